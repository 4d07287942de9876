//! Columns to Parquet and back.

use super::write_atomically;
use crate::error::RunError;
use polars::prelude::*;
use std::fs::File;
use std::path::{Path, PathBuf};

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
    write_atomically(path, |file| parquet(file, frames).map_err(|e| e.to_string()))
}

fn parquet(file: &mut File, mut frames: impl Iterator<Item = PolarsResult<DataFrame>>) -> PolarsResult<()> {
    let Some(first) = frames.next().transpose()? else { return Ok(()) };
    let writer = ParquetWriter::new(std::io::BufWriter::new(file));
    let mut writer = writer.with_compression(ParquetCompression::Zstd(None)).batched(first.schema())?;
    writer.write_batch(&first)?;
    for frame in frames {
        writer.write_batch(&frame?)?;
    }
    writer.finish()?;
    Ok(())
}

/// A file read back; asking for a column that is not there is an error with the file's name.
pub struct Table {
    path: PathBuf,
    frame: DataFrame,
}

impl Table {
    /// Reads a whole file.
    pub fn read(path: &Path) -> Result<Table, RunError> {
        let fault = |reason: String| RunError::File { path: path.display().to_string(), reason };
        let file = File::open(path).map_err(|e| fault(e.to_string()))?;
        let frame = ParquetReader::new(file).finish().map_err(|e| fault(e.to_string()))?;
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
