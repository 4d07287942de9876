//! An elastic solid in a flow.
//!
//! The forces of the fluid are the loads of the solid: half a kick at the start of a step of the fluid and half a kick at
//! its end, with the solid's own steps between (impulses of multiple time stepping: Tuckerman, Berne & Martyna 1992). A
//! solid particle gets exactly the opposite of what its fluid contacts get, friction and pressure, so that the momentum
//! of fluid and solid is kept to rounding.
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
use crate::fluid::setup::Surface;
use crate::fluid::wall::{direction, gradient};
use crate::solid::{Elastic, ElasticState};
use crate::space::matrix::{Matrix, inverse};
use crate::space::{Domain, Grid};
use crate::vector::Vector;
use serde::{Deserialize, Serialize};

/// An elastic solid that a fluid moves.
#[derive(Clone)]
pub struct Coupled<const D: usize> {
    solid: Elastic<D>,
    /// The longest step of the solid, s.
    longest: f64,
    /// Acceleration that the pressure at the surface is told, m/s²: the mean over the time sound takes across it.
    pull: Vec<Vector<D>>,
    /// m/s, when the acceleration was last told.
    before: Vec<Vector<D>>,
    /// F⁻¹.
    back: Vec<Matrix<D>>,
    /// The particle at the surface before each particle, and the way from it to the surface at rest, m.
    faces: Option<Vec<(u32, Vector<D>)>>,
    /// Velocity of the surface before each particle, m/s.
    shown: Vec<Vector<D>>,
    held: bool,
}

/// What is kept of a [`Coupled`] solid.
#[derive(Serialize, Deserialize)]
pub(super) struct Kept<'a, const D: usize> {
    solid: ElasticState<'a, D>,
    pull: std::borrow::Cow<'a, [Vector<D>]>,
    before: std::borrow::Cow<'a, [Vector<D>]>,
    held: bool,
}

impl<const D: usize> Coupled<D> {
    /// The motion of a body whose particles are those of `solid`, in the same order and at their places at rest.
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn motion(mut solid: Elastic<D>) -> Result<Motion<D>, RunError> {
        let n = solid.len();
        let longest = solid.step_limit()?;
        let mut coupled = Coupled {
            longest,
            pull: vec![Vector::zeros(); n],
            before: solid.velocities().to_vec(),
            back: (0..n).map(|i| inverse(&solid.gradient(i))).collect(),
            faces: None,
            shown: vec![Vector::zeros(); n],
            held: false,
            solid,
        };
        coupled.tell(0.0, 1.0);
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

    /// Longest step of the solid, s.
    #[must_use]
    pub fn longest(&self) -> f64 {
        self.longest
    }

    /// Velocity of particle `row` of the solid, m/s.
    #[must_use]
    pub fn velocity(&self, row: usize) -> Vector<D> {
        if self.held { Vector::zeros() } else { self.solid.velocities()[row] }
    }

    /// Velocity of the surface before particle `row`, m/s; where that is not known the particle's own.
    #[must_use]
    pub fn velocity_of_surface(&self, row: usize) -> Vector<D> {
        if self.held { Vector::zeros() } else { self.shown[row] }
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

    /// Finds what of the solid is at the surface, from its signed distance at rest (m).
    pub(super) fn find_faces(&mut self, surface: &Surface<D>, domain: &Domain<D>) {
        let places = self.solid.places();
        let reach = 2.0 * (0..places.len()).map(|i| self.edge(i)).fold(0.0, f64::max);
        let grid = Grid::build(places, domain, reach);
        let face = |i: usize| {
            let (here, edge) = (places[i], self.edge(i));
            let distance = |x: &Vector<D>| surface(&domain.wrap(x));
            let depth = -distance(&here);
            let out = direction(&gradient(distance, &here, 1e-4 * edge));
            let there = here + out * depth.max(0.0);
            let mut nearest = (i, here - there, f64::INFINITY);
            grid.for_each_near(&there, places, |j, away, r2| {
                if r2 < nearest.2 {
                    nearest = (j, away, r2);
                }
            });
            let (j, away, least) = nearest;
            // A surface without particles near it is not that of the solid.
            if least.is_finite() { (j as u32, away) } else { (i as u32, Vector::zeros()) }
        };
        self.faces = Some((0..places.len()).map(face).collect());
        self.tell(0.0, 1.0);
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
            self.solid.glide(dt, self.longest)?;
            for (i, back) in self.back.iter_mut().enumerate() {
                *back = inverse(&self.solid.gradient(i));
            }
        }
        Ok(())
    }

    /// What the fluid is to see of the velocities after a step of `dt` (s); `time` (s) is that of the mean of the
    /// acceleration.
    pub(super) fn tell(&mut self, dt: f64, time: f64) {
        let solid = &self.solid;
        match &self.faces {
            // By the outermost particle: a gradient from further down would make more of its noise than there is.
            Some(faces) => {
                for (shown, (face, way)) in self.shown.iter_mut().zip(faces) {
                    let face = *face as usize;
                    *shown = solid.velocities()[face] + solid.rate_of_gradient(face) * way;
                }
            }
            None => self.shown.copy_from_slice(solid.velocities()),
        }
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
        self.held = kept.held;
        for (i, back) in self.back.iter_mut().enumerate() {
            *back = inverse(&self.solid.gradient(i));
        }
        self.tell(0.0, 1.0);
        Some(())
    }
}

impl<const D: usize> std::fmt::Debug for Coupled<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "Coupled {{ particles: {}, longest: {} }}", self.solid.len(), self.longest)
    }
}

impl<const D: usize> PartialEq for Coupled<D> {
    fn eq(&self, other: &Coupled<D>) -> bool {
        self.solid.image() == other.solid.image() && self.solid.places() == other.solid.places()
    }
}
