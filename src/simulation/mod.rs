//! Realizations: the flow and the chemistry in turn, observed at the output times.

mod at_rest;
pub mod clock;
pub mod compartments;
mod events;
mod freeze;
mod hybrids;
pub mod particles;
mod paths;
mod realization;
pub mod watch;

use crate::error::{ModelError, RunError};
use crate::plan::{Arena, Plan};
use crate::quantity::readable::show;
use crate::record::{FluidRecord, HybridRecord, StepsRecord, TemperatureRecord};
use crate::sampling::Observed;

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

/// Counts and checks of a block.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub steps: StepsRecord,
    pub reaction_events: u64,
    pub hops: u64,
    pub particle_steps: u64,
    pub pair_evaluations: u64,
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
    /// What a user should know, from chemistry and flow.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let flow = self.flow.iter().flat_map(|flow| flow.warnings.iter().cloned());
        flow.chain(hybrids::withheld(self.withheld)).chain(hybrids::coarse(&self.steps)).collect()
    }
}

/// What the flow says of itself.
#[derive(Clone, Debug, Default)]
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
}

impl FlowTally {
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

    /// Runs realizations and watches them; returns what was finished even if something stops it.
    pub fn run(self, realizations: &[u32], watch: &Watch) -> Outcome {
        match self {
            Ready::Compartments(ready) => ready.run(realizations, watch),
            Ready::Line(ready) => ready.run(realizations, watch),
            Ready::Plane(ready) => ready.run(realizations, watch),
            Ready::Space(ready) => ready.run(realizations, watch),
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
