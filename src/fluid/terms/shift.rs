//! The background pressure that keeps particles evenly spread without touching their momentum.

use crate::fluid::pass::Pair;
use crate::space::kernel::{Kernel, KernelKind};
use crate::vector::Vector;

/// Transport less momentum velocity, w_i = (dt/2) P_b (1/m_i) Σ 2 V_i V_j F x_ij, with the background pressure
/// P_b = 2 A rho0 h U/dt: only P_b dt matters, so w does not depend on the step. m/s.
///
/// SPH-BVF's P_b = rho0 c0² is too weak to keep particles from clumping. The shift moves particles towards the
/// least Σ V_i V_j W, and that resists pairing only as far as the Fourier transform of W at half the
/// wavenumber of the lattice is positive: for Lucy's kernel with h = 3 spacings it is 0.0015, for Wendland's 0.033
/// (of 1 at zero). The shift therefore uses Wendland's F with the same cut-off, whatever the kernel of the flow;
/// with Lucy's, rows of a Poiseuille flow pair up and its error triples.
pub struct Shift<const D: usize> {
    /// A h U, m²/s.
    strength: f64,
    kernel: Kernel<D>,
}

impl<const D: usize> Shift<D> {
    /// From A, the cut-off h (m) and the reference speed U (m/s).
    #[must_use]
    pub fn new(a: f64, h: f64, reference_speed: f64) -> Shift<D> {
        Shift { strength: a * h * reference_speed, kernel: Kernel::new(KernelKind::Wendland, h) }
    }

    /// The kernel of the shift.
    #[inline(always)]
    #[must_use]
    pub fn kernel(&self) -> &Kernel<D> {
        &self.kernel
    }

    /// 2 F x_ij, of which the crowding of i is the sum weighted with V_j; m^-(D+1).
    #[inline(always)]
    #[must_use]
    pub fn pair(p: &Pair<D>) -> Vector<D> {
        p.x * (2.0 * p.f_shift)
    }

    /// The velocity w of a crowding (1/m) at a density relative to rest, m/s.
    #[inline(always)]
    #[must_use]
    pub fn velocity(&self, crowding: &Vector<D>, relative_density: f64) -> Vector<D> {
        crowding * (self.strength / relative_density)
    }
}
