//! A closed wall under turgor that follows its softness, grows and gets new columns: always in equilibrium.

use serde::{Deserialize, Serialize};

use crate::error::RunError;
use crate::solid::bonds::Bonds;
use crate::solid::elastic::{Elastic, Setup};
use crate::solid::growth::{Rates, lockhart};
use crate::solid::insert::{Birth, Present};
use crate::solid::outline::Outline;
use crate::solid::relax::{Relaxation, Relaxed};
use crate::solid::shell::Wall;
use crate::solid::surface::volume;
use crate::solid::turgor::{Inside, Turgor};
use crate::space::matrix::{Matrix, embed};
use crate::space::{Domain, Kernel, KernelKind};
use crate::vector::Vector;

/// Numbers of Lockhart's law and of what follows from growth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Growth {
    /// Stress below which nothing grows, Pa.
    pub yields: f64,
    /// Distance of two columns over the longest at the start, beyond which one is put between them.
    pub insert_at: f64,
    /// Columns that may come.
    pub reserve: usize,
}

/// Growth of any particle in one step at most; longer steps are divided.
const MOST: f64 = 0.02;
/// Most steps of growth in what is left of one chemistry step.
const RASH: f64 = 2000.0;
/// Edges that long, in edges at the start, are gaps.
const GAP: f64 = 2.0;
/// Negative turgor that is rounding, over pressure and stiffness.
const SUCTION: f64 = 1e-6;

/// What must be kept of a vessel to go on with it later, to the bit; what follows from it is left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VesselState<const D: usize> {
    wall: Wall<D>,
    places: Vec<Vector<D>>,
    volumes: Vec<f64>,
    displacements: Vec<Vector<D>>,
    /// From which others rise where they must do so slowly.
    loads: Vec<Vector<D>>,
    growth: Option<Vec<Matrix<D>>>,
    softness: Vec<f64>,
    before: Vec<Matrix<D>>,
    delivered: f64,
    step: f64,
    inside: Inside,
    last: Relaxed,
    time: f64,
    tally: crate::solid::elastic::Tally,
}

/// A closed wall in equilibrium with the turgor of what it encloses.
pub struct Vessel<const D: usize> {
    pub solid: Elastic<D>,
    pub wall: Wall<D>,
    turgor: Turgor,
    growth: Option<Growth>,
    relaxation: Relaxation,
    kernel: KernelKind,
    support: f64,
    domain: Domain<D>,
    /// At the start: volume inside (m^D), longest edges of the inner surface, middle and outer surface (m), mass (kg per
    /// unit thickness), columns.
    start: (f64, [f64; 3], f64, usize),
    /// Deformation before the present state of rest.
    before: Vec<Matrix<D>>,
    delivered: f64,
    step: f64,
    inside: Inside,
    last: Relaxed,
    time: f64,
}

impl<const D: usize> Vessel<D> {
    /// A wall as it is built, without load; [`Vessel::relax`] puts it under turgor.
    ///
    /// # Errors
    /// As [`Elastic::new`].
    pub fn new(
        setup: Setup<D>,
        wall: Wall<D>,
        turgor: Turgor,
        growth: Option<Growth>,
        relaxation: Relaxation,
    ) -> Result<Vessel<D>, RunError> {
        let (kernel, support, domain) = (setup.kernel, setup.cutoff, setup.domain.clone());
        let mut solid = Elastic::new(setup)?;
        solid.consist(&wall.skin(&solid.places, &solid.volumes));
        let inside = volume(&wall.inner(|i| solid.position(i)), &wall.faces);
        let edge = wall.longest_edges(|i| solid.position(i));
        let mass = (0..solid.len()).map(|i| solid.mass(i)).sum();
        Ok(Vessel {
            start: (inside, edge, mass, wall.columns),
            before: vec![Matrix::identity(); solid.len()],
            solid,
            wall,
            turgor,
            growth,
            relaxation,
            kernel,
            support,
            domain,
            delivered: 0.0,
            step: 0.0,
            inside: Inside { volume: inside, pressure: 0.0 },
            last: Relaxed::default(),
            time: 0.0,
        })
    }

