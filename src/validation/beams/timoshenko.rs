//! Frequencies of beams by Timoshenko's theory: Huang (1961), J. Appl. Mech. 28, 579.

use crate::solid::Material;

/// How the two ends of a beam are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Clamped and free.
    Cantilever,
    Free,
    Clamped,
}

impl Ends {
    /// kL of the mode `n` from 1 on of a thin beam (Euler and Bernoulli).
    #[must_use]
    pub fn wave(self, n: usize) -> f64 {
        let known: &[f64] = match self {
            Ends::Cantilever => &[1.875_104_1, 4.694_091_1],
            Ends::Free | Ends::Clamped => &[4.730_040_7, 7.853_204_6],
        };
        let far = if self == Ends::Cantilever { n as f64 - 0.5 } else { n as f64 + 0.5 };
        known.get(n - 1).copied().unwrap_or(far * std::f64::consts::PI)
    }
}

/// A beam of length and height (m): a plate in plane strain, or of square section.
#[derive(Clone, Copy, Debug)]
pub struct Timoshenko {
    pub length: f64,
    pub height: f64,
    pub material: Material,
    pub plane: bool,
}

impl Timoshenko {
    /// √(E I/(ρ A L⁴)) with E/(1 - ν²) in plane strain, 1/s: frequencies are this times b.
    fn unit(&self) -> f64 {
        let nu = self.material.poisson();
        let modulus = self.material.young() / if self.plane { 1.0 - nu * nu } else { 1.0 };
        (modulus / (12.0 * self.material.density)).sqrt() * self.height / self.length.powi(2)
    }

    /// Angular frequency (1/s) of mode `n` from 1 on, with shear and rotary inertia.
    #[must_use]
    pub fn frequency(&self, ends: Ends, n: usize) -> f64 {
        let nu = self.material.poisson();
        // Shear coefficients: 5 (1 + ν)/(6 + 5 ν) in plane stress, in plane strain with ν/(1 - ν); of a square
        // 10 (1 + ν)/(12 + 11 ν) (Cowper 1966).
        let (modulus, shear) = if self.plane {
            let across = nu / (1.0 - nu);
            (self.material.young() / (1.0 - nu * nu), 5.0 * (1.0 + across) / (6.0 + 5.0 * across))
        } else {
            (self.material.young(), 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu))
        };
        let r = (self.height / self.length).powi(2) / 12.0;
        let s = r * modulus / (shear * self.material.shear);
        let thin = ends.wave(n).powi(2);
        // From the thin beam downwards to the first change of sign.
        let (mut high, step) = (1.001 * thin, 0.002 * thin);
        while high > step && zero(ends, high, r, s).signum() == zero(ends, high - step, r, s).signum() {
            high -= step;
        }
        let mut low = high - step;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let same = zero(ends, middle, r, s).signum() == zero(ends, high, r, s).signum();
            (low, high) = if same { (low, middle) } else { (middle, high) };
        }
        low * self.unit()
    }
}

/// The frequency equations (5), (7) and (9) of Huang; `r` and `s` are his r² and s².
fn zero(ends: Ends, b: f64, r: f64, s: f64) -> f64 {
    let root = ((r - s).powi(2) + 4.0 / (b * b)).sqrt();
    let alpha = b * (0.5 * (root - r - s)).sqrt();
    let beta = b * (0.5 * (root + r + s)).sqrt();
    let (even, odd) = (alpha.cosh() * beta.cos(), alpha.sinh() * beta.sin());
    let w = b / (1.0 - b * b * r * s).sqrt();
    match ends {
        Ends::Cantilever => 2.0 + (b * b * (r - s).powi(2) + 2.0) * even - w * (r + s) * odd,
        Ends::Free => 2.0 - 2.0 * even + w * (b * b * r * (r - s).powi(2) + 3.0 * r - s) * odd,
        Ends::Clamped => 2.0 - 2.0 * even + w * (b * b * s * (r - s).powi(2) + 3.0 * s - r) * odd,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::Law;

    #[test]
    fn a_thin_beam_is_that_of_euler_and_bernoulli() {
        let material = Material::of_young(Law::NeoHookean, 1000.0, 2e6, 0.3);
        for ends in [Ends::Cantilever, Ends::Free, Ends::Clamped] {
            for n in [1, 2] {
                let beam = |height| Timoshenko { length: 1.0, height, material, plane: false };
                let lack = |height| {
                    1.0 - beam(height).frequency(ends, n) / (ends.wave(n).powi(2) * beam(height).unit())
                };
                // The square of the slenderness, and nothing before it.
                let ratio = lack(0.02) / lack(0.01);
                assert!(
                    (0.0..2e-3).contains(&lack(0.01)) && (ratio - 4.0).abs() < 0.1,
                    "{ends:?} {n}: {ratio}"
                );
            }
        }
    }
}
