//! Tables across realizations: statistics, covariances, histograms.

use super::frame::{self, Sheet, Table};
use crate::error::RunError;
use crate::samples::Columns;
use crate::statistics::{CoMoments, Interval, Summary, mean_interval};
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

/// Writes `tables/statistics.parquet`: one row per time and column.
pub struct StatisticsWriter<'a> {
    columns: &'a Columns,
    sheet: Sheet,
}

impl<'a> StatisticsWriter<'a> {
    /// Begins the table below `dir`.
    ///
    /// # Errors
    /// [`RunError::File`] if the file cannot be written.
    pub fn new(dir: &Path, columns: &'a Columns) -> Result<StatisticsWriter<'a>, RunError> {
        Ok(StatisticsWriter { columns, sheet: Sheet::new(&dir.join("tables/statistics.parquet"))? })
    }

    /// Appends the rows of some times: `rows` are times x columns.
    ///
    /// # Errors
    /// As [`StatisticsWriter::new`].
    pub fn push(&mut self, times: &[f64], rows: &[Summary]) -> Result<(), RunError> {
        let (width, columns) = (self.columns.len().max(1), self.columns);
        let names =
            |of: &'a [String]| -> Vec<&'a str> { (0..rows.len()).map(|k| of[k % width].as_str()).collect() };
        let mut all = vec![
            frame::reals("time", (0..rows.len()).map(|k| times[k / width]).collect()),
            frame::text("group", &names(&columns.groups)),
            frame::text("species", &names(&columns.species)),
        ];
        all.extend(summary_columns(rows));
        self.sheet.push(DataFrame::new_infer_height(all))
    }

    /// Completes the table.
    ///
    /// # Errors
    /// As [`StatisticsWriter::new`].
    pub fn finish(self) -> Result<(), RunError> {
        self.sheet.finish()
    }
}

/// The 95 % confidence interval of the mean: Student's t.
fn interval(s: &Summary) -> Interval {
    mean_interval(s.mean, s.sem, s.count as f64 - 1.0, 0.95)
}

/// The columns of summaries, from `realizations` on. `mean_low` to `mean_high` is the 95 % confidence interval of the
/// mean.
pub(super) fn summary_columns(rows: &[Summary]) -> Vec<Column> {
    let column =
        |name: &str, value: fn(&Summary) -> f64| frame::reals(name, rows.iter().map(value).collect());
    vec![
        frame::whole("realizations", rows.iter().map(|s| s.count as u32).collect()),
        column("mean", |s| s.mean),
        column("mean_low", |s| interval(s).low),
        column("mean_high", |s| interval(s).high),
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
    ]
}

/// Rows of time, group, species and summary.
pub(super) fn summary_rows(table: &Table) -> Result<Vec<StatisticsRow>, RunError> {
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

/// Reads `tables/statistics.parquet` below `dir`.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_statistics(dir: &Path) -> Result<Vec<StatisticsRow>, RunError> {
    summary_rows(&Table::read(&dir.join("tables/statistics.parquet"))?)
}

/// Writes `tables/covariance.parquet`: the full symmetric matrix of all columns at each time.
pub struct CovarianceWriter<'a> {
    columns: &'a Columns,
    sheet: Sheet,
}

impl<'a> CovarianceWriter<'a> {
    /// Begins the table below `dir`.
    ///
    /// # Errors
    /// [`RunError::File`] if the file cannot be written.
    pub fn new(dir: &Path, columns: &'a Columns) -> Result<CovarianceWriter<'a>, RunError> {
        Ok(CovarianceWriter { columns, sheet: Sheet::new(&dir.join("tables/covariance.parquet"))? })
    }

    /// Appends the matrix at a time, s.
    ///
    /// # Errors
    /// As [`CovarianceWriter::new`].
    pub fn push(&mut self, time: f64, moments: &CoMoments) -> Result<(), RunError> {
        let (width, columns) = (self.columns.len(), self.columns);
        let pairs = || (0..width).flat_map(|a| (0..width).map(move |b| (a, b)));
        let name = |names: &'a [String], first: bool| -> Vec<&'a str> {
            pairs().map(|(a, b)| names[if first { a } else { b }].as_str()).collect()
        };
        // One row group a time: a matrix of many columns stays within memory.
        self.sheet.push(DataFrame::new_infer_height(vec![
            frame::reals("time", vec![time; width * width]),
            frame::text("group_a", &name(&columns.groups, true)),
            frame::text("species_a", &name(&columns.species, true)),
            frame::text("group_b", &name(&columns.groups, false)),
            frame::text("species_b", &name(&columns.species, false)),
            frame::reals("covariance", pairs().map(|(a, b)| moments.covariance(a, b)).collect()),
        ]))
    }

    /// Completes the table.
    ///
    /// # Errors
    /// As [`CovarianceWriter::new`].
    pub fn finish(self) -> Result<(), RunError> {
        self.sheet.finish()
    }
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

/// Writes `tables/histogram.parquet` below `dir`.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written.
pub fn write_histograms(dir: &Path, bins: &[Bin]) -> Result<(), RunError> {
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
