//! Tables across realizations: statistics, covariances, histograms.

use super::frame::{self, Table};
use super::series::across;
use crate::error::RunError;
use crate::record::HistogramRecord;
use crate::samples::{Columns, SeriesBlock};
use crate::statistics::{self, Summary};
use polars::prelude::*;
use std::path::Path;

/// A row of `tables/statistics.parquet`.
#[derive(Clone, Debug, PartialEq)]
pub struct StatisticsRow {
    /// s.
    pub time: f64,
    pub group: String,
    pub species: String,
    /// Of the amount in molecules.
    pub summary: Summary,
}

/// A row of `tables/covariance.parquet`.
#[derive(Clone, Debug, PartialEq)]
pub struct CovarianceRow {
    /// s.
    pub time: f64,
    /// Group and species.
    pub a: (String, String),
    /// Group and species.
    pub b: (String, String),
    /// Molecules².
    pub covariance: f64,
}

/// A row of `tables/histogram.parquet`: `count` realizations with low <= amount < high (molecules).
#[derive(Clone, Debug, PartialEq)]
pub struct Bin {
    /// s.
    pub time: f64,
    pub group: String,
    pub species: String,
    pub low: f64,
    pub high: f64,
    pub count: u32,
}

/// Writes `tables/statistics.parquet` below `dir`: one row per time and column, over all blocks.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written.
pub fn write_statistics(
    dir: &Path,
    times: &[f64],
    columns: &Columns,
    blocks: &[SeriesBlock],
) -> Result<(), RunError> {
    let sorted = in_order(blocks);
    let keys = || (0..times.len()).flat_map(|t| (0..columns.len()).map(move |c| (t, c)));
    let rows: Vec<Summary> =
        keys().map(|(t, c)| Summary::of(&across(&sorted, columns.len(), t, c))).collect();
    let column =
        |name: &str, value: fn(&Summary) -> f64| frame::reals(name, rows.iter().map(value).collect());
    let group: Vec<&str> = keys().map(|(_, c)| columns.groups[c].as_str()).collect();
    let species: Vec<&str> = keys().map(|(_, c)| columns.species[c].as_str()).collect();
    let table = DataFrame::new_infer_height(vec![
        frame::reals("time", keys().map(|(t, _)| times[t]).collect()),
        frame::text("group", &group),
        frame::text("species", &species),
        frame::whole("realizations", rows.iter().map(|s| s.count as u32).collect()),
        column("mean", |s| s.mean),
        column("variance", |s| s.variance),
        column("sd", |s| s.sd),
        column("sem", |s| s.sem),
        column("min", |s| s.min),
        column("q05", |s| s.q05),
        column("q25", |s| s.q25),
        column("median", |s| s.median),
        column("q75", |s| s.q75),
        column("q95", |s| s.q95),
        column("max", |s| s.max),
        column("fano", |s| s.fano),
    ]);
    frame::write_frames(&dir.join("tables/statistics.parquet"), std::iter::once(table))
}

/// Reads `tables/statistics.parquet` below `dir`.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_statistics(dir: &Path) -> Result<Vec<StatisticsRow>, RunError> {
    let table = Table::read(&dir.join("tables/statistics.parquet"))?;
    let (time, group, species) = (table.reals("time")?, table.text("group")?, table.text("species")?);
    let count = table.whole("realizations")?;
    let names = ["mean", "variance", "sd", "sem", "min", "q05", "q25", "median", "q75", "q95", "max", "fano"];
    let n = names.iter().map(|name| table.reals(name)).collect::<Result<Vec<_>, _>>()?;
    let row = |k: usize| StatisticsRow {
        time: time[k],
        group: group[k].to_string(),
        species: species[k].to_string(),
        summary: Summary {
            count: count[k] as usize,
            mean: n[0][k],
            variance: n[1][k],
            sd: n[2][k],
            sem: n[3][k],
            min: n[4][k],
            q05: n[5][k],
            q25: n[6][k],
            median: n[7][k],
            q75: n[8][k],
            q95: n[9][k],
            max: n[10][k],
            fano: n[11][k],
        },
    };
    Ok((0..table.rows()).map(row).collect())
}

/// Writes `tables/covariance.parquet` below `dir`: the full symmetric matrix of all columns at each time.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written.
pub fn write_covariance(
    dir: &Path,
    times: &[f64],
    columns: &Columns,
    blocks: &[SeriesBlock],
) -> Result<(), RunError> {
    let (sorted, width) = (in_order(blocks), columns.len());
    // One row group a time: a matrix of many columns stays within memory.
    let at = |t: usize| {
        let samples: Vec<Vec<f64>> = (0..width).map(|c| across(&sorted, width, t, c)).collect();
        let pairs = || (0..width).flat_map(|a| (0..width).map(move |b| (a, b)));
        let name = |names: &[String], first: bool| -> Column {
            let rows: Vec<&str> = pairs().map(|(a, b)| names[if first { a } else { b }].as_str()).collect();
            frame::text("", &rows)
        };
        DataFrame::new_infer_height(vec![
            frame::reals("time", vec![times[t]; width * width]),
            name(&columns.groups, true).with_name("group_a".into()),
            name(&columns.species, true).with_name("species_a".into()),
            name(&columns.groups, false).with_name("group_b".into()),
            name(&columns.species, false).with_name("species_b".into()),
            frame::reals(
                "covariance",
                // Ordered arguments: both halves of the matrix carry the same bits.
                pairs()
                    .map(|(a, b)| statistics::covariance(&samples[a.min(b)], &samples[a.max(b)]))
                    .collect(),
            ),
        ])
    };
    frame::write_frames(&dir.join("tables/covariance.parquet"), (0..times.len()).map(at))
}

