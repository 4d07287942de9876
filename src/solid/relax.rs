//! Quasi-static equilibrium by dynamic relaxation (Underwood 1983).
//!
//! The solid moves in a fictitious time under its internal forces and loads, damped critically for the mode it is moving
//! in: ω² = -v·ΔF/(Δt v·M v), the Rayleigh quotient of the last step, and c = 2ω. Damping is proportional to mass, so
//! centre and angle of a free body stay. As masses are real, 2π/ω with the smallest ω of all rounds is the period of the
//! slowest mode that took part: the mechanical time, to be compared with that of the chemistry.

use crate::error::RunError;
use crate::solid::elastic::{Elastic, Hold};
use crate::solid::unbalanced::Lost;
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
    /// Fictitious time it took, s: what is slower took no part.
    pub lasted: f64,
    /// Period of the slowest mode that took part, s; zero if nothing moved.
    pub period: f64,
}

/// Rounds between looks at the stretches.
const LOOK: u32 = 100;
/// Without loads forces are measured against those of this strain.
const STRAIN: f64 = 1e-4;
/// Growth of the residual beyond which the step was too long.
const RUNAWAY: f64 = 1e3;
/// Change of all forces in a round, over the loads, below which it is rounding and tells of no mode.
const ROUNDING: f64 = 1e-9;
/// Steps that are tried one after the other, each half the one before.
const TRIES: u32 = 4;
/// Rounds over which loads come up in the last attempt of all.
const SLOWLY: u32 = 4000;
/// Part of the loads with which it is seen whether they are what it gives way to.
const EASED: f64 = 0.25;

/// How loads come up over the rounds.
#[derive(Clone, Copy)]
enum Rise {
    /// This part of them from the first round on.
    At(f64),
    /// All of them, slowly from this size, N per unit thickness.
    From(f64),
}

impl<const D: usize> Elastic<D> {
    /// Relaxes to equilibrium in steps of `*step` (s, as of [`Elastic::step_limit`]; zero: to be found). `load` sets the
    /// loads for the displacements of the moment. What cannot be reached with the loads all at once is tried with loads that
    /// rise slowly from those of before.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] where there is no equilibrium, with the reason: it gives way to its load, a particle is turned
    /// inside out, or the tolerance is out of reach.
    pub fn relax(
        &mut self,
        relaxation: &Relaxation,
        step: &mut f64,
        mut load: impl FnMut(&mut Elastic<D>),
    ) -> Result<Relaxed, RunError> {
        if *step <= 0.0 {
            *step = self.step_limit()?;
        }
        let (start, longest) = (self.displacements.clone(), *step);
        let before = self.loads.iter().map(Vector::norm_squared).sum::<f64>().sqrt();
        let mut found = None;
        for _ in 0..TRIES {
            match self.settle(relaxation, (*step, Rise::At(1.0)), &mut load) {
                Ok(relaxed) => return Ok(relaxed),
                // The fastest mode has become faster.
                Err(Lost::Inverted { .. } | Lost::Runaway { .. }) => {
                    self.go_back(&start)?;
                    *step *= 0.5;
                }
                Err(lost) => {
                    found = Some(lost);
                    break;
                }
            }
        }
        let lost = match found {
            Some(lost) => lost,
            None => {
                *step = 0.5 * longest;
                match self.settle(relaxation, (*step, Rise::From(before)), &mut load) {
                    Ok(relaxed) => return Ok(relaxed),
                    Err(lost) => lost,
                }
            }
        };
        if !lost.asks_for_less() {
            return Err(self.unbalanced(lost, false, relaxation));
        }
        let (there, strains) = (std::mem::take(&mut self.displacements), self.strains.clone());
        self.displacements = start.clone();
        self.go_back(&start)?;
        let fewer = Relaxation { rounds: relaxation.rounds / 4, ..*relaxation };
        let eases = self.settle(&fewer, (*step, Rise::At(EASED)), &mut load).is_ok();
        (self.displacements, self.strains) = (there, strains);
        Err(self.unbalanced(lost, eases, relaxation))
    }

