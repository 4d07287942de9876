//! One model run into one folder: what `run` does, and a sweep at each of its points.

use super::Stop;
use crate::ensemble::{self, Concluded, Earlier, claim, release};
use crate::plan::Plan;
use crate::record::RunRecord;
use crate::simulation::{NotReady, Ready, Watch};
use crate::{report, tables};
use std::ops::Range;
use std::path::Path;
use std::time::Instant;

/// Where and how a model is run.
pub(super) struct Job<'a> {
    pub dir: &'a Path,
    pub earlier: &'a Earlier,
    pub block: Range<u32>,
    pub threads: usize,
    /// Says what it does.
    pub tells: bool,
    /// Draws figures and report.
    pub draws: bool,
    /// When it began, and the processor seconds used before.
    pub begun: (Instant, f64),
}

/// A plan ready to run.
pub(super) fn ready(plan: &Plan) -> Result<Ready<'_>, Stop> {
    Ready::new(plan).map_err(|error| match error {
        NotReady::Model(error) => Stop::Model(error),
        NotReady::Run(error) => Stop::Run(error),
    })
}

/// Claims the folder, runs, and writes tables, record and report.
pub(super) fn carry_out(plan: &Plan, ready: &Ready, job: &Job, watch: &Watch) -> Result<Concluded, Stop> {
    let dir = job.dir;
    ensemble::check(plan)?;
    let mut record = ensemble::record(plan, &job.block, ready, job.threads);
    let _held = claim(dir, &record, job.earlier)?;
    if let Earlier::Interrupted(then) = job.earlier {
        let (now, then) = (&mut record.performance, &then.performance);
        now.wall_seconds = then.wall_seconds;
        now.cpu_seconds = then.cpu_seconds;
        now.peak_rss_bytes = then.peak_rss_bytes;
    }
    if job.tells {
        announce(plan, &record, job);
    }
    let mut concluded = match ensemble::run(plan, ready, record.clone(), dir, watch) {
        Ok(concluded) => concluded,
        Err(error) => {
            // The folder may be what does not work: what can still be told there is.
            (record.status, record.error) = ("failed".into(), Some(error.to_string()));
            let _ = tables::write_record(dir, &record);
            tell!("what was finished is kept in {}", dir.join("checkpoint").display());
            return Err(Stop::Run(error));
        }
    };
    let record = &mut concluded.record;
    let performance = &mut record.performance;
    performance.wall_seconds += job.begun.0.elapsed().as_secs_f64();
    let used = usage();
    performance.cpu_seconds += used.0 - job.begun.1;
    performance.peak_rss_bytes = performance.peak_rss_bytes.max(used.1);
    // The record last: a folder with a finished record is complete.
    tables::write_record(dir, record)?;
    if record.status == "finished" {
        release(dir);
    }
    if job.draws && concluded.realizations > 0 && concluded.times > 0 {
        let drawn = report::write(dir);
        // Drawing takes memory too.
        record.performance.peak_rss_bytes = record.performance.peak_rss_bytes.max(usage().1);
        tables::write_record(dir, record)?;
        if drawn.is_err() {
            tell!("the tables are written; draw figures and report with `gillesph report {}`", dir.display());
        }
        // A failed run says first why it failed.
        if record.status == "finished" {
            drawn?;
        }
    }
    Ok(concluded)
}

fn announce(plan: &Plan, record: &RunRecord, job: &Job) {
    let block = record.realizations;
    let how = match job.earlier {
        Earlier::Interrupted(_) => ", taken up where it was left",
        _ => "",
    };
    tell!(
        "{}: realizations {}..{} on {} thread{}, until {} s, into {}{how}",
        plan.model.name,
        block[0],
        block[1],
        job.threads,
        if job.threads == 1 { "" } else { "s" },
        plan.model.run.until,
        job.dir.display()
    );
    if let Earlier::Interrupted(then) = job.earlier
        && then.version != record.version
    {
        tell!(
            "  it was begun by version {}, this is {}; what is kept has the same format",
            then.version,
            record.version
        );
    }
    let steps = &record.steps;
    for (what, step) in [("fluid", &steps.fluid), ("solid", &steps.solid), ("chemistry", &steps.chemistry)] {
        if let Some(step) = step {
            tell!("  {what} step {:.3e} s, limited by {}", step.step, step.limited_by);
        }
    }
}

/// Processor seconds and peak resident memory (bytes) of this process, where the system tells; else zeros.
pub(super) fn usage() -> (f64, u64) {
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
