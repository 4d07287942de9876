//! Friction between neighbours.

use crate::fluid::particles::{Material, Side};
use crate::fluid::setup::Friction;
use crate::fluid::symmetric::Symmetric;
use crate::fluid::terms::continuity::LEAST_DETERMINANT;
use crate::vector::Vector;
use nalgebra::SMatrix;

/// Force on i: -Σ V_i V_j eta_ij F [a v_ij + b (v_ij·e) e], eta_ij the harmonic mean, e = x/|x|.
///
/// Morris, Fox & Zhu 1997: a = 2, b = 0. Español & Revenga 2003: a = b = 2 (D + 2)/(D + 3). Either has the shear
/// viscosity eta [a/2 + b/(2 (D + 2))] = eta. SPH-BVF Eq. (18) lacks the factor 2 (a Taylor-Green vortex then decays
/// at half its rate). A no-slip solid takes the viscosity of the fluid and its mirrored velocity; with a
/// free-slip solid there is no friction.
pub struct Viscosity {
    pub form: Friction,
}

impl Viscosity {
    /// a of `D` dimensions: 2, or 2 (D + 2)/(D + 3).
    #[inline(always)]
    #[must_use]
    pub fn a<const D: usize>(&self) -> f64 {
        match self.form {
            Friction::Morris => 2.0,
            Friction::EspanolRevenga => 2.0 * (D as f64 + 2.0) / (D as f64 + 3.0),
        }
    }

    /// Force per volume of i and of j, N/m³ times m^-D, from `rub` = eta_ij F, the distance `x` (m) and the difference
    /// of velocities (m/s).
    #[inline(always)]
    pub fn pair<const D: usize>(&self, rub: f64, x: &Vector<D>, apart: &Vector<D>, out: &mut Vector<D>) {
        let strength = self.a::<D>() * rub;
        *out -= apart * strength;
        if self.form == Friction::EspanolRevenga {
            *out -= x * (strength * apart.dot(x) / x.norm_squared());
        }
    }
}

/// θ of [`beyond_the_second_order`].
pub const THETA: f64 = 1.0 / 3.0;

/// (1 + θ)(v_i - v_j), θ = 1/3, which takes the place of v_i - v_j in the form of Morris together with the [`flux`]; with the
/// factor c_ij of [`Moment`](super::Moment) the force of a pair is then -V_i V_j eta F [2 c_ij (1 + θ)(v_i - v_j) - θ (∇v_i G_i⁻¹ + ∇v_j G_j⁻¹)·x].
///
/// Σ 2 V_j F (v_i - v_j) is -∇²v - M/12 ∇⁴v, M the fourth moment of F along a line, 0.27 h² for Lucy's kernel in the plane: a
/// vortex of 50 spacings decays 0.65 % too slowly. With r along x, what is added is θ (-r³ ∂³v/12 + r⁴ ∂⁴v/24), of which the
/// sum is θ M/12 ∇⁴v; gradients summed with the same F are too large by M/6 ∇²∇v, which adds twice as much again:
/// together 3 θ M/12 ∇⁴v, so θ = 1/3 takes the error out. The pair's forces stay opposite. And it dissipates however
/// particles lie: Σ_i V_i tr(∇v_i G_i ∇v_iᵀ) is at most Σ V_i V_j F |v_i - v_j|² over pairs both ways, so the rate is at least
/// that without θ, and at most 1 + θ times that.
#[inline(always)]
#[must_use]
pub fn beyond_the_second_order<const D: usize>(i: &Side<D>, j: &Side<D>) -> Vector<D> {
    (i.velocity - j.velocity) * (1.0 + THETA)
}

/// The flux -θ eta ∇v G⁻¹, N/m². Its divergence by the sums has the second moment G that the factor c_ij takes out of
/// friction itself: with its size alone the channel flow of Poiseuille, whose rows slide, errs by 9e-4.
#[inline(always)]
#[must_use]
pub fn flux<const D: usize>(
    eta: f64,
    gradient: &SMatrix<f64, D, D>,
    moment: &Symmetric<D>,
) -> SMatrix<f64, D, D> {
    moment.divide(gradient, LEAST_DETERMINANT).unwrap_or(*gradient) * (-THETA * eta)
}

/// The viscosity that acts between fluid i and j, Pa s.
#[inline(always)]
#[must_use]
pub fn between_fluids<const D: usize>(i: &Side<D>, j: &Side<D>) -> f64 {
    if i.viscosity == j.viscosity {
        i.viscosity
    } else {
        2.0 * i.viscosity * j.viscosity / (i.viscosity + j.viscosity)
    }
}

/// The viscosity that acts between fluid i and solid j, Pa s.
#[inline(always)]
#[must_use]
pub fn with_solid<const D: usize>(i: &Side<D>, j: &Side<D>) -> f64 {
    if j.material == Material::FreeSlip { 0.0 } else { i.viscosity }
}
