//! Realizations on particles: one flow for all of them, one for each, or particles at rest.

mod course;
mod flows;
mod numbers;
mod recording;
mod solids;
mod steps;

use super::clock::{Interval, intervals};
use super::each::each;
use super::freeze::freeze;
use super::keep::Keep;
use super::realization::{Realization, Reservoirs, Surroundings};
use super::walk::Walk;
use super::{Finish, NotReady, Watch, paths};
use crate::chemistry::split::{Frozen, SplittingError, longest_euler_step};
use crate::error::{Fault, ModelError, RunError};
use crate::fluid::Flow;
use crate::model::changes::{flow_makings, other_makings};
use crate::model::{FlowFile, Method};
use crate::plan::limits::{check_euler, check_steps};
use crate::plan::start::{Start, check_amounts, start};
use crate::plan::{ParticlePlan, Plan};
use crate::quantity::readable::show;
use crate::samples::SeriesBlock;
use crate::sampling::{Lens, Observed};
use crate::scene::{AT_A_TIME, Moving, Scene};
use crate::solid::StepLimit;
use recording::{Frame, Player, Title};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;
use steps::{bounds, buoyant_pull, estimate};

/// A particle plan at t = 0: the flow settled, the steps chosen.
pub struct Ready<'p, const D: usize> {
    pub(super) plan: &'p Plan,
    pub(super) scene: Scene<'p, D>,
    pub(super) frozen: Frozen,
    pub(super) start: Start,
    chemistry_step: f64,
    chemistry_limit: String,
    fluid: Option<(f64, String)>,
    /// Longest steps of the elastic solids, in the order of the model.
    solid_steps: Vec<StepLimit>,
    clock: Vec<Interval>,
    fluid_seconds: f64,
    /// Error of splitting and the time over which it was found, s.
    splitting: Option<(SplittingError, f64)>,
    /// Of the flow, m/s.
    sound_speed: f64,
    /// The settled flow and the solids, until the first realizations take them.
    fresh: Mutex<Option<Moving<D>>>,
}