    /// The state as it is now.
    #[must_use]
    pub fn image(&self) -> VesselState<D> {
        let solid = &self.solid;
        VesselState {
            wall: self.wall.clone(),
            places: solid.places.clone(),
            volumes: solid.volumes.clone(),
            displacements: solid.displacements.clone(),
            loads: solid.loads.clone(),
            growth: solid.growth.clone(),
            softness: solid.softness.clone(),
            before: self.before.clone(),
            delivered: self.delivered,
            step: self.step,
            inside: self.inside,
            last: self.last,
            time: self.time,
            tally: solid.tally.clone(),
        }
    }

    /// Puts a vessel of the same setup into a state; `None` if the state belongs to another.
    #[must_use]
    pub fn restore(&mut self, state: VesselState<D>) -> Option<()> {
        let n = state.places.len();
        let fits = state.wall.columns * state.wall.layers == n
            && state.wall.columns >= self.start.3
            && [state.volumes.len(), state.displacements.len(), state.softness.len(), state.before.len()]
                == [n; 4]
            && state.loads.len() == n
            && state.growth.as_ref().is_none_or(|growth| growth.len() == n);
        if !fits {
            return None;
        }
        self.wall = state.wall;
        let skin = self.wall.skin(&state.places, &state.volumes);
        let bonds = self.bonds(&state.places, &state.volumes).ok()?;
        self.solid.begin_at(state.places, state.volumes, bonds);
        self.solid.growth = state.growth;
        self.solid.softness = state.softness;
        self.solid.consist(&skin);
        self.solid.displacements = state.displacements;
        self.solid.loads = state.loads;
        self.solid.renew().ok()?;
        self.solid.time = state.time;
        self.solid.tally = state.tally;
        (self.before, self.delivered, self.step) = (state.before, state.delivered, state.step);
        (self.inside, self.last, self.time) = (state.inside, state.last, state.time);
        Some(())
    }

    /// From one equilibrium to the next, `dt` (s) later: with the softness of now the wall relaxes, grows (particle i at
    /// φ = `phi[i]`, 1/(Pa s)) and gets new columns, step of growth by step of growth; who gave what to whom, in order. A new
    /// particle grows at the mean φ of its donors.
    ///
    /// # Errors
    /// As [`Vessel::relax`] and [`Vessel::insert`].
    pub fn advance(&mut self, dt: f64, phi: &[f64]) -> Result<Vec<Birth>, RunError> {
        let end = self.time + dt;
        let mut births = Vec::new();
        self.solid.renew()?;
        if self.growth.is_some() && phi.iter().any(|&phi| phi > 0.0) {
            self.relax(self.time)?;
            let (mut phi, mut left) = (phi.to_vec(), dt);
            while left > 1e-9 * dt {
                left -= self.grow(left, &phi)?;
                let new = self.insert()?;
                // Both ends of the edge gave as much matter, so it holds the mean of what they hold. They may be new themselves.
                for birth in &new {
                    let [a, b] = birth.donors;
                    phi.push(0.5 * (phi[a.0] + phi[b.0]));
                }
                births.extend(new);
            }
        }
        self.relax(end)?;
        births.extend(self.insert()?);
        Ok(births)
    }

    /// Brings the wall to equilibrium with the turgor of time `t` (s).
    ///
    /// # Errors
    /// As [`Elastic::relax`].
    pub fn relax(&mut self, t: f64) -> Result<Relaxed, RunError> {
        let (wall, turgor, start) = (&self.wall, &self.turgor, self.start.0);
        let inside = &mut self.inside;
        self.time = t;
        self.solid.time = t;
        let slowest = self.last.period;
        self.last = self.solid.relax(&self.relaxation, &mut self.step, |solid| {
            *inside = turgor.load(solid, wall, t, start);
        })?;
        // What took less time than the slowest mode known says nothing of that one.
        if self.last.lasted < slowest {
            self.last.period = self.last.period.max(slowest);
        }
        if self.inside.pressure < -SUCTION * (turgor.pressure + turgor.stiffness) {
            return Err(self.sucks());
        }
        Ok(self.last)
    }

