//! Tau-leaping (Gillespie 2001) with the step of Cao, Gillespie & Petzold (2006), J. Chem. Phys. 124, 044109:
//! approximate. Propensities are taken as constant over a leap so short that none is expected to change by more
//! than a tolerance ε; each channel then fires a Poisson number of times.
//!
//! A channel that fewer than ten firings would exhaust fires at most once in a leap, and a leap that
//! would take an amount below zero is taken again at half the length: counts are never negative and never
//! clipped. Where a leap would hardly be longer than the waiting time of single events, these are played
//! exactly. A leap ends at each output time.

mod select;

use super::channels::{Channels, choose};
use super::system::Column;
use super::{EventMethod, Key, Ledger, System};
use crate::chemistry::reactor::MOST_MOLECULES;
use crate::chemistry::sampling_numbers::{binomial, exponential, poisson};
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};
use rand::Rng;

/// A leap shorter than this many mean waiting times is not worth it, and so many events are played one by
/// one before the next is tried; both from the paper.
const WORTH: f64 = 10.0;
const ONE_BY_ONE: u32 = 100;

/// One realization.
#[derive(Clone, Debug)]
pub struct TauLeaping<'a> {
    channels: Channels<'a>,
    random: Stream,
    /// ε: largest expected relative change of a propensity in a leap.
    tolerance: f64,
    /// Highest order of the reactions that each species enters, and how many of it enter one there.
    orders: Vec<(u32, u32)>,
    /// Whether each channel is critical.
    critical: Vec<bool>,
    /// Mean change of each amount per second by channels that are not critical, and its variance per second.
    drift: Vec<f64>,
    spread: Vec<f64>,
    /// Molecules of each amount that these channels take per second.
    loss: Vec<f64>,
    /// Amounts and books before a leap that may have to be taken back.
    before: Ledger,
    /// Events still to be played one by one.
    single: u32,
}

