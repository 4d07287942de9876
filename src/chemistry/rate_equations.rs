//! The continuous species: reaction rate equations of one voxel, dn_s/dt = Σ_r change_sr v_r(n).
//!
//! Explicit Runge–Kutta of Dormand & Prince (1980), order 5 with an embedded order 4 for the step; a step
//! that would leave an amount below zero is taken again at half the length, never clipped.

use crate::chemistry::propensity::Scale;
use crate::chemistry::reactor::Reactor;
use crate::error::RunError;

/// Relative error allowed in a step.
const RELATIVE: f64 = 1e-9;
/// Error allowed in any case, molecules.
const ABSOLUTE: f64 = 1e-9;
/// Steps within one call after which the equations are taken to be stiff.
const MOST_STEPS: usize = 1_000_000;

/// Shortest step relative to the interval.
const SHORTEST: f64 = 1e-14;

const STAGES: usize = 7;
/// Dormand & Prince (1980), Table 2: coefficients a_ij row by row; the last row is the order 5 solution.
const A: [[f64; 6]; 6] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Order 5 less order 4.
const E: [f64; STAGES] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Work space of the integrator, reused from voxel to voxel.
#[derive(Clone, Debug, Default)]
pub struct RateEquations {
    slopes: [Vec<f64>; STAGES],
    /// Amounts the rates see.
    trial: Vec<f64>,
    /// Amounts at the start of a step, held ones drifting.
    state: Vec<f64>,
}

/// The voxel whose equations are solved.
#[derive(Clone, Copy, Debug)]
pub struct Voxel<'a> {
    /// For messages.
    pub index: usize,
    pub scale: Scale,
    /// Reactions to be integrated.
    pub reactions: &'a [u32],
    /// Species that are held, all species of the voxel; may be empty for none.
    pub held: &'a [bool],
}

impl RateEquations {
    /// Advances the `amounts` (molecules) of one voxel by `dt` seconds from `time`. Held amounts stay, and
    /// what reactions would have changed of them is taken from `supplied` (molecules by species).
    ///
    /// # Errors
    /// A rate that is not finite, and equations too stiff for the explicit method or driving an amount
    /// below zero (a rate law that consumes what is not there).
    pub fn advance(
        &mut self,
        reactor: &Reactor,
        voxel: Voxel,
        amounts: &mut [f64],
        supplied: &mut [f64],
        (time, dt): (f64, f64),
    ) -> Result<(), RunError> {
        let species = amounts.len();
        for slope in &mut self.slopes {
            slope.resize(species, 0.0);
        }
        self.trial.clear();
        self.trial.extend_from_slice(amounts);
        self.slope(0, reactor, voxel, time)?;
        if self.slopes[0].iter().all(|&f| f == 0.0) {
            return Ok(()); // at rest
        }
        self.state.clear();
        self.state.extend_from_slice(amounts);
        let is_held = |s: usize| voxel.held.get(s).copied().unwrap_or(false);
        let mut done = 0.0;
        let mut h = dt;
        for _ in 0..MOST_STEPS {
            let left = dt - done;
            let last = h >= left * (1.0 - 1e-12);
            if last {
                h = left;
            }
            let mut failed = None;
            for (stage, row) in A.iter().enumerate() {
                for s in 0..species {
                    if is_held(s) {
                        continue; // the rates see the held amount
                    }
                    let sum: f64 = row[..=stage].iter().zip(&self.slopes).map(|(a, k)| a * k[s]).sum();
                    self.trial[s] = self.state[s] + h * sum;
                }
                if let Err(error) = self.slope(stage + 1, reactor, voxel, time + done) {
                    failed = Some(error);
                    break;
                }
            }
            if let Some(error) = failed {
                // A stage of a step that was far too long can overflow; at a short one the rate is at fault.
                h *= 0.1;
                if h < SHORTEST * dt {
                    return Err(error);
                }
                continue;
            }
            let mut error: f64 = 0.0;
            let mut negative = false;
            for s in (0..species).filter(|&s| !is_held(s)) {
                let e: f64 = h * E.iter().zip(&self.slopes).map(|(e, k)| e * k[s]).sum::<f64>();
                let size = self.state[s].abs().max(self.trial[s].abs());
                error = error.max((e / (ABSOLUTE + RELATIVE * size)).abs());
                negative |= !(self.trial[s] >= 0.0 && e.is_finite());
            }
            if !negative && error <= 1.0 {
                for s in (0..species).filter(|&s| is_held(s)) {
                    let sum: f64 = A[5].iter().zip(&self.slopes).map(|(a, k)| a * k[s]).sum();
                    supplied[s] -= h * sum;
                }
                self.state.copy_from_slice(&self.trial);
                if last {
                    amounts.copy_from_slice(&self.state);
                    return Ok(());
                }
                done += h;
                self.slopes.swap(0, STAGES - 1); // first same as last
            }
            // The usual controller of order 5 with its safety factor; halved at least after a rejection.
            let factor = if error > 0.0 { 0.9 * error.powf(-0.2) } else { 5.0 };
            h *= if negative { factor.clamp(0.1, 0.5) } else { factor.clamp(0.2, 5.0) };
            if h < SHORTEST * dt {
                break;
            }
        }
        let remedy = String::from(
            "the rate equations are too stiff, or a rate law consumes a species that is used up; \
             check the law or make the species discrete",
        );
        let value = self.state.iter().copied().fold(f64::INFINITY, f64::min);
        let quantity = String::from("smallest amount (molecules)");
        Err(RunError::BlowUp { step: 0, time: time + done, particle: voxel.index, quantity, value, remedy })
    }

