//! An ensemble spread over many jobs: a folder with a copy of the model, one folder a block, and the scripts that
//! run and join the blocks.
//!
//! ```text
//! reports/NAME/               what `run` would leave, once the blocks are joined
//!     cluster/cluster.json    which ensemble, in how many blocks
//!     cluster/input/          the model as it was when the scripts were written
//!     cluster/blocks/0007/    a run of its own: realizations A..B
//!     cluster/logs/           one log a block
//! ```
//!
//! Schedulers differ in how a task is told its number, and in little else: every script calls
//! `gillesph cluster block FOLDER K`, which starts block K, or goes on with it where it was cut off.

mod folder;
mod job;
mod slurm;
mod snakemake;
mod state;

pub use folder::prepare;
pub use job::{Job, Memory, TimeLimit};
pub use slurm::{Script, slurm, word};
pub use snakemake::snakemake;
pub use state::{Standing, State, compact, expand};

use crate::error::{Fault, ModelError, RunError};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Name of the folder of blocks and scripts below the folder of the results.
pub const FOLDER: &str = "cluster";
const DESCRIPTION: &str = "cluster.json";

/// Which ensemble a folder holds, and in how many blocks: the content of `cluster.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ensemble {
    pub program: String,
    pub version: String,
    /// The model's name.
    pub name: String,
    /// Path of the model's copy, relative to the folder.
    pub model: PathBuf,
    /// Hash of model, reactions and `--set` values; see [`crate::record::ModelText`].
    pub hash: String,
    /// `path=value` given with `--set`.
    pub overrides: Vec<String>,
    pub seed: u64,
    pub realizations: u32,
    pub blocks: u32,
}

impl Ensemble {
    /// Realizations of block `k`: blocks differ by one realization at most and leave no gap.
    #[must_use]
    pub fn range(&self, k: u32) -> Range<u32> {
        let edge = |k: u32| (u64::from(k) * u64::from(self.realizations) / u64::from(self.blocks)) as u32;
        edge(k)..edge(k + 1)
    }

    /// Realizations of the largest block.
    #[must_use]
    pub fn largest_block(&self) -> u32 {
        self.realizations.div_ceil(self.blocks)
    }

    /// What differs from another ensemble: its name in words, the value there, the value here.
    #[must_use]
    pub fn differences(&self, other: &Ensemble) -> Vec<(&'static str, String, String)> {
        let pair = |there: &dyn ToString, here: &dyn ToString| (there.to_string(), here.to_string());
        [
            ("model (its text, or a value given with --set)", pair(&short(&other.hash), &short(&self.hash))),
            ("seed", pair(&other.seed, &self.seed)),
            ("number of realizations", pair(&other.realizations, &self.realizations)),
            ("number of blocks", pair(&other.blocks, &self.blocks)),
            ("program version", pair(&other.version, &self.version)),
        ]
        .into_iter()
        .filter(|(_, (there, here))| there != here)
        .map(|(what, (there, here))| (what, there, here))
        .collect()
    }
}

/// The start of a hash, enough to tell two apart.
fn short(hash: &str) -> &str {
    hash.get(..12).unwrap_or(hash)
}

/// A folder of blocks that is there.
#[derive(Clone, Debug)]
pub struct Folder {
    /// Folder of scripts and blocks.
    pub path: PathBuf,
    pub ensemble: Ensemble,
}

impl Folder {
    /// Opens a folder of blocks, given itself or the folder of results it lies in.
    ///
    /// # Errors
    /// A folder without blocks, or one whose description cannot be read.
    pub fn open(dir: &Path) -> Result<Folder, ModelError> {
        let below = dir.join(FOLDER);
        let path = if below.join(DESCRIPTION).exists() { below } else { dir.to_path_buf() };
        let file = path.join(DESCRIPTION);
        let text = std::fs::read_to_string(&file).map_err(|error| {
            let reason = if file.exists() {
                format!("{}: {error}", file.display())
            } else {
                format!("{} holds no blocks of an ensemble", dir.display())
            };
            Fault::general(
                reason,
                "name a folder written by `gillesph cluster slurm` or `gillesph cluster snakemake`",
            )
        })?;
        let ensemble: Ensemble = serde_json::from_str(&text).map_err(|error| {
            Fault::general(
                format!("{}: {error}", file.display()),
                "the file is damaged: write the folder again under another name with --out",
            )
        })?;
        if ensemble.blocks == 0 || ensemble.blocks > ensemble.realizations {
            return Err(Fault::general(
                format!(
                    "{}: {} realizations in {} blocks",
                    file.display(),
                    ensemble.realizations,
                    ensemble.blocks
                ),
                "the file is damaged: write the folder again under another name with --out",
            )
            .into());
        }
        Ok(Folder { path, ensemble })
    }

    /// Folder of block `k`.
    #[must_use]
    pub fn block(&self, k: u32) -> PathBuf {
        self.path.join("blocks").join(format!("{k:04}"))
    }

    /// The model's copy.
    #[must_use]
    pub fn model(&self) -> PathBuf {
        self.path.join(&self.ensemble.model)
    }

    /// Where the joined results go: the folder round this one.
    #[must_use]
    pub fn results(&self) -> PathBuf {
        let path = self.path.canonicalize().unwrap_or_else(|_| self.path.clone());
        path.parent().map_or(path.clone(), Path::to_path_buf)
    }

    fn write_description(&self) -> Result<(), RunError> {
        let path = self.path.join(DESCRIPTION);
        let mut text = serde_json::to_string_pretty(&self.ensemble)
            .map_err(|e| RunError::File { path: path.display().to_string(), reason: e.to_string() })?;
        text.push('\n');
        crate::tables::write_bytes(&path, text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ensemble(realizations: u32, blocks: u32) -> Ensemble {
        Ensemble {
            program: "gillesph".into(),
            version: "0".into(),
            name: "t".into(),
            model: "input/t.yaml".into(),
            hash: "0123456789abcdef".into(),
            overrides: Vec::new(),
            seed: 1,
            realizations,
            blocks,
        }
    }

    #[test]
    fn blocks_cover_all_realizations_and_are_of_equal_size() {
        for (realizations, blocks) in [(1, 1), (2000, 50), (2001, 50), (7, 3), (u32::MAX, 1001)] {
            let whole = ensemble(realizations, blocks);
            let mut next = 0;
            for range in (0..blocks).map(|k| whole.range(k)) {
                assert_eq!(range.start, next);
                next = range.end;
                let size = range.end - range.start;
                assert!(size == realizations / blocks || size == whole.largest_block());
            }
            assert_eq!(next, realizations);
        }
        assert_eq!(ensemble(u32::MAX, u32::MAX).range(u32::MAX - 1), u32::MAX - 1..u32::MAX);
    }

    #[test]
    fn what_differs_is_named() {
        let (a, mut b) = (ensemble(10, 2), ensemble(10, 2));
        assert!(a.differences(&b).is_empty());
        b.seed = 7;
        assert_eq!(a.differences(&b), [("seed", "7".to_string(), "1".to_string())]);
    }
}
