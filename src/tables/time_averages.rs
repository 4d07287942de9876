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

/// Time averages of amounts from the time `from` (s) on: each column's row of all realizations first, then one
/// row a realization. None where there are fewer than twenty output times from there on, or they are not evenly spaced.
#[must_use]
pub fn time_averages(
    times: &[f64],
    columns: &Columns,
    blocks: &[SeriesBlock],
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
    let mut sorted: Vec<&SeriesBlock> = blocks.iter().collect();
    sorted.sort_by_key(|block| block.realization);
    let mut rows = Vec::new();
    for c in 0..width {
        let row = |realization, average| TimeAverageRow {
            realization,
            group: columns.groups[c].clone(),
            species: columns.species[c].clone(),
            average,
        };
        let mut single = Vec::new();
        for block in &sorted {
            let values: Vec<f64> = block.amount.iter().skip(start * width + c).step_by(width).copied().collect();
            single.push((block.realization, TimeAverage::of(&values, spacing)?));
        }
        let averages: Vec<TimeAverage> = single.iter().map(|(_, average)| *average).collect();
        rows.push(row(None, TimeAverage::joined(&averages)?));
        rows.extend(single.into_iter().map(|(realization, average)| row(Some(realization), average)));
    }
    Some(rows)
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
        ((0..60).map(|k| 0.1 * f64::from(k)).collect(), columns, vec![block(4), block(3)])
    }

    #[test]
    fn what_is_written_is_read_back() {
        let (times, columns, blocks) = example();
        let rows = time_averages(&times, &columns, &blocks, 0.0).unwrap();
        let order: Vec<Option<u32>> = rows.iter().map(|r| r.realization).collect();
        assert_eq!(order, [None, Some(3), Some(4), None, Some(3), Some(4)]);
        assert_eq!((rows[3].average.mean, rows[4].average.standard_error), (3.5, 0.0));
        let dir = tempfile::tempdir().unwrap();
        write_time_averages(dir.path(), &rows).unwrap();
        let back = read_time_averages(dir.path()).unwrap();
        // NaN is not equal to itself; its words are.
        assert_eq!(format!("{back:?}"), format!("{rows:?}"));
    }

    #[test]
    fn too_few_or_uneven_times_give_none() {
        let (mut times, columns, blocks) = example();
        assert!(time_averages(&times, &columns, &blocks, 3.9).is_some());
        assert!(time_averages(&times, &columns, &blocks, 4.2).is_none());
        assert!(time_averages(&times, &columns, &blocks, 99.0).is_none());
        times[30] += 0.05;
        assert!(time_averages(&times, &columns, &blocks, 0.0).is_none());
        assert!(time_averages(&times, &columns, &blocks, 3.2).is_some());
    }
}
