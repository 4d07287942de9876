//! Hyperelastic materials: stress as a function of the deformation gradient F.

use crate::space::matrix::{Matrix, determinant, inverse};

/// The stored energy as a function of deformation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// W = λ/2 (tr E)² + G E:E, E = (FᵀF - 1)/2. For large rotations and small strains: it softens under compression.
    #[default]
    SaintVenantKirchhoff,
    /// W = G/2 (F:F - 3 - 2 ln J) + λ/2 (ln J)², J = det F (Bonet & Wood 2008). For large strains.
    NeoHookean,
}

/// An isotropic elastic material. In 2D strain is plane: nothing moves along z. λ = K - 2 G/3 always.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Material {
    pub law: Law,
    /// Density without load, kg/m³.
    pub density: f64,
    /// Bulk modulus K, Pa.
    pub bulk: f64,
    /// Shear modulus G, Pa.
    pub shear: f64,
}

impl Material {
    /// From Young's modulus E (Pa) and Poisson's ratio ν: K = E/(3 (1 - 2ν)), G = E/(2 (1 + ν)).
    #[must_use]
    pub fn of_young(law: Law, density: f64, young: f64, poisson: f64) -> Material {
        let (bulk, shear) = (young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
        Material { law, density, bulk, shear }
    }

    /// Young's modulus E = 9 K G/(3 K + G), Pa.
    #[must_use]
    pub fn young(&self) -> f64 {
        9.0 * self.bulk * self.shear / (3.0 * self.bulk + self.shear)
    }

    /// Poisson's ratio ν = (3 K - 2 G)/(2 (3 K + G)).
    #[must_use]
    pub fn poisson(&self) -> f64 {
        (3.0 * self.bulk - 2.0 * self.shear) / (2.0 * (3.0 * self.bulk + self.shear))
    }

    /// √(K/ρ), m/s.
    #[must_use]
    pub fn sound_speed(&self) -> f64 {
        (self.bulk / self.density).sqrt()
    }

    /// First Piola-Kirchhoff stress P (Pa) at the deformation gradient `f`, with the shear modulus `softness` times that
    /// of the material. `f` must not be inverted.
    #[inline(always)]
    #[must_use]
    pub fn stress<const D: usize>(&self, f: &Matrix<D>, softness: f64) -> Matrix<D> {
        let shear = self.shear * softness;
        let lambda = self.bulk - 2.0 / 3.0 * shear;
        match self.law {
            Law::SaintVenantKirchhoff => {
                let mut strain = f.transpose() * f;
                for k in 0..D {
                    strain[(k, k)] -= 1.0;
                }
                let spread = 0.5 * lambda * strain.trace();
                let mut second = strain * shear;
                for k in 0..D {
                    second[(k, k)] += spread;
                }
                f * second
            }
            Law::NeoHookean => {
                let back = inverse(f).transpose();
                (f - back) * shear + back * (lambda * determinant(f).ln())
            }
        }
    }

    /// Stored energy per volume without load, J/m³, as [`Material::stress`].
    #[must_use]
    pub fn energy<const D: usize>(&self, f: &Matrix<D>, softness: f64) -> f64 {
        let shear = self.shear * softness;
        let lambda = self.bulk - 2.0 / 3.0 * shear;
        match self.law {
            Law::SaintVenantKirchhoff => {
                let strain = (f.transpose() * f - Matrix::<D>::identity()) * 0.5;
                0.5 * lambda * strain.trace().powi(2) + shear * strain.norm_squared()
            }
            Law::NeoHookean => {
                let volume = determinant(f).ln();
                // What is not simulated is not stretched: it adds one to F:F along each of its axes.
                0.5 * shear * (f.norm_squared() - D as f64 - 2.0 * volume) + 0.5 * lambda * volume * volume
            }
        }
    }

    /// Pressure-like stress along an axis that is not simulated, S_zz of plane strain as Cauchy stress, Pa.
    #[must_use]
    pub fn stress_out_of_plane<const D: usize>(&self, f: &Matrix<D>, softness: f64) -> f64 {
        let lambda = self.bulk - 2.0 / 3.0 * self.shear * softness;
        let volume = determinant(f);
        match self.law {
            Law::SaintVenantKirchhoff => lambda * 0.5 * (f.norm_squared() - D as f64) / volume,
            Law::NeoHookean => lambda * volume.ln() / volume,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [Law; 2] = [Law::SaintVenantKirchhoff, Law::NeoHookean];

    fn material(law: Law) -> Material {
        Material { law, density: 1000.0, bulk: 3.0, shear: 1.3 }
    }

    /// P is the derivative of W by F: central differences, whose error is the step squared.
    fn derived<const D: usize>() {
        for law in LAWS {
            let (material, d) = (material(law), 1e-5);
            let f: Matrix<D> = Matrix::from_fn(|a, b| if a == b { 1.1 } else { 0.1 + 0.05 * a as f64 });
            let stress = material.stress(&f, 0.6);
            for a in 0..D {
                for b in 0..D {
                    let (mut up, mut down) = (f, f);
                    up[(a, b)] += d;
                    down[(a, b)] -= d;
                    let slope = (material.energy(&up, 0.6) - material.energy(&down, 0.6)) / (2.0 * d);
                    assert!((slope - stress[(a, b)]).abs() < 1e-8, "{law:?} {D} {a} {b}");
                }
            }
        }
    }

    #[test]
    fn stress_is_the_slope_of_the_energy() {
        derived::<1>();
        derived::<2>();
        derived::<3>();
    }

    #[test]
    fn small_strains_know_young_and_poisson() {
        for law in LAWS {
            let material = Material::of_young(law, 1.0, 2.0, 0.3);
            assert!((material.young() - 2.0).abs() < 1e-14 && (material.poisson() - 0.3).abs() < 1e-14);
            let e = 1e-6;
            // Pulled along x, free to shrink: no stress across, E times the strain along.
            let f = Matrix::<3>::from_diagonal(&[1.0 + e, 1.0 - 0.3 * e, 1.0 - 0.3 * e].into());
            let stress = material.stress(&f, 1.0);
            // Second order in the strain.
            assert!(
                (stress[(0, 0)] / (2.0 * e) - 1.0).abs() < 1e-5 && (stress[(1, 1)] / (2.0 * e)).abs() < 1e-5
            );
            // Sheared: G times the angle.
            let f = Matrix::<3>::new(1.0, e, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
            assert!((material.stress(&f, 1.0)[(0, 1)] / (material.shear * e) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn plane_strain_is_space_without_motion_along_z() {
        for law in LAWS {
            let material = material(law);
            let flat = Matrix::<2>::new(1.2, 0.1, -0.2, 0.9);
            let full = crate::space::matrix::embed(&flat, 1.0);
            let (in_plane, all) = (material.stress(&flat, 0.7), material.stress(&full, 0.7));
            assert!((in_plane - all.fixed_view::<2, 2>(0, 0)).norm() < 1e-14);
            let cauchy = all[(2, 2)] / determinant(&full);
            assert!((material.stress_out_of_plane(&flat, 0.7) - cauchy).abs() < 1e-14);
        }
    }
}
