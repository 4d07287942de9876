//! One time step: kick, drift, density, walls, forces, bounce, kick.
//!
//! The pressure is that of the full-step density. The printed scheme takes it from the half step, which feeds
//! sound waves and is stable only for dt below about 2 nu/c0².

use rayon::prelude::*;

use crate::error::RunError;
use crate::fluid::blocks::{Block, build_blocks};
use crate::fluid::carried;
use crate::fluid::flow::Flow;
use crate::fluid::mirror::{Continuation, Moving, filling, mirror};
use crate::fluid::motion::Motion;
use crate::fluid::order::along_a_curve;
use crate::fluid::particles::{Side, Slopes};
use crate::fluid::pass::{Rates, sweep_reactions};
use crate::fluid::setup::{Body, BodyKind, Slip};
use crate::fluid::sponge::Relaxation;
use crate::fluid::terms::continuity::{contraction, gradient};
use crate::fluid::terms::{Moment, TransportStress, viscosity};
use crate::fluid::wall::{Obstacles, carry};
use crate::fluid::wide::{sweep_densities, sweep_forces};
use crate::vector::Vector;

/// Relative change of density at which a run is given up.
const DENSITY_LIMIT: f64 = 0.2;
/// Rebuilds of the lists between two sortings of the particles: between two rebuilds they move by half a skin.
const SORTING: u64 = 8;

impl<const D: usize> Flow<D> {
    /// Takes `steps` steps of `dt` (s). The result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] when a density leaves 80-120 % of its rest value, a number is lost, or a particle
    /// leaves the box through a wall.
    pub fn advance(&mut self, dt: f64, steps: u64) -> Result<(), RunError> {
        self.advance_until(dt, steps, &|| false).map(drop)
    }

