//! One time step, the longest stable step, and the flow as a whole.

use rayon::prelude::*;

use crate::error::RunError;
use crate::fluid::domain::{Domain, Shortest};
use crate::fluid::kernel::Kernel;
use crate::fluid::neighbours::{BLOCK, Block, Grid, build_blocks};
use crate::fluid::particles::{Material, Own, Side};
use crate::fluid::pass::{Rates, Terms, sweep_densities, sweep_forces};
use crate::fluid::setup::{Body, BodyKind, Setup, Slip, Sponge};
use crate::fluid::terms::{Continuity, DensityDiffusion, Pressure, Shift, TransportStress, Viscosity};
use crate::fluid::wall::{Mirror, Obstacles, carry, mirror};
use crate::vector::Vector;

/// The largest eigenvalue of the viscous operator, in Gershgorin row sums max_i (2/rho_i) Σ V_j eta F.
/// The bound is 2; measured by power iteration (see the tests) 1.06-1.16 on lattices and disordered, walls included.
const VISCOUS_EIGENVALUE: f64 = 1.25;
/// Share of the linear stability limit that is used.
const VISCOUS_SAFETY: f64 = 0.8;
/// Relative change of density at which a run is given up.
const DENSITY_LIMIT: f64 = 0.2;

/// The longest stable step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepLimit {
    /// s.
    pub seconds: f64,
    /// What limits it, in words.
    pub limited_by: String,
}

/// A flow in progress.
pub struct Flow<const D: usize> {
    pub(super) domain: Domain<D>,
    pub(super) bodies: Vec<Body<D>>,
    pub(super) positions: Vec<Vector<D>>,
    pub(super) sides: Vec<Side<D>>,
    pub(super) own: Vec<Own<D>>,
    pub(super) sound_speed: f64,
    pub(super) tally: Tally,
    kernel: Kernel<D>,
    shortest: Shortest<D>,
    terms: Terms<D>,
    sponges: Vec<Sponge<D>>,
    setup: Scales<D>,
    blocks: Vec<Block<D>>,
    rates: Vec<Rates<D>>,
    mirrors: Vec<Mirror<D>>,
    solids: Vec<u32>,
    /// Bound on how far any particle moved since the lists were built, m.
    travel: f64,
    time: f64,
    steps: u64,
}

/// What the steps need of the setup.
struct Scales<const D: usize> {
    spacing: f64,
    skin: f64,
    gravity: Vector<D>,
    reference_speed: f64,
    courant: f64,
    shift: f64,
    surface_fraction: f64,
    drift_correction: u64,
}

/// What is counted over the steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub penetrations: u64,
    pub bounces: u64,
    pub largest_speed: f64,
    pub largest_density_change: f64,
    pub particle_steps: u64,
    pub pair_evaluations: u64,
    pub rebuilds: u64,
}

/// A refusal of the setup as a fault of step 0.
fn refuse(particle: usize, quantity: &str, value: f64, remedy: &str) -> RunError {
    RunError::BlowUp {
        step: 0,
        time: 0.0,
        particle,
        quantity: quantity.to_owned(),
        value,
        remedy: remedy.to_owned(),
    }
}

