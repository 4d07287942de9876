//! Rigid bodies that move with the forces of the fluid.
//!
//! M dV/dt = F + M (g + a), dL/dt = T with F and T the exact opposite of what the body does to the fluid, kick - drift -
//! kick like the fluid. In space the body turns by the angular velocity of the middle of the step, found from
//! L = R I Rᵀ ω with a half step ahead; second order, and L is kept to rounding where no torque acts.
//!
//! Friction along the difference of velocities, strength a, has the stress a/2 eta ∇v instead of its symmetric part: the
//! same force on a volume or a body, but on a turning body less torque. The difference depends on the velocity of
//! the surface alone and is exactly -a eta (volume of the body) ω, which is added here (with its thermal noise).

use nalgebra::Matrix3;

use crate::fluid::motion::Motion;
use crate::space::domain::Domain;
use crate::vector::Vector;
use serde::{Deserialize, Serialize};

/// A free body as it is stated: density and state at t = 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Free<const D: usize> {
    /// kg/m³.
    pub density: f64,
    /// Velocity of the centre of mass at t = 0, m/s.
    pub velocity: Vector<D>,
    /// Angular velocity at t = 0, rad/s; in 2D the third component counts.
    pub rate: [f64; 3],
    /// Acceleration besides the body force on all fluid, m/s².
    pub acceleration: Vector<D>,
}

/// A free body in motion. Until it is part of a flow it has no mass and rests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rigid<const D: usize> {
    pub free: Free<D>,
    /// Mass per unit thickness, kg/m^(3-D).
    pub mass: f64,
    /// Moments of inertia about the centre at t = 0, kg m² per unit thickness; in 2D the last entry.
    pub(super) inertia: Matrix3<f64>,
    pub(super) inverse: Matrix3<f64>,
    /// Centre of mass at t = 0, m.
    home: Vector<D>,
    /// Centre of mass, m; not wrapped.
    pub centre: Vector<D>,
    /// From the frame at t = 0 to that of now.
    pub turn: Matrix3<f64>,
    /// m/s.
    pub velocity: Vector<D>,
    /// Angular momentum about the centre, kg m²/s per unit thickness.
    pub spin: nalgebra::Vector3<f64>,
    /// Angular velocity, rad/s.
    pub rate: nalgebra::Vector3<f64>,
    pub(super) force: Vector<D>,
    pub(super) torque: nalgebra::Vector3<f64>,
    /// Acceleration that the pressure at the surface is told, m/s²: the mean over the time sound takes across it.
    pub(super) pull: Vector<D>,
    pub(super) held: bool,
    /// The box, for the shortest way to the centre.
    #[serde(skip)]
    domain: Option<Domain<D>>,
}

impl<const D: usize> Free<D> {
    /// The motion of a body so stated.
    #[must_use]
    pub fn motion(self) -> Motion<D> {
        Motion::Free(Box::new(Rigid {
            free: self,
            mass: 0.0,
            inertia: Matrix3::zeros(),
            inverse: Matrix3::zeros(),
            home: Vector::zeros(),
            centre: Vector::zeros(),
            turn: Matrix3::identity(),
            velocity: Vector::zeros(),
            spin: nalgebra::Vector3::zeros(),
            rate: nalgebra::Vector3::zeros(),
            force: Vector::zeros(),
            torque: nalgebra::Vector3::zeros(),
            pull: Vector::zeros(),
            held: true,
            domain: None,
        }))
    }
}

impl<const D: usize> Rigid<D> {
    /// Takes over a state that was kept.
    pub(super) fn restore(&mut self, kept: Rigid<D>) {
        *self = Rigid { domain: self.domain.take(), ..kept };
    }

    /// Takes mass, centre and inertia from the particles, places (m) and volumes (m^D), each a small cube of its volume.
    pub(super) fn weigh(&mut self, particles: &[(Vector<D>, f64)], domain: &Domain<D>) {
        let Some(&(first, _)) = particles.first() else { return };
        let place = |x: &Vector<D>| first + domain.separation(x, &first);
        let volume: f64 = particles.iter().map(|(_, v)| v).sum();
        self.mass = self.free.density * volume;
        self.home = particles.iter().fold(Vector::zeros(), |sum, (x, v)| sum + place(x) * (v / volume));
        self.inertia = Matrix3::zeros();
        for (x, v) in particles {
            let r = embed(&(place(x) - self.home));
            // Of a cube of edge a about any axis through its centre m a²/6.
            let own = v.powf(2.0 / D as f64) / 6.0;
            let square = Matrix3::identity() * (r.norm_squared() + own) - r * r.transpose();
            self.inertia += square * (self.free.density * v);
        }
        if D < 3 {
            // In the plane bodies turn about z only, on a line not at all.
            let last = self.inertia[(2, 2)];
            self.inertia = Matrix3::identity() * last;
        }
        self.inverse = self.inertia.try_inverse().unwrap_or_else(Matrix3::zeros);
        self.centre = self.home;
        self.domain = Some(domain.clone());
        self.release();
    }

    /// Lets the body go with its velocities of t = 0.
    pub(super) fn release(&mut self) {
        self.held = false;
        self.velocity = self.free.velocity;
        let mut rate = nalgebra::Vector3::from(self.free.rate);
        for (k, rate) in rate.iter_mut().enumerate() {
            if D == 1 || D == 2 && k < 2 {
                *rate = 0.0;
            }
        }
        self.rate = rate;
        self.spin = self.turn * self.inertia * self.turn.transpose() * rate;
    }

    /// Holds the body where it is, at rest.
    pub(super) fn hold(&mut self) {
        self.held = true;
        self.velocity = Vector::zeros();
        self.spin = nalgebra::Vector3::zeros();
        self.rate = nalgebra::Vector3::zeros();
        self.pull = Vector::zeros();
    }

