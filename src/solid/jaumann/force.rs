//! Accelerations of the updated-Lagrangian form.

use rayon::prelude::*;

use super::{Jaumann, Pull};
use crate::error::RunError;
use crate::solid::force::CHUNK;
use crate::space::matrix::{Matrix, embed};
use crate::vector::Vector;

impl<const D: usize> Jaumann<D> {
    /// Accelerations by stress, artificial stress and artificial viscosity.
    pub(super) fn accelerate(&mut self) -> Result<(), RunError> {
        self.corrections = self.moments()?;
        for i in 0..self.positions.len() {
            let (rho, correction) = (self.densities[i], &self.corrections[i]);
            let stress = self.stress_in_plane(i);
            if !stress.iter().all(|s| s.is_finite()) {
                let remedy = "the solid has blown up: use a smaller courant number or smaller loads";
                return Err(self.fault(i, "stress of a solid particle", stress.trace(), remedy));
            }
            let artificial = match self.form.artificial_stress {
                0.0 => Matrix::zeros(),
                epsilon => against_tension(&stress) * (-epsilon / (rho * rho)),
            };
            self.pulls[i] = Pull { stress: stress * correction / (rho * rho), artificial };
        }
        let (x, v, kernel, pulls) = (&self.positions, &self.velocities, &self.kernel, &self.pulls);
        let (masses, rho, near, domain) = (&self.masses, &self.densities, &self.near, &self.domain);
        let alpha = self.form.artificial_viscosity;
        let (sound, h) = (self.material.sound_speed(), 0.5 * kernel.cutoff());
        let (parted, usual) = (self.form.artificial_stress != 0.0, 1.0 / kernel.value(self.spacing));
        let chunks = self.accelerations.par_chunks_mut(CHUNK).enumerate();
        let pairs: u64 = chunks
            .map(|(chunk, rows)| {
                let mut pairs = 0;
                for (row, out) in rows.iter_mut().enumerate() {
                    let i = chunk * CHUNK + row;
                    let mut sum: Vector<D> = Vector::zeros();
                    for &j in near.of(i) {
                        let j = j as usize;
                        let away = domain.separation(&x[j], &x[i]);
                        let r2 = away.norm_squared();
                        let r = r2.sqrt();
                        if r >= kernel.cutoff() {
                            continue;
                        }
                        pairs += 1;
                        let mut pull = pulls[i].stress + pulls[j].stress;
                        if parted {
                            let nearness = (kernel.value(r) * usual).powi(4);
                            pull += (pulls[i].artificial + pulls[j].artificial) * nearness;
                        }
                        let closing = (v[j] - v[i]).dot(&away);
                        if alpha > 0.0 && closing < 0.0 {
                            let mu = h * closing / (r2 + 0.01 * h * h);
                            let push =
                                (alpha * sound * mu - 2.0 * alpha * mu * mu) / (0.5 * (rho[i] + rho[j]));
                            for k in 0..D {
                                pull[(k, k)] += push;
                            }
                        }
                        sum += pull * away * (masses[j] * kernel.f(r));
                    }
                    *out = sum;
                }
                pairs
            })
            .sum();
        self.tally.bond_evaluations += pairs;
        Ok(())
    }
}

/// The part of a stress that pulls: its principal values above zero, in their axes.
fn against_tension<const D: usize>(stress: &Matrix<D>) -> Matrix<D> {
    if D == 2 {
        let (middle, half) = (0.5 * stress.trace(), 0.5 * (stress[(0, 0)] - stress[(1, 1)]));
        let radius = half.hypot(stress[(0, 1)]);
        let (low, high) = (middle - radius, middle + radius);
        return match () {
            () if low >= 0.0 => *stress,
            () if high <= 0.0 => Matrix::zeros(),
            // σ - low 1 holds the axis of the larger value alone, 2 radius long.
            () => (stress - Matrix::identity() * low) * (high / (2.0 * radius)),
        };
    }
    // Pressed along what is not simulated, so that nothing is added there.
    let axes = embed(stress, -1.0).symmetric_eigen();
    let pulled = nalgebra::Matrix3::from_diagonal(&axes.eigenvalues.map(|s| s.max(0.0)));
    let all = axes.eigenvectors * pulled * axes.eigenvectors.transpose();
    Matrix::from_fn(|a, b| all[(a, b)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_pulls_is_found_in_its_own_axes() {
        let (sin, cos) = 0.7_f64.sin_cos();
        let turn = Matrix::<2>::new(cos, -sin, sin, cos);
        let turned = |a: f64, b: f64| turn * Matrix::<2>::new(a, 0.0, 0.0, b) * turn.transpose();
        for (a, b) in [(2.0, -1.0), (-1.0, 3.0), (2.0, 1.0), (-2.0, -1.0), (1.0, 1.0)] {
            let (stress, exact) = (turned(a, b), turned(f64::max(a, 0.0), f64::max(b, 0.0)));
            // Rounding of a few products.
            assert!((against_tension(&stress) - exact).norm() < 1e-14);
            // In space, pressed or pulled along z as well.
            for z in [-1.0, 4.0] {
                let space = against_tension(&embed(&stress, z));
                assert!((space - embed(&exact, f64::max(z, 0.0))).norm() < 1e-14);
            }
        }
    }
}
