//! What the event-driven methods play on: a reactor on voxels that stay, and what an event touches.

use crate::chemistry::propensity::Rows;
use crate::chemistry::reactor::Reactor;
use crate::chemistry::split::Frozen;

/// A kind of event that each voxel has once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    Reaction(usize),
    /// A molecule of this species leaves for a neighbouring voxel.
    Hop(usize),
    /// A sponge makes or takes a molecule of this species.
    Sponge(usize),
}

/// A reaction–diffusion system on a frozen geometry, shared by all realizations.
#[derive(Clone, Debug)]
pub struct System<'a> {
    pub reactor: &'a Reactor,
    pub frozen: &'a Frozen,
    pub(super) columns: Vec<Column>,
    /// By column: the columns of the same voxel whose rates an event may change.
    affected: Rows<u32>,
    /// Factor of each propensity, voxel by voxel.
    weights: Vec<f64>,
    /// Whether an amount is the mean of a reservoir of Poisson numbers; empty if none is.
    means: Vec<bool>,
    /// Rates of birth (1/s) and of death (1/s per molecule) by sponges, one entry an amount; empty if none.
    sponges: Vec<(f64, f64)>,
}

impl<'a> System<'a> {
    /// All reactions and hops of a geometry.
    #[must_use]
    pub fn new(reactor: &'a Reactor, frozen: &'a Frozen) -> System<'a> {
        let reactions = reactor.propensities.len();
        let weights = (0..frozen.voxels())
            .flat_map(|voxel| (0..reactions).map(move |r| frozen.strength(reactor, r, voxel)))
            .collect();
        let mut system = System {
            reactor,
            frozen,
            columns: Vec::new(),
            affected: Rows::collect(std::iter::empty()),
            weights,
            means: Vec::new(),
            sponges: Vec::new(),
        };
        system.list_columns();
        system
    }

    /// Lets held amounts of `species` in `voxels` stand for reservoirs of Poisson numbers: their amounts are
    /// means, by which they emit and react.
    pub fn hold_means(&mut self, voxels: &[u32], species: usize) {
        let count = self.reactor.species_count();
        self.means.resize(self.frozen.voxels() * count, false);
        for &voxel in voxels {
            self.means[voxel as usize * count + species] = true;
        }
    }

    /// A sponge that draws `species` in `voxels` towards `targets` (molecules) at `rate` (1/s): birth at
    /// rate · target, death at rate · n. Held amounts stay.
    pub fn add_sponge(&mut self, voxels: &[u32], species: usize, rate: f64, targets: &[f64]) {
        let count = self.reactor.species_count();
        self.sponges.resize(self.frozen.voxels() * count, (0.0, 0.0));
        for (&voxel, &target) in voxels.iter().zip(targets) {
            let slot = voxel as usize * count + species;
            if !self.frozen.is_held(slot) {
                self.sponges[slot].0 += rate * target;
                self.sponges[slot].1 += rate;
            }
        }
        self.list_columns();
    }

    fn list_columns(&mut self) {
        let species = self.reactor.species_count();
        let propensities = &self.reactor.propensities;
        let hops = |s: &usize| self.frozen.table(*s).is_some_and(|table| table.rate > 0.0);
        let fed = |s: &usize| self.sponges.iter().skip(*s).step_by(species).any(|&(b, d)| b + d > 0.0);
        self.columns = (0..propensities.len())
            .map(Column::Reaction)
            .chain((0..species).filter(hops).map(Column::Hop))
            .chain((0..species).filter(fed).map(Column::Sponge))
            .collect();
        let reads = |column: &Column, s: usize| match *column {
            Column::Reaction(r) => propensities.inputs(r).contains(&(s as u32)),
            Column::Hop(own) | Column::Sponge(own) => own == s,
        };
        self.affected = Rows::collect(self.columns.iter().map(|column| {
            let changed: Vec<usize> = match *column {
                Column::Reaction(r) => propensities.changes(r).iter().map(|&(s, _)| s as usize).collect(),
                Column::Hop(s) | Column::Sponge(s) => vec![s],
            };
            let touched = |k: &u32| changed.iter().any(|&s| reads(&self.columns[*k as usize], s));
            (0..self.columns.len() as u32).filter(touched).collect()
        }));
    }

    /// Whether some amounts are means of reservoirs.
    pub(super) fn has_means(&self) -> bool {
        !self.means.is_empty()
    }

    /// Channels of a voxel.
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// Columns of a voxel whose rates an event of `column` may change.
    #[inline]
    pub(super) fn affected(&self, column: usize) -> &[u32] {
        self.affected.row(column)
    }

    /// Factor of the propensity of reaction `r` in `voxel`; zero where it does not happen.
    #[inline]
    pub(super) fn weight(&self, voxel: usize, r: usize) -> f64 {
        self.weights[voxel * self.reactor.propensities.len() + r]
    }

    /// Birth rate and death rate per molecule that sponges give an amount.
    pub(super) fn sponge(&self, slot: usize) -> (f64, f64) {
        self.sponges.get(slot).copied().unwrap_or_default()
    }

    /// Rate of a channel, 1/s, not checked; `row` holds the amounts of the voxel.
    #[inline]
    pub(super) fn rate(&self, voxel: usize, column: usize, row: &[f64]) -> f64 {
        let first = voxel * row.len();
        match self.columns[column] {
            Column::Reaction(r) => {
                let weight = self.weight(voxel, r);
                if weight == 0.0 {
                    return 0.0;
                }
                let (propensities, scale) = (&self.reactor.propensities, self.frozen.scales[voxel]);
                let a = if self.means.is_empty() {
                    let held = self.frozen.held.get(first..first + row.len()).unwrap_or_default();
                    propensities.propensity_beside(r, row, scale, held)
                } else {
                    propensities.mean_at(r, row, scale, |s| self.means[first + s])
                };
                weight * a
            }
            // n D Σ_j G_ij / V_i
            Column::Hop(s) => self
                .frozen
                .table(s)
                .map_or(0.0, |table| self.reactor.diffusivity[s] * table.leaving[voxel] * row[s]),
            Column::Sponge(s) => {
                let (birth, death) = self.sponge(first + s);
                birth + death * row[s]
            }
        }
    }
}
