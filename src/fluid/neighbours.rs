//! Who is near whom: a grid of cells, and neighbour lists with a skin that serve many steps.

use rayon::prelude::*;

use crate::fluid::domain::Domain;
use crate::fluid::particles::Side;
use crate::fluid::pass::Contact;
use crate::vector::Vector;

/// Points sorted into cells at least one cut-off wide.
///
/// On a periodic axis pairs are unique only if the box is at least two cut-offs long.
#[derive(Clone, Debug)]
pub struct Grid<const D: usize> {
    domain: Domain<D>,
    cutoff: f64,
    origin: Vector<D>,
    inverse_width: Vector<D>,
    cells: [usize; D],
    starts: Vec<u32>,
    order: Vec<u32>,
}

impl<const D: usize> Grid<D> {
    /// Sorts `positions` (m) into cells for searches of radius `cutoff` (m).
    #[must_use]
    pub fn build(positions: &[Vector<D>], domain: &Domain<D>, cutoff: f64) -> Grid<D> {
        let mut min: Vector<D> = Vector::from_element(f64::INFINITY);
        let mut max: Vector<D> = Vector::from_element(f64::NEG_INFINITY);
        for p in positions {
            min = min.inf(p);
            max = max.sup(p);
        }
        // Not more cells than a few per point, whatever outlier stretches the box.
        let most = (4.0 * positions.len() as f64).powf(1.0 / D as f64).ceil().max(4.0);
        let mut cells = [1; D];
        let mut inverse_width = Vector::zeros();
        for k in 0..D {
            if domain.periodic[k] || positions.is_empty() {
                (min[k], max[k]) = (domain.min[k], domain.max[k]);
            }
            let count = ((max[k] - min[k]) / cutoff).floor().clamp(1.0, most);
            cells[k] = count as usize;
            // A box without extent (all points in a plane) has one cell.
            let width = (max[k] - min[k]).max(cutoff) / count;
            inverse_width[k] = 1.0 / width;
        }
        let mut grid = Grid {
            domain: domain.clone(),
            cutoff,
            origin: min,
            inverse_width,
            cells,
            starts: vec![0; cells.iter().product::<usize>() + 1],
            order: vec![0; positions.len()],
        };
        let home: Vec<usize> = positions.iter().map(|p| grid.index(grid.cell(p))).collect();
        for &cell in &home {
            grid.starts[cell + 1] += 1;
        }
        for cell in 1..grid.starts.len() {
            grid.starts[cell] += grid.starts[cell - 1];
        }
        let mut next = grid.starts.clone();
        for (j, &cell) in home.iter().enumerate() {
            grid.order[next[cell] as usize] = j as u32;
            next[cell] += 1;
        }
        grid
    }

    /// The points in the order of their cells.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Calls `see(j, point - x_j, r²)` for every point nearer than the cut-off, `point` itself included if it
    /// is one of them. `positions` are those the grid was built from.
    #[inline]
    pub fn for_each_near(
        &self,
        point: &Vector<D>,
        positions: &[Vector<D>],
        mut see: impl FnMut(usize, Vector<D>, f64),
    ) {
        let centre = self.cell(&self.domain.wrap(point));
        let limit = self.cutoff * self.cutoff;
        // All cells of the block of three along each axis, as one number in base three.
        'cells: for code in 0..3_usize.pow(D as u32) {
            let mut cell = [0; D];
            let mut digits = code;
            for k in 0..D {
                let (shift, n) = (digits % 3, self.cells[k]);
                digits /= 3;
                let moved = centre[k] + shift;
                cell[k] = if self.domain.periodic[k] {
                    // Fewer than three cells: each of them once.
                    if shift >= n {
                        continue 'cells;
                    }
                    (moved + n - 1) % n
                } else if (1..=n).contains(&moved) {
                    moved - 1
                } else {
                    continue 'cells;
                };
            }
            let index = self.index(cell);
            for &j in &self.order[self.starts[index] as usize..self.starts[index + 1] as usize] {
                let x = self.domain.separation(point, &positions[j as usize]);
                let r2 = x.norm_squared();
                if r2 < limit {
                    see(j as usize, x, r2);
                }
            }
        }
    }

    fn cell(&self, point: &Vector<D>) -> [usize; D] {
        std::array::from_fn(|k| {
            let along = (point[k] - self.origin[k]) * self.inverse_width[k];
            // The cast takes what is left of the box (and not a number) to the first cell.
            (along as usize).min(self.cells[k] - 1)
        })
    }

    fn index(&self, cell: [usize; D]) -> usize {
        (0..D).rev().fold(0, |index, k| index * self.cells[k] + cell[k])
    }
}

