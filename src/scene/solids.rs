//! The elastic solids of a scene: the steps of those that no fluid moves, what is seen of them, and what softens them.

mod alone;

pub use alone::{SolidBody, SolidImage};

use super::Scene;
use super::vessels::concentration;
use crate::error::RunError;
use crate::fluid::{BodyKind, Coupled, Flow, Setup};
use crate::plan::{ParticlePlan, SolidPlan};
use crate::quantity::readable::{show, show_vector};
use crate::solid::{Body, StepLimit};
use crate::vector::Vector;

/// Steps between two looks at whether to stop.
pub const AT_A_TIME: f64 = 64.0;

/// What solids have come to so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidHealth {
    pub largest_stretch: f64,
    pub particle_steps: u64,
    pub bond_evaluations: u64,
    /// Steps of the solid that took most.
    pub steps: u64,
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
    pub fn elastic(&self, number: usize) -> Option<&dyn Body<D>> {
        if let Some(flow) = &self.flow {
            let body = self.plan.solids[number].body;
            let (_, coupled) = flow.elastic_bodies().find(|(mine, _)| *mine == body)?;
            return Some(coupled.solid());
        }
        if let Some(body) = self.vessel(number) {
            return Some(&body.vessel.solid);
        }
        self.solids.iter().find(|body| body.number == number).map(SolidBody::solid)
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
        let moving = self.solids.iter();
        let moving = moving.map(|body| (body.number, body.first, body.solid(), body.pace.steps));
        let balanced = self.vessels.iter().map(|body| {
            let solid: &dyn Body<D> = &body.vessel.solid;
            (body.number, body.first, solid, body.course().steps)
        });
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
                    self.solids.iter_mut().find(|body| body.number == number).and_then(SolidBody::elastic_mut)
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
        let of = |elastic: &dyn Body<D>, largest_stretch: f64| {
            let tally = elastic.tally();
            SolidHealth {
                largest_stretch,
                particle_steps: tally.particle_steps,
                bond_evaluations: tally.bond_evaluations,
                steps: tally.particle_steps / elastic.len().max(1) as u64,
            }
        };
        let alone = self.solids.iter().map(|body| of(body.solid(), body.pace.largest_stretch));
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

/// An error of a solid whose first particle is number `first` of the plan: numbered as those, at `step` if that is given, and with
/// the name of the solid.
pub(super) fn of_solid(error: RunError, at: Option<u64>, first: usize, name: &str) -> RunError {
    match error {
        RunError::BlowUp { step, time, particle, quantity, value, remedy } => RunError::BlowUp {
            step: at.unwrap_or(step),
            time,
            particle: particle + first,
            quantity: format!("{quantity} (solid `{name}`)"),
            value,
            remedy,
        },
        other => other,
    }
}

/// How far a place lies beyond the sides of a box, m.
fn outside<const D: usize>(domain: &crate::space::Domain<D>, x: &Vector<D>) -> f64 {
    (0..D)
        .filter(|&k| !domain.periodic[k])
        .map(|k| (domain.min[k] - x[k]).max(x[k] - domain.max[k]))
        .fold(0.0, f64::max)
}