    /// The turgor has fallen below zero.
    fn sucks(&self) -> RunError {
        let at = self.solid.position(0);
        let place: Vec<String> = at.iter().map(|x| format!("{x:.4e}")).collect();
        RunError::BlowUp {
            step: 0,
            time: self.time,
            particle: 0,
            quantity: format!(
                "the wall at ({}) m holds more than its liquid fills, {:.4} times the volume at the start: pressure inside in Pa",
                place.join(", "),
                self.inside.volume / self.start.0
            ),
            value: self.inside.pressure,
            remedy: "a turgor is no suction: less turgor.stiffness (0: water follows) or growth, or more turgor.pressure".into(),
        }
    }

    /// Grows from the present equilibrium to the next, particle i at φ = `phi[i]` (1/(Pa s)), in one midpoint step that is
    /// small, of at most `most` (s); how long it was, s.
    ///
    /// # Errors
    /// As [`Vessel::relax`].
    pub fn grow(&mut self, most: f64, phi: &[f64]) -> Result<f64, RunError> {
        let Some(growth) = self.growth else { return Ok(most) };
        let rates = self.rates(&growth, phi);
        let fastest = rates.iter().map(Rates::sum).fold(0.0, f64::max);
        if fastest == 0.0 {
            self.time += most;
            return Ok(most);
        }
        // Growth relaxes differences of stress at the rate φ E/(1 - ν²): explicit steps must follow that.
        let parts = (most * (fastest / MOST).max(self.maxwell(&rates, phi))).ceil().max(1.0);
        if parts > RASH {
            let quickest = |i: &usize| rates[*i].sum() / MOST;
            let particle = (0..rates.len()).max_by(|a, b| quickest(a).total_cmp(&quickest(b))).unwrap_or(0);
            return Err(RunError::BlowUp {
                step: 0,
                time: self.time,
                particle,
                quantity: "steps of growth that follow the stress of the wall for one chemistry step".into(),
                value: parts,
                remedy: format!(
                    "growth this fast is no growth of a wall: look at the unit of growth.rate, or make chemistry.step {:.1e} of what it is",
                    RASH / parts
                ),
            });
        }
        let (step, t) = (most / parts, self.time);
        let before = self.solid.growth.clone();
        self.solid.grow(&rates, 0.5 * step);
        self.solid.strain()?;
        self.solid.pull();
        self.relax(t + 0.5 * step)?;
        let rates = self.rates(&growth, phi);
        self.solid.growth = before;
        self.solid.strain()?;
        self.delivered += self.solid.grow(&rates, step);
        self.solid.strain()?;
        self.solid.pull();
        self.relax(t + step)?;
        Ok(step)
    }

    /// Rate at which growth relaxes stress, where it is fastest, 1/s.
    fn maxwell(&self, rates: &[Rates<D>], phi: &[f64]) -> f64 {
        let nu = self.solid.material.poisson();
        let stiffness = self.solid.material.young() / (1.0 - nu * nu);
        let grows = rates.iter().zip(phi).filter(|one| one.0.sum() > 0.0);
        grows.map(|one| one.1).fold(0.0, |most: f64, phi| most.max(*phi)) * stiffness
    }

    fn rates(&self, growth: &Growth, phi: &[f64]) -> Vec<Rates<D>> {
        let normals = self.wall.normals(&self.solid);
        // The stress of the particle itself, not the recovered one: what grows gives way to its own stress, so energy is
        // only lost and nothing can build up from particle to particle.
        let one = |i| lockhart(&self.solid.stress(i), &normals[i / self.wall.layers], phi[i], growth.yields);
        (0..self.solid.len()).map(one).collect()
    }