impl<const D: usize> Flow<D> {
    /// Builds a flow at rest (or at its initial velocity) and sums its first forces.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] at step 0 where the setup cannot run: a box shorter than two cut-offs on a periodic
    /// axis, a body without description, a place, volume, density or scale that is no positive number.
    pub fn new(setup: Setup<D>) -> Result<Flow<D>, RunError> {
        check(&setup)?;
        let sound_speed = setup.sound_speed.unwrap_or_else(|| setup.automatic_sound_speed());
        let (h, shift) = (setup.cutoff, setup.shift());
        let options = &setup.options;
        let courant = options.courant.unwrap_or(if shift > 5.0 { 1.0 / shift } else { 0.2 });
        let lightest = setup.bodies.iter().fold(f64::INFINITY, |rho, body| match body.kind {
            BodyKind::Fluid { density, .. } => density.min(rho),
            BodyKind::Solid { .. } => rho,
        });
        let terms = Terms {
            continuity: Continuity,
            density_diffusion: None,
            pressure: Pressure,
            viscosity: Viscosity,
            transport_stress: (shift > 0.0).then_some(TransportStress),
            shift: (shift > 0.0).then_some(Shift::new(shift, h, setup.reference_speed)),
        };
        let (mut positions, mut sides, mut own) = (Vec::new(), Vec::new(), Vec::new());
        for (id, placed) in setup.particles.iter().enumerate() {
            let (material, density, viscosity) = match &setup.bodies[placed.body as usize].kind {
                BodyKind::Fluid { density, viscosity } => (Material::Fluid, *density, *viscosity),
                BodyKind::Solid { slip: Slip::NoSlip, .. } => (Material::NoSlip, lightest, 0.0),
                BodyKind::Solid { slip: Slip::FreeSlip, .. } => (Material::FreeSlip, lightest, 0.0),
            };
            let fluid = material == Material::Fluid;
            positions.push(placed.position);
            sides.push(Side {
                velocity: if fluid { setup.initial_velocity } else { Vector::zeros() },
                drift: Vector::zeros(),
                density,
                pressure: 0.0,
                volume: placed.volume,
                viscosity,
                material,
                body: placed.body,
            });
            own.push(Own {
                id: id as u32,
                mass: density * placed.volume,
                rest_density: density,
                start: placed.position,
                acceleration: Vector::zeros(),
                fraction: if fluid { 0.0 } else { 1.0 },
            });
        }
        let n = positions.len();
        let given_speed = setup.sound_speed;
        let delta = options.delta;
        let mut flow = Flow {
            shortest: setup.domain.shortest(),
            kernel: Kernel::new(setup.kernel, h),
            setup: Scales {
                spacing: setup.spacing,
                skin: options.skin * h,
                gravity: setup.body_force,
                reference_speed: setup.reference_speed,
                courant,
                shift,
                surface_fraction: options.surface_fraction,
                drift_correction: options.drift_correction,
            },
            domain: setup.domain,
            bodies: setup.bodies,
            sponges: setup.sponges,
            positions,
            sides,
            own,
            sound_speed,
            tally: Tally::default(),
            terms,
            blocks: Vec::new(),
            rates: vec![Rates::default(); n],
            mirrors: vec![Mirror { velocity: Vector::zeros(), pressure: 0.0 }; n],
            solids: Vec::new(),
            travel: 0.0,
            time: 0.0,
            steps: 0,
        };
        flow.carry_solids();
        flow.rebuild();
        flow.densities();
        if given_speed.is_none() {
            flow.sound_speed = flow.stiffen();
        }
        if delta > 0.0 {
            let (c, u) = (flow.sound_speed, flow.setup.reference_speed);
            flow.terms.density_diffusion = Some(DensityDiffusion::new(delta, h, c, u));
        }
        flow.mirrors();
        flow.forces(0.0);
        flow.finish(0.0);
        flow.tally = Tally::default();
        Ok(flow)
    }

    /// Gives every fluid particle the velocity (m/s) `velocity` has at its place (m), and sums the forces anew.
    pub fn set_velocity(&mut self, velocity: impl Fn(&Vector<D>) -> Vector<D>) {
        for (position, side) in self.positions.iter().zip(&mut self.sides) {
            if !side.is_solid() {
                side.velocity = velocity(&self.domain.wrap(position));
            }
        }
        self.carry_solids();
        self.densities();
        self.mirrors();
        self.forces(0.0);
        self.finish(0.0);
    }

