//! Realizations on particles: one flow for all of them, or particles at rest.

use super::clock::{Interval, intervals};
use super::scene::Scene;
use super::{FlowTally, NotReady, Outcome, Tally, Watch};
use crate::chemistry::sampling_numbers::poisson;
use crate::chemistry::split::{Frozen, SplitState, StepBounds, step_bounds};
use crate::error::RunError;
use crate::plan::limits::check_steps;
use crate::plan::start::{Start, sponge_targets, start};
use crate::plan::{ParticlePlan, Plan};
use crate::random::{Purpose, stream};
use crate::record::{StepRecord, StepsRecord};
use crate::sampling::{Lens, Observed};
use crate::tables::SeriesBlock;
use rayon::prelude::*;
use std::time::Instant;

/// A particle plan at t = 0: the flow settled, the steps chosen.
pub struct Ready<'p, const D: usize> {
    plan: &'p Plan,
    scene: Scene<'p, D>,
    frozen: Frozen,
    start: Start,
    chemistry_step: f64,
    chemistry_limit: String,
    fluid: Option<(f64, String)>,
    clock: Vec<Interval>,
    fluid_seconds: f64,
}

/// What the reservoirs do on one geometry: for each sponge and species its rate, voxels and targets.
struct Reservoirs {
    sponges: Vec<(usize, f64, Vec<u32>, Vec<f64>)>,
}

/// A realization under way.
struct Realization {
    number: u32,
    state: SplitState,
    /// Molecules of each species at the start.
    total: Vec<f64>,
    observed: Observed,
}

