//! Friction between neighbours.

use crate::fluid::particles::{Material, Side};
use crate::fluid::pass::{Pair, Rates};

/// Force on i: -Σ 2 V_i V_j eta_ij F (v_i - v_j), eta_ij the harmonic mean; Morris, Fox & Zhu 1997.
///
/// SPH-BVF Eq. (18) lacks the factor 2 (a Taylor-Green vortex then decays at half its rate). A no-slip solid
/// takes the viscosity of the fluid and its mirrored velocity; with a free-slip solid there is no friction.
pub struct Viscosity;

impl Viscosity {
    /// Force per volume of i, N/m³.
    #[inline(always)]
    pub fn pair<const D: usize>(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, out: &mut Rates<D>) {
        let eta = between(i, j);
        out.force -= (i.velocity - j.velocity) * (2.0 * j.volume * eta * p.f);
    }
}

/// The viscosity that acts between fluid i and j, Pa s.
#[inline(always)]
#[must_use]
pub fn between<const D: usize>(i: &Side<D>, j: &Side<D>) -> f64 {
    match j.material {
        Material::FreeSlip => 0.0,
        Material::NoSlip => i.viscosity,
        Material::Fluid if i.viscosity == j.viscosity => i.viscosity,
        Material::Fluid => 2.0 * i.viscosity * j.viscosity / (i.viscosity + j.viscosity),
    }
}
