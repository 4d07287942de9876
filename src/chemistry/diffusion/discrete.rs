//! Discrete molecules: an exact sample of the frozen diffusion operator by multinomial moves.
//!
//! Molecules move independently between reactions, so those of one voxel are split by binomials into the
//! ones that jump at least once, at least twice, … and each lot is moved by one multinomial. The cost is
//! that of the jumps, not of the molecules. The lots of voxels with few molecules are moved one by one.
//!
//! A held voxel keeps its count while it emits and absorbs: with n molecules it sends Poisson(n P(K ≥ s))
//! virtual jumps at stage s, which is the law of hops of constant rate at uniform times in the step.

use super::few::Few;
use super::{HopTable, Jumps};
use crate::chemistry::sampling_numbers::{Trials, poisson};
use rand::Rng;

/// Molecules of one species on their way, reused from step to step.
#[derive(Clone, Debug, Default)]
pub struct Walkers {
    /// Molecules by voxel.
    carried: Vec<u64>,
    next: Vec<u64>,
    /// Voxels of the molecules that go one by one.
    single: Vec<u32>,
    few: Few,
    /// Whether a voxel is held; empty if none is.
    held: Vec<bool>,
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

/// The amounts of one species: that of voxel i stands at `offset + i * stride`.
struct Amounts<'a> {
    all: &'a mut [f64],
    offset: usize,
    stride: usize,
}

impl Amounts<'_> {
    #[inline]
    fn at(&mut self, i: usize) -> &mut f64 {
        &mut self.all[self.offset + i * self.stride]
    }
}

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
        let mut amounts = Amounts { all: amounts, offset, stride };
        let mut moved = Moved::default();
        self.begin(&mut amounts, voxels, held);
        let source: f64 = held.iter().map(|&(_, n)| n).sum();
        // Molecules that go by voxel.
        let mut many = true;
        for (stage, (&tail, &onward)) in jumps.tail.iter().zip(&jumps.onward).enumerate() {
            self.stop_singles(&mut amounts, onward, random);
            let mut moving = 0;
            if many {
                moving = self.set_out(table, &mut amounts, onward, stage == 0, &mut moved, random);
            }
            moved.hops += self.move_singles(table, random);
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
            if !held.is_empty() {
                let before = self.single.len();
                let marks = &self.held;
                self.single.retain(|&i| !marks[i as usize]);
                moved.emitted -= (before - self.single.len()) as f64;
            }
            std::mem::swap(&mut self.carried, &mut self.next);
            many = moving > 0;
            if !many && self.single.is_empty() && source * tail < NO_MORE {
                return moved;
            }
        }
        // Whoever is still on the way has reached a stage that has no further one within rounding.
        for (i, count) in self.carried.iter_mut().enumerate() {
            *amounts.at(i) += std::mem::take(count) as f64;
        }
        for i in self.single.drain(..) {
            *amounts.at(i as usize) += 1.0;
        }
        moved
    }

    fn begin(&mut self, amounts: &mut Amounts, voxels: usize, held: &[(u32, f64)]) {
        self.carried.clear();
        self.carried.extend(
            amounts.all[amounts.offset..].iter().step_by(amounts.stride).take(voxels).map(|&n| n as u64),
        );
        self.next.resize(voxels, 0);
        self.single.clear();
        self.held.clear();
        if !held.is_empty() {
            self.held.resize(voxels, false);
        }
        for &(h, _) in held {
            self.carried[h as usize] = 0;
            self.held[h as usize] = true;
        }
    }

    /// Those single molecules that make no further jump stay where they are.
    #[inline]
    fn stop_singles<R: Rng>(&mut self, amounts: &mut Amounts, onward: f64, random: &mut R) {
        let mut kept = 0;
        for k in 0..self.single.len() {
            let i = self.single[k];
            // No branch: which molecule goes on is as good as random.
            let goes = random.random::<f64>() < onward;
            *amounts.at(i as usize) += f64::from(u8::from(!goes));
            self.single[kept] = i;
            kept += usize::from(goes);
        }
        self.single.truncate(kept);
    }

    /// Takes those that jump out of every voxel: a few become single molecules, many go to `next`.
    /// Returns how many are in `next`.
    fn set_out<R: Rng>(
        &mut self,
        table: &HopTable,
        amounts: &mut Amounts,
        onward: f64,
        first: bool,
        moved: &mut Moved,
        random: &mut R,
    ) -> u64 {
        let lot = Trials::new(onward);
        self.few.of(onward);
        let mut moving = 0;
        for i in 0..self.carried.len() {
            let count = std::mem::take(&mut self.carried[i]);
            if count == 0 {
                continue;
            }
            let going = if count <= Few::MOST as u64 {
                let going = self.few.draw(random, count as usize);
                // The place of the common small numbers is made first, so that their loop needs no branch.
                let end = self.single.len() + going;
                self.single.extend([i as u32; 4]);
                self.single.resize(end, i as u32);
                going as u64
            } else {
                let going = lot.draw(random, count);
                if going > 0 {
                    moving += going;
                    let staying = self.next[i];
                    table.scatter(i, going, &mut self.next, random);
                    moved.hops += going - (self.next[i] - staying);
                }
                going
            };
            // The first lot leaves from the state itself; those that stay are already in place.
            *amounts.at(i) += if first { -(going as f64) } else { (count - going) as f64 };
        }
        moving
    }

    /// One jump of every single molecule; returns the hops.
    #[inline]
    fn move_singles<R: Rng>(&mut self, table: &HopTable, random: &mut R) -> u64 {
        let mut hops = 0;
        for i in &mut self.single {
            let j = table.jump(*i as usize, random) as u32;
            hops += u64::from(j != *i);
            *i = j;
        }
        hops
    }
}