/// Reads `tables/covariance.parquet` below `dir`.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_covariance(dir: &Path) -> Result<Vec<CovarianceRow>, RunError> {
    let table = Table::read(&dir.join("tables/covariance.parquet"))?;
    let (time, covariance) = (table.reals("time")?, table.reals("covariance")?);
    let (ga, sa) = (table.text("group_a")?, table.text("species_a")?);
    let (gb, sb) = (table.text("group_b")?, table.text("species_b")?);
    let row = |k: usize| CovarianceRow {
        time: time[k],
        a: (ga[k].to_string(), sa[k].to_string()),
        b: (gb[k].to_string(), sb[k].to_string()),
        covariance: covariance[k],
    };
    Ok((0..table.rows()).map(row).collect())
}

/// Writes `tables/histogram.parquet` below `dir`: for each distribution asked for, bins of whole molecules
/// whose width follows Freedman & Diaconis (1981), 2 IQR n^(-1/3), but is at least one.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written.
pub fn write_histograms(
    dir: &Path,
    times: &[f64],
    columns: &Columns,
    blocks: &[SeriesBlock],
    wanted: &[HistogramRecord],
) -> Result<(), RunError> {
    let sorted = in_order(blocks);
    let mut bins: Vec<Bin> = Vec::new();
    for w in wanted {
        let Some(c) = columns.find(&w.group, &w.species) else { continue };
        for &time in &w.times {
            let Some(t) = nearest(times, time) else { continue };
            let values = across(&sorted, columns.len(), t, c);
            for (low, high, count) in statistics::histogram(&values) {
                let (group, species) = (w.group.clone(), w.species.clone());
                bins.push(Bin { time: times[t], group, species, low, high, count });
            }
        }
    }
    let group: Vec<&str> = bins.iter().map(|b| b.group.as_str()).collect();
    let species: Vec<&str> = bins.iter().map(|b| b.species.as_str()).collect();
    let table = DataFrame::new_infer_height(vec![
        frame::reals("time", bins.iter().map(|b| b.time).collect()),
        frame::text("group", &group),
        frame::text("species", &species),
        frame::reals("low", bins.iter().map(|b| b.low).collect()),
        frame::reals("high", bins.iter().map(|b| b.high).collect()),
        frame::whole("count", bins.iter().map(|b| b.count).collect()),
    ]);
    frame::write_frames(&dir.join("tables/histogram.parquet"), std::iter::once(table))
}

/// Reads `tables/histogram.parquet` below `dir`.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_histograms(dir: &Path) -> Result<Vec<Bin>, RunError> {
    let table = Table::read(&dir.join("tables/histogram.parquet"))?;
    let (time, group, species) = (table.reals("time")?, table.text("group")?, table.text("species")?);
    let (low, high, count) = (table.reals("low")?, table.reals("high")?, table.whole("count")?);
    let row = |k: usize| Bin {
        time: time[k],
        group: group[k].to_string(),
        species: species[k].to_string(),
        low: low[k],
        high: high[k],
        count: count[k],
    };
    Ok((0..table.rows()).map(row).collect())
}

fn in_order(blocks: &[SeriesBlock]) -> Vec<SeriesBlock> {
    let mut sorted = blocks.to_vec();
    sorted.sort_by_key(|b| b.realization);
    sorted
}

fn nearest(times: &[f64], time: f64) -> Option<usize> {
    (0..times.len()).min_by(|&a, &b| (times[a] - time).abs().total_cmp(&(times[b] - time).abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_covariance_and_histogram_of_three_realizations() {
        let dir = tempfile::tempdir().unwrap();
        let columns = Columns { groups: vec!["all".into(); 2], species: vec!["A".into(), "B".into()] };
        let block = |realization: u32, a: f64| SeriesBlock {
            realization,
            amount: vec![a, 10.0 - a],
            concentration: vec![0.0; 2],
        };
        let blocks = [block(2, 5.0), block(0, 1.0), block(1, 3.0)];
        write_statistics(dir.path(), &[1.5], &columns, &blocks).unwrap();
        let rows = read_statistics(dir.path()).unwrap();
        assert_eq!((rows.len(), rows[0].summary.mean, rows[0].summary.variance), (2, 3.0, 4.0));
        write_covariance(dir.path(), &[1.5], &columns, &blocks).unwrap();
        let c = read_covariance(dir.path()).unwrap();
        assert_eq!(c.iter().map(|r| r.covariance).collect::<Vec<_>>(), [4.0, -4.0, -4.0, 4.0]);
        let wanted = HistogramRecord { group: "all".into(), species: "A".into(), times: vec![1.5] };
        write_histograms(dir.path(), &[1.5], &columns, &blocks, &[wanted]).unwrap();
        let bins = read_histograms(dir.path()).unwrap();
        assert_eq!(bins.iter().map(|b| b.count).sum::<u32>(), 3);
        assert!(bins.iter().all(|b| b.low < b.high && b.species == "A"));
    }
}
