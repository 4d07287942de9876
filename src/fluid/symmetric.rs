//! Symmetric matrices of `D` rows, by their diagonal and what stands beside it.

use crate::vector::Vector;

/// A symmetric matrix: the entries (k, k) and the entries (k, k + 1), the last beside the first. In 2D only the
/// first of the mixed entries is used, in 1D none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric<const D: usize> {
    pub diagonal: Vector<D>,
    pub mixed: Vector<D>,
}

impl<const D: usize> Symmetric<D> {
    /// Mixed entries in use.
    const MIXED: usize = D * (D - 1) / 2;

    /// `scale` times the identity.
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

    /// The sum of this and another matrix.
    #[inline(always)]
    pub fn add(&mut self, other: &Symmetric<D>) {
        self.diagonal += other.diagonal;
        self.mixed += other.mixed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn squares_add_up_in_every_dimension() {
        agrees_with_products::<1>();
        agrees_with_products::<2>();
        agrees_with_products::<3>();
    }
}
