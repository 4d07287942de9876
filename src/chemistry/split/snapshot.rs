//! What must be kept of a realization to go on with it later, to the bit.

use super::{Counters, Modes, SplitState};
use crate::chemistry::reactor::Reactor;
use crate::random::Stream;
use serde::{Deserialize, Serialize};

/// The state of one realization between two steps.
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
    /// Random streams: reactions, hops, reservoirs, changes of representation.
    pub streams: [Stream; 4],
}

impl SplitState {
    /// The state as it is now.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let emission = self.held_mean.iter().copied().enumerate().filter(|(_, mean)| !mean.is_nan());
        let streams = [&self.reactions, &self.hops, &self.reservoirs, &self.changing];
        Snapshot {
            amounts: self.amounts.clone(),
            supplied: self.supplied.clone(),
            counters: self.counters,
            clocks: self.clocks.clone(),
            emission: emission.collect(),
            modes: self.modes.clone(),
            fired: self.fired.clone(),
            withheld: self.withheld,
            streams: streams.map(Clone::clone),
        }
    }

    /// The realization at a snapshot. `None` if the snapshot belongs to another number of species or voxels.
    #[must_use]
    pub fn resume(reactor: &Reactor, snapshot: Snapshot) -> Option<SplitState> {
        let slots = snapshot.amounts.len();
        let mut state = SplitState::new(reactor, snapshot.amounts, 0, 0);
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
        [state.reactions, state.hops, state.reservoirs, state.changing] = snapshot.streams;
        for (slot, mean) in snapshot.emission {
            state.emit_by(slot, mean);
        }
        Some(state)
    }
}
