//! Conservation of mass.

use crate::fluid::particles::Side;
use crate::fluid::pass::Approach;
use crate::fluid::symmetric::Symmetric;
use nalgebra::SMatrix;

/// The density rate of i, kg/m³/s, with w = transport less momentum velocity. Sums with w run over the same
/// material only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// -rho_i times the [`contraction`] of M_i G_i⁻¹ with the sum M_i = Σ V_j F (v_i - v_j)⊗x and the second moment G_i = Σ V_j F x⊗x
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

/// Σ V_j F (v_i - v_j)⊗x, 1/s: the gradient of the velocity where particles lie evenly.
pub type Spread<const D: usize> = SMatrix<f64, D, D>;

/// Least determinant of the second moment that is inverted; an even neighbourhood has one, half of one
/// 2^-D.
pub const LEAST_DETERMINANT: f64 = 0.1;

/// The gradient of the velocity ∂v_a/∂x_b = (M_i G_i⁻¹)_ab, 1/s: exact for every linear velocity however the particles
/// lie. Its trace is the divergence of [`Continuity::Corrected`].
#[inline]
#[must_use]
pub fn gradient<const D: usize>(moment: &Symmetric<D>, spread: &Spread<D>) -> SMatrix<f64, D, D> {
    moment.divide(spread, LEAST_DETERMINANT).unwrap_or(*spread)
}

/// The rate at which a volume has grown over a step of `dt` (s) that ended where the gradient g of its velocity is seen,
/// [1 - det(1 - dt g)]/dt to second order: tr g - dt/2 [(tr g)² - tr g²], 1/s.
///
/// Velocities are those of the middle of the step (of solids too), places those of its end, x = (1 - dt g)⁻¹ times those of its beginning.
/// The trace alone is off by dt/2 tr g², which in a vortex never vanishes: that of Taylor and Green gains 1.4 % of its
/// energy by it at a Courant number of 0.2.
#[inline]
#[must_use]
pub fn contraction<const D: usize>(g: &SMatrix<f64, D, D>, dt: f64) -> f64 {
    let trace = g.trace();
    let square = g.component_mul(&g.transpose()).sum();
    trace - 0.5 * dt * (trace * trace - square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::Vector;

    #[test]
    fn volumes_grow_as_a_linear_flow_makes_them_grow() {
        // x -> (1 + dt g0) x; seen at the end of the step the gradient is g = g0 (1 + dt g0)⁻¹.
        let g0 = SMatrix::<f64, 3, 3>::new(0.3, -1.2, 0.4, 0.7, 0.9, -0.2, 1.1, 0.5, -1.0);
        let off = |dt: f64| {
            let stretch = SMatrix::identity() + g0 * dt;
            let g = g0 * stretch.try_inverse().expect("small");
            (contraction(&g, dt) - (1.0 - 1.0 / stretch.determinant()) / dt).abs()
        };
        // The next term is dt² det g: a quarter for half the step.
        assert!((off(1e-3) / off(5e-4) - 4.0).abs() < 0.1, "{} {}", off(1e-3), off(5e-4));
        // In the plane there is none.
        let g = SMatrix::<f64, 2, 2>::new(0.3, -1.2, 0.7, 0.9);
        let exact = (1.0 - (SMatrix::identity() - g * 0.1).determinant()) / 0.1;
        assert!((contraction(&g, 0.1) - exact).abs() < 1e-14);
    }

    #[test]
    fn a_linear_velocity_has_its_own_divergence_whatever_the_neighbours() {
        // v = A x seen by five neighbours anywhere: M = A G, so the rate is -rho tr A.
        let a = SMatrix::<f64, 2, 2>::new(0.3, -1.2, 0.7, 0.9);
        let (mut moment, mut spread) = (Symmetric::<2>::identity(0.0), Spread::<2>::zeros());
        for (x, y, weight) in
            [(1.0, 0.1, 0.3), (-0.8, 0.6, 0.5), (0.2, -1.1, 0.9), (-0.3, -0.7, 0.2), (0.9, 0.8, 0.4)]
        {
            let x = Vector::<2>::new(x, y);
            moment.add_square(&x, weight);
            spread += a * x * x.transpose() * weight;
        }
        // Rounding of some tens of operations.
        assert!((gradient(&moment, &spread) - a).norm() < 1e-13);
        // Too few neighbours: the plain sum.
        let line = Symmetric::<2> { diagonal: Vector::<2>::new(1.0, 0.0), mixed: Vector::<2>::zeros() };
        assert_eq!(gradient(&line, &spread), spread);
    }
}
