//! Neighbour lists with a skin that serve many steps, in blocks of particles that lie together.

use rayon::prelude::*;

use crate::fluid::candidates::{Candidates, TURNED};
use crate::fluid::particles::Side;
use crate::fluid::wide::fill_lists;
use crate::space::domain::{Domain, Shortest};
use crate::space::kernel::Kernel;
use crate::vector::Vector;
use serde::{Deserialize, Serialize};

/// A pair within the cut-off.
#[derive(Clone, Copy, Debug)]
pub struct Contact<const D: usize> {
    /// x_i - x_j, m.
    pub x: Vector<D>,
    /// F, but W in the row of a solid particle.
    pub weight: f64,
    /// F of the shift's own kernel, zero without a shift.
    pub f_shift: f64,
    /// 1/|x|², m^-2.
    pub inverse_square: f64,
    pub j: u32,
}

/// Lists of candidates, one a particle of a block, and those of them within the cut-off.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Rows<const D: usize> {
    ends: Vec<u32>,
    list: Vec<u32>,
    #[serde(skip)]
    contact_ends: Vec<u32>,
    /// Of the contacts; of this and the next three the first `contact_ends.last()` are in use. Few bytes
    /// each: those of many particles go to memory in one sweep and come back in another.
    #[serde(skip)]
    others: Vec<u32>,
    /// x_i - x_j, m.
    #[serde(skip)]
    ways: Vec<Vector<D>>,
    /// r² until weighed, then [`Contact::weight`]; apart from `ways` so that kernels are evaluated many at a time.
    #[serde(skip)]
    weights: Vec<f64>,
    /// F of the shift's own kernel; empty without a shift.
    #[serde(skip)]
    shifts: Vec<f64>,
}

impl<const D: usize> Rows<D> {
    /// Contacts of row `row`.
    #[inline(always)]
    pub fn row(&self, row: usize) -> impl Iterator<Item = Contact<D>> + '_ {
        let start = if row == 0 { 0 } else { self.contact_ends[row - 1] as usize };
        let mine = start..self.contact_ends[row] as usize;
        let (others, ways, weights) =
            (&self.others[mine.clone()], &self.ways[mine.clone()], &self.weights[mine.clone()]);
        let shifts = self.shifts.get(mine).unwrap_or(&[]);
        let all = others.iter().zip(ways).zip(weights).enumerate();
        all.map(|(n, ((&j, &x), &weight))| Contact {
            x,
            weight,
            f_shift: shifts.get(n).copied().unwrap_or(0.0),
            inverse_square: 1.0 / x.norm_squared(),
            j,
        })
    }

    /// Puts F in the place of r², and beside it F of the shift's kernel.
    #[inline(always)]
    fn weigh(&mut self, kernel: &Kernel<D>, shift: Option<&Kernel<D>>) {
        let count = self.contacts() as usize;
        let room = self.weights.len();
        let weights = &mut self.weights[..count];
        if shift.is_some() && self.shifts.len() < count {
            self.shifts.reserve_exact(room - self.shifts.len());
            self.shifts.resize(count, 0.0);
        }
        // As many at a time as stay near at hand.
        const MANY: usize = 256;
        for (n, weights) in weights.chunks_mut(MANY).enumerate() {
            for weight in &mut *weights {
                *weight = weight.sqrt();
            }
            if let Some(shift) = shift {
                shift.fs(weights, &mut self.shifts[n * MANY..][..weights.len()]);
            }
            kernel.fs_in_place(weights);
        }
    }

    /// Puts W in the place of F in row `row`.
    fn weigh_by_value(&mut self, row: usize, kernel: &Kernel<D>) {
        let start = if row == 0 { 0 } else { self.contact_ends[row - 1] as usize };
        let mine = start..self.contact_ends[row] as usize;
        for (weight, way) in self.weights[mine.clone()].iter_mut().zip(&self.ways[mine]) {
            *weight = kernel.value(way.norm_squared().sqrt());
        }
    }

    /// Number of contacts.
    #[must_use]
    pub fn contacts(&self) -> u64 {
        u64::from(self.contact_ends.last().copied().unwrap_or(0))
    }

    fn clear(&mut self) {
        self.ends.clear();
        self.list.clear();
    }

    fn end_row(&mut self) {
        self.ends.push(self.list.len() as u32);
    }

    /// Keeps of the candidates of rows from particle `first` on those within `cutoff` (m), their r² as weight.
    #[inline(always)]
    fn find(
        &mut self,
        first: usize,
        cutoff: f64,
        positions: &[Vector<D>],
        separation: impl Fn(&Vector<D>, &Vector<D>, bool) -> Vector<D>,
    ) {
        let limit = cutoff * cutoff;
        self.contact_ends.clear();
        let (mut start, mut found) = (0, 0);
        for (row, &end) in self.ends.iter().enumerate() {
            let candidates = &self.list[start..end as usize];
            let needed = found + candidates.len();
            if self.ways.len() < needed {
                // A little more at a time: doubling would waste what the lists of a million particles take.
                let (more, length) = (needed + 256 - self.ways.len(), needed + 256);
                self.others.reserve_exact(more);
                self.others.resize(length, 0);
                self.ways.reserve_exact(more);
                self.ways.resize(length, Vector::zeros());
                self.weights.reserve_exact(more);
                self.weights.resize(length, 0.0);
            }
            let here = positions[first + row];
            let room = found..needed;
            let (others, ways, weights) =
                (&mut self.others[room.clone()], &mut self.ways[room.clone()], &mut self.weights[room]);
            let mut taken = 0;
            for &candidate in candidates {
                let j = candidate & !TURNED;
                let x = separation(&here, &positions[j as usize], candidate & TURNED != 0);
                let r2 = x.norm_squared();
                // Written always, kept if near: no branch to be guessed.
                (others[taken], ways[taken], weights[taken]) = (j, x, r2);
                taken += usize::from(r2 < limit);
            }
            found += taken;
            self.contact_ends.push(found as u32);
            start = end as usize;
        }
    }
}

