//! The elastic solids of a scene: the steps of those that no fluid moves, what is seen of them, and what softens them.

use super::Scene;
use super::vessels::concentration;
use crate::error::RunError;
use crate::fluid::{BodyKind, Coupled, Flow, Setup};
use crate::plan::{ParticlePlan, SolidPlan};
use crate::quantity::readable::{show, show_vector};
use crate::solid::{Elastic, ElasticState, StepLimit};
use crate::vector::Vector;
use serde::{Deserialize, Serialize};

/// Steps after which the longest stable one is found again: what is stretched swings faster.
const RENEWED: u64 = 2000;
/// Steps between two looks at whether to stop.
pub const AT_A_TIME: f64 = 64.0;

/// An elastic solid of a scene.
pub struct SolidBody<const D: usize> {
    /// Its number among the solids of the plan.
    pub number: usize,
    pub group: u8,
    /// Number of its first particle; the others follow.
    pub first: usize,
    pub elastic: Elastic<D>,
    /// Of the start.
    limit: StepLimit,
    pace: Pace,
}

/// How a solid steps, and the most it was stretched so far.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Pace {
    /// The longest step, s.
    longest: f64,
    /// Steps until it is found again.
    left: u64,
    largest_stretch: f64,
    steps: u64,
}

/// What must be kept of a solid to go on with it later.
#[derive(Serialize, Deserialize)]
pub struct SolidImage<'a, const D: usize> {
    elastic: ElasticState<'a, D>,
    pace: Pace,
}

/// What solids have come to so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidHealth {
    pub largest_stretch: f64,
    pub particle_steps: u64,
    pub bond_evaluations: u64,
    /// Steps of the solid that took most.
    pub steps: u64,
}

impl<const D: usize> SolidBody<D> {
    /// The solid of a plan at t = 0.
    ///
    /// # Errors
    /// A solid that cannot be built.
    pub fn new(plan: &SolidPlan<D>, number: usize) -> Result<SolidBody<D>, RunError> {
        let mut elastic = plan.elastic()?;
        let limit = elastic.limit()?;
        let pace = Pace { longest: limit.seconds, left: RENEWED, largest_stretch: 1.0, steps: 0 };
        Ok(SolidBody { number, group: plan.group, first: plan.first, elastic, limit, pace })
    }

    /// What must be kept to go on later.
    #[must_use]
    pub fn image(&self) -> SolidImage<'_, D> {
        SolidImage { elastic: self.elastic.image(), pace: self.pace }
    }

    /// Goes back to an image; `None` if it belongs to another solid.
    #[must_use]
    pub fn restore(&mut self, image: SolidImage<D>) -> Option<()> {
        self.pace = image.pace;
        self.elastic.restore(image.elastic)
    }

    /// Advances by `duration` (s) in equal steps.
    fn advance(&mut self, duration: f64) -> Result<(), RunError> {
        let steps = (duration / self.pace.longest * (1.0 - 1e-9)).ceil().max(1.0);
        self.elastic.advance(duration, duration / steps * (1.0 + 1e-12))?;
        self.pace.steps += steps as u64;
        if steps as u64 >= self.pace.left {
            self.pace.longest = self.elastic.step_limit()?;
            self.pace.left = RENEWED;
        } else {
            self.pace.left -= steps as u64;
        }
        let stretch = (0..self.elastic.len()).map(|i| self.elastic.stretch(i)).fold(0.0, f64::max);
        self.pace.largest_stretch = self.pace.largest_stretch.max(stretch);
        Ok(())
    }

    /// Numbers an error as the particles of the plan are numbered, and says which solid it is.
    fn named(&self, error: RunError, name: &str) -> RunError {
        match error {
            RunError::BlowUp { step, time, particle, quantity, value, remedy } => RunError::BlowUp {
                step,
                time,
                particle: particle + self.first,
                quantity: format!("{quantity} (solid `{name}`)"),
                value,
                remedy,
            },
            other => other,
        }
    }
}

impl<'p, const D: usize> Scene<'p, D> {
    /// The solids of a plan at t = 0.
    pub(super) fn build_solids(plan: &'p ParticlePlan<D>) -> Result<Vec<SolidBody<D>>, RunError> {
        let moving = plan.solids.iter().enumerate().filter(|(_, solid)| solid.vessel.is_none());
        moving.map(|(number, solid)| SolidBody::new(solid, number)).collect()
    }

