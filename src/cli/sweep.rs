//! The verb `run` on a model with a sweep: each point as a run of its own, then their table, figures and report.

use super::job::{Job, carry_out, ready, usage};
use super::run::{Options, Place};
use super::{Stop, print};
use crate::ensemble::{self, Claim, Concluded, Earlier, release};
use crate::model::load;
use crate::model::{Model, Sweep};
use crate::plan::Plan;
use crate::record::{RunRecord, SweepRecord};
use crate::simulation::Watch;
use crate::{report, tables};
use std::path::Path;
use std::time::{Duration, Instant};

/// Time between two states of the record; the points' own folders say how far they are.
const RECORD_EVERY: Duration = Duration::from_secs(2);

/// Points up to which each has figures and a report of its own.
const DRAWN: usize = 200;

/// Runs the points that are not finished.
pub(super) fn run(options: &Options, base: &Model, sweep: &Sweep, place: &Place) -> Result<(), Stop> {
    let begun = Instant::now();
    let dir = place.dir.as_path();
    let earlier = ensemble::sweep::look(dir, place.claim)?;
    rayon::ThreadPoolBuilder::new().num_threads(place.threads).build_global().ok();
    let block = &place.block;
    ensemble::sweep::check(&options.model, base, sweep, block.end - block.start)?;

    let mut record = ensemble::sweep::record(base, sweep, block, place.threads);
    let watch = Watch::on_terminal(options.quiet);
    let _held = ensemble::sweep::claim(dir, &record, earlier.as_deref())?;
    if let Some(then) = &earlier {
        record.performance.wall_seconds = then.performance.wall_seconds;
    }
    tables::write_sweep_record(dir, &record)?;
    if !options.quiet {
        let how = if earlier.is_some() { ", taken up where it was left" } else { "" };
        let points = record.points.len();
        let each = block.end - block.start;
        tell!("{}: {points} points of {each} realizations each, into {}{how}", base.name, dir.display());
    }
    let mut told = Instant::now();
    for number in 0..record.points.len() {
        if watch.stopped() {
            break;
        }
        point(options, base, sweep, place, &watch, &mut record, number);
        if record.points[number].status == "interrupted" {
            break;
        }
        if told.elapsed() > RECORD_EVERY {
            tables::write_sweep_record(dir, &record)?;
            told = Instant::now();
        }
    }
    ensemble::sweep::join(dir, &record)?;
    record.performance.wall_seconds += begun.elapsed().as_secs_f64();
    record.performance.peak_rss_bytes = record.performance.peak_rss_bytes.max(usage().1);
    let has = |status: &str| record.points.iter().any(|point| point.status == status);
    let status = match (has("waiting") || has("interrupted"), has("failed")) {
        (true, _) => "interrupted",
        (false, true) => "failed",
        (false, false) => "finished",
    };
    record.status = status.into();
    tables::write_sweep_record(dir, &record)?;
    if status == "finished" {
        release(dir);
    }
    let drawn = report::write(dir);
    if drawn.is_err() {
        tell!("the tables are written; draw figures and report with `gillesph report {}`", dir.display());
    }
    finish(&record, dir, options)?;
    Ok(drawn?)
}

/// Runs a point, or finds that it is finished; what it came to goes into the record.
fn point(
    options: &Options,
    base: &Model,
    sweep: &Sweep,
    place: &Place,
    watch: &Watch,
    record: &mut SweepRecord,
    number: usize,
) {
    let dir = place.dir.join(&record.points[number].folder);
    let words = record.points[number].words(&record.parameters);
    let result = at_point(options, base, sweep, place, watch, record, number, &dir);
    let point = &mut record.points[number];
    let failed = match result {
        Ok((run, error)) => {
            (point.status, point.finished) = (run.status.clone(), run.finished);
            let (sum, own) = (&mut record.performance, &run.performance);
            sum.particle_steps += own.particle_steps;
            sum.pair_evaluations += own.pair_evaluations;
            sum.solid_particle_steps += own.solid_particle_steps;
            sum.bond_evaluations += own.bond_evaluations;
            sum.fluid_seconds += own.fluid_seconds;
            sum.reaction_events += own.reaction_events;
            sum.hops += own.hops;
            sum.chemistry_seconds += own.chemistry_seconds;
            sum.cpu_seconds += own.cpu_seconds;
            error
        }
        Err(Stop::Model(error)) => Some(error.to_string().trim_end().to_string()),
        Err(Stop::Run(error)) => Some(error.to_string()),
        Err(_) => Some("it ended without a reason".to_string()),
    };
    if let Some(reason) = failed {
        tell!("point {number:04} ({words}) failed: {reason}");
        (point.status, point.error) = ("failed".into(), Some(reason));
    }
}

/// The record of the run of a point and what stopped it.
#[allow(clippy::too_many_arguments)] // a point of a sweep is just these
fn at_point(
    options: &Options,
    base: &Model,
    sweep: &Sweep,
    place: &Place,
    watch: &Watch,
    record: &SweepRecord,
    number: usize,
    dir: &Path,
) -> Result<(RunRecord, Option<String>), Stop> {
    let begun = (Instant::now(), usage().0);
    let point = &record.points[number];
    let mut model = load::point(&options.model, &base.text, &sweep.points[number])?;
    model.run.seed = point.seed;
    if let Some(asked) = &mut model.run.until_precision {
        asked.at_most = place.block.end;
    }
    let draws = record.points.len() <= DRAWN;
    // What is there is of this sweep, or the folder of the sweep would have been refused.
    let earlier = match tables::read_record(dir) {
        Ok(run) if run.status == "finished" && run.model.hash == model.text.hash => {
            // It may have been killed as it drew.
            if draws && !dir.join("report.html").exists() {
                release(dir);
                report::write(dir)?;
            }
            return Ok((run, None));
        }
        Ok(_) => ensemble::look(dir, Claim { resume: true, force: false })?,
        Err(_) => Earlier::Nothing,
    };
    if !options.quiet {
        let of = record.points.len();
        tell!("  point {number:04}, {} of {of}: {}", number + 1, point.words(&record.parameters));
    }
    let (block, threads) = (place.block.clone(), place.threads);
    let plan = Plan::new(model, block.end - block.start)?;
    let ready = ready(&plan)?;
    let job = Job { dir, earlier: &earlier, block, threads, tells: false, draws, begun };
    let Concluded { record, error, .. } = carry_out(&plan, &ready, &job, watch)?;
    Ok((record, error.map(|error| error.to_string())))
}

fn finish(record: &SweepRecord, dir: &Path, options: &Options) -> Result<(), Stop> {
    if options.json {
        print(&serde_json::to_string_pretty(record).unwrap_or_default());
        print("\n");
    }
    let (finished, all) = (record.finished().count(), record.points.len());
    let kept = format!("{finished} of {all} points are finished and kept in {}", dir.display());
    match record.status.as_str() {
        "interrupted" => {
            tell!("interrupted: {kept}; continue with --resume");
            Err(Stop::Interrupted)
        }
        "failed" => {
            tell!("{kept}; --resume tries the others again");
            Err(Stop::Status(1))
        }
        _ => {
            if !options.quiet {
                let seconds = record.performance.wall_seconds;
                let page = dir.join("report.html");
                tell!("done in {seconds:.1} s: {all} points; report: {}", page.display());
            }
            Ok(())
        }
    }
}
