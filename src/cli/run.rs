//! The verb `run`.

use super::{Stop, print};
use crate::ensemble;
use crate::error::{Fault, RunError};
use crate::model::load;
use crate::plan::Plan;
use crate::results::Results;
use crate::simulation::{NotReady, Ready, Watch};
use crate::{report, tables};
use clap::Args;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Options of `run`.
#[derive(Args)]
pub(crate) struct Options {
    /// Model file
    model: PathBuf,
    /// Folder to write (default: reports/<model name>)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of realizations N, or a block A..B of the same ensemble (B not included)
    #[arg(long, value_name = "N|A..B", allow_hyphen_values = true)]
    realizations: Option<String>,
    /// Seed of the random streams
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Number of threads (default: all cores)
    #[arg(long, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Change a value of the model, e.g. --set run.until="1 s" (repeatable)
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Finish an interrupted run
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace a folder that already holds a run
    #[arg(long)]
    force: bool,
    /// No progress and no notes
    #[arg(long)]
    quiet: bool,
    /// Print run.json to standard output at the end
    #[arg(long)]
    json: bool,
}

/// Runs a model.
pub(crate) fn run(options: &Options) -> Result<(), Stop> {
    let begun = Instant::now();
    let mut model = load::model(&options.model, &options.set)?;
    if let Some(seed) = options.seed {
        model.run.seed = seed;
    }
    let block = block(options.realizations.as_deref(), model.run.realizations)?;
    let threads = threads(options.threads.or(model.run.threads))?;
    let dir = options.out.clone().unwrap_or_else(|| Path::new("reports").join(&model.name));
    let earlier = folder(&dir, options)?;
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().ok();

    let plan = Plan::new(model, block.end - block.start)?;
    let ready = Ready::new(&plan).map_err(|error| match error {
        NotReady::Model(error) => Stop::Model(error),
        NotReady::Run(error) => Stop::Run(error),
    })?;
    let record = ensemble::record(&plan, &block, &ready, threads);
    let mut results = ensemble::empty(&plan, record);
    // From here on files are written, and Ctrl-C leaves a folder that can be resumed.
    let watch = Watch::on_terminal(options.quiet);
    if let Some(earlier) = earlier {
        take_up(&mut results, earlier, &dir)?;
    } else {
        // Nothing was written yet: a folder that cannot be used is a fault of the input.
        clear(&dir).map_err(|error| Fault::general(error.to_string(), "name another folder with --out"))?;
    }
    let wanted: Vec<u32> = block
        .clone()
        .filter(|r| results.blocks.binary_search_by_key(r, |b| b.realization).is_err())
        .collect();
    if !options.quiet {
        announce(&plan, &results, &wanted, &dir, threads);
    }
    tables::write_record(&dir, &results.record)?;

    let mut outcome = ready.run(&wanted, &watch);
    watch.end();
    ensemble::keep(&mut results, &dir, &mut outcome, plan.model.output.vtk)?;
    ensemble::conclude(&plan, &mut results, &outcome.tally, outcome.error.as_ref(), outcome.interrupted);
    let performance = &mut results.record.performance;
    performance.wall_seconds += begun.elapsed().as_secs_f64();
    let used = usage();
    performance.cpu_seconds += used.0;
    performance.peak_rss_bytes = performance.peak_rss_bytes.max(used.1);
    results.write(&dir)?;
    if !results.blocks.is_empty() && !results.times.is_empty() {
        let drawn = report::write(&dir);
        // Drawing takes memory too.
        let performance = &mut results.record.performance;
        performance.peak_rss_bytes = performance.peak_rss_bytes.max(usage().1);
        tables::write_record(&dir, &results.record)?;
        if drawn.is_err() {
            tell!("the tables are written; draw figures and report with `gillesph report {}`", dir.display());
        }
        // A failed run says first why it failed.
        if results.record.status == "finished" {
            drawn?;
        }
    }
    finish(&results, outcome.error, &dir, options)
}

