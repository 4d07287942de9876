//! Where a run leaves what it has seen, and the states from which it can be taken up.
//!
//! A realization hands over what it has shown in pieces, so that memory does not grow with the number of output
//! times, and its share of the books when it is done. A [`Keep`] puts them where they last: in memory here, in a
//! journal on disk for a run.

use super::FlowTally;
use crate::chemistry::split::Counters;
use crate::error::RunError;
use crate::record::HybridRecord;
use crate::samples::{ParticleFrame, ProbeRows};
use crate::sampling::Observed;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Rows of a part of a particle table, at least, but for the last part. Fixed: parts are the same in every run.
const ROWS: usize = 1 << 16;

/// Values in a piece of a realization that is under way alone: a megabyte.
pub(super) const PIECE: usize = 1 << 17;

/// What one realization has shown at consecutive output times.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Piece {
    pub realization: u32,
    /// Number of the first output time in it, and how many there are.
    pub first: u32,
    pub outputs: u32,
    /// Molecules, row-major times x columns.
    pub amount: Vec<f64>,
    /// mol/m³, likewise.
    pub concentration: Vec<f64>,
    pub probes: Vec<ProbeRows>,
    /// Probes up to the end of each output; empty where there are none.
    pub marks: Vec<u32>,
}

impl Piece {
    /// What it shows before output number `end`.
    #[must_use]
    pub fn until(&self, end: u32) -> Piece {
        self.part(0, end.saturating_sub(self.first).min(self.outputs))
    }

    /// What it shows from output number `from` on.
    #[must_use]
    pub fn from(&self, from: u32) -> Piece {
        self.part(from.saturating_sub(self.first).min(self.outputs), self.outputs)
    }

    /// Its outputs from the `from`th before the `to`th.
    fn part(&self, from: u32, to: u32) -> Piece {
        let width = self.amount.len() / (self.outputs.max(1) as usize);
        let rows = from as usize * width..to as usize * width;
        let mark = |outputs: u32| match outputs.checked_sub(1) {
            Some(last) => self.marks.get(last as usize).map_or(0, |&mark| mark as usize),
            None => 0,
        };
        let (start, end) = (mark(from), mark(to));
        Piece {
            realization: self.realization,
            first: self.first + from,
            outputs: to - from,
            amount: self.amount[rows.clone()].to_vec(),
            concentration: self.concentration[rows].to_vec(),
            probes: self.probes[start..end].to_vec(),
            marks: (from..to).map(|k| (mark(k + 1) - start) as u32).collect(),
        }
    }
}

/// What a finished realization adds to the books.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Share {
    pub counters: Counters,
    /// Net molecules of each species that reservoirs brought in.
    pub supplied: Vec<f64>,
    /// Sum over species of |end - start - reactions - supplied|.
    pub lost: f64,
    /// Expected events withheld for want of a whole molecule.
    pub withheld: f64,
    pub hybrid: Vec<HybridRecord>,
    /// Time spent on it, s, where it ran alone.
    pub seconds: f64,
}

/// What a flow with realizations on it came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CourseShare {
    pub flow: FlowTally,
    pub fluid_seconds: f64,
    pub chemistry_seconds: f64,
    pub particle_steps: u64,
    pub pair_evaluations: u64,
    pub solid_particle_steps: u64,
    pub bond_evaluations: u64,
}

/// Writes a state.
pub type Writing<'a> = dyn FnMut(&mut dyn Write) -> Result<(), String> + 'a;

/// Keeps what a run has seen. Methods are called from several threads at once.
pub trait Keep: Sync {
    /// Takes a piece of a realization; pieces of one realization come in order, and after a run was taken up from a
    /// state some may come again.
    ///
    /// # Errors
    /// What cannot be kept.
    fn piece(&self, piece: Piece) -> Result<(), RunError>;

    /// Takes a part of the particle frames of a realization: its number, and how many frames were in parts before.
    ///
    /// # Errors
    /// What cannot be kept.
    fn frames(
        &self,
        realization: u32,
        part_and_before: (u32, u32),
        frames: Vec<ParticleFrame>,
    ) -> Result<(), RunError>;

    /// A realization is done; all its pieces were given before.
    ///
    /// # Errors
    /// What cannot be kept.
    fn finished(&self, realization: u32, share: Share) -> Result<(), RunError>;

    /// The flow of this name has come to its end.
    ///
    /// # Errors
    /// What cannot be kept.
    fn course(&self, name: &str, share: CourseShare) -> Result<(), RunError>;

    /// How long a realization or flow goes on before its state is saved, if states are kept at all.
    fn patience(&self) -> Option<Duration> {
        None
    }

    /// Keeps the state of what bears this name, in place of an earlier one; `write` writes it.
    ///
    /// # Errors
    /// What cannot be kept.
    fn save(&self, _name: &str, _write: &mut Writing) -> Result<(), RunError> {
        Ok(())
    }

    /// The state kept under this name, if there is one.
    ///
    /// # Errors
    /// A state that is there but cannot be used.
    fn saved(&self, _name: &str) -> Result<Option<Vec<u8>>, RunError> {
        Ok(None)
    }