impl<'a> TauLeaping<'a> {
    /// Starts from `amounts` (molecules, voxel by voxel); `tolerance` is ε, 0.03 in the paper.
    ///
    /// # Errors
    /// A propensity that is negative or not finite at the start.
    pub fn new(
        system: &'a System<'a>,
        amounts: Vec<f64>,
        tolerance: f64,
        key: Key,
    ) -> Result<TauLeaping<'a>, RunError> {
        let channels = Channels::new(system, amounts)?;
        let (slots, rates) = (channels.ledger.amounts.len(), channels.rates.len());
        Ok(TauLeaping {
            before: channels.ledger.clone(),
            channels,
            random: stream(key.0, key.1, Purpose::Reactions),
            tolerance,
            orders: select::orders(system),
            critical: vec![false; rates],
            drift: vec![0.0; slots],
            spread: vec![0.0; slots],
            loss: vec![0.0; slots],
            single: 0,
        })
    }

    /// One leap, not beyond `until`, or the decision to play single events.
    fn leap(&mut self, until: f64) -> Result<(), RunError> {
        let critical = self.survey();
        let mut longest = self.longest();
        let worth = WORTH / self.channels.rates.iter().sum::<f64>();
        loop {
            if longest < worth {
                self.single = ONE_BY_ONE;
                return Ok(());
            }
            let begun = self.channels.ledger.time;
            let wait = if critical > 0.0 { exponential(&mut self.random) / critical } else { f64::INFINITY };
            let left = until - begun;
            let tau = longest.min(wait).min(left);
            let one = wait <= longest && wait <= left;
            self.before.clone_from(&self.channels.ledger);
            self.fire_many(tau);
            if one {
                self.fire_critical(critical);
            }
            if let Some(slot) = self.channels.ledger.amounts.iter().position(|&n| n > MOST_MOLECULES) {
                let reactor = self.channels.system.reactor;
                let (voxel, s) = (slot / self.orders.len(), slot % self.orders.len());
                let value = self.channels.ledger.amounts[slot];
                return Err(reactor.too_many(s, value, self.channels.ledger.time, voxel));
            }
            if self.channels.ledger.amounts.iter().any(|&n| n < 0.0) {
                self.channels.ledger.clone_from(&self.before);
                longest = 0.5 * longest.min(tau);
                continue;
            }
            self.channels.ledger.time = if tau < left { begun + tau } else { until };
            return self.channels.refresh_all();
        }
    }

    /// Poisson numbers of events of all channels that are not critical; amounts may come out negative.
    fn fire_many(&mut self, tau: f64) {
        let system = self.channels.system;
        for channel in 0..self.critical.len() {
            let rate = self.channels.rates[channel];
            if rate <= 0.0 || self.critical[channel] {
                continue;
            }
            let times = poisson(&mut self.random, rate * tau);
            if times == 0 {
                continue;
            }
            let (voxel, column) = (channel / self.channels.width, channel % self.channels.width);
            match system.columns[column] {
                Column::Reaction(r) => self.react(voxel, r, times),
                Column::Hop(s) => self.scatter(voxel, s, times),
                Column::Sponge(s) => {
                    let (birth, _) = system.sponge(voxel * self.orders.len() + s);
                    let births = binomial(&mut self.random, times, birth / rate) as f64;
                    self.channels.supply(voxel, s, 2.0 * births - times as f64);
                }
            }
        }
    }

    fn react(&mut self, voxel: usize, r: usize, times: u64) {
        for &(s, change) in self.channels.system.reactor.propensities.changes(r) {
            self.channels.hand(voxel, s as usize, change * times as f64);
        }
        self.channels.ledger.counters.events += times;
        self.channels.ledger.fired[r] += times;
    }

    /// Deals out `times` molecules that leave a voxel over its neighbours.
    fn scatter(&mut self, voxel: usize, s: usize, times: u64) {
        let Some(table) = self.channels.system.frozen.table(s) else { return };
        self.channels.hand(voxel, s, -(times as f64));
        self.channels.ledger.counters.hops += times;
        let (mut left, mut share) = (times, table.leaving[voxel] / table.rate);
        let mut last = voxel;
        for (j, p) in table.row(voxel).filter(|&(j, p)| j != voxel && p > 0.0) {
            let taken = binomial(&mut self.random, left, p / share);
            self.channels.hand(j, s, taken as f64);
            left -= taken;
            share -= p;
            last = j;
        }
        // Rounding of the shares may leave some for the last neighbour.
        self.channels.hand(last, s, left as f64);
    }

    /// One event of a critical channel.
    fn fire_critical(&mut self, total: f64) {
        let mut left = self.random.random::<f64>() * total;
        let mut chosen = None;
        for (channel, &rate) in self.channels.rates.iter().enumerate() {
            if self.critical[channel] {
                chosen = Some(channel);
                if left < rate {
                    break;
                }
                left -= rate;
            }
        }
        let Some(channel) = chosen else { return };
        let (voxel, column) = (channel / self.channels.width, channel % self.channels.width);
        let system = self.channels.system;
        match system.columns[column] {
            Column::Reaction(r) => self.react(voxel, r, 1),
            Column::Hop(s) => self.scatter(voxel, s, 1),
            Column::Sponge(s) => {
                let (birth, _) = system.sponge(voxel * self.orders.len() + s);
                let born = self.random.random::<f64>() * self.channels.rates[channel] < birth;
                self.channels.supply(voxel, s, if born { 1.0 } else { -1.0 });
            }
        }
    }

    /// One exact event, unless it comes after `until`.
    fn play_one(&mut self, until: f64) -> Result<(), RunError> {
        let total: f64 = self.channels.rates.iter().sum();
        let next = self.channels.ledger.time + exponential(&mut self.random) / total;
        if next > until {
            // What is waited for forgets how long it was waited for.
            self.channels.ledger.time = until;
            return Ok(());
        }
        self.channels.ledger.time = next;
        let channel = choose(&self.channels.rates, total, self.random.random());
        let width = self.channels.width;
        self.channels.fire(channel / width, channel % width, &mut self.random)?;
        Ok(())
    }
}

impl EventMethod for TauLeaping<'_> {
    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        while self.channels.ledger.time < until {
            if self.channels.rates.iter().all(|&rate| rate <= 0.0) {
                break;
            }
            if self.single > 0 {
                self.single -= 1;
                self.play_one(until)?;
            } else {
                self.leap(until)?;
            }
        }
        self.channels.ledger.time = self.channels.ledger.time.max(until);
        Ok(())
    }

    fn ledger(&self) -> &Ledger {
        &self.channels.ledger
    }
}
