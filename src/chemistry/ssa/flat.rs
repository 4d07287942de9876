//! The direct method in one volume, for speed: every mass-action propensity is a product of three factors,
//! and nothing in the loop branches on what is drawn.

use super::{Ledger, System};
use crate::chemistry::propensity::Rows;
use crate::chemistry::sampling_numbers::exponential;
use crate::error::RunError;
use crate::random::Stream;
use rand::Rng;

/// Propensity rate · (X_a - i) (X_b - j) (X_c - k); a factor that is not there points at a count that is
/// always 1.
#[derive(Clone, Copy, Debug)]
struct Product {
    rate: f64,
    species: [u32; 3],
    less: [f64; 3],
}

impl Product {
    #[inline]
    fn value(&self, counts: &[f64]) -> f64 {
        let factor = |k: usize| counts[self.species[k] as usize] - self.less[k];
        self.rate * factor(0) * (factor(1) * factor(2))
    }
}

/// Entries a block of partial sums holds.
const BLOCK: usize = 4;
/// Rows of changes and dependencies are filled up to equal length if none is longer than this: loops of one
/// length are foreseen by the processor, and cost less than those that are short by chance.
const EVEN: usize = 8;

/// The verbs of a realization of one volume.
pub(super) trait Lane {
    /// Time of the next event, s.
    fn next(&self) -> f64;

    /// Plays the next event and draws the time of the one after.
    fn event(&mut self) -> Result<(), RunError>;

    /// Ends at `until`, no event being due before, and brings the books up to date.
    fn reach(&mut self, until: f64) -> Result<(), RunError>;

    fn ledger(&self) -> &Ledger;

    fn into_ledger(self) -> Ledger;
}

/// One realization of one volume.
#[derive(Clone, Debug)]
pub(super) struct Flat<'a> {
    system: &'a System<'a>,
    ledger: Ledger,
    /// Molecules of each species, then a 1, then a place for changes that change nothing.
    counts: Vec<f64>,
    /// One for each reaction, filled up to whole blocks and one more by products that are zero.
    products: Vec<Product>,
    /// What an event of each reaction changes of the counts; held species are left out.
    changes: Rows<(u32, f64)>,
    /// Products to compute again after each reaction.
    affected: Rows<u32>,
    /// Rate laws to compute again after each reaction.
    laws: Rows<u32>,
    has_laws: bool,
    /// Propensities, 1/s, and their partial sums.
    rates: Vec<f64>,
    partial: Vec<f64>,
    total: f64,
    /// Time of the next event, s.
    next: f64,
    random: Stream,
}

impl<'a> Flat<'a> {
    /// Whether a system has nothing but reactions in one volume.
    pub fn fits(system: &System) -> bool {
        let reactions = system.reactor.propensities.len();
        system.frozen.voxels() == 1 && system.width() == reactions && !system.has_means()
    }

    /// Starts from `amounts` (molecules).
    pub fn new(system: &'a System<'a>, amounts: Vec<f64>, random: Stream) -> Result<Flat<'a>, RunError> {
        let (reactor, scale) = (system.reactor, system.frozen.scales[0]);
        let (species, reactions) = (reactor.species_count(), reactor.propensities.len());
        let (one, nowhere) = (species as u32, species as u32 + 1);
        let places = reactions.div_ceil(BLOCK) * BLOCK;
        let nothing = Product { rate: 0.0, species: [one; 3], less: [0.0; 3] };
        let mut products = vec![nothing; places + 1];
        let mut is_law = vec![false; reactions];
        for (r, law) in is_law.iter_mut().enumerate() {
            match reactor.propensities.product(r, scale) {
                Some((rate, factors)) => {
                    products[r].rate = rate * system.weight(0, r);
                    for (k, (s, less)) in factors.into_iter().enumerate() {
                        (products[r].species[k], products[r].less[k]) = (s, less);
                    }
                }
                None => *law = system.weight(0, r) > 0.0,
            }
        }
        let changes = (0..reactions).map(|r| {
            let changes = reactor.propensities.changes(r).iter().copied();
            changes.filter(|&(s, _)| !system.frozen.is_held(s as usize)).collect()
        });
        let touched = |r: usize, law: bool| -> Vec<u32> {
            let affected = reactor.propensities.affected(r).iter().copied();
            affected.filter(|&q| is_law[q as usize] == law).collect()
        };
        let mut flat = Flat {
            system,
            counts: amounts.iter().copied().chain([1.0, 0.0]).collect(),
            ledger: Ledger::new(system, amounts),
            products,
            changes: even(changes.collect(), (nowhere, 0.0)),
            affected: even((0..reactions).map(|r| touched(r, false)).collect(), places as u32),
            laws: Rows::collect((0..reactions).map(|r| touched(r, true))),
            has_laws: is_law.contains(&true),
            rates: vec![0.0; places + 1],
            partial: vec![0.0; places],
            total: 0.0,
            next: f64::INFINITY,
            random,
        };
        for (r, law) in is_law.into_iter().enumerate() {
            flat.rates[r] = flat.products[r].value(&flat.counts);
            if law {
                flat.evaluate_law(r)?;
            }
        }
        flat.total = sum_up(&flat.rates, &mut flat.partial);
        flat.check_total()?;
        if flat.total > 0.0 {
            flat.next = exponential(&mut flat.random) / flat.total;
        }
        Ok(flat)
    }

    /// Plays all events up to `until`.
    pub fn advance(&mut self, until: f64) -> Result<(), RunError> {
        while self.next <= until {
            self.event()?;
        }
        self.reach(until)
    }

    fn evaluate_law(&mut self, r: usize) -> Result<(), RunError> {
        let (reactor, frozen) = (self.system.reactor, self.system.frozen);
        let row = &self.counts[..reactor.species_count()];
        let a = self.system.weight(0, r)
            * reactor.propensities.propensity_beside(r, row, frozen.scales[0], &frozen.held);
        if !(0.0..f64::INFINITY).contains(&a) {
            return Err(reactor.bad_propensity(r, a, self.ledger.time, 0, row));
        }
        self.rates[r] = a;
        Ok(())
    }

    /// Tells which propensity is to blame for a total that is none.
    #[cold]
    fn check_total(&self) -> Result<(), RunError> {
        if (0.0..f64::INFINITY).contains(&self.total) {
            return Ok(());
        }
        let reactor = self.system.reactor;
        let largest =
            (0..reactor.propensities.len()).max_by(|&a, &b| self.rates[a].total_cmp(&self.rates[b]));
        let r = largest.unwrap_or(0);
        let row = &self.counts[..reactor.species_count()];
        Err(reactor.bad_propensity(r, self.rates[r], self.ledger.time, 0, row))
    }
}

