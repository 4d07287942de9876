//! Conservation of mass.

use crate::fluid::particles::Side;
use crate::fluid::pass::Approach;

/// The density rate of i, kg/m³/s, with w = transport less momentum velocity. Sums with w run over the same
/// material only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
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
            Continuity::Advected | Continuity::Printed => i.density * a.opening,
            Continuity::Summed => j.density * a.opening,
        };
        if i.body == j.body {
            match self {
                Continuity::Advected => sum += 0.5 * (j.density - i.density) * (i.drift + j.drift).dot(&a.x),
                Continuity::Printed => sum += (i.drift * i.density + j.drift * j.density).dot(&a.x),
                Continuity::Summed => (),
            }
        }
        *out -= a.f * sum;
    }
}