/// Particles per block: enough work for a thread to be worth waking.
pub const BLOCK: usize = 256;

/// A run of neighbouring particles with its neighbour lists and its share of the pairs of this step.
#[derive(Clone, Debug, Default)]
pub struct Block<const D: usize> {
    /// First particle of the block.
    pub first: usize,
    ends: Vec<u32>,
    list: Vec<u32>,
    /// Whether a fluid particle has any solid in its list.
    pub near_solid: Vec<bool>,
    /// Pairs within the cut-off, row after row; written by the density sweep.
    pub contacts: Vec<Contact<D>>,
    /// End of each row of `contacts`.
    pub contact_ends: Vec<u32>,
}

impl<const D: usize> Block<D> {
    /// Candidates of row `row` of the block.
    #[inline]
    #[must_use]
    pub fn candidates(&self, row: usize) -> &[u32] {
        let start = if row == 0 { 0 } else { self.ends[row - 1] };
        &self.list[start as usize..self.ends[row] as usize]
    }

    /// Contacts of row `row` of the block.
    #[inline]
    #[must_use]
    pub fn row(&self, row: usize) -> &[Contact<D>] {
        let start = if row == 0 { 0 } else { self.contact_ends[row - 1] };
        &self.contacts[start as usize..self.contact_ends[row] as usize]
    }

    /// Fills the lists: a fluid particle sees everyone, a solid one only fluid.
    fn fill(&mut self, grid: &Grid<D>, positions: &[Vector<D>], sides: &[Side<D>]) {
        self.ends.clear();
        self.list.clear();
        self.near_solid.clear();
        for i in self.first..(self.first + BLOCK).min(positions.len()) {
            let solid = sides[i].is_solid();
            let mut near = false;
            grid.for_each_near(&positions[i], positions, |j, _, _| {
                let other = sides[j].is_solid();
                if j != i && !(solid && other) {
                    near |= other;
                    self.list.push(j as u32);
                }
            });
            self.ends.push(self.list.len() as u32);
            self.near_solid.push(near && !solid);
        }
    }
}

/// Neighbour lists of all particles, in blocks of [`BLOCK`].
///
/// # Panics
/// Never; `cutoff` includes the skin and `positions` and `sides` are of one length.
pub fn build_blocks<const D: usize>(
    blocks: &mut Vec<Block<D>>,
    positions: &[Vector<D>],
    sides: &[Side<D>],
    domain: &Domain<D>,
    cutoff: f64,
) {
    let grid = Grid::build(positions, domain, cutoff);
    blocks.resize_with(positions.len().div_ceil(BLOCK), Block::default);
    blocks.par_iter_mut().enumerate().for_each(|(k, block)| {
        block.first = k * BLOCK;
        block.fill(&grid, positions, sides);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn against_all_pairs<const D: usize>(periodic: [bool; D], lengths: f64, cutoff: f64) {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(11);
        let domain = Domain { min: Vector::zeros(), max: Vector::from_element(lengths), periodic };
        let positions: Vec<Vector<D>> =
            (0..200).map(|_| Vector::from_fn(|_, _| random.random::<f64>() * lengths)).collect();
        let grid = Grid::build(&positions, &domain, cutoff);
        for point in &positions {
            let mut found = Vec::new();
            grid.for_each_near(point, &positions, |j, x, r2| {
                assert_eq!(x.norm_squared(), r2);
                found.push(j);
            });
            found.sort_unstable();
            let all: Vec<usize> = (0..positions.len())
                .filter(|&j| domain.separation(point, &positions[j]).norm() < cutoff)
                .collect();
            assert_eq!(found, all);
        }
    }

    #[test]
    fn grid_finds_the_same_pairs_as_a_double_loop() {
        against_all_pairs([true], 1.0, 0.13);
        against_all_pairs([true, false], 1.0, 0.21);
        against_all_pairs([true, true], 1.0, 0.49);
        against_all_pairs([false, false], 1.0, 3.0);
        against_all_pairs([true, false, true], 1.0, 0.3);
    }
}
