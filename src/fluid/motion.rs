//! How a solid body moves, as a function of time alone. Before t = 0, while a flow settles, bodies keep their
//! places: those that travel or oscillate rest, those that rotate turn where they are. Free and elastic bodies are the
//! exception: the flow keeps their state in their motion.

use crate::fluid::deform::Deformation;
use crate::fluid::elastic::Coupled;
use crate::fluid::rigid::Rigid;
use crate::space::domain::Domain;
use crate::vector::Vector;

/// A motion, prescribed but for a free or an elastic body's.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Motion<const D: usize> {
    #[default]
    Still,
    /// The surface moves along itself, the particles stay: a conveyor belt, the lid of a cavity. m/s.
    Belt { velocity: Vector<D> },
    /// Constant velocity, m/s.
    Translating { velocity: Vector<D> },
    /// Velocity `amplitude * sin(frequency * t)`: starts from rest. m/s and rad/s.
    Oscillating { amplitude: Vector<D>, frequency: f64 },
    /// Rigid rotation about `centre` (m) with angular velocity `rate` (rad/s): in 2D its third component
    /// counts, in 3D the whole vector, in 1D there is none. In a box with periodic ends arms are the shortest.
    Rotating { centre: Vector<D>, rate: [f64; 3], domain: Option<Domain<D>> },
    /// Particles displaced by a function of place and time.
    Deforming(Deformation<D>),
    /// Moved by the fluid: as it is now, whatever time is asked for.
    Free(Box<Rigid<D>>),
    /// Moved and bent by the fluid: as it is now. The sweeps ask its particles; asked for a place it answers for the
    /// particle nearest to it.
    Elastic(Box<Coupled<D>>),
}

impl<const D: usize> Motion<D> {
    /// Where a particle that was at `start` at t = 0 is at time `t`, m.
    #[must_use]
    pub fn position(&self, start: &Vector<D>, t: f64) -> Vector<D> {
        match self {
            Motion::Still | Motion::Belt { .. } => *start,
            Motion::Translating { .. } | Motion::Oscillating { .. } => start + self.displacement(t),
            Motion::Rotating { centre, rate, domain } => {
                centre + rotate(&arm(domain, start, centre), rate, t.max(0.0))
            }
            Motion::Deforming(deformation) => deformation.position(start, t),
            Motion::Free(rigid) => rigid.position(start),
            Motion::Elastic(coupled) => {
                let i = coupled.nearest(start, true);
                let solid = coupled.solid();
                solid.position(i) + solid.gradient(i) * (start - solid.places()[i])
            }
        }
    }

    /// Where the material point now at `point` was at t = 0, m.
    #[must_use]
    pub fn origin(&self, point: &Vector<D>, t: f64) -> Vector<D> {
        match self {
            Motion::Still | Motion::Belt { .. } => *point,
            Motion::Translating { .. } | Motion::Oscillating { .. } => point - self.displacement(t),
            Motion::Rotating { centre, rate, domain } => {
                centre + rotate(&arm(domain, point, centre), rate, -t.max(0.0))
            }
            Motion::Deforming(deformation) => deformation.origin(point, t),
            Motion::Free(rigid) => rigid.origin(point),
            Motion::Elastic(coupled) => {
                let i = coupled.nearest(point, false);
                coupled.origin_beside(i, &(point - coupled.solid().position(i)))
            }
        }
    }

    /// Velocity of the material at `point` at time `t`, m/s.
    #[must_use]
    pub fn velocity(&self, point: &Vector<D>, t: f64) -> Vector<D> {
        match self {
            Motion::Still => Vector::zeros(),
            Motion::Translating { .. } | Motion::Oscillating { .. } if t < 0.0 => Vector::zeros(),
            Motion::Belt { velocity } | Motion::Translating { velocity } => *velocity,
            Motion::Oscillating { amplitude, frequency } => amplitude * (frequency * t).sin(),
            Motion::Rotating { centre, rate, domain } => cross(rate, &arm(domain, point, centre)),
            Motion::Deforming(deformation) => deformation.velocity(&deformation.origin(point, t), t),
            Motion::Free(rigid) => rigid.velocity_at(point),
            Motion::Elastic(coupled) => coupled.velocity(coupled.nearest(point, false)),
        }
    }

    /// Acceleration of the material at `point` at time `t`, m/s².
    #[must_use]
    pub fn acceleration(&self, point: &Vector<D>, t: f64) -> Vector<D> {
        match self {
            Motion::Still | Motion::Belt { .. } | Motion::Translating { .. } => Vector::zeros(),
            Motion::Oscillating { .. } if t < 0.0 => Vector::zeros(),
            Motion::Oscillating { amplitude, frequency } => amplitude * (*frequency * (frequency * t).cos()),
            Motion::Rotating { centre, rate, domain } => {
                cross(rate, &cross(rate, &arm(domain, point, centre)))
            }
            Motion::Deforming(deformation) => deformation.acceleration(&deformation.origin(point, t), t),
            Motion::Free(rigid) => rigid.acceleration_at(point),
            Motion::Elastic(coupled) => coupled.acceleration(coupled.nearest(point, false)),
        }
    }

