//! One realization on particles: the parts of a chemistry step, and what surrounds it.

use super::keep::{Keep, hand_over};
use super::walk::share;
use crate::chemistry::split::{Frozen, Snapshot, SplitState};
use crate::error::RunError;
use crate::model::Integrator;
use crate::plan::Plan;
use crate::plan::start::{Start, sponge_targets};
use crate::sampling::Observed;
use crate::scene::Scene;
use crate::solid::Birth;
use serde::{Deserialize, Serialize};

/// What all realizations share on one geometry.
pub(super) struct Surroundings<'a> {
    pub plan: &'a Plan,
    pub frozen: &'a Frozen,
    pub reservoirs: &'a Reservoirs,
    pub start: &'a Start,
}

/// What the sponges do on one geometry.
pub(super) struct Reservoirs {
    pub sponges: Vec<Sponge>,
}

/// A sponge for one species: rate (1/s), and the target (molecules) in each voxel.
pub(super) struct Sponge {
    pub species: usize,
    pub rate: f64,
    pub voxels: Vec<u32>,
    pub targets: Vec<f64>,
}

/// What a step of the flow took out of the box and brought in.
#[derive(Default)]
pub(super) struct Exchange {
    left: Vec<u32>,
    /// Species, the particles that carry it in, and mean molecules in each.
    entered: Vec<(usize, Vec<u32>, Vec<f64>)>,
    /// Particles that came into being, and their home groups.
    births: Vec<(Birth, u8)>,
}

impl Exchange {
    /// Works out the particles that crossed an open end since the scene was looked at before.
    pub fn new<const D: usize>(plan: &Plan, scene: &Scene<D>) -> Exchange {
        let births = scene.births.iter().map(|birth| (*birth, scene.home[birth.particle])).collect();
        let Some(openings) = &scene.plan.openings else {
            return Exchange { births, ..Exchange::default() };
        };
        let places = scene.places();
        let mut entered = Vec::new();
        for (particles, carried) in scene.crossings.entered.iter().zip(&openings.carried) {
            for (species, amount) in carried {
                let holds = |i: &u32| plan.reactor.habitat[*species].holds(scene.home[*i as usize]);
                let voxels: Vec<u32> = particles.iter().copied().filter(holds).collect();
                let means = sponge_targets(&places, &voxels, amount);
                entered.push((*species, voxels, means));
            }
        }
        Exchange { left: scene.crossings.left.clone(), entered, births }
    }
}

impl Reservoirs {
    /// Works out voxels and targets of a scene.
    pub fn new<const D: usize>(plan: &Plan, scene: &Scene<D>) -> Reservoirs {
        let places = scene.places();
        let mut sponges = Vec::new();
        for sponge in &scene.plan.sponges {
            for (species, amount) in &sponge.species {
                let voxels: Vec<u32> = scene
                    .members(sponge.group)
                    .into_iter()
                    .filter(|&i| plan.reactor.habitat[*species].holds(scene.home[i as usize]))
                    .collect();
                let targets = sponge_targets(&places, &voxels, amount);
                sponges.push(Sponge { species: *species, rate: sponge.rate, voxels, targets });
            }
        }
        Reservoirs { sponges }
    }
}

/// What is kept of a realization to go on with it later.
#[derive(Serialize, Deserialize)]
pub(super) struct Image {
    state: Snapshot,
    total: Vec<f64>,
    observed: Observed,
}

/// A realization under way.
pub(super) struct Realization {
    pub state: SplitState,
    /// Molecules of each species at the start.
    pub total: Vec<f64>,
    pub observed: Observed,
}

impl Realization {
    /// Realization `number` at t = 0.
    pub fn new(plan: &Plan, start: &Start, number: u32) -> Realization {
        let (seed, realization) = (plan.model.run.seed, u64::from(number));
        let state = SplitState::new(&plan.reactor, start.deal((seed, realization)), seed, realization);
        let mut one = Realization { state, total: Vec::new(), observed: Observed::new(number) };
        one.deal_held(plan, start);
        // What is dealt at the start is there from the start.
        one.state.supplied.fill(0.0);
        one.total = (0..plan.reactor.species.len()).map(|s| one.state.total(s)).collect();
        one
    }

    /// What must be kept to go on later.
    pub fn image(&self) -> Image {
        let (total, observed) = (self.total.clone(), self.observed.clone());
        Image { state: self.state.snapshot(), total, observed }
    }

