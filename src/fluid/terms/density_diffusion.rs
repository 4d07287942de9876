//! Diffusion of density, which keeps sound waves of the length of a spacing from growing.

use crate::fluid::particles::Side;
use crate::fluid::pass::Approach;

/// drho_i/dt = 2 delta h c Σ V_j (rho_j - rho_i) F, within one material only; after Antuono et al. 2010
/// (their h is half of ours). kg/m³/s.
///
/// The speed c is c0, but at most 10 U. They differ where pressure, not speed, asked for a stiff fluid: slow
/// viscous flows, in which friction damps sound anyway and a diffusion in proportion to c0 carries mass down
/// the pressure gradient (a fifth of the flux of a pump at Re = 0.025).
pub struct DensityDiffusion {
    /// 2 delta h c, m²/s.
    pub strength: f64,
}

impl DensityDiffusion {
    /// From delta, the cut-off h (m), the sound speed and the reference speed U (m/s).
    #[must_use]
    pub fn new(delta: f64, h: f64, sound_speed: f64, reference_speed: f64) -> DensityDiffusion {
        DensityDiffusion { strength: 2.0 * delta * h * sound_speed.min(10.0 * reference_speed) }
    }

    /// What the density of i gains from j, per volume of j; kg/m³/s times m^-D. Antisymmetric.
    #[inline(always)]
    pub fn pair<const D: usize>(&self, a: &Approach<D>, i: &Side<D>, j: &Side<D>, out: &mut f64) {
        if i.body == j.body {
            *out += self.strength * a.f * a.denser;
        }
    }
}
