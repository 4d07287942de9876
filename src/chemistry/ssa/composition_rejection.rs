//! Composition and rejection (Slepoy, Thompson & Plimpton 2008): channels are grouped by the power of two
//! below their rate; a group is chosen by its sum, a channel within it by rejection. The cost of an event
//! does not grow with the number of channels.
//!
//! The sums of the groups are kept as whole numbers, exactly; the paper's sums of rounded numbers drift.

use super::channels::Channels;
use super::groups::Groups;
use super::{EventMethod, Key, Ledger, System};
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};

/// One realization.
#[derive(Clone, Debug)]
pub struct CompositionRejection<'a> {
    channels: Channels<'a>,
    groups: Groups,
    total: f64,
    /// Time of the next event, s.
    next: f64,
    random: Stream,
}

impl<'a> CompositionRejection<'a> {
    /// Starts from `amounts` (molecules, voxel by voxel).
    ///
    /// # Errors
    /// A propensity that is negative or not finite at the start.
    pub fn new(
        system: &'a System<'a>,
        amounts: Vec<f64>,
        key: Key,
    ) -> Result<CompositionRejection<'a>, RunError> {
        let channels = Channels::new(system, amounts)?;
        let groups = Groups::new(&channels.rates);
        let random = stream(key.0, key.1, Purpose::Reactions);
        let mut method = CompositionRejection { channels, groups, total: 0.0, next: 0.0, random };
        method.draw();
        Ok(method)
    }

    /// The waiting time to the next event, exponential with mean 1 / a_0.
    fn draw(&mut self) {
        self.total = self.groups.total();
        self.next = if self.total > 0.0 {
            self.channels.ledger.time + exponential(&mut self.random) / self.total
        } else {
            f64::INFINITY
        };
    }
}

impl EventMethod for CompositionRejection<'_> {
    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        while self.next <= until {
            self.channels.ledger.time = self.next;
            let chosen = self.groups.choose(&self.channels.rates, self.total, &mut self.random);
            if let Some(channel) = chosen {
                let width = self.channels.width;
                self.channels.fire(channel / width, channel % width, &mut self.random)?;
                for &(k, before) in &self.channels.changed {
                    self.groups.change(k as usize, before, self.channels.rates[k as usize]);
                }
            }
            self.draw();
        }
        self.channels.ledger.time = self.channels.ledger.time.max(until);
        Ok(())
    }

    fn ledger(&self) -> &Ledger {
        &self.channels.ledger
    }
}
