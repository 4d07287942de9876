//! What a run leaves as tables: Parquet by polars, `run.json`, and their readers.
//!
//! Every file is written under a temporary name in its own folder and then renamed, so a reader never sees
//! half a file. Rows come in a fixed order and row groups have a fixed size: the same samples give the same bytes.

mod comparisons;
mod frame;
mod particles;
mod probes;
mod record;
mod series;
mod summary;
mod sweep;
mod time_averages;

pub use crate::samples::{Columns, ParticleFrame, ProbeRows, SeriesBlock};
pub use comparisons::{ComparisonRow, write_comparison};
pub use particles::{list_particles, read_particles, write_particles};
pub use probes::{ProbesWriter, read_probes, read_probes_head, write_probes};
pub use record::{is_sweep, read_record, read_sweep_record, write_record, write_sweep_record};
pub use series::{SeriesTable, SeriesWriter, read_series, read_series_head, write_series};
pub use summary::{
    Bin, CovarianceRow, CovarianceWriter, StatisticsRow, StatisticsWriter, read_covariance, read_histograms,
    read_statistics, write_histograms,
};
pub use sweep::{SweepRow, SweepWriter, read_sweep_ends};
pub use time_averages::{
    TimeAverageRow, averages_of, averages_of_all, read_time_averages, write_time_averages,
};

use crate::error::RunError;
use std::io::Write;
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a file as a whole or not at all: temporary name in the same folder, then rename. Makes the folder
/// if it is missing.
///
/// # Errors
/// [`RunError::File`] with the path and what the system said.
pub fn write_atomically(
    path: &Path,
    content: impl FnOnce(&mut std::fs::File) -> Result<(), String>,
) -> Result<(), RunError> {
    let fault = |reason: String| RunError::File { path: path.display().to_string(), reason };
    let mut file = draft(path)?;
    content(file.as_file_mut()).map_err(fault)?;
    finish(file, path)
}

/// A temporary file in the folder of a file to be written; the folder is made if it is missing.
fn draft(path: &Path) -> Result<NamedTempFile, RunError> {
    let fault = |reason: String| RunError::File { path: path.display().to_string(), reason };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(|e| fault(e.to_string()))?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".writing-");
    // Without this the file would keep the private mode of a temporary file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    builder.tempfile_in(folder).map_err(|e| fault(e.to_string()))
}

/// Drives a draft to the disk and gives it its name.
fn finish(mut draft: NamedTempFile, path: &Path) -> Result<(), RunError> {
    let fault = |reason: String| RunError::File { path: path.display().to_string(), reason };
    let file = draft.as_file_mut();
    file.flush().and_then(|()| file.sync_all()).map_err(|e| fault(e.to_string()))?;
    draft.persist(path).map_err(|e| fault(e.error.to_string()))?;
    Ok(())
}

/// Writes text or bytes as a whole or not at all.
///
/// # Errors
/// [`RunError::File`] with the path and what the system said.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    write_atomically(path, |file| file.write_all(bytes).map_err(|e| e.to_string()))
}