/// Realizations asked for: `N`, or `A..B`.
fn block(text: Option<&str>, usual: u32) -> Result<Range<u32>, Fault> {
    let Some(text) = text else { return Ok(0..usual) };
    let wrong = |reason: String| {
        Fault::general(
            reason,
            "give a number, e.g. --realizations 100, or a block, e.g. --realizations 100..200",
        )
    };
    let number = |part: &str| -> Result<u32, Fault> {
        part.trim().parse().map_err(|_| {
            let most = u32::MAX;
            wrong(format!("--realizations {text}: expected a whole number from 0 to {most}, found `{part}`"))
        })
    };
    let block = match text.split_once("..") {
        Some((from, to)) => number(from)?..number(to)?,
        None => 0..number(text)?,
    };
    if block.start > block.end {
        return Err(Fault::general(
            format!("--realizations {text}: the block is reversed"),
            format!("write {}..{}", block.end, block.start),
        ));
    }
    if block.is_empty() {
        return Err(wrong(format!("--realizations {text}: at least one realization is needed")));
    }
    Ok(block)
}

fn threads(asked: Option<usize>) -> Result<usize, Fault> {
    match asked {
        Some(n) if n == 0 || n > 4096 => Err(Fault::general(
            format!("--threads {n}: expected 1 to 4096 threads"),
            "leave the option out for all cores",
        )),
        Some(n) => Ok(n),
        None => Ok(std::thread::available_parallelism().map_or(1, std::num::NonZero::get)),
    }
}

/// Looks at the folder to write: refuses one that is in use, reads what an interrupted run left.
fn folder(dir: &Path, options: &Options) -> Result<Option<Results>, Stop> {
    let shown = dir.display();
    if dir.exists() && !dir.is_dir() {
        return Err(Fault::general(format!("{shown} is not a folder"), "name another one with --out").into());
    }
    let empty = !dir.exists() || dir.read_dir().is_ok_and(|mut entries| entries.next().is_none());
    if empty {
        if options.resume {
            return Err(
                Fault::general(format!("{shown} holds no run to resume"), "leave out --resume").into()
            );
        }
        return Ok(None);
    }
    let record = match tables::read_record(dir) {
        Ok(record) => record,
        Err(error) => {
            let reason = if dir.join("run.json").exists() {
                format!("{shown} holds a run that cannot be read: {error}")
            } else {
                format!("{shown} is not empty and holds no run of this program")
            };
            return Err(Fault::general(reason, "name another folder with --out").into());
        }
    };
    if options.force {
        return Ok(None);
    }
    if record.status == "finished" {
        let reason = format!("{shown} already holds a finished run");
        return Err(
            Fault::general(reason, "name another folder with --out, or replace it with --force").into()
        );
    }
    if !options.resume {
        let state = match record.status.as_str() {
            "running" => "is still going on, or was cut off",
            "failed" => "failed",
            _ => "was interrupted",
        };
        let reason = format!("{shown} holds a run that {state} ({} realizations finished)", record.finished);
        return Err(Fault::general(reason, "finish it with --resume, or replace it with --force").into());
    }
    if !dir.join("tables/series.parquet").exists() {
        // Stopped before anything was finished.
        return Ok(Some(Results {
            record,
            times: Vec::new(),
            columns: tables::Columns::default(),
            blocks: Vec::new(),
            probes: Vec::new(),
            covariance: false,
        }));
    }
    Ok(Some(Results::read(dir)?))
}

/// Takes the finished realizations of an interrupted run into the results.
fn take_up(results: &mut Results, earlier: Results, dir: &Path) -> Result<(), Stop> {
    let (now, then) = (&results.record, &earlier.record);
    let mut faults = Vec::new();
    for (what, differs) in [
        ("model (its text, or a value given with --set)", now.model.hash != then.model.hash),
        ("seed", now.seed != then.seed),
        ("block of realizations", now.realizations != then.realizations),
        ("program version", now.version != then.version),
    ] {
        if differs {
            faults.push(Fault::general(
                format!("{}: the {what} has changed since the run was interrupted", dir.display()),
                "resume with what the run was started with, or start anew with --force",
            ));
        }
    }
    if !faults.is_empty() {
        return Err(crate::error::ModelError { faults }.into());
    }
    if earlier.times.len() == results.times.len() {
        results.blocks = earlier.blocks;
        results.probes = earlier.probes;
        results.record.health = earlier.record.health;
        results.record.hybrid = earlier.record.hybrid;
        results.record.performance = earlier.record.performance;
    } else {
        clear(dir)?;
    }
    Ok(())
}

