//! Who is near whom: a grid of cells.

use crate::space::domain::Domain;
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

    /// Calls `see(j, point - x_j, r²)` for every point nearer than the cut-off, `point` itself included if it
    /// is one of them. `positions` are those the grid was built from.
    #[inline]
    pub fn for_each_near(
        &self,
        point: &Vector<D>,
        positions: &[Vector<D>],
        see: impl FnMut(usize, Vector<D>, f64),
    ) {
        self.for_each_near_after(point, positions, 0, see);
    }

    /// As [`Grid::for_each_near`] of the points from number `first` on.
    #[inline]
    pub fn for_each_near_after(
        &self,
        point: &Vector<D>,
        positions: &[Vector<D>],
        first: usize,
        mut see: impl FnMut(usize, Vector<D>, f64),
    ) {
        let limit = self.cutoff * self.cutoff;
        self.for_each_cell(self.cell(&self.domain.wrap(point)), |points| {
            for &j in points.iter().filter(|&&j| j as usize >= first) {
                let x = self.domain.separation(point, &positions[j as usize]);
                let r2 = x.norm_squared();
                if r2 < limit {
                    see(j as usize, x, r2);
                }
            }
        });
    }

    /// Calls `see` with the points of each cell of the block of three along each axis around `centre`.
    #[inline(always)]
    fn for_each_cell(&self, centre: [usize; D], mut see: impl FnMut(&[u32])) {
        // All cells of the block as one number in base three.
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
                    // The remainder without a division: moved is below n + 2.
                    let before = moved + n - 1;
                    if before >= 2 * n {
                        before - 2 * n
                    } else if before >= n {
                        before - n
                    } else {
                        before
                    }
                } else if (1..=n).contains(&moved) {
                    moved - 1
                } else {
                    continue 'cells;
                };
            }
            let index = self.index(cell);
            see(&self.order[self.starts[index] as usize..self.starts[index + 1] as usize]);
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
