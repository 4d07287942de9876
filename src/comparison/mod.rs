//! Two runs side by side: which means and variances differ, and what a difference would have to be to be
//! seen.
//!
//! Every amount that both runs hold at the same time is tested for its mean and its variance; all these tests
//! together give a false alarm with the chance `level` at most (Holm 1979). Runs of one seed share their
//! random numbers realization by realization and are compared in pairs.

mod few;
mod findings;
mod shared;
mod sides;
mod sight;
#[cfg(test)]
mod tests;
mod wanted;
mod words;

pub use findings::{Finding, Findings, Judged};
pub use sides::Side;
pub use wanted::Wanted;

use crate::error::ModelError;
use crate::statistics::holm;
use crate::tables::ComparisonRow;
use rayon::prelude::*;
use serde::Serialize;
use shared::Shared;
use sight::Sight;

/// The power that the smallest difference seen is stated for.
pub const POWER: f64 = 0.8;

/// What is asked of two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Chance of any false alarm, as a share.
    pub level: f64,
    /// A relative difference whose chance to be found is wanted.
    pub difference: Option<f64>,
    /// Quantities to look at; all if there is none.
    pub only: Vec<Wanted>,
    /// Compare the times both have, instead of refusing where they differ.
    pub common_times: bool,
}

impl Default for Question {
    fn default() -> Question {
        Question { level: 0.05, difference: None, only: Vec::new(), common_times: false }
    }
}

/// How the realizations of two runs belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Pairing {
    /// One seed: realization k of both ran on the same random numbers.
    Paired,
    /// Nothing in common.
    Independent,
}

/// One of the runs, in words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SideRecord {
    pub folder: String,
    pub model: String,
    pub seed: u64,
    /// Realizations compared.
    pub realizations: usize,
}

/// What the comparison of two runs has found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    pub a: SideRecord,
    pub b: SideRecord,
    pub pairing: Pairing,
    /// Chance of any false alarm.
    pub level: f64,
    /// The relative difference whose power was asked for.
    pub difference: Option<f64>,
    /// Rows of means and of variances.
    pub means: usize,
    pub variances: usize,
    /// Quantities that are equal without noise, or equal realization by realization: nothing to test.
    pub equal: usize,
    /// Quantities left out because another holds the same numbers (a group and the whole domain).
    pub repeated: usize,
    /// Quantities of one run only, e.g. `X in all`.
    pub only_a: Vec<String>,
    pub only_b: Vec<String>,
    /// Times of one run only, s.
    pub times_only_a: Vec<f64>,
    pub times_only_b: Vec<f64>,
    pub differs: bool,
    pub verdict: String,
    /// Least likely first.
    pub rows: Vec<ComparisonRow>,
}

/// Compares two runs.
///
/// # Errors
/// Runs with nothing in common, with different times, or without what was asked for.
pub fn compare(a: &Side, b: &Side, question: &Question) -> Result<Comparison, ModelError> {
    let shared = Shared::of(a, b, question.common_times, &question.only)?;
    let found: Vec<Vec<(usize, Findings)>> =
        (0..shared.times.len()).into_par_iter().map(|t| at_time(a, b, &shared, t)).collect();
    let mut comparison = Comparison {
        a: a.record(shared.blocks_a.len()),
        b: b.record(shared.blocks_b.len()),
        pairing: shared.pairing,
        level: question.level,
        difference: question.difference,
        means: 0,
        variances: 0,
        equal: 0,
        repeated: 0,
        only_a: shared.only_a.clone(),
        only_b: shared.only_b.clone(),
        times_only_a: shared.times_only_a.clone(),
        times_only_b: shared.times_only_b.clone(),
        differs: false,
        verdict: String::new(),
        rows: Vec::new(),
    };
    for (t, columns) in found.iter().enumerate() {
        comparison.repeated += shared.wanted(t).count() - columns.len();
        for (c, findings) in columns {
            comparison.equal += usize::from(findings.equal);
            comparison.means += usize::from(findings.mean.is_some());
            comparison.variances += usize::from(findings.variance.is_some());
            for (moment, finding) in [("mean", findings.mean), ("variance", findings.variance)] {
                comparison.rows.extend(finding.map(|finding| row(&shared, t, *c, moment, &finding)));
            }
        }
    }
    comparison.conclude(question);
    Ok(comparison)
}

/// Judges the quantities at one time; of those with the same numbers only the first.
fn at_time(a: &Side, b: &Side, shared: &Shared, t: usize) -> Vec<(usize, Findings)> {
    let mut seen: Vec<(usize, Vec<f64>, Vec<f64>)> = Vec::new();
    let mut out = Vec::new();
    for c in shared.wanted(t) {
        let (x, y) = (shared.values_a(a, t, c), shared.values_b(b, t, c));
        let species = &shared.columns.species[c];
        if seen.iter().any(|(other, u, v)| shared.columns.species[*other] == *species && *u == x && *v == y) {
            continue;
        }
        out.push((c, Findings::of(&x, &y, shared.pairing == Pairing::Paired)));
        seen.push((c, x, y));
    }
    out
}

fn row(shared: &Shared, t: usize, c: usize, moment: &'static str, finding: &Finding) -> ComparisonRow {
    let test = &finding.test;
    ComparisonRow {
        time: shared.times[t].value,
        group: shared.columns.groups[c].clone(),
        species: shared.columns.species[c].clone(),
        moment,
        a: finding.a,
        b: finding.b,
        difference: test.difference,
        standard_error: test.standard_error,
        relative: if finding.a == 0.0 { f64::NAN } else { test.difference / finding.a.abs() },
        t: test.t,
        freedom: test.freedom,
        p: test.p,
        p_adjusted: f64::NAN,
        detectable: f64::NAN,
        power: f64::NAN,
        judged: finding.judged.word(),
        differs: false,
    }
}

impl Comparison {
    /// Adjusts for the number of tests, says what would have been seen, sorts, and puts it into words.
    fn conclude(&mut self, question: &Question) {
        let p: Vec<f64> = self.rows.iter().map(|row| row.p).collect();
        let family = p.iter().filter(|p| !p.is_nan()).count();
        // A single difference has to pass the first and strictest step of Holm's procedure.
        let mut sight = Sight::new(question.level / family.max(1) as f64, POWER);
        for (row, adjusted) in self.rows.iter_mut().zip(holm(&p)) {
            row.p_adjusted = adjusted;
            row.differs = adjusted <= question.level;
            let error = row.standard_error / row.a.abs();
            if error > 0.0 && error.is_finite() {
                row.detectable = error * sight.detectable(row.freedom);
                if let Some(difference) = question.difference {
                    row.power = sight.power(difference / error, row.freedom);
                }
            }
        }
        self.differs = self.rows.iter().any(|row| row.differs);
        // The same chance: the larger difference first. The sort keeps the order of time and column else.
        self.rows.sort_by(|x, y| x.p.total_cmp(&y.p).then(y.t.abs().total_cmp(&x.t.abs())));
        self.verdict = words::verdict(self);
    }
}
