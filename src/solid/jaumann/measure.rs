//! What there is to see of the updated-Lagrangian form.

use super::Jaumann;
use crate::solid::elastic::{Hold, Tally};
use crate::solid::measure::largest_stretch;
use crate::space::matrix::{Matrix, embed};
use crate::vector::Vector;

impl<const D: usize> Jaumann<D> {
    /// K (ρ/ρ0 - 1), Pa.
    fn pressure(&self, i: usize) -> f64 {
        self.material.bulk * (self.densities[i] / self.material.density - 1.0)
    }

    /// σ in the plane, Pa.
    pub(super) fn stress_in_plane(&self, i: usize) -> Matrix<D> {
        self.deviators[i] - Matrix::identity() * self.pressure(i)
    }

    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is no particle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Where particle `i` is, m; not wrapped round periodic axes.
    #[must_use]
    pub fn position(&self, i: usize) -> Vector<D> {
        self.positions[i]
    }

    /// Where the particles are at rest, m.
    #[must_use]
    pub fn places(&self) -> &[Vector<D>] {
        &self.places
    }

    /// m/s.
    #[must_use]
    pub fn velocities(&self) -> &[Vector<D>] {
        &self.velocities
    }

    /// Deformation gradient F of particle `i` from its place at rest, gathered from the velocity gradients since.
    #[must_use]
    pub fn gradient(&self, i: usize) -> Matrix<D> {
        self.gradients[i]
    }

    /// The largest stretch of particle `i`: √ of the largest eigenvalue of FᵀF.
    #[must_use]
    pub fn stretch(&self, i: usize) -> f64 {
        largest_stretch(&self.gradients[i])
    }

    /// Whether particle `i` is held or driven.
    #[must_use]
    pub fn is_held(&self, i: usize) -> bool {
        !matches!(self.holds[i], Hold::Free)
    }

    /// Mass of particle `i`, kg per unit thickness.
    #[must_use]
    pub fn mass(&self, i: usize) -> f64 {
        self.masses[i]
    }

    /// Volume of particle `i` now, m^D.
    #[must_use]
    pub fn volume(&self, i: usize) -> f64 {
        self.masses[i] / self.densities[i]
    }

    /// Cauchy stress of particle `i`, Pa; in fewer than three dimensions that of plane strain.
    #[must_use]
    pub fn stress(&self, i: usize) -> nalgebra::Matrix3<f64> {
        // What is out of the plane takes the trace of S back to zero, in equal parts along each axis.
        let rest = if D < 3 { -self.deviators[i].trace() / (3 - D) as f64 } else { 0.0 };
        embed(&self.stress_in_plane(i), rest - self.pressure(i))
    }

    /// Sets the stress in the plane (Pa) of particle `i`; that out of the plane follows from no strain along it.
    pub fn set_stress(&mut self, i: usize, stress: &Matrix<D>) {
        let (k, g) = (self.material.bulk, self.material.shear);
        // tr σ = D (K + 2 G/D - 2 G/3) tr ε in the plane, P = -K tr ε.
        let spread = stress.trace() / (D as f64 * k + 2.0 * g - 2.0 / 3.0 * g * D as f64);
        self.densities[i] = self.material.density * (1.0 - spread);
        self.deviators[i] = stress - Matrix::identity() * (k * spread);
    }

    /// Gives the free particles velocities (m/s) by their places at rest.
    pub fn set_velocity(&mut self, of: impl Fn(&Vector<D>) -> Vector<D>) {
        for ((velocity, place), hold) in self.velocities.iter_mut().zip(&self.places).zip(&self.holds) {
            if matches!(hold, Hold::Free) {
                *velocity = of(place);
            }
        }
    }

    /// Forces from outside on the particles, N per unit thickness; they act until changed.
    pub fn loads_mut(&mut self) -> &mut [Vector<D>] {
        &mut self.loads
    }

    /// Σ m v, kg m/s per unit thickness.
    #[must_use]
    pub fn momentum(&self) -> Vector<D> {
        self.velocities.iter().zip(&self.masses).fold(Vector::zeros(), |sum, (v, m)| sum + v * *m)
    }

    /// Σ m v²/2, J per unit thickness.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        self.velocities.iter().zip(&self.masses).map(|(v, m)| 0.5 * m * v.norm_squared()).sum()
    }

    /// Σ V [S:S/(4 G) + P²/(2 K)], J per unit thickness: what small strains store.
    #[must_use]
    pub fn elastic_energy(&self) -> f64 {
        let (k, g) = (self.material.bulk, self.material.shear);
        (0..self.len())
            .map(|i| {
                let p = self.pressure(i);
                let s = self.stress(i) + nalgebra::Matrix3::identity() * p;
                self.volume(i) * (s.norm_squared() / (4.0 * g) + p * p / (2.0 * k))
            })
            .sum()
    }

    /// Time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// What was counted.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.tally
    }
}
