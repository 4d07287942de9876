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

use crate::error::RunError;
use crate::fluid::domain::Domain;
use crate::fluid::flow::Flow;
use crate::fluid::motion::Motion;
use crate::fluid::pass::Pair;
use crate::fluid::setup::{Body, BodyKind, Slip};
use crate::vector::Vector;

/// How many times a wall shows its velocity to the fluid: once at the surface, and up to twice more continued behind it.
const SHOWN: f64 = 3.0;

/// A free body as it is stated: density and state at t = 0.
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
pub struct Rigid<const D: usize> {
    pub free: Free<D>,
    /// Mass per unit thickness, kg/m^(3-D).
    pub mass: f64,
    /// Moments of inertia about the centre at t = 0, kg m² per unit thickness; in 2D the last entry.
    inertia: Matrix3<f64>,
    inverse: Matrix3<f64>,
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
    force: Vector<D>,
    torque: nalgebra::Vector3<f64>,
    /// Acceleration that the pressure at the surface is told, m/s²: the mean over the time sound takes across it.
    pull: Vector<D>,
    held: bool,
    /// The box, for the shortest way to the centre.
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
    /// Takes mass, centre and inertia from the particles, places (m) and volumes (m^D), each a small cube of its volume.
    fn weigh(&mut self, particles: &[(Vector<D>, f64)], domain: &Domain<D>) {
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
    fn release(&mut self) {
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
    fn hold(&mut self) {
        self.held = true;
        self.velocity = Vector::zeros();
        self.spin = nalgebra::Vector3::zeros();
        self.rate = nalgebra::Vector3::zeros();
        self.pull = Vector::zeros();
    }

    /// From the centre to a place, by the shortest way, m.
    fn arm(&self, place: &Vector<D>) -> Vector<D> {
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
    fn kick(&mut self, dt: f64) {
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
    fn drift(&mut self, dt: f64) {
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

    /// |V| + |ω| r of a point at distance `reach` (m), m/s.
    #[must_use]
    pub fn speed(&self, reach: f64) -> f64 {
        self.velocity.norm() + self.rate.norm() * reach
    }
}

/// Rotation by the vector `angle` (rad): Rodrigues.
fn rotation(angle: &nalgebra::Vector3<f64>) -> Matrix3<f64> {
    *nalgebra::Rotation3::new(*angle).matrix()
}

fn embed<const D: usize>(x: &Vector<D>) -> nalgebra::Vector3<f64> {
    nalgebra::Vector3::from_fn(|k, _| if k < D { x[k] } else { 0.0 })
}

fn narrow<const D: usize>(x: &nalgebra::Vector3<f64>) -> Vector<D> {
    Vector::from_fn(|k, _| x[k])
}

/// How a free body moves now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState<const D: usize> {
    pub body: u8,
    /// Centre of mass, m; not wrapped round periodic axes.
    pub centre: Vector<D>,
    /// m/s.
    pub velocity: Vector<D>,
    /// rad/s.
    pub rate: [f64; 3],
    /// Momentum per unit thickness, kg m/s times m^(D-3).
    pub momentum: Vector<D>,
    /// Angular momentum about the centre, per unit thickness.
    pub spin: [f64; 3],
    /// Force of the fluid per unit thickness and the body's weight, N times m^(D-3).
    pub force: Vector<D>,
}

impl<const D: usize> Flow<D> {
    /// The free bodies, in the order of the setup.
    pub fn free_bodies(&self) -> impl Iterator<Item = BodyState<D>> + '_ {
        self.bodies.iter().zip(0_u8..).filter_map(|(body, number)| {
            let BodyKind::Solid { motion: Motion::Free(rigid), .. } = &body.kind else { return None };
            Some(BodyState {
                body: number,
                centre: rigid.centre,
                velocity: rigid.velocity,
                rate: rigid.rate.into(),
                momentum: rigid.velocity * rigid.mass,
                spin: rigid.spin.into(),
                force: rigid.force,
            })
        })
    }

    fn each_free(&mut self, mut act: impl FnMut(&mut Rigid<D>)) {
        for body in &mut self.bodies {
            if let BodyKind::Solid { motion: Motion::Free(rigid), .. } = &mut body.kind {
                act(rigid);
            }
        }
    }

    /// Mass and inertia of the free bodies from their particles.
    pub(super) fn weigh_bodies(&mut self) {
        for number in 0..self.bodies.len() {
            let own: Vec<(Vector<D>, f64)> = self
                .sides
                .iter()
                .zip(&self.own)
                .filter(|(side, _)| usize::from(side.body) == number)
                .map(|(side, own)| (own.start, side.volume))
                .collect();
            if let BodyKind::Solid { motion: Motion::Free(rigid), .. } = &mut self.bodies[number].kind {
                rigid.weigh(&own, &self.domain);
                self.asks[number] = true;
            }
        }
    }

    /// Free bodies rest where they are.
    pub(super) fn hold_bodies(&mut self) {
        self.each_free(Rigid::hold);
    }

    /// Free bodies begin to move.
    pub(super) fn release_bodies(&mut self) {
        self.each_free(Rigid::release);
    }

    /// The first half kick and the drift of the free bodies.
    pub(super) fn kick_and_drift_bodies(&mut self, dt: f64) {
        self.each_free(|rigid| {
            rigid.kick(dt);
            rigid.drift(dt);
        });
    }

    /// Force and torque on the free bodies from the reactions just summed.
    pub(super) fn load_bodies(&mut self, dt: f64) {
        if !self.bodies.iter().any(|body| body.is_free()) {
            return;
        }
        let gravity = self.setup.gravity;
        let mut loads = vec![(Vector::<D>::zeros(), nalgebra::Vector3::zeros()); self.bodies.len()];
        for &i in &self.solids {
            let (side, rates) = (&self.sides[i as usize], &self.rates[i as usize]);
            let number = usize::from(side.body);
            let BodyKind::Solid { motion: Motion::Free(rigid), .. } = &self.bodies[number].kind else {
                continue;
            };
            let force = rates.force * side.volume;
            loads[number].0 += force;
            loads[number].1 += embed(&rigid.arm(&self.positions[i as usize])).cross(&embed(&force));
        }
        // Told at once the pressure would answer to the acceleration it makes itself, and a light body would shake.
        // Noise must not be answered at all.
        let (quiet, h) = (self.terms.noise.is_none(), self.kernel.cutoff());
        let (sound, a, viscosity) = (self.sound_speed, self.terms.viscosity.a::<D>(), self.setup.viscosity);
        for ((body, (force, torque)), number) in self.bodies.iter_mut().zip(loads).zip(0_u8..) {
            if let BodyKind::Solid { motion: Motion::Free(rigid), slip, .. } = &mut body.kind {
                rigid.force = force + (gravity + rigid.free.acceleration) * rigid.mass;
                rigid.torque = torque;
                if *slip == Slip::NoSlip && D > 1 {
                    let rub = viscosity * rigid.mass / rigid.free.density;
                    rigid.torque -= rigid.rate * (a * rub);
                    if let Some(noise) = &self.terms.noise {
                        let kick = noise.torque(number, rub);
                        rigid.torque +=
                            nalgebra::Vector3::from_fn(|k, _| if D == 3 || k == 2 { kick[k] } else { 0.0 });
                    }
                }
                if quiet && !rigid.held && rigid.mass > 0.0 {
                    let time = h / sound * (self.setup.rest_density / rigid.free.density).max(1.0);
                    let share = -(-dt / time).exp_m1();
                    rigid.pull += (rigid.force / rigid.mass - rigid.pull) * share;
                }
            }
        }
    }

    /// The fastest rate at which friction takes velocity or spin from a free body, 1/s; with the fluid at rest, to which
    /// the body shows its velocity [`SHOWN`] times. Zero without one.
    pub(super) fn friction_rate_of_bodies(&self) -> f64 {
        if !self.bodies.iter().any(Body::is_free) {
            return 0.0;
        }
        let (a, makeup) = (self.terms.viscosity.a::<D>(), self.terms.makeup());
        let mut sums = vec![(0.0, 0.0); self.bodies.len()];
        for block in &self.blocks {
            for (row, near) in block.near_solid.iter().enumerate() {
                let side = &self.sides[block.first + row];
                if !near || side.is_solid() {
                    continue;
                }
                for c in block.row(row) {
                    let solid = &self.sides[c.j as usize];
                    let number = usize::from(solid.body);
                    let BodyKind::Solid { motion: Motion::Free(rigid), .. } = &self.bodies[number].kind
                    else {
                        continue;
                    };
                    let pair = Pair { x: c.x, f: c.weight, f_shift: c.f_shift };
                    let rub = SHOWN
                        * a
                        * self.terms.rub::<true>(makeup, &pair, side, solid)
                        * side.volume
                        * solid.volume;
                    sums[number].0 += rub;
                    sums[number].1 += rub * rigid.arm(&self.positions[c.j as usize]).norm_squared();
                }
            }
        }
        let rate = |(body, (push, turn)): (&Body<D>, (f64, f64))| match &body.kind {
            BodyKind::Solid { motion: Motion::Free(rigid), .. } if rigid.mass > 0.0 => {
                let own = a * self.setup.viscosity * rigid.mass / rigid.free.density;
                (push / rigid.mass).max((turn + own) * rigid.inverse.norm())
            }
            _ => 0.0,
        };
        self.bodies.iter().zip(sums).map(rate).fold(0.0, f64::max)
    }

    /// The second half kick of the free bodies.
    pub(super) fn kick_bodies(&mut self, dt: f64) {
        self.each_free(|rigid| rigid.kick(dt));
    }

    /// A free body must not run into a wall of the box or another solid: nothing would keep it out.
    pub(super) fn check_bodies(&self) -> Result<(), RunError> {
        for &i in &self.solids {
            let (side, here) = (&self.sides[i as usize], &self.positions[i as usize]);
            let body = &self.bodies[usize::from(side.body)];
            if !body.is_free() {
                continue;
            }
            let beyond = (0..D).find(|&k| {
                !self.domain.periodic[k] && (here[k] < self.domain.min[k] || here[k] > self.domain.max[k])
            });
            if let Some(k) = beyond {
                let what = format!(
                    "{} (m) of the body `{}`, at the end of the box,",
                    ["x", "y", "z"][k.min(2)],
                    body.name
                );
                return Err(self.collision(i, what, here[k]));
            }
            for (other, number) in self.bodies.iter().zip(0_u8..) {
                let BodyKind::Solid { motion, surface: Some(surface), .. } = &other.kind else { continue };
                if number == side.body {
                    continue;
                }
                let place = self.domain.wrap(&motion.origin(&self.domain.wrap(here), self.time));
                let distance = surface(&place);
                if distance < 0.0 {
                    let what = format!("distance (m) of the body `{}` from `{}`", body.name, other.name);
                    return Err(self.collision(i, what, distance));
                }
            }
        }
        Ok(())
    }

    fn collision(&self, i: u32, quantity: String, value: f64) -> RunError {
        RunError::BlowUp {
            step: self.steps,
            time: self.time,
            particle: self.own[i as usize].id as usize,
            quantity,
            value,
            remedy:
                "bodies that touch have no law of contact here: end the run before, or begin further away"
                    .to_owned(),
        }
    }
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
