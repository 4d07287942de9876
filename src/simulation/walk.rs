//! A realization in chemistry steps on voxels that stay where they are; taken up from its last saved state if there
//! is one.

use super::clock::Interval;
use super::each::Found;
use super::hybrids;
use super::keep::{Keep, PIECE, Share, hand_over};
use super::realization::{Image, Realization};
use super::states::{decode, foreign, save};
use super::watch::Watch;
use crate::error::RunError;
use crate::plan::Plan;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// What surrounds the steps.
pub(super) struct Walk<'a> {
    pub plan: &'a Plan,
    pub clock: &'a [Interval],
    pub watch: &'a Watch,
    pub keep: &'a dyn Keep,
    /// Group and home group of each voxel.
    pub groups: (&'a [usize], &'a [u8]),
}

/// A realization between two steps: intervals and steps of the current one behind it.
#[derive(Serialize, Deserialize)]
struct Saved {
    interval: usize,
    ticks: u64,
    seconds: f64,
    one: Image,
}

impl Walk<'_> {
    /// Takes a realization that `begin`s at t = 0 through the clock by `step`s (from a time, s, by a tick, s) and
    /// `look`s (at a time).
    pub fn follow(
        &self,
        number: u32,
        begin: impl FnOnce() -> Realization,
        mut step: impl FnMut(&mut Realization, f64, f64) -> Result<(), RunError>,
        mut look: impl FnMut(&mut Realization, f64),
    ) -> Found {
        let (name, mut patience) = (format!("realization-{number}"), self.keep.patience());
        let mut begun = Instant::now();
        let mut saved_at = begun;
        let (mut one, from, mut seconds) = match self.keep.saved(&name)?.map(|state| decode(&state, &name)) {
            Some(saved) => {
                let saved: Saved = saved?;
                let one = Realization::restore(self.plan, saved.one).ok_or_else(|| foreign(&name))?;
                (one, (saved.interval, saved.ticks), saved.seconds)
            }
            None => (begin(), (0, 0), 0.0),
        };
        for (i, interval) in self.clock.iter().enumerate().skip(from.0) {
            let first = if i == from.0 { from.1 } else { 0 };
            for k in first..interval.ticks {
                let stop = self.watch.stopped();
                let due = patience.is_some_and(|patience| stop || saved_at.elapsed() > patience);
                // What has just begun is begun again as fast as it is taken up.
                if due && (i, k) > from {
                    seconds += begun.elapsed().as_secs_f64();
                    begun = Instant::now();
                    let state = Saved { interval: i, ticks: k, seconds, one: one.image() };
                    save(self.keep, &name, &state)?;
                    (patience, saved_at) = (self.keep.patience(), Instant::now());
                }
                if stop {
                    return Ok(false);
                }
                step(&mut one, interval.time(k), interval.tick())?;
            }
            look(&mut one, interval.end);
            hand_over(&mut one.observed, self.keep, PIECE)?;
        }
        let share = Share { seconds: seconds + begun.elapsed().as_secs_f64(), ..self.share(&one) };
        hand_over(&mut one.observed, self.keep, 0)?;
        self.keep.finished(number, share)?;
        self.keep.forget(&name);
        Ok(true)
    }

    /// What a realization that is done adds to the books.
    fn share(&self, one: &Realization) -> Share {
        share(self.plan, one, self.groups)
    }
}

/// What a realization that is done adds to the books; `groups`: group and home group of each voxel.
pub(super) fn share(plan: &Plan, one: &Realization, groups: (&[usize], &[u8])) -> Share {
    Share {
        counters: one.state.counters,
        supplied: one.state.supplied.clone(),
        lost: one.state.astray(&plan.reactor, &one.total),
        withheld: one.state.withheld,
        hybrid: hybrids::history(plan, &one.state.modes, groups),
        seconds: 0.0,
    }
}