    /// The longest stable step at the present state and what limits it:
    /// sound dt = C h/(c0 + U); viscosity 0.8 · 2/λ, λ the largest eigenvalue of the viscous operator (kick-
    /// drift-kick is forward Euler for friction); body force dt = ¼ √(h/g); shift dt = 0.1 h/(A U).
    #[must_use]
    pub fn step_limit(&self) -> StepLimit {
        let (h, s) = (self.kernel.cutoff(), &self.setup);
        let speed = s.reference_speed.max(self.tally.largest_speed);
        let candidates = [
            (s.courant * h / (self.sound_speed + speed), "sound"),
            (self.viscous_limit(), "viscosity"),
            (0.25 * (h / s.gravity.norm()).sqrt(), "body force"),
            (0.1 * h / (s.shift * speed), "particle shift"),
        ];
        let (seconds, word) =
            candidates.into_iter().fold((f64::INFINITY, "nothing"), |a, b| if b.0 < a.0 { b } else { a });
        StepLimit { seconds, limited_by: word.to_owned() }
    }

    /// The sound speed raised to what costs nothing where friction limits the step, at most threefold, m/s:
    /// density changes fall with its square, and with them all errors of compressibility.
    fn stiffen(&self) -> f64 {
        let viscous = self.viscous_limit();
        let free = 0.8 * self.setup.courant * self.kernel.cutoff() / viscous - self.setup.reference_speed;
        self.sound_speed.max(free.min(3.0 * self.sound_speed))
    }

    /// Longest step that friction allows, s.
    fn viscous_limit(&self) -> f64 {
        VISCOUS_SAFETY * 2.0 / (VISCOUS_EIGENVALUE * self.friction_rate())
    }

    /// The largest (2/rho_i) Σ V_j eta_ij F, 1/s.
    #[must_use]
    pub fn friction_rate(&self) -> f64 {
        let mut largest = 0.0_f64;
        for block in &self.blocks {
            for row in 0..block.contact_ends.len() {
                let i = &self.sides[block.first + row];
                if !i.is_solid() {
                    let sum: f64 = block
                        .row(row)
                        .iter()
                        .map(|c| (c, &self.sides[c.j as usize]))
                        .map(|(c, j)| j.volume * crate::fluid::terms::viscosity::between(i, j) * c.weight)
                        .sum();
                    largest = largest.max(2.0 * sum / i.density);
                }
            }
        }
        largest
    }

    /// Time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps taken.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// c0, m/s.
    #[must_use]
    pub fn sound_speed(&self) -> f64 {
        self.sound_speed
    }

    /// Takes `steps` steps of `dt` (s). The result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] when a density leaves 80-120 % of its rest value, a number is lost, or a particle
    /// leaves the box through a wall.
    pub fn advance(&mut self, dt: f64, steps: u64) -> Result<(), RunError> {
        // On a thread of the pool from the start, so that no sweep has to wake one for itself.
        rayon::scope(|_| (0..steps).try_for_each(|_| self.step(dt)))
    }

