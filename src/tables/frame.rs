//! Columns to Parquet and back.

use super::{draft, finish};
use crate::error::RunError;
use polars::io::parquet::write::BatchedWriter;
use polars::prelude::*;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A column of numbers.
pub fn reals(name: &str, values: Vec<f64>) -> Column {
    Column::new(name.into(), values)
}

/// A column of whole numbers.
pub fn whole(name: &str, values: Vec<u32>) -> Column {
    Column::new(name.into(), values)
}

/// A column of text.
pub fn text(name: &str, values: &[&str]) -> Column {
    Column::new(name.into(), values)
}

/// Writes frames one after the other as row groups of one file; at least one frame, which may be empty.
pub fn write_frames(
    path: &Path,
    frames: impl Iterator<Item = PolarsResult<DataFrame>>,
) -> Result<(), RunError> {
    let mut sheet = Sheet::new(path)?;
    for frame in frames {
        sheet.push(frame)?;
    }
    sheet.finish()
}

/// A table that is written row group by row group and gets its name when it is complete.
pub struct Sheet {
    path: PathBuf,
    draft: NamedTempFile,
    writer: Option<BatchedWriter<BufWriter<File>>>,
}

impl Sheet {
    /// Begins a table.
    pub fn new(path: &Path) -> Result<Sheet, RunError> {
        Ok(Sheet { path: path.to_path_buf(), draft: draft(path)?, writer: None })
    }

    /// Appends a row group; the first one says what the columns are and may be empty.
    pub fn push(&mut self, frame: PolarsResult<DataFrame>) -> Result<(), RunError> {
        let fault = |reason: String| RunError::File { path: self.path.display().to_string(), reason };
        let frame = frame.map_err(|e| fault(e.to_string()))?;
        if self.writer.is_none() {
            let file = self.draft.as_file().try_clone().map_err(|e| fault(e.to_string()))?;
            let writer =
                ParquetWriter::new(BufWriter::new(file)).with_compression(ParquetCompression::Zstd(None));
            self.writer = Some(writer.batched(frame.schema()).map_err(|e| fault(e.to_string()))?);
        }
        match &mut self.writer {
            Some(writer) => writer.write_batch(&frame).map_err(|e| fault(e.to_string())),
            None => Ok(()),
        }
    }

    /// Completes the table.
    pub fn finish(mut self) -> Result<(), RunError> {
        if let Some(writer) = self.writer.take() {
            let fault = |reason: String| RunError::File { path: self.path.display().to_string(), reason };
            writer.finish().map_err(|e| fault(e.to_string()))?;
        }
        finish(self.draft, &self.path)
    }
}

/// A file read back; asking for a column that is not there is an error with the file's name.
pub struct Table {
    path: PathBuf,
    frame: DataFrame,
}

impl Table {
    /// Reads a whole file.
    pub fn read(path: &Path) -> Result<Table, RunError> {
        Table::read_head(path, usize::MAX)
    }

    /// Reads at most the first `rows` rows of a file.
    pub fn read_head(path: &Path, rows: usize) -> Result<Table, RunError> {
        Table::read_part(path, 0, rows)
    }

    /// Reads at most `rows` rows of a file after the first `from`.
    pub fn read_part(path: &Path, from: usize, rows: usize) -> Result<Table, RunError> {
        let fault = |reason: String| RunError::File { path: path.display().to_string(), reason };
        let file = File::open(path).map_err(|e| fault(e.to_string()))?;
        let slice = (rows < usize::MAX).then_some((from, rows));
        let frame = ParquetReader::new(file).with_slice(slice).finish().map_err(|e| fault(e.to_string()))?;
        Ok(Table { path: path.to_path_buf(), frame })
    }

    pub fn rows(&self) -> usize {
        self.frame.height()
    }

    pub fn names(&self) -> Vec<String> {
        self.frame.get_column_names().iter().map(|n| n.to_string()).collect()
    }

    pub fn reals(&self, name: &str) -> Result<Vec<f64>, RunError> {
        let values = self.column(name)?.f64().map_err(|e| self.fault(&e))?;
        Ok(values.iter().map(|v| v.unwrap_or(f64::NAN)).collect())
    }

    pub fn whole(&self, name: &str) -> Result<Vec<u32>, RunError> {
        let values = self.column(name)?.u32().map_err(|e| self.fault(&e))?;
        Ok(values.iter().map(|v| v.unwrap_or(0)).collect())
    }

    pub fn whole_or_null(&self, name: &str) -> Result<Vec<Option<u32>>, RunError> {
        Ok(self.column(name)?.u32().map_err(|e| self.fault(&e))?.iter().collect())
    }

    pub fn text(&self, name: &str) -> Result<Vec<&str>, RunError> {
        let values = self.column(name)?.str().map_err(|e| self.fault(&e))?;
        Ok(values.iter().map(|v| v.unwrap_or("")).collect())
    }

    fn column(&self, name: &str) -> Result<&Column, RunError> {
        self.frame.column(name).map_err(|e| self.fault(&e))
    }

    fn fault(&self, error: &PolarsError) -> RunError {
        RunError::File { path: self.path.display().to_string(), reason: error.to_string() }
    }
}

/// Distinct names in order of appearance, and each row's index into them.
pub fn index_of_names(rows: &[&str]) -> (Vec<String>, Vec<usize>) {
    let mut names: Vec<String> = Vec::new();
    let mut numbers = std::collections::HashMap::new();
    let index = rows
        .iter()
        .map(|&row| {
            *numbers.entry(row).or_insert_with(|| {
                names.push(row.to_string());
                names.len() - 1
            })
        })
        .collect();
    (names, index)
}
