//! `tables/series.parquet`: amounts against time, realization by realization.

use super::frame::{self, Sheet, Table};
use crate::error::RunError;
use crate::samples::{Columns, SeriesBlock};
use polars::prelude::*;
use std::path::Path;

/// Rows of a row group: bounds the memory of writing. The same rows give the same bytes however they came.
const ROWS_PER_GROUP: usize = 1 << 18;

/// The whole of `series.parquet`, blocks in order of realization.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SeriesTable {
    /// s.
    pub times: Vec<f64>,
    pub columns: Columns,
    pub blocks: Vec<SeriesBlock>,
}

impl SeriesTable {
    /// Amounts of one column at one time across realizations.
    #[must_use]
    pub fn across(&self, time: usize, column: usize) -> Vec<f64> {
        across(&self.blocks, self.columns.len(), time, column)
    }
}

/// Amounts of one column at one time across realizations.
pub(super) fn across(blocks: &[SeriesBlock], columns: usize, time: usize, column: usize) -> Vec<f64> {
    blocks.iter().filter_map(|b| b.amount.get(time * columns + column).copied()).collect()
}

/// Writes `tables/series.parquet` row by row, in order of realization, time and column.
pub struct SeriesWriter<'a> {
    times: &'a [f64],
    columns: &'a Columns,
    sheet: Sheet,
    realization: Vec<u32>,
    /// Time and column of each row that waits: time x columns + column.
    place: Vec<usize>,
    amount: Vec<f64>,
    concentration: Vec<f64>,
}

