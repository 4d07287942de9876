//! The same as a workflow for Snakemake: a rule for the blocks, one that joins them.

use super::slurm::{fill, name_of_partition, path_text, word};
use super::{Ensemble, Job};
use crate::error::Fault;
use std::path::Path;

/// The text of a `Snakefile`; `folder` is where it goes, for the commands in its head.
///
/// # Errors
/// A binary whose path cannot be written in a script, a partition that is no name.
pub fn snakemake(ensemble: &Ensemble, job: &Job, binary: &Path, folder: &Path) -> Result<String, Fault> {
    let mut resources = vec![format!("        runtime={},", job.time.seconds.div_ceil(60))];
    if let Some(memory) = &job.memory {
        resources.push(format!("        mem_mb={},", memory.mebibytes));
    }
    if let Some(partition) = &job.partition {
        resources.push(format!("        slurm_partition={},", quoted(name_of_partition(partition)?)));
    }
    Ok(fill(
        include_str!("scripts/Snakefile"),
        &[
            ("@FILE@", word(path_text(&folder.join("Snakefile"))?)),
            ("@BINARY@", quoted(path_text(binary)?)),
            ("@BLOCKS@", ensemble.blocks.to_string()),
            ("@THREADS@", job.threads.to_string()),
            ("@RESOURCES@", resources.join("\n")),
        ],
    ))
}

/// A text without control characters as a text of Python.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', r"\\").replace('"', "\\\""))
}
