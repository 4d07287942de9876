//! What the samplers need to know of a domain besides amounts, volumes and links.

use crate::chemistry::propensity::Propensities;

/// A set of at most 64 groups of voxels, as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupSet(pub u64);

impl GroupSet {
    /// Every group.
    pub const ALL: GroupSet = GroupSet(u64::MAX);

    /// Whether the set holds group `group`.
    #[inline]
    #[must_use]
    pub fn holds(self, group: u8) -> bool {
        self.0 >> group & 1 == 1
    }
}

/// The chemistry of a run, compiled once and shared by all realizations.
///
/// Amounts are `f64`, voxel by voxel: species s of voxel i stands at `amounts[i * species + s]`;
/// discrete species hold whole numbers (exact below 2^53). A voxel has a home group (where it was made,
/// decides which species may live there) and a current group (a zone it is passing, decides with the home
/// group which reactions happen).
#[derive(Clone, Debug)]
pub struct Reactor {
    /// Names of the species, for messages.
    pub species: Vec<String>,
    /// Names of the reactions, for messages.
    pub reactions: Vec<String>,
    pub propensities: Propensities,
    /// Whether a species is carried as whole molecules.
    pub discrete: Vec<bool>,
    /// Diffusivity of each species, m²/s.
    pub diffusivity: Vec<f64>,
    /// Home groups each species may live in.
    pub habitat: Vec<GroupSet>,
    /// Groups (home or current) in which each reaction happens.
    pub active: Vec<GroupSet>,
}
