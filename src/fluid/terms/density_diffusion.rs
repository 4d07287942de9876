//! Diffusion of density, which keeps sound waves of the length of a spacing from growing.

use crate::fluid::particles::Side;
use crate::fluid::pass::Pair;

/// drho_i/dt = 2 delta h c0 Σ V_j (rho_j - rho_i) F, within one material only; after Antuono et al. 2010
/// (their h is half of ours). kg/m³/s.
pub struct DensityDiffusion {
    /// 2 delta h c0, m²/s.
    pub strength: f64,
}

impl DensityDiffusion {
    /// What the density of i gains from j, kg/m³/s. Antisymmetric once multiplied by V_i.
    #[inline(always)]
    pub fn pair<const D: usize>(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, density_rate: &mut f64) {
        if i.body == j.body {
            *density_rate += self.strength * j.volume * p.f * (j.density - i.density);
        }
    }
}
