//! The course of one flow with the realizations on it, step by step; taken up from its last saved state if there is
//! one.

use super::recording::{Frame, Player, Recorder, Title};
use crate::error::RunError;
use crate::model::FlowFile;
use crate::model::changes::flow_makings;
use crate::plan::Plan;
use crate::plan::start::Start;
use crate::record::TemperatureRecord;
use crate::sampling::Lens;
use crate::scene::{self, Scene};
use crate::simulation::clock::Interval;
use crate::simulation::freeze::freeze;
use crate::simulation::keep::{CourseShare, Keep, PIECE, hand_over};
use crate::simulation::realization::{Exchange, Image, Realization, Reservoirs, Surroundings};
use crate::simulation::states::{decode, foreign, save};
use crate::simulation::{FlowTally, Watch};
use rayon::prelude::*;
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::time::Instant;

/// Values that realizations on one flow may hold together before they hand over pieces: 64 MB.
const TOGETHER: usize = 1 << 23;

/// A flow at t = 0 and the chemistry's view of it.
pub(super) struct Course<'r, 'p, const D: usize> {
    pub plan: &'p Plan,
    pub scene: Scene<'p, D>,
    pub start: &'r Start,
    pub clock: &'r [Interval],
    /// Whether all realizations of the run see this flow.
    pub shared: bool,
    /// Where the flow is recorded, or taken from.
    pub file: Option<&'r FlowFile>,
    pub watch: &'r Watch,
    pub keep: &'r dyn Keep,
}

/// The realizations on a flow, and the first failure among them or of the flow.
#[derive(Default)]
pub(super) struct Crew {
    pub members: Vec<Realization>,
    pub error: Option<RunError>,
}

/// How far a course came.
#[derive(Default)]
pub(super) struct Travelled {
    pub crew: Crew,
    pub course: CourseShare,
    /// Temperatures at the output times of the second half.
    warmth: TemperatureRecord,
    /// Home group of each voxel at the end; empty if it did not come so far.
    pub home: Vec<u8>,
    /// Whether the realizations that are left came to the end.
    pub arrived: bool,
    pub interrupted: bool,
}

/// Where a course stands: intervals that are behind it, chemistry steps of the present one, and fluid steps of the
/// present one of these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Point {
    interval: usize,
    ticks: u64,
    /// Whether the first half of the chemistry of the present step is done.
    begun: bool,
    fluid_steps: u64,
}

impl Point {
    /// Whether it is in the chemistry step of another.
    fn reaches(&self, other: &Point) -> bool {
        self.interval == other.interval && self.ticks == other.ticks
    }
}

/// A course that was kept.
#[derive(Deserialize)]
struct Saved<const D: usize> {
    at: Point,
    warmth: TemperatureRecord,
    /// Bytes of the flow's record that were written.
    recorded: Option<u64>,
    scene: scene::Image<'static, D>,
    members: Vec<Image>,
    course: CourseShare,
}

/// A [`Saved`] on its way out.
#[derive(Serialize)]
struct Saving<'a, const D: usize> {
    at: Point,
    warmth: TemperatureRecord,
    /// Bytes of the flow's record that were written.
    recorded: Option<u64>,
    scene: scene::Image<'a, D>,
    members: Images<'a>,
    course: CourseShare,
}

/// Images of realizations, made one at a time.
struct Images<'a>(&'a [Realization]);

impl Serialize for Images<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(Realization::image))
    }
}

/// Where the flow goes to, or comes from, besides the run itself.
enum Tape<const D: usize> {
    None,
    Record(Recorder),
    Play(Player<D>),
}

/// The particles as they are now.
fn shot<const D: usize>(scene: &Scene<D>) -> Frame<D> {
    Frame { snapshot: scene.snapshot.clone(), presence: scene.presence().to_vec() }
}

impl<const D: usize> Tape<D> {
    /// The tape of a course that stands at `from`, `recorded` bytes of it written before.
    fn new(course: &mut Course<D>, from: &Point, recorded: Option<u64>) -> Result<Tape<D>, RunError> {
        match course.file {
            None => Ok(Tape::None),
            Some(FlowFile::Record(path)) => {
                let makings = flow_makings(&course.plan.model.text);
                let title = Title::new(course.scene.plan, course.clock, makings);
                let mut recorder = Recorder::new(path, &title, recorded)?;
                if recorded.is_none() {
                    recorder.push(&shot(&course.scene))?;
                }
                Ok(Tape::Record(recorder))
            }
            Some(FlowFile::Replay(path)) => {
                let mut player = Player::open(path, course.scene.plan)?;
                let behind: u64 = course.clock[..from.interval].iter().map(|i| i.ticks).sum();
                // The first instant is t = 0; the last one shown is that of the present step.
                for _ in 0..=behind + from.ticks {
                    let Frame { snapshot, presence } = player.next()?;
                    course.scene.show(snapshot, presence);
                }
                Ok(Tape::Play(player))
            }
        }
    }
}

