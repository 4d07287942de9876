//! Thermal noise between neighbours, keyed by the pair: both sides draw the same, and no order of evaluation or number
//! of threads changes it.
//!
//! How it enters a step. Kick, drift, kick with one force a step makes v^{n+½} = (1 - γ dt) v^{n-½} + β ξ for a mode of
//! friction γ; with β² = 2 γ dt kT/m its variance is (kT/m)/(1 - γ dt/2), and that of v^n = v^{n-½} + half the same kick
//! is (1 - γ dt/2)² (kT/m)/(1 - γ dt/2) + β²/4 = kT/m: exact for any step. This holds for each mode of the symmetric
//! friction between neighbours, so the noise of a step is one draw of variance 1/dt, used in both half kicks.

use crate::fluid::particles::Side;
use crate::fluid::pass::Pair;
use crate::fluid::setup::{Friction, Noise};
use crate::random::{Purpose, mix};
use crate::vector::Vector;

/// Nodes and weights of the Gauss-Hermite rule of four points: x = ±√(3 ∓ √6). A deviate that takes the outer pair
/// with probability (3 - √6)/6 has the moments of a normal one up to the seventh.
const INNER: f64 = 0.741_963_784_302_725_9;
const OUTER: f64 = 2.334_414_218_338_977_2;
/// (3 - √6)/6 of 2^20.
const RARE: u64 = 96_208;

/// The deviate of 21 bits: one for the sign, twenty for the choice. The probability of the outer pair is
/// rounded to 2^-20, which changes the variance by less than 2e-6.
#[inline(always)]
fn deviate(bits: u64) -> f64 {
    // By a table: a branch would be guessed wrong one time in ten.
    let size = [INNER, OUTER][usize::from((bits & 0xf_ffff) < RARE)];
    f64::from_bits(size.to_bits() | (bits & 0x10_0000) << 43)
}

/// Force on i: √(2 a kT V_i V_j eta_ij F c_ij/dt) n, with the friction of [`Viscosity`](crate::fluid::terms::Viscosity)
/// and its factors. Morris: n = ξ, independent deviates along each axis. Español & Revenga 2003: the symmetric Wiener
/// matrix with its trace on e, whose law is that of √2 S e = ξ + (√2 - 1)(ξ·e) e, with covariance 1 + e⊗e.
///
/// With a solid the fluid rubs on its own image: the mirrored velocity is less the mean Σ s_i v_i of the fluid before
/// it. Of the friction γ_i (v_i + Σ s_j v_j) the symmetric part is γ_i δ_ij + (γ_i s_j + γ_j s_i)/2, so besides the
/// noise of the pair there is one that all fluid before the solid particle shares, √s_i of it each: exact on the
/// diagonal, and beside it where γ and s fall off alike.
pub struct ThermalNoise<const D: usize> {
    /// Of seed and realization.
    key: u64,
    /// Of the step in hand.
    step_key: u64,
    /// kT, J/m^(3-D).
    energy: f64,
    /// 2 a kT/dt, zero without a step.
    power: f64,
}

impl<const D: usize> ThermalNoise<D> {
    /// The noise of a seed and a realization.
    #[must_use]
    pub fn new(noise: &Noise) -> ThermalNoise<D> {
        // As for the streams of `random`: the key spread over all bits, once for each part.
        let key = mix(mix(mix(noise.seed) ^ noise.realization) ^ Purpose::Noise as u64);
        ThermalNoise { key, step_key: key, energy: noise.energy, power: 0.0 }
    }

    /// Makes ready for step number `step` of length `dt` (s) with the coefficient `a` of the friction; silent if
    /// `dt` is zero.
    pub fn begin(&mut self, step: u64, dt: f64, a: f64) {
        self.step_key = mix(self.key ^ step);
        self.power = if dt > 0.0 { 2.0 * a * self.energy / dt } else { 0.0 };
    }

    /// Independent deviates of the pair, the same from both sides.
    #[inline(always)]
    fn draw(&self, i: u32, j: u32) -> Vector<D> {
        let (low, high) = (i.min(j), i.max(j));
        let bits = mix(self.step_key ^ (u64::from(low) << 32 | u64::from(high)));
        Vector::from_fn(|k, _| deviate(bits >> (21 * k)))
    }

    /// Force per volume of i and of j, N/m³ times m^-D, that matches a form of friction of strength `rub` = eta_ij F c_ij.
    #[inline(always)]
    pub fn pair(&self, form: Friction, rub: f64, p: &Pair<D>, i: &Side<D>, j: &Side<D>, out: &mut Vector<D>) {
        let size = (self.power * rub).sqrt() * (i.inverse_root * j.inverse_root);
        let signed = f64::from_bits(size.to_bits() | u64::from(i.id > j.id) << 63);
        *out += shape(form, self.draw(i.id, j.id), &p.x) * signed;
    }