    /// Whether the particles of the body change place.
    #[must_use]
    pub fn moves(&self) -> bool {
        !matches!(self, Motion::Still | Motion::Belt { .. })
    }

    fn displacement(&self, t: f64) -> Vector<D> {
        let t = t.max(0.0);
        match self {
            Motion::Translating { velocity } => velocity * t,
            Motion::Oscillating { amplitude, frequency } if *frequency != 0.0 => {
                amplitude * ((1.0 - (frequency * t).cos()) / frequency)
            }
            _ => Vector::zeros(),
        }
    }
}

/// From a centre to a place, by the shortest way where the box is known, m.
fn arm<const D: usize>(domain: &Option<Domain<D>>, place: &Vector<D>, centre: &Vector<D>) -> Vector<D> {
    domain.as_ref().map_or_else(|| place - centre, |domain| domain.separation(place, centre))
}

/// A vector of the plane or of space in three components.
fn lift<const D: usize>(x: &Vector<D>) -> [f64; 3] {
    std::array::from_fn(|k| if k < D { x[k] } else { 0.0 })
}

/// The angular velocity that can act in `D` dimensions.
fn effective<const D: usize>(rate: &[f64; 3]) -> [f64; 3] {
    match D {
        1 => [0.0; 3],
        2 => [0.0, 0.0, rate[2]],
        _ => *rate,
    }
}

fn cross<const D: usize>(rate: &[f64; 3], x: &Vector<D>) -> Vector<D> {
    let (w, r) = (effective::<D>(rate), lift(x));
    let c = [w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]];
    Vector::from_fn(|k, _| c[k])
}

/// Rodrigues' rotation of `x` by the angle |rate| t about the direction of `rate`.
fn rotate<const D: usize>(x: &Vector<D>, rate: &[f64; 3], t: f64) -> Vector<D> {
    let w = effective::<D>(rate);
    let speed = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
    if speed == 0.0 {
        return *x;
    }
    let (sin, cos) = (speed * t).sin_cos();
    let axis = [w[0] / speed, w[1] / speed, w[2] / speed];
    let r = lift(x);
    let along = (axis[0] * r[0] + axis[1] * r[1] + axis[2] * r[2]) * (1.0 - cos);
    let turned = cross(&axis, x);
    Vector::from_fn(|k, _| x[k] * cos + turned[k] * sin + axis[k] * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn consistent<const D: usize>(motion: &Motion<D>) {
        let start = Vector::from_fn(|k, _| 0.3 + k as f64);
        let (t, d) = (0.7, 1e-5);
        let now = motion.position(&start, t);
        // Rounding of a handful of operations.
        assert!((motion.origin(&now, t) - start).norm() < 1e-13);
        let slope = (motion.position(&start, t + d) - motion.position(&start, t - d)) / (2.0 * d);
        // Central differences: truncation d² and rounding 1e-16/d, times the rates cubed.
        assert!((slope - motion.velocity(&now, t)).norm() < 1e-7, "{motion:?}");
        let (after, before) = (motion.position(&start, t + d), motion.position(&start, t - d));
        let bend = (motion.velocity(&after, t + d) - motion.velocity(&before, t - d)) / (2.0 * d);
        assert!((bend - motion.acceleration(&now, t)).norm() < 1e-7, "{motion:?}");
    }

    #[test]
    fn position_velocity_and_acceleration_agree() {
        consistent(&Motion::Translating { velocity: Vector::<2>::new(1.0, -2.0) });
        consistent(&Motion::Oscillating { amplitude: Vector::<2>::new(1.0, -2.0), frequency: 3.0 });
        consistent(&Motion::Rotating {
            centre: Vector::<2>::new(0.1, 0.2),
            rate: [9.0, 9.0, 1.5],
            domain: None,
        });
        consistent(&Motion::Rotating {
            centre: Vector::<3>::new(0.1, 0.2, 0.3),
            rate: [0.4, -1.0, 1.5],
            domain: None,
        });
    }
    /// A blade whose tip has crossed a periodic end moves as it would without one.
    #[test]
    fn arms_over_a_periodic_end_are_the_shortest() {
        type V = Vector<2>;
        let (centre, rate) = (V::new(1.0, 5.0), [0.0, 0.0, 1.5]);
        let domain = Domain { min: V::zeros(), max: V::new(10.0, 10.0), periodic: [true, false] };
        let plain = Motion::Rotating { centre, rate, domain: None };
        let motion = Motion::Rotating { centre, rate, domain: Some(domain.clone()) };
        let (start, t) = (V::new(1.2, 7.0), 0.9);
        let (free, here) = (plain.position(&start, t), domain.wrap(&motion.position(&start, t)));
        assert!(free[0] < 0.0 && here[0] > 9.0, "the tip does not cross the end: {free}");
        // Rounding of a handful of operations on numbers of ten.
        assert!((motion.velocity(&here, t) - plain.velocity(&free, t)).norm() < 1e-13);
        assert!((motion.acceleration(&here, t) - plain.acceleration(&free, t)).norm() < 1e-13);
        assert!((motion.origin(&here, t) - start).norm() < 1e-13);
    }
}
