//! `cluster slurm` and `cluster snakemake`: from a model and options to a folder with scripts.

use super::super::Stop;
use crate::cluster::{self, Ensemble, Folder, Job, Memory, Script, TimeLimit};
use crate::error::{Fault, ModelError, RunError};
use crate::model::{FlowFile, load};
use crate::plan::Plan;
use crate::tables;
use clap::Args;
use std::path::{Path, PathBuf};

/// Options of `cluster slurm` and `cluster snakemake`.
#[derive(Args)]
pub(crate) struct Options {
    /// Model file
    model: PathBuf,
    /// Number of blocks, each a job
    #[arg(long, allow_negative_numbers = true)]
    blocks: u32,
    /// Number of realizations (default: the model's)
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    realizations: Option<u32>,
    /// Folder of the results; blocks and scripts go to DIR/cluster (default: reports/<model name>)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Time limit of a job; a block that needs longer goes on in a further job
    #[arg(long, default_value = "02:00:00")]
    time: String,
    /// Memory of a job, e.g. 4G (default: what the cluster gives)
    #[arg(long)]
    memory: Option<String>,
    /// Threads of a job
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    threads: u32,
    /// Partition of the cluster
    #[arg(long)]
    partition: Option<String>,
    /// Seed of the random streams (default: the model's)
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Change a value of the model, e.g. --set run.until="1 s" (repeatable)
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
}

pub(super) fn slurm(options: &Options) -> Result<(), Stop> {
    let folder = write(options, |ensemble, job, _| cluster::slurm(ensemble, job, &binary()?))?;
    tell!("submit them with {}", word(&folder.path.join("submit.sh")));
    if folder.ensemble.blocks > LARGEST_ARRAY {
        tell!(
            "  more than {LARGEST_ARRAY} blocks need a larger MaxArraySize than Slurm's own; see `scontrol show config`"
        );
    }
    Ok(())
}

/// Tasks of an array in Slurm unless its `MaxArraySize` (1001) was changed.
const LARGEST_ARRAY: u32 = 1000;

pub(super) fn snakemake(options: &Options) -> Result<(), Stop> {
    let folder = write(options, |ensemble, job, path| {
        Ok(vec![("Snakefile", cluster::snakemake(ensemble, job, &binary()?, path)?, false)])
    })?;
    tell!("run them with snakemake --cores all --snakefile {}", word(&folder.path.join("Snakefile")));
    Ok(())
}

/// A path to copy into a shell.
fn word(path: &Path) -> String {
    cluster::word(&path.display().to_string())
}

/// Checks the model and all options, makes the folder of blocks and writes scripts there.
fn write(
    options: &Options,
    scripts: impl FnOnce(&Ensemble, &Job, &Path) -> Result<Vec<Script>, Fault>,
) -> Result<Folder, Stop> {
    let mut faults = Vec::new();
    let job = job(options, &mut faults);
    let model = load::model(&options.model, &options.set)?;
    if model.run.until_precision.is_some() {
        faults.push(Fault::at(
            &model.places.run,
            "run.until_precision chooses the number of realizations as it goes; blocks that run apart cannot",
            "remove it for a cluster, and give the number with --realizations",
        ));
    }
    let flow = match &model.flow {
        Some(FlowFile::Replay(path)) => Some(path.clone()),
        Some(FlowFile::Record(_)) => {
            faults.push(Fault::general(
                "flow: { record: … } in blocks: each of them would write that file",
                "record the flow by a run of its own, e.g. with --realizations 1, and let the blocks replay it",
            ));
            None
        }
        None => None,
    };
    if model.sweep.is_some() {
        faults.push(Fault::general(
            "a model with a sweep cannot run in blocks",
            "choose a point with --set and leave the sweep out; one cluster folder a point",
        ));
    }
    let realizations = options.realizations.unwrap_or(model.run.realizations);
    if let Err(fault) = check_blocks(options.blocks, realizations) {
        faults.push(fault);
    }
    let Some(job) = job.filter(|_| faults.is_empty()) else { return Err(ModelError { faults }.into()) };
    let ensemble = Ensemble {
        program: "gillesph".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        name: model.name.clone(),
        model: PathBuf::new(),
        hash: model.text.hash.clone(),
        overrides: options.set.clone(),
        seed: options.seed.unwrap_or(model.run.seed),
        realizations,
        blocks: options.blocks,
    };
    let text = model.text.clone();
    let results = options.out.clone().unwrap_or_else(|| Path::new("reports").join(&model.name));
    // What is wrong with the model shows here, not in each of many jobs.
    Plan::new(model, ensemble.largest_block())?;
    let scripts = scripts(&ensemble, &job, &results.join(cluster::FOLDER))?;
    let folder = cluster::prepare(&results, ensemble, &text, flow.as_deref())?;
    for (name, text, by_hand) in scripts {
        let path = folder.path.join(name);
        tables::write_bytes(&path, text.as_bytes())?;
        if by_hand {
            make_executable(&path)?;
        }
    }
    let ensemble = &folder.ensemble;
    tell!(
        "{}: {} realizations in {} block{} of up to {}, seed {}; scripts are in {}",
        ensemble.name,
        ensemble.realizations,
        ensemble.blocks,
        if ensemble.blocks == 1 { "" } else { "s" },
        ensemble.largest_block(),
        ensemble.seed,
        folder.path.display()
    );
    Ok(folder)
}

/// What each job asks for; faults go to the list.
fn job(options: &Options, faults: &mut Vec<Fault>) -> Option<Job> {
    let mut kept = |fault: Fault| faults.push(fault);
    let time = TimeLimit::parse(&options.time).map_err(&mut kept).ok();
    let memory = options.memory.as_deref().map(Memory::parse).transpose().map_err(&mut kept).ok();
    if options.threads == 0 || options.threads > 4096 {
        kept(Fault::general(
            format!("--threads {}: expected 1 to 4096 threads", options.threads),
            "leave the option out for one thread a job",
        ));
    }
    Some(Job { time: time?, memory: memory?, threads: options.threads, partition: options.partition.clone() })
}

fn check_blocks(blocks: u32, realizations: u32) -> Result<(), Fault> {
    if realizations == 0 {
        return Err(Fault::general(
            "--realizations 0: at least one realization is needed",
            "give a number, e.g. --realizations 1000",
        ));
    }
    if blocks == 0 {
        return Err(Fault::general(
            "--blocks 0: at least one block is needed",
            "give a number, e.g. --blocks 50",
        ));
    }
    if blocks > realizations {
        return Err(Fault::general(
            format!("--blocks {blocks}: more blocks than realizations ({realizations})"),
            "each block needs a realization: ask for fewer blocks, or for more with --realizations",
        ));
    }
    Ok(())
}

/// This program, as the jobs will call it.
fn binary() -> Result<PathBuf, Fault> {
    std::env::current_exe().map_err(|error| {
        Fault::general(
            format!("the path of this program cannot be found: {error}"),
            "call it by its full path",
        )
    })
}

#[cfg(unix)]
fn make_executable(path: &Path) -> Result<(), RunError> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755))
        .map_err(|error| RunError::File { path: path.display().to_string(), reason: error.to_string() })
}

#[cfg(not(unix))]
fn make_executable(_: &Path) -> Result<(), RunError> {
    Ok(())
}
