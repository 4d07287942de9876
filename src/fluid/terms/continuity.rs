//! Conservation of mass for particles that move with the transport velocity.

use crate::fluid::particles::Side;
use crate::fluid::pass::Pair;

/// drho_i/dt = rho_i Σ V_j (v_i - v_j)·∇W + ½ Σ V_j (rho_j - rho_i)(w_i + w_j)·∇W, w = transport less momentum
/// velocity; kg/m³/s.
///
/// The second sum, the advection of the density by w, runs over the same material only. It is written with
/// the difference of densities so that it vanishes for a uniform density; the sum SPH-BVF prints does not.
pub struct Continuity;

impl Continuity {
    /// What the density of i gains from j, kg/m³/s.
    #[inline(always)]
    pub fn pair<const D: usize>(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, density_rate: &mut f64) {
        let volume_f = j.volume * p.f;
        *density_rate -= i.density * volume_f * (i.velocity - j.velocity).dot(&p.x);
        if i.body == j.body {
            *density_rate -= 0.5 * volume_f * (j.density - i.density) * (i.drift + j.drift).dot(&p.x);
        }
    }
}
