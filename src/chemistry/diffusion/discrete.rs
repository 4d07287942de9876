//! Discrete molecules: an exact sample of the frozen diffusion operator by multinomial moves.
//!
//! Molecules move independently between reactions, so those of one voxel are split by binomials into the
//! ones that jump at least once, at least twice, … and each lot is moved by one multinomial. The cost is
//! that of the jumps, not of the molecules. The lots of voxels with few molecules are moved one by one.
//!
//! A bath (a held voxel, a door in a surface) keeps its count while it sends and takes: with n molecules it sends
//! Poisson(n P(K ≥ s)) virtual jumps at stage s, which is the law of hops of constant rate at uniform times in the step.

use super::few::Few;
use super::{Bath, HopTable, Jumps, Open};
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
    /// Number of the bath at a node, from 1; empty if there is none.
    bath: Vec<u32>,
}

/// Chance of a further emission below which a bath has done with a step: expected molecules.
const NO_MORE: f64 = 1e-18;

/// Molecules per voxel that enter by a door from which on each voxel gets a number of its own.
const PER_VOXEL: f64 = 8.0;

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
    /// `baths` are its held voxels and the doors of the table, which book what passes; doors send into `open` voxels.
    /// Returns the hops from one row to another.
    pub fn diffuse<R: Rng>(
        &mut self,
        table: &HopTable,
        jumps: &Jumps,
        (amounts, offset, stride): (&mut [f64], usize, usize),
        (baths, open): (&mut [Bath], Open),
        random: &mut R,
    ) -> u64 {
        let mut amounts = Amounts { all: amounts, offset, stride };
        let mut hops = 0;
        self.begin(&mut amounts, table, baths);
        let source: f64 = baths.iter().map(|bath| bath.mean).sum();
        // Molecules that go by voxel.
        let mut many = true;
        for (stage, (&tail, &onward)) in jumps.tail.iter().zip(&jumps.onward).enumerate() {
            self.stop_singles(&mut amounts, onward, random);
            let mut moving = 0;
            if many {
                moving = self.set_out(table, &mut amounts, onward, stage == 0, &mut hops, random);
            }
            hops += self.move_singles(table, random);
            for bath in baths.iter_mut().filter(|bath| bath.mean > 0.0) {
                let node = bath.node as usize;
                if node >= table.voxels() {
                    let going = self.enter(table, node, bath.mean * tail, open, random);
                    moving += going;
                    bath.sent += going as f64;
                    hops += going;
                    continue;
                }
                let going = poisson(random, bath.mean * tail);
                if going > 0 {
                    moving += going;
                    bath.sent += going as f64;
                    let staying = self.next[node];
                    table.scatter(node, going, &mut self.next, random);
                    hops += going - (self.next[node] - staying);
                }
            }
            for bath in &mut *baths {
                let taken = std::mem::take(&mut self.next[bath.node as usize]);
                moving -= taken;
                bath.taken += taken as f64;
            }
            if !baths.is_empty() {
                let numbers = &self.bath;
                self.single.retain(|&i| match numbers[i as usize] {
                    0 => true,
                    number => {
                        baths[number as usize - 1].taken += 1.0;
                        false
                    }
                });
            }
            std::mem::swap(&mut self.carried, &mut self.next);
            many = moving > 0;
            if !many && self.single.is_empty() && source * tail < NO_MORE {
                return hops;
            }
        }
        // Whoever is still on the way has reached a stage that has no further one within rounding.
        for (i, count) in self.carried[..table.voxels()].iter_mut().enumerate() {
            *amounts.at(i) += std::mem::take(count) as f64;
        }
        for i in self.single.drain(..) {
            *amounts.at(i as usize) += 1.0;
        }
        hops
    }

    fn begin(&mut self, amounts: &mut Amounts, table: &HopTable, baths: &[Bath]) {
        let (voxels, nodes) = (table.voxels(), table.nodes());
        self.carried.clear();
        self.carried.extend(
            amounts.all[amounts.offset..].iter().step_by(amounts.stride).take(voxels).map(|&n| n as u64),
        );
        self.carried.resize(nodes, 0);
        self.next.resize(nodes, 0);
        self.single.clear();
        self.bath.clear();
        if !baths.is_empty() {
            self.bath.resize(nodes, 0);
        }
        for (number, bath) in (1..).zip(baths) {
            self.carried[bath.node as usize] = 0;
            self.bath[bath.node as usize] = number;
        }
    }

    /// Lets molecules enter `open` voxels by a door that sends `mean` of them into all; returns how many do.
    fn enter<R: Rng>(&mut self, table: &HopTable, door: usize, mean: f64, open: Open, random: &mut R) -> u64 {
        let row = table.row(door);
        let mut entered = 0;
        if mean < PER_VOXEL * row.len() as f64 {
            for _ in 0..poisson(random, mean) {
                let j = table.jump(door, random);
                if open(j) {
                    self.next[j] += 1;
                    entered += 1;
                }
            }
            return entered;
        }
        for (j, p) in row.filter(|&(j, _)| open(j)) {
            let count = poisson(random, mean * p);
            self.next[j] += count;
            entered += count;
        }
        entered
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
        hops: &mut u64,
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
                    *hops += going - (self.next[i] - staying);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::diffusion::ALL;
    use crate::chemistry::diffusion::continuous::tests::between_surfaces;
    use crate::random::{Purpose, stream};

    #[test]
    fn molecules_through_surfaces_are_poisson() {
        // Between surfaces from nothing: the numbers are independent Poisson, with the means of the exponential.
        let (table, means) = between_surfaces();
        let mut random = stream(41, 0, Purpose::Diffusion);
        let (jumps, _) = Jumps::expected(table.rate * 2.5);
        let baths = || (5..).zip(&means).map(|(node, &mean)| Bath::new(node, mean)).collect::<Vec<_>>();
        let (mut exact, mut passed) = ([0.0; 5], baths());
        crate::chemistry::diffusion::continuous::Flow::default().diffuse(
            &table,
            &jumps,
            (&mut exact, 0, 1),
            (&mut passed, ALL),
        );
        let (runs, mut walkers) = (40_000, Walkers::default());
        let (mut sum, mut squares, mut doors) = ([0.0; 5], [0.0; 5], [0.0; 3]);
        for _ in 0..runs {
            let (mut amounts, mut seen) = ([0.0; 5], baths());
            walkers.diffuse(&table, &jumps, (&mut amounts, 0, 1), (&mut seen, ALL), &mut random);
            let through: f64 = seen.iter().map(Bath::emitted).sum();
            assert_eq!(through, amounts.iter().sum::<f64>());
            for (i, n) in amounts.into_iter().enumerate() {
                sum[i] += n;
                squares[i] += n * n;
            }
            (0..3).for_each(|k| doors[k] += seen[k].sent + seen[k].taken);
        }
        let count = f64::from(runs);
        // Five standard errors; 13 comparisons, chance 1e-5 in all.
        for i in 0..5 {
            let (mean, m) = (sum[i] / count, exact[i]);
            assert!((mean - m).abs() < 5.0 * (m / count).sqrt(), "{i}: {mean} {m}");
            let variance = squares[i] / count - mean * mean;
            // Of the variance of Poisson numbers: m + 2 m².
            assert!((variance - m).abs() < 5.0 * ((m + 2.0 * m * m) / count).sqrt(), "{i}: {variance} {m}");
        }
        for k in 0..3 {
            let m = passed[k].sent + passed[k].taken;
            assert!((doors[k] / count - m).abs() < 5.0 * (m / count).sqrt(), "{k}: {} {m}", doors[k] / count);
        }
    }
}
