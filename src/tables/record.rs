//! `run.json`, of a run and of a sweep.

use super::write_bytes;
use crate::error::RunError;
use crate::record::{RunRecord, SweepRecord};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Writes `run.json` in `dir`, indented.
///
/// # Errors
/// [`RunError::File`] if it cannot be written.
pub fn write_record(dir: &Path, record: &RunRecord) -> Result<(), RunError> {
    write(dir, record)
}

/// Writes the `run.json` of a sweep in `dir`.
///
/// # Errors
/// [`RunError::File`] if it cannot be written.
pub fn write_sweep_record(dir: &Path, record: &SweepRecord) -> Result<(), RunError> {
    write(dir, record)
}

/// Reads `run.json` in `dir`.
///
/// # Errors
/// [`RunError::File`] if it is missing or not the record of a run.
pub fn read_record(dir: &Path) -> Result<RunRecord, RunError> {
    read(dir).map_err(|error| {
        if !is_sweep(dir) {
            return error;
        }
        let path = dir.join("run.json").display().to_string();
        let point = dir.join("points/0000");
        let reason = format!("this is a sweep, not a run; name one of its points, e.g. {}", point.display());
        RunError::File { path, reason }
    })
}

/// Reads the `run.json` of a sweep in `dir`.
///
/// # Errors
/// [`RunError::File`] if it is missing or not the record of a sweep.
pub fn read_sweep_record(dir: &Path) -> Result<SweepRecord, RunError> {
    read(dir)
}

/// Whether a folder holds a sweep.
#[must_use]
pub fn is_sweep(dir: &Path) -> bool {
    read_sweep_record(dir).is_ok()
}

fn write<T: Serialize>(dir: &Path, record: &T) -> Result<(), RunError> {
    let path = dir.join("run.json");
    let mut text = serde_json::to_string_pretty(record)
        .map_err(|e| RunError::File { path: path.display().to_string(), reason: e.to_string() })?;
    text.push('\n');
    write_bytes(&path, text.as_bytes())
}

fn read<T: DeserializeOwned>(dir: &Path) -> Result<T, RunError> {
    let path = dir.join("run.json");
    let fault = |reason: String| RunError::File { path: path.display().to_string(), reason };
    let text = std::fs::read_to_string(&path).map_err(|e| fault(e.to_string()))?;
    serde_json::from_str(&text).map_err(|e| fault(e.to_string()))
}