    /// slopes[stage] = dn/dt at the trial amounts.
    fn slope(&mut self, stage: usize, reactor: &Reactor, voxel: Voxel, time: f64) -> Result<(), RunError> {
        let slope = &mut self.slopes[stage];
        slope.fill(0.0);
        for &r in voxel.reactions {
            let r = r as usize;
            let flux = reactor.propensities.flux_at(r, &self.trial, voxel.scale);
            if !flux.is_finite() {
                return Err(reactor.bad_propensity(r, flux, time, voxel.index, &self.trial));
            }
            for &(s, change) in reactor.propensities.changes(r) {
                slope[s as usize] += change * flux;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::network::Kinetics;
    use crate::chemistry::reactor::example::{Equation, network};

    fn solve(reactions: &[Equation], start: &[f64], held: &[bool], t: f64) -> (Vec<f64>, Vec<f64>) {
        let network = network(Kinetics::Molecules, start.len(), reactions);
        let reactor = Reactor::everywhere(&network, &vec![false; start.len()]);
        let all: Vec<u32> = (0..reactions.len() as u32).collect();
        let voxel = Voxel { index: 0, scale: Scale::of(1.0), reactions: &all, held };
        let mut amounts = start.to_vec();
        let mut supplied = vec![0.0; start.len()];
        RateEquations::default().advance(&reactor, voxel, &mut amounts, &mut supplied, (0.0, t)).unwrap();
        (amounts, supplied)
    }

    #[test]
    fn closed_forms() {
        // Relative error 1e-9 per step, some tens of steps.
        let (n, _) = solve(&[(&[(0, 1)], &[(1, 1)], 2.0)], &[100.0, 0.0], &[], 3.0);
        assert!(
            (n[0] / (100.0 * (-6.0_f64).exp()) - 1.0).abs() < 1e-7 && (n[0] + n[1] - 100.0).abs() < 1e-11
        );
        // 2 A -> 0 at c: dA/dt = -c A² (change -2, c A²/2): A = A0 / (1 + c A0 t).
        let (n, _) = solve(&[(&[(0, 2)], &[], 0.1)], &[50.0], &[], 4.0);
        assert!((n[0] - 50.0 / 21.0).abs() < 1e-7);
        let (n, _) = solve(&[(&[], &[(0, 1)], 7.0)], &[0.0], &[], 2.0);
        assert!((n[0] - 14.0).abs() < 1e-12);
    }

    #[test]
    fn a_first_step_that_is_far_too_long_is_shortened() {
        // A + B -> 0 from equal amounts: 1 / (1/A0 + c t), here 1e9 times the initial time scale long.
        let (n, _) = solve(&[(&[(0, 1), (1, 1)], &[], 1e3)], &[1e6, 1e6], &[], 1.0);
        assert!((n[0] * 1e3 - 1.0).abs() < 1e-5, "{n:?}");
    }

    #[test]
    fn long_decay_stays_positive() {
        let (n, _) = solve(&[(&[(0, 1)], &[], 1.0)], &[1000.0], &[], 200.0);
        assert!(n[0] >= 0.0 && n[0] < 1e-9);
    }

    #[test]
    fn held_amounts_are_supplied() {
        let (n, supplied) = solve(&[(&[(0, 1)], &[(1, 1)], 0.5)], &[10.0, 0.0], &[true, false], 2.0);
        assert_eq!(n[0], 10.0);
        assert!((n[1] - 10.0).abs() < 1e-9 && (supplied[0] - 10.0).abs() < 1e-9);
    }
}
