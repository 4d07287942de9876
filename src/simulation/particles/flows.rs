//! Realizations on flows: one flow for all of them, or for each its own.

use super::course::{Course, Crew, Travelled};
use super::{Ready, settled};
use crate::error::RunError;
use crate::plan::start::start;
use crate::scene::Scene;
use crate::simulation::each::{Found, each};
use crate::simulation::keep::Keep;
use crate::simulation::realization::Realization;
use crate::simulation::{Finish, Watch};
use std::time::Instant;

/// Memory that realizations on one flow may take together, bytes; a few of them are let on it in any case.
const MEMORY: usize = 512 << 20;
const FEW: usize = 64;

impl<'p, const D: usize> Ready<'p, D> {
    /// All realizations step by step on one flow; more than fit in memory on the same flow run again.
    pub(super) fn run_on_flow(&self, realizations: &[u32], watch: &Watch, keep: &dyn Keep) -> Finish {
        let size = Realization::new(self.plan, &self.start, 0).bytes();
        let crew = (MEMORY / size).max(FEW).min(realizations.len().max(1));
        watch.begin(self.ticks() * realizations.len().div_ceil(crew) as u64, "chemistry steps");
        let mut finish = Finish::default();
        for numbers in realizations.chunks(crew) {
            if let Err(error) = self.one_shared(numbers, &mut finish, watch, keep) {
                finish.error = finish.error.or(Some(error));
            }
            if finish.interrupted || finish.error.is_some() {
                break;
            }
        }
        finish
    }

    fn one_shared(
        &self,
        numbers: &[u32],
        finish: &mut Finish,
        watch: &Watch,
        keep: &dyn Keep,
    ) -> Result<(), RunError> {
        let begun = Instant::now();
        let Some(scene) = self.scene(watch)? else {
            finish.interrupted = true;
            return Ok(());
        };
        let prepared = begun.elapsed().as_secs_f64();
        let name = format!("flow-{}", numbers.first().copied().unwrap_or(0));
        let begin = || numbers.iter().map(|&n| Realization::new(self.plan, &self.start, n)).collect();
        let course = Course {
            file: self.plan.model.flow.as_ref(),
            ..self.course(scene, &self.start, true, watch, keep)
        };
        let way = course.follow(&name, begin, prepared)?;
        self.settle_accounts(way, finish, keep, &name)
    }

    /// Each realization on a flow of its own, as many side by side as there are threads: no more flows than that are
    /// in memory. Those that finish are kept whatever befalls others.
    pub(super) fn run_on_flows(&self, realizations: &[u32], watch: &Watch, keep: &dyn Keep) -> Finish {
        watch.begin(self.ticks() * realizations.len() as u64, "chemistry steps");
        each(realizations, 1, watch, |numbers| {
            numbers.iter().map(|&number| (number, self.one_flow(number, watch, keep))).collect()
        })
    }

    /// One realization from the flow at rest to its end.
    fn one_flow(&self, number: u32, watch: &Watch, keep: &dyn Keep) -> Found {
        let begun = Instant::now();
        let Some(scene) = settled(self.scene.plan, number, watch)? else {
            return Ok(false);
        };
        let start = start(self.plan, &scene.places());
        let name = format!("realization-{number}");
        let prepared = begun.elapsed().as_secs_f64();
        let begin = || vec![Realization::new(self.plan, &start, number)];
        let way = self.course(scene, &start, false, watch, keep).follow(&name, begin, prepared)?;
        let mut finish = Finish::default();
        self.settle_accounts(way, &mut finish, keep, &name)?;
        match finish.error {
            Some(error) => Err(error),
            None => Ok(!finish.interrupted),
        }
    }

    fn course<'r>(
        &'r self,
        scene: Scene<'p, D>,
        start: &'r crate::plan::start::Start,
        shared: bool,
        watch: &'r Watch,
        keep: &'r dyn Keep,
    ) -> Course<'r, 'p, D> {
        Course { plan: self.plan, scene, start, clock: &self.clock, shared, file: None, watch, keep }
    }

    /// Hands over what is left to hand over of realizations that came to the end of a flow or part of the way.
    fn settle_accounts(
        &self,
        way: Travelled,
        finish: &mut Finish,
        keep: &dyn Keep,
        name: &str,
    ) -> Result<(), RunError> {
        let Travelled { crew: Crew { members, error }, course, arrived, interrupted, home, .. } = way;
        finish.interrupted |= interrupted;
        // Before the realizations: counted once, however often it is run again.
        if !interrupted {
            keep.course(name, course)?;
        }
        let home = if home.is_empty() { &self.scene.plan.home } else { &home };
        let groups: Vec<usize> = home.iter().map(|&home| usize::from(home)).collect();
        for one in members {
            one.conclude(self.plan, keep, arrived, (&groups, home))?;
        }
        if arrived {
            keep.forget(name);
        }
        finish.error = finish.error.take().or(error);
        Ok(())
    }

    /// Chemistry steps of a realization.
    fn ticks(&self) -> u64 {
        self.clock.iter().map(|interval| interval.ticks).sum()
    }
}
