//! Particles as they are at an instant: what the chemistry and the observers see of geometry and flow.

mod solids;
mod vessels;

use crate::chemistry::{AVOGADRO, GroupSet};
use crate::error::RunError;
use crate::fluid::exchange::{Exchange, exchange};
use crate::fluid::open::Presence;
use crate::fluid::surface::{Facing, side};
use crate::fluid::{self, BodyKind, Flow, Setup, Snapshot, Voxels};
use crate::geometry::shape::embed;
use crate::model::conditions::WallName;
use crate::plan::ParticlePlan;
use crate::plan::particles::BOLTZMANN;
use crate::plan::start::Voxels as Places;
use crate::solid::Birth;
use crate::vector::Vector;
use serde::{Deserialize, Serialize};
pub use solids::{AT_A_TIME, SolidBody, SolidHealth, SolidImage};
use std::borrow::Cow;
pub use vessels::{VesselBody, VesselImage};

/// The geometry of a particle plan at an instant, and the flow that moves it, if there is one.
pub struct Scene<'p, const D: usize> {
    pub plan: &'p ParticlePlan<D>,
    pub flow: Option<Flow<D>>,
    /// Elastic solids that no fluid moves.
    pub solids: Vec<SolidBody<D>>,
    /// Walls in balance with what they enclose.
    pub vessels: Vec<VesselBody<D>>,
    /// Particles that left the reserves at the last step.
    pub births: Vec<Birth>,
    /// All that left them so far, in order.
    pub born: Vec<Birth>,
    pub snapshot: Snapshot<D>,
    /// Places with three coordinates, m.
    pub positions: Vec<Vector<3>>,
    /// m³.
    pub volumes: Vec<f64>,
    /// Home group of each particle; those that are not in the box now have the number of walls round it.
    pub home: Vec<u8>,
    /// Zone a particle is in, or its home group.
    pub current: Vec<u8>,
    /// Where there are open ends: who is in the box, and who left and entered it by which end at the last step.
    presence: Vec<Presence>,
    pub crossings: Crossings,
    momentum: Option<Momentum<D>>,
}

/// What moves in a scene.
pub struct Moving<const D: usize> {
    pub flow: Option<Flow<D>>,
    /// Elastic solids that no fluid moves.
    pub solids: Vec<SolidBody<D>>,
    /// Walls in balance with what they enclose.
    pub vessels: Vec<VesselBody<D>>,
}

/// What must be kept of a scene to go on with it later.
#[derive(Serialize, Deserialize)]
pub struct Image<'a, const D: usize> {
    flow: Option<fluid::Image<'a, D>>,
    solids: Vec<SolidImage<'a, D>>,
    vessels: Vec<VesselImage<D>>,
    born: Cow<'a, [Birth]>,
    presence: Vec<Presence>,
    momentum: Option<Momentum<D>>,
}

/// Particles that crossed an open end during a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Crossings {
    pub left: Vec<u32>,
    /// By the lower and by the upper end.
    pub entered: [Vec<u32>; 2],
}

/// Momentum of a fluid that nothing holds, per unit thickness: kg m/s times m^(D-3).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Momentum<const D: usize> {
    /// At the first step; `None` before.
    start: Option<Vector<D>>,
    /// Largest Σ m |v| seen.
    scale: f64,
    /// ∫ F dt of body forces.
    impulse: Vector<D>,
    /// F now.
    force: Vector<D>,
}

