//! Walls of a scene that are always in balance with what they enclose.

use super::Scene;
use super::solids::of_solid;
use crate::chemistry::AVOGADRO;
use crate::error::RunError;
use crate::fluid::Snapshot;
use crate::plan::{ParticlePlan, SolidPlan, VesselPlan};
use crate::solid::{Birth, StepLimit, Vessel, VesselState};
use serde::{Deserialize, Serialize};

/// A wall of a scene in balance.
pub struct VesselBody<const D: usize> {
    /// Its number among the solids of the plan.
    pub number: usize,
    /// Number of its first particle; the others follow, then those in reserve.
    pub first: usize,
    pub vessel: Vessel<D>,
    /// φ of each particle, 1/(Pa s).
    phi: Vec<f64>,
    /// Home group of each particle: the wall or one of its surfaces.
    homes: Vec<u8>,
    course: Course,
    /// The period of the slowest mode of the last balance over the last step.
    pub time_ratio: f64,
}

/// What a wall has come to so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Course {
    /// Gaps and crossings found, step by step.
    pub escapes: u64,
    pub largest_stretch: f64,
    pub steps: u64,
}

/// What must be kept of a wall to go on with it later.
#[derive(Serialize, Deserialize)]
pub struct VesselImage<const D: usize> {
    vessel: VesselState<D>,
    phi: Vec<f64>,
    homes: Vec<u8>,
    course: Course,
    time_ratio: f64,
}

impl<const D: usize> VesselBody<D> {
    /// The wall of a plan at t = 0, in balance.
    fn new(
        plan: &SolidPlan<D>,
        vessel: &VesselPlan<D>,
        (number, homes): (usize, &[u8]),
    ) -> Result<VesselBody<D>, RunError> {
        let phi = if vessel.by.is_none() { vessel.rate } else { 0.0 };
        let mut body = VesselBody {
            number,
            first: plan.first,
            phi: vec![phi; plan.setup.places.len()],
            homes: homes[plan.first..][..plan.setup.places.len()].to_vec(),
            vessel: Vessel::new(
                plan.setup.clone(),
                vessel.wall.clone(),
                vessel.turgor,
                vessel.growth,
                vessel.relaxation,
            )?,
            course: Course { largest_stretch: 1.0, ..Course::default() },
            time_ratio: 0.0,
        };
        body.vessel.relax(0.0).map_err(|error| body.named(error, &plan.name))?;
        Ok(body)
    }

    /// What it has come to so far.
    #[must_use]
    pub fn course(&self) -> &Course {
        &self.course
    }

    fn image(&self) -> VesselImage<D> {
        VesselImage {
            vessel: self.vessel.image(),
            phi: self.phi.clone(),
            homes: self.homes.clone(),
            course: self.course,
            time_ratio: self.time_ratio,
        }
    }

    fn restore(&mut self, image: VesselImage<D>) -> Option<()> {
        self.vessel.restore(image.vessel)?;
        (self.phi, self.homes) = (image.phi, image.homes);
        (self.course, self.time_ratio) = (image.course, image.time_ratio);
        ([self.phi.len(), self.homes.len()] == [self.vessel.solid.len(); 2]).then_some(())
    }

    /// One chemistry step of `dt` (s); the births, numbered as the particles of the plan.
    fn advance(&mut self, dt: f64) -> Result<Vec<Birth>, RunError> {
        let births = self.vessel.advance(dt, &self.phi)?;
        self.phi.resize(self.vessel.solid.len(), 0.0);
        for birth in &births {
            self.homes.push(self.homes[birth.parent()]);
        }
        self.course.steps += 1;
        self.course.escapes += self.vessel.escapes() as u64;
        self.course.largest_stretch = self.course.largest_stretch.max(self.vessel.largest_stretch());
        self.time_ratio = self.vessel.last().period / dt;
        let number = |birth: Birth| Birth {
            particle: birth.particle + self.first,
            donors: birth.donors.map(|(donor, part)| (donor + self.first, part)),
        };
        Ok(births.into_iter().map(number).collect())
    }

    /// An error of this wall, told of the plan's particles and chemistry steps.
    fn named(&self, error: RunError, name: &str) -> RunError {
        of_solid(error, Some(self.course.steps), self.first, name)
    }

    /// Shows places, volumes, densities and pressures.
    fn show(&self, plan: &ParticlePlan<D>, snapshot: &mut Snapshot<D>) {
        let solid = &self.vessel.solid;
        for i in 0..solid.len() {
            let at = self.first + i;
            let volume = solid.volume(i);
            snapshot.position[at] = plan.domain.wrap(&solid.position(i));
            snapshot.volume[at] = volume;
            snapshot.density[at] = solid.grown_mass(i) / volume;
            snapshot.pressure[at] = -solid.stress(i).trace() / 3.0;
            snapshot.volume_fraction[at] = 1.0;
        }
    }
}