impl<const D: usize> Course<'_, '_, D> {
    /// Takes realizations through all output times: half a step of chemistry, the motion, the other half. What lifts
    /// the fluid is the state of the first member between the halves; where members differ each has its own course.
    /// `prepared` seconds were spent on the flow before.
    pub fn follow(
        mut self,
        name: &str,
        begin: impl FnOnce() -> Vec<Realization>,
        prepared: f64,
    ) -> Result<Travelled, RunError> {
        let mut way = Travelled::default();
        way.course.fluid_seconds = prepared;
        let mut recorded = None;
        let from = match self.keep.saved(name)? {
            Some(state) => {
                let saved: Saved<D> = decode(&state, name)?;
                recorded = saved.recorded;
                self.take_up(saved, &mut way).ok_or_else(|| foreign(name))?
            }
            None => {
                way.crew.members = begin();
                if let Some(first) = way.crew.members.first() {
                    let (amounts, species) = (&first.state.amounts, &self.plan.reactor.species);
                    if let Err(found) = self.scene.soften_at_start(amounts, species) {
                        return Ok(self.failed(found, way));
                    }
                }
                Point::default()
            }
        };
        let mut tape = Tape::new(&mut self, &from, recorded)?;
        // With what was born since.
        let mut start = Cow::Borrowed(self.start);
        let species = self.plan.reactor.species_count();
        if !self.scene.born.is_empty() {
            start.to_mut().bear(&self.scene.born, species);
        }
        let mut frozen = freeze(self.plan, &self.scene, &start)?;
        let mut reservoirs = Reservoirs::new(self.plan, &self.scene);
        if from == Point::default() && !self.scene.vessels.is_empty() {
            // Volumes have changed as walls came to balance.
            let around =
                Surroundings { plan: self.plan, frozen: &frozen, reservoirs: &reservoirs, start: &start };
            way.crew.members.iter_mut().for_each(|one| one.hold_in_solids(&around));
        }
        let (mut patience, mut saved_at) = (self.keep.patience(), Instant::now());
        let piece = (TOGETHER / way.crew.members.len().max(1)).clamp(1 << 10, PIECE);
        for (i, interval) in self.clock.iter().enumerate().skip(from.interval) {
            let tick = interval.tick();
            let first = if i == from.interval { from.ticks } else { 0 };
            for k in first..interval.ticks {
                let (time, half) = (interval.time(k), 0.5 * tick);
                let plan = self.plan;
                let mut at = Point { interval: i, ticks: k, begun: false, fluid_steps: 0 };
                if at.reaches(&from) {
                    at = from;
                }
                // Before the motion, and again each time it is broken off, the state can be saved.
                loop {
                    let stop = self.watch.stopped();
                    let due = patience.is_some_and(|patience| stop || saved_at.elapsed() > patience);
                    // What has just begun is begun again as fast as it is taken up.
                    // A realization that failed fails again after the state before it; without it, nobody would know.
                    if due && at != from && way.crew.error.is_none() {
                        self.save(name, at, &mut tape, &way)?;
                        patience = self.keep.patience();
                    }
                    if due {
                        saved_at = Instant::now();
                    }
                    if stop {
                        way.interrupted = true;
                        return Ok(way);
                    }
                    let chemistry = Instant::now();
                    if !at.begun {
                        at.begun = true;
                        let (frozen, reservoirs) = (&frozen, &reservoirs);
                        let before = Surroundings { plan, frozen, reservoirs, start: &start };
                        way.crew.advance(|one| one.before_motion(&before, time, half));
                        let lifted = way.crew.members.first().filter(|_| !self.scene.plan.lifts.is_empty());
                        if let Some(first) = lifted {
                            self.scene.lift(&first.state.amounts, plan.reactor.species.len());
                        }
                        if let Some(first) = way.crew.members.first() {
                            let done: u64 = self.clock[..i].iter().map(|interval| interval.ticks).sum();
                            let (amounts, species) = (&first.state.amounts, &plan.reactor.species);
                            if let Err(found) = self.scene.soften(amounts, species, (done + k, time)) {
                                return Ok(self.failed(found, way));
                            }
                        }
                    }
                    let fluid = Instant::now();
                    way.course.chemistry_seconds += (fluid - chemistry).as_secs_f64();
                    let watch = self.watch;
                    let break_off =
                        || watch.stopped() || patience.is_some_and(|patience| saved_at.elapsed() > patience);
                    let left = interval.fluid_steps - at.fluid_steps;
                    let moved = match &mut tape {
                        Tape::Play(player) => player.next().map(|Frame { snapshot, presence }| {
                            self.scene.show(snapshot, presence);
                            left
                        }),
                        _ => self.scene.advance(tick / interval.fluid_steps as f64, left, &break_off),
                    };
                    way.course.fluid_seconds += fluid.elapsed().as_secs_f64();
                    match moved {
                        Ok(taken) if taken == left => break,
                        Ok(taken) => at.fluid_steps += taken,
                        // The flow carries them all.
                        Err(found) => return Ok(self.failed(found, way)),
                    }
                }
                if let Tape::Record(recorder) = &mut tape {
                    recorder.push(&shot(&self.scene))?;
                }
                let chemistry = Instant::now();
                if !self.scene.births.is_empty() {
                    start.to_mut().bear(&self.scene.births, species);
                }
                match freeze(plan, &self.scene, &start) {
                    Ok(found) => frozen = found,
                    Err(found) => return Ok(self.failed(found, way)),
                }
                reservoirs = Reservoirs::new(plan, &self.scene);
                let after = Surroundings { plan, frozen: &frozen, reservoirs: &reservoirs, start: &start };
                let exchange = Exchange::new(plan, &self.scene);
                way.crew.advance(|one| {
                    one.cross(plan, &start, &exchange);
                    one.after_motion(&after, time + half, half)
                });
                way.course.chemistry_seconds += chemistry.elapsed().as_secs_f64();
                if way.crew.members.is_empty() {
                    self.book(&mut way);
                    return Ok(way);
                }
                self.watch.advance(1);
            }
            let lens = Lens::new(self.plan, &self.scene);
            let look = |one: &mut Realization| {
                lens.look(&one.state.amounts, interval.end, self.shared, &mut one.observed);
                hand_over(&mut one.observed, self.keep, piece)
            };
            way.crew.members.par_iter_mut().try_for_each(look)?;
            // A flow may start cold: what it has come to is what counts.
            if 2.0 * interval.end >= self.plan.model.run.until
                && let Some(temperature) = self.scene.temperature()
            {
                way.warmth.look(temperature);
            }
        }
        self.book(&mut way);
        if let Tape::Record(recorder) = tape {
            recorder.finish(&way.course)?;
        }
        way.arrived = true;
        way.home.clone_from(&self.scene.home);
        Ok(way)
    }

