//! Candidates for neighbour lists: who is nearer than a radius, fast enough for lists that noise makes anew every
//! few steps.

use crate::space::domain::Domain;
use crate::vector::Vector;

/// Marks a candidate that is seen round a periodic axis; fewer than 2^31 particles fit any memory of today.
pub const TURNED: u32 = 1 << 31;

/// Parts of the radius that a cell is long on the first axis, along which cells are read one after the other, and
/// wide on the others.
const PARTS: [f64; 2] = [4.0, 2.0];
/// Rows of cells to either side that come as near as the radius.
const REACH: usize = PARTS[1] as usize;
/// Cells of one axis at most.
const MOST: usize = 1 << 28;
/// Slabs of cells in sight of a point on one axis.
const SLABS: usize = 2 * REACH + 1;

/// Places sorted into rows of small cells. On a periodic axis the box must be at least two radii long.
pub struct Candidates<const D: usize> {
    radius: f64,
    /// Lengths of the periodic axes, m; of the others without meaning.
    length: Vector<D>,
    periodic: [bool; D],
    origin: Vector<D>,
    width: Vector<D>,
    inverse_width: Vector<D>,
    cells: [usize; D],
    starts: Vec<u32>,
    order: Vec<u32>,
    /// The places in the order of the cells, m.
    places: Vec<Vector<D>>,
}

/// The cells of one axis that share an index, seen from a point.
#[derive(Clone, Copy, Default)]
struct Slab {
    index: usize,
    /// What takes a place in it to where it is seen, m.
    turn: f64,
    /// [`TURNED`] if that is anywhere else.
    mark: u32,
    /// Square of the distance to it, m².
    gap: f64,
}

impl<const D: usize> Candidates<D> {
    /// Sorts `positions` (m), inside the box on periodic axes, for searches of `radius` (m).
    #[must_use]
    pub fn new(positions: &[Vector<D>], domain: &Domain<D>, radius: f64) -> Candidates<D> {
        let mut min: Vector<D> = Vector::from_element(f64::INFINITY);
        let mut max: Vector<D> = Vector::from_element(f64::NEG_INFINITY);
        for p in positions {
            min = min.inf(p);
            max = max.sup(p);
        }
        let mut cells = [1; D];
        for k in 0..D {
            if domain.periodic[k] || positions.is_empty() {
                (min[k], max[k]) = (domain.min[k], domain.max[k]);
            }
            // One cell for a box without extent (all points in a plane) and where a number is lost.
            cells[k] = ((PARTS[k.min(1)] * (max[k] - min[k]) / radius) as usize).clamp(1, MOST);
        }
        // Not more cells than some per point, whatever outlier stretches the box.
        let most = 4 * MOST.min(8 * positions.len() + 16);
        while cells.iter().fold(1, |all: usize, &n| all.saturating_mul(n)) > most {
            if let Some(n) = cells.iter_mut().max() {
                *n /= 2;
            }
        }
        let width = Vector::from_fn(|k, _| (max[k] - min[k]).max(radius / PARTS[k.min(1)]) / cells[k] as f64);
        let mut all = Candidates {
            radius,
            length: domain.lengths(),
            periodic: domain.periodic,
            origin: min,
            width,
            inverse_width: width.map(|w| 1.0 / w),
            cells,
            starts: vec![0; cells.iter().product::<usize>() + 1],
            order: vec![0; positions.len()],
            places: vec![Vector::zeros(); positions.len()],
        };
        let home: Vec<u32> = positions.iter().map(|p| all.home(p) as u32).collect();
        for &cell in &home {
            all.starts[cell as usize] += 1;
        }
        let mut sum = 0;
        for start in &mut all.starts {
            sum += *start;
            *start = sum;
        }
        // From the end of each cell down, so that the starts are left where they belong.
        for (j, &cell) in home.iter().enumerate().rev() {
            let start = &mut all.starts[cell as usize];
            *start -= 1;
            (all.order[*start as usize], all.places[*start as usize]) = (j as u32, positions[j]);
        }
        all
    }

