//! Conservation of mass.

use crate::fluid::particles::Side;
use crate::fluid::pass::Approach;
use crate::fluid::symmetric::Symmetric;

/// The density rate of i, kg/m³/s, with w = transport less momentum velocity. Sums with w run over the same
/// material only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// -rho_i tr(G_i⁻¹ M_i) with the sum M_i = Σ V_j F (v_i - v_j)⊗x and the second moment G_i = Σ V_j F x⊗x
    /// ([`Spread`]), and the advection by w as in `Advected`. Exact for every linear velocity however the
    /// particles lie (the renormalised divergence of Randles & Libersky 1996). Without it disorder makes pressure,
    /// and pressure noise: a Poiseuille flow's particles stray 40 times as fast, a Taylor-Green vortex that leaves
    /// its lattice rings.
    Corrected,
    /// rho_i Σ V_j (v_i - v_j)·∇W + ½ Σ V_j (rho_j - rho_i)(w_i + w_j)·∇W. The second sum, the advection of the
    /// density by w, is written with the difference of densities so that it vanishes for a uniform density.
    Advected,
    /// rho_i Σ V_j (v_i - v_j)·∇W + Σ V_j (rho_i w_i + rho_j w_j)·∇W with the sign of Eq. (6); SPH-BVF Eq. (17).
    /// The second sum does not vanish for a uniform density where particles crowd, and drifts.
    Printed,
    /// Σ m_j (v_i - v_j)·∇W, the rate of the density by summation Σ m_j W; Monaghan 1992. Integrated from the
    /// rest density it needs no kernel sum at walls.
    Summed,
}

impl Continuity {
    /// What the density of i gains from j, per volume of j; kg/m³/s times m^-D.
    #[inline(always)]
    pub fn pair<const D: usize>(self, a: &Approach<D>, i: &Side<D>, j: &Side<D>, out: &mut f64) {
        let mut sum = match self {
            Continuity::Corrected => 0.0,
            Continuity::Advected | Continuity::Printed => i.density * a.opening,
            Continuity::Summed => j.density * a.opening,
        };
        if i.body == j.body {
            match self {
                Continuity::Corrected | Continuity::Advected => sum += 0.5 * a.denser * a.drifting,
                Continuity::Printed => sum += (i.drift * i.density + j.drift * j.density).dot(&a.x),
                Continuity::Summed => (),
            }
        }
        *out -= a.f * sum;
    }
}

/// The symmetric part of Σ V_j F (v_i - v_j)⊗x, 1/s, all that its product with G_i⁻¹ needs: where particles lie evenly
/// minus the rate of strain.
pub type Spread<const D: usize> = Symmetric<D>;

/// Least determinant of the second moment that is inverted; an even neighbourhood has one, half of one
/// 2^-D.
const LEAST_DETERMINANT: f64 = 0.1;

/// The density rate of the corrected form but for its advection, kg/m³/s.
#[inline]
#[must_use]
pub fn corrected_rate<const D: usize>(density: f64, moment: &Symmetric<D>, spread: &Spread<D>) -> f64 {
    -density * moment.inverse_contracted(spread, LEAST_DETERMINANT).unwrap_or_else(|| spread.trace())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::Vector;
    use nalgebra::SMatrix;

    #[test]
    fn a_linear_velocity_has_its_own_divergence_whatever_the_neighbours() {
        // v = A x seen by five neighbours anywhere: M = A G, so the rate is -rho tr A.
        let a = SMatrix::<f64, 2, 2>::new(0.3, -1.2, 0.7, 0.9);
        let (mut moment, mut spread) = (Symmetric::<2>::identity(0.0), Spread::<2>::identity(0.0));
        for (x, y, weight) in
            [(1.0, 0.1, 0.3), (-0.8, 0.6, 0.5), (0.2, -1.1, 0.9), (-0.3, -0.7, 0.2), (0.9, 0.8, 0.4)]
        {
            let x = Vector::<2>::new(x, y);
            moment.add_square(&x, weight);
            spread.add_scaled(&Spread::of(&(a * x), &x), weight);
        }
        // Rounding of some tens of operations.
        assert!((corrected_rate(2.0, &moment, &spread) + 2.0 * a.trace()).abs() < 1e-13);
        // Too few neighbours: the plain sum.
        let line = Symmetric::<2> { diagonal: Vector::<2>::new(1.0, 0.0), mixed: Vector::<2>::zeros() };
        assert_eq!(corrected_rate(2.0, &line, &spread), -2.0 * spread.trace());
    }
}
