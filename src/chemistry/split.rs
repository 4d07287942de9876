//! Particle chemistry: reaction and diffusion one after the other, each sampled exactly on frozen voxels.
//!
//! A step of length τ is `react τ/2, diffuse τ/2 | move the particles | diffuse τ/2, react τ/2` (Strang
//! 1968), second order in τ. The frozen geometry is one value, [`Frozen`], shared by all realizations of a
//! flow; what belongs to one realization is its [`SplitState`]. What diffuses passes surfaces in the step of diffusion.

mod bounds;
mod diffuse;
mod estimate;
mod euler;
mod frozen;
mod kinds;
mod mixed;
mod modes;
mod passages;
mod react;
mod snapshot;

pub use bounds::{StepBounds, step_bounds};
pub use estimate::{Feed, SplittingError, splitting_error};
pub use euler::longest_euler_step;
pub use frozen::Frozen;
pub use modes::Modes;
pub use snapshot::Snapshot;

use crate::chemistry::diffusion::continuous::Flow;
use crate::chemistry::diffusion::discrete::Walkers;
use crate::chemistry::rate_equations::RateEquations;
use crate::chemistry::reactor::Reactor;
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};
use mixed::Mixture;

/// What happened so far in a realization.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Counters {
    /// Reaction events.
    pub events: u64,
    /// Hops of molecules from one voxel to another.
    pub hops: u64,
}

/// The chemical state of one realization, with its random streams.
///
/// Booked exactly (in whole numbers for discrete species): total now = total at the start + reactions +
/// `supplied`.
#[derive(Clone, Debug)]
pub struct SplitState {
    /// Molecules, voxel by voxel: species s of voxel i at `i * species + s`.
    pub amounts: Vec<f64>,
    /// Net molecules of each species that reservoirs (held amounts, sponges) brought in.
    pub supplied: Vec<f64>,
    pub counters: Counters,
    /// Events of each reaction so far.
    pub fired: Vec<u64>,
    /// Integrated hazard each voxel has left until its next reaction (unit exponentials; Anderson 2007).
    clocks: Vec<f64>,
    /// Mean by which a held amount emits if that is not the amount itself; empty or one per amount.
    held_mean: Vec<f64>,
    /// Expected number of events that did not happen because a continuous amount held less than a molecule.
    pub withheld: f64,
    /// How the hybrid species are carried in each voxel.
    pub modes: Modes,
    reactions: Stream,
    hops: Stream,
    pub(super) reservoirs: Stream,
    changing: Stream,
    walkers: Walkers,
    flow: Flow,
    equations: RateEquations,
    propensities: Vec<f64>,
    mixture: Mixture,
}

impl SplitState {
    /// The state of realization `realization` of a run with seed `seed`, starting from `amounts`
    /// (molecules, voxel by voxel).
    #[must_use]
    pub fn new(reactor: &Reactor, amounts: Vec<f64>, seed: u64, realization: u64) -> SplitState {
        let species = reactor.species_count();
        let voxels = amounts.len() / species.max(1);
        let mut reactions = stream(seed, realization, Purpose::Reactions);
        SplitState {
            amounts,
            supplied: vec![0.0; species],
            counters: Counters::default(),
            fired: vec![0; reactor.propensities.len()],
            clocks: (0..voxels).map(|_| exponential(&mut reactions)).collect(),
            held_mean: Vec::new(),
            reactions,
            hops: stream(seed, realization, Purpose::Diffusion),
            reservoirs: stream(seed, realization, Purpose::Reservoirs),
            changing: stream(seed, realization, Purpose::Representation),
            withheld: 0.0,
            modes: Modes::new(reactor, voxels),
            walkers: Walkers::default(),
            flow: Flow::default(),
            equations: RateEquations::default(),
            propensities: Vec::new(),
            mixture: Mixture::default(),
        }
    }

    /// One Strang step on a geometry that stays: react τ/2, diffuse τ, react τ/2.
    ///
    /// # Errors
    /// As [`SplitState::react`].
    pub fn step(&mut self, reactor: &Reactor, frozen: &Frozen, time: f64, dt: f64) -> Result<(), RunError> {
        self.react(reactor, frozen, time, 0.5 * dt)?;
        self.diffuse(reactor, frozen, time, dt)?;
        self.react(reactor, frozen, time + 0.5 * dt, 0.5 * dt)
    }

    /// Net molecules of species `s` that reactions made so far: events, and for hybrid species the extents of
    /// the rate equations.
    #[must_use]
    pub fn made(&self, reactor: &Reactor, s: usize) -> f64 {
        let by_equations: f64 = self
            .modes
            .extents()
            .iter()
            .enumerate()
            .flat_map(|(r, extent)| reactor.propensities.changes(r).iter().map(move |c| (c, extent)))
            .filter(|(change, _)| change.0 as usize == s)
            .map(|(change, extent)| change.1 * extent)
            .sum();
        reactor.made(&self.fired, s) + by_equations
    }

    /// Molecules of species `s` in all voxels, and what rounding of a hybrid species left over.
    #[must_use]
    pub fn total(&self, s: usize) -> f64 {
        self.amounts.iter().skip(s).step_by(self.supplied.len()).sum::<f64>() + self.modes.left_over(s)
    }

    /// Molecules of discrete species that appeared or vanished since the totals were `start`, outside reactions and
    /// reservoirs: zero unless something is wrong.
    #[must_use]
    pub fn astray(&self, reactor: &Reactor, start: &[f64]) -> f64 {
        /// Amounts of a hybrid species are not whole; less than this of a molecule is rounding.
        const ROUNDING: f64 = 1e-3;
        (0..start.len())
            .filter(|&s| reactor.discrete[s])
            .map(|s| (self.total(s) - start[s] - self.made(reactor, s) - self.supplied[s]).abs())
            .filter(|off| *off >= ROUNDING || off.is_nan())
            .sum()
    }

    /// Notes that held amount `slot` emits by `mean` instead of the amount it shows.
    pub(super) fn emit_by(&mut self, slot: usize, mean: f64) {
        if self.held_mean.is_empty() {
            if mean.is_nan() {
                return;
            }
            self.held_mean = vec![f64::NAN; self.amounts.len()];
        }
        self.held_mean[slot] = mean;
    }

    /// What a held amount emits by, molecules.
    fn emission(&self, slot: usize) -> f64 {
        match self.held_mean.get(slot) {
            Some(&mean) if !mean.is_nan() => mean,
            _ => self.amounts[slot],
        }
    }
}
