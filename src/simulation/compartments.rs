//! Realizations in one volume or on a graph of volumes: event driven, or split where species are continuous.

use super::clock::{Interval, intervals};
use super::events::{self, Share};
use super::{FORWARD_EULER, NotReady, Outcome, Tally, Watch, euler_caveat, hybrids, paths};
use crate::chemistry::split::{
    Frozen, SplitState, SplittingError, longest_euler_step, splitting_error, step_bounds,
};
use crate::chemistry::ssa::side_by_side::{Task, fits, side_by_side};
use crate::chemistry::ssa::{Key, System};
use crate::error::RunError;
use crate::model::{Integrator, Method};
use crate::plan::limits::{check_euler, check_steps};
use crate::plan::start::{Start, Voxels, check_amounts, start};
use crate::plan::{Compartments, Plan};
use crate::quantity::readable::show;
use crate::record::{StepRecord, StepsRecord};
use crate::samples::SeriesBlock;
use crate::sampling::{Observed, Sums};
use crate::vector::Vector;
use rayon::prelude::*;
use std::time::Instant;

/// What a realization came to; `None` if it was stopped.
type Found = Result<Option<(Share, Observed)>, RunError>;

/// A plan of compartments, ready to run.
pub struct Ready<'p> {
    plan: &'p Plan,
    arena: &'p Compartments,
    start: Start,
    sums: Sums<'p>,
    frozen: Frozen,
    /// Steps, if the method splits, and what limits them.
    split: Option<(Vec<Interval>, String)>,
    /// Error of splitting and the time over which it was found, s.
    splitting: Option<(SplittingError, f64)>,
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
        let start = start(plan, &places);
        let slot = (0..arena.volumes.len() as u32).collect();
        let sums = Sums::new(plan, slot, &arena.volumes, arena.volumes.len());
        let frozen =
            Frozen::build(&plan.reactor, &arena.links, &arena.volumes, &arena.home, &arena.home, &[])?;
        if arena.volumes.len() > 1 {
            let groups: Vec<usize> = (0..arena.volumes.len()).collect();
            paths::check(plan, &frozen, &groups)?;
        }
        let split = match arena.method {
            Method::Split => Some(split(plan, &frozen, &start)?),
            _ => None,
        };
        let euler = plan.model.chemistry.integrator == Integrator::Euler;
        let splitting = split.as_ref().filter(|_| !euler).and_then(|(clock, _)| {
            let longest = clock.iter().map(Interval::tick).fold(0.0, f64::max);
            let ticks: u64 = clock.iter().map(|i| i.ticks).sum();
            let error = splitting_error(&plan.reactor, &frozen, &start.means(), (longest, ticks), None)?;
            Some((error, error.steps as f64 * longest))
        });
        Ok(Ready { plan, arena, start, sums, frozen, split, splitting })
    }

    /// Method and steps.
    #[must_use]
    pub fn steps(&self) -> StepsRecord {
        let chemistry = self.split.as_ref().map(|(clock, limited_by)| {
            let step = clock.iter().map(Interval::tick).fold(0.0, f64::max);
            let wanted = self.plan.model.chemistry.step.unwrap_or(step);
            StepRecord {
                step,
                count: clock.iter().map(|i| i.ticks).sum(),
                limited_by: if step < 0.5 * wanted { "the output times".into() } else { limited_by.clone() },
            }
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
        let mut approximations = hybrids::approximations(self.plan, in_time, self.splitting.as_ref());
        approximations.extend(events::approximations(self.arena.method, &self.plan.model.chemistry));
        StepsRecord {
            fluid: None,
            chemistry,
            method: if euler { FORWARD_EULER } else { events::words(self.arena.method) }.into(),
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
        let system = System::new(&self.plan.reactor, &self.frozen);
        // Parts small enough to keep all threads busy to the end, large enough to be worth the handing out.
        let part = (realizations.len() / (8 * rayon::current_num_threads())).clamp(1, 64);
        let found: Vec<Found> = realizations
            .par_chunks(part)
            .flat_map_iter(|numbers| self.several(&system, numbers, watch))
            .collect();
        let mut tally = Tally {
            steps: self.steps(),
            chemistry_seconds: begun.elapsed().as_secs_f64(),
            supplied: vec![0.0; self.plan.reactor.species.len()],
            ..Tally::default()
        };
        let groups: Vec<usize> = (0..self.arena.volumes.len()).collect();
        let shares = || found.iter().filter_map(|result| Some(&result.as_ref().ok()?.as_ref()?.0));
        tally.hybrid =
            hybrids::history(self.plan, shares().map(|share| &share.modes), (&groups, &self.arena.home));
        tally.withheld = shares().map(|share| share.withheld).sum();
        events::gather(found, tally, self.plan.model.output.times.len())
    }

    /// A few realizations on one thread.
    fn several(&self, system: &System, numbers: &[u32], watch: &Watch) -> Vec<Found> {
        if self.arena.method != Method::Direct || !fits(system) {
            let one = |&number: &u32| {
                let found = if watch.stopped() { Ok(None) } else { self.one(system, number, watch) };
                watch.advance(1);
                found.map_err(|error| error.of(number))
            };
            return numbers.iter().map(one).collect();
        }
        let mut observed: Vec<Observed> = numbers.iter().map(|&number| Observed::new(number)).collect();
        let task = Task {
            count: numbers.len(),
            halts: &events::halts(&self.plan.model.output.times),
            start: &|k| (self.start.deal(self.key(numbers[k])), self.key(numbers[k])),
            stopped: &|| watch.stopped(),
        };
        let played =
            side_by_side(system, &task, |k, amounts| self.sums.look(amounts, &mut observed[k].series));
        watch.advance(numbers.len() as u64);
        let found = played.into_iter().zip(observed).zip(numbers);
        found
            .map(|((played, seen), &number)| {
                let begun = || events::free_totals(system, &self.start.deal(self.key(number)));
                let played = played.map_err(|error| error.of(number))?;
                Ok(played.map(|ledger| (events::share(system, &begun(), &ledger), seen)))
            })
            .collect()
    }

    fn key(&self, number: u32) -> Key {
        (self.plan.model.run.seed, u64::from(number))
    }

    /// One realization; `None` if it was stopped.
    fn one(
        &self,
        system: &System,
        number: u32,
        watch: &Watch,
    ) -> Result<Option<(Share, Observed)>, RunError> {
        let model = &self.plan.model;
        let key = self.key(number);
        let amounts = self.start.deal(key);
        let mut observed = Observed::new(number);
        let found = if let Some((clock, _)) = &self.split {
            self.step(
                SplitState::new(&self.plan.reactor, amounts, key.0, key.1),
                clock,
                &mut observed,
                watch,
            )?
        } else {
            let Some(mut method) = events::start(self.arena.method, &model.chemistry, system, amounts, key)?
            else {
                return Ok(None);
            };
            events::play(system, method.as_mut(), &model.output.times, watch, |_, amounts| {
                self.sums.look(amounts, &mut observed.series);
            })?
        };
        Ok(found.map(|share| (share, observed)))
    }

    /// One realization in steps of diffusion and reaction in turn.
    fn step(
        &self,
        mut state: SplitState,
        clock: &[Interval],
        observed: &mut Observed,
        watch: &Watch,
    ) -> Result<Option<Share>, RunError> {
        let start = totals(self.plan, &state.amounts);
        for interval in clock {
            for k in 0..interval.ticks {
                if watch.stopped() {
                    return Ok(None);
                }
                let (reactor, time, tick) = (&self.plan.reactor, interval.time(k), interval.tick());
                match self.plan.model.chemistry.integrator {
                    Integrator::Exponential => state.step(reactor, &self.frozen, time, tick)?,
                    Integrator::Euler => state.euler(reactor, &self.frozen, time, tick)?,
                }
            }
            self.sums.look(&state.amounts, &mut observed.series);
        }
        let lost = state.astray(&self.plan.reactor, &start);
        Ok(Some(Share {
            counters: state.counters,
            supplied: state.supplied,
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

fn split(plan: &Plan, frozen: &Frozen, start: &Start) -> Result<(Vec<Interval>, String), NotReady> {
    let chemistry = &plan.model.chemistry;
    check_euler(&plan.model, longest_euler_step(&plan.reactor, frozen))?;
    let bounds = step_bounds(&plan.reactor, frozen, &start.means(), chemistry.hops, chemistry.change);
    let until = plan.model.run.until;
    let (step, limited_by) = match chemistry.step {
        Some(step) => (step, "the step given in the model".to_string()),
        None if bounds.step() > until => (until, "the output times".to_string()),
        None => (bounds.step(), bounds.limited_by().to_string()),
    };
    check_steps(&plan.model.places.chemistry, "chemistry", step, &limited_by, until)?;
    Ok((intervals(&plan.model.output.times, step, None), limited_by))
}