impl<'a> SeriesWriter<'a> {
    /// Begins the table below `dir`.
    ///
    /// # Errors
    /// [`RunError::File`] if the file cannot be written.
    pub fn new(dir: &Path, times: &'a [f64], columns: &'a Columns) -> Result<SeriesWriter<'a>, RunError> {
        let sheet = Sheet::new(&dir.join("tables/series.parquet"))?;
        let mut writer = SeriesWriter {
            times,
            columns,
            sheet,
            realization: Vec::new(),
            place: Vec::new(),
            amount: Vec::new(),
            concentration: Vec::new(),
        };
        // What the columns are is told even if there is no row.
        writer.flush()?;
        Ok(writer)
    }

    /// Appends what a realization has shown from output time number `first` on.
    ///
    /// # Errors
    /// As [`SeriesWriter::new`].
    pub fn push(
        &mut self,
        realization: u32,
        first: usize,
        amount: &[f64],
        concentration: &[f64],
    ) -> Result<(), RunError> {
        let from = first * self.columns.len();
        for (k, (&n, &c)) in amount.iter().zip(concentration).enumerate() {
            self.realization.push(realization);
            self.place.push(from + k);
            self.amount.push(n);
            self.concentration.push(c);
            if self.place.len() == ROWS_PER_GROUP {
                self.flush()?;
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), RunError> {
        let width = self.columns.len().max(1);
        let names = |of: &'a [String]| -> Vec<&'a str> {
            self.place.iter().map(|k| of[k % width].as_str()).collect()
        };
        let frame = DataFrame::new_infer_height(vec![
            frame::whole("realization", std::mem::take(&mut self.realization)),
            frame::reals("time", self.place.iter().map(|k| self.times[k / width]).collect()),
            frame::text("group", &names(&self.columns.groups)),
            frame::text("species", &names(&self.columns.species)),
            frame::reals("amount", std::mem::take(&mut self.amount)),
            frame::reals("concentration", std::mem::take(&mut self.concentration)),
        ]);
        self.place.clear();
        self.sheet.push(frame)
    }

    /// Completes the table.
    ///
    /// # Errors
    /// As [`SeriesWriter::new`].
    pub fn finish(mut self) -> Result<(), RunError> {
        if !self.place.is_empty() {
            self.flush()?;
        }
        self.sheet.finish()
    }
}

/// Writes `tables/series.parquet` below `dir`, sorted by realization, time and column.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written or a block does not have times x columns values.
pub fn write_series(
    dir: &Path,
    times: &[f64],
    columns: &Columns,
    blocks: &[SeriesBlock],
) -> Result<(), RunError> {
    let size = times.len() * columns.len();
    let mut sorted: Vec<&SeriesBlock> = blocks.iter().collect();
    sorted.sort_by_key(|b| b.realization);
    if let Some(b) = sorted.iter().find(|b| b.amount.len() != size || b.concentration.len() != size) {
        let reason = format!("realization {} holds {} amounts for {size}", b.realization, b.amount.len());
        return Err(RunError::File { path: dir.join("tables/series.parquet").display().to_string(), reason });
    }
    let mut writer = SeriesWriter::new(dir, times, columns)?;
    for block in sorted {
        writer.push(block.realization, 0, &block.amount, &block.concentration)?;
    }
    writer.finish()
}

/// Reads `tables/series.parquet` below `dir`.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing, or a realization is incomplete.
pub fn read_series(dir: &Path) -> Result<SeriesTable, RunError> {
    let path = dir.join("tables/series.parquet");
    blocks(&path, &Table::read(&path)?)
}

/// Reads at most the first `realizations` of `tables/series.parquet` below `dir`, each of `rows` rows.
///
/// # Errors
/// As [`read_series`].
pub fn read_series_head(dir: &Path, realizations: usize, rows: usize) -> Result<SeriesTable, RunError> {
    let path = dir.join("tables/series.parquet");
    blocks(&path, &Table::read_head(&path, realizations.saturating_mul(rows))?)
}

fn blocks(path: &Path, table: &Table) -> Result<SeriesTable, RunError> {
    let (realization, time) = (table.whole("realization")?, table.reals("time")?);
    let (group, species) = (table.text("group")?, table.text("species")?);
    let (amount, concentration) = (table.reals("amount")?, table.reals("concentration")?);
    let mut out = SeriesTable::default();
    let Some(&first) = realization.first() else { return Ok(out) };
    let size = realization.iter().take_while(|&&r| r == first).count();
    let width = time[..size].iter().take_while(|&&t| t == time[0]).count();
    out.times = time[..size].iter().step_by(width).copied().collect();
    out.columns.groups = group[..width].iter().map(|g| g.to_string()).collect();
    out.columns.species = species[..width].iter().map(|s| s.to_string()).collect();
    for start in (0..realization.len()).step_by(size) {
        let rows = start..(start + size).min(realization.len());
        let complete = rows.len() == size
            && rows.clone().all(|k| {
                realization[k] == realization[start]
                    && time[k] == time[k - start]
                    && group[k] == group[(k - start) % width]
                    && species[k] == species[(k - start) % width]
            });
        if !complete {
            let reason = format!("realization {} is incomplete or out of order", realization[start]);
            return Err(RunError::File { path: path.display().to_string(), reason });
        }
        out.blocks.push(SeriesBlock {
            realization: realization[start],
            amount: amount[rows.clone()].to_vec(),
            concentration: concentration[rows].to_vec(),
        });
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> SeriesTable {
        let columns = Columns {
            groups: ["water", "water", "all", "all"].map(String::from).to_vec(),
            species: ["A", "B", "A", "B"].map(String::from).to_vec(),
        };
        let block = |realization: u32| SeriesBlock {
            realization,
            amount: (0..8).map(|k| f64::from(k + realization)).collect(),
            concentration: (0..8).map(|k| f64::from(k) * 1e-6).collect(),
        };
        SeriesTable { times: vec![0.0, 0.5], columns, blocks: vec![block(3), block(4)] }
    }

    #[test]
    fn what_is_written_is_read_back_and_has_the_same_bytes() {
        let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let t = example();
        write_series(one.path(), &t.times, &t.columns, &t.blocks).unwrap();
        assert_eq!(read_series(one.path()).unwrap(), t);
        let turned: Vec<SeriesBlock> = t.blocks.iter().rev().cloned().collect();
        write_series(two.path(), &t.times, &t.columns, &turned).unwrap();
        let bytes = |dir: &Path| std::fs::read(dir.join("tables/series.parquet")).unwrap();
        assert_eq!(bytes(one.path()), bytes(two.path()));
        assert_eq!(std::fs::read_dir(one.path().join("tables")).unwrap().count(), 1);
    }

    #[test]
    fn faults_name_the_file() {
        let dir = tempfile::tempdir().unwrap();
        let missing = read_series(dir.path()).unwrap_err().to_string();
        assert!(missing.contains("series.parquet"), "{missing}");
        let mut t = example();
        t.blocks[0].amount.pop();
        assert!(write_series(dir.path(), &t.times, &t.columns, &t.blocks).is_err());
        write_series(dir.path(), &t.times, &t.columns, &[]).unwrap();
        assert!(read_series(dir.path()).unwrap().blocks.is_empty());
    }

    #[test]
    #[ignore = "1.5 million rows; for timing"]
    fn a_large_ensemble_is_written_and_read() {
        let dir = tempfile::tempdir().unwrap();
        let columns =
            Columns { groups: vec!["all".into(); 3], species: ["A", "B", "C"].map(String::from).to_vec() };
        let times: Vec<f64> = (0..51).map(f64::from).collect();
        let block = |realization: u32| SeriesBlock {
            realization,
            amount: (0..153).map(|k| f64::from((k * 7919 + realization * 104_729) % 1000)).collect(),
            concentration: vec![1e-6; 153],
        };
        let blocks: Vec<SeriesBlock> = (0..10_000).map(block).collect();
        let clock = std::time::Instant::now();
        write_series(dir.path(), &times, &columns, &blocks).unwrap();
        let written = clock.elapsed();
        let back = read_series(dir.path()).unwrap();
        let size = std::fs::metadata(dir.path().join("tables/series.parquet")).unwrap().len();
        eprintln!("written in {written:?}, read in {:?}, {size} bytes", clock.elapsed() - written);
        assert_eq!(back.blocks, blocks);
    }
}
