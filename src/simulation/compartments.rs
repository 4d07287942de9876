//! Realizations in one volume or on a graph of volumes: event driven, or split where species are continuous.

use super::clock::{Interval, intervals};
use super::{FORWARD_EULER, NotReady, Outcome, Tally, Watch, euler_caveat, hybrids, paths};
use crate::chemistry::sampling_numbers::poisson;
use crate::chemistry::split::{
    Frozen, Modes, SplitState, SplittingError, longest_euler_step, splitting_error, step_bounds,
};
use crate::chemistry::ssa::next_subvolume::Graph;
use crate::chemistry::ssa::{Direct, EventMethod, NextReaction, NextSubvolume};
use crate::error::RunError;
use crate::model::{Integrator, Method};
use crate::plan::limits::{check_euler, check_steps};
use crate::plan::start::{Start, Voxels, check_amounts, start};
use crate::plan::{Compartments, Plan};
use crate::quantity::readable::show;
use crate::random::{Purpose, stream};
use crate::record::{StepRecord, StepsRecord};
use crate::samples::SeriesBlock;
use crate::sampling::{Observed, Sums};
use crate::vector::Vector;
use rayon::prelude::*;
use std::time::Instant;

/// A plan of compartments, ready to run.
pub struct Ready<'p> {
    plan: &'p Plan,
    arena: &'p Compartments,
    start: Start,
    sums: Sums<'p>,
    /// Frozen volumes and steps, if the method splits.
    split: Option<(Frozen, Vec<Interval>, String)>,
    /// Error of splitting and the time over which it was found, s.
    splitting: Option<(SplittingError, f64)>,
}

/// Parts of an output interval between which a realization can be stopped.
const SLICES: u32 = 8;

/// What one realization adds to the tally.
#[derive(Default)]
struct Share {
    observed: Observed,
    events: u64,
    hops: u64,
    supplied: Vec<f64>,
    lost: f64,
    modes: Modes,
    withheld: f64,
}

