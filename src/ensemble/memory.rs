//! A run whose results stay in memory, for cases that are judged on the spot.

use super::books::Books;
use super::record::record;
use crate::error::RunError;
use crate::plan::Plan;
use crate::record::RunRecord;
use crate::samples::{Columns, ProbeRows, SeriesBlock};
use crate::sampling;
use crate::simulation::{Piece, Ready, Watch};

/// What a run has shown.
#[derive(Clone, Debug)]
pub struct Results {
    pub record: RunRecord,
    /// Output times, s.
    pub times: Vec<f64>,
    pub columns: Columns,
    /// In order of realization.
    pub blocks: Vec<SeriesBlock>,
    pub probes: Vec<ProbeRows>,
}

/// Runs all realizations of a plan without writing anything.
///
/// # Errors
/// What stopped it.
pub fn in_memory(plan: &Plan, ready: Ready) -> Result<Results, RunError> {
    let block = 0..plan.model.run.realizations;
    let mut record = record(plan, &block, &ready, 0);
    let numbers: Vec<u32> = block.collect();
    let outcome = ready.run(&numbers, &Watch::silent());
    if let Some(error) = outcome.error {
        return Err(error);
    }
    let mut books = Books::new(plan, outcome.tally);
    let (mut blocks, mut probes) = (Vec::new(), Vec::new());
    for one in outcome.observed {
        let piece = Piece {
            realization: one.series.realization,
            outputs: one.outputs,
            amount: one.series.amount,
            concentration: one.series.concentration,
            ..Piece::default()
        };
        books.see(&piece);
        let Piece { realization, amount, concentration, .. } = piece;
        blocks.push(SeriesBlock { realization, amount, concentration });
        probes.extend(one.probes);
    }
    books.conclude(plan, &mut record, blocks.len(), None, false);
    let (times, columns) = (plan.model.output.times.clone(), sampling::columns(plan));
    Ok(Results { record, times, columns, blocks, probes })
}
