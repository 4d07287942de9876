//! The direct method for one well-mixed volume (Gillespie 1976, 1977), with the dependency graph of Gibson
//! & Bruck (2000) deciding which propensities to compute again.

use super::events::{Cells, choose};
use super::{Counters, EventMethod};
use crate::chemistry::reactor::Reactor;
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::{Purpose, Stream, stream};
use rand::Rng;

/// One realization of a well-mixed volume.
#[derive(Clone, Debug)]
pub struct Direct<'a> {
    cells: Cells<'a>,
    /// Propensity of every reaction; zero for those that do not happen here.
    propensities: Vec<f64>,
    happens: Vec<bool>,
    total: f64,
    time: f64,
    /// Time of the next event.
    next: f64,
    random: Stream,
}

impl<'a> Direct<'a> {
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
    ) -> Result<Direct<'a>, RunError> {
        let reactions = reactor.propensities.len();
        let mut direct = Direct {
            cells: Cells::new(reactor, &[volume], held, amounts),
            propensities: vec![0.0; reactions],
            happens: (0..reactions).map(|r| reactor.happens(r, group, group)).collect(),
            total: 0.0,
            time: 0.0,
            next: f64::INFINITY,
            random: stream(seed, realization, Purpose::Reactions),
        };
        for r in 0..reactions {
            if direct.happens[r] {
                direct.propensities[r] = direct.cells.propensity(r, 0, 0.0)?;
            }
        }
        direct.draw();
        Ok(direct)
    }

    /// The waiting time to the next event, exponential with mean 1 / a_0.
    fn draw(&mut self) {
        self.total = self.propensities.iter().sum();
        self.next = match self.total {
            a if a > 0.0 => self.time + exponential(&mut self.random) / a,
            _ => f64::INFINITY,
        };
    }
}

impl EventMethod for Direct<'_> {
    fn advance(&mut self, until: f64) -> Result<(), RunError> {
        while self.next <= until {
            self.time = self.next;
            let r = choose(self.propensities.iter().copied(), self.total, self.random.random());
            self.cells.apply(r, 0, self.time)?;
            let reactor = self.cells.reactor;
            for &q in reactor.propensities.affected(r) {
                let q = q as usize;
                if self.happens[q] {
                    self.propensities[q] = self.cells.propensity(q, 0, self.time)?;
                }
            }
            self.draw();
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
