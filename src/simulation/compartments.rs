//! Realizations in one volume or on a graph of volumes: event driven, or split where species are continuous.

use super::clock::{Interval, intervals};
use super::each::{Found, each};
use super::events;
use super::keep::{Keep, PIECE, Share, Shown};
use super::realization::Realization;
use super::walk::Walk;
use super::{FORWARD_EULER, Finish, NotReady, Watch, euler_caveat, hybrids, paths};
use crate::chemistry::split::{
    Frozen, SplitState, SplittingError, longest_euler_step, splitting_error, step_bounds,
};
use crate::chemistry::ssa::side_by_side::{Task, fits, side_by_side};
use crate::chemistry::ssa::{Key, System};
use crate::model::{Integrator, Method};
use crate::plan::limits::{check_euler, check_steps};
use crate::plan::start::{Start, Voxels, check_amounts, start};
use crate::plan::{Compartments, Plan};
use crate::quantity::readable::show;
use crate::record::{StepRecord, StepsRecord};
use crate::samples::SeriesBlock;
use crate::sampling::{Observed, Sums};
use crate::vector::Vector;
use std::time::Instant;

/// A plan of compartments, ready to run.
pub struct Ready<'p> {
    pub(super) plan: &'p Plan,
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
            solid: None,
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
        let mut seen = Observed::default();
        self.sums.look(&self.start.means(), &mut seen);
        seen.series
    }

    /// Runs realizations; those that finish are kept whatever befalls others.
    #[must_use]
    pub fn run_into(&self, realizations: &[u32], watch: &Watch, keep: &dyn Keep) -> Finish {
        watch.begin(realizations.len() as u64, "realizations");
        let system = System::new(&self.plan.reactor, &self.frozen);
        // Parts small enough to keep all threads busy to the end, large enough to be worth the handing out.
        let part = (realizations.len() / (8 * rayon::current_num_threads())).clamp(1, 64);
        each(realizations, part, watch, |numbers| self.several(&system, numbers, watch, keep))
    }

    /// A few realizations on one thread.
    fn several(&self, system: &System, numbers: &[u32], watch: &Watch, keep: &dyn Keep) -> Vec<(u32, Found)> {
        if self.arena.method != Method::Direct || !fits(system) {
            return numbers
                .iter()
                .map(|&n| (n, if watch.stopped() { Ok(false) } else { self.one(system, n, watch, keep) }))
                .collect();
        }
        let begun = Instant::now();
        // They share the memory that one alone may fill.
        let piece = PIECE / numbers.len().max(1);
        let mut shown: Vec<Shown> =
            numbers.iter().map(|&number| Shown::new(Observed::new(number), keep, piece)).collect();
        let task = Task {
            count: numbers.len(),
            halts: &events::halts(&self.plan.model.output.times),
            start: &|k| (self.start.deal(self.key(numbers[k])), self.key(numbers[k])),
            stopped: &|| watch.stopped(),
        };
        let played = side_by_side(system, &task, |k, amounts| {
            self.sums.look(amounts, &mut shown[k].observed);
            shown[k].looked();
        });
        let seconds = begun.elapsed().as_secs_f64() / numbers.len().max(1) as f64;
        let found = played.into_iter().zip(shown).zip(numbers);
        found
            .map(|((played, seen), &number)| {
                let begun = || events::free_totals(system, &self.start.deal(self.key(number)));
                let found = played.and_then(|ledger| {
                    let Some(ledger) = ledger else { return Ok(false) };
                    seen.finish(Share { seconds, ..events::share(system, &begun(), &ledger) })?;
                    Ok(true)
                });
                (number, found)
            })
            .collect()
    }

    fn key(&self, number: u32) -> Key {
        (self.plan.model.run.seed, u64::from(number))
    }

    /// One realization.
    fn one(&self, system: &System, number: u32, watch: &Watch, keep: &dyn Keep) -> Found {
        if let Some((clock, _)) = &self.split {
            return self.steps_of(number, clock, watch, keep);
        }
        let begun = Instant::now();
        let model = &self.plan.model;
        let key = self.key(number);
        let amounts = self.start.deal(key);
        let Some(mut method) = events::start(self.arena.method, &model.chemistry, system, amounts, key)?
        else {
            return Ok(false);
        };
        let mut seen = Shown::new(Observed::new(number), keep, PIECE);
        let share = events::play(system, method.as_mut(), &model.output.times, watch, |_, amounts| {
            self.sums.look(amounts, &mut seen.observed);
            seen.looked();
        })?;
        let Some(share) = share else { return Ok(false) };
        seen.finish(Share { seconds: begun.elapsed().as_secs_f64(), ..share })?;
        Ok(true)
    }

    /// One realization in steps of diffusion and reaction in turn.
    fn steps_of(&self, number: u32, clock: &[Interval], watch: &Watch, keep: &dyn Keep) -> Found {
        let key = self.key(number);
        let reactor = &self.plan.reactor;
        let begin = || {
            let state = SplitState::new(reactor, self.start.deal(key), key.0, key.1);
            let total = (0..reactor.species_count()).map(|s| state.total(s)).collect();
            Realization { state, total, observed: Observed::new(number) }
        };
        let step = |one: &mut Realization, time: f64, tick: f64| match self.plan.model.chemistry.integrator {
            Integrator::Exponential => one.state.step(reactor, &self.frozen, time, tick),
            Integrator::Euler => one.state.euler(reactor, &self.frozen, time, tick),
        };
        let look = |one: &mut Realization, _: f64| self.sums.look(&one.state.amounts, &mut one.observed);
        let groups: Vec<usize> = (0..self.arena.volumes.len()).collect();
        let walk = Walk { plan: self.plan, clock, watch, keep, groups: (&groups, &self.arena.home) };
        walk.follow(number, begin, step, look)
    }
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