impl<'p, const D: usize> Scene<'p, D> {
    /// The particles at the start of a realization, the flow built but not yet run.
    ///
    /// # Errors
    /// A flow that cannot be built.
    pub fn new(plan: &'p ParticlePlan<D>, realization: u32) -> Result<Scene<'p, D>, RunError> {
        let mut setup = plan.flow.clone();
        if let Some(noise) = setup.as_mut().and_then(|setup| setup.noise.as_mut()) {
            noise.realization = u64::from(realization);
        }
        if let Some(setup) = &mut setup {
            Scene::couple(plan, setup)?;
        }
        let mut flow = setup
            .map(|setup| Flow::with_ends(setup, plan.openings.as_ref().map(|openings| openings.open.clone())))
            .transpose()?;
        if let Some(flow) = flow.as_mut().filter(|_| plan.velocity.uniform().is_none()) {
            flow.set_velocity(|x| {
                let velocity = plan.velocity.at(&embed(x));
                Vector::from_fn(|k, _| velocity[k])
            });
        }
        // In a flow it is the flow that moves them.
        let solids = if flow.is_none() { Scene::build_solids(plan)? } else { Vec::new() };
        let vessels = Scene::build_vessels(plan)?;
        Ok(Scene::at_rest(plan).with_motion(Moving { flow, solids, vessels }))
    }

    /// The particles where they are placed, without a flow.
    #[must_use]
    pub fn at_rest(plan: &'p ParticlePlan<D>) -> Scene<'p, D> {
        let count = plan.particles.len();
        Scene {
            plan,
            flow: None,
            solids: Vec::new(),
            vessels: Vec::new(),
            births: Vec::new(),
            born: Vec::new(),
            snapshot: Snapshot {
                position: plan.particles.iter().map(|p| p.position).collect(),
                velocity: vec![Vector::zeros(); count],
                density: vec![0.0; count],
                pressure: vec![0.0; count],
                volume: plan.particles.iter().map(|p| p.volume).collect(),
                volume_fraction: vec![0.0; count],
            },
            positions: Vec::new(),
            volumes: Vec::new(),
            home: Vec::new(),
            current: Vec::new(),
            presence: Vec::new(),
            crossings: Crossings::default(),
            momentum: plan.flow.as_ref().filter(|setup| is_free(setup)).map(|setup| Momentum {
                start: None,
                scale: 0.0,
                impulse: Vector::zeros(),
                force: weight(setup),
            }),
        }
    }

    /// The scene of a plan with what moves in that plan as it is now.
    #[must_use]
    pub fn with_motion(mut self, moving: Moving<D>) -> Scene<'p, D> {
        (self.flow, self.solids, self.vessels) = (moving.flow, moving.solids, moving.vessels);
        self.look();
        self
    }

    /// What must be kept to go on later.
    #[must_use]
    pub fn image(&self) -> Image<'_, D> {
        Image {
            flow: self.flow.as_ref().map(Flow::image),
            solids: self.solids.iter().map(SolidBody::image).collect(),
            vessels: self.vessel_images(),
            born: Cow::Borrowed(&self.born),
            presence: self.presence.clone(),
            momentum: self.momentum,
        }
    }

    /// Goes back to an image; `None` if it belongs to another plan.
    #[must_use]
    pub fn restore(&mut self, image: Image<D>) -> Option<()> {
        match (&mut self.flow, image.flow) {
            (Some(flow), Some(kept)) => flow.restore(kept)?,
            (None, None) => {}
            _ => return None,
        }
        if image.solids.len() != self.solids.len() {
            return None;
        }
        for (body, kept) in self.solids.iter_mut().zip(image.solids) {
            body.restore(kept)?;
        }
        self.restore_vessels(image.vessels)?;
        self.momentum = image.momentum;
        self.born = image.born.into_owned();
        self.look();
        // Who was there at the last look; it may have been before the last steps of the flow.
        self.presence = image.presence;
        Some(())
    }

    /// Shows particles as they were when a flow was recorded.
    pub fn show(&mut self, snapshot: Snapshot<D>, presence: Vec<Presence>) {
        self.snapshot = snapshot;
        self.see(presence);
    }

    /// Who is in the box and who is not, where there are open ends.
    #[must_use]
    pub fn presence(&self) -> &[Presence] {
        &self.presence
    }

    /// Takes what moves out of the scene.
    #[must_use]
    pub fn take_motion(&mut self) -> Moving<D> {
        Moving {
            flow: self.flow.take(),
            solids: std::mem::take(&mut self.solids),
            vessels: std::mem::take(&mut self.vessels),
        }
    }

    /// Reads places and volumes off the flow and the solids.
    pub fn look(&mut self) {
        let mut presence = Vec::new();
        if let Some(flow) = &self.flow {
            self.snapshot = flow.snapshot();
            presence = flow.presence().unwrap_or_default();
        }
        self.show_solids();
        self.show_vessels();
        self.see(presence);
    }

    /// Takes places and volumes off the snapshot.
    fn see(&mut self, presence: Vec<Presence>) {
        self.note_presence(presence);
        self.positions = self.snapshot.position.iter().map(embed).collect();
        self.volumes = self.snapshot.volume.iter().map(|v| v * self.plan.thickness).collect();
        self.current = self
            .positions
            .iter()
            .zip(&self.home)
            .map(|(x, &home)| {
                // Walls do not pass through zones; what flows, or rests in one, is counted to it.
                let zone = self.plan.zones.iter().find(|(_, shape)| shape.holds(x));
                match zone {
                    Some(&(zone, _)) if !self.plan.is_wall(home) => zone,
                    _ => home,
                }
            })
            .collect();
    }

