//! What the event-driven methods share: the rates of all channels, kept up to date as events fire.

use super::system::{Column, System};
use super::{Counters, Ledger};
use crate::error::RunError;
use crate::random::Stream;
use rand::Rng;

/// Amounts of all voxels with their books, and the rate of every channel.
#[derive(Clone, Debug)]
pub(super) struct Channels<'a> {
    pub system: &'a System<'a>,
    pub ledger: Ledger,
    /// 1/s; column k of voxel v is channel `v * width + k`.
    pub rates: Vec<f64>,
    pub width: usize,
    /// Channels whose rate the last event changed, with the rate before.
    pub changed: Vec<(u32, f64)>,
    species: usize,
}

impl<'a> Channels<'a> {
    /// All rates at the start.
    ///
    /// # Errors
    /// A propensity that is negative or not finite.
    pub fn new(system: &'a System<'a>, amounts: Vec<f64>) -> Result<Channels<'a>, RunError> {
        let width = system.width();
        let mut channels = Channels {
            system,
            ledger: Ledger::new(system, amounts),
            rates: vec![0.0; system.frozen.voxels() * width],
            width,
            changed: Vec::new(),
            species: system.reactor.species_count(),
        };
        channels.refresh_all()?;
        Ok(channels)
    }

    /// Rates of all channels of a voxel.
    #[inline]
    pub fn row(&self, voxel: usize) -> &[f64] {
        &self.rates[voxel * self.width..(voxel + 1) * self.width]
    }

    /// Number of voxels.
    pub fn voxels(&self) -> usize {
        self.system.frozen.voxels()
    }

    /// Computes every rate again.
    pub fn refresh_all(&mut self) -> Result<(), RunError> {
        self.changed.clear();
        for voxel in 0..self.voxels() {
            for column in 0..self.width {
                self.refresh(voxel, column)?;
            }
        }
        Ok(())
    }

    /// One event of `column` in `voxel`. [`Channels::changed`] then lists the rates that changed; all are of
    /// this voxel or of the one returned, where a molecule went.
    pub fn fire(
        &mut self,
        voxel: usize,
        column: usize,
        random: &mut Stream,
    ) -> Result<Option<usize>, RunError> {
        self.changed.clear();
        let mut other = None;
        match self.system.columns[column] {
            Column::Reaction(r) => self.react(voxel, r, 1)?,
            Column::Hop(s) => {
                if let Some(table) = self.system.frozen.table(s) {
                    let to = table.hop(voxel, random);
                    self.hand(voxel, s, -1.0);
                    self.hand(to, s, 1.0);
                    self.ledger.counters.hops += 1;
                    self.refresh_affected(to, column)?;
                    other = Some(to);
                }
            }
            Column::Sponge(s) => {
                let (birth, _) = self.system.sponge(voxel * self.species + s);
                let total = self.rates[voxel * self.width + column];
                let change = if random.random::<f64>() * total < birth { 1.0 } else { -1.0 };
                self.supply(voxel, s, change);
            }
        }
        self.refresh_affected(voxel, column)?;
        Ok(other)
    }

    /// `times` events of reaction `r` in `voxel`; rates stay as they are.
    pub fn react(&mut self, voxel: usize, r: usize, times: u64) -> Result<(), RunError> {
        let reactor = self.system.reactor;
        for &(s, change) in reactor.propensities.changes(r) {
            let (s, change) = (s as usize, change * times as f64);
            let count = self.ledger.amounts[voxel * self.species + s] + change;
            if count < 0.0 && !self.is_held(voxel, s) {
                return Err(reactor.negative_count(s, count, r, self.ledger.time, voxel));
            }
            self.hand(voxel, s, change);
        }
        self.ledger.counters =
            Counters { events: self.ledger.counters.events + times, ..self.ledger.counters };
        self.ledger.fired[r] += times;
        Ok(())
    }

    /// Whether the amount of species `s` in `voxel` is a reservoir.
    #[inline]
    pub fn is_held(&self, voxel: usize, s: usize) -> bool {
        self.system.frozen.is_held(voxel * self.species + s)
    }

    /// Changes an amount, or books the change where it is held.
    #[inline]
    pub fn hand(&mut self, voxel: usize, s: usize, change: f64) {
        if self.is_held(voxel, s) {
            self.ledger.supplied[s] -= change;
        } else {
            self.ledger.amounts[voxel * self.species + s] += change;
        }
    }

    /// A sponge's gift to an amount.
    pub fn supply(&mut self, voxel: usize, s: usize, change: f64) {
        self.ledger.amounts[voxel * self.species + s] += change;
        self.ledger.supplied[s] += change;
    }

    #[inline]
    fn refresh_affected(&mut self, voxel: usize, column: usize) -> Result<(), RunError> {
        let system = self.system;
        for &k in system.affected(column) {
            self.refresh(voxel, k as usize)?;
        }
        Ok(())
    }

    /// Computes one rate again, checks it, and notes if it changed.
    #[inline]
    fn refresh(&mut self, voxel: usize, column: usize) -> Result<(), RunError> {
        let row = &self.ledger.amounts[voxel * self.species..(voxel + 1) * self.species];
        let rate = self.system.rate(voxel, column, row);
        if !(0.0..f64::INFINITY).contains(&rate) {
            return Err(self.bad(voxel, column, rate));
        }
        let channel = voxel * self.width + column;
        let before = std::mem::replace(&mut self.rates[channel], rate);
        if before != rate {
            self.changed.push((channel as u32, before));
        }
        Ok(())
    }

    #[cold]
    fn bad(&self, voxel: usize, column: usize, rate: f64) -> RunError {
        let row = &self.ledger.amounts[voxel * self.species..(voxel + 1) * self.species];
        match self.system.columns[column] {
            Column::Reaction(r) => self.system.reactor.bad_propensity(r, rate, self.ledger.time, voxel, row),
            Column::Hop(s) | Column::Sponge(s) => RunError::NegativeCount {
                time: self.ledger.time,
                voxel,
                species: self.system.reactor.species[s].clone(),
                count: row[s],
                event: String::from("the start"),
            },
        }
    }
}

/// Index with chance weight / total; `uniform` in [0, 1). The last positive weight should rounding leave a
/// sliver; 0 if there is none.
#[inline]
pub(super) fn choose(weights: &[f64], total: f64, uniform: f64) -> usize {
    let mut left = uniform * total;
    let mut chosen = 0;
    for (k, &w) in weights.iter().enumerate() {
        if w > 0.0 {
            chosen = k;
            if left < w {
                break;
            }
            left -= w;
        }
    }
    chosen
}