impl<'p> Ready<'p> {
    /// Works out the start and, where the method splits, the step.
    ///
    /// # Errors
    /// Too many steps.
    pub fn new(plan: &'p Plan, arena: &'p Compartments) -> Result<Ready<'p>, NotReady> {
        let positions = vec![Vector::zeros(); arena.volumes.len()];
        let places = Voxels {
            positions: &positions,
            volumes: &arena.volumes,
            home: &arena.home,
            current: &arena.home,
        };
        check_amounts(plan, &places)?;
        if arena.volumes.len() > 1 {
            let frozen =
                Frozen::build(&plan.reactor, &arena.links, &arena.volumes, &arena.home, &arena.home, &[])?;
            let groups: Vec<usize> = (0..arena.volumes.len()).collect();
            paths::check(plan, &frozen, &groups)?;
        }
        let start = start(plan, &places);
        let slot = (0..arena.volumes.len() as u32).collect();
        let sums = Sums::new(plan, slot, &arena.volumes, arena.volumes.len());
        let split = match arena.method {
            Method::Split => Some(split(plan, arena, &start)?),
            Method::Direct | Method::NextReaction | Method::NextSubvolume => None,
        };
        let euler = plan.model.chemistry.integrator == Integrator::Euler;
        let splitting = split.as_ref().filter(|_| !euler).and_then(|(frozen, clock, _)| {
            let longest = clock.iter().map(Interval::tick).fold(0.0, f64::max);
            let ticks: u64 = clock.iter().map(|i| i.ticks).sum();
            let error = splitting_error(&plan.reactor, frozen, &start.means(), (longest, ticks), None)?;
            Some((error, error.steps as f64 * longest))
        });
        Ok(Ready { plan, arena, start, sums, split, splitting })
    }

    /// Method and steps.
    #[must_use]
    pub fn steps(&self) -> StepsRecord {
        let method = match self.arena.method {
            Method::Direct => "direct method (Gillespie 1976), exact",
            Method::NextReaction => "next reaction method (Gibson & Bruck 2000), exact",
            Method::NextSubvolume => "next subvolume method (Elf & Ehrenberg 2004), exact",
            Method::Split if self.plan.model.chemistry.integrator == Integrator::Euler => FORWARD_EULER,
            Method::Split => "diffusion and reaction in turn, Strang splitting",
        };
        let chemistry = self.split.as_ref().map(|(_, clock, limited_by)| StepRecord {
            step: clock.iter().map(Interval::tick).fold(0.0, f64::max),
            count: clock.iter().map(|i| i.ticks).sum(),
            limited_by: limited_by.clone(),
        });
        let euler = self.plan.model.chemistry.integrator == Integrator::Euler;
        let in_time = chemistry.as_ref().filter(|_| euler || self.arena.volumes.len() > 1).map(|step| {
            if euler {
                return euler_caveat(step.step);
            }
            format!(
                "splitting of diffusion and reaction: second order in the step of {}",
                show(step.step, "s")
            )
        });
        let approximations = hybrids::approximations(self.plan, in_time, self.splitting.as_ref());
        StepsRecord {
            fluid: None,
            chemistry,
            method: method.into(),
            approximations,
            shared_flow: false,
            splitting_error: self.splitting.map(|(error, _)| error.relative),
        }
    }

    /// The series at the start, with means where amounts are dealt.
    #[must_use]
    pub fn first_look(&self) -> SeriesBlock {
        let mut block = SeriesBlock::default();
        self.sums.look(&self.start.means(), &mut block);
        block
    }

    /// Runs realizations; those that finish are kept whatever befalls others.
    #[must_use]
    pub fn run(self, realizations: &[u32], watch: &Watch) -> Outcome {
        watch.begin(realizations.len() as u64, "realizations");
        let begun = Instant::now();
        let found: Vec<Result<Option<Share>, RunError>> = realizations
            .par_iter()
            .map(|&number| {
                let share = if watch.stopped() { None } else { self.one(number, watch)? };
                watch.advance(1);
                Ok(share)
            })
            .collect();
        let mut tally = Tally {
            steps: self.steps(),
            chemistry_seconds: begun.elapsed().as_secs_f64(),
            supplied: vec![0.0; self.plan.reactor.species.len()],
            ..Tally::default()
        };
        let groups: Vec<usize> = (0..self.arena.volumes.len()).collect();
        let shares = || found.iter().filter_map(|result| result.as_ref().ok()?.as_ref());
        tally.hybrid = hybrids::history(self.plan, shares().map(|share| &share.modes), &groups);
        tally.withheld = shares().map(|share| share.withheld).sum();
        let mut outcome = Outcome { times: self.plan.model.output.times.len(), ..Outcome::default() };
        for result in found {
            match result {
                Ok(Some(share)) => {
                    tally.reaction_events += share.events;
                    tally.hops += share.hops;
                    tally.lost += share.lost;
                    tally.supplied.iter_mut().zip(&share.supplied).for_each(|(sum, n)| *sum += n);
                    outcome.observed.push(share.observed);
                }
                Ok(None) => outcome.interrupted = true,
                Err(error) => outcome.error = outcome.error.or(Some(error)),
            }
        }
        outcome.tally = tally;
        outcome
    }

    /// One realization; `None` if it was stopped.
    fn one(&self, number: u32, watch: &Watch) -> Result<Option<Share>, RunError> {
        let (plan, arena) = (self.plan, self.arena);
        let seed = plan.model.run.seed;
        let mut amounts = self.start.amounts.clone();
        let mut random = stream(seed, u64::from(number), Purpose::Deal);
        for &(index, mean) in &self.start.poisson {
            amounts[index as usize] += poisson(&mut random, mean) as f64;
        }
        let key = (seed, u64::from(number));
        // The methods of one volume look at the first, which is all there is.
        let (volume, home) = (arena.volumes[0], arena.home[0]);
        match arena.method {
            Method::Direct => {
                self.play(number, Direct::new(&plan.reactor, volume, home, &[], amounts, key)?, watch)
            }
            Method::NextReaction => {
                self.play(number, NextReaction::new(&plan.reactor, volume, home, &[], amounts, key)?, watch)
            }
            Method::NextSubvolume => {
                let graph = Graph {
                    volumes: &arena.volumes,
                    links: &arena.links,
                    home: &arena.home,
                    current: &arena.home,
                    held: &[],
                };
                self.play(number, NextSubvolume::new(&plan.reactor, graph, amounts, key)?, watch)
            }
            Method::Split => {
                self.step(number, SplitState::new(&plan.reactor, amounts, seed, u64::from(number)), watch)
            }
        }
    }

    fn play(
        &self,
        number: u32,
        mut method: impl EventMethod,
        watch: &Watch,
    ) -> Result<Option<Share>, RunError> {
        let mut observed = Observed::new(number);
        let start = totals(self.plan, method.amounts());
        for &time in &self.plan.model.output.times {
            // Slices only so that the wish to stop is heard; the course of events does not depend on them.
            let begun = method.time();
            for slice in 1..=SLICES {
                if watch.stopped() {
                    return Ok(None);
                }
                let part = begun + (time - begun) * f64::from(slice) / f64::from(SLICES);
                method.advance(if slice == SLICES { time } else { part })?;
            }
            self.sums.look(method.amounts(), &mut observed.series);
        }
        let end = totals(self.plan, method.amounts());
        let fired = method.fired();
        let lost = (0..start.len())
            .map(|s| (end[s] - start[s] - self.plan.reactor.made(fired, s) - method.supplied()[s]).abs())
            .sum();
        let counters = method.counters();
        Ok(Some(Share {
            observed,
            events: counters.events,
            hops: counters.hops,
            supplied: method.supplied().to_vec(),
            lost,
            ..Share::default()
        }))
    }

    fn step(&self, number: u32, mut state: SplitState, watch: &Watch) -> Result<Option<Share>, RunError> {
        let mut observed = Observed::new(number);
        let Some((frozen, clock, _)) = &self.split else { return Ok(None) };
        let start = totals(self.plan, &state.amounts);
        for interval in clock {
            for k in 0..interval.ticks {
                if watch.stopped() {
                    return Ok(None);
                }
                let (reactor, time, tick) = (&self.plan.reactor, interval.time(k), interval.tick());
                match self.plan.model.chemistry.integrator {
                    Integrator::Exponential => state.step(reactor, frozen, time, tick)?,
                    Integrator::Euler => state.euler(reactor, frozen, time, tick)?,
                }
            }
            self.sums.look(&state.amounts, &mut observed.series);
        }
        let off =
            |s: usize| state.total(s) - start[s] - state.made(&self.plan.reactor, s) - state.supplied[s];
        let lost = (0..start.len())
            .filter(|&s| self.plan.reactor.discrete[s])
            .map(|s| off(s).abs())
            // Amounts of a hybrid species are not whole; less than a thousandth of a molecule is rounding.
            .filter(|off| *off >= 1e-3)
            .sum();
        Ok(Some(Share {
            observed,
            events: state.counters.events,
            hops: state.counters.hops,
            supplied: state.supplied.clone(),
            lost,
            withheld: state.withheld,
            modes: state.modes,
        }))
    }
}

/// Molecules of each species in all volumes.
fn totals(plan: &Plan, amounts: &[f64]) -> Vec<f64> {
    let count = plan.reactor.species.len();
    (0..count).map(|s| amounts.iter().skip(s).step_by(count).sum()).collect()
}

fn split(
    plan: &Plan,
    arena: &Compartments,
    start: &Start,
) -> Result<(Frozen, Vec<Interval>, String), NotReady> {
    let frozen = Frozen::build(&plan.reactor, &arena.links, &arena.volumes, &arena.home, &arena.home, &[])?;
    let chemistry = &plan.model.chemistry;
    check_euler(&plan.model, longest_euler_step(&plan.reactor, &frozen))?;
    let bounds = step_bounds(&plan.reactor, &frozen, &start.means(), chemistry.hops, chemistry.change);
    let until = plan.model.run.until;
    let (step, limited_by) = match chemistry.step {
        Some(step) => (step, "the step given in the model".to_string()),
        None if bounds.step() > until => (until, "the output times".to_string()),
        None => (bounds.step(), bounds.limited_by().to_string()),
    };
    check_steps(&plan.model.places.chemistry, "chemistry", step, &limited_by, until)?;
    Ok((frozen, intervals(&plan.model.output.times, step, None), limited_by))
}