    /// Who is in the box, and who came and went since it was asked last.
    fn note_presence(&mut self, now: Vec<Presence>) {
        self.home.clone_from(&self.plan.home);
        self.house_vessels();
        let Some(openings) = self.plan.openings.as_ref().filter(|_| !now.is_empty()) else { return };
        let boundary = self.plan.home.iter().copied().max().unwrap_or(0);
        let axis = openings.open.axis;
        let domain = &self.plan.domain;
        self.crossings = Crossings::default();
        for (i, one) in now.iter().enumerate() {
            if !one.inside {
                self.home[i] = boundary;
            } else if one.entries > 0 {
                self.home[i] = openings.group;
            }
            if one.inside && !self.plan.is_wall(self.home[i]) {
                // It crosses the end when the lists are built next.
                let x = &mut self.snapshot.position[i][axis];
                *x = x.clamp(domain.min[axis], domain.max[axis]);
            }
            let Some(before) = self.presence.get(i) else { continue };
            let again = one.entries != before.entries;
            if before.inside && (!one.inside || again) {
                self.crossings.left.push(i as u32);
            }
            if one.inside && (!before.inside || again) {
                self.crossings.entered[usize::from(one.by)].push(i as u32);
            }
        }
        self.presence = now;
    }

    /// Moves the flow, or the solids, by `steps` steps of `dt` seconds, or until `stop` says so; the number of steps taken. Only after
    /// all of them it is looked at again.
    pub fn advance(
        &mut self,
        dt: f64,
        steps: u64,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<u64, RunError> {
        self.book_momentum(0.0);
        let taken = match &mut self.flow {
            Some(flow) => flow.advance_until(dt, steps, stop)?,
            None if !self.vessels.is_empty() => {
                self.advance_vessels(dt * steps as f64)?;
                steps
            }
            None => self.advance_solids(dt, steps, stop)?,
        };
        if taken == steps {
            self.look();
            self.check_solids()?;
        }
        self.book_momentum(dt * taken as f64);
        Ok(taken)
    }

    /// Temperature by the velocities of now, K; none without thermal noise.
    #[must_use]
    pub fn temperature(&self) -> Option<f64> {
        self.plan.flow.as_ref()?.noise?;
        Some(self.flow.as_ref()?.thermal_energy()? * self.plan.thickness / BOLTZMANN)
    }

    /// Lets the amounts of a realization (molecules, voxel by voxel of `species`) lift the fluid from here on:
    /// -expansion (C - reference) gravity with C = n/(N_A V) of each particle (Boussinesq). Set in the middle of a
    /// split step it stays for the whole motion, which keeps the step second order.
    pub fn lift(&mut self, amounts: &[f64], species: usize) {
        let (Some(flow), Some(setup)) = (&mut self.flow, &self.plan.flow) else { return };
        let of = |i: usize| -> Vector<D> {
            self.plan.lifts.iter().fold(Vector::zeros(), |sum, lift| {
                let concentration = amounts[i * species + lift.species] / (AVOGADRO * self.volumes[i]);
                sum - lift.gravity * (lift.expansion * (concentration - lift.reference))
            })
        };
        flow.set_buoyancy(of);
        if let Some(momentum) = &mut self.momentum {
            momentum.force = weight(setup)
                + (0..setup.particles.len())
                    .fold(Vector::zeros(), |sum: Vector<D>, i| sum + of(i) * mass(setup, i));
        }
    }

    /// Takes the time that passed and the momentum that is there now into the books.
    fn book_momentum(&mut self, duration: f64) {
        let (Some(momentum), Some(setup)) = (&mut self.momentum, &self.plan.flow) else { return };
        let velocities = self.snapshot.velocity.iter().enumerate();
        let (sum, scale) = velocities.fold((Vector::<D>::zeros(), 0.0), |(sum, scale), (i, v)| {
            (sum + v * mass(setup, i), scale + v.norm() * mass(setup, i))
        });
        momentum.start.get_or_insert(sum);
        momentum.scale = momentum.scale.max(scale);
        momentum.impulse += momentum.force * duration;
    }

    /// |P - P(0) - ∫ F dt| over the largest Σ m |v|, where nothing but body forces F acts on the fluid from outside:
    /// no walls, no sponges, periodic on all axes.
    #[must_use]
    pub fn momentum_drift(&self) -> Option<f64> {
        let momentum = self.momentum.as_ref()?;
        let astray = self.flow.as_ref()?.health().momentum - momentum.start? - momentum.impulse;
        Some(if momentum.scale > 0.0 { astray.norm() / momentum.scale } else { astray.norm() })
    }

    /// Conductances between the particles as they are now, for species that live in the groups of `habitat`, and
    /// what the particles face of surfaces.
    #[must_use]
    pub fn exchange(&self, habitat: GroupSet) -> Exchange {
        let (weights, thickness) = (self.plan.weights, self.plan.thickness);
        self.for_habitat(habitat, |voxels| exchange(voxels, &self.plan.kernel(), weights, thickness))
    }

    /// Voxels that face a surface of the plan, among those of the groups of `habitat`, whose exchange is given.
    #[must_use]
    pub fn facing(&self, surface: usize, habitat: GroupSet, exchange: &Exchange) -> Vec<Facing> {
        match self.plan.surfaces[surface] {
            WallName::Side { axis, upper } => {
                let areas = &exchange.sides[2 * axis + usize::from(upper)];
                let (cutoff, thickness) = (self.plan.cutoff, self.plan.thickness);
                self.for_habitat(habitat, |voxels| side(voxels, areas, cutoff, thickness, (axis, upper)))
            }
            // The plan refuses surfaces of what moves or holds the species, so they are among the obstacles.
            WallName::Group(wall) => {
                let mut obstacles = self.plan.still.iter().filter(|(group, _)| !habitat.holds(*group));
                let number = obstacles.position(|(group, _)| usize::from(*group) == wall);
                number.and_then(|number| exchange.obstacles.get(number)).cloned().unwrap_or_default()
            }
        }
    }

    /// What `see` makes of the particles as hosts of the species that live in the groups of `habitat`.
    fn for_habitat<T>(&self, habitat: GroupSet, see: impl FnOnce(&Voxels<D>) -> T) -> T {
        let hosts: Vec<bool> = self.home.iter().map(|&home| habitat.holds(home)).collect();
        // What stays where it is and does not hold the species is in its way.
        let distances: Vec<_> = self
            .plan
            .still
            .iter()
            .filter(|(group, _)| !habitat.holds(*group))
            .map(|(_, shape)| move |x: &Vector<D>| shape.signed_distance(&embed(x)))
            .collect();
        let obstacles: Vec<&(dyn Fn(&Vector<D>) -> f64 + Sync)> =
            distances.iter().map(|distance| distance as &(dyn Fn(&Vector<D>) -> f64 + Sync)).collect();
        see(&Voxels {
            positions: &self.snapshot.position,
            volumes: &self.snapshot.volume,
            hosts: &hosts,
            domain: &self.plan.domain,
            barriers: &self.plan.barriers,
            obstacles: &obstacles,
        })
    }

    /// The voxels as the start of the chemistry sees them.
    #[must_use]
    pub fn places(&self) -> Places<'_> {
        Places {
            positions: &self.positions,
            volumes: &self.volumes,
            home: &self.home,
            current: &self.current,
        }
    }

    /// Numbers of the particles that are in a group now, by home or by zone.
    #[must_use]
    pub fn members(&self, group: u8) -> Vec<u32> {
        (0..self.positions.len() as u32)
            .filter(|&i| self.current[i as usize] == group || self.home[i as usize] == group)
            .collect()
    }
}

/// Whether nothing but body forces acts on a fluid from outside.
fn is_free<const D: usize>(setup: &Setup<D>) -> bool {
    setup.domain.periodic.iter().all(|&periodic| periodic) && !setup.has_solids() && setup.sponges.is_empty()
}

/// Mass of a fluid particle per unit thickness, kg times m^(D-3); none of a solid.
fn mass<const D: usize>(setup: &Setup<D>, i: usize) -> f64 {
    let placed = &setup.particles[i];
    match setup.bodies[usize::from(placed.body)].kind {
        BodyKind::Fluid { density, .. } => density * placed.volume,
        BodyKind::Solid { .. } => 0.0,
    }
}

/// The body force on all fluid, per unit thickness.
fn weight<const D: usize>(setup: &Setup<D>) -> Vector<D> {
    setup.body_force * (0..setup.particles.len()).map(|i| mass(setup, i)).sum::<f64>()
}
