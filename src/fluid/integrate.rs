//! One time step: kick, drift, density, walls, forces, bounce, kick.
//!
//! The pressure is that of the full-step density. The printed scheme takes it from the half step, which feeds
//! sound waves and is stable only for dt below about 2 nu/c0².

use rayon::prelude::*;

use crate::error::RunError;
use crate::fluid::flow::Flow;
use crate::fluid::neighbours::{BLOCK, Grid, build_blocks};
use crate::fluid::pass::{sweep_densities, sweep_forces};
use crate::fluid::setup::BodyKind;
use crate::fluid::sponge::Relaxation;
use crate::fluid::wall::{Obstacles, carry, mirror};

/// Relative change of density at which a run is given up.
const DENSITY_LIMIT: f64 = 0.2;

impl<const D: usize> Flow<D> {
    /// Takes `steps` steps of `dt` (s). The result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] when a density leaves 80-120 % of its rest value, a number is lost, or a particle
    /// leaves the box through a wall.
    pub fn advance(&mut self, dt: f64, steps: u64) -> Result<(), RunError> {
        // On a thread of the pool from the start, so that no sweep has to wake one for itself.
        rayon::scope(|_| (0..steps).try_for_each(|_| self.step(dt)))
    }

    /// Advances by `duration` (s) in equal steps of at most the step limit, up to t = 0: until then walls that
    /// travel or oscillate rest, and those that rotate turn in their place.
    ///
    /// # Errors
    /// As [`Flow::advance`].
    pub fn settle(&mut self, duration: f64) -> Result<(), RunError> {
        if duration <= 0.0 {
            return Ok(());
        }
        let steps = (duration / self.step_limit().seconds).ceil().max(1.0);
        self.time = -duration;
        self.advance(duration / steps, steps as u64)?;
        self.time = 0.0;
        Ok(())
    }

    /// Kick, drift, density, walls, forces, bounce, kick.
    fn step(&mut self, dt: f64) -> Result<(), RunError> {
        self.kick_and_drift(dt);
        self.time += dt;
        self.steps += 1;
        self.carry_solids();
        if self.travel > 0.5 * self.setup.skin {
            self.rebuild();
        }
        self.densities();
        self.update_densities(dt)?;
        self.mirrors();
        self.forces(dt);
        self.finish(dt);
        self.tally.particle_steps += self.sides.len() as u64;
        self.tally.pair_evaluations += self.blocks.iter().map(|b| b.contacts.len() as u64).sum::<u64>();
        Ok(())
    }

    /// v += dt/2 a, sponges, x += dt (v + w), for the fluid.
    fn kick_and_drift(&mut self, dt: f64) {
        let sponges = Relaxation::new(&self.sponges, 0.5 * dt, self.passage(), &self.domain);
        let (fastest, transport) = self
            .positions
            .par_chunks_mut(BLOCK)
            .zip(self.sides.par_chunks_mut(BLOCK))
            .zip(self.own.par_chunks(BLOCK))
            .map(|((positions, sides), own)| {
                let (mut fastest, mut transport) = (0.0_f64, 0.0_f64);
                for ((position, side), own) in positions.iter_mut().zip(sides).zip(own) {
                    if side.is_solid() {
                        continue;
                    }
                    side.velocity += own.acceleration * (0.5 * dt);
                    sponges.apply(position, &mut side.velocity);
                    let carried = side.velocity + side.drift;
                    *position += carried * dt;
                    fastest = fastest.max(side.velocity.norm_squared());
                    transport = transport.max(carried.norm_squared());
                }
                (fastest, transport)
            })
            .reduce(|| (0.0, 0.0), |a, b| (a.0.max(b.0), a.1.max(b.1)));
        self.tally.largest_speed = self.tally.largest_speed.max(fastest.sqrt());
        self.travel += dt * transport.sqrt();
    }

    /// Solids to their place and velocity of now.
    pub(super) fn carry_solids(&mut self) {
        let mut furthest = 0.0_f64;
        for i in 0..self.sides.len() {
            if self.sides[i].is_solid() {
                let before = self.positions[i];
                let body = &self.bodies[self.sides[i].body as usize];
                carry(body, &self.own[i], &mut self.positions[i], &mut self.sides[i], self.time);
                // A turn round a periodic axis since the last sorting is no movement.
                furthest = furthest.max(self.domain.separation(&self.positions[i], &before).norm_squared());
            }
        }
        self.travel += furthest.sqrt();
    }

