//! What must be kept of a realization to go on with it later.
//!
//! Random streams are not kept: a run that may be resumed opens a new period at fixed model times
//! ([`SplitState::open_period`]), interrupted or not, and a resumed run opens the same one.

use super::{Counters, Modes, SplitState};
use crate::chemistry::reactor::Reactor;
use crate::random::{Purpose, mix, stream};
use serde::{Deserialize, Serialize};

/// The state of one realization between two periods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Molecules, voxel by voxel.
    pub amounts: Vec<f64>,
    /// Net molecules of each species brought in by reservoirs.
    pub supplied: Vec<f64>,
    pub counters: Counters,
    /// Hazard left until the next reaction of each voxel.
    pub clocks: Vec<f64>,
    /// Means by which held amounts emit: place among the amounts, and molecules.
    pub emission: Vec<(usize, f64)>,
    /// How hybrid species are carried.
    pub modes: Modes,
    /// Events of each reaction.
    pub fired: Vec<u64>,
    /// Expected events withheld.
    pub withheld: f64,
}

impl SplitState {
    /// The state as it is now.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let emission = self.held_mean.iter().copied().enumerate().filter(|(_, mean)| !mean.is_nan());
        Snapshot {
            amounts: self.amounts.clone(),
            supplied: self.supplied.clone(),
            counters: self.counters,
            clocks: self.clocks.clone(),
            emission: emission.collect(),
            modes: self.modes.clone(),
            fired: self.fired.clone(),
            withheld: self.withheld,
        }
    }

    /// The realization at a snapshot; to be followed by [`SplitState::open_period`].
    /// `None` if the snapshot belongs to another number of species or voxels.
    #[must_use]
    pub fn resume(reactor: &Reactor, snapshot: Snapshot, seed: u64, realization: u64) -> Option<SplitState> {
        let slots = snapshot.amounts.len();
        let mut state = SplitState::new(reactor, snapshot.amounts, seed, realization);
        let fits = snapshot.supplied.len() == state.supplied.len()
            && snapshot.clocks.len() == state.clocks.len()
            && snapshot.fired.len() == state.fired.len()
            && snapshot.modes.fits(&state.modes)
            && snapshot.emission.iter().all(|&(slot, _)| slot < slots);
        if !fits {
            return None;
        }
        state.supplied = snapshot.supplied;
        state.counters = snapshot.counters;
        state.clocks = snapshot.clocks;
        state.modes = snapshot.modes;
        state.fired = snapshot.fired;
        state.withheld = snapshot.withheld;
        for (slot, mean) in snapshot.emission {
            state.emit_by(slot, mean);
        }
        Some(state)
    }

    /// Starts fresh streams keyed by (seed, realization, period); what follows depends on nothing else
    /// than these and the snapshot.
    pub fn open_period(&mut self, seed: u64, realization: u64, period: u64) {
        let key = mix(seed ^ mix(period.wrapping_add(1)));
        self.reactions = stream(key, realization, Purpose::Reactions);
        self.hops = stream(key, realization, Purpose::Diffusion);
        self.reservoirs = stream(key, realization, Purpose::Reservoirs);
        self.changing = stream(key, realization, Purpose::Representation);
    }
}