/// A run of particles that lie together, with its neighbour lists and its share of the pairs of this step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Block<const D: usize> {
    /// First particle of the block.
    pub first: usize,
    /// Whether a fluid particle has any solid in its list.
    pub near_solid: Vec<bool>,
    /// Pairs of two fluid particles of the block away from solids, in the row of the first of them.
    pub inner: Rows<D>,
    /// Other pairs of two fluid particles, in the rows of both.
    pub outer: Rows<D>,
    /// Pairs of a fluid and a solid particle, in the rows of both.
    pub walls: Rows<D>,
}

impl<const D: usize> Block<D> {
    /// Particles in a block, enough work for a thread to be worth waking. The larger, the fewer pairs cross from
    /// one block to another; the smaller, the more evenly threads share the work.
    pub const SIZE: usize = if D == 3 { 1024 } else { 512 };

    /// Contacts of row `row` between fluid and solid: of a fluid particle its solid ones, of a solid one its fluid.
    #[inline]
    pub fn row(&self, row: usize) -> impl Iterator<Item = Contact<D>> + '_ {
        self.walls.row(row)
    }

    /// Pairs within the cut-off, each counted once from either side.
    #[must_use]
    pub fn pairs(&self) -> u64 {
        2 * self.inner.contacts() + self.outer.contacts() + self.walls.contacts()
    }

    /// Finds the contacts among the candidates and weighs them.
    #[inline(always)]
    pub fn find(
        &mut self,
        kernel: &Kernel<D>,
        shift: Option<&Kernel<D>>,
        shortest: &Shortest<D>,
        (positions, sides): (&[Vector<D>], &[Side<D>]),
    ) {
        let (first, cutoff) = (self.first, kernel.cutoff());
        self.inner.find(first, cutoff, positions, |a, b, turned| shortest.known(a, b, turned));
        self.outer.find(first, cutoff, positions, |a, b, turned| shortest.known(a, b, turned));
        // Solids are put back into the box at every step.
        self.walls.find(first, cutoff, positions, |a, b, _| shortest.separation(a, b));
        for rows in [&mut self.inner, &mut self.outer, &mut self.walls] {
            rows.weigh(kernel, shift);
        }
        if self.walls.contacts() > 0 {
            for row in (0..self.near_solid.len()).filter(|&row| sides[first + row].is_solid()) {
                self.walls.weigh_by_value(row, kernel);
            }
        }
    }

    /// Fills the lists: a fluid particle sees everyone, a solid one only fluid.
    #[inline(always)]
    pub(super) fn fill(
        &mut self,
        all: &Candidates<D>,
        positions: &[Vector<D>],
        sides: &[Side<D>],
        solids: bool,
        mutual: bool,
    ) {
        let mine = self.first..(self.first + Self::SIZE).min(positions.len());
        let mut found = Vec::new();
        self.walls.clear();
        self.near_solid.clear();
        for i in mine.clone() {
            let solid = sides[i].is_solid();
            let before = self.walls.list.len();
            if solids {
                let other = |&j: &u32| sides[(j & !TURNED) as usize].is_solid() != solid;
                self.walls.list.extend(all.near(&positions[i], &mut found).iter().copied().filter(other));
            }
            self.walls.end_row();
            self.near_solid.push(!solid && self.walls.list.len() > before);
        }
        self.inner.clear();
        self.outer.clear();
        let (mut inner, mut outer) = (Vec::new(), Vec::new());
        for i in mine.clone() {
            if !sides[i].is_solid() {
                let alone = !mutual || self.near_solid[i - mine.start];
                let near = all.near(&positions[i], &mut found);
                if inner.len() < near.len() {
                    inner.resize(near.len(), 0);
                    outer.resize(near.len(), 0);
                }
                let (mut once, mut twice) = (0, 0);
                for &candidate in near {
                    let j = (candidate & !TURNED) as usize;
                    let fluid = j != i && !(solids && sides[j].is_solid());
                    let shared = !alone && mine.contains(&j) && !(solids && self.near_solid[j - mine.start]);
                    // Written always, kept where it belongs: no branch to be guessed.
                    (inner[once], outer[twice]) = (candidate, candidate);
                    once += usize::from(fluid & shared & (j > i));
                    twice += usize::from(fluid & !shared);
                }
                self.inner.list.extend_from_slice(&inner[..once]);
                self.outer.list.extend_from_slice(&outer[..twice]);
            }
            self.inner.end_row();
            self.outer.end_row();
        }
    }
}