    /// The end of a course whose flow failed.
    fn failed(&self, found: RunError, mut way: Travelled) -> Travelled {
        way.crew.error.get_or_insert(found);
        self.book(&mut way);
        way
    }

    /// Keeps the state between two steps.
    fn save(&self, name: &str, at: Point, tape: &mut Tape<D>, way: &Travelled) -> Result<(), RunError> {
        let recorded = match tape {
            Tape::Record(recorder) => {
                recorder.flush()?;
                Some(recorder.length)
            }
            _ => None,
        };
        let members = Images(&way.crew.members);
        let (scene, course) = (self.scene.image(), way.course.clone());
        save(self.keep, name, &Saving { at, warmth: way.warmth, recorded, scene, members, course })
    }

    /// Goes back to a state; where it stands. `None` if it belongs to another plan.
    fn take_up(&mut self, saved: Saved<D>, way: &mut Travelled) -> Option<Point> {
        self.scene.restore(saved.scene)?;
        for image in saved.members {
            way.crew.members.push(Realization::restore(self.plan, image)?);
        }
        let prepared = way.course.fluid_seconds;
        way.course = saved.course;
        way.course.fluid_seconds += prepared;
        way.warmth = saved.warmth;
        Some(saved.at)
    }

    /// What the flow says of itself.
    fn book(&self, way: &mut Travelled) {
        let course = &mut way.course;
        if let Some(solids) = self.scene.solid_health() {
            course.solid_particle_steps = solids.particle_steps;
            course.bond_evaluations = solids.bond_evaluations;
            course.flow.largest_stretch = Some(solids.largest_stretch);
        }
        let Some(flow) = &self.scene.flow else { return };
        course.particle_steps = flow.particle_steps();
        course.pair_evaluations = flow.pair_evaluations();
        let health = flow.health();
        course.flow = FlowTally {
            momentum_drift: self.scene.momentum_drift(),
            penetrations: health.penetrations,
            bounces: health.bounces,
            largest_mach: health.largest_mach,
            largest_density_change: health.largest_density_change,
            warnings: health.warnings,
            temperature: Some(way.warmth).filter(|warmth| warmth.looks > 0),
            largest_stretch: course.flow.largest_stretch,
        };
    }
}

impl Crew {
    /// Takes every realization a part of a step on; one that fails is left behind, and the first failure is told.
    fn advance(&mut self, part: impl Fn(&mut Realization) -> Result<(), RunError> + Sync + Send) {
        let part =
            |one: &mut Realization| part(one).map_err(|error| error.of(one.observed.series.realization));
        let results: Vec<Result<(), RunError>> = self.members.par_iter_mut().map(part).collect();
        let mut results = results.into_iter();
        self.members.retain(|_| match results.next() {
            Some(Err(found)) => {
                self.error.get_or_insert(found);
                false
            }
            _ => true,
        });
    }
}
