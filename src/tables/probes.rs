//! `tables/probes.parquet`: quantities along lines and rings.

use super::frame::{self, Sheet, Table};
use crate::error::RunError;
use crate::samples::ProbeRows;
use polars::prelude::*;
use std::path::{Path, PathBuf};

/// Rows of a row group, roughly: bounds the memory of writing.
const ROWS_PER_GROUP: usize = 1 << 17;

/// Writes `tables/probes.parquet` in order of realization; within one the given order stands.
pub struct ProbesWriter {
    path: PathBuf,
    sheet: Sheet,
    waiting: Vec<ProbeRows>,
    rows: usize,
}

impl ProbesWriter {
    /// Begins the table below `dir`.
    ///
    /// # Errors
    /// [`RunError::File`] if the file cannot be written.
    pub fn new(dir: &Path) -> Result<ProbesWriter, RunError> {
        let path = dir.join("tables/probes.parquet");
        let mut sheet = Sheet::new(&path)?;
        sheet.push(row_group(&[]))?;
        Ok(ProbesWriter { path, sheet, waiting: Vec::new(), rows: 0 })
    }

    /// Appends a row of one probe.
    ///
    /// # Errors
    /// As [`ProbesWriter::new`], and arrays that differ in length.
    pub fn push(&mut self, rows: &ProbeRows) -> Result<(), RunError> {
        if rows.s.len() != rows.value.len() || rows.s.len() != rows.position.len() {
            let reason = format!("probe {} at {} s: arrays differ in length", rows.probe, rows.time);
            return Err(RunError::File { path: self.path.display().to_string(), reason });
        }
        self.rows += rows.s.len();
        self.waiting.push(rows.clone());
        if self.rows >= ROWS_PER_GROUP { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), RunError> {
        self.sheet.push(row_group(&self.waiting))?;
        self.waiting.clear();
        self.rows = 0;
        Ok(())
    }

    /// Completes the table.
    ///
    /// # Errors
    /// As [`ProbesWriter::new`].
    pub fn finish(mut self) -> Result<(), RunError> {
        if !self.waiting.is_empty() {
            self.flush()?;
        }
        self.sheet.finish()
    }
}

/// Writes `tables/probes.parquet` below `dir`, sorted by realization; within one the given order stands.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written or the arrays of a row differ in length.
pub fn write_probes(dir: &Path, rows: &[ProbeRows]) -> Result<(), RunError> {
    let mut sorted: Vec<&ProbeRows> = rows.iter().collect();
    sorted.sort_by_key(|r| r.realization);
    let mut writer = ProbesWriter::new(dir)?;
    for rows in sorted {
        writer.push(rows)?;
    }
    writer.finish()
}

fn row_group(blocks: &[ProbeRows]) -> PolarsResult<DataFrame> {
    let rows = || blocks.iter().flat_map(|b| (0..b.s.len()).map(move |k| (b, k)));
    let probe: Vec<&str> = rows().map(|(b, _)| b.probe.as_str()).collect();
    let quantity: Vec<&str> = rows().map(|(b, _)| b.quantity.as_str()).collect();
    DataFrame::new_infer_height(vec![
        frame::text("probe", &probe),
        frame::whole("realization", rows().map(|(b, _)| b.realization).collect()),
        frame::reals("time", rows().map(|(b, _)| b.time).collect()),
        frame::reals("s", rows().map(|(b, k)| b.s[k]).collect()),
        frame::reals("x", rows().map(|(b, k)| b.position[k][0]).collect()),
        frame::reals("y", rows().map(|(b, k)| b.position[k][1]).collect()),
        frame::reals("z", rows().map(|(b, k)| b.position[k][2]).collect()),
        frame::text("quantity", &quantity),
        frame::reals("value", rows().map(|(b, k)| b.value[k]).collect()),
    ])
}

/// Reads `tables/probes.parquet` below `dir`, one entry per probe, realization, time and quantity.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_probes(dir: &Path) -> Result<Vec<ProbeRows>, RunError> {
    read_probes_head(dir, usize::MAX)
}

/// Reads at most the first `rows` rows of `tables/probes.parquet` below `dir`; a realization cut short is left out.
///
/// # Errors
/// As [`read_probes`].
pub fn read_probes_head(dir: &Path, rows: usize) -> Result<Vec<ProbeRows>, RunError> {
    let table = Table::read_head(&dir.join("tables/probes.parquet"), rows)?;
    let (probe, quantity) = (table.text("probe")?, table.text("quantity")?);
    let (realization, time) = (table.whole("realization")?, table.reals("time")?);
    let (s, value) = (table.reals("s")?, table.reals("value")?);
    let (x, y, z) = (table.reals("x")?, table.reals("y")?, table.reals("z")?);
    let mut out: Vec<ProbeRows> = Vec::new();
    for k in 0..table.rows() {
        let same = out.last().is_some_and(|r| {
            r.probe == probe[k]
                && r.quantity == quantity[k]
                && r.realization == realization[k]
                && r.time == time[k]
        });
        if !same {
            out.push(ProbeRows {
                probe: probe[k].to_string(),
                realization: realization[k],
                time: time[k],
                quantity: quantity[k].to_string(),
                ..ProbeRows::default()
            });
        }
        if let Some(row) = out.last_mut() {
            row.s.push(s[k]);
            row.position.push([x[k], y[k], z[k]]);
            row.value.push(value[k]);
        }
    }
    if table.rows() == rows {
        // What is there of the last realization may not be all.
        let last = out.last().map(|row| row.realization);
        let several = out.first().map(|row| row.realization) != last;
        out.retain(|row| !several || Some(row.realization) != last);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let dir = tempfile::tempdir().unwrap();
        let row = |realization, quantity: &str| ProbeRows {
            probe: "ring".into(),
            realization,
            time: 0.25,
            quantity: quantity.into(),
            s: vec![0.0, 1.0],
            position: vec![[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]],
            value: vec![0.5, f64::from(realization)],
        };
        let rows = [row(0, "L"), row(0, "vx"), row(1, "L")];
        write_probes(dir.path(), &rows).unwrap();
        assert_eq!(read_probes(dir.path()).unwrap(), rows);
        write_probes(dir.path(), &[]).unwrap();
        assert!(read_probes(dir.path()).unwrap().is_empty());
    }
}
