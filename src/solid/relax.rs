//! Quasi-static equilibrium by dynamic relaxation (Underwood 1983).
//!
//! The solid moves in a fictitious time under its internal forces and loads, damped critically for the mode it is moving
//! in: ω² = -v·ΔF/(Δt v·M v), the Rayleigh quotient of the last step, and c = 2ω. Damping is proportional to mass, so
//! centre and angle of a free body stay. As masses are real, 2π/ω at the end is the period of the slowest mode that took
//! part: the mechanical time, to be compared with that of the chemistry.

use crate::error::RunError;
use crate::solid::elastic::{Elastic, Hold};
use crate::vector::Vector;

/// When a relaxation ends.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Relaxation {
    /// Largest residual: |net forces| / |loads|.
    pub tolerance: f64,
    /// Rounds after which there is no equilibrium.
    pub rounds: u32,
    /// Stretch of a particle beyond which there is no equilibrium.
    pub stretch: f64,
}

impl Default for Relaxation {
    fn default() -> Relaxation {
        Relaxation { tolerance: 1e-4, rounds: 40_000, stretch: 8.0 }
    }
}

/// How a relaxation went.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Relaxed {
    /// |net forces| / |loads|.
    pub residual: f64,
    pub rounds: u32,
    /// Period of the slowest mode that took part, s.
    pub period: f64,
}

/// Rounds between looks at the stretches.
const LOOK: u32 = 100;
/// Without loads forces are measured against those of this strain.
const STRAIN: f64 = 1e-4;
/// Growth of the residual beyond which the step was too long.
const RUNAWAY: f64 = 1e3;

impl<const D: usize> Elastic<D> {
    /// Relaxes to equilibrium in steps of `*step` (s, as of [`Elastic::step_limit`]; zero: to be found). `load` sets the
    /// loads for the displacements of the moment.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] where there is no equilibrium: the particle that is stretched most.
    pub fn relax(
        &mut self,
        relaxation: &Relaxation,
        step: &mut f64,
        mut load: impl FnMut(&mut Elastic<D>),
    ) -> Result<Relaxed, RunError> {
        if *step <= 0.0 {
            *step = self.step_limit()?;
        }
        let start = self.displacements.clone();
        for _ in 0..4 {
            match self.settle(relaxation, *step, &mut load)? {
                Some(relaxed) => return Ok(relaxed),
                // The fastest mode has become faster.
                None => {
                    self.displacements.clone_from(&start);
                    self.strain()?;
                    self.pull();
                    *step *= 0.5;
                }
            }
        }
        Err(self.unbalanced("shorter steps were tried in vain, the last one in s", *step))
    }

    /// One attempt; none if it ran away.
    fn settle(
        &mut self,
        relaxation: &Relaxation,
        dt: f64,
        load: &mut impl FnMut(&mut Elastic<D>),
    ) -> Result<Option<Relaxed>, RunError> {
        let n = self.len();
        let young = self.material.young() * STRAIN;
        let surface = 2.0 * (D as f64 - 1.0) / D as f64;
        let least = young * self.volumes.iter().map(|v| v.powf(surface)).sum::<f64>().sqrt();
        let mut before: Vec<Vector<D>> = vec![Vector::zeros(); n];
        let mut lowest = f64::INFINITY;
        let mut omega = 0.0;
        self.velocities.fill(Vector::zeros());
        for round in 0..=relaxation.rounds {
            load(self);
            let (mut net, mut loads, mut work, mut moving) = (0.0, 0.0, 0.0, 0.0);
            for (i, before) in before.iter_mut().enumerate() {
                let force = self.net(i);
                net += force.norm_squared();
                loads += self.loads[i].norm_squared();
                work += self.velocities[i].dot(&(*before - force));
                moving += self.velocities[i].norm_squared() * self.mass(i);
                *before = force;
            }
            let residual = net.sqrt() / loads.sqrt().max(least);
            if residual.is_nan() || residual > RUNAWAY * lowest {
                return Ok(None);
            }
            lowest = lowest.min(residual);
            if moving > 0.0 && work > 0.0 {
                omega = (work / (dt * moving)).sqrt();
            }
            if residual <= relaxation.tolerance {
                self.velocities.fill(Vector::zeros());
                let period = if omega > 0.0 { std::f64::consts::TAU / omega } else { 0.0 };
                return Ok(Some(Relaxed { residual, rounds: round, period }));
            }
            if round % LOOK == LOOK - 1 {
                let stretch = (0..n).map(|i| self.stretch(i)).fold(0.0, f64::max);
                if stretch > relaxation.stretch {
                    return Err(self.unbalanced("its largest stretch", stretch));
                }
            }
            let damp = (omega * dt).min(1.0);
            let density = self.material.density;
            for (i, force) in before.iter().enumerate() {
                if matches!(self.holds[i], Hold::Free) {
                    let pull = force * (dt / (density * self.volumes[i]));
                    let velocity = (self.velocities[i] * (1.0 - damp) + pull) / (1.0 + damp);
                    self.velocities[i] = velocity;
                    self.displacements[i] += velocity * dt;
                }
            }
            self.tally.particle_steps += n as u64;
            if self.strain().is_err() {
                // Overshot, or there is nothing to come to.
                return Ok(None);
            }
            self.pull();
        }
        Err(self.unbalanced("its least force left over its loads", lowest))
    }

    /// All forces on a particle that may move, N per unit thickness.
    fn net(&self, i: usize) -> Vector<D> {
        match self.holds[i] {
            Hold::Free => self.forces[i] + self.loads[i] + self.options.body_force * self.mass(i),
            _ => Vector::zeros(),
        }
    }

    fn unbalanced(&self, what: &str, value: f64) -> RunError {
        let widest =
            (0..self.len()).max_by(|&a, &b| self.stretch(a).total_cmp(&self.stretch(b))).unwrap_or(0);
        let at: Vec<String> = self.position(widest).iter().map(|x| format!("{x:.4e}")).collect();
        RunError::BlowUp {
            step: self.steps,
            time: self.time,
            particle: widest,
            quantity: format!(
                "no equilibrium: at ({}) m the solid is stretched {:.2} times; {what}",
                at.join(", "),
                self.stretch(widest)
            ),
            value,
            remedy: "a wall too soft for its load balloons: less turgor, less softening, a thicker wall, or a turgor \
                     with stiffness (a fixed amount of liquid)"
                .into(),
        }
    }
}