impl Lane for Flat<'_> {
    fn next(&self) -> f64 {
        self.next
    }

    #[inline]
    fn event(&mut self) -> Result<(), RunError> {
        self.ledger.time = self.next;
        let left = self.random.random::<f64>() * self.total;
        let wait = exponential(&mut self.random);
        // As many partial sums lie below or at the mark as there are reactions before the chosen one. One
        // of propensity zero adds nothing to the sum before it, so it is never chosen; and the mark lies
        // below the total.
        let r = self.partial.iter().map(|&sum| u64::from(sum <= left)).sum::<u64>() as usize;
        self.ledger.fired[r] += 1;
        for &(s, change) in self.changes.row(r) {
            self.counts[s as usize] += change;
        }
        for &q in self.affected.row(r) {
            self.rates[q as usize] = self.products[q as usize].value(&self.counts);
        }
        if self.has_laws {
            for k in 0..self.laws.row(r).len() {
                self.evaluate_law(self.laws.row(r)[k] as usize)?;
            }
        }
        self.total = sum_up(&self.rates, &mut self.partial);
        self.next = self.ledger.time + wait / self.total;
        if !(self.total > 0.0 && self.total < f64::INFINITY) {
            self.check_total()?;
            self.next = f64::INFINITY;
        }
        Ok(())
    }

    fn reach(&mut self, until: f64) -> Result<(), RunError> {
        self.ledger.time = self.ledger.time.max(until);
        let species = self.ledger.amounts.len();
        self.ledger.amounts.copy_from_slice(&self.counts[..species]);
        self.ledger.balance(self.system)
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn into_ledger(self) -> Ledger {
        self.ledger
    }
}

/// Rows filled up to the length of the longest, unless that is long.
fn even<T: Clone>(mut rows: Vec<Vec<T>>, with: T) -> Rows<T> {
    let longest = rows.iter().map(Vec::len).max().unwrap_or(0);
    if longest <= EVEN {
        rows.iter_mut().for_each(|row| row.resize(longest, with.clone()));
    }
    Rows::collect(rows.into_iter())
}

/// Partial sums of the rates; returns the last. Within a block they are formed in pairs, which takes half as
/// long as one after the other; they never fall, and stay equal over a rate of zero.
#[inline(always)]
pub(super) fn sum_up(rates: &[f64], partial: &mut [f64]) -> f64 {
    let mut before = 0.0;
    for (sums, a) in partial.chunks_exact_mut(BLOCK).zip(rates.chunks_exact(BLOCK)) {
        let pair = a[0] + a[1];
        sums[0] = before + a[0];
        sums[1] = before + pair;
        sums[2] = before + (pair + a[2]);
        sums[3] = before + (pair + (a[2] + a[3]));
        before = sums[3];
    }
    before
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Partial sums never fall, whatever the sizes of the rates, and rates of zero add nothing.
        #[test]
        fn partial_sums_never_fall(
            rates in proptest::collection::vec(prop_oneof![Just(0.0), 1e-300..1e300_f64, 0.1..10.0_f64], 12)
        ) {
            let mut partial = [0.0; 12];
            sum_up(&rates, &mut partial);
            let mut before = 0.0;
            for (&sum, &rate) in partial.iter().zip(&rates) {
                let rises = if rate == 0.0 { sum == before } else { sum >= before };
                prop_assert!(rises);
                before = sum;
            }
        }
    }
}
