//! The next subvolume method on a graph of voxels (Elf & Ehrenberg 2004): hops are events like reactions.
//!
//! Every voxel has the time of its next event in an indexed heap; the earliest one fires, by a reaction or
//! by a hop i -> j at rate D G_ij / V_i per molecule. A voxel that receives a molecule has its waiting time
//! rescaled by the ratio of its rates (Gibson & Bruck 2000), which spares a random number.

use super::events::{Cells, choose};
use super::heap::TimeHeap;
use super::{Counters, EventMethod};
use crate::chemistry::diffusion::HopTable;
use crate::chemistry::links::Links;
use crate::chemistry::reactor::Reactor;
use crate::chemistry::sampling_numbers::exponential;
use crate::chemistry::split::Frozen;
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};
use rand::Rng;

/// The voxels of a graph: volumes m³, home and current group of each, and which amounts are held
/// (voxel by voxel; empty for none).
#[derive(Clone, Copy, Debug)]
pub struct Graph<'a> {
    pub volumes: &'a [f64],
    pub home: &'a [u8],
    pub current: &'a [u8],
    pub links: &'a Links,
    pub held: &'a [bool],
}

/// One realization of a reaction–diffusion system on a graph.
#[derive(Clone, Debug)]
pub struct NextSubvolume<'a> {
    cells: Cells<'a>,
    frozen: Frozen,
    /// Groups of each voxel.
    groups: Vec<(u8, u8)>,
    /// Propensity of each reaction in each voxel, voxel by voxel.
    propensities: Vec<f64>,
    /// Sum of the propensities of each voxel.
    reacting: Vec<f64>,
    /// Rate at which molecules leave each voxel by hops.
    leaving: Vec<f64>,
    heap: TimeHeap,
    time: f64,
    random: Stream,
}

impl<'a> NextSubvolume<'a> {
    /// Starts from `amounts` (molecules, voxel by voxel).
    ///
    /// # Errors
    /// Conductances, volumes or propensities that are negative or not finite.
    pub fn new(
        reactor: &'a Reactor,
        graph: Graph,
        amounts: Vec<f64>,
        (seed, realization): (u64, u64),
    ) -> Result<NextSubvolume<'a>, RunError> {
        let voxels = graph.volumes.len();
        let frozen =
            Frozen::build(reactor, graph.links, graph.volumes, graph.home, graph.current, graph.held)?;
        let mut method = NextSubvolume {
            cells: Cells::new(reactor, graph.volumes, graph.held, amounts),
            frozen,
            groups: graph.home.iter().copied().zip(graph.current.iter().copied()).collect(),
            propensities: vec![0.0; voxels * reactor.propensities.len()],
            reacting: vec![0.0; voxels],
            leaving: vec![0.0; voxels],
            heap: TimeHeap::new(Vec::new()),
            time: 0.0,
            random: stream(seed, realization, Purpose::Reactions),
        };
        let mut times = Vec::with_capacity(voxels);
        for voxel in 0..voxels {
            for r in 0..reactor.propensities.len() {
                method.refresh(voxel, r)?;
            }
            method.sum_up(voxel);
            times.push(method.waiting(voxel));
        }
        method.heap = TimeHeap::new(times);
        Ok(method)
    }

    /// Computes one propensity again.
    fn refresh(&mut self, voxel: usize, r: usize) -> Result<(), RunError> {
        let reactor = self.cells.reactor;
        let (home, current) = self.groups[voxel];
        if reactor.happens(r, home, current) {
            let a = self.cells.propensity(r, voxel, self.time)?;
            self.propensities[voxel * reactor.propensities.len() + r] = a;
        }
        Ok(())
    }

    /// Computes again all propensities that read species `s`.
    fn refresh_readers(&mut self, voxel: usize, s: usize) -> Result<(), RunError> {
        let reactor = self.cells.reactor;
        for r in 0..reactor.propensities.len() {
            if reactor.propensities.inputs(r).contains(&(s as u32)) {
                self.refresh(voxel, r)?;
            }
        }
        Ok(())
    }

    /// Rate of hops of species `s` out of `voxel`: n D Σ_j G_ij / V_i.
    fn hop_rate(&self, voxel: usize, s: usize) -> f64 {
        let reactor = self.cells.reactor;
        let per_molecule = self.frozen.table(s).map_or(0.0, |t: &HopTable| t.leaving[voxel]);
        reactor.diffusivity[s] * per_molecule * self.cells.amounts[voxel * self.cells.species + s]
    }

    fn sum_up(&mut self, voxel: usize) {
        let reactions = self.cells.reactor.propensities.len();
        self.reacting[voxel] = self.propensities[voxel * reactions..(voxel + 1) * reactions].iter().sum();
        self.leaving[voxel] = (0..self.cells.species).map(|s| self.hop_rate(voxel, s)).sum();
    }

    /// Time of the next event of a voxel, drawn anew.
    fn waiting(&mut self, voxel: usize) -> f64 {
        let total = self.reacting[voxel] + self.leaving[voxel];
        if total > 0.0 { self.time + exponential(&mut self.random) / total } else { f64::INFINITY }
    }

    /// The waiting time of a voxel whose rates were changed from outside.
    fn rescale(&mut self, voxel: usize) {
        let before = self.reacting[voxel] + self.leaving[voxel];
        self.sum_up(voxel);
        let after = self.reacting[voxel] + self.leaving[voxel];
        let time = if before > 0.0 && after > 0.0 {
            self.time + (self.heap.time(voxel) - self.time) * (before / after)
        } else {
            self.waiting(voxel)
        };
        self.heap.set(voxel, time);
    }

    fn fire(&mut self, voxel: usize) -> Result<(), RunError> {
        let reactor = self.cells.reactor;
        let reactions = reactor.propensities.len();
        let total = self.reacting[voxel] + self.leaving[voxel];
        let uniform: f64 = self.random.random();
        if uniform * total < self.reacting[voxel] {
            let row = &self.propensities[voxel * reactions..(voxel + 1) * reactions];
            let r = choose(row.iter().copied(), total, uniform);
            self.cells.apply(r, voxel, self.time)?;
            for &q in reactor.propensities.affected(r) {
                self.refresh(voxel, q as usize)?;
            }
        } else {
            let left = (uniform * total - self.reacting[voxel]) / self.leaving[voxel];
            let rates = (0..self.cells.species).map(|s| self.hop_rate(voxel, s));
            let s = choose(rates, self.leaving[voxel], left);
            let Some(table) = self.frozen.table(s) else { return Ok(()) };
            let to = table.hop(voxel, &mut self.random);
            self.cells.hop(s, voxel, to);
            self.refresh_readers(voxel, s)?;
            if !self.cells.is_held(to, s) {
                self.refresh_readers(to, s)?;
                self.rescale(to);
            }
        }
        self.sum_up(voxel);
        let time = self.waiting(voxel);
        self.heap.set(voxel, time);
        Ok(())
    }
}

impl EventMethod for NextSubvolume<'_> {
    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        while let Some((voxel, time)) = self.heap.first() {
            if time > until {
                break;
            }
            self.time = time;
            self.fire(voxel)?;
        }
        self.time = self.time.max(until);
        Ok(())
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn amounts(&self) -> &[f64] {
        &self.cells.amounts
    }

    fn supplied(&self) -> &[f64] {
        &self.cells.supplied
    }

    fn fired(&self) -> &[u64] {
        &self.cells.fired
    }

    fn counters(&self) -> Counters {
        self.cells.counters
    }
}
