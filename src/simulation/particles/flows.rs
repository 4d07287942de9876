//! Realizations on flows: one flow for all of them, or for each its own.

use super::course::{Course, Travelled};
use super::{Ready, settled};
use crate::error::RunError;
use crate::plan::start::start;
use crate::simulation::freeze::freeze;
use crate::simulation::realization::Realization;
use crate::simulation::{Outcome, Tally, Watch};
use rayon::prelude::*;
use std::time::Instant;

impl<'p, const D: usize> Ready<'p, D> {
    /// All realizations step by step on one flow.
    pub(super) fn run_on_flow(self, realizations: &[u32], mut tally: Tally, watch: &Watch) -> Outcome {
        watch.begin(self.ticks(), "chemistry steps");
        let mut members = self.members(realizations);
        let home = &self.scene.plan.home;
        let course = Course {
            plan: self.plan,
            scene: self.scene,
            frozen: self.frozen,
            start: &self.start,
            clock: &self.clock,
            shared: true,
        };
        let way = course.follow(&mut members, watch);
        book(&way, &mut tally);
        super::count(self.plan, home, &members, &mut tally);
        Outcome {
            observed: members.into_iter().map(|one| one.observed).collect(),
            times: way.times,
            tally,
            error: way.error,
            interrupted: way.interrupted,
        }
    }

    /// Each realization on a flow of its own, as many side by side as there are threads: no more flows than that are
    /// in memory. Those that finish are kept whatever befalls others; a single one is kept as far as it came.
    pub(super) fn run_on_flows(mut self, realizations: &[u32], mut tally: Tally, watch: &Watch) -> Outcome {
        watch.begin(self.ticks() * realizations.len() as u64, "chemistry steps");
        let all = self.plan.model.output.times.len();
        let single = realizations.len() == 1;
        // Each realization builds its own.
        self.scene.flow = None;
        let home = &self.scene.plan.home;
        let mut outcome = Outcome { times: all, ..Outcome::default() };
        let mut kept = Vec::new();
        for side_by_side in realizations.chunks(rayon::current_num_threads().max(1)) {
            if watch.stopped() {
                outcome.interrupted = true;
                break;
            }
            let found: Vec<(Option<Realization>, Travelled)> =
                side_by_side.par_iter().map(|&number| self.one_flow(number, watch)).collect();
            for (one, mut way) in found {
                book(&way, &mut tally);
                outcome.error = outcome.error.or(way.error.take());
                outcome.interrupted |= way.interrupted;
                if single {
                    outcome.times = way.times;
                }
                kept.extend(one.filter(|_| single || way.times == all));
            }
        }
        super::count(self.plan, home, &kept, &mut tally);
        outcome.observed = kept.into_iter().map(|one| one.observed).collect();
        outcome.tally = tally;
        outcome
    }

    /// One realization from the flow at rest to its end; `None` if it failed.
    fn one_flow(&self, number: u32, watch: &Watch) -> (Option<Realization>, Travelled) {
        let mut members = Vec::new();
        let way = self.travel(number, &mut members, watch);
        let way = way.unwrap_or_else(|error| Travelled { error: Some(error), ..Travelled::default() });
        let error = way.error.map(|error| error.of(number));
        (members.pop(), Travelled { error, ..way })
    }

    fn travel(
        &self,
        number: u32,
        members: &mut Vec<Realization>,
        watch: &Watch,
    ) -> Result<Travelled, RunError> {
        let begun = Instant::now();
        let Some(scene) = settled(self.scene.plan, number, watch)? else {
            return Ok(Travelled { interrupted: true, ..Travelled::default() });
        };
        let start = start(self.plan, &scene.places());
        let frozen = freeze(self.plan, &scene, &start)?;
        members.push(Realization::new(self.plan, &start, number));
        let prepared = begun.elapsed().as_secs_f64();
        let course =
            Course { plan: self.plan, scene, frozen, start: &start, clock: &self.clock, shared: false };
        let way = course.follow(members, watch);
        Ok(Travelled { fluid_seconds: way.fluid_seconds + prepared, ..way })
    }

    /// Chemistry steps of a realization.
    fn ticks(&self) -> u64 {
        self.clock.iter().map(|interval| interval.ticks).sum()
    }
}

/// Takes what a flow says of itself and what it cost into the tally.
fn book(way: &Travelled, tally: &mut Tally) {
    tally.fluid_seconds += way.fluid_seconds;
    tally.chemistry_seconds += way.chemistry_seconds;
    tally.particle_steps += way.particle_steps;
    tally.pair_evaluations += way.pair_evaluations;
    match &mut tally.flow {
        Some(flow) => flow.absorb(way.flow.clone()),
        None => tally.flow = Some(way.flow.clone()),
    }
}
