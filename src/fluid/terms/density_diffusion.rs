//! Diffusion of density, which keeps sound waves of the length of a spacing from growing.

use crate::fluid::particles::Side;
use crate::fluid::pass::Approach;
use crate::fluid::symmetric::Symmetric;
use crate::vector::Vector;

/// drho_i/dt = 2 delta h c Σ V_j [rho_j - rho_i + ½ (∇rho_i + ∇rho_j)·x] F with x = x_i - x_j, within one material only;
/// Antuono et al. 2010 (their h is half of ours). kg/m³/s.
///
/// The gradients are those of the step before ([`slope`]). They take out what is linear, so that a pressure gradient
/// drives no mass: without them (Molteni & Colagrossi 2009) the cavity at Re = 100 errs by half as much again, as mass
/// goes from the high pressure in one corner of the lid to the low one in the other.
///
/// None where a sponge sets the velocity: through a plug, narrower than the slopes can tell, 0.4 % of a stream leaked back.
///
/// The speed c is c0, but at most 10 U. They differ where pressure, not speed, asked for a stiff fluid: slow viscous
/// flows, in which friction damps sound anyway.
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
        if i.body == j.body && !(i.held || j.held) {
            *out += self.strength * a.f * (a.denser - a.sloping);
        }
    }
}

/// Least determinant of a second moment that is inverted, relative to that of an even one of the same trace.
const LEAST_EVENNESS: f64 = 0.1;

/// ∇rho = -G⁻¹ Σ V_j F (rho_j - rho_i) x from that sum over the same fluid and the second moment G of all fluid: exact for
/// every linear density however neighbours lie (Randles & Libersky 1996), too small before another fluid, where some of
/// the leak stays. Zero where they are too few or in a line. kg/m⁴.
#[inline]
#[must_use]
pub fn slope<const D: usize>(moment: &Symmetric<D>, sum: &Vector<D>) -> Vector<D> {
    let least = LEAST_EVENNESS * (moment.trace() / D as f64).powi(D as i32);
    moment.divide(&sum.transpose(), least).map_or_else(Vector::zeros, |slope| -slope.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::terms::tests::side;

    #[test]
    fn a_linear_density_stays_as_it_is_wherever_the_neighbours_are() {
        // rho = 2 + s·x at a particle of a corner and its neighbours, all on one side.
        let s = Vector::<2>::new(0.3, -0.7);
        let at = |place: Vector<2>| side(2.0 + s.dot(&place), 0.0);
        let (i, here) = (at(Vector::zeros()), Vector::zeros());
        let diffusion = DensityDiffusion::new(0.2, 1.0, 10.0, 1.0);
        let (mut moment, mut sum, mut rate): (_, Vector<2>, _) = (Symmetric::identity(0.0), here, 0.0);
        for (x, y, f) in [(0.3, 0.1, 1.2), (0.1, 0.4, 0.9), (0.4, 0.5, 0.3), (0.0, 0.6, 0.5)] {
            let place = Vector::<2>::new(x, y);
            let j = at(place);
            let mut a = Approach::new(&(here - place), f, &i, &j);
            a.sloping = -0.5 * (s + s).dot(&a.x);
            diffusion.pair(&a, &i, &j, &mut rate);
            moment.add_square(&a.x, f);
            sum += a.x * (f * a.denser);
        }
        // Rounding of some tens of operations.
        assert!((slope(&moment, &sum) - s).norm() < 1e-13);
        assert!(rate.abs() < 1e-14, "{rate}");
        assert_eq!(slope(&Symmetric::<2>::identity(0.0), &here), here);
    }
}
