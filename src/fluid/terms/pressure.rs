//! The pressure gradient.

use crate::fluid::particles::Side;
use crate::fluid::pass::{Pair, Rates};

/// Force on i: Σ 2 V_i V_j p_ij F x_ij with p_ij = (rho_i p_j + rho_j p_i)/(rho_i + rho_j); Adami, Hu & Adams 2013.
pub struct Pressure;

impl Pressure {
    /// Force per volume of i, N/m³.
    #[inline(always)]
    pub fn pair<const D: usize>(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, out: &mut Rates<D>) {
        let between = (i.density * j.pressure + j.density * i.pressure) / (i.density + j.density);
        out.force += p.x * (2.0 * j.volume * between * p.f);
    }
}
