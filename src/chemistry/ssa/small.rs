//! The direct method in one volume of few species and reactions, for speed: as [`super::flat`], with every table of
//! a length that is known when the program is compiled. The same numbers come out, to the bit.

use super::flat::{Lane, sum_up};
use super::{Ledger, System};
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::Stream;
use rand::Rng;

/// Species, the count that is always 1, and a place for changes that change nothing.
const COUNTS: usize = 16;
/// Species that an event changes, and propensities that it makes to be computed again, at most.
const CHANGES: usize = 4;
const AFFECTED: usize = 8;

/// Propensity rate · (X_a - i) (X_b - j) (X_c - k), as in [`super::flat`].
#[derive(Clone, Copy, Debug)]
struct Product {
    rate: f64,
    less: [f64; 3],
    species: [u8; 3],
}

/// What follows from an event of a reaction.
#[derive(Clone, Copy, Debug)]
struct Event {
    change: [f64; CHANGES],
    species: [u8; CHANGES],
    affected: [u8; AFFECTED],
}

/// The network, shared by all realizations: up to `R` reactions, `P` = 2 `R` places for their propensities.
#[derive(Clone, Debug)]
pub(super) struct Tables<'a, const R: usize, const P: usize> {
    system: &'a System<'a>,
    products: [Product; P],
    events: [Event; R],
    /// Entries of the longest rows.
    changes: usize,
    affected: usize,
}

impl<'a, const R: usize, const P: usize> Tables<'a, R, P> {
    /// `None` if the system does not fit: more than mass action, more than the tables hold.
    pub fn new(system: &'a System<'a>) -> Option<Self> {
        let (reactor, frozen) = (system.reactor, system.frozen);
        let propensities = &reactor.propensities;
        let (species, reactions) = (reactor.species_count(), propensities.len());
        if reactions > R || species + 2 > COUNTS || P != 2 * R {
            return None;
        }
        let (one, nowhere) = (species as u8, species as u8 + 1);
        let nothing = Product { rate: 0.0, less: [0.0; 3], species: [one; 3] };
        let still =
            Event { change: [0.0; CHANGES], species: [nowhere; CHANGES], affected: [R as u8; AFFECTED] };
        let mut tables =
            Tables { system, products: [nothing; P], events: [still; R], changes: 0, affected: 0 };
        for r in 0..reactions {
            let (rate, factors) = propensities.product(r, frozen.scales[0])?;
            tables.products[r].rate = rate * system.weight(0, r);
            for (k, (s, less)) in factors.into_iter().enumerate() {
                (tables.products[r].species[k], tables.products[r].less[k]) = (s as u8, less);
            }
            let event = &mut tables.events[r];
            let changes = propensities.changes(r).iter().filter(|(s, _)| !frozen.is_held(*s as usize));
            for (k, &(s, change)) in changes.enumerate() {
                *event.species.get_mut(k)? = s as u8;
                event.change[k] = change;
                tables.changes = tables.changes.max(k + 1);
            }
            for (k, &q) in propensities.affected(r).iter().enumerate() {
                *event.affected.get_mut(k)? = q as u8;
                tables.affected = tables.affected.max(k + 1);
            }
        }
        Some(tables)
    }
}

/// One realization of one volume.
#[derive(Clone, Debug)]
pub(super) struct Small<'a, const R: usize, const P: usize> {
    tables: &'a Tables<'a, R, P>,
    counts: [f64; COUNTS],
    rates: [f64; P],
    partial: [f64; R],
    fired: [u64; R],
    total: f64,
    time: f64,
    /// Time of the next event, s.
    next: f64,
    random: Stream,
    ledger: Ledger,
}

impl<'a, const R: usize, const P: usize> Small<'a, R, P> {
    /// Starts from `amounts` (molecules).
    pub fn new(tables: &'a Tables<'a, R, P>, amounts: Vec<f64>, random: Stream) -> Result<Self, RunError> {
        let mut counts = [0.0; COUNTS];
        counts[..amounts.len()].copy_from_slice(&amounts);
        counts[amounts.len()] = 1.0;
        let mut small = Small {
            tables,
            counts,
            rates: [0.0; P],
            partial: [0.0; R],
            fired: [0; R],
            total: 0.0,
            time: 0.0,
            next: f64::INFINITY,
            random,
            ledger: Ledger::new(tables.system, amounts),
        };
        for r in 0..R {
            small.rates[r] = small.value(r);
        }
        small.total = sum_up(&small.rates, &mut small.partial);
        small.check_total()?;
        if small.total > 0.0 {
            small.next = exponential(&mut small.random) / small.total;
        }
        Ok(small)
    }

    #[inline(always)]
    fn value(&self, q: usize) -> f64 {
        let product = &self.tables.products[q % P];
        let factor = |k: usize| self.counts[product.species[k] as usize % COUNTS] - product.less[k];
        product.rate * factor(0) * (factor(1) * factor(2))
    }

    /// Tells which propensity is to blame for a total that is none.
    #[cold]
    fn check_total(&self) -> Result<(), RunError> {
        if (0.0..f64::INFINITY).contains(&self.total) {
            return Ok(());
        }
        let reactor = self.tables.system.reactor;
        let r = (0..R).max_by(|&a, &b| self.rates[a].total_cmp(&self.rates[b])).unwrap_or(0);
        let row = &self.counts[..reactor.species_count()];
        Err(reactor.bad_propensity(r, self.rates[r], self.time, 0, row))
    }
}

impl<const R: usize, const P: usize> Lane for Small<'_, R, P> {
    #[inline(always)]
    fn next(&self) -> f64 {
        self.next
    }

    #[inline(always)]
    fn event(&mut self) -> Result<(), RunError> {
        self.time = self.next;
        let left = self.random.random::<f64>() * self.total;
        let wait = exponential(&mut self.random);
        let r = self.partial.iter().map(|&sum| usize::from(sum <= left)).sum::<usize>() % R;
        self.fired[r] += 1;
        let tables = self.tables;
        let event = &tables.events[r];
        for k in 0..tables.changes.min(CHANGES) {
            self.counts[event.species[k] as usize % COUNTS] += event.change[k];
        }
        for k in 0..tables.affected.min(AFFECTED) {
            let q = event.affected[k] as usize % P;
            self.rates[q] = self.value(q);
        }
        self.total = sum_up(&self.rates, &mut self.partial);
        self.next = self.time + wait / self.total;
        if !(self.total > 0.0 && self.total < f64::INFINITY) {
            self.check_total()?;
            self.next = f64::INFINITY;
        }
        Ok(())
    }

    fn reach(&mut self, until: f64) -> Result<(), RunError> {
        self.time = self.time.max(until);
        self.ledger.time = self.time;
        let (species, reactions) = (self.ledger.amounts.len(), self.ledger.fired.len());
        self.ledger.amounts.copy_from_slice(&self.counts[..species]);
        self.ledger.fired.copy_from_slice(&self.fired[..reactions]);
        self.ledger.balance(self.tables.system)
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn into_ledger(self) -> Ledger {
        self.ledger
    }
}
