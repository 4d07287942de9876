//! The next reaction method (Gibson & Bruck 2000): every channel has a time of its own in an indexed heap,
//! and after an event only those times are touched whose rate changed; the time a channel has left is rescaled
//! by the ratio of its rates, which spares a random number.

use super::channels::Channels;
use super::heap::TimeHeap;
use super::{EventMethod, Key, Ledger, System};
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};

/// One realization.
#[derive(Clone, Debug)]
pub struct NextReaction<'a> {
    channels: Channels<'a>,
    heap: TimeHeap,
    random: Stream,
}

impl<'a> NextReaction<'a> {
    /// Starts from `amounts` (molecules, voxel by voxel).
    ///
    /// # Errors
    /// A propensity that is negative or not finite at the start.
    pub fn new(system: &'a System<'a>, amounts: Vec<f64>, key: Key) -> Result<NextReaction<'a>, RunError> {
        let channels = Channels::new(system, amounts)?;
        let mut random = stream(key.0, key.1, Purpose::Reactions);
        let times: Vec<f64> = channels.rates.iter().map(|&rate| waiting(&mut random, 0.0, rate)).collect();
        Ok(NextReaction { channels, heap: TimeHeap::new(&times), random })
    }

    /// The event of `channel`, at `time`.
    fn fire(&mut self, channel: usize, time: f64) -> Result<(), RunError> {
        let width = self.channels.width;
        self.channels.ledger.time = time;
        self.channels.fire(channel / width, channel % width, &mut self.random)?;
        for &(k, before) in &self.channels.changed {
            let k = k as usize;
            if k == channel {
                continue;
            }
            let after = self.channels.rates[k];
            let next = if before <= 0.0 || after <= 0.0 {
                waiting(&mut self.random, time, after)
            } else {
                time + (self.heap.time(k) - time) * (before / after)
            };
            self.heap.set(k, next);
        }
        // The channel itself always waits anew, also where its rate stayed (a source).
        let next = waiting(&mut self.random, time, self.channels.rates[channel]);
        self.heap.set(channel, next);
        Ok(())
    }
}

fn waiting(random: &mut Stream, time: f64, rate: f64) -> f64 {
    if rate > 0.0 { time + exponential(random) / rate } else { f64::INFINITY }
}

impl EventMethod for NextReaction<'_> {
    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        while let Some((channel, time)) = self.heap.first() {
            if time > until {
                break;
            }
            self.fire(channel, time)?;
        }
        self.channels.ledger.time = self.channels.ledger.time.max(until);
        Ok(())
    }

    fn ledger(&self) -> &Ledger {
        &self.channels.ledger
    }
}