    /// The state of this name is needed no more.
    fn forget(&self, _name: &str) {}
}

/// What a realization shows, on its way to where it is kept.
pub(super) struct Shown<'k> {
    pub observed: Observed,
    keep: &'k dyn Keep,
    /// Values from which a piece is handed over.
    limit: usize,
    failed: Option<RunError>,
}

impl<'k> Shown<'k> {
    /// Hands over to `keep`, a piece at the latest when there are `limit` values.
    pub fn new(observed: Observed, keep: &'k dyn Keep, limit: usize) -> Shown<'k> {
        Shown { observed, keep, limit, failed: None }
    }

    /// To be called after each look; keeps what went wrong for [`Shown::check`].
    pub fn looked(&mut self) {
        if self.failed.is_none() {
            self.failed = hand_over(&mut self.observed, self.keep, self.limit).err();
        }
    }

    /// Whether all went well so far.
    pub fn check(&mut self) -> Result<(), RunError> {
        self.failed.take().map_or(Ok(()), Err)
    }

    /// Hands over the rest, and the books.
    pub fn finish(mut self, share: Share) -> Result<(), RunError> {
        self.check()?;
        let realization = self.observed.series.realization;
        hand_over(&mut self.observed, self.keep, 0)?;
        self.keep.finished(realization, share)
    }
}

/// Hands over what a realization has shown if there are at least `limit` values; all there is if that is 0.
pub(super) fn hand_over(seen: &mut Observed, keep: &dyn Keep, limit: usize) -> Result<(), RunError> {
    let rows: usize = seen.frames.iter().map(ParticleFrame::len).sum();
    let realization = seen.series.realization;
    if rows >= ROWS || (limit == 0 && rows > 0) {
        let (frames, part) = (std::mem::take(&mut seen.frames), seen.parts);
        seen.parts = (part.0 + 1, part.1 + frames.len() as u32);
        keep.frames(realization, part, frames)?;
    }
    if seen.outputs > 0 && seen.bulk() >= limit {
        let first = seen.first;
        seen.first += seen.outputs;
        keep.piece(Piece {
            realization,
            first,
            outputs: std::mem::take(&mut seen.outputs),
            amount: std::mem::take(&mut seen.series.amount),
            concentration: std::mem::take(&mut seen.series.concentration),
            probes: std::mem::take(&mut seen.probes),
            marks: std::mem::take(&mut seen.marks),
        })?;
    }
    Ok(())
}

/// What realizations keep in memory: all they have shown, and the books.
#[derive(Default)]
pub(super) struct Memory {
    kept: Mutex<Kept>,
}

/// See [`Memory`].
#[derive(Default)]
pub(super) struct Kept {
    pub observed: BTreeMap<u32, Observed>,
    pub shares: BTreeMap<u32, Share>,
    pub courses: Vec<CourseShare>,
}

impl Memory {
    fn open(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// All that was kept.
    pub fn into_kept(self) -> Kept {
        self.kept.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Keep for Memory {
    fn piece(&self, piece: Piece) -> Result<(), RunError> {
        let mut kept = self.open();
        let seen = kept.observed.entry(piece.realization).or_insert_with(|| Observed::new(piece.realization));
        seen.outputs += piece.outputs;
        seen.series.amount.extend(piece.amount);
        seen.series.concentration.extend(piece.concentration);
        seen.probes.extend(piece.probes);
        Ok(())
    }

    fn frames(&self, realization: u32, _: (u32, u32), frames: Vec<ParticleFrame>) -> Result<(), RunError> {
        let mut kept = self.open();
        kept.observed.entry(realization).or_insert_with(|| Observed::new(realization)).frames.extend(frames);
        Ok(())
    }

    fn finished(&self, realization: u32, share: Share) -> Result<(), RunError> {
        self.open().shares.insert(realization, share);
        Ok(())
    }

    fn course(&self, _name: &str, share: CourseShare) -> Result<(), RunError> {
        self.open().courses.push(share);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of probes stay with their outputs, also where an output has none.
    #[test]
    fn parts_of_a_piece_keep_the_probes_of_their_outputs() {
        let row = |time: f64| ProbeRows { time, ..ProbeRows::default() };
        let piece = Piece {
            first: 3,
            outputs: 4,
            amount: vec![0.0, 0.1, 1.0, 1.1, 2.0, 2.1, 3.0, 3.1],
            concentration: vec![0.0; 8],
            // None at output 3, two at 4, none at 5, one at 6.
            probes: vec![row(4.0), row(4.0), row(6.0)],
            marks: vec![0, 2, 2, 3],
            ..Piece::default()
        };
        let (early, late) = (piece.until(5), piece.from(5));
        assert_eq!((early.first, early.outputs, early.probes.len()), (3, 2, 2));
        assert_eq!((late.first, late.outputs, late.amount.len(), late.probes.len()), (5, 2, 4, 1));
        assert_eq!((late.probes[0].time, late.marks.as_slice()), (6.0, &[0, 1][..]));
        assert_eq!(piece.from(0), piece);
        assert_eq!(piece.from(9).outputs, 0);
        assert!(late.from(6).probes.len() == 1 && late.until(6).probes.is_empty());
    }
}