    /// From the centre to a place, by the shortest way, m.
    pub(super) fn arm(&self, place: &Vector<D>) -> Vector<D> {
        match &self.domain {
            Some(domain) => domain.separation(place, &self.centre),
            None => place - self.centre,
        }
    }

    /// Where the particle that was at `start` is now, m.
    #[must_use]
    pub fn position(&self, start: &Vector<D>) -> Vector<D> {
        let arm = match &self.domain {
            Some(domain) => domain.separation(start, &self.home),
            None => start - self.home,
        };
        self.centre + narrow::<D>(&(self.turn * embed(&arm)))
    }

    /// Where the material point now at `place` was at the start, m.
    #[must_use]
    pub fn origin(&self, place: &Vector<D>) -> Vector<D> {
        self.home + narrow::<D>(&(self.turn.transpose() * embed(&self.arm(place))))
    }

    /// Velocity of the material at `place`, m/s.
    #[must_use]
    pub fn velocity_at(&self, place: &Vector<D>) -> Vector<D> {
        self.velocity + narrow::<D>(&self.rate.cross(&embed(&self.arm(place))))
    }

    /// Acceleration of the material at `place` as the pressure at the surface is told it, m/s².
    #[must_use]
    pub fn acceleration_at(&self, place: &Vector<D>) -> Vector<D> {
        let inward = self.rate.cross(&self.rate.cross(&embed(&self.arm(place))));
        self.pull + narrow::<D>(&inward)
    }

    /// V += dt/2 F/M, L += dt/2 T.
    pub(super) fn kick(&mut self, dt: f64) {
        if self.held || self.mass <= 0.0 {
            return;
        }
        self.velocity += self.force * (0.5 * dt / self.mass);
        self.spin += self.torque * (0.5 * dt);
        self.rate = self.rate_of(&self.turn);
    }

    fn rate_of(&self, turn: &Matrix3<f64>) -> nalgebra::Vector3<f64> {
        turn * (self.inverse * (turn.transpose() * self.spin))
    }

    /// X += dt V, and the turn by the angular velocity in the middle of the step.
    pub(super) fn drift(&mut self, dt: f64) {
        if self.held || self.mass <= 0.0 {
            return;
        }
        self.centre += self.velocity * dt;
        let half = rotation(&(self.rate * (0.5 * dt))) * self.turn;
        let middle = self.rate_of(&half);
        self.turn = rotation(&(middle * dt)) * self.turn;
        // Rounding makes a rotation by and by no rotation: one step of Newton's iteration for the nearest one.
        self.turn = self.turn * (Matrix3::identity() * 3.0 - self.turn.transpose() * self.turn) * 0.5;
        self.rate = self.rate_of(&self.turn);
    }
}

/// Rotation by the vector `angle` (rad): Rodrigues.
fn rotation(angle: &nalgebra::Vector3<f64>) -> Matrix3<f64> {
    *nalgebra::Rotation3::new(*angle).matrix()
}

pub(super) fn embed<const D: usize>(x: &Vector<D>) -> nalgebra::Vector3<f64> {
    nalgebra::Vector3::from_fn(|k, _| if k < D { x[k] } else { 0.0 })
}

fn narrow<const D: usize>(x: &nalgebra::Vector3<f64>) -> Vector<D> {
    Vector::from_fn(|k, _| x[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of edges 3, 2, 1 that tumbles without torque: L stays, the energy stays to second order of the step.
    #[test]
    fn a_free_body_tumbles_with_its_momentum() {
        let energy_after = |dt: f64| {
            let domain = Domain {
                min: Vector::<3>::zeros(),
                max: Vector::<3>::new(9.0, 9.0, 9.0),
                periodic: [true; 3],
            };
            let free = Free {
                density: 2.0,
                velocity: Vector::<3>::new(1.0, 0.0, 0.0),
                rate: [0.1, 1.0, 0.1],
                acceleration: Vector::<3>::zeros(),
            };
            let Motion::Free(mut rigid) = free.motion() else { unreachable!() };
            let mut particles = Vec::new();
            for code in 0..6 {
                let (x, y) = (f64::from(code % 3), f64::from(code / 3));
                // Across the wrap of x.
                particles.push((domain.wrap(&Vector::<3>::new(7.5 + x, 3.0 + y, 4.0)), 1.0));
            }
            rigid.weigh(&particles, &domain);
            // Of a box m (b² + c²)/12, exactly.
            assert!((rigid.inertia[(0, 0)] - 12.0 * 5.0 / 12.0).abs() < 1e-12);
            assert!((rigid.inertia[(2, 2)] - 12.0 * 13.0 / 12.0).abs() < 1e-12);
            let (spin, energy) = (rigid.spin, rigid.spin.dot(&rigid.rate));
            for _ in 0..(20.0 / dt) as u64 {
                rigid.kick(dt);
                rigid.drift(dt);
                rigid.kick(dt);
            }
            assert_eq!(spin, rigid.spin);
            assert!((rigid.turn.transpose() * rigid.turn - Matrix3::identity()).norm() < 1e-13);
            let place = rigid.position(&particles[4].0);
            assert!((domain.separation(&rigid.origin(&place), &particles[4].0)).norm() < 1e-12);
            (rigid.spin.dot(&rigid.rate) / energy - 1.0).abs()
        };
        let (coarse, fine) = (energy_after(0.02), energy_after(0.01));
        // Second order: a fourth, and a fifth at least as the error oscillates.
        assert!(coarse < 1e-3 && fine < 0.35 * coarse, "{coarse} {fine}");
    }
}
