//! Many realizations of one volume on one core, a few at a time, one event of each in turn.
//!
//! Within a realization every event waits for the one before it; a processor that has others at hand gets on with
//! them meanwhile. Each realization comes out as it would alone.

use super::flat::{Flat, Lane};
use super::small::{Small, Tables};
use super::{Key, Ledger, System};
use crate::error::RunError;
use crate::random::{Purpose, stream};

/// Realizations under way at a time: as many as a core can overlap.
const LANES: usize = 4;

/// A time at which a realization halts, s, and whether it is looked at there.
pub type Halt = (f64, bool);

/// What came of a realization: its books at the last halt, `None` if it was stopped.
pub type Played = Result<Option<Ledger>, RunError>;

/// What to play: how many realizations through which halts, which rise; amounts (molecules) and key of each.
pub struct Task<'t> {
    pub count: usize,
    pub halts: &'t [Halt],
    pub start: &'t dyn Fn(usize) -> (Vec<f64>, Key),
    /// Asked at every halt.
    pub stopped: &'t dyn Fn() -> bool,
}

/// Whether a system can be played side by side: nothing but reactions in one volume.
#[must_use]
pub fn fits(system: &System) -> bool {
    Flat::fits(system)
}

/// Plays the realizations of a task; `look` sees number and amounts of each at the halts that say so.
pub fn side_by_side(system: &System, task: &Task, look: impl FnMut(usize, &[f64])) -> Vec<Played> {
    let random = |key: Key| stream(key.0, key.1, Purpose::Reactions);
    if let Some(tables) = Tables::<4, 8>::new(system) {
        play(task, |amounts, key| Small::new(&tables, amounts, random(key)), look)
    } else if let Some(tables) = Tables::<8, 16>::new(system) {
        play(task, |amounts, key| Small::new(&tables, amounts, random(key)), look)
    } else {
        play(task, |amounts, key| Flat::new(system, amounts, random(key)), look)
    }
}

/// A realization under way: its number, the halt it is heading for, its state.
struct Runner<L> {
    number: usize,
    halt: usize,
    lane: L,
}

fn play<L: Lane>(
    task: &Task,
    new: impl Fn(Vec<f64>, Key) -> Result<L, RunError>,
    mut look: impl FnMut(usize, &[f64]),
) -> Vec<Played> {
    let mut played: Vec<Played> = (0..task.count).map(|_| Ok(None)).collect();
    let mut runners: Vec<Runner<L>> = Vec::with_capacity(LANES);
    let mut begun = 0;
    while !(task.stopped)() {
        while runners.len() < LANES && begun < task.count {
            let (amounts, key) = (task.start)(begun);
            match new(amounts, key) {
                Ok(lane) => runners.push(Runner { number: begun, halt: 0, lane }),
                Err(error) => played[begun] = Err(error),
            }
            begun += 1;
        }
        let Some((at, result)) = next_arrival(&mut runners, task.halts) else { break };
        let runner = &mut runners[at];
        if result.is_ok() && task.halts[runner.halt].1 {
            look(runner.number, &runner.lane.ledger().amounts);
        }
        runner.halt += 1;
        if result.is_err() || runner.halt == task.halts.len() {
            let runner = runners.swap_remove(at);
            played[runner.number] = result.map(|()| Some(runner.lane.into_ledger()));
        }
    }
    played
}

/// Plays events in turn until a realization arrives at its halt or fails; `None` if there is none, or no halt.
fn next_arrival<L: Lane>(runners: &mut [Runner<L>], halts: &[Halt]) -> Option<(usize, Result<(), RunError>)> {
    if runners.is_empty() || halts.is_empty() {
        return None;
    }
    loop {
        for (at, runner) in runners.iter_mut().enumerate() {
            let (until, seen) = halts[runner.halt];
            if runner.lane.next() > until {
                // The books are wanted where somebody looks.
                return Some((at, if seen { runner.lane.reach(until) } else { Ok(()) }));
            }
            if let Err(error) = runner.lane.event() {
                return Some((at, Err(error)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::network::Kinetics;
    use crate::chemistry::reactor::example::{Equation, network};
    use crate::chemistry::split::Frozen;
    use crate::chemistry::ssa::{Direct, EventMethod};
    use crate::chemistry::{Links, Reactor};

    /// Realizations side by side, in tables of either length and without, are those of the direct method alone.
    #[test]
    fn each_is_as_it_would_be_alone() {
        let birth: Equation = (&[], &[(0, 1)], 30.0);
        let turns: Vec<Equation> = vec![
            (&[(0, 1)], &[(1, 1)], 1.0),
            (&[(1, 1)], &[(0, 1)], 0.5),
            (&[(0, 2)], &[(2, 1)], 0.02),
            (&[(2, 1)], &[(0, 2)], 1.0),
            (&[(0, 1), (1, 1)], &[(2, 1)], 0.01),
            (&[(0, 1)], &[], 0.3),
            (&[(2, 1)], &[], 0.1),
            (&[(1, 1)], &[], 0.2),
            (&[(2, 1), (1, 1)], &[(1, 1)], 0.01),
        ];
        for count in [2, 6, 9] {
            let equations: Vec<Equation> =
                std::iter::once(birth).chain(turns[..count].iter().copied()).collect();
            let network = network(Kinetics::Molecules, 3, &equations);
            let reactor = Reactor::everywhere(&network, &[true; 3]);
            let frozen = Frozen::build(&reactor, &Links::none(1), &[1.0], &[0], &[0], &[]).unwrap();
            let system = System::new(&reactor, &frozen);
            let start = |k: usize| (vec![10.0 + k as f64, 5.0, 0.0], (9, k as u64));
            let halts = [(0.5, true), (1.0, false), (2.0, true)];
            let mut seen = vec![Vec::new(); 11];
            let task = Task { count: 11, halts: &halts, start: &start, stopped: &|| false };
            let played = side_by_side(&system, &task, |k, amounts| seen[k].push(amounts.to_vec()));
            for (k, played) in played.into_iter().enumerate() {
                let (amounts, key) = start(k);
                let mut alone = Direct::new(&system, amounts, key).unwrap();
                alone.advance(0.5).unwrap();
                assert_eq!(alone.amounts(), seen[k][0]);
                alone.advance(2.0).unwrap();
                assert_eq!(alone.amounts(), seen[k][1]);
                assert_eq!(alone.ledger().fired, played.unwrap().unwrap().fired);
            }
        }
    }
}
