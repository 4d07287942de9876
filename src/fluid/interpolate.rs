//! Fields of particles at any place, by moving least squares.

use crate::space::domain::Domain;
use crate::space::kernel::Kernel;
use crate::space::neighbours::Grid;
use crate::vector::Vector;

/// The particles a field lives on.
#[derive(Clone, Copy)]
pub struct Carriers<'a, const D: usize> {
    /// m.
    pub positions: &'a [Vector<D>],
    /// m^D.
    pub volumes: &'a [f64],
    /// Which particles take part.
    pub mask: &'a [bool],
    pub domain: &'a Domain<D>,
}

/// Sparse weights that take values of particles to points.
///
/// First order consistent: linear fields are reproduced. Where the particles in reach do not span the space
/// (all in a line, say) the weights are those of Shepard, which reproduce constants; where there are none the
/// value is not a number.
#[derive(Clone, Debug, Default)]
pub struct Interpolator<const D: usize> {
    offsets: Vec<u32>,
    weights: Vec<(u32, f64)>,
}

/// Smallest variance of the particles in reach along any direction, in cut-offs squared, for a gradient to be
/// taken: a full neighbourhood has about 0.1, half of one 0.03, a single layer none.
const LEAST_SPREAD: f64 = 1e-3;

impl<const D: usize> Interpolator<D> {
    /// Weights for `points` (m) with the kernel of weight V_j W.
    #[must_use]
    pub fn new(points: &[Vector<D>], carriers: &Carriers<D>, kernel: &Kernel<D>) -> Interpolator<D> {
        let Carriers { positions, volumes, mask, domain } = *carriers;
        let h = kernel.cutoff();
        let grid = Grid::build(positions, domain, h);
        let mut interpolator = Interpolator { offsets: vec![0], weights: Vec::new() };
        let mut near: Vec<(usize, Vector<D>, f64)> = Vec::new();
        for point in points {
            near.clear();
            grid.for_each_near(point, positions, |j, x, r2| {
                let weight = volumes[j] * kernel.value(r2.sqrt());
                if mask[j] && weight > 0.0 {
                    near.push((j, -x / h, weight));
                }
            });
            near.sort_unstable_by_key(|&(j, _, _)| j);
            let all: f64 = near.iter().map(|&(_, _, w)| w).sum();
            let mean = near.iter().fold(Vector::<D>::zeros(), |m, (_, x, w)| m + x * (w / all));
            let mut spread = [[0.0; D]; D];
            for (_, x, w) in &near {
                let y = x - mean;
                for (a, row) in spread.iter_mut().enumerate() {
                    for (b, entry) in row.iter_mut().enumerate() {
                        *entry += y[a] * y[b] * w / all;
                    }
                }
            }
            // Value at the point of the least-squares plane: the mean value less slope times mean place.
            let slope = solve(spread, &mean).unwrap_or_else(Vector::zeros);
            for (j, x, w) in &near {
                interpolator.weights.push((*j as u32, w / all * (1.0 - (x - mean).dot(&slope))));
            }
            interpolator.offsets.push(interpolator.weights.len() as u32);
        }
        interpolator
    }

    /// Number of points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Particles and weights of a point; the weights sum to one.
    #[must_use]
    pub fn row(&self, point: usize) -> &[(u32, f64)] {
        &self.weights[self.offsets[point] as usize..self.offsets[point + 1] as usize]
    }

    /// The same weights, with no support at the points `dropped` tells.
    #[must_use]
    pub fn without(&self, dropped: impl Fn(usize) -> bool) -> Interpolator<D> {
        let mut kept = Interpolator { offsets: vec![0], weights: Vec::new() };
        for point in 0..self.points() {
            if !dropped(point) {
                kept.weights.extend_from_slice(self.row(point));
            }
            kept.offsets.push(kept.weights.len() as u32);
        }
        kept
    }

    /// The field at a point; not a number where no particle is in reach.
    #[inline]
    pub fn apply(&self, point: usize, value: impl Fn(usize) -> f64) -> f64 {
        let row = self.row(point);
        if row.is_empty() {
            return f64::NAN;
        }
        row.iter().map(|&(j, weight)| weight * value(j as usize)).sum()
    }
}

/// Solves a symmetric positive system by elimination; `None` if a pivot is below [`LEAST_SPREAD`].
fn solve<const D: usize>(mut matrix: [[f64; D]; D], right: &Vector<D>) -> Option<Vector<D>> {
    let mut x = *right;
    for k in 0..D {
        // Diagonal pivots suffice: the matrix is symmetric and not indefinite. (Not a number fails here too.)
        let pivot = matrix[k][k];
        if pivot.is_nan() || pivot <= LEAST_SPREAD {
            return None;
        }
        let upper = matrix[k];
        for row in k + 1..D {
            let factor = matrix[row][k] / pivot;
            for (entry, above) in matrix[row].iter_mut().zip(&upper).skip(k) {
                *entry -= factor * above;
            }
            x[row] -= factor * x[k];
        }
    }
    for k in (0..D).rev() {
        for column in k + 1..D {
            x[k] -= matrix[k][column] * x[column];
        }
        x[k] /= matrix[k][k];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::kernel::KernelKind;
    use rand::{Rng, SeedableRng};

    fn linear_fields_are_exact_in<const D: usize>(count: usize) {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(3);
        let domain = Domain { min: Vector::zeros(), max: Vector::from_element(1.0), periodic: [false; D] };
        let mut point = || Vector::<D>::from_fn(|_, _| random.random::<f64>());
        let positions: Vec<_> = (0..count).map(|_| point()).collect();
        let points: Vec<_> = (0..50).map(|_| point()).collect();
        let volumes = vec![1.0 / count as f64; count];
        let carriers =
            Carriers { positions: &positions, volumes: &volumes, mask: &vec![true; count], domain: &domain };
        let interpolator = Interpolator::new(&points, &carriers, &Kernel::new(KernelKind::Lucy, 0.4));
        let field =
            |x: &Vector<D>| 2.0 + x.iter().enumerate().map(|(k, x)| (k as f64 - 0.7) * x).sum::<f64>();
        for (k, point) in points.iter().enumerate() {
            // Rounding, worsened by at most 1/LEAST_SPREAD.
            assert!((interpolator.apply(k, |j| field(&positions[j])) - field(point)).abs() < 1e-12);
        }
    }

    #[test]
    fn linear_fields_are_exact() {
        linear_fields_are_exact_in::<1>(40);
        linear_fields_are_exact_in::<2>(400);
        linear_fields_are_exact_in::<3>(2000);
    }

    #[test]
    fn a_line_of_particles_gives_means_and_nothing_gives_nan() {
        let domain =
            Domain { min: Vector::<2>::zeros(), max: Vector::<2>::new(1.0, 1.0), periodic: [false; 2] };
        let positions: Vec<_> = (0..20).map(|i| Vector::<2>::new(0.05 * f64::from(i), 0.5)).collect();
        let carriers =
            Carriers { positions: &positions, volumes: &[0.05; 20], mask: &[true; 20], domain: &domain };
        let points = [Vector::<2>::new(0.5, 0.55), Vector::<2>::new(0.5, 0.95)];
        let interpolator = Interpolator::new(&points, &carriers, &Kernel::new(KernelKind::Wendland, 0.2));
        // Weights sum to one to rounding.
        assert!((interpolator.apply(0, |_| 3.0) - 3.0).abs() < 1e-14);
        assert!(interpolator.apply(1, |_| 3.0).is_nan());
    }
}
