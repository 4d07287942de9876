//! The runs to compare, and how their realizations belong together.

use super::{Pairing, SideRecord};
use crate::error::Fault;
use crate::samples::SeriesBlock;
use crate::tables::{self, SeriesTable};
use std::collections::BTreeSet;
use std::path::Path;

/// A finished run to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// The folder as the user would type it.
    pub folder: String,
    pub model: String,
    pub seed: u64,
    pub series: SeriesTable,
}

impl Side {
    /// Reads the folder of a run.
    ///
    /// # Errors
    /// A folder without a run, one that is not finished or cannot be read, fewer than two realizations.
    pub fn read(dir: &Path) -> Result<Side, Fault> {
        let folder = dir.display().to_string();
        if !dir.join("run.json").exists() {
            return Err(Fault::general(
                format!("{folder} holds no run"),
                "name the folder of a run, e.g. reports/birth_death",
            ));
        }
        let unreadable = |error: crate::error::RunError| {
            Fault::general(
                format!("{folder} holds a run that cannot be read: {error}"),
                "run it again with --force, or name another folder",
            )
        };
        let record = tables::read_record(dir).map_err(unreadable)?;
        if record.status != "finished" {
            let state = match record.status.as_str() {
                "running" => "is still going on, or was cut off",
                "failed" => "failed",
                _ => "was interrupted",
            };
            let [from, to] = record.realizations;
            return Err(Fault::general(
                format!(
                    "{folder} holds a run that {state} ({} of {} realizations finished)",
                    record.finished,
                    to.saturating_sub(from)
                ),
                "finish it with `gillesph run --resume`, then compare",
            ));
        }
        let series = tables::read_series(dir).map_err(unreadable)?;
        if series.blocks.len() < 2 {
            return Err(Fault::general(
                format!(
                    "{folder} holds {} realization, which says nothing of its noise",
                    series.blocks.len()
                ),
                "run it with more, e.g. --realizations 100",
            ));
        }
        Ok(Side { folder, model: record.name, seed: record.seed, series })
    }

    pub(super) fn record(&self, realizations: usize) -> SideRecord {
        let (folder, model) = (self.folder.clone(), self.model.clone());
        SideRecord { folder, model, seed: self.seed, realizations }
    }

    pub(super) fn value(&self, block: usize, time: usize, column: usize) -> f64 {
        let width = self.series.columns.len();
        self.series.blocks[block].amount.get(time * width + column).copied().unwrap_or(f64::NAN)
    }
}

/// Which blocks to compare, and whether in pairs. Runs of one seed share the random numbers of realizations
/// of one number: they are pairs where at least half of the smaller run has a partner; else the few partners
/// are left out of the second run, and what is left is independent.
pub(super) fn pair(a: &Side, b: &Side) -> (Pairing, Vec<usize>, Vec<usize>) {
    let (x, y) = (&a.series.blocks, &b.series.blocks);
    let (all_a, all_b): (Vec<usize>, Vec<usize>) = ((0..x.len()).collect(), (0..y.len()).collect());
    if a.seed != b.seed {
        return (Pairing::Independent, all_a, all_b);
    }
    let partner = |block: &SeriesBlock| y.binary_search_by_key(&block.realization, |b| b.realization).ok();
    let pairs: Vec<(usize, usize)> = all_a.iter().filter_map(|&k| Some((k, partner(&x[k])?))).collect();
    if pairs.len() >= 2 && 2 * pairs.len() >= x.len().min(y.len()) {
        let (first, second) = pairs.into_iter().unzip();
        return (Pairing::Paired, first, second);
    }
    let taken: BTreeSet<usize> = pairs.into_iter().map(|(_, k)| k).collect();
    (Pairing::Independent, all_a, all_b.into_iter().filter(|k| !taken.contains(k)).collect())
}