    /// As [`Flow::advance`], but ends before the step at which `stop` says so; the number of steps taken.
    ///
    /// # Errors
    /// As [`Flow::advance`].
    pub fn advance_until(
        &mut self,
        dt: f64,
        steps: u64,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<u64, RunError> {
        // On a thread of the pool from the start, so that no sweep has to wake one for itself.
        rayon::scope(|_| {
            for taken in 0..steps {
                if stop() {
                    return Ok(taken);
                }
                self.step(dt)?;
            }
            Ok(steps)
        })
    }

    /// Advances by `duration` (s) in equal steps of at most the step limit, up to t = 0: until then walls that
    /// travel, oscillate or are free rest, and those that rotate turn in their place.
    ///
    /// # Errors
    /// As [`Flow::advance`].
    pub fn settle(&mut self, duration: f64) -> Result<(), RunError> {
        self.settle_until(duration, &|| false).map(drop)
    }

    /// As [`Flow::settle`], but ends before the step at which `stop` says so; whether it came to t = 0.
    ///
    /// # Errors
    /// As [`Flow::advance`].
    pub fn settle_until(
        &mut self,
        duration: f64,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<bool, RunError> {
        if duration <= 0.0 {
            return Ok(true);
        }
        let steps = (duration / self.step_limit().seconds).ceil().max(1.0);
        self.time = -duration;
        self.hold_bodies();
        if self.advance_until(duration / steps, steps as u64, stop)? < steps as u64 {
            return Ok(false);
        }
        self.time = 0.0;
        self.release_bodies();
        Ok(true)
    }

    /// Kick, drift, density, walls, forces, bounce, kick.
    fn step(&mut self, dt: f64) -> Result<(), RunError> {
        if self.terms.noise.is_some() && dt != self.noise_step {
            self.redraw(dt);
        }
        self.step_length = dt;
        self.kick_and_drift(dt);
        self.kick_and_drift_bodies(dt)?;
        self.time += dt;
        self.steps += 1;
        self.carry_solids();
        if self.travel.max(self.strayed) > 0.5 * self.setup.skin {
            self.pass_ends()?;
            self.check_bodies()?;
            if self.tally.rebuilds.is_multiple_of(SORTING) {
                self.sort();
            }
            self.rebuild();
        }
        self.densities();
        self.update_densities(dt)?;
        if self.setup.shepard.is_some_and(|every| every > 0 && self.steps.is_multiple_of(every)) {
            self.filter_densities();
        }
        self.densities_at_ends();
        self.mirrors();
        self.forces(dt);
        self.finish(dt);
        self.tally.particle_steps += self.sides.len() as u64;
        self.tally.pair_evaluations += self.blocks.iter().map(Block::pairs).sum::<u64>();
        Ok(())
    }

    /// Sums the accelerations anew with the noise of a step of `dt` (s): that of a shorter step is too strong for a
    /// longer one.
    fn redraw(&mut self, dt: f64) {
        self.begin_noise(dt);
        // At the places of now: those of the last sweep are not kept with a state, and walls moved some particles since.
        self.find_contacts();
        let (terms, kernel, gravity) = (&self.terms, &self.kernel, self.setup.gravity);
        let (sides, slopes) = (&self.sides, &self.slopes);
        let asks = &self.asks;
        let asked = asks.iter().any(|&asks| asks);
        self.blocks
            .par_iter()
            .zip(self.rates.par_chunks_mut(Block::<D>::SIZE))
            .zip(self.own.par_chunks_mut(Block::<D>::SIZE))
            .for_each(|((block, rates), own)| {
                sweep_forces(block, rates, terms, kernel, (sides, slopes));
                if asked {
                    sweep_reactions(block, rates, terms, kernel, sides, |body| asks[body as usize]);
                }
                for ((rates, own), side) in rates.iter().zip(own).zip(&sides[block.first..]) {
                    own.acceleration = rates.force * side.inverse_density + gravity + own.lift;
                }
            });
        self.load_bodies(0.0);
        self.finish_ends(0.0);
    }

    /// Makes the noise ready for the present step.
    fn begin_noise(&mut self, dt: f64) {
        if let Some(noise) = &mut self.terms.noise {
            noise.begin(self.steps, dt, self.terms.viscosity.a::<D>());
            self.noise_step = dt;
        }
    }

    /// v += dt/2 a, sponges, x += dt (v + w), for the fluid.
    fn kick_and_drift(&mut self, dt: f64) {
        let sponges = Relaxation::new(&self.sponges, 0.5 * dt, self.passage(), &self.domain);
        let (fastest, strayed) = self
            .positions
            .par_chunks_mut(Block::<D>::SIZE)
            .zip(self.sides.par_chunks_mut(Block::<D>::SIZE))
            .zip(self.own.par_chunks(Block::<D>::SIZE))
            .zip(self.listed.par_chunks(Block::<D>::SIZE))
            .map(|(((positions, sides), own), listed)| {
                let (mut fastest, mut strayed) = (0.0_f64, 0.0_f64);
                for (((position, side), own), listed) in positions.iter_mut().zip(sides).zip(own).zip(listed)
                {
                    if side.is_solid() {
                        continue;
                    }
                    side.velocity += own.acceleration * (0.5 * dt);
                    sponges.apply(position, &mut side.velocity);
                    *position += (side.velocity + side.drift) * dt;
                    fastest = fastest.max(side.velocity.norm_squared());
                    // From where it was listed, not along its way: noise turns it back again and again.
                    strayed = strayed.max((*position - listed).norm_squared());
                }
                (fastest, strayed)
            })
            .reduce(|| (0.0, 0.0), |a, b| (a.0.max(b.0), a.1.max(b.1)));
        self.tally.largest_speed = self.tally.largest_speed.max(fastest.sqrt());
        self.strayed = strayed.sqrt();
    }

    /// Solids to their place and velocity of now.
    pub(super) fn carry_solids(&mut self) {
        if self.tally.rebuilds > 0 && self.solids.is_empty() {
            return;
        }
        let (bodies, domain, rows) = (&self.bodies, &self.domain, &self.rows);
        let (time, dt) = (self.time, self.step_length);
        let size = Block::<D>::SIZE;
        let furthest = self
            .positions
            .par_chunks_mut(size)
            .zip(self.sides.par_chunks_mut(size))
            .zip(self.own.par_chunks(size))
            .map(|((positions, sides), own)| {
                let mut furthest = 0.0_f64;
                for ((position, side), own) in positions.iter_mut().zip(sides).zip(own) {
                    if side.is_solid() {
                        let before = *position;
                        let row = rows[side.id as usize] as usize;
                        carry(&bodies[side.body as usize], row, own, position, side, (time, dt));
                        // Back into the box: the sweeps turn round a periodic axis once only.
                        *position = domain.wrap(position);
                        let way = domain.separation(position, &before);
                        if bodies[side.body as usize].is_elastic() && dt > 0.0 {
                            // By which it went, as that of the fluid: at the end of its own steps it has felt half of the
                            // load of this step and all of what resists it, and a wall at rest would seem to come
                            // towards the fluid that presses on it.
                            side.velocity = way / dt;
                        }
                        furthest = furthest.max(way.norm_squared());
                    }
                }
                furthest
            })
            .reduce(|| 0.0, f64::max);
        self.travel += furthest.sqrt();
    }

    /// Sorts the particles along a curve that keeps neighbours together; the lists must be built anew.
    pub(super) fn sort(&mut self) {
        for position in &mut self.positions {
            *position = self.domain.wrap(position);
        }
        let order = along_a_curve(&self.positions, &self.domain, self.kernel.cutoff());
        self.positions = order.iter().map(|&i| self.positions[i as usize]).collect();
        self.sides = order.iter().map(|&i| self.sides[i as usize]).collect();
        self.own = order.iter().map(|&i| self.own[i as usize]).collect();
        if !self.slopes.is_empty() {
            self.slopes = order.iter().map(|&i| self.slopes[i as usize]).collect();
        }
        self.solids = (0..self.sides.len() as u32).filter(|&i| self.sides[i as usize].is_solid()).collect();
    }

    /// Builds the lists anew.
    pub(super) fn rebuild(&mut self) {
        let domain = &self.domain;
        self.positions
            .par_iter_mut()
            .with_min_len(4096)
            .for_each(|position| *position = domain.wrap(position));
        let radius = self.kernel.cutoff() + self.setup.skin;
        let mutual = self.terms.are_mutual();
        build_blocks(&mut self.blocks, &self.positions, &self.sides, &self.domain, radius, mutual);
        self.listed.clone_from(&self.positions);
        (self.travel, self.strayed) = (0.0, 0.0);
        self.tally.rebuilds += 1;
        self.note_ends();
    }

    pub(super) fn densities(&mut self) {
        let (terms, kernel, shortest) = (&self.terms, &self.kernel, &self.shortest);
        let (positions, sides, slopes) = (&self.positions, &self.sides, &self.slopes);
        self.blocks.par_iter_mut().zip(self.rates.par_chunks_mut(Block::<D>::SIZE)).for_each(
            |(block, rates)| {
                sweep_densities(block, rates, terms, kernel, shortest, positions, (sides, slopes));
            },
        );
    }

    /// What the sweep of densities leaves for that of forces besides densities: the second moments and slopes of the fluid
    /// and the reach of solids.
    pub(super) fn moments(&mut self) {
        let (corrected, spread) = (self.terms.moment.is_some(), self.terms.makeup().spreads());
        for (side, rates) in self.sides.iter_mut().zip(&mut self.rates) {
            note(side, rates, corrected);
            if spread {
                rates.spread = gradient(&rates.moment, &rates.spread);
            }
        }
        self.show_slopes();
    }

    /// What neighbours see besides [`Side`]s where there is no noise.
    fn show_slopes(&mut self) {
        let (fourth, moved) = (self.terms.fourth_order, self.terms.transport_stress.is_some());
        let size = Block::<D>::SIZE;
        self.slopes
            .par_chunks_mut(size)
            .zip(self.sides.par_chunks(size))
            .zip(self.rates.par_chunks(size))
            .for_each(|((slopes, sides), rates)| {
                for ((slopes, side), rates) in slopes.iter_mut().zip(sides).zip(rates) {
                    *slopes = Slopes::default();
                    if side.is_solid() {
                        continue;
                    }
                    (slopes.density, slopes.clear) = (rates.slope, rates.fraction == 0.0);
                    if fourth {
                        slopes.flux += viscosity::flux(side.viscosity, &rates.spread, &rates.moment);
                    }
                    if moved {
                        slopes.flux += TransportStress.flux(side);
                    }
                }
            });
    }

    /// rho += dt drho/dt, p of the equation of state, V = m/rho; and every so often takes the mean drift of the
    /// density out, without which a closed flow creeps to a wrong pressure level.
    fn update_densities(&mut self, dt: f64) -> Result<(), RunError> {
        let (state, c) = (self.setup.state, self.sound_speed);
        let drift = self.density_drift();
        let corrected = self.terms.moment.is_some();
        let spread = self.terms.makeup().spreads();
        let slips =
            self.bodies.iter().any(|b| matches!(b.kind, BodyKind::Solid { slip: Slip::FreeSlip, .. }));
        let (domain, cutoff, closed) = (&self.domain, self.kernel.cutoff(), self.closed_axes());
        let size = Block::<D>::SIZE;
        let (worst, fault) = self
            .sides
            .par_chunks_mut(size)
            .zip(self.own.par_chunks_mut(size))
            .zip(self.rates.par_chunks_mut(size))
            .zip(self.positions.par_chunks(size))
            .enumerate()
            .map(|(chunk, (((sides, own), rates), positions))| {
                let (mut worst, mut fault) = (0.0_f64, None::<(usize, Option<usize>)>);
                let all = sides.iter_mut().zip(own).zip(rates).zip(positions).enumerate();
                for (row, (((side, own), rates), place)) in all {
                    note(side, rates, corrected);
                    if side.is_solid() {
                        // A block without fluid in reach is not swept for walls.
                        own.fraction = 1.0;
                        continue;
                    }
                    own.fraction = rates.fraction;
                    let mut rate = rates.density;
                    if spread {
                        rates.spread = gradient(&rates.moment, &rates.spread);
                        // What a frictionless wall shows as its velocity makes a shear that is none.
                        let over = if slips && rates.fraction > 0.0 { 0.0 } else { dt };
                        rate -= side.density * contraction(&rates.spread, over);
                    }
                    side.density += dt * rate - drift * own.rest_density;
                    side.pressure = state.pressure(side.density, own.rest_density, c);
                    side.volume = own.mass / side.density;
                    side.invert();
                    let change = (side.density / own.rest_density - 1.0).abs();
                    // Without a place there are no neighbours, and so no change of density that could tell.
                    let lost = !place.iter().chain(side.velocity.iter()).all(|x| x.is_finite());
                    // Written so that "not a number" is a fault too.
                    if change <= DENSITY_LIMIT && !lost {
                        worst = worst.max(change);
                    } else {
                        fault.get_or_insert((chunk * size + row, None));
                    }
                    for k in (0..D).filter(|&k| closed[k]) {
                        let out = (domain.min[k] - place[k]).max(place[k] - domain.max[k]);
                        if out > cutoff {
                            fault.get_or_insert((chunk * size + row, Some(k)));
                        }
                    }
                }
                (worst, fault)
            })
            // The first fault in the order of the particles.
            .reduce(|| (0.0, None), |a, b| (a.0.max(b.0), a.1.or(b.1)));
        self.tally.largest_density_change = self.tally.largest_density_change.max(worst);
        self.show_slopes();
        match fault {
            None => Ok(()),
            Some((i, None)) if !self.sides[i].velocity.iter().all(|v| v.is_finite()) => {
                Err(self.blow_up(i, "velocity (m/s)", self.sides[i].velocity.norm()))
            }
            Some((i, None)) => Err(self.blow_up(i, "density (kg/m^3)", self.sides[i].density)),
            Some((i, Some(k))) => {
                let name = format!("{} (m), outside the box,", ["x", "y", "z"][k.min(2)]);
                Err(self.blow_up(i, &name, self.positions[i][k]))
            }
        }
    }

    /// Mean of rho/rho0 - 1 over the mass of the fluid less what bodies press it by as they swell, on the steps that
    /// take it out; else zero.
    fn density_drift(&self) -> f64 {
        let every = self.setup.drift_correction;
        if every == 0 || !self.steps.is_multiple_of(every) {
            return 0.0;
        }
        let (mut mass, mut sum, mut volume) = (0.0, 0.0, 0.0);
        for (side, own) in self.sides.iter().zip(&self.own).filter(|(side, _)| !side.is_solid()) {
            mass += own.mass;
            sum += own.mass * (side.density / own.rest_density - 1.0);
            volume += own.mass / own.rest_density;
        }
        let swelling: f64 = self.elastic_bodies().map(|(_, coupled)| coupled.swelling()).sum();
        let swelling = swelling + self.growth_of_walls();
        if mass > 0.0 { sum / mass - swelling / volume } else { 0.0 }
    }

    /// Volume that walls which deform have gained, m^D.
    fn growth_of_walls(&self) -> f64 {
        let deforms =
            |body: &Body<D>| matches!(&body.kind, BodyKind::Solid { motion: Motion::Deforming(_), .. });
        if !self.bodies.iter().any(deforms) {
            return 0.0;
        }
        let all = self.sides.iter().zip(&self.own);
        let own = all.filter(|(side, _)| deforms(&self.bodies[usize::from(side.body)]));
        own.map(|(side, own)| side.volume - own.rest_volume()).sum()
    }

    /// Whether solids continue the velocity of the fluid by a parabola.
    fn continues_by_parabola(&self) -> bool {
        self.terms.moment.is_some() && self.terms.noise.is_none()
    }

    /// Whether solids answer by the pressure of a density of their own: with noise, where none of them moves. (Of those that do,
    /// one takes the place of fluid in reach of another.)
    fn has_densities_of_walls(&self) -> bool {
        let moves = |body: &Body<D>| matches!(&body.kind, BodyKind::Solid { motion, .. } if motion.moves());
        self.terms.noise.is_some() && !self.bodies.iter().any(moves)
    }

    /// Notes how much fluid solid particles have in reach, at the start.
    pub(super) fn note_fillings(&mut self) {
        if !self.has_densities_of_walls() {
            return;
        }
        for block in &self.blocks {
            for row in 0..block.near_solid.len() {
                let i = block.first + row;
                if self.sides[i].is_solid() {
                    self.own[i].filling = filling(block, row, &self.sides);
                }
            }
        }
    }

    /// What solids show to the fluid from here to the end of the step.
    pub(super) fn mirrors(&mut self) {
        let (bodies, sides, positions, time) = (&self.bodies, &self.sides, &self.positions, self.time);
        let (own, gravity, numbers) = (&self.own, self.setup.gravity, &self.rows);
        // Noise between fluid and solids is that of the mean.
        let parabola = self.continues_by_parabola();
        let dense = self.has_densities_of_walls();
        let (state, c) = (self.setup.state, self.sound_speed);
        if self.solids.is_empty() {
            return;
        }
        self.blocks.par_iter().zip(self.mirrors.par_chunks_mut(Block::<D>::SIZE)).for_each(
            |(block, mirrors)| {
                for (row, out) in mirrors.iter_mut().enumerate() {
                    let i = block.first + row;
                    if let BodyKind::Solid { motion, .. } = &bodies[sides[i].body as usize].kind {
                        let (depth, curvature) = (own[i].depth, own[i].curvature);
                        let continuation = match parabola && depth > 0.0 {
                            true => Continuation::Parabola { depth, curvature },
                            false => Continuation::Mean,
                        };
                        *out = match motion {
                            Motion::Elastic(coupled) => {
                                let number = numbers[sides[i].id as usize] as usize;
                                let wall = Moving {
                                    velocity: |_: &Vector<D>| coupled.velocity(number),
                                    turns: false,
                                    acceleration: coupled.acceleration(number),
                                    gravity,
                                    continuation,
                                };
                                mirror(block, row, (sides, own), &wall)
                            }
                            _ => {
                                let wall = Moving {
                                    velocity: |x: &Vector<D>| motion.velocity(&(positions[i] + x), time),
                                    turns: matches!(motion, Motion::Rotating { .. } | Motion::Free(_)),
                                    acceleration: motion.acceleration(&positions[i], time),
                                    gravity,
                                    continuation,
                                };
                                mirror(block, row, (sides, own), &wall)
                            }
                        };
                        if dense {
                            let (own, now) = (&own[i], filling(block, row, sides));
                            let density = own.rest_density + now - own.filling;
                            out.pressure = state.pressure(density, own.rest_density, c);
                        }
                    }
                }
            },
        );
        for &i in &self.solids {
            let (side, shown) = (&mut self.sides[i as usize], &self.mirrors[i as usize]);
            side.velocity = shown.velocity;
            side.pressure = shown.pressure;
            side.density = state.density(shown.pressure, self.own[i as usize].rest_density, c);
            side.invert();
        }
    }

    /// Forces and crowding, and the corrections of positions at walls.
    pub(super) fn forces(&mut self, dt: f64) {
        self.begin_noise(dt);
        let (terms, kernel) = (&self.terms, &self.kernel);
        let (sides, slopes, positions, asks) = (&self.sides, &self.slopes, &self.positions, &self.asks);
        let asked = asks.iter().any(|&asks| asks);
        let bounds = terms.bounds_drift && terms.transport_stress.is_some();
        let obstacles = Obstacles {
            bodies: &self.bodies,
            rows: &self.rows,
            domain: &self.domain,
            time: self.time,
            dt,
            surface_fraction: self.setup.surface_fraction,
            spacing: self.setup.spacing,
            closed: self.closed_axes(),
        };
        let (bounces, penetrations) = self
            .blocks
            .par_iter()
            .zip(self.rates.par_chunks_mut(Block::<D>::SIZE))
            .map(|(block, rates)| {
                sweep_forces(block, rates, terms, kernel, (sides, slopes));
                if bounds {
                    carried::bound(block, rates, (sides, slopes));
                }
                if asked {
                    sweep_reactions(block, rates, terms, kernel, sides, |body| asks[body as usize]);
                }
                let (mut bounces, mut inside) = (0, 0);
                for (row, rates) in rates.iter_mut().enumerate() {
                    if !sides[block.first + row].is_solid() {
                        let result = obstacles.bounce(block, row, rates.fraction, positions, sides);
                        rates.correction = result.correction;
                        bounces += u64::from(result.bounced);
                        inside += u64::from(result.inside);
                    }
                }
                (bounces, inside)
            })
            .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        if !self.solids.is_empty() && self.continues_by_parabola() {
            let own = self.own.par_chunks_mut(Block::<D>::SIZE);
            self.blocks.par_iter().zip(own).for_each(|(block, own)| Self::bend(block, own, terms, sides));
        }
        self.tally.bounces += bounces;
        self.tally.penetrations += penetrations;
    }

    /// Corrected positions, acceleration, v += dt/2 a, sponges, and the shift of the next drift.
    pub(super) fn finish(&mut self, dt: f64) {
        let sponges = Relaxation::new(&self.sponges, 0.5 * dt, self.passage(), &self.domain);
        let shift = self.terms.shift.as_ref();
        let gravity = self.setup.gravity;
        self.positions
            .par_chunks_mut(Block::<D>::SIZE)
            .zip(self.sides.par_chunks_mut(Block::<D>::SIZE))
            .zip(self.own.par_chunks_mut(Block::<D>::SIZE))
            .zip(self.rates.par_chunks(Block::<D>::SIZE))
            .for_each(|(((positions, sides), own), rates)| {
                for (((position, side), own), rates) in positions.iter_mut().zip(sides).zip(own).zip(rates) {
                    if side.is_solid() {
                        continue;
                    }
                    *position += rates.correction;
                    own.acceleration = rates.force * side.inverse_density + gravity + own.lift;
                    side.velocity += own.acceleration * (0.5 * dt);
                    sponges.apply(position, &mut side.velocity);
                    if let Some(shift) = shift {
                        side.drift = shift.velocity(&rates.crowding, side.density / own.rest_density);
                    }
                    side.held = sponges.damp(position, &mut side.drift);
                }
            });
        self.load_bodies(dt);
        self.kick_bodies(dt);
        self.finish_ends(dt);
    }

    /// Time a particle takes across a cut-off at the reference speed, s.
    fn passage(&self) -> f64 {
        self.kernel.cutoff() / self.setup.reference_speed
    }
}

/// Takes what the sweep of densities found for that of forces.
#[inline(always)]
fn note<const D: usize>(side: &mut Side<D>, rates: &Rates<D>, corrected: bool) {
    if side.is_solid() {
        side.reach = rates.density;
    } else if corrected {
        (side.moment, side.uneven) = Moment.correction(&rates.moment);
    }
}
