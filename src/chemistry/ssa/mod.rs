//! Event-driven exact methods: every reaction and every hop is an event; no splitting error.
//!
//! All reactions are sampled, also those of continuous species (by whole molecules); hybrid and continuous
//! models are stepped by [`crate::chemistry::split`].

pub mod direct;
pub mod events;
pub mod heap;
pub mod next_reaction;
pub mod next_subvolume;

pub use crate::chemistry::split::Counters;
pub use direct::Direct;
pub use next_reaction::NextReaction;
pub use next_subvolume::NextSubvolume;

use crate::error::RunError;

/// The verbs that all event-driven methods share.
pub trait EventMethod {
    /// Plays all events up to time `until` (s); the state is then exactly that at `until`. The time of the
    /// next event is kept, so that the course does not depend on when it is looked at.
    ///
    /// # Errors
    /// A propensity that is negative or not finite, or a count below zero.
    fn advance(&mut self, until: f64) -> Result<(), RunError>;

    /// Time reached, s.
    fn time(&self) -> f64;

    /// Molecules, voxel by voxel.
    fn amounts(&self) -> &[f64];

    /// Net molecules of each species brought in by held amounts.
    fn supplied(&self) -> &[f64];

    /// Events of each reaction so far.
    fn fired(&self) -> &[u64];

    /// Events and hops so far.
    fn counters(&self) -> Counters;
}