impl<'p, const D: usize> Scene<'p, D> {
    /// The walls of a plan that are in balance, at t = 0.
    pub(super) fn build_vessels(plan: &'p ParticlePlan<D>) -> Result<Vec<VesselBody<D>>, RunError> {
        let all = plan.solids.iter().enumerate();
        all.filter_map(|(number, solid)| Some((number, solid, solid.vessel.as_ref()?)))
            .map(|(number, solid, vessel)| VesselBody::new(solid, vessel, (number, &plan.home)))
            .collect()
    }

    /// Wall `number` of the plan as it is now.
    #[must_use]
    pub fn vessel(&self, number: usize) -> Option<&VesselBody<D>> {
        self.vessels.iter().find(|body| body.number == number)
    }

    /// Walls in balance know no step of their own: one for each chemistry step, of at most `until` (s).
    #[must_use]
    pub fn vessel_steps(&self, until: f64) -> Vec<StepLimit> {
        vec![StepLimit { seconds: until, limited_by: String::new() }; self.vessels.len()]
    }

    /// Advances the walls by `duration` (s).
    pub(super) fn advance_vessels(&mut self, duration: f64) -> Result<(), RunError> {
        self.births.clear();
        for body in &mut self.vessels {
            let name = &self.plan.solids[body.number].name;
            match body.advance(duration) {
                Ok(births) => self.births.extend(births),
                Err(error) => return Err(body.named(error, name)),
            }
        }
        self.born.extend(&self.births);
        Ok(())
    }

    /// Brings the walls to balance with what the amounts of a realization make of them at t = 0.
    ///
    /// # Errors
    /// As [`Scene::soften`]; a wall without balance.
    pub fn soften_at_start(&mut self, amounts: &[f64], species: &[String]) -> Result<(), RunError> {
        if self.vessels.is_empty() {
            return Ok(());
        }
        self.soften(amounts, species, (0, 0.0))?;
        for body in &mut self.vessels {
            let name = &self.plan.solids[body.number].name;
            let relaxed = body.vessel.solid.renew().and_then(|()| body.vessel.relax(0.0));
            if let Err(error) = relaxed {
                return Err(body.named(error, name));
            }
        }
        self.look();
        Ok(())
    }

    /// Shows the walls in the snapshot.
    pub(super) fn show_vessels(&mut self) {
        for body in &self.vessels {
            body.show(self.plan, &mut self.snapshot);
        }
    }

    /// Particles that have left the reserve belong to the group of their donors.
    pub(super) fn house_vessels(&mut self) {
        for body in &self.vessels {
            self.home[body.first..][..body.homes.len()].copy_from_slice(&body.homes);
        }
    }

    /// Softness and rate of growth by the concentrations (mol/m³) that `of` knows of particles and species.
    pub(super) fn feed_vessels(
        &mut self,
        of: impl Fn(usize, usize) -> f64,
        soft: impl Fn(&SolidPlan<D>, usize) -> Result<f64, RunError>,
    ) -> Result<(), RunError> {
        for body in &mut self.vessels {
            let plan = &self.plan.solids[body.number];
            if plan.softening.is_some() {
                for (i, softness) in body.vessel.solid.softness_mut().iter_mut().enumerate() {
                    *softness = soft(plan, body.first + i)?;
                }
            }
            let Some(vessel) = &plan.vessel else { continue };
            for (i, phi) in body.phi.iter_mut().enumerate() {
                let there = vessel.by.map_or(1.0, |(species, at)| of(body.first + i, species).max(0.0) / at);
                *phi = vessel.rate * there;
            }
        }
        Ok(())
    }

    /// What must be kept of the walls.
    pub(super) fn vessel_images(&self) -> Vec<VesselImage<D>> {
        self.vessels.iter().map(VesselBody::image).collect()
    }

    /// Puts the walls back; `None` if the images belong to others.
    pub(super) fn restore_vessels(&mut self, images: Vec<VesselImage<D>>) -> Option<()> {
        if images.len() != self.vessels.len() {
            return None;
        }
        self.vessels.iter_mut().zip(images).try_for_each(|(body, image)| body.restore(image))
    }
}

/// mol/m³ of `n` molecules in `volume` (m³).
#[must_use]
pub(super) fn concentration(n: f64, volume: f64) -> f64 {
    n / (AVOGADRO * volume)
}
