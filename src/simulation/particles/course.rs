//! The course of one flow with the realizations on it, step by step.

use crate::chemistry::split::Frozen;
use crate::error::RunError;
use crate::plan::Plan;
use crate::plan::start::Start;
use crate::sampling::{Lens, Moment};
use crate::scene::Scene;
use crate::simulation::clock::Interval;
use crate::simulation::freeze::freeze;
use crate::simulation::realization::{Exchange, Realization, Reservoirs, Surroundings};
use crate::simulation::{FlowTally, Watch};
use rayon::prelude::*;
use std::time::Instant;

/// A flow at t = 0 and the chemistry's view of it.
pub(super) struct Course<'r, 'p, const D: usize> {
    pub plan: &'p Plan,
    pub scene: Scene<'p, D>,
    pub frozen: Frozen,
    pub start: &'r Start,
    pub clock: &'r [Interval],
    /// Whether all realizations of the run see this flow.
    pub shared: bool,
}

/// How far a course came.
#[derive(Default)]
pub(super) struct Travelled {
    /// Output times seen.
    pub times: usize,
    /// The first failure.
    pub error: Option<RunError>,
    pub interrupted: bool,
    pub fluid_seconds: f64,
    pub chemistry_seconds: f64,
    pub flow: FlowTally,
    pub particle_steps: u64,
    pub pair_evaluations: u64,
}

impl<const D: usize> Course<'_, '_, D> {
    /// Takes `members` through all output times: half a step of chemistry, the motion, the other half. What lifts the
    /// fluid is the state of the first member between the halves; where members differ each has its own course.
    pub fn follow(mut self, members: &mut Vec<Realization>, watch: &Watch) -> Travelled {
        let (plan, species) = (self.plan, self.plan.reactor.species.len());
        let mut reservoirs = Reservoirs::new(plan, &self.scene);
        let mut way = Travelled::default();
        'time: for interval in self.clock {
            let tick = interval.tick();
            for k in 0..interval.ticks {
                if watch.stopped() {
                    way.interrupted = true;
                    break 'time;
                }
                let (time, half) = (interval.time(k), 0.5 * tick);
                let chemistry = Instant::now();
                let before =
                    Surroundings { plan, frozen: &self.frozen, reservoirs: &reservoirs, start: self.start };
                advance(members, &mut way.error, |one| one.before_motion(&before, time, half));
                if let Some(first) = members.first().filter(|_| !self.scene.plan.lifts.is_empty()) {
                    self.scene.lift(&first.state.amounts, species);
                }
                let fluid = Instant::now();
                way.chemistry_seconds += (fluid - chemistry).as_secs_f64();
                let moved = self.scene.advance(tick / interval.fluid_steps as f64, interval.fluid_steps);
                let chemistry = Instant::now();
                way.fluid_seconds += (chemistry - fluid).as_secs_f64();
                match moved.and_then(|()| freeze(plan, &self.scene, self.start)) {
                    Ok(frozen) => self.frozen = frozen,
                    Err(found) => {
                        // The flow carries them all.
                        way.error = way.error.or(Some(found));
                        break 'time;
                    }
                }
                reservoirs = Reservoirs::new(plan, &self.scene);
                let after =
                    Surroundings { plan, frozen: &self.frozen, reservoirs: &reservoirs, start: self.start };
                let exchange = Exchange::new(plan, &self.scene);
                advance(members, &mut way.error, |one| {
                    one.cross(plan, &exchange);
                    one.after_motion(&after, time + half, half)
                });
                way.chemistry_seconds += chemistry.elapsed().as_secs_f64();
                if members.is_empty() {
                    break 'time;
                }
                watch.advance(1);
            }
            let lens = Lens::new(plan, &self.scene);
            members.par_iter_mut().for_each(|one| {
                let now = Moment { time: interval.end, tick };
                lens.look(&one.state.amounts, now, self.shared, &mut one.observed);
            });
            way.times += 1;
        }
        self.book(&mut way);
        way
    }

    /// What the flow says of itself.
    fn book(&self, way: &mut Travelled) {
        let Some(flow) = &self.scene.flow else { return };
        way.particle_steps = flow.particle_steps();
        way.pair_evaluations = flow.pair_evaluations();
        let health = flow.health();
        way.flow = FlowTally {
            momentum_drift: self.scene.momentum_drift(),
            penetrations: health.penetrations,
            bounces: health.bounces,
            largest_mach: health.largest_mach,
            largest_density_change: health.largest_density_change,
            warnings: health.warnings,
        };
    }
}

/// Takes every realization a part of a step on; one that fails is left behind, and the first failure is told.
fn advance(
    members: &mut Vec<Realization>,
    error: &mut Option<RunError>,
    part: impl Fn(&mut Realization) -> Result<(), RunError> + Sync + Send,
) {
    let part = |one: &mut Realization| part(one).map_err(|error| error.of(one.observed.series.realization));
    let results: Vec<Result<(), RunError>> = members.par_iter_mut().map(part).collect();
    let mut results = results.into_iter();
    members.retain(|_| match results.next() {
        Some(Err(found)) => {
            error.get_or_insert(found);
            false
        }
        _ => true,
    });
}
