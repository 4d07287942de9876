//! Neighbour lists with a skin that serve many steps, in blocks of particles that lie together.

use rayon::prelude::*;

use crate::fluid::domain::{Domain, Shortest};
use crate::fluid::neighbours::Grid;
use crate::fluid::particles::Side;
use crate::vector::Vector;

/// A pair within the cut-off as the density sweep leaves it for what follows.
#[derive(Clone, Copy, Debug)]
pub struct Contact<const D: usize> {
    /// x_i - x_j, m.
    pub x: Vector<D>,
    /// F in the row of a fluid particle, W in that of a solid one; r² until the density sweep has seen it.
    pub weight: f64,
    /// F of the shift's own kernel, in the row of a fluid particle.
    pub f_shift: f64,
    pub j: u32,
}

/// Marks a candidate that is seen round a periodic axis; fewer than 2^31 particles fit any memory of today.
const TURNED: u32 = 1 << 31;

/// Lists of candidates, one a particle of a block, and those of them within the cut-off.
#[derive(Clone, Debug, Default)]
pub struct Rows<const D: usize> {
    ends: Vec<u32>,
    list: Vec<u32>,
    contact_ends: Vec<u32>,
    /// The first `contact_ends.last()` are in use.
    contacts: Vec<Contact<D>>,
}

impl<const D: usize> Rows<D> {
    /// Contacts of row `row`.
    #[inline]
    #[must_use]
    pub fn row(&self, row: usize) -> &[Contact<D>] {
        let start = if row == 0 { 0 } else { self.contact_ends[row - 1] };
        &self.contacts[start as usize..self.contact_ends[row] as usize]
    }

    /// Contacts of row `row`, to be weighed.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [Contact<D>] {
        let start = if row == 0 { 0 } else { self.contact_ends[row - 1] };
        &mut self.contacts[start as usize..self.contact_ends[row] as usize]
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

    /// Lists particle `j`, seen round a periodic axis if `turned`.
    fn push(&mut self, j: usize, turned: bool) {
        self.list.push(j as u32 | if turned { TURNED } else { 0 });
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
            if self.contacts.len() < needed {
                // A little more at a time: doubling would waste what the lists of a million particles take.
                self.contacts.reserve_exact(needed + 256 - self.contacts.len());
                let none = Contact { x: Vector::zeros(), weight: 0.0, f_shift: 0.0, j: 0 };
                self.contacts.resize(needed + 256, none);
            }
            let here = positions[first + row];
            let into = &mut self.contacts[found..needed];
            let mut taken = 0;
            for &candidate in candidates {
                let j = candidate & !TURNED;
                let x = separation(&here, &positions[j as usize], candidate & TURNED != 0);
                let r2 = x.norm_squared();
                // Written always, kept if near: no branch to be guessed.
                into[taken] = Contact { x, weight: r2, f_shift: 0.0, j };
                taken += usize::from(r2 < limit);
            }
            found += taken;
            self.contact_ends.push(found as u32);
            start = end as usize;
        }
    }
}

/// A run of particles that lie together, with its neighbour lists and its share of the pairs of this step.
#[derive(Clone, Debug, Default)]
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
    #[must_use]
    pub fn row(&self, row: usize) -> &[Contact<D>] {
        self.walls.row(row)
    }

    /// Pairs within the cut-off, each counted once from either side.
    #[must_use]
    pub fn pairs(&self) -> u64 {
        2 * self.inner.contacts() + self.outer.contacts() + self.walls.contacts()
    }

    /// Finds the contacts among the candidates.
    pub fn find(&mut self, cutoff: f64, shortest: &Shortest<D>, positions: &[Vector<D>]) {
        let first = self.first;
        self.inner.find(first, cutoff, positions, |a, b, turned| shortest.known(a, b, turned));
        self.outer.find(first, cutoff, positions, |a, b, turned| shortest.known(a, b, turned));
        // Solids are put back into the box at every step.
        self.walls.find(first, cutoff, positions, |a, b, _| shortest.separation(a, b));
    }

    /// Fills the lists: a fluid particle sees everyone, a solid one only fluid.
    fn fill(
        &mut self,
        grid: &Grid<D>,
        positions: &[Vector<D>],
        sides: &[Side<D>],
        solids: bool,
        mutual: bool,
    ) {
        let mine = self.first..(self.first + Self::SIZE).min(positions.len());
        self.walls.clear();
        self.near_solid.clear();
        for i in mine.clone() {
            let solid = sides[i].is_solid();
            let before = self.walls.list.len();
            if solids {
                grid.for_each_candidate(&positions[i], positions, |j, _| {
                    if sides[j].is_solid() != solid {
                        self.walls.push(j, false);
                    }
                });
            }
            self.walls.end_row();
            self.near_solid.push(!solid && self.walls.list.len() > before);
        }
        self.fill_fluid(mine, grid, positions, sides, mutual);
    }

    /// Fills the lists of pairs of fluid particles.
    fn fill_fluid(
        &mut self,
        mine: std::ops::Range<usize>,
        grid: &Grid<D>,
        positions: &[Vector<D>],
        sides: &[Side<D>],
        mutual: bool,
    ) {
        self.inner.clear();
        self.outer.clear();
        for i in mine.clone() {
            let alone = !mutual || self.near_solid[i - mine.start];
            if !sides[i].is_solid() {
                grid.for_each_candidate(&positions[i], positions, |j, turned| {
                    if j == i || sides[j].is_solid() {
                        return;
                    }
                    if alone || !mine.contains(&j) || self.near_solid[j - mine.start] {
                        self.outer.push(j, turned);
                    } else if j > i {
                        self.inner.push(j, turned);
                    }
                });
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
    let grid = Grid::build(positions, domain, cutoff);
    let solids = sides.iter().any(Side::is_solid);
    blocks.resize_with(positions.len().div_ceil(Block::<D>::SIZE), Block::default);
    blocks.par_iter_mut().enumerate().for_each(|(k, block)| {
        block.first = k * Block::<D>::SIZE;
        block.fill(&grid, positions, sides, solids, mutual);
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
        for block in &mut blocks {
            block.find(cutoff, &domain.shortest(), &positions);
            for row in 0..block.near_solid.len() {
                let i = (block.first + row) as u32;
                assert!(mutual || block.inner.row(row).is_empty());
                found.extend(block.inner.row(row).iter().flat_map(|c| [(i, c.j), (c.j, i)]));
                found.extend(block.outer.row(row).iter().chain(block.row(row)).map(|c| (i, c.j)));
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
