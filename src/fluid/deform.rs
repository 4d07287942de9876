//! Solids that deform as prescribed: the particle at x at t = 0 is at x + u(x, t).

use std::sync::Arc;

use crate::vector::Vector;
use nalgebra::SMatrix;

/// A displacement u(x, t), m, of the place x (m) at t = 0 and the time (s).
pub type Displacement<const D: usize> = Arc<dyn Fn(&Vector<D>, f64) -> Vector<D> + Send + Sync>;

/// A prescribed deformation. The body stays in one piece as long as u changes by less than the distance from one point
/// to another, |∇u| < 1; only then is there one place at t = 0 for each of now.
#[derive(Clone)]
pub struct Deformation<const D: usize> {
    pub displacement: Displacement<D>,
    /// A time short against all changes of u, s: the step of difference quotients.
    pub instant: f64,
    /// A length short against all changes of u, m: the same in space.
    pub nearby: f64,
}

/// Most rounds of the search for a place at t = 0, x' = y - u(x', t); each gains a factor |∇u|.
const ROUNDS: u32 = 60;
/// Weights of the differences u(t + k d) - u(t - k d), k = 1, 2, 3, in 60 d du/dt; error (ω d)⁶/140.
const FIRST: [f64; 3] = [45.0, -9.0, 1.0];
/// Weights of u(t + k d) - 2 u(t) + u(t - k d), k = 1, 2, 3, in 180 d² d²u/dt²; error (ω d)⁶/560.
const SECOND: [f64; 3] = [270.0, -27.0, 2.0];

impl<const D: usize> Deformation<D> {
    /// Where the particle of `start` is at time `t`, m; at rest until t = 0.
    #[must_use]
    pub fn position(&self, start: &Vector<D>, t: f64) -> Vector<D> {
        start + (self.displacement)(start, t.max(0.0))
    }

    /// Where the material now at `point` was at t = 0, m: by iteration to rounding.
    #[must_use]
    pub fn origin(&self, point: &Vector<D>, t: f64) -> Vector<D> {
        let mut origin = *point;
        let mut before = f64::INFINITY;
        for _ in 0..ROUNDS {
            let next = point - (self.displacement)(&origin, t.max(0.0));
            let moved = (next - origin).norm_squared();
            origin = next;
            // Written so that "not a number" ends the search too.
            if !(moved > 0.0 && moved < before) {
                break;
            }
            before = moved;
        }
        origin
    }

    /// Volume of the material at `start` over that at t = 0: det(1 + ∇u).
    #[must_use]
    pub fn growth(&self, start: &Vector<D>, t: f64) -> f64 {
        let t = t.max(0.0);
        let mut stretch = SMatrix::<f64, D, D>::identity();
        for k in 0..D {
            let (mut ahead, mut behind) = (*start, *start);
            ahead[k] += self.nearby;
            behind[k] -= self.nearby;
            let slope =
                ((self.displacement)(&ahead, t) - (self.displacement)(&behind, t)) / (2.0 * self.nearby);
            for a in 0..D {
                stretch[(a, k)] += slope[a];
            }
        }
        // Written out, for a matrix of any size has no determinant here.
        let at = |a: usize, b: usize| stretch[(a, b)];
        match D {
            1 => at(0, 0),
            2 => at(0, 0) * at(1, 1) - at(0, 1) * at(1, 0),
            _ => {
                at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1))
                    - at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0))
                    + at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0))
            }
        }
    }

    /// Velocity of the particle of `start` at time `t`, m/s; before t = 0 it rests.
    #[must_use]
    pub fn velocity(&self, start: &Vector<D>, t: f64) -> Vector<D> {
        if t < 0.0 {
            return Vector::zeros();
        }
        let (t, instant) = within(t, self.instant, 1e-5);
        let u = |k: f64| (self.displacement)(start, t + k * instant);
        let terms = FIRST.iter().zip([1.0, 2.0, 3.0]).map(|(weight, k)| (u(k) - u(-k)) * *weight);
        terms.fold(Vector::zeros(), |sum: Vector<D>, term| sum + term) / (60.0 * instant)
    }

    /// Acceleration of the particle of `start` at time `t`, m/s².
    #[must_use]
    pub fn acceleration(&self, start: &Vector<D>, t: f64) -> Vector<D> {
        if t < 0.0 {
            return Vector::zeros();
        }
        // Ten times the step of the first derivative: rounding counts by its square here.
        let (t, instant) = within(t, 10.0 * self.instant, 1e-3);
        let u = |k: f64| (self.displacement)(start, t + k * instant);
        let now = u(0.0);
        let terms =
            SECOND.iter().zip([1.0, 2.0, 3.0]).map(|(weight, k)| ((u(k) - now) + (u(-k) - now)) * *weight);
        terms.fold(Vector::zeros(), |sum: Vector<D>, term| sum + term) / (180.0 * instant * instant)
    }
}

