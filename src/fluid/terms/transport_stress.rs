//! The momentum carried by the difference of transport and momentum velocity.

use crate::fluid::particles::Side;
use crate::fluid::pass::Pair;
use crate::vector::Vector;
use nalgebra::SMatrix;

/// Force on i: Σ 2 V_i V_j ½ (A_i + A_j)·∇W with A = rho v ⊗ (transport - momentum velocity); Adami, Hu & Adams
/// 2013. None with solids.
pub struct TransportStress;

impl TransportStress {
    /// A of a particle, N/m².
    #[inline(always)]
    #[must_use]
    pub fn flux<const D: usize>(&self, side: &Side<D>) -> SMatrix<f64, D, D> {
        side.velocity * side.drift.transpose() * side.density
    }

    /// Force per volume of i and of j, N/m³ times m^-D; written out, for those that do not keep their A.
    #[inline(always)]
    pub fn pair<const D: usize>(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, out: &mut Vector<D>) {
        *out -= i.velocity * (p.f * i.density * i.drift.dot(&p.x))
            + j.velocity * (p.f * j.density * j.drift.dot(&p.x));
    }
}
