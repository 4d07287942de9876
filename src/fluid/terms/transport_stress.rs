//! The momentum carried by the difference of transport and momentum velocity.

use crate::fluid::particles::Side;
use crate::fluid::pass::{Pair, Rates};

/// Force on i: Σ 2 V_i V_j ½ (A_i + A_j)·∇W with A = rho v ⊗ (transport - momentum velocity); Adami, Hu & Adams
/// 2013. Zero with solids.
pub struct TransportStress;

impl TransportStress {
    /// Force per volume of i, N/m³.
    #[inline(always)]
    pub fn pair<const D: usize>(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, out: &mut Rates<D>) {
        if j.is_solid() {
            return;
        }
        let scale = -j.volume * p.f;
        out.force += i.velocity * (scale * i.density * i.drift.dot(&p.x))
            + j.velocity * (scale * j.density * j.drift.dot(&p.x));
    }
}