    /// The realization as it was; `None` if the image belongs to another plan.
    pub fn restore(plan: &Plan, image: Image) -> Option<Realization> {
        let state = SplitState::resume(&plan.reactor, image.state)?;
        let fits = image.total.len() == plan.reactor.species.len();
        fits.then_some(Realization { state, total: image.total, observed: image.observed })
    }

    /// Hands over what is left, and the books if it `arrived` at its end. `groups`: group and home group of each
    /// voxel.
    pub fn conclude(
        mut self,
        plan: &Plan,
        keep: &dyn Keep,
        arrived: bool,
        groups: (&[usize], &[u8]),
    ) -> Result<(), RunError> {
        hand_over(&mut self.observed, keep, 0)?;
        if arrived {
            keep.finished(self.observed.series.realization, share(plan, &self, groups))?;
        }
        Ok(())
    }

    /// Memory it takes, bytes, roughly.
    pub fn bytes(&self) -> usize {
        // Clocks and the modes of hybrid species come with the amounts.
        16 * self.state.amounts.len() + 1024
    }

    /// The half of a step before the particles move: sponges, reactions, diffusion.
    pub fn before_motion(&mut self, around: &Surroundings, time: f64, half: f64) -> Result<(), RunError> {
        self.feed(around, half);
        self.state.react(&around.plan.reactor, around.frozen, time, half)?;
        self.state.diffuse(&around.plan.reactor, around.frozen, time, half)
    }

    /// Molecules leave and enter with the particles that cross an open end.
    /// Those of particles that divide are shared out.
    pub fn cross(&mut self, plan: &Plan, start: &Start, exchange: &Exchange) {
        for birth in &exchange.births {
            let (birth, home) = birth;
            self.state.divide(&plan.reactor, &start.held, (birth.particle, *home), &birth.donors);
        }
        self.state.empty(&exchange.left);
        for (species, voxels, means) in &exchange.entered {
            self.state.enter(&plan.reactor, voxels, *species, means);
        }
    }

    /// The half of a step after the particles moved, in the opposite order.
    pub fn after_motion(&mut self, around: &Surroundings, time: f64, half: f64) -> Result<(), RunError> {
        self.state.diffuse(&around.plan.reactor, around.frozen, time, half)?;
        self.state.react(&around.plan.reactor, around.frozen, time, half)?;
        self.feed(around, half);
        self.deal_held(around.plan, around.start);
        self.hold_in_solids(around);
        Ok(())
    }

    /// A whole step on particles that do not move: the two halves of diffusion are one, or all is one of Euler's.
    pub fn step_at_rest(&mut self, around: &Surroundings, time: f64, tick: f64) -> Result<(), RunError> {
        self.feed(around, 0.5 * tick);
        let (reactor, frozen) = (&around.plan.reactor, around.frozen);
        match around.plan.model.chemistry.integrator {
            Integrator::Exponential => self.state.step(reactor, frozen, time, tick)?,
            Integrator::Euler => self.state.euler(reactor, frozen, time, tick)?,
        }
        self.feed(around, 0.5 * tick);
        self.deal_held(around.plan, around.start);
        Ok(())
    }

    /// Sponges act for `dt` seconds.
    fn feed(&mut self, around: &Surroundings, dt: f64) {
        for sponge in &around.reservoirs.sponges {
            let pull = (sponge.rate, sponge.targets.as_slice());
            self.state.sponge(
                (&around.plan.reactor, around.frozen),
                &sponge.voxels,
                sponge.species,
                pull,
                dt,
            );
        }
    }

    /// Draws held Poisson amounts anew.
    fn deal_held(&mut self, plan: &Plan, start: &Start) {
        for (s, voxels, means) in &start.held_poisson {
            self.state.deal_held(&plan.reactor, voxels, *s, means);
        }
    }

    /// Brings held concentrations to what they are in the volumes of now.
    pub fn hold_in_solids(&mut self, around: &Surroundings) {
        let reactor = &around.plan.reactor;
        for held in &around.start.held_in_solids {
            let of = |(&voxel, c): (&u32, &f64)| {
                let amount = c * around.frozen.scales[voxel as usize].molar;
                if reactor.discrete[held.species] && !held.poisson { amount.round() } else { amount }
            };
            let amounts: Vec<f64> = held.voxels.iter().zip(&held.concentrations).map(of).collect();
            if held.poisson {
                self.state.deal_held(reactor, &held.voxels, held.species, &amounts);
            } else {
                self.state.hold(&held.voxels, held.species, &amounts);
            }
        }
    }
}