    /// Makes the bodies of a flow that are elastic what the plan says of them.
    ///
    /// # Errors
    /// A solid that cannot be built.
    pub(super) fn couple(plan: &ParticlePlan<D>, setup: &mut Setup<D>) -> Result<(), RunError> {
        for solid in &plan.solids {
            let Some(body) = setup.bodies.get_mut(usize::from(solid.body)) else { continue };
            if let BodyKind::Solid { motion, .. } = &mut body.kind {
                *motion = Coupled::motion(solid.elastic()?)?;
            }
        }
        Ok(())
    }

    /// The longest steps of the solids, in the order of the plan.
    #[must_use]
    pub fn solid_steps(&self) -> Vec<StepLimit> {
        let Some(flow) = &self.flow else {
            return self.solids.iter().map(|body| body.limit.clone()).collect();
        };
        let of = |plan: &SolidPlan<D>| flow.elastic_bodies().find(|(body, _)| *body == plan.body);
        self.plan.solids.iter().filter_map(of).map(|(_, coupled)| coupled.limit().clone()).collect()
    }

    /// Force of the fluid on elastic solid `number` of the plan (of the depth that a model of fewer than three dimensions
    /// stands for), N, if a fluid moves it.
    #[must_use]
    pub fn force_on_solid(&self, number: usize) -> Option<Vector<D>> {
        let body = self.plan.solids[number].body;
        let mine = self.flow.as_ref()?.reactions().filter(|one| one.body == body);
        Some(mine.fold(Vector::zeros(), |sum, one| sum + one.force) * self.plan.thickness)
    }

    /// Elastic solid `number` of the plan as it is now.
    #[must_use]
    pub fn elastic(&self, number: usize) -> Option<&Elastic<D>> {
        if let Some(flow) = &self.flow {
            let body = self.plan.solids[number].body;
            return flow.elastic_bodies().find(|(mine, _)| *mine == body).map(|(_, coupled)| coupled.solid());
        }
        let vessel = self.vessel(number).map(|body| &body.vessel.solid);
        vessel.or(self.solids.iter().find(|body| body.number == number).map(|body| &body.elastic))
    }

