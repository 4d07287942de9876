//! Discrete molecules: an exact sample of the frozen diffusion operator by multinomial moves.
//!
//! Molecules move independently between reactions, so those of one voxel are split by binomials into the
//! ones that jump at least once, at least twice, … and each lot is moved by one multinomial. The cost is
//! that of the jumps, not of the molecules.
//!
//! A held voxel keeps its count while it emits and absorbs: with n molecules it sends Poisson(n P(K ≥ s))
//! virtual jumps at stage s, which is the law of hops of constant rate at uniform times in the step.

use super::{HopTable, Jumps};
use crate::chemistry::sampling_numbers::{Trials, poisson};
use rand::Rng;

/// Molecules of one species on their way, reused from step to step.
#[derive(Clone, Debug, Default)]
pub struct Walkers {
    carried: Vec<u64>,
    next: Vec<u64>,
}

/// What a diffusion step did besides moving molecules.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Hops from one voxel to another.
    pub hops: u64,
    /// Molecules that left held voxels less those that entered them.
    pub emitted: f64,
}

/// Chance of a further emission below which a held voxel has done with a step: expected molecules.
const NO_MORE: f64 = 1e-18;

impl Walkers {
    /// Moves the discrete species that stands at `amounts[offset + i * stride]` in voxel i by one step.
    /// `held` lists the held voxels and the counts they emit by.
    pub fn diffuse<R: Rng>(
        &mut self,
        table: &HopTable,
        jumps: &Jumps,
        (amounts, offset, stride): (&mut [f64], usize, usize),
        held: &[(u32, f64)],
        random: &mut R,
    ) -> Moved {
        let voxels = table.voxels();
        let mut moved = Moved::default();
        self.carried.clear();
        self.carried.extend(amounts[offset..].iter().step_by(stride).take(voxels).map(|&n| n as u64));
        self.next.resize(voxels, 0);
        for &(h, _) in held {
            self.carried[h as usize] = 0;
        }
        let source: f64 = held.iter().map(|&(_, n)| n).sum();
        for (stage, (&tail, &onward)) in jumps.tail.iter().zip(&jumps.onward).enumerate() {
            let first = stage == 0;
            let lot = Trials::new(onward);
            let mut moving = 0;
            for i in 0..voxels {
                let count = self.carried[i];
                if count == 0 {
                    continue;
                }
                let going = lot.draw(random, count);
                if first {
                    // The first lot leaves from the state itself; those that stay are already in place.
                    amounts[offset + i * stride] -= going as f64;
                } else {
                    amounts[offset + i * stride] += (count - going) as f64;
                }
                self.carried[i] = 0;
                if going > 0 {
                    moving += going;
                    let staying = self.next[i];
                    table.scatter(i, going, &mut self.next, random);
                    moved.hops += going - (self.next[i] - staying);
                }
            }
            for &(h, n) in held {
                let going = poisson(random, n * tail);
                if going > 0 {
                    moving += going;
                    moved.emitted += going as f64;
                    let staying = self.next[h as usize];
                    table.scatter(h as usize, going, &mut self.next, random);
                    moved.hops += going - (self.next[h as usize] - staying);
                }
            }
            for &(h, _) in held {
                let absorbed = std::mem::take(&mut self.next[h as usize]);
                moving -= absorbed;
                moved.emitted -= absorbed as f64;
            }
            std::mem::swap(&mut self.carried, &mut self.next);
            if moving == 0 && source * tail < NO_MORE {
                return moved;
            }
        }
        // Whoever is still on the way has reached a stage that has no further one within rounding.
        for (i, count) in self.carried.iter_mut().enumerate() {
            if *count > 0 {
                amounts[offset + i * stride] += std::mem::take(count) as f64;
            }
        }
        moved
    }
}