    /// The same between fluid i and solid j, where `share` is the part s_i of i in what j mirrors.
    #[inline(always)]
    #[must_use]
    pub fn solid(
        &self,
        form: Friction,
        rub: f64,
        share: f64,
        p: &Pair<D>,
        i: &Side<D>,
        j: &Side<D>,
    ) -> Vector<D> {
        let size = (self.power * rub).sqrt() * (i.inverse_root * j.inverse_root);
        let n = self.draw(i.id, j.id) + self.draw(j.id, j.id) * share.sqrt();
        shape(form, n, &p.x) * size
    }

    /// The torque on body number `body` that goes with its friction a `rub` ω, `rub` in kg m²/s per unit thickness.
    #[must_use]
    pub fn torque(&self, body: u8, rub: f64) -> [f64; 3] {
        // No pair of particles has this key.
        let bits = mix(self.step_key ^ (u64::from(u32::MAX - u32::from(body)) << 32 | u64::from(u32::MAX)));
        std::array::from_fn(|k| deviate(bits >> (21 * k)) * (self.power * rub).sqrt())
    }
}

/// Deviates with the covariance of the friction: 1, or 1 + e⊗e.
#[inline(always)]
fn shape<const D: usize>(form: Friction, n: Vector<D>, x: &Vector<D>) -> Vector<D> {
    match form {
        Friction::Morris => n,
        Friction::EspanolRevenga => n + x * ((std::f64::consts::SQRT_2 - 1.0) * n.dot(x) / x.norm_squared()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::terms::tests::side;

    #[test]
    fn deviates_have_the_moments_of_a_normal_law() {
        let p = f64::from(RARE as u32) / f64::from(1 << 20);
        for (power, expected) in [(2, 1.0), (4, 3.0), (6, 15.0)] {
            let moment = p * OUTER.powi(power) + (1.0 - p) * INNER.powi(power);
            // Half of 2^-20 times the largest difference, 5.4³.
            assert!((moment - expected).abs() < 1e-4 * expected, "{power}: {moment}");
        }
        assert_eq!((deviate(0), deviate(0x1f_ffff)), (OUTER, -INNER));
    }

    #[test]
    fn neighbours_and_steps_draw_independently() {
        let mut noise = ThermalNoise::<3>::new(&Noise { energy: 1.0, seed: 5, realization: 2 });
        let (mut square, mut next, mut later, mut axes, mut fourth) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let pairs = 40_000_u32;
        for n in 0..pairs {
            noise.begin(7, 1.0, 2.0);
            let (a, b) = (noise.draw(n, n + 1), noise.draw(n + 2, n + 1));
            assert_eq!(a, noise.draw(n + 1, n));
            noise.begin(8, 1.0, 2.0);
            let c = noise.draw(n, n + 1);
            square += a.norm_squared();
            fourth += a[0].powi(4);
            next += a.dot(&b);
            later += a.dot(&c);
            axes += a[0] * a[1] + a[1] * a[2];
        }
        let count = f64::from(pairs);
        // 120 000 squares of variance 2, products of variance 1 (two sums a pair: one), 40 000 fourth powers of
        // variance 96 at most: five standard errors each; a false alarm once in a million.
        assert!((square / count - 3.0).abs() < 5.0 * (6.0 / count).sqrt());
        assert!((fourth / count - 3.0).abs() < 5.0 * (96.0 / count).sqrt());
        assert!((next / count).abs() < 5.0 * (3.0 / count).sqrt());
        assert!((later / count).abs() < 5.0 * (3.0 / count).sqrt());
        assert!((axes / count).abs() < 5.0 * (2.0 / count).sqrt());
    }

    #[test]
    fn forces_are_opposite_and_have_the_covariance_of_the_friction() {
        let x = Vector::<2>::new(0.6, 0.8);
        let there = Pair { x, f: 1.0, f_shift: 1.0, inverse_square: 1.0 };
        let back = Pair { x: -x, ..there };
        for form in [Friction::Morris, Friction::EspanolRevenga] {
            let mut noise = ThermalNoise::<2>::new(&Noise { energy: 2.0, seed: 1, realization: 0 });
            let (mut along, mut across) = (0.0, 0.0);
            let count = 40_000;
            for step in 0..count {
                noise.begin(step, 0.5, 1.5);
                let (mut a, mut b) = (side::<2>(1.0, 0.0), side::<2>(1.0, 0.0));
                (a.id, b.id) = (3, 8);
                let (mut on_a, mut on_b) = (Vector::zeros(), Vector::zeros());
                noise.pair(form, 0.25, &there, &a, &b, &mut on_a);
                noise.pair(form, 0.25, &back, &b, &a, &mut on_b);
                assert_eq!(on_a, -on_b);
                along += on_a.dot(&x).powi(2);
                across += (on_a[0] * x[1] - on_a[1] * x[0]).powi(2);
            }
            // 2 a kT rub/dt = 3, twice that along e for Español & Revenga. Squares of variance 2 times the square
            // of the mean: 0.7 %, five of which are allowed.
            let twice = if form == Friction::Morris { 1.0 } else { 2.0 };
            assert!((along / count as f64 / (3.0 * twice) - 1.0).abs() < 0.036, "{form:?}");
            assert!((across / count as f64 / 3.0 - 1.0).abs() < 0.036, "{form:?}");
        }
    }
}