    /// Sorts the particles by cells and builds their lists anew.
    pub(super) fn rebuild(&mut self) {
        for position in &mut self.positions {
            *position = self.domain.wrap(position);
        }
        let radius = self.kernel.cutoff() + self.setup.skin;
        let grid = Grid::build(&self.positions, &self.domain, radius);
        let order = grid.order();
        self.positions = order.iter().map(|&i| self.positions[i as usize]).collect();
        self.sides = order.iter().map(|&i| self.sides[i as usize]).collect();
        self.own = order.iter().map(|&i| self.own[i as usize]).collect();
        self.solids = (0..self.sides.len() as u32).filter(|&i| self.sides[i as usize].is_solid()).collect();
        build_blocks(&mut self.blocks, &self.positions, &self.sides, &self.domain, radius);
        self.travel = 0.0;
        self.tally.rebuilds += 1;
    }

    pub(super) fn densities(&mut self) {
        let (terms, kernel, shortest) = (&self.terms, &self.kernel, &self.shortest);
        let (positions, sides) = (&self.positions, &self.sides);
        self.blocks.par_iter_mut().zip(self.rates.par_chunks_mut(BLOCK)).for_each(|(block, rates)| {
            sweep_densities(block, rates, terms, kernel, shortest, positions, sides);
        });
    }

    /// rho += dt drho/dt, p = c0² (rho - rho0), V = m/rho; and every so often takes the mean drift of the
    /// density out, without which a closed flow creeps to a wrong pressure level.
    fn update_densities(&mut self, dt: f64) -> Result<(), RunError> {
        let stiffness = self.sound_speed * self.sound_speed;
        let every = self.setup.drift_correction;
        let mut drift = 0.0;
        if every > 0 && self.steps.is_multiple_of(every) {
            let (mut mass, mut sum) = (0.0, 0.0);
            for (side, own) in self.sides.iter().zip(&self.own).filter(|(side, _)| !side.is_solid()) {
                mass += own.mass;
                sum += own.mass * (side.density / own.rest_density - 1.0);
            }
            drift = if mass > 0.0 { sum / mass } else { 0.0 };
        }
        let (mut worst, mut fault) = (0.0_f64, None::<(usize, Option<usize>)>);
        for (i, ((side, own), rates)) in self.sides.iter_mut().zip(&mut self.own).zip(&self.rates).enumerate()
        {
            own.fraction = rates.fraction;
            if side.is_solid() {
                continue;
            }
            side.density += dt * rates.density - drift * own.rest_density;
            side.pressure = stiffness * (side.density - own.rest_density);
            side.volume = own.mass / side.density;
            let change = (side.density / own.rest_density - 1.0).abs();
            // Written so that "not a number" is a fault too.
            if change <= DENSITY_LIMIT {
                worst = worst.max(change);
            } else {
                fault.get_or_insert((i, None));
            }
            let place = &self.positions[i];
            for k in (0..D).filter(|&k| !self.domain.periodic[k]) {
                let out = (self.domain.min[k] - place[k]).max(place[k] - self.domain.max[k]);
                if out > self.kernel.cutoff() {
                    fault.get_or_insert((i, Some(k)));
                }
            }
        }
        self.tally.largest_density_change = self.tally.largest_density_change.max(worst);
        match fault {
            None => Ok(()),
            Some((i, None)) => Err(self.blow_up(i, "density (kg/m^3)", self.sides[i].density)),
            Some((i, Some(k))) => {
                let name = format!("{} (m), outside the box,", ["x", "y", "z"][k.min(2)]);
                Err(self.blow_up(i, &name, self.positions[i][k]))
            }
        }
    }

