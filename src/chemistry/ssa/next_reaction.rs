//! The next reaction method for one well-mixed volume (Gibson & Bruck 2000): every reaction has a time of
//! its own in an indexed heap, and after an event only those times are touched whose propensity changed.
//! Pays against [`super::Direct`] for networks of many loosely coupled reactions.

use super::events::Cells;
use super::heap::TimeHeap;
use super::{Counters, EventMethod};
use crate::chemistry::reactor::Reactor;
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};

/// One realization of a well-mixed volume.
#[derive(Clone, Debug)]
pub struct NextReaction<'a> {
    cells: Cells<'a>,
    /// Propensity of every reaction; zero for those that do not happen here.
    propensities: Vec<f64>,
    happens: Vec<bool>,
    heap: TimeHeap,
    time: f64,
    random: Stream,
}

impl<'a> NextReaction<'a> {
    /// A volume of `volume` m³ in group `group` that starts from `amounts` (molecules); `held` flags
    /// species whose amount never changes (empty for none).
    ///
    /// # Errors
    /// A propensity that is negative or not finite at the start.
    pub fn new(
        reactor: &'a Reactor,
        volume: f64,
        group: u8,
        held: &[bool],
        amounts: Vec<f64>,
        (seed, realization): (u64, u64),
    ) -> Result<NextReaction<'a>, RunError> {
        let cells = Cells::new(reactor, &[volume], held, amounts);
        let mut random = stream(seed, realization, Purpose::Reactions);
        let reactions = reactor.propensities.len();
        let happens: Vec<bool> = (0..reactions).map(|r| reactor.happens(r, group, group)).collect();
        let mut propensities = vec![0.0; reactions];
        let mut times = vec![f64::INFINITY; reactions];
        for r in (0..reactions).filter(|&r| happens[r]) {
            propensities[r] = cells.propensity(r, 0, 0.0)?;
            times[r] = waiting(&mut random, 0.0, propensities[r]);
        }
        Ok(NextReaction { cells, propensities, happens, heap: TimeHeap::new(times), time: 0.0, random })
    }

    /// New propensity of reaction `q` after an event of reaction `r`; the time it has left is rescaled.
    fn update(&mut self, q: usize, r: usize) -> Result<(), RunError> {
        let before = std::mem::replace(&mut self.propensities[q], self.cells.propensity(q, 0, self.time)?);
        let after = self.propensities[q];
        let time = if q == r || before <= 0.0 || after <= 0.0 {
            waiting(&mut self.random, self.time, after)
        } else {
            self.time + (self.heap.time(q) - self.time) * (before / after)
        };
        self.heap.set(q, time);
        Ok(())
    }
}

fn waiting(random: &mut Stream, time: f64, propensity: f64) -> f64 {
    if propensity > 0.0 { time + exponential(random) / propensity } else { f64::INFINITY }
}

impl EventMethod for NextReaction<'_> {
    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        let reactor = self.cells.reactor;
        while let Some((r, time)) = self.heap.first() {
            if time > until || time == f64::INFINITY {
                break;
            }
            self.time = time;
            self.cells.apply(r, 0, time)?;
            let affected = reactor.propensities.affected(r);
            for &q in affected {
                if self.happens[q as usize] && q as usize != r {
                    self.update(q as usize, r)?;
                }
            }
            // The reaction itself always waits anew, also where its propensity stayed (a source).
            self.update(r, r)?;
        }
        self.time = self.time.max(until);
        Ok(())
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn amounts(&self) -> &[f64] {
        &self.cells.amounts
    }

    fn supplied(&self) -> &[f64] {
        &self.cells.supplied
    }

    fn fired(&self) -> &[u64] {
        &self.cells.fired
    }

    fn counters(&self) -> Counters {
        self.cells.counters
    }
}
