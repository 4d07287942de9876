//! What a sweep says of itself: the content of `run.json` in its folder. Each point has a folder and a record of its own.

use super::{ModelText, Performance};
use serde::{Deserialize, Serialize};

/// Columns of `tables/sweep.parquet` besides those of the swept parameters.
pub const SWEEP_COLUMNS: [&str; 17] = [
    "point",
    "time",
    "group",
    "species",
    "realizations",
    "mean",
    "variance",
    "sd",
    "sem",
    "min",
    "q05",
    "q25",
    "median",
    "q75",
    "q95",
    "max",
    "fano",
];

/// The whole of `run.json` of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepRecord {
    pub program: String,
    pub version: String,
    /// Of what is kept while it runs, as in a run.
    pub format: u32,
    /// `running`, `interrupted`, `failed` (one point at least) or `finished`.
    pub status: String,
    pub name: String,
    /// Free text of the model's author.
    pub description: String,
    pub model: ModelText,
    pub seed: u64,
    /// First realization and one past the last, of every point.
    pub realizations: [u32; 2],
    /// `grid`, `list` or `latin_hypercube`.
    pub design: String,
    pub common_random_numbers: bool,
    pub parameters: Vec<SweptRecord>,
    pub points: Vec<PointRecord>,
    /// Of all points together.
    pub performance: Performance,
}

/// A swept parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SweptRecord {
    /// As the user calls it; a column of the table.
    pub name: String,
    /// Where it stands in the model.
    pub path: String,
    /// Unit in which the user gave it; its values in SI times `per_si` read in this unit.
    pub unit: String,
    pub per_si: f64,
    /// Spread evenly over its logarithm.
    pub logarithmic: bool,
}

/// A point of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointRecord {
    pub point: u32,
    /// In SI, in the order of the parameters.
    pub values: Vec<f64>,
    /// The same as they are put into the model, `path=value`.
    pub set: Vec<String>,
    pub seed: u64,
    /// Below the folder of the sweep.
    pub folder: String,
    /// `waiting`, or as of a run.
    pub status: String,
    /// What stopped it.
    pub error: Option<String>,
    /// Realizations whose tables are complete.
    pub finished: u32,
}

impl SweepRecord {
    /// Points that are finished.
    pub fn finished(&self) -> impl Iterator<Item = &PointRecord> {
        self.points.iter().filter(|point| point.status == "finished")
    }
}

impl PointRecord {
    /// Its values as a user would write them: `k_on = 2 1/s, k_off = 0.1 1/s`.
    #[must_use]
    pub fn words(&self, parameters: &[SweptRecord]) -> String {
        let value =
            |set: &String| set.split_once('=').map_or_else(String::new, |(_, value)| value.to_string());
        let pairs = parameters.iter().zip(&self.set);
        let words: Vec<String> = pairs.map(|(p, set)| format!("{} = {}", p.name, value(set))).collect();
        words.join(", ")
    }
}