/// A time and a step of difference quotients that do not ask for what is before t = 0, where u need not be defined: near it
/// they are shorter, down to a share that rounding allows.
fn within(t: f64, instant: f64, least: f64) -> (f64, f64) {
    let instant = instant.min(t / 3.0).max(least * instant);
    (t.max(3.0 * instant), instant)
}

impl<const D: usize> std::fmt::Debug for Deformation<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "Deformation {{ instant: {} }}", self.instant)
    }
}

impl<const D: usize> PartialEq for Deformation<D> {
    fn eq(&self, other: &Deformation<D>) -> bool {
        Arc::ptr_eq(&self.displacement, &other.displacement) && self.instant == other.instant
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_and_origin_of_a_wave() {
        let wave = |x: &Vector<2>, t: f64| Vector::<2>::new(0.0, 0.2 * (2.0 * x[0] - 3.0 * t).sin());
        let deformation = Deformation { displacement: Arc::new(wave), instant: 1e-3, nearby: 1e-4 };
        let (start, t) = (Vector::<2>::new(0.4, 0.1), 0.7);
        let phase = 2.0 * start[0] - 3.0 * t;
        let velocity = deformation.velocity(&start, t)[1];
        // (ω d)⁶/140 of it is 5e-18; rounding 1e-16/d.
        assert!((velocity + 0.6 * phase.cos()).abs() < 1e-12, "{velocity}");
        let acceleration = deformation.acceleration(&start, t)[1];
        // (10 ω d)⁶/560 of it is 1e-12; rounding 1e-16/(10 d)².
        assert!((acceleration + 1.8 * phase.sin()).abs() < 1e-10, "{acceleration}");
        // Defined from t = 0 on only: t^1.5 has no number before.
        let late = Deformation {
            displacement: Arc::new(|_: &Vector<2>, t: f64| Vector::<2>::new(t.powf(1.5), 0.0)),
            ..deformation.clone()
        };
        assert!(late.velocity(&start, 0.0)[0].is_finite() && late.acceleration(&start, 0.0)[0].is_finite());
        let there = deformation.position(&start, t);
        assert!((deformation.origin(&there, t) - start).norm() < 1e-15);
        // A stretch by 1.3: each round gains a factor 0.3.
        let stretch = Deformation {
            displacement: Arc::new(|x: &Vector<2>, t: f64| x * (0.3 * t)) as Displacement<2>,
            instant: 1e-3,
            nearby: 1e-4,
        };
        assert!((stretch.origin(&stretch.position(&start, 1.0), 1.0) - start).norm() < 1e-14);
        // Areas grow by 1.3²; a shear leaves them; rounding is 1e-16/1e-4.
        assert!((stretch.growth(&start, 1.0) - 1.69).abs() < 1e-11);
        assert!((deformation.growth(&start, t) - 1.0).abs() < 1e-11);
    }
}