    /// The displacements of before and their forces.
    fn go_back(&mut self, to: &[Vector<D>]) -> Result<(), RunError> {
        self.displacements.copy_from_slice(to);
        self.strain()?;
        self.pull();
        Ok(())
    }

    /// One attempt in steps of `dt` (s).
    fn settle(
        &mut self,
        relaxation: &Relaxation,
        (dt, rise): (f64, Rise),
        load: &mut impl FnMut(&mut Elastic<D>),
    ) -> Result<Relaxed, Lost> {
        let n = self.len();
        let young = self.material.young() * STRAIN;
        let surface = 2.0 * (D as f64 - 1.0) / D as f64;
        let least = young * self.volumes.iter().map(|v| v.powf(surface)).sum::<f64>().sqrt();
        let mut before: Vec<Vector<D>> = vec![Vector::zeros(); n];
        let (mut lowest, mut slowest) = (f64::INFINITY, f64::INFINITY);
        let (mut omega, mut halfway) = (0.0, f64::INFINITY);
        self.velocities.fill(Vector::zeros());
        for round in 0..=relaxation.rounds {
            load(self);
            let risen = self.raise(rise, round);
            let rising = risen < 1.0 && matches!(rise, Rise::From(_));
            let (mut net, mut loads, mut work, mut moving, mut change) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for (i, before) in before.iter_mut().enumerate() {
                let force = self.net(i);
                net += force.norm_squared();
                loads += self.loads[i].norm_squared();
                work += self.velocities[i].dot(&(*before - force));
                change += (*before - force).norm_squared();
                moving += self.velocities[i].norm_squared() * self.mass(i);
                *before = force;
            }
            let scale = loads.sqrt().max(least);
            let residual = net.sqrt() / scale;
            if residual.is_nan() || residual > RUNAWAY * lowest {
                return Err(Lost::Runaway { risen });
            }
            if !rising {
                lowest = lowest.min(residual);
            }
            if moving > 0.0 && work > 0.0 {
                omega = (work / (dt * moving)).sqrt();
                if change.sqrt() > ROUNDING * scale {
                    slowest = slowest.min(omega);
                }
            }
            if residual <= relaxation.tolerance && !rising {
                self.velocities.fill(Vector::zeros());
                let lasted = f64::from(round) * dt;
                // In a quarter of its period a mode comes half way; what is slower than that hardly moved.
                let period = (std::f64::consts::TAU / slowest).min(4.0 * lasted);
                return Ok(Relaxed { residual, rounds: round, lasted, period });
            }
            if round % LOOK == LOOK - 1 && self.widest().1 > relaxation.stretch {
                return Err(Lost::Wide);
            }
            if round == relaxation.rounds / 2 {
                halfway = self.widest().1;
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
            if let Err(inverted) = self.strain() {
                // Overshot, or there is nothing to come to.
                return Err(Lost::Inverted { error: Box::new(inverted), risen });
            }
            self.pull();
        }
        Err(Lost::Restless { lowest, halfway })
    }

    /// Lowers the loads to what they have risen to in a round; that part of them.
    fn raise(&mut self, rise: Rise, round: u32) -> f64 {
        let part = match rise {
            Rise::At(part) => part,
            Rise::From(_) if round >= SLOWLY => 1.0,
            Rise::From(before) => {
                let all = self.loads.iter().map(Vector::norm_squared).sum::<f64>().sqrt();
                let first = if all > 0.0 { (before / all).min(1.0) } else { 1.0 };
                first + (1.0 - first) * f64::from(round) / f64::from(SLOWLY)
            }
        };
        if part < 1.0 {
            self.loads.iter_mut().for_each(|load| *load *= part);
        }
        part
    }

    /// All forces on a particle that may move, N per unit thickness.
    fn net(&self, i: usize) -> Vector<D> {
        match self.holds[i] {
            Hold::Free => self.forces[i] + self.loads[i] + self.options.body_force * self.mass(i),
            _ => Vector::zeros(),
        }
    }
}