impl<'p, const D: usize> Ready<'p, D> {
    /// Builds the flow, lets it settle, and chooses the steps.
    ///
    /// # Errors
    /// Too many steps, or a flow that fails while it settles.
    pub fn new(plan: &'p Plan, arena: &'p ParticlePlan<D>) -> Result<Ready<'p, D>, NotReady> {
        let begun = Instant::now();
        let until = plan.model.run.until;
        let mut player = match &plan.model.flow {
            Some(FlowFile::Replay(path)) => Some(Player::open(path, arena)?),
            _ => None,
        };
        let mut scene = match &mut player {
            Some(player) => {
                let other = other_makings(&player.title.makings, &flow_makings(&plan.model.text));
                if !other.is_empty() {
                    let reason = format!("the flow to be replayed is another one: {}", other.join("; "));
                    let remedy = "record it again with these values, or take those it was recorded with";
                    return Err(ModelError::from(Fault::at(&plan.model.places.run, reason, remedy)).into());
                }
                let mut scene = Scene::at_rest(arena);
                let Frame { snapshot, presence } = player.next()?;
                scene.show(snapshot, presence);
                scene
            }
            None => Scene::new(arena, 0)?,
        };
        let mut fluid = None;
        if let Some(flow) = &mut scene.flow {
            let before = flow.step_limit();
            let (place, duration) = (&plan.model.places.run, until + arena.settle);
            check_steps(place, "fluid", before.seconds, &before.limited_by, duration)?;
            flow.settle(arena.settle)?;
            // Faster flow than expected shows by now.
            let after = flow.step_limit();
            let limit = if after.seconds < before.seconds { after } else { before };
            check_steps(place, "fluid", limit.seconds, &limit.limited_by, duration)?;
            fluid = Some((limit.seconds, limit.limited_by));
        }
        let mut solid_steps = scene.solid_steps();
        solid_steps.extend(scene.vessel_steps(until));
        let solid = shortest(&solid_steps);
        if let Some(limit) = solid {
            check_steps(&plan.model.places.run, "solid", limit.seconds, &limit.limited_by, until)?;
        }
        if player.is_none() {
            scene.look();
        }
        let fluid_seconds = begun.elapsed().as_secs_f64();
        check_amounts(plan, &scene.places())?;
        let start = start(plan, &scene.places());
        solids::check_softening(plan, &scene, &start)?;
        let frozen = freeze(plan, &scene, &start)?;
        let pull = buoyant_pull(plan, arena, &scene, &start);
        if let Some((step, limited_by)) = &mut fluid {
            let buoyant = 0.25 * (arena.cutoff / pull).sqrt();
            if buoyant < *step {
                (*step, *limited_by) = (buoyant, "buoyancy".into());
            }
        }
        let groups: Vec<usize> = arena.home.iter().map(|&home| usize::from(home)).collect();
        paths::check(plan, &frozen, &groups)?;
        check_euler(&plan.model, longest_euler_step(&plan.reactor, &frozen))?;
        // Events know no step; realizations go from output time to output time.
        let (chemistry_step, chemistry_limit, clock, splitting) = if event_driven(plan).is_some() {
            (f64::INFINITY, String::new(), Vec::new(), None)
        } else {
            let bounds = bounds(plan, &scene, &frozen, &start);
            // What lifts the fluid is renewed at each chemistry step: a tenth of the inverse frequency at which the
            // steepest layers that the particles can carry would swing, N² = pull / cut-off.
            let buoyancy = 0.1 * (arena.cutoff / pull).sqrt();
            let (step, limit) = match plan.model.chemistry.step {
                Some(step) => (step, "the step given in the model".to_string()),
                None if buoyancy < bounds.step().min(until) => (
                    buoyancy,
                    "buoyancy, a tenth of sqrt(h / (g times the relative change of density))".into(),
                ),
                // Where nothing limits the step, outputs do.
                None if bounds.step() > until => (until, "the output times".to_string()),
                None => (bounds.step(), bounds.limited_by().to_string()),
            };
            check_steps(&plan.model.places.chemistry, "chemistry", step, &limit, until)?;
            let clock = match &player {
                Some(player) => recorded(plan, &player.title, (step, &limit))?,
                None => {
                    // Solids that no fluid moves go several of their own steps at a time.
                    let motion = fluid.as_ref().map(|f| f.0).or(solid.map(|limit| AT_A_TIME * limit.seconds));
                    intervals(&plan.model.output.times, step, motion)
                }
            };
            let splitting = estimate(plan, &scene, &frozen, &start, &clock);
            (step, limit, clock, splitting)
        };
        let sound_speed = scene.flow.as_ref().map_or(0.0, Flow::sound_speed);
        let fresh = Mutex::new(Some(scene.take_motion()));
        Ok(Ready {
            plan,
            scene,
            frozen,
            start,
            chemistry_step,
            chemistry_limit,
            fluid,
            solid_steps,
            clock,
            fluid_seconds,
            splitting,
            sound_speed,
            fresh,
        })
    }

    /// The series at the start, with means where amounts are dealt.
    #[must_use]
    pub fn first_look(&self) -> SeriesBlock {
        let mut observed = Observed::new(0);
        Lens::new(self.plan, &self.scene).look(&self.start.means(), 0.0, true, &mut observed);
        observed.series
    }

    /// Runs realizations; those that finish are kept whatever befalls others.
    #[must_use]
    pub fn run_into(&self, realizations: &[u32], watch: &Watch, keep: &dyn Keep) -> Finish {
        if let Some(method) = event_driven(self.plan) {
            return self.run_events(realizations, method, watch, keep);
        }
        let replayed = matches!(self.plan.model.flow, Some(FlowFile::Replay(_)));
        match (self.moves() || replayed, self.plan.model.flows_differ()) {
            (true, false) => self.run_on_flow(realizations, watch, keep),
            (true, true) => self.run_on_flows(realizations, watch, keep),
            (false, _) => self.run_at_rest(realizations, watch, keep),
        }
    }

    /// Whether a fluid or solids move.
    pub(super) fn moves(&self) -> bool {
        self.fluid.is_some() || !self.solid_steps.is_empty()
    }

    /// Time spent to let the flow settle, s.
    #[must_use]
    pub fn settling_seconds(&self) -> f64 {
        self.fluid_seconds
    }

    /// Realizations one by one on particles at rest.
    fn run_at_rest(&self, realizations: &[u32], watch: &Watch, keep: &dyn Keep) -> Finish {
        let plan = self.plan;
        watch.begin(realizations.len() as u64, "realizations");
        let lens = Lens::new(plan, &self.scene);
        let reservoirs = Reservoirs::new(plan, &self.scene);
        let around = Surroundings { plan, frozen: &self.frozen, reservoirs: &reservoirs, start: &self.start };
        let groups = self.groups();
        let walk = Walk { plan, clock: &self.clock, watch, keep, groups: (&groups, &self.scene.plan.home) };
        each(realizations, 1, watch, |numbers| {
            let one = |&number: &u32| {
                let begin = || Realization::new(plan, &self.start, number);
                let step = |one: &mut Realization, time, tick| one.step_at_rest(&around, time, tick);
                let look = |one: &mut Realization, time| {
                    lens.look(&one.state.amounts, time, false, &mut one.observed);
                };
                (number, walk.follow(number, begin, step, look))
            };
            numbers.iter().map(one).collect()
        })
    }

    /// The scene at t = 0, the flow settled: the one made ready, or another like it; none if the user wants to stop
    /// before.
    fn scene(&self, watch: &Watch) -> Result<Option<Scene<'p, D>>, RunError> {
        if matches!(self.plan.model.flow, Some(FlowFile::Replay(_))) {
            // Shown instant by instant as the chemistry goes on.
            return Ok(Some(Scene::at_rest(self.scene.plan)));
        }
        let fresh = self.fresh.lock().unwrap_or_else(PoisonError::into_inner).take();
        match fresh {
            Some(moving) => Ok(Some(Scene::at_rest(self.scene.plan).with_motion(moving))),
            None => settled(self.scene.plan, 0, watch),
        }
    }

    /// Home group of each voxel, as a number.
    fn groups(&self) -> Vec<usize> {
        self.scene.plan.home.iter().map(|&home| usize::from(home)).collect()
    }
}

