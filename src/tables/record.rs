//! `run.json`.

use super::write_bytes;
use crate::error::RunError;
use crate::record::RunRecord;
use std::path::Path;

/// Writes `run.json` in `dir`, indented.
///
/// # Errors
/// [`RunError::File`] if it cannot be written.
pub fn write_record(dir: &Path, record: &RunRecord) -> Result<(), RunError> {
    let path = dir.join("run.json");
    let mut text = serde_json::to_string_pretty(record)
        .map_err(|e| RunError::File { path: path.display().to_string(), reason: e.to_string() })?;
    text.push('\n');
    write_bytes(&path, text.as_bytes())
}

/// Reads `run.json` in `dir`.
///
/// # Errors
/// [`RunError::File`] if it is missing or not the record of a run.
pub fn read_record(dir: &Path) -> Result<RunRecord, RunError> {
    let path = dir.join("run.json");
    let fault = |reason: String| RunError::File { path: path.display().to_string(), reason };
    let text = std::fs::read_to_string(&path).map_err(|e| fault(e.to_string()))?;
    serde_json::from_str(&text).map_err(|e| fault(e.to_string()))
}
