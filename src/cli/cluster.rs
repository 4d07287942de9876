//! The verb `cluster`: an ensemble as many jobs.

use super::{Stop, print, verbs};
use crate::cluster::{self, Ensemble, Folder, Job, Memory, State, TimeLimit};
use crate::error::{Fault, ModelError, RunError};
use crate::model::load;
use crate::plan::Plan;
use crate::tables;
use clap::{Args, Subcommand};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

#[derive(Subcommand)]
pub(crate) enum Task {
    /// Write scripts for Slurm: an array job with a task a block, a merge job, and submit.sh, which submits both
    /// and, run again, only blocks that are not finished
    Slurm(Options),
    /// Write a workflow for Snakemake: a rule for the blocks and one that joins them
    Snakemake(Options),
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

pub(crate) fn cluster(task: &Task) -> Result<(), Stop> {
    match task {
        Task::Slurm(options) => slurm(options),
        Task::Snakemake(options) => snakemake(options),
        Task::Status { dir, unfinished: true, except } => {
            let except = cluster::expand(except)?;
            unfinished(&Folder::open(dir)?, &except);
            Ok(())
        }
        Task::Status { dir, .. } => {
            print(&table(&Folder::open(dir)?));
            Ok(())
        }
        Task::Block { dir, block: k, threads } => block(&Folder::open(dir)?, *k, *threads),
        Task::Merge { dir } => merge(&Folder::open(dir)?),
    }
}

type Scripts = Vec<cluster::Script>;

fn slurm(options: &Options) -> Result<(), Stop> {
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

fn snakemake(options: &Options) -> Result<(), Stop> {
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
    scripts: impl FnOnce(&Ensemble, &Job, &Path) -> Result<Scripts, Fault>,
) -> Result<Folder, Stop> {
    let mut faults = Vec::new();
    let job = job(options, &mut faults);
    let model = load::model(&options.model, &options.set)?;
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
    let folder = cluster::prepare(&results, ensemble, &text)?;
    for (name, text, by_hand) in scripts {
        let path = folder.path.join(name);
        tables::write_bytes(&path, text.as_bytes())?;
        if by_hand {
            make_executable(&path)?;
        }
    }
    let ensemble = &folder.ensemble;
    tell!(
        "{}: {} realizations in {} blocks of up to {}, seed {}; scripts are in {}",
        ensemble.name,
        ensemble.realizations,
        ensemble.blocks,
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

fn unfinished(folder: &Folder, except: &[u32]) {
    let except: BTreeSet<u32> = except.iter().copied().collect();
    let open = folder.unfinished();
    if open.is_empty() && folder.joined() {
        print("joined\n");
        return;
    }
    let open: Vec<u32> = open.into_iter().filter(|k| !except.contains(k)).collect();
    print(&format!("{}\n", cluster::compact(&open)));
}

/// Where each block stands, and a line for all.
fn table(folder: &Folder) -> String {
    let ensemble = &folder.ensemble;
    let mut text = format!("{}, seed {}: {}\n", ensemble.name, ensemble.seed, folder.path.display());
    text.push_str("block  realizations           done  state        wall time\n");
    let states = [
        State::Finished,
        State::Running,
        State::Interrupted,
        State::Failed,
        State::Unreadable,
        State::Missing,
    ];
    let mut counts = [0_u32; 6];
    let (mut done, mut wall) = (0_u64, 0.0);
    for k in 0..ensemble.blocks {
        let (range, standing) = (ensemble.range(k), folder.standing(k));
        let size = range.end - range.start;
        let mut remark = standing.error.clone();
        if standing.state == State::Running
            && let Some(age) = standing.age
        {
            remark = format!("last written {} ago", duration(age as f64));
        }
        let line = format!(
            "{k:>5}  {:<15} {:>11}  {:<11} {:>10}  {remark}",
            format!("{}..{}", range.start, range.end),
            format!("{}/{size}", standing.finished),
            standing.state.word(),
            if standing.state == State::Missing { "-".into() } else { duration(standing.wall_seconds) },
        );
        text.push_str(line.trim_end());
        text.push('\n');
        done += u64::from(standing.finished);
        wall += standing.wall_seconds;
        if let Some(at) = states.iter().position(|state| *state == standing.state) {
            counts[at] += 1;
        }
    }
    let said: Vec<String> = states
        .iter()
        .zip(counts)
        .filter(|(_, count)| *count > 0)
        .map(|(state, count)| format!("{count} {}", state.word()))
        .collect();
    text.push_str(&format!(
        "{} blocks: {}; {done} of {} realizations, {} in all; {}\n",
        ensemble.blocks,
        said.join(", "),
        ensemble.realizations,
        duration(wall),
        if folder.joined() { "joined" } else { "not joined" }
    ));
    text
}

/// Seconds as `12.3 s` or `h:mm:ss`.
fn duration(seconds: f64) -> String {
    if seconds < 100.0 {
        return format!("{seconds:.1} s");
    }
    let whole = seconds.round() as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}