impl<'p, const D: usize> Ready<'p, D> {
    /// Builds the flow, lets it settle, and chooses the steps.
    ///
    /// # Errors
    /// Too many steps, or a flow that fails while it settles.
    pub fn new(plan: &'p Plan, arena: &'p ParticlePlan<D>) -> Result<Ready<'p, D>, NotReady> {
        let begun = Instant::now();
        let mut scene = Scene::new(arena, &plan.reactor)?;
        let until = plan.model.run.until;
        let fluid = scene.flow.as_ref().map(|flow| {
            let limit = flow.step_limit();
            (limit.seconds, limit.limited_by)
        });
        if let Some((step, limited_by)) = &fluid {
            check_steps(&plan.model.places.run, "fluid", *step, limited_by, until + arena.settle)?;
        }
        if let Some(flow) = &mut scene.flow {
            flow.settle(arena.settle)?;
            scene.look();
        }
        let fluid_seconds = begun.elapsed().as_secs_f64();
        let start = start(plan, &scene.places());
        let frozen = freeze(plan, &scene, &start)?;
        let bounds = bounds(plan, &scene, &frozen, &start);
        let automatic = (bounds.step(), bounds.limited_by().to_string());
        let (chemistry_step, chemistry_limit) = match plan.model.chemistry.step {
            Some(step) => (step, "the step given in the model".to_string()),
            // Where nothing limits the step, outputs do.
            None if automatic.0 > until => (until, "the output times".to_string()),
            None => automatic,
        };
        check_steps(&plan.model.places.chemistry, "chemistry", chemistry_step, &chemistry_limit, until)?;
        let clock = intervals(&plan.model.output.times, chemistry_step, fluid.as_ref().map(|f| f.0));
        Ok(Ready { plan, scene, frozen, start, chemistry_step, chemistry_limit, fluid, clock, fluid_seconds })
    }

    /// Steps and what limits them.
    #[must_use]
    pub fn steps(&self) -> StepsRecord {
        let longest = self.clock.iter().map(Interval::tick).fold(0.0, f64::max);
        let ticks: u64 = self.clock.iter().map(|i| i.ticks).sum();
        let limited_by = if longest < 0.5 * self.chemistry_step {
            "the output times".to_string()
        } else {
            self.chemistry_limit.clone()
        };
        let finest = self
            .clock
            .iter()
            .filter(|i| i.fluid_steps > 0)
            .map(|i| i.tick() / i.fluid_steps as f64)
            .fold(0.0, f64::max);
        let discrete = self.plan.reactor.discrete.iter().filter(|&&d| d).count();
        let method = match discrete {
            0 => "rate equations, diffusion by the exact exponential, Strang splitting",
            n if n == self.plan.reactor.discrete.len() => {
                "exact sampling of diffusion and reaction in turn, Strang splitting"
            }
            _ => "discrete and continuous species side by side, Strang splitting",
        };
        StepsRecord {
            fluid: self.fluid.as_ref().map(|(_, limited_by)| StepRecord {
                step: finest,
                count: self.clock.iter().map(|i| i.ticks * i.fluid_steps).sum(),
                limited_by: limited_by.clone(),
            }),
            chemistry: Some(StepRecord { step: longest, count: ticks, limited_by }),
            method: method.into(),
            approximations: vec![format!(
                "splitting of motion, diffusion and reaction: second order in the chemistry step of {}",
                crate::quantity::readable::show(longest, "s")
            )],
            shared_flow: self.fluid.is_some(),
        }
    }

    /// The series at the start, with means where amounts are dealt.
    #[must_use]
    pub fn first_look(&self) -> SeriesBlock {
        let mut observed = Observed::new(0);
        Lens::new(self.plan, &self.scene, 0.0).look(&self.start.means(), true, &mut observed);
        observed.series
    }

    /// Runs realizations.
    #[must_use]
    pub fn run(self, realizations: &[u32], watch: &Watch) -> Outcome {
        let mut tally = Tally { steps: self.steps(), fluid_seconds: self.fluid_seconds, ..Tally::default() };
        tally.supplied = vec![0.0; self.plan.reactor.species.len()];
        let members: Vec<Realization> = realizations.iter().map(|&number| self.deal(number)).collect();
        if self.fluid.is_some() {
            self.run_on_flow(members, tally, watch)
        } else {
            self.run_at_rest(members, tally, watch)
        }
    }

    /// A realization at t = 0.
    fn deal(&self, number: u32) -> Realization {
        let seed = self.plan.model.run.seed;
        let mut amounts = self.start.amounts.clone();
        let mut random = stream(seed, u64::from(number), Purpose::Deal);
        for &(index, mean) in &self.start.poisson {
            amounts[index as usize] += poisson(&mut random, mean) as f64;
        }
        let state = SplitState::new(&self.plan.reactor, amounts, seed, u64::from(number));
        let total = (0..self.plan.reactor.species.len()).map(|s| state.total(s)).collect();
        let mut one = Realization { number, state, total, observed: Observed::new(number) };
        one.deal_held(self.plan, &self.start);
        one
    }

    /// All realizations step by step on one flow.
    fn run_on_flow(mut self, mut members: Vec<Realization>, mut tally: Tally, watch: &Watch) -> Outcome {
        let plan = self.plan;
        watch.begin(self.clock.iter().map(|i| i.ticks).sum(), "chemistry steps");
        let mut reservoirs = Reservoirs::new(plan, &self.scene);
        let mut error = None;
        let mut seen = 0;
        let mut interrupted = false;
        'time: for interval in &self.clock {
            let tick = interval.tick();
            for k in 0..interval.ticks {
                if watch.stopped() {
                    interrupted = true;
                    break 'time;
                }
                let time = interval.time(k);
                let chemistry = Instant::now();
                let first = members
                    .par_iter_mut()
                    .try_for_each(|one| one.before(plan, &self.frozen, &reservoirs, time, 0.5 * tick));
                let fluid = Instant::now();
                tally.chemistry_seconds += (fluid - chemistry).as_secs_f64();
                let moved = first.and_then(|()| {
                    self.scene.advance(tick / interval.fluid_steps as f64, interval.fluid_steps)
                });
                let chemistry = Instant::now();
                tally.fluid_seconds += (chemistry - fluid).as_secs_f64();
                let second = moved.and_then(|()| freeze(plan, &self.scene, &self.start)).and_then(|frozen| {
                    self.frozen = frozen;
                    reservoirs = Reservoirs::new(plan, &self.scene);
                    members.par_iter_mut().try_for_each(|one| {
                        one.after(plan, &self.frozen, &reservoirs, &self.start, time + 0.5 * tick, 0.5 * tick)
                    })
                });
                tally.chemistry_seconds += chemistry.elapsed().as_secs_f64();
                if let Err(found) = second {
                    error = Some(found);
                    break 'time;
                }
                watch.advance(1);
            }
            let lens = Lens::new(plan, &self.scene, interval.end);
            members.par_iter_mut().for_each(|one| lens.look(&one.state.amounts, true, &mut one.observed));
            seen += 1;
        }
        self.count(&members, &mut tally);
        Outcome {
            observed: members.into_iter().map(|one| one.observed).collect(),
            times: seen,
            tally,
            error,
            interrupted,
        }
    }

    /// Realizations one by one on particles at rest; those that finish are kept whatever befalls others.
    fn run_at_rest(self, mut members: Vec<Realization>, mut tally: Tally, watch: &Watch) -> Outcome {
        let plan = self.plan;
        watch.begin(members.len() as u64, "realizations");
        let lenses: Vec<Lens<D>> =
            plan.model.output.times.iter().map(|&time| Lens::new(plan, &self.scene, time)).collect();
        let reservoirs = Reservoirs::new(plan, &self.scene);
        let begun = Instant::now();
        let finished: Vec<Result<bool, RunError>> = members
            .par_iter_mut()
            .map(|one| {
                for (interval, lens) in self.clock.iter().zip(&lenses) {
                    for k in 0..interval.ticks {
                        if watch.stopped() {
                            return Ok(false);
                        }
                        let (time, half) = (interval.time(k), 0.5 * interval.tick());
                        one.before(plan, &self.frozen, &reservoirs, time, half)?;
                        one.after(plan, &self.frozen, &reservoirs, &self.start, time + half, half)?;
                    }
                    lens.look(&one.state.amounts, false, &mut one.observed);
                }
                watch.advance(1);
                Ok(true)
            })
            .collect();
        tally.chemistry_seconds = begun.elapsed().as_secs_f64();
        let mut error = None;
        let mut interrupted = false;
        let mut kept = Vec::new();
        for (one, result) in members.into_iter().zip(finished) {
            match result {
                Ok(true) => kept.push(one),
                Ok(false) => interrupted = true,
                Err(found) => error = error.or(Some(found)),
            }
        }
        self.count(&kept, &mut tally);
        let times = plan.model.output.times.len();
        Outcome {
            observed: kept.into_iter().map(|one| one.observed).collect(),
            times,
            tally,
            error,
            interrupted,
        }
    }

    /// Books counters, conservation and what the flow says of itself.
    fn count(&self, members: &[Realization], tally: &mut Tally) {
        for one in members {
            tally.reaction_events += one.state.counters.events;
            tally.hops += one.state.counters.hops;
            for (s, start) in one.total.iter().enumerate() {
                tally.supplied[s] += one.state.supplied[s];
                if self.plan.reactor.discrete[s] {
                    let made = one.state.made(&self.plan.reactor, s);
                    tally.lost += (one.state.total(s) - start - made - one.state.supplied[s]).abs();
                }
            }
        }
        if let Some(flow) = &self.scene.flow {
            tally.particle_steps = flow.particle_steps();
            tally.pair_evaluations = flow.pair_evaluations();
            let health = flow.health();
            tally.flow = Some(FlowTally {
                penetrations: health.penetrations,
                bounces: health.bounces,
                largest_mach: health.largest_mach,
                largest_density_change: health.largest_density_change,
                warnings: health.warnings,
            });
        }
    }
}