    /// Advances by `duration` (s) in equal steps of at most the step limit.
    ///
    /// # Errors
    /// As [`Flow::advance`].
    pub fn settle(&mut self, duration: f64) -> Result<(), RunError> {
        let steps = (duration / self.step_limit().seconds).ceil().max(1.0);
        self.advance(duration / steps, steps as u64)
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
        let sponges = Relaxation::new(&self.sponges, 0.5 * dt, &self.domain);
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
    fn carry_solids(&mut self) {
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
    fn rebuild(&mut self) {
        for position in &mut self.positions {
            *position = self.domain.wrap(position);
        }
        let radius = self.kernel.cutoff() + self.setup.skin;
        let grid = Grid::build(&self.positions, &self.domain, radius);
        let order = grid.order();
        self.positions = order.iter().map(|&i| self.positions[i as usize]).collect();
        self.sides = order.iter().map(|&i| self.sides[i as usize]).collect();
        self.own = order.iter().map(|&i| self.own[i as usize]).collect();
        self.solids =
            (0..self.sides.len() as u32).filter(|&i| self.sides[i as usize].is_solid()).collect();
        build_blocks(&mut self.blocks, &self.positions, &self.sides, &self.domain, radius);
        self.travel = 0.0;
        self.tally.rebuilds += 1;
    }

    fn densities(&mut self) {
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
        for (i, ((side, own), rates)) in self.sides.iter_mut().zip(&mut self.own).zip(&self.rates).enumerate() {
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
    fn mirrors(&mut self) {
        let (bodies, sides, positions, time) = (&self.bodies, &self.sides, &self.positions, self.time);
        let gravity = &self.setup.gravity;
        self.blocks.par_iter().zip(self.mirrors.par_chunks_mut(BLOCK)).for_each(|(block, mirrors)| {
            for (row, out) in mirrors.iter_mut().enumerate() {
                let i = block.first + row;
                if let BodyKind::Solid { motion, .. } = &bodies[sides[i].body as usize].kind {
                    let pull = motion.acceleration(&positions[i], time);
                    *out = mirror(block, row, sides, sides[i].velocity, pull, gravity);
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
    fn forces(&mut self, dt: f64) {
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
    fn finish(&mut self, dt: f64) {
        let sponges = Relaxation::new(&self.sponges, 0.5 * dt, &self.domain);
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
                    own.acceleration = rates.force / side.density + gravity;
                    side.velocity += own.acceleration * (0.5 * dt);
                    sponges.apply(position, &mut side.velocity);
                    if let Some(shift) = shift {
                        side.drift = shift.velocity(&rates.crowding, side.density / own.rest_density);
                    }
                }
            });
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

/// The sponges with their decay over one kick.
struct Relaxation<'a, const D: usize> {
    sponges: Vec<(&'a Sponge<D>, f64)>,
    domain: &'a Domain<D>,
}

impl<'a, const D: usize> Relaxation<'a, D> {
    fn new(sponges: &'a [Sponge<D>], dt: f64, domain: &'a Domain<D>) -> Relaxation<'a, D> {
        Relaxation { sponges: sponges.iter().map(|s| (s, (-s.rate * dt).exp())).collect(), domain }
    }

    /// v -> target + (v - target) exp(-rate dt) in every sponge that holds the place.
    #[inline]
    fn apply(&self, position: &Vector<D>, velocity: &mut Vector<D>) {
        for (sponge, decay) in &self.sponges {
            let place = self.domain.wrap(position);
            if (sponge.region)(&place) {
                let target = (sponge.velocity)(&place);
                *velocity = target + (*velocity - target) * *decay;
            }
        }
    }
}

/// Refuses a setup that cannot run.
fn check<const D: usize>(setup: &Setup<D>) -> Result<(), RunError> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let scales = [
        ("cut-off (m)", setup.cutoff),
        ("spacing (m)", setup.spacing),
        ("reference speed (m/s)", setup.reference_speed),
        ("reference length (m)", setup.reference_length),
        ("sound speed (m/s)", setup.sound_speed.unwrap_or(1.0)),
    ];
    for (name, value) in scales {
        if !positive(value) {
            return Err(refuse(0, name, value, "it must be a positive number"));
        }
    }
    let lengths = setup.domain.lengths();
    let least = 2.0 * setup.cutoff * (1.0 + setup.options.skin);
    for k in 0..D {
        if !positive(lengths[k]) || (setup.domain.periodic[k] && lengths[k] < least) {
            let remedy = format!("a periodic box must be at least {least:.3e} m long: two cut-offs with skin");
            return Err(refuse(0, "length of the box (m)", lengths[k], &remedy));
        }
    }
    for body in &setup.bodies {
        if let BodyKind::Fluid { density, viscosity } = body.kind
            && !(positive(density) && viscosity.is_finite() && viscosity >= 0.0)
        {
            return Err(refuse(0, "density (kg/m^3) of a fluid", density, "density and viscosity must be positive"));
        }
    }
    for (i, placed) in setup.particles.iter().enumerate() {
        if placed.body as usize >= setup.bodies.len() {
            return Err(refuse(i, "body", f64::from(placed.body), "no such body in the setup"));
        }
        if !positive(placed.volume) || !placed.position.iter().all(|x| x.is_finite()) {
            return Err(refuse(i, "volume (m^D)", placed.volume, "place and volume must be finite numbers"));
        }
    }
    Ok(())
}
