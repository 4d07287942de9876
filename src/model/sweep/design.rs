//! Where the points of a sweep lie, as numbers from 0 to 1 or as indices into lists.

use crate::random::{Purpose, stream};
use rand::Rng;

/// Every combination of `counts` values, the last index fastest.
pub(super) fn grid(counts: &[usize]) -> Vec<Vec<usize>> {
    let total = counts.iter().product();
    let point = |mut k: usize| {
        let mut indices = vec![0; counts.len()];
        for (index, count) in indices.iter_mut().zip(counts).rev() {
            (*index, k) = (k % count, k / count);
        }
        indices
    };
    (0..total).map(point).collect()
}

/// Points of a Latin hypercube, 0 to 1 in each dimension: each of `points` equal intervals of each dimension holds one of
/// them, at a place drawn at random (M. D. McKay, R. J. Beckman & W. J. Conover, Technometrics 21 (1979) 239).
pub(super) fn latin_hypercube(points: usize, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = stream(seed, 0, Purpose::Design);
    let mut all = vec![Vec::with_capacity(dimensions); points];
    for _ in 0..dimensions {
        let mut order: Vec<usize> = (0..points).collect();
        for k in (1..points).rev() {
            order.swap(k, random.random_range(0..=k));
        }
        for (point, interval) in all.iter_mut().zip(order) {
            point.push((interval as f64 + random.random::<f64>()) / points as f64);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_holds_every_combination_once() {
        assert_eq!(grid(&[2, 3]), [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]);
        assert_eq!(grid(&[4]).len(), 4);
    }

    #[test]
    fn every_interval_of_a_hypercube_holds_one_point() {
        let points = latin_hypercube(37, 3, 5);
        for dimension in 0..3 {
            let mut intervals: Vec<usize> = points.iter().map(|p| (p[dimension] * 37.0) as usize).collect();
            intervals.sort_unstable();
            assert_eq!(intervals, (0..37).collect::<Vec<_>>());
        }
        assert_eq!(points, latin_hypercube(37, 3, 5));
        assert_ne!(points, latin_hypercube(37, 3, 6));
    }
}
