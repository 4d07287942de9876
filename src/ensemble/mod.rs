//! Many realizations from plan to tables: who runs, what is kept, what the record says.
//!
//! While a run goes on, what its realizations have shown is appended to a journal below `checkpoint/` and states of what
//! takes long are kept beside it; tables are written from the journal at the end, in order of realization. A run that
//! was killed at any moment is taken up from there, and its tables come out the same to the byte.

mod assemble;
mod blocks;
mod books;
mod desk;
mod folder;
mod journal;
mod memory;
mod precision;
mod record;
mod states;
pub mod sweep;

pub use assemble::EXACT_UP_TO;
pub use blocks::NotJoined;
pub use blocks::merge;
pub use folder::{Claim, Earlier, claim, look, release};
pub use memory::{Results, in_memory};
pub use record::{conditions, record};
pub use states::FORMAT;

use crate::error::{Fault, ModelError, RunError};
use crate::model::Precision;
use crate::model::precision::FIRST_LOOK;
use crate::plan::Plan;
use crate::quantity::readable::significant;
use crate::record::{PrecisionRecord, RunRecord};
use crate::sampling;
use crate::simulation::{Finish, Piece, Ready, Share, Tally, Watch};
use crate::tables;
use assemble::{Source, Wanted, assemble};
use books::Books;
use desk::Desk;
use journal::Reader;
use precision::Look;
use std::path::Path;

/// What a run came to; its tables are written.
pub struct Concluded {
    pub record: RunRecord,
    /// What stopped it, if the numbers or the disk did.
    pub error: Option<RunError>,
    /// Realizations and output times in the tables.
    pub realizations: usize,
    pub times: usize,
}