/// Neighbour lists of all particles, in blocks of [`Block::SIZE`]; `cutoff` (m) includes the skin. Pairs are listed once
/// where they can be only if forces are `mutual`.
pub fn build_blocks<const D: usize>(
    blocks: &mut Vec<Block<D>>,
    positions: &[Vector<D>],
    sides: &[Side<D>],
    domain: &Domain<D>,
    cutoff: f64,
    mutual: bool,
) {
    let all = Candidates::new(positions, domain, cutoff);
    let solids = sides.iter().any(Side::is_solid);
    blocks.resize_with(positions.len().div_ceil(Block::<D>::SIZE), Block::default);
    blocks.par_iter_mut().enumerate().for_each(|(k, block)| {
        block.first = k * Block::<D>::SIZE;
        fill_lists(block, &all, positions, sides, solids, mutual);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::particles::Material;
    use crate::fluid::terms::tests::side;
    use rand::{Rng, SeedableRng};

    /// Every pair once from either side, whatever the block, the axis or the solid between.
    fn lists_all<const D: usize>(n: usize, length: f64, cutoff: f64, solids: bool, mutual: bool) {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(13);
        let domain = Domain { min: Vector::zeros(), max: Vector::from_element(length), periodic: [true; D] };
        let mut positions: Vec<Vector<D>> =
            (0..n).map(|_| Vector::from_fn(|_, _| random.random::<f64>() * length)).collect();
        let order = crate::fluid::order::along_a_curve(&positions, &domain, cutoff);
        positions = order.iter().map(|&i| positions[i as usize]).collect();
        let sides: Vec<Side<D>> = positions
            .iter()
            .map(|x| {
                let solid = solids && x[0] < 0.3 * length;
                Side { material: if solid { Material::NoSlip } else { Material::Fluid }, ..side(1.0, 0.0) }
            })
            .collect();
        let mut blocks = Vec::new();
        build_blocks(&mut blocks, &positions, &sides, &domain, 1.1 * cutoff, mutual);
        let mut found = Vec::new();
        let kernel = Kernel::new(crate::fluid::KernelKind::Lucy, cutoff);
        for block in &mut blocks {
            block.find(&kernel, None, &domain.shortest(), (&positions, &sides));
            for row in 0..block.near_solid.len() {
                let i = (block.first + row) as u32;
                assert!(mutual || block.inner.row(row).next().is_none());
                found.extend(block.inner.row(row).flat_map(|c| [(i, c.j), (c.j, i)]));
                found.extend(block.outer.row(row).chain(block.row(row)).map(|c| (i, c.j)));
            }
        }
        found.sort_unstable();
        let mut all = Vec::new();
        for i in 0..n {
            for j in (0..n).filter(|&j| j != i && !(sides[i].is_solid() && sides[j].is_solid())) {
                if domain.separation(&positions[i], &positions[j]).norm() < cutoff {
                    all.push((i as u32, j as u32));
                }
            }
        }
        assert_eq!(found.len() as u64, blocks.iter().map(Block::pairs).sum::<u64>());
        assert_eq!(found, all);
    }

    #[test]
    fn blocks_list_every_pair_once_from_either_side() {
        lists_all::<1>(1200, 100.0, 0.4, false, true);
        lists_all::<2>(1500, 10.0, 0.6, false, true);
        lists_all::<2>(1500, 10.0, 0.6, true, true);
        lists_all::<2>(700, 10.0, 0.6, true, false);
        lists_all::<3>(2200, 5.0, 0.7, true, true);
    }
}
