//! Irreversible growth of a wall (Lockhart 1965) as a part of its deformation: F = F_e F_g.
//!
//! ```text
//! dF_g/dt F_g⁻¹ = Σ_k φ (σ_k - σ_y)₊ m_k⊗m_k,     m_k = Rᵀ t_k,     F_e = R U
//! ```
//!
//! t_k are the principal directions of the Cauchy stress in the plane of the wall (in 2D the tangent) and σ_k its
//! principal values there. Nothing grows along the normal: what the wall would lose in thickness is delivered to it. Each
//! step is exact for constant rates, and dm = ρ0 V d(det F_g) is booked.

use nalgebra::Matrix3;

use crate::solid::elastic::Elastic;
use crate::solid::recover::space;
use crate::space::matrix::{Matrix, determinant, dyad, inverse};
use crate::vector::Vector;

/// What drives the growth of one particle: rates (1/s) along directions of the present wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<const D: usize> {
    pub directions: [Vector<D>; D],
    /// That along the last direction, the normal, is zero.
    pub rates: [f64; D],
}

impl<const D: usize> Rates<D> {
    /// All directions that grow together, 1/s: the relative rate of mass.
    #[must_use]
    pub fn sum(&self) -> f64 {
        self.rates.iter().sum()
    }
}

/// Lockhart's law at the stress `stress` (Pa) where `normal` is that of the wall: φ (1/(Pa s)) and yield stress (Pa).
#[must_use]
pub fn lockhart<const D: usize>(
    stress: &Matrix3<f64>,
    normal: &Vector<D>,
    phi: f64,
    yields: f64,
) -> Rates<D> {
    let mut directions = [*normal; D];
    let mut rates = [0.0; D];
    let rate = |pull: f64| phi * (pull - yields).max(0.0);
    if D == 2 {
        directions[0] = Vector::from_fn(|k, _| [-normal[1], normal[0]][k]);
        let tangent = space(&directions[0]);
        rates[0] = rate(tangent.dot(&(stress * tangent)));
        return Rates { directions, rates };
    }
    // Any two directions in the plane, then the principal ones.
    let n = space(normal);
    let least = if n[0].abs() < 0.6 { nalgebra::Vector3::x() } else { nalgebra::Vector3::y() };
    let a = n.cross(&least).normalize();
    let b = n.cross(&a);
    let (aa, ab, bb) = (a.dot(&(stress * a)), a.dot(&(stress * b)), b.dot(&(stress * b)));
    let angle = 0.5 * (2.0 * ab).atan2(aa - bb);
    for (k, angle) in [angle, angle + std::f64::consts::FRAC_PI_2].into_iter().enumerate() {
        let t = a * angle.cos() + b * angle.sin();
        directions[k] = Vector::from_fn(|k, _| t[k]);
        rates[k] = rate(t.dot(&(stress * t)));
    }
    Rates { directions, rates }
}

impl<const D: usize> Elastic<D> {
    /// Mass of particle `i` with what has grown, kg per unit thickness: ρ0 V det F_g.
    #[must_use]
    pub fn grown_mass(&self, i: usize) -> f64 {
        self.mass(i) / self.growth.as_ref().map_or(1.0, |growth| determinant(&growth[i]))
    }

    /// The elastic part F_e of the deformation of particle `i`.
    #[must_use]
    pub fn elastic_gradient(&self, i: usize) -> Matrix<D> {
        self.strains[i].f * self.growth.as_ref().map_or_else(Matrix::identity, |growth| growth[i])
    }

    /// Lets all particles grow for `dt` (s) at constant rates; returns the mass that was delivered, kg per unit thickness.
    /// Forces are those of before until the next relaxation.
    pub fn grow(&mut self, rates: &[Rates<D>], dt: f64) -> f64 {
        let mut delivered = 0.0;
        for (i, rates) in rates.iter().enumerate() {
            if rates.sum() == 0.0 {
                continue;
            }
            let turn = rotation(&self.elastic_gradient(i)).transpose();
            let mut back: Matrix<D> = Matrix::identity();
            for (direction, rate) in rates.directions.iter().zip(rates.rates) {
                let m = turn * direction;
                back += dyad(&m, &m) * (-rate * dt).exp_m1();
            }
            delivered += self.grown_mass(i) * (rates.sum() * dt).exp_m1();
            let n = self.places.len();
            let growth = self.growth.get_or_insert_with(|| vec![Matrix::identity(); n]);
            growth[i] *= back;
        }
        delivered
    }

    /// What has grown, to come back to it.
    #[must_use]
    pub fn growth(&self) -> Option<&[Matrix<D>]> {
        self.growth.as_deref()
    }
}

/// The rotation R of F = R U (Higham 1986): means of a matrix and its inverse transposed.
#[must_use]
pub fn rotation<const D: usize>(f: &Matrix<D>) -> Matrix<D> {
    let mut r = *f;
    for _ in 0..30 {
        let next = (r + inverse(&r).transpose()) * 0.5;
        let change = (next - r).norm();
        r = next;
        if change < 1e-14 {
            break;
        }
    }
    r
}
