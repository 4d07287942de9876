//! Output times: at equal intervals or listed, up to the end of a run.

use super::reader::{Faults, Fields};
use crate::quantity::Dimension;

/// The end of a run, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct End {
    pub time: f64,
    /// Whether `--set run.until` moved it: times after the end are then left out, and no fault.
    pub shortened: bool,
}

const MOST_OUTPUTS: f64 = 1e6;

/// Multiples of `every` up to and including `until`.
pub(super) fn multiples(every: f64, until: f64) -> Vec<f64> {
    let count = (until / every * (1.0 + 1e-12)).floor() as usize;
    let mut times: Vec<f64> = (0..=count).map(|k| k as f64 * every).collect();
    if let Some(last) = times.last_mut() {
        if (until - *last).abs() <= 1e-9 * until {
            *last = until;
        } else {
            times.push(until);
        }
    }
    times
}

/// Reads `every` or `times` of a section: `Some(None)` if neither is given, `None` after a fault.
pub(super) fn times(fields: &mut Fields, end: End, faults: &mut Faults) -> Option<Option<Vec<f64>>> {
    let until = end.time;
    let (every, list) = (fields.optional("every"), fields.optional("times"));
    match (every, list) {
        (Some(n), None) => {
            let every = n.positive(Dimension::TIME, faults)?;
            if until / every > MOST_OUTPUTS {
                faults.at(
                    &n.place,
                    format!("{:.3e} output times", until / every),
                    "at most a million are possible; make `every` longer",
                );
                return None;
            }
            if every > until && end.shortened {
                return Some(Some(vec![0.0, until]));
            }
            if every > until {
                faults.at(
                    &n.place,
                    format!("an interval of {every} s is longer than the run of {until} s"),
                    "make `every` shorter or run.until longer",
                );
                return None;
            }
            Some(Some(multiples(every, until)))
        }
        (None, Some(n)) => {
            let mut found = Vec::new();
            for item in n.list(faults)? {
                let t = item.non_negative(Dimension::TIME, faults)?;
                if t > until * (1.0 + 1e-12) && end.shortened {
                    continue;
                }
                if t > until * (1.0 + 1e-12) {
                    faults.at(
                        &item.place,
                        format!("{t} s lies after the end of the run, {until} s"),
                        "make run.until longer or remove it",
                    );
                    return None;
                }
                found.push(t);
            }
            if found.is_empty() && end.shortened {
                return Some(Some(vec![until]));
            }
            if found.is_empty() {
                faults.at(&n.place, "no output times", "give at least one, e.g. times: [1 s], or `every`");
                return None;
            }
            found.sort_by(f64::total_cmp);
            found.dedup();
            Some(Some(found))
        }
        (None, None) => Some(None),
        (Some(n), Some(_)) => {
            faults.at(&n.place, "both `every` and `times` are given", "keep one of them");
            None
        }
    }
}
