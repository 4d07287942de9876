//! The verb `cluster`: an ensemble as many jobs.

mod scripts;
mod status;

use super::{Stop, print, verbs};
use crate::cluster::{self, Folder, State};
use crate::error::{Fault, ModelError, RunError};
use crate::tables;
use clap::Subcommand;
use std::ffi::OsString;
use std::path::PathBuf;

#[derive(Subcommand)]
pub(crate) enum Task {
    /// Write scripts for Slurm: an array job with a task a block, a merge job, and submit.sh, which submits both
    /// and, run again, only blocks that are not finished
    Slurm(scripts::Options),
    /// Write a workflow for Snakemake: a rule for the blocks and one that joins them
    Snakemake(scripts::Options),
    /// Show where each block stands
    Status {
        /// Folder of the results or of the blocks
        dir: PathBuf,
        /// Print only the list of blocks that are not finished, e.g. 3,7-9; `joined` if there are none and the
        /// results are there
        #[arg(long)]
        unfinished: bool,
        /// Blocks to leave out of that list
        #[arg(long, value_name = "LIST", requires = "unfinished", default_value = "")]
        except: String,
    },
    /// Run a block, or go on with it where it was cut off (the scripts do this)
    Block {
        /// Folder of the results or of the blocks
        dir: PathBuf,
        /// Number of the block, from 0
        block: u32,
        /// Number of threads
        #[arg(long, default_value_t = 1)]
        threads: u32,
    },
    /// Join the blocks once all are finished (the scripts do this)
    Merge {
        /// Folder of the results or of the blocks
        dir: PathBuf,
    },
}

pub(crate) fn cluster(task: &Task) -> Result<(), Stop> {
    match task {
        Task::Slurm(options) => scripts::slurm(options),
        Task::Snakemake(options) => scripts::snakemake(options),
        Task::Status { dir, unfinished: true, except } => {
            let except = cluster::expand(except)?;
            print(&status::unfinished(&Folder::open(dir)?, &except));
            Ok(())
        }
        Task::Status { dir, .. } => {
            print(&status::table(&Folder::open(dir)?));
            Ok(())
        }
        Task::Block { dir, block: k, threads } => block(&Folder::open(dir)?, *k, *threads),
        Task::Merge { dir } => merge(&Folder::open(dir)?),
    }
}

/// Runs block `k` as a user would type it, with `--resume` where something of it is there.
fn block(folder: &Folder, k: u32, threads: u32) -> Result<(), Stop> {
    let ensemble = &folder.ensemble;
    if k >= ensemble.blocks {
        return Err(Fault::general(
            format!("{}: there is no block {k}", folder.path.display()),
            format!("blocks are numbered from 0 to {}", ensemble.blocks - 1),
        )
        .into());
    }
    if ensemble.version != env!("CARGO_PKG_VERSION") {
        return Err(Fault::general(
            format!("{} was written by version {} of this program", folder.path.display(), ensemble.version),
            format!("blocks of different versions cannot be joined: run that one, set by GILLESPH in the scripts, or write another folder with version {}", env!("CARGO_PKG_VERSION")),
        )
        .into());
    }
    let (dir, range) = (folder.block(k), ensemble.range(k));
    let standing = folder.standing(k);
    if standing.state == State::Finished {
        tell!("block {k} is finished");
        return Ok(());
    }
    if standing.state == State::Missing && dir.exists() {
        // Cut off before its record was written: there is nothing to go on with.
        std::fs::remove_dir_all(&dir)
            .map_err(|error| RunError::File { path: dir.display().to_string(), reason: error.to_string() })?;
    }
    let mut words: Vec<OsString> = vec!["gillesph".into(), "run".into(), folder.model().into()];
    for (option, value) in [
        ("--realizations", format!("{}..{}", range.start, range.end)),
        ("--seed", ensemble.seed.to_string()),
        ("--threads", threads.to_string()),
    ] {
        words.extend([option.into(), value.into()]);
    }
    for assignment in &ensemble.overrides {
        words.push(format!("--set={assignment}").into());
    }
    words.extend(["--out".into(), dir.into()]);
    if standing.state != State::Missing {
        words.push("--resume".into());
    }
    super::perform_words(words)
}

/// Joins the blocks into the folder round them.
fn merge(folder: &Folder) -> Result<(), Stop> {
    let open = folder.unfinished();
    let unfinished = (!open.is_empty()).then(|| {
        Fault::general(
            format!("{}: not finished are blocks {}", folder.path.display(), cluster::compact(&open)),
            "`gillesph cluster status` shows where they stand; submit.sh or snakemake, run again, go on with them",
        )
    });
    let faults: Vec<Fault> = unfinished.into_iter().chain(foreign(folder)).collect();
    if !faults.is_empty() {
        return Err(ModelError { faults }.into());
    }
    let blocks: Vec<PathBuf> = (0..folder.ensemble.blocks).map(|k| folder.block(k)).collect();
    verbs::merge(&folder.results(), &blocks, true)
}

/// A run in the folder of the results that is not of this ensemble must stay.
fn foreign(folder: &Folder) -> Option<Fault> {
    let results = folder.results();
    let there = results.join("run.json").exists();
    let ours = tables::read_record(&results).is_ok_and(|record| folder.holds(&record));
    (there && !ours).then(|| {
        Fault::general(
            format!("{} holds a run of another ensemble", results.display()),
            "move that run away, or move the folder of blocks to a folder of its own",
        )
    })
}
