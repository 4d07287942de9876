//! One step of an elastic solid: kick, drift, forces, kick.

use crate::error::RunError;
use crate::solid::elastic::{Drive, Elastic, Hold};
use crate::vector::Vector;

impl<const D: usize> Elastic<D> {
    /// One step of `dt` (s), with the loads that are set.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] for a particle that is turned inside out or lost.
    pub fn step(&mut self, dt: f64) -> Result<(), RunError> {
        self.step_under(dt, true)
    }

    /// One step of `dt` (s), without the loads unless `loaded`.
    fn step_under(&mut self, dt: f64, loaded: bool) -> Result<(), RunError> {
        self.kick(0.5 * dt, loaded);
        for ((u, v), hold) in self.displacements.iter_mut().zip(&self.velocities).zip(&self.holds) {
            if matches!(hold, Hold::Free) {
                *u += v * dt;
            }
        }
        self.time += dt;
        self.steps += 1;
        self.drive(dt)?;
        self.strain()?;
        self.pull();
        self.kick(0.5 * dt, loaded);
        self.tally.particle_steps += self.places.len() as u64;
        Ok(())
    }

    /// Advances by `duration` (s) in equal steps of at most `longest` (s).
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn advance(&mut self, duration: f64, longest: f64) -> Result<(), RunError> {
        let steps = (duration / longest).ceil().max(1.0);
        for _ in 0..steps as u64 {
            self.step(duration / steps)?;
        }
        Ok(())
    }

    /// As [`Elastic::advance`] without the loads: they come as kicks before and after ([`Elastic::kick_by_loads`]).
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn glide(&mut self, duration: f64, longest: f64) -> Result<(), RunError> {
        let steps = (duration / longest).ceil().max(1.0);
        for _ in 0..steps as u64 {
            self.step_under(duration / steps, false)?;
        }
        Ok(())
    }

    /// v += dt (load/m) of the free particles.
    pub fn kick_by_loads(&mut self, dt: f64) {
        for i in 0..self.len() {
            if matches!(self.holds[i], Hold::Free) {
                let mass = self.mass(i);
                self.velocities[i] += self.loads[i] * (dt / mass);
            }
        }
    }

    /// v = (v + dt a) e^(-drag dt). Drag alone is exact; with a force first order in drag dt. Forces of a fluid come in kicks of
    /// their own, and v' = a - drag v solved for the forces from inside alone would set the two off balance (by 3 % of the
    /// pressure on a soft floor).
    fn kick(&mut self, dt: f64, loaded: bool) {
        let kept = (-self.options.drag * dt).exp();
        let density = self.material.density;
        for (i, velocity) in self.velocities.iter_mut().enumerate() {
            if !matches!(self.holds[i], Hold::Free) {
                continue;
            }
            let force: Vector<D> = if loaded { self.forces[i] + self.loads[i] } else { self.forces[i] };
            let pull = force / (density * self.volumes[i]) + self.options.body_force;
            *velocity = (*velocity + pull * dt) * kept;
        }
    }

    /// Driven particles to their place of now; their velocity is the mean over the `dt` (s) before.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] for a displacement that is no finite number.
    pub(super) fn drive(&mut self, dt: f64) -> Result<(), RunError> {
        let t = self.time;
        for (i, hold) in self.holds.iter().enumerate() {
            if let Hold::Driven(drive) = hold {
                let now = driven(drive, (i, &self.places[i]), (self.steps, t))?;
                let before = std::mem::replace(&mut self.displacements[i], now);
                if dt > 0.0 {
                    self.velocities[i] = (self.displacements[i] - before) / dt;
                }
            }
        }
        Ok(())
    }
}

/// Where a driven particle, with its place at rest, is displaced to at a time (s), m.
///
/// # Errors
/// [`RunError::BlowUp`] for a displacement that is no finite number.
pub(super) fn driven<const D: usize>(
    drive: &Drive<D>,
    (particle, place): (usize, &Vector<D>),
    (step, time): (u64, f64),
) -> Result<Vector<D>, RunError> {
    let displacement = drive(place, time);
    let Some(value) = displacement.iter().copied().find(|u| !u.is_finite()) else { return Ok(displacement) };
    let place: Vec<String> = place.iter().map(|x| format!("{x:.4e}")).collect();
    Err(RunError::BlowUp {
        step,
        time,
        particle,
        quantity: format!("driven displacement in m of the particle at ({}) m at rest", place.join(", ")),
        value,
        remedy: "driven.displacement is no number there and then: guard it, e.g. sqrt(max(0, ...))".into(),
    })
}