/// Removes what an earlier run left in a folder, and nothing else.
fn clear(dir: &Path) -> Result<(), RunError> {
    let file_error = |path: &Path, error: std::io::Error| RunError::File {
        path: path.display().to_string(),
        reason: error.to_string(),
    };
    for name in ["run.json", "report.html", "tables", "figures", "vtk", "checkpoint"] {
        let path = dir.join(name);
        let removed =
            if path.is_dir() { std::fs::remove_dir_all(&path) } else { std::fs::remove_file(&path) };
        if let Err(error) = removed
            && error.kind() != std::io::ErrorKind::NotFound
        {
            return Err(file_error(&path, error));
        }
    }
    std::fs::create_dir_all(dir.join("tables")).map_err(|error| file_error(dir, error))
}

fn announce(plan: &Plan, results: &Results, wanted: &[u32], dir: &Path, threads: usize) {
    let block = results.record.realizations;
    tell!(
        "{}: realizations {}..{} ({} to run) on {threads} thread{}, until {} s, into {}",
        plan.model.name,
        block[0],
        block[1],
        wanted.len(),
        if threads == 1 { "" } else { "s" },
        plan.model.run.until,
        dir.display()
    );
    let steps = &results.record.steps;
    for (what, step) in [("fluid", &steps.fluid), ("chemistry", &steps.chemistry)] {
        if let Some(step) = step {
            tell!("  {what} step {:.3e} s, limited by {}", step.step, step.limited_by);
        }
    }
}

/// What an unfinished run leaves, in words.
fn kept(results: &Results, dir: &Path) -> String {
    let record = &results.record;
    format!(
        "{} of {} realizations are complete, {} of {} output times are kept in {}",
        record.finished,
        record.realizations[1] - record.realizations[0],
        results.times.len(),
        record.times.len(),
        dir.display()
    )
}

fn finish(results: &Results, error: Option<RunError>, dir: &Path, options: &Options) -> Result<(), Stop> {
    let record = &results.record;
    if options.json {
        print(&serde_json::to_string_pretty(record).unwrap_or_default());
        print("\n");
    }
    let kept = if results.blocks.is_empty() {
        format!("no realization was finished; run.json in {} says how far it came", dir.display())
    } else {
        kept(results, dir)
    };
    if let Some(error) = error {
        tell!("{kept}");
        return Err(Stop::Run(error));
    }
    if record.status == "interrupted" {
        let how = if record.finished == 0 { "--resume starts again" } else { "continue with --resume" };
        tell!("interrupted: {kept}; {how}");
        return Err(Stop::Interrupted);
    }
    if !options.quiet {
        for warning in &record.health.warnings {
            tell!("  warning: {warning}");
        }
        let p = &record.performance;
        tell!(
            "done in {:.1} s: fluid {:.1} s, chemistry {:.1} s; {} reactions, {} hops; report: {}",
            p.wall_seconds,
            p.fluid_seconds,
            p.chemistry_seconds,
            p.reaction_events,
            p.hops,
            dir.join("report.html").display()
        );
    }
    Ok(())
}

/// Processor seconds and peak resident memory (bytes) of this process, where the system tells; else zeros.
fn usage() -> (f64, u64) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .and_then(|rest| rest.split_whitespace().next()?.parse::<u64>().ok())
        .map_or(0, |kib| kib * 1024);
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Fields 14 and 15 are user and system time in ticks of 1/100 s; the second field may hold spaces.
    let ticks = stat.rsplit_once(')').map_or(0, |(_, rest)| {
        rest.split_whitespace().skip(11).take(2).filter_map(|field| field.parse::<u64>().ok()).sum()
    });
    (ticks as f64 / 100.0, peak)
}
