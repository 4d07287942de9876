//! The verb `run`.

use super::job::{Job, carry_out, ready};
use super::{Stop, print, sweep};
use crate::ensemble::{Claim, Concluded, Earlier, look, release};
use crate::error::{Fault, RunError};
use crate::model::load;
use crate::model::precision::FIRST_LOOK;
use crate::plan::Plan;
use crate::quantity::readable::significant;
use crate::record::RunRecord;
use crate::report;
use crate::simulation::Watch;
use clap::Args;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Options of `run`.
#[derive(Args)]
pub(crate) struct Options {
    /// Model file
    pub(super) model: PathBuf,
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
    pub(super) quiet: bool,
    /// Print run.json to standard output at the end
    #[arg(long)]
    pub(super) json: bool,
}

/// Runs a model, or the points of its sweep.
pub(crate) fn run(options: &Options) -> Result<(), Stop> {
    let begun = (Instant::now(), 0.0);
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
    let claim = Claim { resume: options.resume, force: options.force };
    if let Some(sweep) = model.sweep.take() {
        return sweep::run(options, &model, &sweep, &Place { dir, claim, block, threads });
    }
    let earlier = look(&dir, claim)?;
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().ok();
    if let Earlier::Finished(then) = &earlier {
        if then.model.hash == model.text.hash && then.seed == model.run.seed {
            tell!("{} is finished: nothing to resume", dir.display());
            return Ok(());
        }
        let reason = format!("{} holds a finished run of another model or seed", dir.display());
        return Err(
            Fault::general(reason, "name another folder with --out, or replace it with --force").into()
        );
    }
    if matches!(earlier, Earlier::Undrawn) {
        release(&dir);
        report::write(&dir)?;
        tell!("the run was finished; report: {}", dir.join("report.html").display());
        return Ok(());
    }

    let plan = Plan::new(model, block.end - block.start)?;
    let ready = ready(&plan)?;
    if !options.quiet {
        for warning in &plan.warnings {
            tell!("  warning: {}", warning.line());
        }
    }
    // From here on files are written, and Ctrl-C leaves a folder that can be resumed.
    let watch = Watch::on_terminal(options.quiet);
    let (dir, earlier, tells) = (dir.as_path(), &earlier, !options.quiet);
    let job = Job { dir, earlier, block, threads, tells, draws: true, begun };
    let Concluded { record, error, realizations, times } = carry_out(&plan, &ready, &job, &watch)?;
    let told: Vec<String> = plan.warnings.iter().map(Fault::line).collect();
    finish(&record, (realizations, times), error, (dir, &told), options)
}

/// Where a model goes, and how much of it.
pub(super) struct Place {
    pub dir: PathBuf,
    pub claim: Claim,
    pub block: Range<u32>,
    pub threads: usize,
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

fn finish(
    record: &RunRecord,
    (realizations, times): (usize, usize),
    error: Option<RunError>,
    (dir, told): (&Path, &[String]),
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
        for warning in record.health.warnings.iter().filter(|warning| !told.contains(warning)) {
            tell!("  warning: {warning}");
        }
        if let Some(known) = record.precision.as_ref().filter(|known| known.reached) {
            tell!(
                "  {}: {} ± {} ({} % confidence) after {} realizations",
                known.quantity,
                significant(known.mean, 6),
                significant(known.half_width, 2),
                significant(100.0 * known.confidence, 4),
                record.finished
            );
        }
        let p = &record.performance;
        tell!(
            "done in {:.1} s: motion {:.1} s, chemistry {:.1} s; {} reactions, {} hops; report: {}",
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
