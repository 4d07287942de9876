//! An elastic solid in a flow.
//!
//! The forces of the fluid are the loads of the solid: half a kick at the start of a step of the fluid and half a kick at
//! its end, with the solid's own steps between (impulses of multiple time stepping: Tuckerman, Berne & Martyna 1992). A
//! solid particle gets exactly the opposite of what its fluid contacts get, friction and pressure, so that the momentum
//! of fluid and solid is kept to rounding.
//!
//! Each solid particle shows the fluid its own velocity, not one continued to the surface: a force that goes with the
//! velocity of another particle than it acts on does not always damp, and fed thickness modes until the solid shook.
//!
//! A place x near solid particle n is that of the undeformed solid at
//!
//! ```text
//! X = X_n + F_n⁻¹ (x - x_n)
//! ```
//!
//! where the signed distance d of the surface is known: x is inside where d(X) < 0, by -d/|F⁻ᵀ ∇d|, along F⁻ᵀ ∇d.

use crate::error::RunError;
use crate::fluid::motion::Motion;
use crate::solid::{Elastic, ElasticState, StepLimit};
use crate::space::matrix::{Matrix, inverse};
use crate::vector::Vector;
use serde::{Deserialize, Serialize};

/// An elastic solid that a fluid moves.
#[derive(Clone)]
pub struct Coupled<const D: usize> {
    solid: Elastic<D>,
    /// The longest step of the solid.
    limit: StepLimit,
    /// Acceleration that the pressure at the surface is told, m/s²: the mean over the time sound takes across it.
    pull: Vec<Vector<D>>,
    /// m/s, when the acceleration was last told.
    before: Vec<Vector<D>>,
    /// F⁻¹.
    back: Vec<Matrix<D>>,
    /// Steps of the solid until the longest one is found again.
    left: u64,
    /// The largest stretch so far.
    stretch: f64,
    held: bool,
}

/// Steps of a solid after which the longest stable one is found again: what is stretched swings faster.
const RENEWED: u64 = 2000;

/// What is kept of a [`Coupled`] solid.
#[derive(Serialize, Deserialize)]
pub(super) struct Kept<'a, const D: usize> {
    solid: ElasticState<'a, D>,
    pull: std::borrow::Cow<'a, [Vector<D>]>,
    before: std::borrow::Cow<'a, [Vector<D>]>,
    longest: f64,
    left: u64,
    stretch: f64,
    held: bool,
}

impl<const D: usize> Coupled<D> {
    /// The motion of a body whose particles are those of `solid`, in the same order and at their places at rest.
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn motion(mut solid: Elastic<D>) -> Result<Motion<D>, RunError> {
        let n = solid.len();
        let limit = solid.limit()?;
        let coupled = Coupled {
            limit,
            pull: vec![Vector::zeros(); n],
            before: solid.velocities().to_vec(),
            back: (0..n).map(|i| inverse(&solid.gradient(i))).collect(),
            left: RENEWED,
            stretch: 1.0,
            held: false,
            solid,
        };
        Ok(Motion::Elastic(Box::new(coupled)))
    }

    /// The solid.
    #[must_use]
    pub fn solid(&self) -> &Elastic<D> {
        &self.solid
    }

    /// The solid, to be softened or grown; what its particles are bound to must not change.
    pub fn solid_mut(&mut self) -> &mut Elastic<D> {
        &mut self.solid
    }

    /// Longest step of the solid, and what limits it.
    #[must_use]
    pub fn limit(&self) -> &StepLimit {
        &self.limit
    }

    /// The largest stretch of a particle so far.
    #[must_use]
    pub fn largest_stretch(&self) -> f64 {
        self.stretch
    }

    /// Velocity of particle `row` of the solid, m/s.
    #[must_use]
    pub fn velocity(&self, row: usize) -> Vector<D> {
        if self.held { Vector::zeros() } else { self.solid.velocities()[row] }
    }

    /// Acceleration of particle `row` as the pressure at the surface is told it, m/s².
    #[must_use]
    pub fn acceleration(&self, row: usize) -> Vector<D> {
        self.pull[row]
    }

    /// Where the material at a distance `away` (m) from particle `row` is in the undeformed solid, m.
    #[must_use]
    pub fn origin_beside(&self, row: usize, away: &Vector<D>) -> Vector<D> {
        self.solid.places()[row] + self.back[row] * away
    }

