//! The continuous species: reaction rate equations of one voxel, dn_s/dt = Σ_r change_sr v_r(n), and the hazard
//! of events that depend on them, ∫ a_0(n) dt (a piecewise deterministic process, Davis 1984).
//!
//! Explicit Runge–Kutta of Dormand & Prince (1980), order 5 with an embedded order 4 for the step; a step
//! that would leave an amount below zero is taken again at half the length, never clipped.

use crate::chemistry::propensity::{Propensities, Scale};
use crate::chemistry::reactor::Reactor;
use crate::error::RunError;

/// Relative error allowed in a step.
const RELATIVE: f64 = 1e-9;
/// Error allowed in any case, molecules, and of the hazard at which an event falls.
const ABSOLUTE: f64 = 1e-9;
/// How much more is allowed between events, whose chance outweighs it by far.
const BETWEEN_EVENTS: f64 = 1e3;
/// Steps within one call after which the equations are taken to be stiff.
const MOST_STEPS: usize = 1_000_000;

/// Points tried at most to find when an event falls.
const MOST_HALVINGS: usize = 100;

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
///
/// The state is the amounts of all species, then the hazard of the sampled reactions (∫ a_0 dt), then the extent
/// of each integrated reaction (∫ v dt, events).
#[derive(Clone, Debug, Default)]
pub struct RateEquations {
    slopes: [Vec<f64>; STAGES],
    /// What the rates see.
    trial: Vec<f64>,
    /// At the start of a step; held amounts stay.
    state: Vec<f64>,
}

/// The voxel whose equations are solved.
#[derive(Clone, Copy, Debug)]
pub struct Voxel<'a> {
    /// For messages.
    pub index: usize,
    pub scale: Scale,
    pub propensities: &'a Propensities,
    /// Reactions to be integrated.
    pub integrated: &'a [u32],
    /// Reactions whose hazard is to be integrated along; may be empty.
    pub sampled: &'a [u32],
    /// Factor of the propensities of some reactions by voxel, as in [`crate::chemistry::split::Frozen`].
    pub weights: &'a [Vec<f64>],
    /// Species that are held, all species of the voxel; may be empty for none.
    pub held: &'a [bool],
}

impl Voxel<'_> {
    /// Factor of the propensity of a reaction.
    #[inline]
    #[must_use]
    pub fn weight(&self, r: usize) -> f64 {
        match self.weights.get(r) {
            Some(row) if !row.is_empty() => row[self.index],
            _ => 1.0,
        }
    }

    fn is_held(&self, s: usize) -> bool {
        self.held.get(s).copied().unwrap_or(false)
    }
}

/// What integration adds to.
#[derive(Debug)]
pub struct Books<'a> {
    /// Net molecules of each species brought in by held amounts.
    pub supplied: &'a mut [f64],
    /// Events of each integrated reaction of the voxel, in their order; may be empty if nobody asks.
    pub extents: &'a mut [f64],
}

/// A step tried.
enum Try {
    /// Error relative to the one allowed, and whether an amount fell below zero.
    Done { error: f64, negative: bool },
    /// A rate was not finite.
    Failed(RunError),
}

