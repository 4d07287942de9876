//! The free bodies of a flow: what they weigh, what the fluid does to them, and what they must not run into.

use crate::error::RunError;
use crate::fluid::elastic::Coupled;
use crate::fluid::flow::Flow;
use crate::fluid::motion::Motion;
use crate::fluid::pass::Pair;
use crate::fluid::rigid::{Rigid, embed};
use crate::fluid::setup::{Body, BodyKind, Slip};
use crate::space::Grid;
use crate::vector::Vector;

/// How many times a wall shows its velocity to the fluid: once at the surface, and up to twice more continued behind it.
const SHOWN: f64 = 3.0;

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

    fn each_elastic(&mut self, mut act: impl FnMut(&mut Coupled<D>)) {
        for body in &mut self.bodies {
            if let BodyKind::Solid { motion: Motion::Elastic(coupled), .. } = &mut body.kind {
                act(coupled);
            }
        }
    }

    /// The elastic solids with their bodies, in the order of the setup.
    pub fn elastic_bodies(&self) -> impl Iterator<Item = (u8, &Coupled<D>)> + '_ {
        self.bodies.iter().zip(0_u8..).filter_map(|(body, number)| match &body.kind {
            BodyKind::Solid { motion: Motion::Elastic(coupled), .. } => Some((number, &**coupled)),
            _ => None,
        })
    }

    /// The elastic solid of a body, to be softened or grown.
    pub fn elastic_body_mut(&mut self, body: u8) -> Option<&mut Coupled<D>> {
        match self.bodies.get_mut(usize::from(body)).map(|body| &mut body.kind) {
            Some(BodyKind::Solid { motion: Motion::Elastic(coupled), .. }) => Some(coupled),
            _ => None,
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
            self.asks[number] |= self.bodies[number].is_elastic();
        }
    }

    /// Free and elastic bodies rest where they are.
    pub(super) fn hold_bodies(&mut self) {
        self.each_free(Rigid::hold);
        self.each_elastic(Coupled::hold);
    }

    /// Free and elastic bodies begin to move.
    pub(super) fn release_bodies(&mut self) {
        self.each_free(Rigid::release);
        self.each_elastic(Coupled::release);
    }

    /// The first half kick and the drift of the free and elastic bodies.
    pub(super) fn kick_and_drift_bodies(&mut self, dt: f64) -> Result<(), RunError> {
        self.each_free(|rigid| {
            rigid.kick(dt);
            rigid.drift(dt);
        });
        let (mut fault, step) = (Ok(()), self.steps);
        self.each_elastic(|coupled| {
            coupled.kick(dt);
            if fault.is_ok() {
                fault = coupled.drift(dt);
            }
        });
        fault.map_err(|fault| match fault {
            // In steps of the fluid; the particle is that of the solid.
            RunError::BlowUp { time, particle, quantity, value, remedy, .. } => {
                RunError::BlowUp { step, time, particle, quantity, value, remedy }
            }
            other => other,
        })
    }

    /// The forces of the fluid on the elastic solids and their weight, from the reactions just summed.
    fn load_elastic(&mut self) {
        let gravity = self.setup.gravity;
        for &i in &self.solids {
            let (side, rates) = (&self.sides[i as usize], &self.rates[i as usize]);
            let kind = &mut self.bodies[usize::from(side.body)].kind;
            if let BodyKind::Solid { motion: Motion::Elastic(coupled), .. } = kind {
                let row = self.rows[side.id as usize] as usize;
                let solid = coupled.solid_mut();
                let weight = gravity * solid.mass(row);
                solid.loads_mut()[row] = rates.force * side.volume + weight;
            }
        }
    }

    /// Force and torque on the free bodies from the reactions just summed.
    pub(super) fn load_bodies(&mut self, dt: f64) {
        self.load_elastic();
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

    /// The fastest rate at which friction takes velocity or spin from a free body or a particle of an elastic one, 1/s; with the fluid at rest, to which
    /// the body shows its velocity [`SHOWN`] times. Zero without one.
    pub(super) fn friction_rate_of_bodies(&self) -> f64 {
        if !self.bodies.iter().any(|body| body.is_free() || body.is_elastic()) {
            return 0.0;
        }
        let (a, makeup) = (self.terms.viscosity.a::<D>(), self.terms.makeup());
        let mut sums = vec![(0.0, 0.0); self.bodies.len()];
        // Of each particle of an elastic body; those that are held have no rate.
        let mut shaken = vec![0.0; self.sides.len()];
        for block in &self.blocks {
            for (row, near) in block.near_solid.iter().enumerate() {
                let side = &self.sides[block.first + row];
                if !near || side.is_solid() {
                    continue;
                }
                for c in block.row(row) {
                    let solid = &self.sides[c.j as usize];
                    let number = usize::from(solid.body);
                    let BodyKind::Solid { motion, .. } = &self.bodies[number].kind else { continue };
                    let pair = Pair::new(&c);
                    let rub = || {
                        let rub = self.terms.rub::<true>(makeup, &pair, side, solid);
                        SHOWN * a * rub * side.volume * solid.volume
                    };
                    match motion {
                        Motion::Free(rigid) => {
                            let rub = rub();
                            sums[number].0 += rub;
                            sums[number].1 += rub * rigid.arm(&self.positions[c.j as usize]).norm_squared();
                        }
                        Motion::Elastic(coupled) => {
                            let row = self.rows[solid.id as usize] as usize;
                            if !coupled.solid().is_held(row) {
                                shaken[c.j as usize] += rub() / coupled.solid().mass(row);
                            }
                        }
                        _ => {}
                    }
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
        let shaken = shaken.into_iter().fold(0.0, f64::max);
        self.bodies.iter().zip(sums).map(rate).fold(shaken, f64::max)
    }

    /// The second half kick of the free and elastic bodies.
    pub(super) fn kick_bodies(&mut self, dt: f64) {
        self.each_free(|rigid| rigid.kick(dt));
        let (passage, rest) = (self.kernel.cutoff() / self.sound_speed, self.setup.rest_density);
        self.each_elastic(|coupled| {
            coupled.kick(dt);
            // As for free bodies: a light one would shake.
            let density = coupled.solid().density();
            coupled.tell(dt, passage * (rest / density).max(1.0));
        });
    }

    /// A free or elastic body must not run into a wall of the box or another solid: nothing would keep it out. Elastic ones
    /// are asked for their free particles.
    pub(super) fn check_bodies(&self) -> Result<(), RunError> {
        let bent = self.bent();
        for &i in &self.solids {
            let (side, here) = (&self.sides[i as usize], &self.positions[i as usize]);
            let body = &self.bodies[usize::from(side.body)];
            let goes = match &body.kind {
                BodyKind::Solid { motion: Motion::Elastic(coupled), .. } => {
                    !coupled.solid().is_held(self.rows[side.id as usize] as usize)
                }
                _ => body.is_free(),
            };
            if !goes {
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
                // An elastic one is asked below.
                if number == side.body || other.is_elastic() {
                    continue;
                }
                let place = self.domain.wrap(&motion.origin(&self.domain.wrap(here), self.time));
                let distance = surface(&place);
                if distance < 0.0 {
                    let what = format!("distance (m) of the body `{}` from `{}`", body.name, other.name);
                    return Err(self.collision(i, what, distance));
                }
            }
            for (number, places, grid, least) in bent.iter().filter(|one| one.0 != side.body) {
                let mut nearest = *least;
                grid.for_each_near(here, places, |_, _, r2| nearest = nearest.min(r2.sqrt()));
                if nearest < *least {
                    let other = &self.bodies[usize::from(*number)].name;
                    let what =
                        format!("distance (m) of the body `{}` from a particle of `{other}`", body.name);
                    return Err(self.collision(i, what, nearest));
                }
            }
        }
        Ok(())
    }

    /// Where the particles of elastic bodies are, and how near (m) nothing else may come to them: half an edge. None where
    /// one body moves alone.
    fn bent(&self) -> Vec<(u8, Vec<Vector<D>>, Grid<D>, f64)> {
        if self.bodies.iter().filter(|body| body.is_free() || body.is_elastic()).count() < 2 {
            return Vec::new();
        }
        let all = self.elastic_bodies().map(|(number, coupled)| {
            let n = coupled.solid().len();
            let places: Vec<Vector<D>> =
                (0..n).map(|i| self.domain.wrap(&coupled.solid().position(i))).collect();
            let least = 0.5 * (0..n).map(|i| coupled.edge(i)).fold(0.0, f64::max);
            let grid = Grid::build(&places, &self.domain, least);
            (number, places, grid, least)
        });
        all.collect()
    }

    fn collision(&self, i: u32, quantity: String, value: f64) -> RunError {
        RunError::BlowUp {
            step: self.steps,
            time: self.time,
            particle: self.sides[i as usize].id as usize,
            quantity,
            value,
            remedy:
                "bodies that touch have no law of contact here: end the run before, or begin further away"
                    .to_owned(),
        }
    }
}