    /// What solids show to the fluid from here to the end of the step.
    pub(super) fn mirrors(&mut self) {
        let (bodies, sides, positions, time) = (&self.bodies, &self.sides, &self.positions, self.time);
        let (own, gravity) = (&self.own, &self.setup.gravity);
        self.blocks.par_iter().zip(self.mirrors.par_chunks_mut(BLOCK)).for_each(|(block, mirrors)| {
            for (row, out) in mirrors.iter_mut().enumerate() {
                let i = block.first + row;
                if let BodyKind::Solid { motion, .. } = &bodies[sides[i].body as usize].kind {
                    let pull = motion.acceleration(&positions[i], time);
                    *out = mirror(block, row, (sides, own), sides[i].velocity, pull, gravity);
                }
            }
        });
        let softness = 1.0 / (self.sound_speed * self.sound_speed);
        for &i in &self.solids {
            let (side, shown) = (&mut self.sides[i as usize], &self.mirrors[i as usize]);
            side.velocity = shown.velocity;
            side.pressure = shown.pressure;
            side.density = self.own[i as usize].rest_density + shown.pressure * softness;
        }
    }

    /// Forces and crowding, and the corrections of positions at walls.
    pub(super) fn forces(&mut self, dt: f64) {
        let (terms, sides, positions) = (&self.terms, &self.sides, &self.positions);
        let obstacles = Obstacles {
            bodies: &self.bodies,
            domain: &self.domain,
            time: self.time,
            dt,
            surface_fraction: self.setup.surface_fraction,
            spacing: self.setup.spacing,
        };
        let (bounces, penetrations, furthest) = self
            .blocks
            .par_iter()
            .zip(self.rates.par_chunks_mut(BLOCK))
            .map(|(block, rates)| {
                sweep_forces(block, rates, terms, sides);
                let (mut bounces, mut inside, mut furthest) = (0, 0, 0.0_f64);
                for (row, rates) in rates.iter_mut().enumerate() {
                    if !sides[block.first + row].is_solid() {
                        let result = obstacles.bounce(block, row, rates.fraction, positions, sides);
                        rates.correction = result.correction;
                        bounces += u64::from(result.bounced);
                        inside += u64::from(result.inside);
                        furthest = furthest.max(result.correction.norm_squared());
                    }
                }
                (bounces, inside, furthest)
            })
            .reduce(|| (0, 0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1, a.2.max(b.2)));
        self.tally.bounces += bounces;
        self.tally.penetrations += penetrations;
        self.travel += furthest.sqrt();
    }

    /// Corrected positions, acceleration, v += dt/2 a, sponges, and the shift of the next drift.
    pub(super) fn finish(&mut self, dt: f64) {
        let sponges = Relaxation::new(&self.sponges, 0.5 * dt, self.passage(), &self.domain);
        let shift = self.terms.shift.as_ref();
        let gravity = self.setup.gravity;
        self.positions
            .par_chunks_mut(BLOCK)
            .zip(self.sides.par_chunks_mut(BLOCK))
            .zip(self.own.par_chunks_mut(BLOCK))
            .zip(self.rates.par_chunks(BLOCK))
            .for_each(|(((positions, sides), own), rates)| {
                for (((position, side), own), rates) in positions.iter_mut().zip(sides).zip(own).zip(rates) {
                    if side.is_solid() {
                        continue;
                    }
                    *position += rates.correction;
                    own.acceleration = rates.force / side.density + gravity + own.lift;
                    side.velocity += own.acceleration * (0.5 * dt);
                    sponges.apply(position, &mut side.velocity);
                    if let Some(shift) = shift {
                        side.drift = shift.velocity(&rates.crowding, side.density / own.rest_density);
                        sponges.damp(position, &mut side.drift);
                    }
                }
            });
    }

    /// Time a particle takes across a cut-off at the reference speed, s.
    fn passage(&self) -> f64 {
        self.kernel.cutoff() / self.setup.reference_speed
    }

    /// The fault of particle `i` (in the present order) at the present step.
    fn blow_up(&self, i: usize, quantity: &str, value: f64) -> RunError {
        RunError::BlowUp {
            step: self.steps,
            time: self.time,
            particle: self.own[i].id as usize,
            quantity: quantity.to_owned(),
            value,
            remedy: "take a shorter fluid step, or a larger sound speed or pressure scale".to_owned(),
        }
    }
}
