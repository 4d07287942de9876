//! Realizations: the flow and the chemistry in turn, observed at the output times.

mod at_rest;
pub mod clock;
pub mod compartments;
mod each;
mod events;
mod freeze;
mod hybrids;
pub mod keep;
pub mod particles;
mod paths;
mod realization;
mod states;
mod walk;
pub mod watch;

use crate::error::{ModelError, RunError};
use crate::plan::{Arena, Plan};
use crate::quantity::readable::show;
use crate::record::{FluidRecord, HybridRecord, SolidRecord, StepsRecord, TemperatureRecord};
use crate::sampling::Observed;
use keep::Memory;
use serde::{Deserialize, Serialize};

pub use keep::{CourseShare, Keep, Piece, Share};
pub use watch::Watch;

/// The method where forward Euler was asked for by name.
const FORWARD_EULER: &str = "rate equations, forward Euler on diffusion and reactions together";

/// What is approximate about it.
fn euler_caveat(step: f64) -> String {
    format!("forward Euler: first order in the step of {}", show(step, "s"))
}

/// What a block of realizations came to.
#[derive(Debug, Default)]
pub struct Outcome {
    /// In order of realization; all have seen the same number of output times.
    pub observed: Vec<Observed>,
    /// Output times seen; fewer than asked for if the block was stopped.
    pub times: usize,
    pub tally: Tally,
    /// What stopped the block, if the numbers did.
    pub error: Option<RunError>,
    pub interrupted: bool,
}

/// How a block of realizations ended.
#[derive(Debug, Default)]
pub struct Finish {
    /// What stopped a realization, if something did; of the first one in number.
    pub error: Option<RunError>,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// Counts and checks of a block.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub steps: StepsRecord,
    pub reaction_events: u64,
    pub hops: u64,
    pub particle_steps: u64,
    pub pair_evaluations: u64,
    pub solid_particle_steps: u64,
    pub bond_evaluations: u64,
    pub fluid_seconds: f64,
    pub chemistry_seconds: f64,
    /// Net molecules brought in by reservoirs, by species.
    pub supplied: Vec<f64>,
    /// Sum over realizations and species of |end - start - reactions - supplied|.
    pub lost: f64,
    pub flow: Option<FlowTally>,
    pub hybrid: Vec<HybridRecord>,
    /// Expected events that did not happen for want of a whole molecule of a continuous species.
    pub withheld: f64,
}

impl Tally {
    /// The books of no realization yet, of a model with `species`.
    #[must_use]
    pub fn new(steps: StepsRecord, species: usize) -> Tally {
        Tally { steps, supplied: vec![0.0; species], ..Tally::default() }
    }

    /// Takes in what a realization adds.
    pub fn take(&mut self, share: &Share) {
        self.reaction_events += share.counters.events;
        self.hops += share.counters.hops;
        self.supplied.iter_mut().zip(&share.supplied).for_each(|(sum, n)| *sum += n);
        self.lost += share.lost;
        self.withheld += share.withheld;
        self.chemistry_seconds += share.seconds;
        if self.hybrid.is_empty() {
            self.hybrid.clone_from(&share.hybrid);
        } else {
            self.hybrid.iter_mut().zip(&share.hybrid).for_each(|(own, other)| own.absorb(other));
        }
    }

    /// Takes in what a flow came to. A shared flow that is run again for more realizations counts the same again.
    pub fn take_course(&mut self, course: &CourseShare) {
        self.fluid_seconds += course.fluid_seconds;
        self.chemistry_seconds += course.chemistry_seconds;
        self.particle_steps += course.particle_steps;
        self.pair_evaluations += course.pair_evaluations;
        self.solid_particle_steps += course.solid_particle_steps;
        self.bond_evaluations += course.bond_evaluations;
        match &mut self.flow {
            Some(flow) if self.steps.shared_flow => flow.absorb_same(course.flow.clone()),
            Some(flow) => flow.absorb(course.flow.clone()),
            None => self.flow = Some(course.flow.clone()),
        }
    }

