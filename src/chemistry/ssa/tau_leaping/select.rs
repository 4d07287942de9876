//! How far a leap may go: which channels are critical, and how fast the others change every amount.

use super::TauLeaping;
use crate::chemistry::ssa::System;
use crate::chemistry::ssa::system::Column;

/// Firings left below which a channel is critical; n_c of the paper.
const CRITICAL: f64 = 10.0;

impl TauLeaping<'_> {
    /// g_i: how much faster than the species the fastest propensity changes that it enters; paper, Sec. III.
    fn steepness(&self, s: usize, x: f64) -> f64 {
        match self.orders[s] {
            (2, 2) => 2.0 + 1.0 / (x - 1.0).max(1.0),
            (3, 2) => 1.5 * (2.0 + 1.0 / (x - 1.0).max(1.0)),
            (3, 3) => 3.0 + 1.0 / (x - 1.0).max(1.0) + 2.0 / (x - 2.0).max(1.0),
            (order, _) => f64::from(order),
        }
    }

    /// Whether fewer than [`CRITICAL`] firings would exhaust what a channel takes.
    fn is_critical(&self, voxel: usize, column: usize) -> bool {
        let (system, amounts) = (self.channels.system, &self.channels.ledger.amounts);
        let species = system.reactor.species_count();
        let scarce = |s: usize, taken: f64| {
            !self.channels.is_held(voxel, s) && amounts[voxel * species + s] < CRITICAL * taken
        };
        match system.columns[column] {
            Column::Reaction(r) => {
                let changes = system.reactor.propensities.changes(r);
                changes.iter().any(|&(s, change)| change < 0.0 && scarce(s as usize, -change))
            }
            Column::Hop(s) => scarce(s, 1.0),
            Column::Sponge(s) => system.sponge(voxel * species + s).1 > 0.0 && scarce(s, 1.0),
        }
    }

    /// Sorts out critical channels and gathers drift and spread; returns the sum of the critical rates.
    pub(super) fn survey(&mut self) -> f64 {
        self.drift.fill(0.0);
        self.spread.fill(0.0);
        self.loss.fill(0.0);
        let system = self.channels.system;
        let species = system.reactor.species_count();
        let mut sum = 0.0;
        for channel in 0..self.critical.len() {
            let rate = self.channels.rates[channel];
            self.critical[channel] = false;
            if rate <= 0.0 {
                continue;
            }
            let (voxel, column) = (channel / self.channels.width, channel % self.channels.width);
            if self.is_critical(voxel, column) {
                self.critical[channel] = true;
                sum += rate;
                continue;
            }
            let mut add = |slot: usize, change: f64, rate: f64| {
                self.drift[slot] += change * rate;
                self.spread[slot] += change * change * rate;
                self.loss[slot] -= change.min(0.0) * rate;
            };
            match system.columns[column] {
                Column::Reaction(r) => {
                    for &(s, change) in system.reactor.propensities.changes(r) {
                        add(voxel * species + s as usize, change, rate);
                    }
                }
                Column::Hop(s) => {
                    add(voxel * species + s, -1.0, rate);
                    if let Some(table) = system.frozen.table(s) {
                        let leaving = table.leaving[voxel] / table.rate;
                        for (j, p) in table.row(voxel).filter(|&(j, _)| j != voxel) {
                            add(j * species + s, 1.0, rate * (p / leaving).min(1.0));
                        }
                    }
                }
                Column::Sponge(s) => {
                    let (birth, _) = system.sponge(voxel * species + s);
                    add(voxel * species + s, 1.0, birth);
                    add(voxel * species + s, -1.0, rate - birth);
                }
            }
        }
        sum
    }

    /// Longest leap of the channels that are not critical; paper, Eq. (33), and one bound more.
    ///
    /// In a balance of gain and loss the drift vanishes, and the paper's leaps may be as long as the time of
    /// relaxation; the variance of n -> n + Poisson(b τ) - Poisson(n c τ) is then mean / (1 - c τ / 2). A leap that
    /// takes at most 2 ε of an amount keeps this error at ε.
    pub(super) fn longest(&self) -> f64 {
        let species = self.orders.len();
        let mut longest = f64::INFINITY;
        for (slot, &x) in self.channels.ledger.amounts.iter().enumerate() {
            let s = slot % species;
            if self.orders[s].0 == 0 || self.spread[slot] <= 0.0 || self.channels.is_held(slot / species, s) {
                continue;
            }
            let change = (self.tolerance * x / self.steepness(s, x)).max(1.0);
            longest = longest.min(change / self.drift[slot].abs()).min(change * change / self.spread[slot]);
            longest = longest.min(2.0 * change / self.loss[slot]);
        }
        longest
    }
}

/// Highest order of the reactions that each species enters, with the most that enter one of that order; hops and
/// sponges are of first order, rate laws count as third.
pub(super) fn orders(system: &System) -> Vec<(u32, u32)> {
    let propensities = &system.reactor.propensities;
    let mut orders = vec![(0, 0); system.reactor.species_count()];
    let mut raise = |s: usize, order: (u32, u32)| orders[s] = order.max(orders[s]);
    for column in &system.columns {
        match *column {
            Column::Hop(s) | Column::Sponge(s) => raise(s, (1, 1)),
            Column::Reaction(r) => match propensities.product(r, system.frozen.scales[0]) {
                Some((_, factors)) => {
                    for &(s, _) in &factors {
                        let of_kind = factors.iter().filter(|f| f.0 == s).count();
                        raise(s as usize, (factors.len() as u32, of_kind as u32));
                    }
                }
                None => propensities.inputs(r).iter().for_each(|&s| raise(s as usize, (3, 3))),
            },
        }
    }
    orders
}