    /// Advances the solids by `steps` times `dt` (s), or until `stop` says so; how often.
    pub(super) fn advance_solids(
        &mut self,
        dt: f64,
        steps: u64,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<u64, RunError> {
        // On a thread of the pool from the start, as a flow does.
        rayon::scope(|_| {
            for taken in 0..steps {
                if taken > 0 && stop() {
                    return Ok(taken);
                }
                for body in &mut self.solids {
                    let name = &self.plan.solids[body.number].name;
                    body.advance(dt).map_err(|error| body.named(error, name))?;
                }
            }
            Ok(steps)
        })
    }

    /// Shows the solids in the snapshot: places, velocities, volumes, densities and pressures.
    pub(super) fn show_solids(&mut self) {
        let mut snapshot = std::mem::take(&mut self.snapshot);
        for (number, solid) in self.plan.solids.iter().enumerate() {
            let Some(elastic) = self.elastic(number) else { continue };
            for i in 0..elastic.len() {
                let (at, volume) = (solid.first + i, elastic.volume(i));
                // A flow shows its solids where they are, and at rest while it settles.
                if self.flow.is_none() {
                    snapshot.position[at] = self.plan.domain.wrap(&elastic.position(i));
                    snapshot.velocity[at] = elastic.velocities()[i];
                    snapshot.volume_fraction[at] = 1.0;
                }
                snapshot.volume[at] = volume;
                snapshot.density[at] = elastic.mass(i) / volume;
                snapshot.pressure[at] = -elastic.stress(i).trace() / 3.0;
            }
        }
        self.snapshot = snapshot;
    }

    /// A solid that has left the box: molecules in it would be nowhere.
    pub(super) fn check_solids(&self) -> Result<(), RunError> {
        let moving = self.solids.iter().map(|body| (body.number, body.first, &body.elastic, body.pace.steps));
        let balanced = self.vessels.iter();
        let balanced =
            balanced.map(|body| (body.number, body.first, &body.vessel.solid, body.course().steps));
        for (number, first, elastic, step) in moving.chain(balanced) {
            // What is held may be in the walls.
            let beyond =
                |i: &usize| !elastic.is_held(*i) && self.plan.domain.is_beyond(&elastic.position(*i));
            let Some(i) = (0..elastic.len()).find(beyond) else { continue };
            let at = show_vector(elastic.position(i).as_slice(), "m");
            return Err(RunError::BlowUp {
                step,
                time: elastic.time(),
                particle: first + i,
                quantity: format!(
                    "distance of solid `{}` beyond the box at {at}",
                    self.plan.solids[number].name
                ),
                value: outside(&self.plan.domain, &elastic.position(i)),
                remedy: "make the box larger, clamp the solid or move it less".into(),
            });
        }
        Ok(())
    }

    /// Lets the amounts of a realization (molecules, voxel by voxel of `species`) soften the solids from here on:
    /// G = G0 (1 - factor c/at). `tick` counts chemistry steps.
    ///
    /// # Errors
    /// A shear modulus that is not positive any more.
    pub fn soften(
        &mut self,
        amounts: &[f64],
        species: &[String],
        (tick, time): (u64, f64),
    ) -> Result<(), RunError> {
        let (count, volumes) = (species.len(), self.volumes.clone());
        let there = |voxel: usize, s: usize| concentration(amounts[voxel * count + s], volumes[voxel]);
        let soft = |plan: &SolidPlan<D>, voxel: usize| -> Result<f64, RunError> {
            let Some(softening) = plan.softening else { return Ok(1.0) };
            let found = there(voxel, softening.species);
            let softness = 1.0 - softening.factor * found / softening.at;
            if softness > 0.0 {
                return Ok(softness);
            }
            let most = show(softening.at / softening.factor, "mol/m^3");
            Err(RunError::BlowUp {
                step: tick,
                time,
                particle: voxel,
                quantity: format!(
                    "shear modulus of solid `{}` over that without `{}`, of which there are {},",
                    plan.name,
                    species[softening.species],
                    show(found, "mol/m^3")
                ),
                value: softness,
                remedy: format!(
                    "it falls to zero at {most}: make softening.factor smaller or softening.at larger, or keep the concentration below"
                ),
            })
        };
        self.feed_vessels(there, soft)?;
        for (number, plan) in self.plan.solids.iter().enumerate() {
            if plan.softening.is_none() {
                continue;
            }
            let elastic = match &mut self.flow {
                Some(flow) => flow.elastic_body_mut(plan.body).map(Coupled::solid_mut),
                None => {
                    self.solids.iter_mut().find(|body| body.number == number).map(|body| &mut body.elastic)
                }
            };
            let Some(elastic) = elastic else { continue };
            for (i, softness) in elastic.softness_mut().iter_mut().enumerate() {
                *softness = soft(plan, plan.first + i)?;
            }
            elastic.renew()?;
        }
        Ok(())
    }

    /// What the solids have come to so far, if there are any.
    #[must_use]
    pub fn solid_health(&self) -> Option<SolidHealth> {
        let of = |elastic: &Elastic<D>, largest_stretch: f64| {
            let tally = elastic.tally();
            SolidHealth {
                largest_stretch,
                particle_steps: tally.particle_steps,
                bond_evaluations: tally.bond_evaluations,
                steps: tally.particle_steps / elastic.len().max(1) as u64,
            }
        };
        let alone = self.solids.iter().map(|body| of(&body.elastic, body.pace.largest_stretch));
        let coupled = self.flow.iter().flat_map(Flow::elastic_bodies);
        let coupled = coupled.map(|(_, coupled)| of(coupled.solid(), coupled.largest_stretch()));
        let balanced = self.vessels.iter().map(|body| of(&body.vessel.solid, body.course().largest_stretch));
        alone.chain(coupled).chain(balanced).reduce(|a, b| SolidHealth {
            largest_stretch: a.largest_stretch.max(b.largest_stretch),
            particle_steps: a.particle_steps + b.particle_steps,
            bond_evaluations: a.bond_evaluations + b.bond_evaluations,
            steps: a.steps.max(b.steps),
        })
    }
}

/// How far a place lies beyond the sides of a box, m.
fn outside<const D: usize>(domain: &crate::space::Domain<D>, x: &Vector<D>) -> f64 {
    (0..D)
        .filter(|&k| !domain.periodic[k])
        .map(|k| (domain.min[k] - x[k]).max(x[k] - domain.max[k]))
        .fold(0.0, f64::max)
}