    /// F⁻ᵀ of a covector of the undeformed solid at particle `row`.
    #[must_use]
    pub fn push_forward(&self, row: usize, covector: &Vector<D>) -> Vector<D> {
        self.back[row].tr_mul(covector)
    }

    /// Volume of the solid less that at rest, m^D.
    pub(super) fn swelling(&self) -> f64 {
        (0..self.solid.len()).map(|i| self.solid.volume(i) - self.solid.volumes()[i]).sum()
    }

    /// The edge of the cube particle `row` filled at rest, m.
    #[must_use]
    pub fn edge(&self, row: usize) -> f64 {
        self.solid.volumes()[row].powf(1.0 / D as f64)
    }

    /// The particle whose place at rest (if `at_rest`) or of now is nearest to a place (m). Asks all of them.
    pub(super) fn nearest(&self, place: &Vector<D>, at_rest: bool) -> usize {
        let away = |i: usize| {
            let there = if at_rest { self.solid.places()[i] } else { self.solid.position(i) };
            (place - there).norm_squared()
        };
        let nearer = |(best, least): (usize, f64), i: usize| {
            let distance = away(i);
            if distance < least { (i, distance) } else { (best, least) }
        };
        (0..self.solid.len()).fold((0, f64::INFINITY), nearer).0
    }

    /// Holds the solid where it is, at rest.
    pub(super) fn hold(&mut self) {
        self.held = true;
        self.pull.fill(Vector::zeros());
    }

    /// Lets the solid go.
    pub(super) fn release(&mut self) {
        self.held = false;
        self.before.copy_from_slice(self.solid.velocities());
    }

    /// v += dt/2 (load/m).
    pub(super) fn kick(&mut self, dt: f64) {
        if !self.held {
            self.solid.kick_by_loads(0.5 * dt);
        }
    }

    /// The solid's own motion over `dt` (s).
    pub(super) fn drift(&mut self, dt: f64) -> Result<(), RunError> {
        if !self.held {
            let before = self.solid.tally().particle_steps;
            self.solid.glide(dt, self.limit.seconds)?;
            let steps = (self.solid.tally().particle_steps - before) / self.solid.len().max(1) as u64;
            self.left = self.left.saturating_sub(steps);
            if self.left == 0 {
                (self.limit, self.left) = (self.solid.limit()?, RENEWED);
            }
            for (i, back) in self.back.iter_mut().enumerate() {
                *back = inverse(&self.solid.gradient(i));
                self.stretch = self.stretch.max(self.solid.stretch(i));
            }
        }
        Ok(())
    }

    /// What the fluid is to see of the velocities after a step of `dt` (s); `time` (s) is that of the mean of the
    /// acceleration.
    pub(super) fn tell(&mut self, dt: f64, time: f64) {
        if self.held || dt <= 0.0 {
            return;
        }
        let share = -(-dt / time).exp_m1();
        let now = self.solid.velocities();
        for ((pull, before), now) in self.pull.iter_mut().zip(&mut self.before).zip(now) {
            *pull += ((now - *before) / dt - *pull) * share;
            *before = *now;
        }
    }

    pub(super) fn image(&self) -> Kept<'_, D> {
        Kept {
            solid: self.solid.image(),
            pull: (&self.pull[..]).into(),
            before: (&self.before[..]).into(),
            longest: self.limit.seconds,
            left: self.left,
            stretch: self.stretch,
            held: self.held,
        }
    }

    pub(super) fn restore(&mut self, kept: Kept<D>) -> Option<()> {
        let n = self.solid.len();
        if kept.pull.len() != n || kept.before.len() != n {
            return None;
        }
        self.solid.restore(kept.solid)?;
        (self.pull, self.before) = (kept.pull.into_owned(), kept.before.into_owned());
        (self.limit.seconds, self.left) = (kept.longest, kept.left);
        (self.stretch, self.held) = (kept.stretch, kept.held);
        for (i, back) in self.back.iter_mut().enumerate() {
            *back = inverse(&self.solid.gradient(i));
        }
        Some(())
    }
}

impl<const D: usize> std::fmt::Debug for Coupled<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "Coupled {{ particles: {}, longest: {} }}", self.solid.len(), self.limit.seconds)
    }
}

impl<const D: usize> PartialEq for Coupled<D> {
    fn eq(&self, other: &Coupled<D>) -> bool {
        self.solid.image() == other.solid.image() && self.solid.places() == other.solid.places()
    }
}
