//! `tables/time_averages.parquet`: averages over time of each realization, and of all.

use super::frame::{self, Table};
use crate::error::RunError;
use crate::samples::{Columns, SeriesBlock};
use crate::statistics::TimeAverage;
use polars::prelude::*;
use std::path::Path;

/// Output times, as a share of their mean distance, may be so uneven and still count as even.
const EVEN: f64 = 1e-6;

/// A row of `tables/time_averages.parquet`.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeAverageRow {
    /// None for all realizations together.
    pub realization: Option<u32>,
    pub group: String,
    pub species: String,
    /// Of the amount in molecules.
    pub average: TimeAverage,
}

/// Time averages of the amounts of one realization from the time `from` (s) on, one row a column. None where there
/// are fewer than twenty output times from there on, or they are not evenly spaced.
#[must_use]
pub fn averages_of(
    times: &[f64],
    columns: &Columns,
    block: &SeriesBlock,
    from: f64,
) -> Option<Vec<TimeAverageRow>> {
    let start = times.partition_point(|&t| t < from);
    let used = &times[start..];
    let spacing = (used.last()? - used[0]) / (used.len() as f64 - 1.0);
    let even = used.windows(2).all(|pair| (pair[1] - pair[0] - spacing).abs() <= EVEN * spacing);
    if !even {
        return None;
    }
    let width = columns.len();
    let row = |c: usize| {
        let values: Vec<f64> = block.amount.iter().skip(start * width + c).step_by(width).copied().collect();
        Some(TimeAverageRow {
            realization: Some(block.realization),
            group: columns.groups[c].clone(),
            species: columns.species[c].clone(),
            average: TimeAverage::of(&values, spacing)?,
        })
    };
    (0..width).map(row).collect()
}

/// One row a column for all realizations together, of rows in order of realization and column as
/// [`averages_of`] gives them.
#[must_use]
pub fn averages_of_all(rows: &[TimeAverageRow], columns: usize) -> Vec<TimeAverageRow> {
    let joined = |c: usize| {
        let parts: Vec<&TimeAverageRow> = rows.iter().skip(c).step_by(columns).collect();
        let averages: Vec<TimeAverage> = parts.iter().map(|row| row.average).collect();
        let first = *parts.first()?;
        let average = TimeAverage::joined(&averages)?;
        Some(TimeAverageRow { realization: None, average, ..first.clone() })
    };
    (0..columns).filter_map(joined).collect()
}

/// Writes `tables/time_averages.parquet` below `dir`; `realization` is null for all together.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written.
pub fn write_time_averages(dir: &Path, rows: &[TimeAverageRow]) -> Result<(), RunError> {
    let number = |name: &str, of: fn(&TimeAverage) -> f64| {
        frame::reals(name, rows.iter().map(|r| of(&r.average)).collect())
    };
    let group: Vec<&str> = rows.iter().map(|r| r.group.as_str()).collect();
    let species: Vec<&str> = rows.iter().map(|r| r.species.as_str()).collect();
    let realization: Vec<Option<u32>> = rows.iter().map(|r| r.realization).collect();
    let table = DataFrame::new_infer_height(vec![
        Column::new("realization".into(), realization),
        frame::text("group", &group),
        frame::text("species", &species),
        number("mean", |a| a.mean),
        number("standard_error", |a| a.standard_error),
        number("autocorrelation_time", |a| a.autocorrelation_time),
        number("effective_samples", |a| a.effective_samples),
        number("degrees_of_freedom", |a| a.freedom),
        number("stationarity", |a| a.stationarity),
    ]);
    frame::write_frames(&dir.join("tables/time_averages.parquet"), std::iter::once(table))
}

/// Reads `tables/time_averages.parquet` below `dir`.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_time_averages(dir: &Path) -> Result<Vec<TimeAverageRow>, RunError> {
    let table = Table::read(&dir.join("tables/time_averages.parquet"))?;
    let (realization, group, species) =
        (table.whole_or_null("realization")?, table.text("group")?, table.text("species")?);
    let names = [
        "mean",
        "standard_error",
        "autocorrelation_time",
        "effective_samples",
        "degrees_of_freedom",
        "stationarity",
    ];
    let n = names.iter().map(|name| table.reals(name)).collect::<Result<Vec<_>, _>>()?;
    let row = |k: usize| TimeAverageRow {
        realization: realization[k],
        group: group[k].to_string(),
        species: species[k].to_string(),
        average: TimeAverage {
            mean: n[0][k],
            standard_error: n[1][k],
            autocorrelation_time: n[2][k],
            effective_samples: n[3][k],
            freedom: n[4][k],
            stationarity: n[5][k],
        },
    };
    Ok((0..table.rows()).map(row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> (Vec<f64>, Columns, Vec<SeriesBlock>) {
        let columns = Columns { groups: vec!["all".into(); 2], species: vec!["A".into(), "B".into()] };
        let block = |realization: u32| SeriesBlock {
            realization,
            // A wanders, B is the number of the realization.
            amount: (0..60)
                .flat_map(|k: u32| [f64::from((k * 37 + realization) % 11), f64::from(realization)])
                .collect(),
            concentration: vec![0.0; 120],
        };
        ((0..60).map(|k| 0.1 * f64::from(k)).collect(), columns, vec![block(3), block(4)])
    }

    #[test]
    fn what_is_written_is_read_back() {
        let (times, columns, blocks) = example();
        let mut rows: Vec<TimeAverageRow> =
            blocks.iter().flat_map(|block| averages_of(&times, &columns, block, 0.0).unwrap()).collect();
        rows.extend(averages_of_all(&rows, columns.len()));
        let order: Vec<Option<u32>> = rows.iter().map(|r| r.realization).collect();
        assert_eq!(order, [Some(3), Some(3), Some(4), Some(4), None, None]);
        let (single, all) = (&rows[1], &rows[5]);
        assert_eq!((all.species.as_str(), all.average.mean, single.average.standard_error), ("B", 3.5, 0.0));
        let dir = tempfile::tempdir().unwrap();
        write_time_averages(dir.path(), &rows).unwrap();
        let back = read_time_averages(dir.path()).unwrap();
        // NaN is not equal to itself; its words are.
        assert_eq!(format!("{back:?}"), format!("{rows:?}"));
    }

    #[test]
    fn too_few_or_uneven_times_give_none() {
        let (mut times, columns, blocks) = example();
        let known = |times: &[f64], from: f64| averages_of(times, &columns, &blocks[0], from).is_some();
        assert!(known(&times, 3.9) && !known(&times, 4.2) && !known(&times, 99.0));
        times[30] += 0.05;
        assert!(!known(&times, 0.0) && known(&times, 3.2));
    }
}
