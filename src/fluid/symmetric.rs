//! Symmetric matrices of `D` rows, by their diagonal and what stands beside it.

use crate::vector::Vector;
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};

/// A symmetric matrix: the entries (k, k) and the entries (k, k + 1), the last beside the first. In 2D only the
/// first of the mixed entries is used, in 1D none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Symmetric<const D: usize> {
    pub diagonal: Vector<D>,
    pub mixed: Vector<D>,
}

impl<const D: usize> Symmetric<D> {
    /// Mixed entries in use.
    const MIXED: usize = D * (D - 1) / 2;

    /// `scale` times the identity.
    #[inline(always)]
    #[must_use]
    pub fn identity(scale: f64) -> Symmetric<D> {
        Symmetric { diagonal: Vector::from_element(scale), mixed: Vector::zeros() }
    }

    /// Adds `scale` x⊗x.
    #[inline(always)]
    pub fn add_square(&mut self, x: &Vector<D>, scale: f64) {
        let scaled = x * scale;
        for k in 0..D {
            self.diagonal[k] += scaled[k] * x[k];
        }
        for k in 0..Self::MIXED {
            self.mixed[k] += scaled[k] * x[(k + 1) % D];
        }
    }

    /// `scale` x⊗x.
    #[inline(always)]
    #[must_use]
    pub fn square(x: &Vector<D>, scale: f64) -> Symmetric<D> {
        let scaled = x * scale;
        let mut mixed = Vector::zeros();
        for k in 0..Self::MIXED {
            mixed[k] = scaled[k] * x[(k + 1) % D];
        }
        Symmetric { diagonal: scaled.component_mul(x), mixed }
    }

    /// Adds `scale` times another matrix.
    #[inline(always)]
    pub fn add_scaled(&mut self, other: &Symmetric<D>, scale: f64) {
        for k in 0..D {
            self.diagonal[k] += other.diagonal[k] * scale;
        }
        for k in 0..Self::MIXED {
            self.mixed[k] += other.mixed[k] * scale;
        }
    }

    /// x·A·x.
    #[inline(always)]
    #[must_use]
    pub fn along(&self, x: &Vector<D>) -> f64 {
        let mut sum = 0.0;
        for k in 0..D {
            sum += self.diagonal[k] * x[k] * x[k];
        }
        for k in 0..Self::MIXED {
            sum += 2.0 * self.mixed[k] * x[k] * x[(k + 1) % D];
        }
        sum
    }

    /// Sum of the diagonal.
    #[must_use]
    pub fn trace(&self) -> f64 {
        self.diagonal.sum()
    }

    /// The determinant and the matrix that divided by it is the inverse: its diagonal and its mixed entries.
    #[inline(always)]
    fn adjugate(&self) -> (f64, [f64; 3], [f64; 3]) {
        let (a, b) = (&self.diagonal, &self.mixed);
        match D {
            1 => (a[0], [1.0, 0.0, 0.0], [0.0; 3]),
            2 => (a[0] * a[1] - b[0] * b[0], [a[1], a[0], 0.0], [-b[0], 0.0, 0.0]),
            _ => {
                // Mixed entries: (0, 1), (1, 2), (2, 0).
                let minors =
                    [a[1] * a[2] - b[1] * b[1], a[2] * a[0] - b[2] * b[2], a[0] * a[1] - b[0] * b[0]];
                let crossed =
                    [b[1] * b[2] - b[0] * a[2], b[2] * b[0] - b[1] * a[0], b[0] * b[1] - b[2] * a[1]];
                (a[0] * minors[0] + b[0] * crossed[0] + b[2] * crossed[2], minors, crossed)
            }
        }
    }

    /// A⁻¹; `None` where the determinant is below `least`.
    #[inline]
    #[must_use]
    pub fn inverse(&self, least: f64) -> Option<Symmetric<D>> {
        let (determinant, minors, crossed) = self.adjugate();
        // Written so that "not a number" is refused too.
        (determinant > least).then(|| Symmetric {
            diagonal: Vector::from_fn(|k, _| minors[k] / determinant),
            mixed: Vector::from_fn(|k, _| crossed[k] / determinant),
        })
    }

    /// M A⁻¹ with any matrix M of D columns; `None` where the determinant is below `least` (too few neighbours, or all in a line).
    #[inline]
    #[must_use]
    pub fn divide<const R: usize>(&self, m: &SMatrix<f64, R, D>, least: f64) -> Option<SMatrix<f64, R, D>> {
        let (determinant, minors, crossed) = self.adjugate();
        // Written so that "not a number" is refused too.
        (determinant > least).then(|| {
            let inverse = SMatrix::<f64, D, D>::from_fn(|k, l| match (l + 3 - k) % 3 {
                0 => minors[k],
                1 => crossed[k],
                _ => crossed[l],
            });
            m * inverse / determinant
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn agrees_with_products<const D: usize>() {
        let x: Vector<D> = Vector::from_fn(|k, _| 0.3 + k as f64);
        let y: Vector<D> = Vector::from_fn(|k, _| 1.0 - 0.7 * k as f64);
        let mut sum = Symmetric::identity(2.0);
        sum.add_square(&x, 0.5);
        let expected = 2.0 * y.norm_squared() + 0.5 * x.dot(&y).powi(2);
        // Rounding of a dozen operations.
        assert!((sum.along(&y) - expected).abs() < 1e-13);
        assert!((sum.trace() - 2.0 * D as f64 - 0.5 * x.norm_squared()).abs() < 1e-13);
    }

    fn inverts<const D: usize>() {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(31);
        for _ in 0..50 {
            let mut any = || random.random::<f64>() - 0.5;
            let mut sum = Symmetric::<D>::identity(0.5);
            for _ in 0..3 {
                sum.add_square(&Vector::from_fn(|_, _| any()), 1.0);
            }
            let whole = SMatrix::<f64, D, D>::from_fn(|k, l| match (l + 3 - k) % 3 {
                0 => sum.diagonal[k],
                1 => sum.mixed[k],
                _ => sum.mixed[l],
            });
            let any = SMatrix::<f64, D, D>::from_fn(|_, _| any());
            let back = sum.divide(&(any * whole), 1e-3).expect("positive");
            // Rounding, times the condition of A.
            assert!((back - any).norm() < 1e-13, "{back} {any}");
            let inverse = sum.inverse(1e-3).expect("positive");
            let x: Vector<D> = Vector::from_fn(|k, _| 1.0 - 0.7 * k as f64);
            assert!((inverse.along(&x) - x.dot(&(whole.try_inverse().expect("positive") * x))).abs() < 1e-12);
        }
        assert_eq!(Symmetric::<D>::identity(0.0).divide(&SMatrix::<f64, D, D>::identity(), 1e-3), None);
    }

    #[test]
    fn a_product_is_divided_in_every_dimension() {
        inverts::<1>();
        inverts::<2>();
        inverts::<3>();
    }

    #[test]
    fn squares_add_up_in_every_dimension() {
        agrees_with_products::<1>();
        agrees_with_products::<2>();
        agrees_with_products::<3>();
    }
}
