//! Small square matrices of `D` rows, on nalgebra.

use crate::vector::Vector;

/// A matrix of `D` rows and columns.
pub type Matrix<const D: usize> = nalgebra::SMatrix<f64, D, D>;

/// The determinant; of one to three rows.
#[inline(always)]
#[must_use]
pub fn determinant<const D: usize>(m: &Matrix<D>) -> f64 {
    match D {
        1 => m[(0, 0)],
        2 => m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)],
        _ => (0..3).map(|k| m[(0, k)] * minor(m, 0, k)).sum(),
    }
}

/// The inverse of a matrix whose determinant is not zero; of one to three rows.
#[inline(always)]
#[must_use]
pub fn inverse<const D: usize>(m: &Matrix<D>) -> Matrix<D> {
    let scale = 1.0 / determinant(m);
    match D {
        1 => Matrix::from_fn(|_, _| scale),
        2 => Matrix::from_fn(|a, b| if a == b { scale * m[(1 - a, 1 - a)] } else { -scale * m[(a, b)] }),
        _ => Matrix::from_fn(|a, b| scale * minor(m, b, a)),
    }
}

/// The cofactor of row `a` and column `b` of a matrix of three rows.
#[inline(always)]
fn minor<const D: usize>(m: &Matrix<D>, a: usize, b: usize) -> f64 {
    let (p, q, r, s) = ((a + 1) % 3, (a + 2) % 3, (b + 1) % 3, (b + 2) % 3);
    m[(p, r)] * m[(q, s)] - m[(p, s)] * m[(q, r)]
}

/// a⊗b.
#[inline(always)]
#[must_use]
pub fn dyad<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> Matrix<D> {
    Matrix::from_fn(|k, l| a[k] * b[l])
}

/// A matrix of three rows with the given one in its corner and `rest` on the rest of the diagonal.
#[must_use]
pub fn embed<const D: usize>(m: &Matrix<D>, rest: f64) -> nalgebra::Matrix3<f64> {
    nalgebra::Matrix3::from_fn(|a, b| match (a < D && b < D, a == b) {
        (true, _) => m[(a, b)],
        (false, true) => rest,
        _ => 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inverts<const D: usize>() {
        let m: Matrix<D> = Matrix::from_fn(|a, b| if a == b { 2.0 + a as f64 } else { 0.3 - 0.2 * a as f64 });
        // Rounding of a few products.
        assert!((inverse(&m) * m - Matrix::identity()).norm() < 1e-14);
        assert!((determinant(&inverse(&m)) * determinant(&m) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn inverses_and_determinants_agree() {
        inverts::<1>();
        inverts::<2>();
        inverts::<3>();
        // By hand: rows (1, 2) and (3, 4).
        assert_eq!(determinant(&Matrix::<2>::new(1.0, 2.0, 3.0, 4.0)), -2.0);
        let turn = Matrix::<3>::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        assert_eq!(determinant(&turn), 1.0);
        assert_eq!(inverse(&turn), turn.transpose());
    }
}