    /// Everyone nearer than the radius to `point` (m), a point inside the box, itself included if it is one of
    /// them; with [`TURNED`] where the way leads round a periodic axis. Taken from the front of `found`, which
    /// grows as needed.
    #[inline(always)]
    pub fn near<'a>(&self, point: &Vector<D>, found: &'a mut Vec<u32>) -> &'a [u32] {
        let slabs: [[Slab; SLABS]; D] =
            std::array::from_fn(|k| if k == 0 { Default::default() } else { self.slabs(k, point[k]) });
        let mut taken = 0;
        // All rows of cells as one number in base `SLABS`.
        'rows: for code in 0..SLABS.pow(D as u32 - 1) {
            let (mut seen_from, mut gap, mut mark) = (*point, 0.0, 0);
            let mut digits = code;
            let mut row = 0;
            let mut stride = self.cells[0];
            for k in 1..D {
                let slab = &slabs[k][digits % SLABS];
                digits /= SLABS;
                gap += slab.gap;
                seen_from[k] -= slab.turn;
                mark |= slab.mark;
                row += slab.index * stride;
                stride *= self.cells[k];
            }
            let room = self.radius * self.radius - gap;
            if room.is_nan() || room <= 0.0 {
                continue 'rows;
            }
            self.along(row, room.sqrt(), &seen_from, mark, &mut taken, found);
        }
        &found[..taken]
    }

    /// Those of a row of cells, not further than `half` (m) along it, seen from `point`.
    #[inline(always)]
    fn along(
        &self,
        row: usize,
        half: f64,
        point: &Vector<D>,
        mark: u32,
        taken: &mut usize,
        found: &mut Vec<u32>,
    ) {
        let n = self.cells[0] as i64;
        let place = point[0] - self.origin[0];
        let low = ((place - half) * self.inverse_width[0]).floor() as i64;
        let high = ((place + half) * self.inverse_width[0]).floor() as i64;
        let limit = self.radius * self.radius;
        let mut see = |from: i64, to: i64, point: Vector<D>, mark: u32| {
            // Into the row, whatever a lost number asks for.
            let (from, to) = (row + from.clamp(0, n - 1) as usize, row + to.clamp(0, n - 1) as usize);
            let mine = self.starts[from] as usize..self.starts[to + 1] as usize;
            if found.len() < *taken + mine.len() {
                found.resize(*taken + mine.len() + 64, 0);
            }
            let (order, places) = (&self.order[mine.clone()], &self.places[mine]);
            let found = &mut found[*taken..][..order.len()];
            let mut kept = 0;
            for (&j, there) in order.iter().zip(places) {
                // Written always, kept if near: no branch to be guessed.
                found[kept] = j | mark;
                kept += usize::from((point - there).norm_squared() < limit);
            }
            *taken += kept;
        };
        see(low, high, *point, mark);
        if self.periodic[0] && (low < 0 || high >= n) {
            // A box of two radii or more: beyond one end at most.
            let mut beyond = *point;
            if low < 0 {
                beyond[0] += self.length[0];
                see(low + n, n - 1, beyond, TURNED);
            } else {
                beyond[0] -= self.length[0];
                see(0, high - n, beyond, TURNED);
            }
        }
    }

    /// The slabs of axis `k` in sight of the coordinate `x` (m). Those that are not there are infinitely far.
    #[inline(always)]
    fn slabs(&self, k: usize, x: f64) -> [Slab; SLABS] {
        let n = self.cells[k] as i64;
        let (place, width) = (x - self.origin[k], self.width[k]);
        let here = self.cell(k, x) as i64;
        std::array::from_fn(|s| {
            let index = here + s as i64 - REACH as i64;
            let (start, end) = (index as f64 * width, (index + 1) as f64 * width);
            let gap = if s == REACH { 0.0 } else { (start - place).max(place - end).max(0.0) };
            if (0..n).contains(&index) {
                Slab { index: index as usize, turn: 0.0, mark: 0, gap: gap * gap }
            } else if self.periodic[k] {
                // A box of two radii has REACH cells or more: one turn is enough.
                let turn = if index < 0 { -self.length[k] } else { self.length[k] };
                Slab { index: index.rem_euclid(n) as usize, turn, mark: TURNED, gap: gap * gap }
            } else {
                Slab { gap: f64::INFINITY, ..Slab::default() }
            }
        })
    }

    fn cell(&self, k: usize, x: f64) -> usize {
        // The cast takes what is left of the box (and not a number) to the first cell.
        (((x - self.origin[k]) * self.inverse_width[k]) as usize).min(self.cells[k] - 1)
    }

    fn home(&self, point: &Vector<D>) -> usize {
        (0..D).rev().fold(0, |index, k| index * self.cells[k] + self.cell(k, point[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn against_all_pairs<const D: usize>(periodic: [bool; D], lengths: [f64; D], radius: f64) {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(17);
        let domain = Domain { min: Vector::zeros(), max: Vector::from_row_slice(&lengths), periodic };
        let positions: Vec<Vector<D>> =
            (0..300).map(|_| Vector::from_fn(|k, _| random.random::<f64>() * lengths[k])).collect();
        let all = Candidates::new(&positions, &domain, radius);
        let mut room = Vec::new();
        for point in &positions {
            let mut found = all.near(point, &mut room).to_vec();
            found.sort_unstable_by_key(|j| j & !TURNED);
            let expected: Vec<u32> = (0..positions.len())
                .filter(|&j| domain.separation(point, &positions[j]).norm() < radius)
                .map(|j| {
                    let turned = domain.separation(point, &positions[j]) != point - positions[j];
                    j as u32 | if turned { TURNED } else { 0 }
                })
                .collect();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn the_same_pairs_as_a_double_loop() {
        against_all_pairs([true], [1.0], 0.13);
        against_all_pairs([false], [1.0], 0.3);
        against_all_pairs([true, false], [1.0, 0.4], 0.21);
        // Two radii long, the shortest box there is.
        against_all_pairs([true, true], [1.0, 0.9], 0.45);
        against_all_pairs([false, false], [1.0, 1.0], 3.0);
        against_all_pairs([true, false, true], [1.0, 0.7, 1.3], 0.3);
        against_all_pairs([true, true, true], [1.0, 1.7, 1.3], 0.5);
    }

    #[test]
    fn lost_places_break_no_search() {
        let domain = Domain { min: Vector::zeros(), max: Vector::from_element(1.0), periodic: [true, false] };
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e284, -1e284] {
            let positions =
                [Vector::<2>::new(0.2, 0.2), Vector::<2>::new(bad, 0.3), Vector::<2>::new(0.3, bad)];
            let all = Candidates::new(&positions, &domain, 0.3);
            for point in &positions {
                assert!(all.near(point, &mut Vec::new()).len() <= positions.len());
            }
        }
    }
}
