//! Figures of a sweep: the outcome at the end against the values swept.

mod curves;
mod map;
mod scatter;
mod tornado;

pub use tornado::correlations;

use super::Figure;
use super::plot::Ruler;
use crate::error::RunError;
use crate::record::{SweepRecord, SweptRecord};
use crate::statistics::{Summary, student_critical};
use crate::tables;
use std::path::Path;

/// Most species with panels of their own.
const SPECIES: usize = 12;
/// Curves that are told apart by colour.
const FAMILY: usize = 6;
/// Points from which a correlation of ranks says something.
const RANKED: usize = 8;

/// Everything the figures of a sweep are drawn from.
#[derive(Clone, Debug)]
pub struct Outcomes {
    pub record: SweepRecord,
    /// Species by species what came out over the whole domain at the last output time; those that never occur are
    /// left out.
    pub species: Vec<Outcome>,
}

/// What came out of one species.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub species: String,
    /// Values of the parameters in the units of the user, point by point.
    pub values: Vec<Vec<f64>>,
    /// Time at the end, s, point by point.
    pub times: Vec<f64>,
    /// Of the amount in molecules.
    pub summaries: Vec<Summary>,
}

impl Outcomes {
    /// Reads the record and the table of a sweep below `dir`.
    ///
    /// # Errors
    /// [`RunError::File`] if one is missing or cannot be read.
    pub fn read(dir: &Path) -> Result<Outcomes, RunError> {
        let record = tables::read_sweep_record(dir)?;
        let mut species: Vec<Outcome> = Vec::new();
        if record.finished().next().is_some() {
            for row in tables::read_sweep_ends(dir, &record.parameters)? {
                let name = &row.statistics.species;
                let k = species.iter().position(|one| one.species == *name).unwrap_or_else(|| {
                    let (values, times, summaries) = (Vec::new(), Vec::new(), Vec::new());
                    species.push(Outcome { species: name.clone(), values, times, summaries });
                    species.len() - 1
                });
                let shown = row.values.iter().zip(&record.parameters).map(|(v, p)| v * p.per_si);
                species[k].values.push(shown.collect());
                species[k].times.push(row.statistics.time);
                species[k].summaries.push(row.statistics.summary);
            }
        }
        species.retain(|one| one.summaries.iter().any(|s| s.max != 0.0 || s.min != 0.0));
        Ok(Outcomes { record, species })
    }
}

impl Outcome {
    /// Value of a parameter at every point.
    #[must_use]
    pub fn value(&self, parameter: usize) -> Vec<f64> {
        self.values.iter().map(|values| values[parameter]).collect()
    }

    /// Mean amount at every point.
    #[must_use]
    pub fn mean(&self) -> Vec<f64> {
        self.summaries.iter().map(|s| s.mean).collect()
    }
}

/// Half of the 95 % interval of a mean; NaN of one realization.
#[must_use]
pub fn half_width(s: &Summary) -> f64 {
    if s.count < 2 { f64::NAN } else { s.sem * student_critical(0.05, s.count as f64 - 1.0) }
}

/// Ends of the 95 % interval of a mean; an amount is never below zero.
fn interval(s: &Summary) -> [f64; 2] {
    let half = half_width(s);
    // Not `max`, which would make a number of what is none.
    let low = if s.mean - half < 0.0 { s.min.min(0.0) } else { s.mean - half };
    [low, s.mean + half]
}

/// Every figure of a sweep, in the order of the report.
#[must_use]
pub fn draw(outcomes: &Outcomes) -> Vec<Figure> {
    let mut shown = outcomes.clone();
    shown.species.truncate(SPECIES);
    if shown.species.is_empty() {
        return Vec::new();
    }
    let grid = shown.record.design == "grid";
    let mut out = Vec::new();
    match shown.record.parameters.len() {
        1 if shown.record.design != "latin_hypercube" => out.push(curves::against(&shown)),
        2 if grid => {
            out.extend(curves::family(&shown));
            out.extend(map::map(&shown));
        }
        _ => {
            out.extend(tornado::tornado(&shown));
            out.extend(scatter::scatter(&shown));
        }
    }
    out
}

/// A unit as in print.
pub(crate) fn printed(unit: &str) -> String {
    let mut out = unit.replace("^2", "²").replace("^3", "³");
    for prefixed in ["um", "uM", "us", "umol", "uL"] {
        out = out.replace(prefixed, &prefixed.replace('u', "µ"));
    }
    out
}

/// The name of a parameter without the ways that lead to it.
pub(crate) fn name(parameter: &SweptRecord) -> &str {
    let name = parameter.name.as_str();
    let short =
        name.strip_prefix("reactions.parameters.").or_else(|| name.strip_prefix("reactions.reactions."));
    short.unwrap_or(name)
}

fn label(parameter: &SweptRecord) -> String {
    match parameter.unit.as_str() {
        "" => name(parameter).to_string(),
        unit => format!("{} ({})", name(parameter), printed(unit)),
    }
}

/// The axis of a parameter.
fn ruler(parameter: &SweptRecord) -> Ruler {
    let label = label(parameter);
    if parameter.logarithmic { Ruler::logarithmic(&label) } else { Ruler::linear(&label) }
}

/// The axis of an amount that reaches from `low` to `high`, from zero if that is near.
fn amount(values: impl Iterator<Item = f64>) -> Ruler {
    let (low, high) = super::panel::range(values);
    let air = 0.05 * (high - low).max(1e-3 * high.abs()).max(f64::MIN_POSITIVE);
    let low = if low >= 0.0 && low < 0.5 * high { 0.0 } else { low - air };
    Ruler::linear("amount (molecules)").from(low, high + air)
}

/// When the amounts were read, in words.
fn at_the_end(outcomes: &Outcomes) -> String {
    let times = outcomes.species.iter().flat_map(|one| one.times.iter().copied());
    let (first, last) = super::panel::range(times);
    if first == last {
        format!("at {}", crate::quantity::readable::show(last, "s"))
    } else {
        "at the end of each run".into()
    }
}

/// How many realizations each point has, in words.
pub(crate) fn each(outcomes: &Outcomes) -> String {
    let counts = || outcomes.species.iter().flat_map(|one| one.summaries.iter().map(|s| s.count));
    match (counts().min().unwrap_or(0), counts().max().unwrap_or(0)) {
        (1, 1) => "one realization at each point".into(),
        (few, many) if few == many => format!("{many} realizations at each point"),
        (few, many) => format!("{few} to {many} realizations at each point"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_printed() {
        assert_eq!((printed("um^2/s").as_str(), printed("1/(uM s)").as_str()), ("µm²/s", "1/(µM s)"));
    }
}
