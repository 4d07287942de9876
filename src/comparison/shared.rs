//! What two runs have in common: times, quantities, realizations.

use super::sides::{Side, pair};
use super::{Pairing, Wanted};
use crate::error::{Fault, ModelError};
use crate::quantity::readable::show;
use crate::samples::Columns;
use std::collections::BTreeSet;

/// A time of both runs.
pub(super) struct SharedTime {
    /// s.
    pub value: f64,
    a: usize,
    b: usize,
}

/// Times, quantities and realizations that two runs share.
pub(super) struct Shared {
    pub pairing: Pairing,
    /// Blocks compared; in pairs, if they are paired.
    pub blocks_a: Vec<usize>,
    pub blocks_b: Vec<usize>,
    pub times: Vec<SharedTime>,
    pub columns: Columns,
    /// Where each shared column stands in either run.
    index: Vec<(usize, usize)>,
    /// Whether a quantity is asked for, times x columns.
    asked: Vec<bool>,
    pub only_a: Vec<String>,
    pub only_b: Vec<String>,
    pub times_only_a: Vec<f64>,
    pub times_only_b: Vec<f64>,
}

impl Shared {
    pub fn of(a: &Side, b: &Side, common_times: bool, only: &[Wanted]) -> Result<Shared, ModelError> {
        let mut faults = Vec::new();
        let (pairing, blocks_a, blocks_b) = pair(a, b);
        if blocks_a.len().min(blocks_b.len()) < 2 {
            faults.push(Fault::general(
                format!(
                    "{} and {} have one seed and share realizations, and too few others",
                    a.folder, b.folder
                ),
                "run one of them with another --seed",
            ));
        }
        let (ca, cb) = (&a.series.columns, &b.series.columns);
        let mut columns = Columns::default();
        let mut index = Vec::new();
        for c in 0..ca.len() {
            if let Some(other) = cb.find(&ca.groups[c], &ca.species[c]) {
                columns.groups.push(ca.groups[c].clone());
                columns.species.push(ca.species[c].clone());
                index.push((c, other));
            }
        }
        let rest = |own: &Columns, other: &Columns| -> Vec<String> {
            (0..own.len())
                .filter(|&c| other.find(&own.groups[c], &own.species[c]).is_none())
                .map(|c| format!("{} in {}", own.species[c], own.groups[c]))
                .collect()
        };
        let (only_a, only_b) = (rest(ca, cb), rest(cb, ca));
        if index.is_empty() {
            faults.push(Fault::general(
                format!(
                    "{} and {} have no quantity in common: {} against {}",
                    a.folder,
                    b.folder,
                    list(&only_a),
                    list(&only_b)
                ),
                "compare runs of models that share a species and a group",
            ));
        }
        let times = times(&a.series.times, &b.series.times);
        let alone = |own: &[f64], used: BTreeSet<usize>| -> Vec<f64> {
            (0..own.len()).filter(|k| !used.contains(k)).map(|k| own[k]).collect()
        };
        let times_only_a = alone(&a.series.times, times.iter().map(|t| t.a).collect());
        let times_only_b = alone(&b.series.times, times.iter().map(|t| t.b).collect());
        let apart = !times_only_a.is_empty() || !times_only_b.is_empty();
        if times.is_empty() || (apart && !common_times) {
            let part = |folder: &str, times: &[f64]| {
                let shown: Vec<String> = times.iter().map(|t| show(*t, "s")).collect();
                format!("{} only in {folder}", list(&shown))
            };
            let parts: Vec<String> = [(&a.folder, &times_only_a), (&b.folder, &times_only_b)]
                .into_iter()
                .filter(|(_, times)| !times.is_empty())
                .map(|(folder, times)| part(folder, times))
                .collect();
            faults.push(Fault::general(
                format!("the output times differ: {}", parts.join("; ")),
                if times.is_empty() {
                    "give both models the same `output` and run one of them again"
                } else {
                    "give both models the same `output`, or compare what both have with --common-times"
                },
            ));
        }
        let mut asked = vec![only.is_empty(); times.len() * columns.len()];
        if faults.is_empty() {
            let values: Vec<f64> = times.iter().map(|t| t.value).collect();
            for wanted in only {
                match wanted.mark(&values, &columns, &mut asked) {
                    Ok(()) => {}
                    Err(fault) => faults.push(fault),
                }
            }
        }
        if faults.is_empty() {
            Ok(Shared {
                pairing,
                blocks_a,
                blocks_b,
                times,
                columns,
                index,
                asked,
                only_a,
                only_b,
                times_only_a,
                times_only_b,
            })
        } else {
            Err(ModelError { faults })
        }
    }

    /// Columns to look at, at one time.
    pub fn wanted(&self, time: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.columns.len()).filter(move |c| self.asked[time * self.columns.len() + c])
    }

    pub fn values_a(&self, a: &Side, time: usize, column: usize) -> Vec<f64> {
        self.blocks_a.iter().map(|&k| a.value(k, self.times[time].a, self.index[column].0)).collect()
    }

    pub fn values_b(&self, b: &Side, time: usize, column: usize) -> Vec<f64> {
        self.blocks_b.iter().map(|&k| b.value(k, self.times[time].b, self.index[column].1)).collect()
    }
}

/// The first few of many words.
pub(super) fn list(words: &[String]) -> String {
    const SHOWN: usize = 6;
    let shown = words[..words.len().min(SHOWN)].join(", ");
    if words.len() > SHOWN { format!("{shown} and {} more", words.len() - SHOWN) } else { shown }
}

/// Times that are the same but for rounding.
fn times(a: &[f64], b: &[f64]) -> Vec<SharedTime> {
    let mut out = Vec::new();
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        if (a[i] - b[j]).abs() <= 1e-9 * a[i].abs().max(b[j].abs()) {
            out.push(SharedTime { value: a[i], a: i, b: j });
            (i, j) = (i + 1, j + 1);
        } else if a[i] < b[j] {
            i += 1;
        } else {
            j += 1;
        }
    }
    out
}
