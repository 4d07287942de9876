//! Diffusion of every species over one step on the frozen geometry.

use super::SplitState;
use super::frozen::Frozen;
use crate::chemistry::diffusion::{ALL, Bath, Jumps};
use crate::chemistry::reactor::{MOST_MOLECULES, Reactor};
use crate::error::RunError;

impl SplitState {
    /// Diffusion of all species from `time` over `dt` seconds, with what surfaces let through: an exact sample for
    /// discrete species, the exact exponential for continuous ones, whatever the length of the step. Held amounts emit
    /// at a constant rate, absorb what reaches them, and stay as they are; `supplied` books the difference. What passes
    /// a surface is booked as events of its reactions.
    ///
    /// # Errors
    /// An amount that is negative or not finite at the start of the step.
    pub fn diffuse(
        &mut self,
        reactor: &Reactor,
        frozen: &Frozen,
        time: f64,
        dt: f64,
    ) -> Result<(), RunError> {
        let species = reactor.species_count();
        for s in 0..species {
            let Some(table) = frozen.ways(s) else { continue };
            let (jumps, pieces) = Jumps::expected(reactor.diffusivity[s] * table.rate * dt);
            if jumps.tail.is_empty() {
                continue;
            }
            if let Some((voxel, &count)) =
                self.amounts.iter().skip(s).step_by(species).enumerate().find(|&(_, &n)| {
                    !(0.0..f64::INFINITY).contains(&n) || reactor.discrete[s] && n > MOST_MOLECULES
                })
            {
                if count > MOST_MOLECULES {
                    return Err(reactor.too_many(s, count, time, voxel));
                }
                let (species, event) =
                    (reactor.species[s].clone(), String::from("the start of a diffusion step"));
                return Err(RunError::NegativeCount { time, voxel, species, count, event });
            }
            let mut baths = frozen.baths(s, |h| self.emission(h * species + s));
            if reactor.discrete[s]
                && let Some(bath) = baths.iter().find(|bath| bath.mean > MOST_MOLECULES)
            {
                // Of a door, the first voxel that it sends into.
                let node = bath.node as usize;
                let door = table.row(node).next().filter(|_| node >= table.voxels());
                return Err(reactor.too_many(s, bath.mean, time, door.map_or(node, |(voxel, _)| voxel)));
            }
            if let Some(hybrid) = reactor.hybrid.as_ref().filter(|hybrid| hybrid.bit(s) != 0) {
                let k = hybrid.bit(s).trailing_zeros() as usize;
                for _ in 0..pieces {
                    self.diffuse_mixed((hybrid, frozen, table), k, &jumps, &baths);
                }
                continue;
            }
            for _ in 0..pieces {
                let state = (self.amounts.as_mut_slice(), s, species);
                if reactor.discrete[s] {
                    self.counters.hops +=
                        self.walkers.diffuse(table, &jumps, state, (&mut baths, ALL), &mut self.hops);
                } else {
                    self.flow.diffuse(table, &jumps, state, (&mut baths, ALL));
                }
            }
            self.book(frozen, s, &baths, reactor.discrete[s]);
        }
        Ok(())
    }

    /// Takes what the baths of species `s` sent and took into the books; `whole` molecules are events, and entering or
    /// leaving by a door is no hop.
    pub(super) fn book(&mut self, frozen: &Frozen, s: usize, baths: &[Bath], whole: bool) {
        self.supplied[s] += frozen.emitted(s, baths);
        for (r, door) in frozen.passed(s, baths) {
            let passed = door.sent + door.taken;
            if whole {
                self.fired[r] += passed as u64;
                self.counters.events += passed as u64;
                self.counters.hops -= passed as u64;
            } else {
                self.modes.add(r, passed);
            }
        }
    }
}