/// Runs the realizations of a record's block that are not finished yet, and writes the tables below `dir`, whose folder
/// was claimed.
///
/// # Errors
/// What cannot be written or read; what is finished stays in the journal.
pub fn run(
    plan: &Plan,
    ready: &Ready,
    mut record: RunRecord,
    dir: &Path,
    watch: &Watch,
) -> Result<Concluded, RunError> {
    let output = &plan.model.output;
    let [from, to] = record.realizations;
    tables::write_record(dir, &record)?;
    let frames = output.vtk.then(|| {
        let asked = output.particles.iter().flat_map(|(times, _)| times);
        let mut times: Vec<f64> = asked.copied().filter(|time| output.times.contains(time)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    });
    let species = plan.reactor.species.clone();
    let title = format!("{} {} {from}..{to} {FORMAT}", record.model.hash, record.seed);
    let desk = Desk::new(dir, plan, &title, species, frames, watch)?;
    let finish = match &plan.model.run.until_precision {
        None => ready.run_into(&desk.unfinished(from..to), watch, &desk),
        Some(asked) => until(ready, asked, &desk, &mut record),
    };
    watch.end();
    let mut finish = finish;
    let [from, to] = record.realizations;
    if let (None, false, Some(number)) =
        (&finish.error, finish.interrupted, desk.unfinished(from..to).first().copied())
    {
        // Never told as finished.
        finish.error = Some(journal::missing(dir, number, 0));
    }
    let (notes, reader) = desk.close()?;
    record.health.warnings = notes;
    conclude(plan, ready, record, dir, reader, finish)
}

/// Realizations of a run that are finished so far, also while it goes on.
#[must_use]
pub fn finished_so_far(dir: &Path) -> usize {
    journal::finished(&dir.join("checkpoint/journal"))
}

/// Whether the amount that a run is to know well is one there is.
///
/// # Errors
/// A species that does not live in the group asked for.
pub fn check(plan: &Plan) -> Result<(), ModelError> {
    if plan.model.run.until_precision.is_none() || desk::is_watchable(plan) {
        return Ok(());
    }
    let reason = "run.until_precision asks for a species in a group where it cannot be";
    let remedy = "choose a group it lives in, or leave the group out for the whole domain";
    Err(Fault::at(&plan.model.places.run, reason, remedy).into())
}

/// Runs more and more realizations until a mean is known as well as was asked.
fn until(ready: &Ready, asked: &Precision, desk: &Desk, record: &mut RunRecord) -> Finish {
    let (mut upto, mut looks) = (FIRST_LOOK.min(asked.at_most), Vec::new());
    loop {
        let finish = ready.run_into(&desk.unfinished(0..upto), desk.watch(), desk);
        let interrupted = finish.interrupted || desk.watch().stopped();
        if finish.error.is_some() || interrupted {
            return Finish { interrupted, ..finish };
        }
        let look = desk.look(upto, asked.confidence);
        looks.push(upto);
        let reached = look.suffices(asked);
        if reached || upto >= asked.at_most {
            record.realizations = [0, upto];
            let quantity = desk.watched_words();
            if !reached {
                desk.note(not_reached(&quantity, &look, asked));
            }
            record.precision = Some(PrecisionRecord {
                quantity,
                mean: look.mean,
                half_width: look.half_width,
                confidence: asked.confidence,
                asked: asked.relative_error,
                reached,
                looks,
            });
            return finish;
        }
        upto = look.next(asked);
    }
}

/// How far a run got that was not allowed to go on.
fn not_reached(quantity: &str, look: &Look, asked: &Precision) -> String {
    let percent = |share: f64| format!("{} %", significant(100.0 * share, 2));
    let got = match look.relative() {
        relative if relative.is_finite() => format!(
            "{} of the mean, {} would take about {} realizations",
            percent(relative),
            percent(asked.relative_error),
            significant(look.needed(asked), 2)
        ),
        _ => "nothing but zeros".into(),
    };
    format!("{quantity} is not known as well as asked after {} realizations: {got}", look.realizations)
}

/// Writes tables and record of what a journal holds.
fn conclude(
    plan: &Plan,
    ready: &Ready,
    mut record: RunRecord,
    dir: &Path,
    reader: Reader,
    finish: Finish,
) -> Result<Concluded, RunError> {
    let mut tally = Tally::new(ready.steps(), plan.reactor.species.len());
    tally.fluid_seconds = ready.settling_seconds();
    reader.index().courses.values().for_each(|course| tally.take_course(course));
    let finished = reader.index().finished.len();
    let mut told = Told::new(reader, plan.model.output.times.len())?;
    let (columns, times) = (sampling::columns(plan), &plan.model.output.times[..told.times]);
    let wanted = Wanted {
        times,
        columns: &columns,
        covariance: plan.model.output.covariance,
        histograms: &record.histograms,
        probes: !record.probes.is_empty(),
    };
    let mut books = Books::new(plan, tally);
    assemble(&mut told, dir, &wanted, Some(&mut books))?;
    let error = finish.error;
    books.conclude(plan, &mut record, finished, error.as_ref(), finish.interrupted);
    let realizations = told.numbers.len();
    Ok(Concluded { record, error, realizations, times: times.len() })
}

/// The realizations of a journal that are told of: those that are finished, or as long as none is all there are, as
/// far as they came together.
struct Told {
    reader: Reader,
    numbers: Vec<u32>,
    times: usize,
}

impl Told {
    fn new(mut reader: Reader, all: usize) -> Result<Told, RunError> {
        let finished: Vec<u32> = reader.index().finished.iter().copied().collect();
        if !finished.is_empty() {
            return Ok(Told { reader, numbers: finished, times: all });
        }
        let numbers = reader.realizations();
        let mut times = if numbers.is_empty() { 0 } else { all };
        for &number in &numbers {
            let mut shown = 0;
            reader.realization(number, &mut |piece| {
                shown = (piece.first + piece.outputs) as usize;
                Ok(())
            })?;
            times = times.min(shown);
        }
        Ok(Told { reader, numbers, times })
    }
}

impl Source for Told {
    fn realizations(&self) -> Vec<u32> {
        self.numbers.clone()
    }

    fn realization(
        &mut self,
        number: u32,
        see: &mut dyn FnMut(&Piece) -> Result<(), RunError>,
    ) -> Result<Option<Share>, RunError> {
        let (times, mut shown) = (self.times as u32, 0);
        let share = self.reader.realization(number, &mut |piece| {
            if piece.first >= times {
                return Ok(());
            }
            shown = (piece.first + piece.outputs).min(times);
            if piece.first + piece.outputs <= times { see(piece) } else { see(&piece.until(times)) }
        })?;
        if shown < times {
            return Err(journal::missing(self.reader.path(), number, shown));
        }
        Ok(share)
    }
}
