//! The background pressure that keeps particles evenly spread without touching their momentum.

use crate::fluid::particles::Side;
use crate::fluid::pass::{Pair, Rates};

/// Transport less momentum velocity, w_i = (dt/2) P_b (1/m_i) Σ 2 V_i V_j F x_ij, with the background pressure
/// P_b = 2 A rho0 h U/dt: only P_b dt matters, so w does not depend on the step. m/s.
///
/// SPH-BVF's P_b = rho0 c0² is too weak to keep particles from clumping.
pub struct Shift {
    /// A h U, m²/s.
    pub strength: f64,
}

impl Shift {
    /// Sum of 2 V_j F x_ij, 1/m; [`Shift::velocity`] makes a velocity of it.
    #[inline(always)]
    pub fn pair<const D: usize>(&self, p: &Pair<D>, j: &Side<D>, out: &mut Rates<D>) {
        out.crowding += p.x * (2.0 * j.volume * p.f);
    }
}
