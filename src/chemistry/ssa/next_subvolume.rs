//! The next subvolume method on a graph of voxels (Elf & Ehrenberg 2004): hops are events like reactions.
//!
//! Every voxel has the time of its next event in an indexed heap; the earliest one fires, by a reaction or
//! by a hop i -> j at rate D G_ij / V_i per molecule. A voxel that receives a molecule has its waiting time
//! rescaled by the ratio of its rates (Gibson & Bruck 2000), which spares a random number.

use super::channels::{Channels, choose};
use super::heap::TimeHeap;
use super::{EventMethod, Key, Ledger, System};
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};
use rand::Rng;

/// One realization.
#[derive(Clone, Debug)]
pub struct NextSubvolume<'a> {
    channels: Channels<'a>,
    /// Sum of the rates of each voxel.
    totals: Vec<f64>,
    heap: TimeHeap,
    random: Stream,
}

impl<'a> NextSubvolume<'a> {
    /// Starts from `amounts` (molecules, voxel by voxel).
    ///
    /// # Errors
    /// A propensity that is negative or not finite at the start.
    pub fn new(system: &'a System<'a>, amounts: Vec<f64>, key: Key) -> Result<NextSubvolume<'a>, RunError> {
        let channels = Channels::new(system, amounts)?;
        let totals: Vec<f64> = (0..channels.voxels()).map(|voxel| channels.row(voxel).iter().sum()).collect();
        let mut random = stream(key.0, key.1, Purpose::Reactions);
        let times: Vec<f64> = totals.iter().map(|&total| waiting(&mut random, 0.0, total)).collect();
        Ok(NextSubvolume { channels, totals, heap: TimeHeap::new(&times), random })
    }

    /// The waiting time of a voxel whose rates were changed from outside.
    fn rescale(&mut self, voxel: usize) {
        let time = self.channels.ledger.time;
        let after = self.channels.row(voxel).iter().sum();
        let before = std::mem::replace(&mut self.totals[voxel], after);
        let next = if before > 0.0 && after > 0.0 {
            time + (self.heap.time(voxel) - time) * (before / after)
        } else {
            waiting(&mut self.random, time, after)
        };
        self.heap.set(voxel, next);
    }

    fn fire(&mut self, voxel: usize) -> Result<(), RunError> {
        let column = choose(self.channels.row(voxel), self.totals[voxel], self.random.random());
        if let Some(other) = self.channels.fire(voxel, column, &mut self.random)? {
            self.rescale(other);
        }
        self.totals[voxel] = self.channels.row(voxel).iter().sum();
        let next = waiting(&mut self.random, self.channels.ledger.time, self.totals[voxel]);
        self.heap.set(voxel, next);
        Ok(())
    }
}

/// Time of the next event of a voxel, drawn anew.
fn waiting(random: &mut Stream, time: f64, total: f64) -> f64 {
    if total > 0.0 { time + exponential(random) / total } else { f64::INFINITY }
}

impl EventMethod for NextSubvolume<'_> {
    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        while let Some((voxel, time)) = self.heap.first() {
            if time > until {
                break;
            }
            self.channels.ledger.time = time;
            self.fire(voxel)?;
        }
        self.channels.ledger.time = self.channels.ledger.time.max(until);
        Ok(())
    }

    fn ledger(&self) -> &Ledger {
        &self.channels.ledger
    }
}
