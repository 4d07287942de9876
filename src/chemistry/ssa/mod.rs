//! Event-driven methods: every reaction and every hop is an event; no splitting error.
//!
//! A [`System`] lists the channels (voxel x reaction, voxel x species that hops away) and is shared by all
//! realizations; `Channels` keeps their rates and fires events; a method is a structure that finds the next
//! event among them. All reactions are sampled, also those of continuous species (by whole molecules);
//! hybrid and continuous models are stepped by [`crate::chemistry::split`].
//!
//! | method | next event | cost of an event among n channels |
//! |---|---|---|
//! | [`Direct`] | one waiting time, one search | n in one volume, log(voxels) on a graph |
//! | [`NextReaction`] | a waiting time for every channel, in a heap | log n for each rate that changed |
//! | [`CompositionRejection`] | one waiting time, rates sorted by powers of two | constant |
//! | [`NextSubvolume`] | a waiting time for every voxel, in a heap | log(voxels) |
//! | [`TauLeaping`] | many events at once, approximate | n for each leap |

mod channels;
pub mod composition_rejection;
pub mod direct;
mod flat;
mod groups;
pub mod heap;
pub mod next_reaction;
pub mod next_subvolume;
pub mod side_by_side;
mod small;
mod sums;
pub mod system;
pub mod tau_leaping;

pub use crate::chemistry::split::Counters;
pub use composition_rejection::CompositionRejection;
pub use direct::Direct;
pub use next_reaction::NextReaction;
pub use next_subvolume::NextSubvolume;
pub use system::System;
pub use tau_leaping::TauLeaping;

use crate::error::RunError;

/// Seed of the run and number of the realization, which name its random streams.
pub type Key = (u64, u64);

/// State and books of one realization: total now = total at the start + reactions + `supplied`.
#[derive(Clone, Debug)]
pub struct Ledger {
    /// Time reached, s.
    pub time: f64,
    /// Molecules, voxel by voxel: species s of voxel i at `i * species + s`.
    pub amounts: Vec<f64>,
    /// Net molecules of each species brought in by held amounts and sponges.
    pub supplied: Vec<f64>,
    /// Events of each reaction.
    pub fired: Vec<u64>,
    pub counters: Counters,
}

impl Ledger {
    fn new(system: &System, amounts: Vec<f64>) -> Ledger {
        Ledger {
            time: 0.0,
            amounts,
            supplied: vec![0.0; system.reactor.species_count()],
            fired: vec![0; system.reactor.propensities.len()],
            counters: Counters::default(),
        }
    }

    /// Counts events and books what reactions changed of held species, from the events of each reaction.
    fn balance(&mut self, system: &System) -> Result<(), RunError> {
        let reactor = system.reactor;
        self.counters.events = self.fired.iter().sum();
        for s in 0..self.amounts.len() {
            if system.frozen.is_held(s) {
                self.supplied[s] = -reactor.made(&self.fired, s);
            }
            if self.amounts[s] < 0.0 {
                return Err(reactor.negative_count(s, self.amounts[s], 0, self.time, 0));
            }
        }
        Ok(())
    }
}

/// The verbs that all event-driven methods share.
pub trait EventMethod {
    /// Plays all events up to time `until` (s); the state is then exactly that at `until`. Exact methods keep
    /// the time of the next event, so that the course does not depend on when it is looked at.
    ///
    /// # Errors
    /// A propensity that is negative or not finite, or a count below zero.
    fn advance(&mut self, until: f64) -> Result<(), RunError>;

    /// State and books as of the last call of [`EventMethod::advance`].
    fn ledger(&self) -> &Ledger;

    /// Time reached, s.
    fn time(&self) -> f64 {
        self.ledger().time
    }

    /// Molecules, voxel by voxel.
    fn amounts(&self) -> &[f64] {
        &self.ledger().amounts
    }
}
