//! Reactions in every voxel over one step: sampled events by integrated hazards, continuous amounts by the
//! rate equations.

use super::frozen::Frozen;
use super::{Counters, SplitState};
use crate::chemistry::rate_equations::Voxel;
use crate::chemistry::reactor::Reactor;
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::Stream;
use rand::Rng;

impl SplitState {
    /// Reactions of all voxels from `time` over `dt` seconds.
    ///
    /// Each voxel carries a unit exponential R from step to step and loses a_0 dt of it; it fires when R
    /// is used up (modified next reaction method, Anderson 2007), which is exact for propensities constant
    /// between events and costs no random number in a step without an event. Where continuous amounts
    /// react too, events are framed by two half steps of the rate equations (second order).
    ///
    /// # Errors
    /// A propensity that is negative or not finite, a count below zero, rate equations that fail.
    pub fn react(&mut self, reactor: &Reactor, frozen: &Frozen, time: f64, dt: f64) -> Result<(), RunError> {
        let species = reactor.species_count();
        for i in 0..frozen.voxels() {
            let kind = &frozen.kinds[frozen.kind[i] as usize];
            if kind.sampled.is_empty() && kind.integrated.is_empty() {
                continue;
            }
            let row = i * species..(i + 1) * species;
            let held: &[bool] = if frozen.held.is_empty() { &[] } else { &frozen.held[row.clone()] };
            let amounts = &mut self.amounts[row];
            let scale = frozen.scales[i];
            let equations = Voxel { index: i, scale, reactions: &kind.integrated, held };
            if kind.sampled.is_empty() {
                self.equations.advance(reactor, equations, amounts, &mut self.supplied, (time, dt))?;
                continue;
            }
            if !kind.integrated.is_empty() {
                self.equations.advance(reactor, equations, amounts, &mut self.supplied, (time, 0.5 * dt))?;
            }
            let mut cell = Cell {
                reactor,
                voxel: Voxel { reactions: &kind.sampled, ..equations },
                amounts,
                supplied: &mut self.supplied,
                propensities: &mut self.propensities,
                counters: &mut self.counters,
                fired: &mut self.fired,
                random: &mut self.reactions,
            };
            cell.fire(&mut self.clocks[i], time, dt)?;
            if !kind.integrated.is_empty() {
                let half = (time + 0.5 * dt, 0.5 * dt);
                self.equations.advance(reactor, equations, amounts, &mut self.supplied, half)?;
            }
        }
        Ok(())
    }
}

/// One voxel and what its events touch.
struct Cell<'a> {
    reactor: &'a Reactor,
    voxel: Voxel<'a>,
    amounts: &'a mut [f64],
    supplied: &'a mut [f64],
    propensities: &'a mut Vec<f64>,
    counters: &'a mut Counters,
    fired: &'a mut [u64],
    random: &'a mut Stream,
}

impl Cell<'_> {
    /// All events of the voxel within `dt`; `clock` is the hazard left until the next one.
    fn fire(&mut self, clock: &mut f64, time: f64, dt: f64) -> Result<(), RunError> {
        let mut left = dt;
        let mut total = self.evaluate(time)?;
        while total * left >= *clock {
            left -= *clock / total;
            *clock = exponential(self.random);
            let now = time + dt - left;
            let r = self.choose(total);
            self.apply(r, now)?;
            total = self.evaluate(now)?;
        }
        *clock -= total * left;
        Ok(())
    }

    /// Propensities of all reactions of the voxel; returns their sum.
    fn evaluate(&mut self, time: f64) -> Result<f64, RunError> {
        let (reactor, voxel) = (self.reactor, self.voxel);
        self.propensities.clear();
        let mut total = 0.0;
        for &r in voxel.reactions {
            let a = reactor.propensities.propensity_at(r as usize, self.amounts, voxel.scale);
            if !(0.0..f64::INFINITY).contains(&a) {
                return Err(reactor.bad_propensity(r as usize, a, time, voxel.index, self.amounts));
            }
            self.propensities.push(a);
            total += a;
        }
        Ok(total)
    }

    /// A reaction with chance a_r / a_0.
    fn choose(&mut self, total: f64) -> usize {
        let mut left = self.random.random::<f64>() * total;
        let mut chosen = 0;
        for (&r, &a) in self.voxel.reactions.iter().zip(self.propensities.iter()) {
            if a > 0.0 {
                chosen = r as usize; // also the last possible one, should rounding leave a sliver
                if left < a {
                    break;
                }
                left -= a;
            }
        }
        chosen
    }

    fn apply(&mut self, r: usize, time: f64) -> Result<(), RunError> {
        for &(s, change) in self.reactor.propensities.changes(r) {
            let s = s as usize;
            if self.voxel.held.get(s).copied().unwrap_or(false) {
                self.supplied[s] -= change; // the reservoir makes good what the reaction changed
                continue;
            }
            let count = self.amounts[s] + change;
            if count < 0.0 {
                return Err(self.reactor.negative_count(s, count, r, time, self.voxel.index));
            }
            self.amounts[s] = count;
        }
        self.counters.events += 1;
        self.fired[r] += 1;
        Ok(())
    }
}
