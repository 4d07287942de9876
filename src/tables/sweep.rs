//! `tables/sweep.parquet`: the statistics of every point of a sweep beside the values swept.

use super::frame::{self, Sheet, Table};
use super::summary::{StatisticsRow, summary_columns, summary_rows};
use crate::error::RunError;
use crate::record::SweptRecord;
use polars::prelude::*;
use std::path::Path;

/// Rows read at once.
const CHUNK: usize = 500_000;

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepRow {
    pub point: u32,
    /// In SI, in the order of the parameters.
    pub values: Vec<f64>,
    pub statistics: StatisticsRow,
}

/// Writes the table, point by point.
pub struct SweepWriter<'a> {
    parameters: &'a [SweptRecord],
    sheet: Sheet,
}

impl<'a> SweepWriter<'a> {
    /// Begins the table below `dir`.
    ///
    /// # Errors
    /// [`RunError::File`] if the file cannot be written.
    pub fn new(dir: &Path, parameters: &'a [SweptRecord]) -> Result<SweepWriter<'a>, RunError> {
        Ok(SweepWriter { parameters, sheet: Sheet::new(&dir.join("tables/sweep.parquet"))? })
    }

    /// Appends the statistics of a point with these values (SI).
    ///
    /// # Errors
    /// As [`SweepWriter::new`].
    pub fn push(&mut self, point: u32, values: &[f64], rows: &[StatisticsRow]) -> Result<(), RunError> {
        let mut columns = vec![frame::whole("point", vec![point; rows.len()])];
        for (parameter, &value) in self.parameters.iter().zip(values) {
            columns.push(frame::reals(&parameter.name, vec![value; rows.len()]));
        }
        let text = |of: fn(&StatisticsRow) -> &str| rows.iter().map(of).collect::<Vec<&str>>();
        columns.push(frame::reals("time", rows.iter().map(|row| row.time).collect()));
        columns.push(frame::text("group", &text(|row| &row.group)));
        columns.push(frame::text("species", &text(|row| &row.species)));
        columns.extend(summary_columns(&rows.iter().map(|row| row.summary).collect::<Vec<_>>()));
        self.sheet.push(DataFrame::new_infer_height(columns))
    }

    /// Completes the table.
    ///
    /// # Errors
    /// As [`SweepWriter::new`].
    pub fn finish(self) -> Result<(), RunError> {
        self.sheet.finish()
    }
}

/// Rows over the whole domain at the last output time of each point.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_sweep_ends(dir: &Path, parameters: &[SweptRecord]) -> Result<Vec<SweepRow>, RunError> {
    let path = dir.join("tables/sweep.parquet");
    let (mut ends, mut from): (Vec<SweepRow>, usize) = (Vec::new(), 0);
    loop {
        let table = Table::read_part(&path, from, CHUNK)?;
        let point = table.whole("point")?;
        let names = parameters.iter().map(|parameter| table.reals(&parameter.name));
        let values = names.collect::<Result<Vec<_>, _>>()?;
        for (k, statistics) in summary_rows(&table)?.into_iter().enumerate() {
            if statistics.group != "all" {
                continue;
            }
            // Times rise within a point: a later one takes the place of what came before.
            while ends
                .last()
                .is_some_and(|end| end.point == point[k] && end.statistics.time < statistics.time)
            {
                ends.pop();
            }
            ends.push(SweepRow {
                point: point[k],
                values: values.iter().map(|column| column[k]).collect(),
                statistics,
            });
        }
        from += table.rows();
        if table.rows() < CHUNK {
            return Ok(ends);
        }
    }
}