    /// What a user should know, from chemistry and flow.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let flow = self.flow.iter().flat_map(|flow| flow.warnings.iter().cloned());
        flow.chain(hybrids::withheld(self.withheld)).chain(hybrids::coarse(&self.steps)).collect()
    }
}

/// What the flow says of itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlowTally {
    /// Where nothing but body forces acts on the fluid from outside.
    pub momentum_drift: Option<f64>,
    pub penetrations: u64,
    pub bounces: u64,
    pub largest_mach: f64,
    pub largest_density_change: f64,
    pub warnings: Vec<String>,
    /// With thermal noise.
    pub temperature: Option<TemperatureRecord>,
    /// Of elastic solids.
    pub largest_stretch: Option<f64>,
}

impl FlowTally {
    /// Takes in the same flow, run again or further: what it counts is no sum.
    pub(crate) fn absorb_same(&mut self, other: FlowTally) {
        let (penetrations, bounces) = (self.penetrations, self.bounces);
        let (later, again) = (penetrations.max(other.penetrations), bounces.max(other.bounces));
        self.absorb(other);
        (self.penetrations, self.bounces) = (later, again);
    }

    /// Takes in another flow, of another realization.
    pub(crate) fn absorb(&mut self, other: FlowTally) {
        self.penetrations += other.penetrations;
        self.bounces += other.bounces;
        self.largest_mach = self.largest_mach.max(other.largest_mach);
        self.largest_density_change = self.largest_density_change.max(other.largest_density_change);
        self.momentum_drift = match (self.momentum_drift, other.momentum_drift) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
        self.largest_stretch = match (self.largest_stretch, other.largest_stretch) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
        TemperatureRecord::join(&mut self.temperature, other.temperature);
        for warning in other.warnings {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
    }
}

/// A plan whose steps are chosen: ready to run, nothing written yet.
pub enum Ready<'p> {
    Compartments(Box<compartments::Ready<'p>>),
    Line(Box<particles::Ready<'p, 1>>),
    Plane(Box<particles::Ready<'p, 2>>),
    Space(Box<particles::Ready<'p, 3>>),
}

impl<'p> Ready<'p> {
    /// Builds flow and chemistry at the start and chooses the steps.
    ///
    /// # Errors
    /// A run that would need too many steps, or a flow that cannot be built.
    pub fn new(plan: &'p Plan) -> Result<Ready<'p>, NotReady> {
        Ok(match &plan.arena {
            Arena::Compartments(arena) => {
                Ready::Compartments(Box::new(compartments::Ready::new(plan, arena)?))
            }
            Arena::Line(arena) => Ready::Line(Box::new(particles::Ready::new(plan, arena)?)),
            Arena::Plane(arena) => Ready::Plane(Box::new(particles::Ready::new(plan, arena)?)),
            Arena::Space(arena) => Ready::Space(Box::new(particles::Ready::new(plan, arena)?)),
        })
    }

    /// Steps and what limits them.
    #[must_use]
    pub fn steps(&self) -> StepsRecord {
        match self {
            Ready::Compartments(ready) => ready.steps(),
            Ready::Line(ready) => ready.steps(),
            Ready::Plane(ready) => ready.steps(),
            Ready::Space(ready) => ready.steps(),
        }
    }

    /// The fluid and its numbers, if anything flows.
    #[must_use]
    pub fn fluid(&self) -> Option<FluidRecord> {
        match self {
            Ready::Compartments(_) => None,
            Ready::Line(ready) => ready.fluid(),
            Ready::Plane(ready) => ready.fluid(),
            Ready::Space(ready) => ready.fluid(),
        }
    }

    /// The elastic solids and their numbers.
    #[must_use]
    pub fn solids(&self) -> Vec<SolidRecord> {
        match self {
            Ready::Compartments(_) => Vec::new(),
            Ready::Line(ready) => ready.solids(),
            Ready::Plane(ready) => ready.solids(),
            Ready::Space(ready) => ready.solids(),
        }
    }

    /// Warnings of walls that would grow beyond measure in one chemistry step.
    #[must_use]
    pub fn rash_growth(&self) -> Vec<String> {
        match self {
            Ready::Compartments(_) => Vec::new(),
            Ready::Line(ready) => ready.rash_growth(),
            Ready::Plane(ready) => ready.rash_growth(),
            Ready::Space(ready) => ready.rash_growth(),
        }
    }

    /// A warning if the chemistry step is too long.
    #[must_use]
    pub fn coarse(&self) -> Option<String> {
        hybrids::coarse(&self.steps())
    }

    /// Amounts at the start that are not zero: group, species, molecules (means where they are dealt).
    #[must_use]
    pub fn amounts(&self, plan: &Plan) -> Vec<(String, String, f64)> {
        let block = match self {
            Ready::Compartments(ready) => ready.first_look(),
            Ready::Line(ready) => ready.first_look(),
            Ready::Plane(ready) => ready.first_look(),
            Ready::Space(ready) => ready.first_look(),
        };
        plan.columns
            .iter()
            .zip(block.amount)
            .filter(|(_, amount)| *amount != 0.0)
            .map(|(column, amount)| {
                (plan.group_name(column), plan.reactor.species[column.species].clone(), amount)
            })
            .collect()
    }

    /// Runs realizations and keeps what they show in memory; what was finished comes back even if something stops
    /// it, and of realizations that march together also how far they came.
    #[must_use]
    pub fn run(self, realizations: &[u32], watch: &Watch) -> Outcome {
        let memory = Memory::default();
        let finish = self.run_into(realizations, watch, &memory);
        let (plan, kept) = (self.plan(), memory.into_kept());
        let mut tally = Tally::new(self.steps(), plan.reactor.species.len());
        tally.fluid_seconds = self.settling_seconds();
        kept.shares.values().for_each(|share| tally.take(share));
        kept.courses.iter().for_each(|course| tally.take_course(course));
        let all = plan.model.output.times.len();
        let mut observed: Vec<Observed> = kept.observed.into_values().collect();
        let mut times = all;
        if kept.shares.is_empty() {
            // How far all of them came that came so far together.
            times = observed.iter().map(|one| one.outputs as usize).min().unwrap_or(0);
        } else {
            observed.retain(|one| kept.shares.contains_key(&one.series.realization));
        }
        Outcome { observed, times, tally, error: finish.error, interrupted: finish.interrupted }
    }

    /// Runs realizations and hands what they show to `keep`. May be called again for others.
    #[must_use]
    pub fn run_into(&self, realizations: &[u32], watch: &Watch, keep: &dyn Keep) -> Finish {
        match self {
            Ready::Compartments(ready) => ready.run_into(realizations, watch, keep),
            Ready::Line(ready) => ready.run_into(realizations, watch, keep),
            Ready::Plane(ready) => ready.run_into(realizations, watch, keep),
            Ready::Space(ready) => ready.run_into(realizations, watch, keep),
        }
    }

    /// Time spent to let the flow settle, s.
    #[must_use]
    pub fn settling_seconds(&self) -> f64 {
        match self {
            Ready::Compartments(_) => 0.0,
            Ready::Line(ready) => ready.settling_seconds(),
            Ready::Plane(ready) => ready.settling_seconds(),
            Ready::Space(ready) => ready.settling_seconds(),
        }
    }

    fn plan(&self) -> &'p Plan {
        match self {
            Ready::Compartments(ready) => ready.plan,
            Ready::Line(ready) => ready.plan,
            Ready::Plane(ready) => ready.plan,
            Ready::Space(ready) => ready.plan,
        }
    }
}

/// Why a plan cannot be run.
#[derive(Clone, Debug, thiserror::Error)]
pub enum NotReady {
    /// The model asks for too much.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The flow could not be built.
    #[error(transparent)]
    Run(#[from] RunError),
}
