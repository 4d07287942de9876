//! What the event-driven methods share: amounts with their bookkeeping, and the choice among propensities.

use crate::chemistry::propensity::Scale;
use crate::chemistry::reactor::Reactor;
use crate::chemistry::split::Counters;
use crate::error::RunError;

/// Amounts of all voxels, what is held, and what was counted.
#[derive(Clone, Debug)]
pub(super) struct Cells<'a> {
    pub reactor: &'a Reactor,
    pub species: usize,
    pub scales: Vec<Scale>,
    /// One flag per amount; empty if nothing is held.
    pub held: Vec<bool>,
    pub amounts: Vec<f64>,
    pub supplied: Vec<f64>,
    pub counters: Counters,
    /// Events of each reaction.
    pub fired: Vec<u64>,
}

impl<'a> Cells<'a> {
    pub fn new(reactor: &'a Reactor, volumes: &[f64], held: &[bool], amounts: Vec<f64>) -> Cells<'a> {
        let species = reactor.species_count();
        Cells {
            reactor,
            species,
            scales: volumes.iter().map(|&v| Scale::of(v)).collect(),
            held: held.to_vec(),
            amounts,
            supplied: vec![0.0; species],
            counters: Counters::default(),
            fired: vec![0; reactor.propensities.len()],
        }
    }

    /// The propensity of reaction `r` in `voxel`, checked.
    pub fn propensity(&self, r: usize, voxel: usize, time: f64) -> Result<f64, RunError> {
        let row = &self.amounts[voxel * self.species..(voxel + 1) * self.species];
        let a = self.reactor.propensities.propensity_at(r, row, self.scales[voxel]);
        if (0.0..f64::INFINITY).contains(&a) {
            Ok(a)
        } else {
            Err(self.reactor.bad_propensity(r, a, time, voxel, row))
        }
    }

    /// One event of reaction `r` in `voxel`.
    pub fn apply(&mut self, r: usize, voxel: usize, time: f64) -> Result<(), RunError> {
        for &(s, change) in self.reactor.propensities.changes(r) {
            let s = s as usize;
            let count = self.amounts[voxel * self.species + s] + change;
            if count < 0.0 && !self.is_held(voxel, s) {
                return Err(self.reactor.negative_count(s, count, r, time, voxel));
            }
            self.hand(voxel, s, change);
        }
        self.counters.events += 1;
        self.fired[r] += 1;
        Ok(())
    }

    /// One molecule of `s` from voxel `from` to voxel `to`.
    pub fn hop(&mut self, s: usize, from: usize, to: usize) {
        self.hand(from, s, -1.0);
        self.hand(to, s, 1.0);
        self.counters.hops += 1;
    }

    #[inline]
    pub fn is_held(&self, voxel: usize, s: usize) -> bool {
        !self.held.is_empty() && self.held[voxel * self.species + s]
    }

    /// Changes an amount, or books the change where it is held.
    fn hand(&mut self, voxel: usize, s: usize, change: f64) {
        if self.is_held(voxel, s) {
            self.supplied[s] -= change;
        } else {
            self.amounts[voxel * self.species + s] += change;
        }
    }
}

/// Index with chance weight / total; `uniform` in [0, 1). The last positive weight should rounding leave a
/// sliver; 0 if there is none.
#[inline]
pub(super) fn choose(weights: impl Iterator<Item = f64>, total: f64, uniform: f64) -> usize {
    let mut left = uniform * total;
    let mut chosen = 0;
    for (k, w) in weights.enumerate() {
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