/// The shortest of steps.
fn shortest(steps: &[StepLimit]) -> Option<&StepLimit> {
    steps.iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds))
}

/// The clock of a recorded flow, if a chemistry whose step is at most `step` (s; and what limits it) can go by it.
fn recorded(plan: &Plan, title: &Title, (step, limit): (f64, &str)) -> Result<Vec<Interval>, ModelError> {
    let fault = |reason: String, remedy: String| Fault::at(&plan.model.places.run, reason, remedy);
    let clock = title.clock(&plan.model.output.times).map_err(|reason| {
        fault(reason, "choose output times among those instants, or record the flow again".into())
    })?;
    let longest = clock.iter().map(Interval::tick).fold(0.0, f64::max);
    if longest > step * (1.0 + 1e-6) {
        let (longest, step) = (show(longest, "s"), show(step, "s"));
        return Err(fault(
            format!("the flow was recorded with chemistry steps of {longest}; this chemistry needs {step} ({limit})"),
            format!("record it again with chemistry: {{ step: {step} }}"),
        )
        .into());
    }
    Ok(clock)
}

/// The particles of a realization when the flow has settled; none if the user wants to stop before.
fn settled<'p, const D: usize>(
    arena: &'p ParticlePlan<D>,
    realization: u32,
    watch: &Watch,
) -> Result<Option<Scene<'p, D>>, RunError> {
    let mut scene = Scene::new(arena, realization)?;
    if let Some(flow) = &mut scene.flow
        && !flow.settle_until(arena.settle, &|| watch.stopped())?
    {
        return Ok(None);
    }
    scene.look();
    Ok(Some(scene))
}

/// The method, if it is event driven; the plan has seen to it that the particles then rest.
fn event_driven(plan: &Plan) -> Option<Method> {
    plan.model.chemistry.method.filter(|method| method.event_driven())
}