impl RateEquations {
    /// Advances the `amounts` (molecules) of one voxel by `dt` seconds from `time`, or until the hazard of the
    /// sampled reactions has used up `clock`: returns the time that took, or `None` and lowers the clock. Held
    /// amounts stay, and what reactions would have changed of them is booked.
    ///
    /// # Errors
    /// A rate that is not finite, and equations too stiff for the explicit method or driving an amount
    /// below zero (a rate law that consumes what is not there).
    pub fn advance(
        &mut self,
        reactor: &Reactor,
        voxel: Voxel,
        amounts: &mut [f64],
        books: &mut Books,
        clock: &mut f64,
        (time, dt): (f64, f64),
    ) -> Result<Option<f64>, RunError> {
        let species = amounts.len();
        let length = species + 1 + books.extents.len();
        for slope in &mut self.slopes {
            slope.resize(length, 0.0);
        }
        self.trial.clear();
        self.trial.extend_from_slice(amounts);
        self.trial.resize(length, 0.0);
        self.slope(0, reactor, voxel, species, time)?;
        if self.slopes[0][..species].iter().all(|&f| f == 0.0) && books.extents.is_empty() {
            // At rest: the hazard is constant.
            let hazard = self.slopes[0][species];
            if hazard * dt >= *clock {
                return Ok(Some(*clock / hazard));
            }
            *clock -= hazard * dt;
            return Ok(None);
        }
        self.state.clone_from(&self.trial);
        let mut done = 0.0;
        let mut h = dt;
        for _ in 0..MOST_STEPS {
            let left = dt - done;
            let last = h >= left * (1.0 - 1e-12);
            if last {
                h = left;
            }
            let (error, negative) = match self.attempt(reactor, voxel, species, h, time + done) {
                Try::Done { error, negative } => (error, negative),
                Try::Failed(error) => {
                    // A stage of a step that was far too long can overflow; at a short one the rate is at fault.
                    h *= 0.1;
                    if h < SHORTEST * dt {
                        return Err(error);
                    }
                    continue;
                }
            };
            if !negative && error <= 1.0 {
                let fires = self.trial[species] >= *clock;
                if fires {
                    h = self.find(reactor, voxel, species, (*clock, h), time + done)?;
                } else {
                    *clock -= self.trial[species];
                }
                self.book(voxel, species, h, books);
                self.trial[species] = 0.0;
                if last || fires {
                    amounts.copy_from_slice(&self.trial[..species]);
                    for (sum, extent) in books.extents.iter_mut().zip(&self.trial[species + 1..]) {
                        *sum += extent;
                    }
                    return Ok(fires.then_some(done + h));
                }
                std::mem::swap(&mut self.state, &mut self.trial);
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
        let value = self.state[..species].iter().copied().fold(f64::INFINITY, f64::min);
        let quantity = String::from("smallest amount (molecules)");
        Err(RunError::BlowUp { step: 0, time: time + done, particle: voxel.index, quantity, value, remedy })
    }

    /// One step of length `h` from `state` into `trial`.
    fn attempt(&mut self, reactor: &Reactor, voxel: Voxel, species: usize, h: f64, time: f64) -> Try {
        for (stage, row) in A.iter().enumerate() {
            for s in 0..self.state.len() {
                if s < species && voxel.is_held(s) {
                    self.trial[s] = self.state[s];
                    continue; // the rates see the held amount
                }
                let sum: f64 = row[..=stage].iter().zip(&self.slopes).map(|(a, k)| a * k[s]).sum();
                self.trial[s] = self.state[s] + h * sum;
            }
            if let Err(error) = self.slope(stage + 1, reactor, voxel, species, time) {
                return Try::Failed(error);
            }
        }
        let mut error: f64 = 0.0;
        let mut negative = false;
        let slack = if voxel.sampled.is_empty() { 1.0 } else { BETWEEN_EVENTS };
        // Extents follow from the rates that the amounts decide.
        for s in (0..=species).filter(|&s| !voxel.is_held(s)) {
            let e: f64 = h * E.iter().zip(&self.slopes).map(|(e, k)| e * k[s]).sum::<f64>();
            let size = self.state[s].abs().max(self.trial[s].abs());
            error = error.max((e / (slack * (ABSOLUTE + RELATIVE * size))).abs());
            negative |= !(self.trial[s] >= 0.0 && e.is_finite());
        }
        Try::Done { error, negative }
    }

    /// The length of the step from `state`, at most `longest`, at whose end the hazard is `clock`; `trial` is
    /// then the state there. By false position with Illinois' halving of the end that stays (Dowell & Jarratt
    /// 1971), each point a step of its own.
    fn find(
        &mut self,
        reactor: &Reactor,
        voxel: Voxel,
        species: usize,
        (clock, longest): (f64, f64),
        time: f64,
    ) -> Result<f64, RunError> {
        let (mut low, mut below) = (0.0, -clock);
        let (mut high, mut above) = (longest, self.trial[species] - clock);
        let mut h = longest;
        for _ in 0..MOST_HALVINGS {
            if above.abs() <= ABSOLUTE && h == high || high - low <= SHORTEST * longest {
                break;
            }
            h = (low * above - high * below) / (above - below);
            h = h.clamp(low, high);
            if let Try::Failed(error) = self.attempt(reactor, voxel, species, h, time) {
                return Err(error);
            }
            let off = self.trial[species] - clock;
            if off.abs() <= ABSOLUTE {
                break;
            }
            if off < 0.0 {
                (low, below) = (h, off);
                above *= 0.5;
            } else {
                (high, above) = (h, off);
                below *= 0.5;
            }
        }
        Ok(h)
    }

    /// Books what held amounts gave in the step just accepted.
    fn book(&self, voxel: Voxel, species: usize, h: f64, books: &mut Books) {
        for s in (0..species).filter(|&s| voxel.is_held(s)) {
            let sum: f64 = A[5].iter().zip(&self.slopes).map(|(a, k)| a * k[s]).sum();
            books.supplied[s] -= h * sum;
        }
    }

    /// slopes[stage] = rate of change at the trial state.
    fn slope(
        &mut self,
        stage: usize,
        reactor: &Reactor,
        voxel: Voxel,
        species: usize,
        time: f64,
    ) -> Result<(), RunError> {
        let (slope, amounts) = (&mut self.slopes[stage], &self.trial[..species]);
        slope.fill(0.0);
        for (k, &r) in voxel.integrated.iter().enumerate() {
            let r = r as usize;
            let flux = voxel.propensities.flux_at(r, amounts, voxel.scale) * voxel.weight(r);
            // A trial state may lie below zero, and its rates too; then the step is shortened for the amounts.
            let backward = flux < 0.0 && amounts.iter().all(|&n| n >= 0.0);
            if !flux.is_finite() || backward {
                return Err(reactor.bad_propensity(r, flux, time, voxel.index, amounts));
            }
            for &(s, change) in voxel.propensities.changes(r) {
                slope[s as usize] += change * flux;
            }
            if let Some(extent) = slope.get_mut(species + 1 + k) {
                *extent = flux;
            }
        }
        for &r in voxel.sampled {
            let r = r as usize;
            let a =
                voxel.propensities.propensity_beside(r, amounts, voxel.scale, voxel.held) * voxel.weight(r);
            if !a.is_finite() {
                return Err(reactor.bad_propensity(r, a, time, voxel.index, amounts));
            }
            slope[species] += a;
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
        let voxel = Voxel { integrated: &all, held, ..voxel(&reactor) };
        let mut amounts = start.to_vec();
        let mut supplied = vec![0.0; start.len()];
        let mut books = Books { supplied: &mut supplied, extents: &mut [] };
        let mut never = f64::INFINITY;
        let fired =
            RateEquations::default().advance(&reactor, voxel, &mut amounts, &mut books, &mut never, (0.0, t));
        assert_eq!(fired.unwrap(), None);
        (amounts, supplied)
    }

    fn voxel(reactor: &Reactor) -> Voxel<'_> {
        Voxel {
            index: 0,
            scale: Scale::of(1.0),
            propensities: &reactor.propensities,
            integrated: &[],
            sampled: &[],
            weights: &[],
            held: &[],
        }
    }

    #[test]
    fn the_hazard_of_a_decaying_amount_stops_the_clock() {
        // S0 -> 0 continuous at 2; S0 + S1 -> S0 sampled at 0.3: a_0 = 0.3 * 50 e^{-2t} * 4, whose integral
        // is 30 (1 - e^{-2t}); a clock of 12 runs out at t = ln(30 / 18) / 2.
        let equations: [Equation; 2] = [(&[(0, 1)], &[], 2.0), (&[(0, 1), (1, 1)], &[(0, 1)], 0.3)];
        let reactor = Reactor::everywhere(&network(Kinetics::Molecules, 2, &equations), &[false, true]);
        let voxel = Voxel { integrated: &[0], sampled: &[1], ..voxel(&reactor) };
        // Errors allowed between events: 1e-6 of the amount and of the hazard in each of some steps.
        let expected = 0.5 * (30.0_f64 / 18.0).ln();
        let run = |clock: &mut f64, dt: f64| {
            let (mut amounts, mut extents) = (vec![50.0, 4.0], [0.0]);
            let mut books = Books { supplied: &mut [0.0; 2], extents: &mut extents };
            let mut equations = RateEquations::default();
            let time =
                equations.advance(&reactor, voxel, &mut amounts, &mut books, clock, (0.0, dt)).unwrap();
            // What left is what the extent says.
            assert!((50.0 - amounts[0] - extents[0]).abs() < 1e-9);
            (time, amounts[0])
        };
        for dt in [0.3, 1.0, 50.0] {
            let (time, left) = run(&mut 12.0, dt);
            let time = time.unwrap();
            assert!((time - expected).abs() < 1e-6, "{dt}: {time}");
            assert!((left - 30.0).abs() < 1e-4);
        }
        // A step that ends before leaves the rest on the clock.
        let mut clock = 12.0;
        assert_eq!(run(&mut clock, 0.1).0, None);
        assert!((clock - (12.0 - 30.0 * (1.0 - (-0.2_f64).exp()))).abs() < 1e-5);
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
