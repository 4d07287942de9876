//! Reactions in every voxel over one step: sampled events by integrated hazards, continuous amounts by the
//! rate equations.

use super::frozen::Frozen;
use super::{Counters, SplitState};
use crate::chemistry::propensity::{Propensities, Scale};
use crate::chemistry::rate_equations::{Books, RateEquations, Voxel};
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
    /// between events and costs no random number in a step without an event. Where events depend on
    /// continuous amounts that react as well, ∫ a_0 dt is integrated along with the rate equations.
    ///
    /// # Errors
    /// A propensity that is negative or not finite, a count below zero, rate equations that fail.
    pub fn react(&mut self, reactor: &Reactor, frozen: &Frozen, time: f64, dt: f64) -> Result<(), RunError> {
        self.change_over(reactor, frozen);
        let species = reactor.species_count();
        for i in 0..frozen.voxels() {
            let mode = self.modes.of(i);
            let lists = &frozen.kinds[frozen.kind[i] as usize].lists[usize::from(mode)];
            if lists.sampled.is_empty() && lists.integrated.is_empty() {
                continue;
            }
            let row = i * species..(i + 1) * species;
            let held: &[bool] = if frozen.held.is_empty() { &[] } else { &frozen.held[row.clone()] };
            if lists.plain {
                let propensities = reactor.propensities_in(mode);
                let here = (&self.amounts[row.clone()], frozen.scales[i], held);
                let idle = hazard(propensities, &lists.sampled, here) * dt;
                if idle < self.clocks[i] {
                    self.clocks[i] -= idle;
                    continue;
                }
            }
            let voxel = Voxel {
                index: i,
                scale: frozen.scales[i],
                propensities: reactor.propensities_in(mode),
                integrated: &lists.integrated,
                sampled: &lists.sampled,
                weights: &frozen.weights,
                held,
            };
            let mut cell = Cell {
                reactor,
                voxel,
                amounts: &mut self.amounts[row],
                books: Books {
                    supplied: &mut self.supplied,
                    extents: self.modes.room(lists.integrated.len()),
                },
                propensities: &mut self.propensities,
                counters: &mut self.counters,
                fired: &mut self.fired,
                random: &mut self.reactions,
            };
            let clock = &mut self.clocks[i];
            if lists.integrated.is_empty() {
                cell.fire(clock, time, dt)?;
            } else if lists.coupled {
                cell.fire_along(&mut self.equations, clock, time, dt)?;
            } else {
                cell.integrate(&mut self.equations, time, dt)?;
                if !lists.sampled.is_empty() {
                    cell.fire(clock, time, dt)?;
                }
            }
            for &r in &lists.taking {
                self.withheld += cell.withheld(r as usize) * dt;
            }
            self.modes.book(i, &lists.integrated);
        }
        Ok(())
    }
}

/// Sum of the propensities of reactions that nothing but events changes; not a number if one is negative.
#[inline]
fn hazard(
    propensities: &Propensities,
    sampled: &[u32],
    (amounts, scale, held): (&[f64], Scale, &[bool]),
) -> f64 {
    let (mut total, mut least) = (0.0, 0.0_f64);
    for &r in sampled {
        let a = propensities.propensity_beside(r as usize, amounts, scale, held);
        total += a;
        least = if a < least { a } else { least };
    }
    if least < 0.0 { f64::NAN } else { total }
}

/// One voxel and what its events touch.
struct Cell<'a> {
    reactor: &'a Reactor,
    voxel: Voxel<'a>,
    amounts: &'a mut [f64],
    books: Books<'a>,
    propensities: &'a mut Vec<f64>,
    counters: &'a mut Counters,
    fired: &'a mut [u64],
    random: &'a mut Stream,
}

impl Cell<'_> {
    /// All events of the voxel within `dt`, nothing else changing; `clock` is the hazard left until the next.
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

    /// All events of the voxel within `dt` while the continuous amounts follow their rate equations.
    fn fire_along(
        &mut self,
        equations: &mut RateEquations,
        clock: &mut f64,
        time: f64,
        dt: f64,
    ) -> Result<(), RunError> {
        let mut left = dt;
        while left > 0.0 {
            let now = time + dt - left;
            let (amounts, books) = (&mut *self.amounts, &mut self.books);
            let span = (now, left);
            let Some(waited) = equations.advance(self.reactor, self.voxel, amounts, books, clock, span)?
            else {
                return Ok(());
            };
            left -= waited;
            *clock = exponential(self.random);
            let now = time + dt - left;
            let total = self.evaluate(now)?;
            if total > 0.0 {
                let r = self.choose(total);
                self.apply(r, now)?;
            }
        }
        Ok(())
    }

    /// The rate equations over `dt`, no event being due.
    fn integrate(&mut self, equations: &mut RateEquations, time: f64, dt: f64) -> Result<(), RunError> {
        let alone = Voxel { sampled: &[], ..self.voxel };
        let mut never = f64::INFINITY;
        let span = (time, dt);
        equations.advance(self.reactor, alone, self.amounts, &mut self.books, &mut never, span)?;
        Ok(())
    }

    /// Propensities of all sampled reactions of the voxel; returns their sum.
    fn evaluate(&mut self, time: f64) -> Result<f64, RunError> {
        let voxel = self.voxel;
        self.propensities.clear();
        let mut total = 0.0;
        for &r in voxel.sampled {
            let r = r as usize;
            let mut a = voxel.propensities.propensity_beside(r, self.amounts, voxel.scale, voxel.held);
            if !voxel.weights.is_empty() {
                a *= voxel.weight(r);
            }
            if !(0.0..f64::INFINITY).contains(&a) {
                return Err(self.reactor.bad_propensity(r, a, time, voxel.index, self.amounts));
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
        for (&r, &a) in self.voxel.sampled.iter().zip(self.propensities.iter()) {
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
        for &(s, change) in self.voxel.propensities.changes(r) {
            let s = s as usize;
            if self.voxel.held.get(s).copied().unwrap_or(false) {
                self.books.supplied[s] -= change; // the reservoir makes good what the reaction changed
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

    /// Rate at which reaction `r` would take a whole molecule out of a continuous amount that holds less.
    fn withheld(&self, r: usize) -> f64 {
        let voxel = &self.voxel;
        let short = voxel.propensities.changes(r).iter().any(|&(s, change)| {
            let s = s as usize;
            let held = voxel.held.get(s).copied().unwrap_or(false);
            !held && !voxel.propensities.whole(s) && self.amounts[s] + change < 0.0
        });
        if short { voxel.propensities.flux_at(r, self.amounts, voxel.scale) * voxel.weight(r) } else { 0.0 }
    }
}