/// The chemistry's view of a scene.
fn freeze<const D: usize>(plan: &Plan, scene: &Scene<D>, start: &Start) -> Result<Frozen, RunError> {
    let held: &[bool] = if start.held.iter().any(|&held| held) { &start.held } else { &[] };
    Frozen::build(&plan.reactor, &scene.links(), &scene.volumes, &scene.plan.home, &scene.current, held)
}

/// Bounds of the chemistry step, from the amounts at the start with the sponges' targets put in.
fn bounds<const D: usize>(plan: &Plan, scene: &Scene<D>, frozen: &Frozen, start: &Start) -> StepBounds {
    let count = plan.reactor.species.len();
    let mut amounts = start.means();
    for (s, _, voxels, targets) in &Reservoirs::new(plan, scene).sponges {
        for (&i, &target) in voxels.iter().zip(targets) {
            amounts[i as usize * count + s] = target;
        }
    }
    step_bounds(&plan.reactor, frozen, &amounts, plan.model.chemistry.hops, plan.model.chemistry.change)
}

impl Reservoirs {
    fn new<const D: usize>(plan: &Plan, scene: &Scene<D>) -> Reservoirs {
        let places = scene.places();
        let mut sponges = Vec::new();
        for sponge in &scene.plan.sponges {
            for (s, amount) in &sponge.species {
                let voxels: Vec<u32> = scene
                    .members(sponge.group)
                    .into_iter()
                    .filter(|&i| plan.reactor.habitat[*s].holds(scene.plan.home[i as usize]))
                    .collect();
                let targets = sponge_targets(&places, &voxels, amount);
                sponges.push((*s, sponge.rate, voxels, targets));
            }
        }
        Reservoirs { sponges }
    }

    fn act(&self, plan: &Plan, frozen: &Frozen, state: &mut SplitState, dt: f64) {
        for (s, rate, voxels, targets) in &self.sponges {
            state.sponge((&plan.reactor, frozen), voxels, *s, (*rate, targets), dt);
        }
    }
}

impl Realization {
    /// Draws held Poisson amounts anew.
    fn deal_held(&mut self, plan: &Plan, start: &Start) {
        for (s, voxels, means) in &start.held_poisson {
            self.state.deal_held(&plan.reactor, voxels, *s, means);
        }
    }

    /// The half of a step before the particles move.
    fn before(
        &mut self,
        plan: &Plan,
        frozen: &Frozen,
        reservoirs: &Reservoirs,
        time: f64,
        half: f64,
    ) -> Result<(), RunError> {
        debug_assert_eq!(self.number, self.observed.series.realization);
        reservoirs.act(plan, frozen, &mut self.state, half);
        self.state.react(&plan.reactor, frozen, time, half)?;
        self.state.diffuse(&plan.reactor, frozen, time, half)
    }

    /// The half of a step after the particles moved, in the opposite order.
    fn after(
        &mut self,
        plan: &Plan,
        frozen: &Frozen,
        reservoirs: &Reservoirs,
        start: &Start,
        time: f64,
        half: f64,
    ) -> Result<(), RunError> {
        self.state.diffuse(&plan.reactor, frozen, time, half)?;
        self.state.react(&plan.reactor, frozen, time, half)?;
        reservoirs.act(plan, frozen, &mut self.state, half);
        self.deal_held(plan, start);
        Ok(())
    }
}
