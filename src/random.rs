//! Independent random streams, each with a name and a key.
//!
//! A stream is keyed by (seed of the run, realization, purpose), so what one purpose draws never shifts
//! what another gets, and a realization is the same whichever thread or block runs it.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// The generator behind every stream.
pub type Stream = Xoshiro256PlusPlus;

/// What a stream is drawn for; one independent stream each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Placement of particles (jitter); the same for all realizations of a run.
    Placement = 1,
    /// Dealing out the molecules of the initial state.
    Deal = 2,
    /// Hops between voxels.
    Diffusion = 3,
    /// Reaction events.
    Reactions = 4,
    /// Sponges, sources and held amounts.
    Reservoirs = 5,
    /// Thermal noise of the fluid.
    Noise = 6,
    /// Change of a species between whole molecules and real amounts.
    Representation = 7,
    /// Samples drawn again from a sample, for confidence intervals.
    Bootstrap = 8,
    /// Points of a sweep; the same for all realizations.
    Design = 9,
}

/// The stream of one purpose in one realization of a run with this seed.
#[must_use]
pub fn stream(seed: u64, realization: u64, purpose: Purpose) -> Stream {
    // Two rounds of the SplitMix64 finaliser (Steele, Lea & Flood 2014) spread each key over all 64 bits.
    let key = mix(mix(mix(seed) ^ realization) ^ purpose as u64);
    Stream::seed_from_u64(key)
}

/// A bijection of 64 bits: the finaliser of SplitMix64.
#[must_use]
pub fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngCore;

    #[test]
    fn streams_of_different_keys_differ() {
        let mut first: Vec<u64> = Vec::new();
        for seed in 0..4 {
            for realization in 0..4 {
                for purpose in [Purpose::Deal, Purpose::Diffusion, Purpose::Reactions] {
                    first.push(stream(seed, realization, purpose).next_u64());
                }
            }
        }
        first.sort_unstable();
        first.dedup();
        assert_eq!(first.len(), 48);
    }
}
