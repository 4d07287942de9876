//! The direct method (Gillespie 1976, 1977): one waiting time for the next event of all, one choice among the
//! channels. The dependencies of Gibson & Bruck (2000) decide which rates to compute again.
//!
//! In one volume the search is linear over flat tables ([`super::flat`]); among many voxels it goes down a
//! tree of sums (Li & Petzold 2006) and then along the channels of a voxel.

use super::channels::{Channels, choose};
use super::flat::{Flat, Lane};
use super::sums::SumTree;
use super::{EventMethod, Key, Ledger, System};
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};
use rand::Rng;

/// One realization.
#[derive(Clone, Debug)]
pub struct Direct<'a>(Domain<'a>);

#[derive(Clone, Debug)]
enum Domain<'a> {
    One(Box<Flat<'a>>),
    Many(Box<Voxels<'a>>),
}

/// Voxels of a graph, with the sum of the rates of each in a tree.
#[derive(Clone, Debug)]
struct Voxels<'a> {
    channels: Channels<'a>,
    tree: SumTree,
    /// Time of the next event, s.
    next: f64,
    random: Stream,
}

impl<'a> Direct<'a> {
    /// Starts from `amounts` (molecules, voxel by voxel).
    ///
    /// # Errors
    /// A propensity that is negative or not finite at the start.
    pub fn new(system: &'a System<'a>, amounts: Vec<f64>, key: Key) -> Result<Direct<'a>, RunError> {
        let random = stream(key.0, key.1, Purpose::Reactions);
        if Flat::fits(system) {
            return Ok(Direct(Domain::One(Box::new(Flat::new(system, amounts, random)?))));
        }
        let channels = Channels::new(system, amounts)?;
        let tree = SumTree::new((0..channels.voxels()).map(|voxel| channels.row(voxel).iter().sum()));
        let mut voxels = Voxels { channels, tree, next: 0.0, random };
        voxels.draw();
        Ok(Direct(Domain::Many(Box::new(voxels))))
    }
}

impl Voxels<'_> {
    /// The waiting time to the next event, exponential with mean 1 / a_0.
    fn draw(&mut self) {
        let total = self.tree.total();
        self.next = if total > 0.0 {
            self.channels.ledger.time + exponential(&mut self.random) / total
        } else {
            f64::INFINITY
        };
    }

    fn sum_up(&mut self, voxel: usize) {
        self.tree.set(voxel, self.channels.row(voxel).iter().sum());
    }

    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        while self.next <= until {
            self.channels.ledger.time = self.next;
            let (voxel, rest) = self.tree.choose(self.random.random());
            let row = self.channels.row(voxel);
            let column = choose(row, row.iter().sum(), rest);
            if let Some(other) = self.channels.fire(voxel, column, &mut self.random)? {
                self.sum_up(other);
            }
            self.sum_up(voxel);
            self.draw();
        }
        self.channels.ledger.time = self.channels.ledger.time.max(until);
        Ok(())
    }
}

impl EventMethod for Direct<'_> {
    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        match &mut self.0 {
            Domain::One(flat) => flat.advance(until),
            Domain::Many(voxels) => voxels.advance(until),
        }
    }

    fn ledger(&self) -> &Ledger {
        match &self.0 {
            Domain::One(flat) => flat.ledger(),
            Domain::Many(voxels) => &voxels.channels.ledger,
        }
    }
}
