//! The verb `run`.

use super::{Stop, print};
use crate::ensemble::{self, Claim, Concluded, Earlier, claim, look, release};
use crate::error::{Fault, RunError};
use crate::model::load;
use crate::model::precision::FIRST_LOOK;
use crate::plan::Plan;
use crate::record::RunRecord;
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
    let block = match &mut model.run.until_precision {
        None => block(options.realizations.as_deref(), model.run.realizations)?,
        Some(asked) => {
            let whole = block(options.realizations.as_deref(), asked.at_most)?;
            if whole.start > 0 || whole.end < FIRST_LOOK {
                return Err(Fault::general(
                    "--realizations with run.until_precision: the run chooses their number".to_string(),
                    format!("leave it out, or give the most there may be, at least {FIRST_LOOK}"),
                )
                .into());
            }
            asked.at_most = whole.end;
            whole
        }
    };
    let threads = threads(options.threads.or(model.run.threads))?;
    let dir = options.out.clone().unwrap_or_else(|| Path::new("reports").join(&model.name));
    let earlier = look(&dir, Claim { resume: options.resume, force: options.force })?;
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().ok();
    if matches!(earlier, Earlier::Undrawn) {
        release(&dir);
        report::write(&dir)?;
        tell!("the run was finished; report: {}", dir.join("report.html").display());
        return Ok(());
    }

    let plan = Plan::new(model, block.end - block.start)?;
    let ready = Ready::new(&plan).map_err(|error| match error {
        NotReady::Model(error) => Stop::Model(error),
        NotReady::Run(error) => Stop::Run(error),
    })?;
    let mut record = ensemble::record(&plan, &block, &ready, threads);
    // From here on files are written, and Ctrl-C leaves a folder that can be resumed.
    let watch = Watch::on_terminal(options.quiet);
    let _held = claim(&dir, &record, &earlier)?;
    if let Earlier::Interrupted(then) = &earlier {
        let (now, then) = (&mut record.performance, &then.performance);
        now.wall_seconds = then.wall_seconds;
        now.cpu_seconds = then.cpu_seconds;
        now.peak_rss_bytes = then.peak_rss_bytes;
    }
    if !options.quiet {
        announce(&plan, &record, &earlier, &dir, threads);
    }
    let concluded = match ensemble::run(&plan, &ready, record.clone(), &dir, &watch) {
        Ok(concluded) => concluded,
        Err(error) => {
            // The folder may be what does not work: what can still be told there is.
            (record.status, record.error) = ("failed".into(), Some(error.to_string()));
            let _ = tables::write_record(&dir, &record);
            tell!("what was finished is kept in {}", dir.join("checkpoint").display());
            return Err(Stop::Run(error));
        }
    };
    let Concluded { mut record, error, realizations, times } = concluded;
    let performance = &mut record.performance;
    performance.wall_seconds += begun.elapsed().as_secs_f64();
    let used = usage();
    performance.cpu_seconds += used.0;
    performance.peak_rss_bytes = performance.peak_rss_bytes.max(used.1);
    // The record last: a folder with a finished record is complete.
    tables::write_record(&dir, &record)?;
    if record.status == "finished" {
        release(&dir);
    }
    if realizations > 0 && times > 0 {
        let drawn = report::write(&dir);
        // Drawing takes memory too.
        record.performance.peak_rss_bytes = record.performance.peak_rss_bytes.max(usage().1);
        tables::write_record(&dir, &record)?;
        if drawn.is_err() {
            tell!("the tables are written; draw figures and report with `gillesph report {}`", dir.display());
        }
        // A failed run says first why it failed.
        if record.status == "finished" {
            drawn?;
        }
    }
    finish(&record, (realizations, times), error, &dir, options)
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

fn announce(plan: &Plan, record: &RunRecord, earlier: &Earlier, dir: &Path, threads: usize) {
    let block = record.realizations;
    let how = match earlier {
        Earlier::Nothing | Earlier::Undrawn => "",
        Earlier::Interrupted(_) => ", taken up where it was left",
    };
    tell!(
        "{}: realizations {}..{} on {threads} thread{}, until {} s, into {}{how}",
        plan.model.name,
        block[0],
        block[1],
        if threads == 1 { "" } else { "s" },
        plan.model.run.until,
        dir.display()
    );
    if let Earlier::Interrupted(then) = earlier
        && then.version != record.version
    {
        tell!(
            "  it was begun by version {}, this is {}; what is kept has the same format",
            then.version,
            record.version
        );
    }
    let steps = &record.steps;
    for (what, step) in [("fluid", &steps.fluid), ("chemistry", &steps.chemistry)] {
        if let Some(step) = step {
            tell!("  {what} step {:.3e} s, limited by {}", step.step, step.limited_by);
        }
    }
}

fn finish(
    record: &RunRecord,
    (realizations, times): (usize, usize),
    error: Option<RunError>,
    dir: &Path,
    options: &Options,
) -> Result<(), Stop> {
    if options.json {
        print(&serde_json::to_string_pretty(record).unwrap_or_default());
        print("\n");
    }
    let shown = dir.display();
    let kept = if realizations == 0 {
        format!("no realization has shown anything yet; run.json in {shown} says how far it came")
    } else {
        format!(
            "{} of {} realizations are complete, {times} of {} output times are kept in {shown}",
            record.finished,
            record.realizations[1] - record.realizations[0],
            record.times.len(),
        )
    };
    if let Some(error) = error {
        tell!("{kept}");
        return Err(Stop::Run(error));
    }
    if record.status == "interrupted" {
        tell!("interrupted: {kept}; continue with --resume");
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
