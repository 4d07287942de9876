//! A sweep from its points to its table: points are checked together before any of them runs, each runs as an ensemble of
//! its own in a folder of its own, and their statistics are joined.

use super::folder::{
    Claim, Content, Held, Identity, clear, clear_kept, clear_points, content, lock, other_kind, refuse,
    remove_drafts, same, undrawn, unusable,
};
use super::states::FORMAT;
use crate::error::{Fault, ModelError, RunError};
use crate::model::Model;
use crate::model::load;
use crate::model::sweep::{Setting, Sweep};
use crate::plan::Plan;
use crate::random::mix;
use crate::record::{Performance, PointRecord, SweepRecord};
use crate::tables::{self, SweepWriter};
use rayon::prelude::*;
use std::ops::Range;
use std::path::Path;

/// Different faults of points that are told.
const FAULTS: usize = 12;

/// Reads and plans the model of every point of a sweep.
///
/// # Errors
/// What is wrong at any point, each fault once, with the first point that has it.
pub fn check(path: &Path, base: &Model, sweep: &Sweep, realizations: u32) -> Result<(), ModelError> {
    let found: Vec<Option<ModelError>> = sweep
        .points
        .par_iter()
        .map(|point| load::point(path, &base.text, point).and_then(|m| Plan::new(m, realizations)).err())
        .collect();
    let mut faults: Vec<Fault> = Vec::new();
    let mut known: Vec<Fault> = Vec::new();
    let mut more = 0;
    for ((number, point), error) in sweep.points.iter().enumerate().zip(found) {
        for mut fault in error.map(|error| error.faults).unwrap_or_default() {
            if known.contains(&fault) {
                continue;
            }
            if faults.len() == FAULTS {
                more += 1;
                continue;
            }
            known.push(fault.clone());
            // What stands in the sweep itself needs no words on where it applies.
            if !point.iter().any(|setting| setting.owns(&fault)) {
                let settings: Vec<String> = point.iter().map(Setting::assignment).collect();
                fault.reason = format!("point {number} ({}): {}", settings.join(", "), fault.reason);
            }
            faults.push(fault);
        }
    }
    if more > 0 {
        faults.push(Fault::general(format!("{more} more faults of other points"), "mend these first"));
    }
    if faults.is_empty() { Ok(()) } else { Err(ModelError::sorted(faults)) }
}

/// Seed of a point.
fn seed(sweep: &Sweep, seed: u64, point: u32) -> u64 {
    // 53 bits: every reader of JSON gives them back.
    if sweep.common_random_numbers { seed } else { mix(mix(seed) ^ u64::from(point)) >> 11 }
}

/// The record of a sweep before it runs.
#[must_use]
pub fn record(base: &Model, sweep: &Sweep, block: &Range<u32>, threads: usize) -> SweepRecord {
    let point = |(number, settings): (usize, &Vec<Setting>)| PointRecord {
        point: number as u32,
        values: settings.iter().map(|setting| setting.si).collect(),
        set: settings.iter().map(Setting::assignment).collect(),
        seed: seed(sweep, base.run.seed, number as u32),
        folder: format!("points/{number:04}"),
        status: "waiting".into(),
        error: None,
        finished: 0,
    };
    SweepRecord {
        program: "gillesph".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        format: FORMAT,
        status: "running".into(),
        name: base.name.clone(),
        description: base.description.clone(),
        model: base.text.clone(),
        seed: base.run.seed,
        realizations: [block.start, block.end],
        design: sweep.design.name().into(),
        common_random_numbers: sweep.common_random_numbers,
        parameters: sweep.parameters.clone(),
        points: sweep.points.iter().enumerate().map(point).collect(),
        performance: Performance { threads, ..Performance::default() },
    }
}

/// Looks at the folder to write; the record of the sweep that is to be resumed.
///
/// # Errors
/// Why it cannot be used.
pub fn look(dir: &Path, claim: Claim) -> Result<Option<Box<SweepRecord>>, ModelError> {
    match content(dir, claim)? {
        Content::Sweep(record) if undrawn(dir, claim, &record.status) => Ok(Some(record)),
        Content::Sweep(record) if !claim.force => {
            let done = format!("{} of {} points finished", record.finished().count(), record.points.len());
            refuse(dir, claim, "sweep", &record.status, &done)?;
            Ok(Some(record))
        }
        Content::Run(_) if !claim.force => Err(other_kind(dir, "a run, and this is a sweep")),
        _ => Ok(None),
    }
}

/// Claims a folder for a sweep: clears what is replaced, checks that what is resumed is the same sweep.
///
/// # Errors
/// As [`super::claim`].
pub fn claim(dir: &Path, now: &SweepRecord, earlier: Option<&SweepRecord>) -> Result<Held, ModelError> {
    let held = lock(dir)?;
    match earlier {
        None => {
            clear_points(dir).map_err(unusable)?;
            clear_kept(dir).map_err(unusable)?;
            tables::write_sweep_record(dir, now).and_then(|()| clear(dir)).map_err(unusable)?;
        }
        Some(then) => {
            same(dir, &identity(now), &identity(then))?;
            remove_drafts(dir);
        }
    }
    Ok(held)
}

fn identity(record: &SweepRecord) -> Identity<'_> {
    let SweepRecord { model, seed, realizations, format, version, .. } = record;
    Identity { model, seed: *seed, realizations: *realizations, format: *format, version }
}

/// Joins the statistics of the points that are finished into `tables/sweep.parquet`.
///
/// # Errors
/// What cannot be read or written.
pub fn join(dir: &Path, record: &SweepRecord) -> Result<(), RunError> {
    let mut writer = SweepWriter::new(dir, &record.parameters)?;
    for point in record.finished() {
        let rows = tables::read_statistics(&dir.join(&point.folder))?;
        writer.push(point.point, &point.values, &rows)?;
    }
    writer.finish()
}
