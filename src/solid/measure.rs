//! What there is to see of a solid.

use crate::solid::elastic::Elastic;
use crate::space::matrix::{Matrix, determinant, embed};
use crate::vector::Vector;

impl<const D: usize> Elastic<D> {
    /// Σ m v, kg m/s per unit thickness.
    #[must_use]
    pub fn momentum(&self) -> Vector<D> {
        (0..self.len()).fold(Vector::zeros(), |sum, i| sum + self.velocities[i] * self.mass(i))
    }

    /// Σ m v²/2, J per unit thickness.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        (0..self.len()).map(|i| 0.5 * self.mass(i) * self.velocities[i].norm_squared()).sum()
    }

    /// Σ V W(F_e) det F_g, J per unit thickness; without hourglass control.
    #[must_use]
    pub fn elastic_energy(&self) -> f64 {
        (0..self.len())
            .map(|i| {
                let back = self.back(i);
                let f = self.strains[i].f * back;
                self.material.energy(&f, self.softness[i]) * self.volumes[i] / determinant(&back)
            })
            .sum()
    }

    /// Deformation gradient F of particle `i` from its place at rest.
    #[must_use]
    pub fn gradient(&self, i: usize) -> Matrix<D> {
        self.strains[i].f
    }

    /// Volume of particle `i` now, m^D.
    #[must_use]
    pub fn volume(&self, i: usize) -> f64 {
        self.volumes[i] * determinant(&self.strains[i].f)
    }

    /// Cauchy stress of particle `i`, Pa; in fewer than three dimensions those of plane strain.
    #[must_use]
    pub fn stress(&self, i: usize) -> nalgebra::Matrix3<f64> {
        let f = self.strains[i].f * self.back(i);
        let soft = self.softness[i];
        let stress = self.material.stress(&f, soft) * f.transpose() / determinant(&f);
        embed(&stress, self.material.stress_out_of_plane(&f, soft))
    }

    /// The largest stretch of particle `i`, elastic and grown together: √ of the largest eigenvalue of FᵀF.
    #[must_use]
    pub fn stretch(&self, i: usize) -> f64 {
        largest_stretch(&self.strains[i].f)
    }

    /// F_g⁻¹ of particle `i`.
    fn back(&self, i: usize) -> Matrix<D> {
        self.growth.as_ref().map_or_else(Matrix::identity, |growth| growth[i])
    }
}

/// √ of the largest eigenvalue of FᵀF.
pub(super) fn largest_stretch<const D: usize>(f: &Matrix<D>) -> f64 {
    embed(&(f.transpose() * f), 0.0).symmetric_eigenvalues().max().max(0.0).sqrt()
}