    /// Puts new columns where the wall is stretched too far, and relaxes again; returns who gave what to whom, in order.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] when the reserve is used up; as [`Vessel::relax`].
    pub fn insert(&mut self) -> Result<Vec<Birth>, RunError> {
        let Some(growth) = self.growth else { return Ok(Vec::new()) };
        let at = |i| self.solid.position(i);
        if self.wall.stretched(at, &self.start.1).all(|(_, stretch)| stretch <= growth.insert_at) {
            return Ok(Vec::new());
        }
        let mut present = Present::new(&self.solid, &self.before);
        let capacity = self.start.3 + growth.reserve;
        let density = self.solid.material.density;
        let births = present.refine(
            &mut self.wall,
            (growth.insert_at, &self.start.1),
            capacity,
            density,
            self.time,
        )?;
        let bonds = self.bonds(&present.places, &present.volumes)?;
        self.before = std::mem::take(&mut present.gradients);
        let skin = self.wall.skin(&present.places, &present.volumes);
        self.solid.begin_again(present, bonds, &skin)?;
        self.step = 0.0;
        self.relax(self.time)?;
        Ok(births)
    }

    /// Bonds whose reach follows the longest edge of each column.
    fn bonds(&self, places: &[Vector<D>], volumes: &[f64]) -> Result<Bonds<D>, RunError> {
        let mut wide = vec![1.0_f64; self.wall.columns];
        for (edge, stretch) in self.wall.stretched(|i| places[i], &self.start.1) {
            for end in edge {
                wide[end as usize] = wide[end as usize].max(stretch);
            }
        }
        let widest = wide.iter().copied().fold(1.0, f64::max) * self.support;
        let layers = self.wall.layers;
        Bonds::each(places, volumes, &self.domain, widest, |i, j| {
            Kernel::new(self.kernel, 0.5 * self.support * (wide[i / layers] + wide[j / layers]))
        })
    }

    /// Turgor and volume inside.
    #[must_use]
    pub fn inside(&self) -> Inside {
        self.inside
    }

    /// Time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// How the last relaxation went.
    #[must_use]
    pub fn last(&self) -> Relaxed {
        self.last
    }

    /// Mass now less that at the start less what was delivered, over that at the start.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        (self.mass() - self.start.2 - self.delivered) / self.start.2
    }

    /// Mass of the wall, kg per unit thickness.
    #[must_use]
    pub fn mass(&self) -> f64 {
        (0..self.solid.len()).map(|i| self.solid.grown_mass(i)).sum()
    }

    /// Stretch of particle `i` from the very first state of rest, the largest of all directions.
    #[must_use]
    pub fn stretch(&self, i: usize) -> f64 {
        let f = self.solid.gradient(i) * self.before[i];
        embed(&(f.transpose() * f), 0.0).symmetric_eigenvalues().max().max(0.0).sqrt()
    }

    /// The largest stretch of all particles.
    #[must_use]
    pub fn largest_stretch(&self) -> f64 {
        (0..self.solid.len()).map(|i| self.stretch(i)).fold(0.0, f64::max)
    }

    /// The least distance of the inner from the outer surface, column by column, m.
    #[must_use]
    pub fn thinnest(&self) -> f64 {
        let at = |i| self.solid.position(i);
        let (inner, outer) = (self.wall.inner(at), self.wall.outer(at));
        inner.iter().zip(&outer).map(|(a, b)| (a - b).norm()).fold(f64::INFINITY, f64::min)
    }

    /// Ways out: gaps between columns, at the inner side, the middle or the outer side of the wall, and places where the inner
    /// or outer surface crosses itself.
    #[must_use]
    pub fn escapes(&self) -> usize {
        let at = |i| self.solid.position(i);
        let gaps = self.wall.stretched(at, &self.start.1).filter(|(_, stretch)| *stretch > GAP).count();
        gaps + self.wall.crossings(&self.wall.inner(at)) + self.wall.crossings(&self.wall.outer(at))
    }

    /// The shape of the outer surface.
    #[must_use]
    pub fn outline(&self) -> Outline<D> {
        Outline::new(&self.wall, &self.wall.outer(|i| self.solid.position(i)))
    }
}

#[cfg(test)]
mod tests;
