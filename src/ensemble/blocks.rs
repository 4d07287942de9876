//! Joining blocks of one ensemble that ran apart.

use super::assemble::{Source, Wanted, assemble};
use super::folder::{clear, clear_kept, lock, release, unusable};
use crate::error::{Fault, ModelError, RunError};
use crate::record::RunRecord;
use crate::samples::ProbeRows;
use crate::simulation::{Piece, Share};
use crate::tables::{self, Columns, SeriesTable};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A finished block: its folder and its record.
pub struct Block {
    pub dir: PathBuf,
    pub record: RunRecord,
}

/// Why blocks were not joined.
#[derive(Debug, thiserror::Error)]
pub enum NotJoined {
    /// They do not belong together.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A file could not be read or written.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Joins the blocks in folders into tables and record below `out`. The blocks must come from the same program, model
/// and seed, and follow each other without overlap or gap.
///
/// # Errors
/// What does not fit, all of it; files that cannot be read or written.
pub fn merge(out: &Path, dirs: &[PathBuf]) -> Result<RunRecord, NotJoined> {
    let mut blocks = Vec::new();
    for dir in dirs {
        blocks.push(Block { dir: dir.clone(), record: tables::read_record(dir)? });
    }
    check(&mut blocks)?;
    if dirs
        .iter()
        .any(|dir| out.canonicalize().is_ok_and(|out| dir.canonicalize().is_ok_and(|dir| dir == out)))
    {
        let reason = format!("{} is one of the blocks to be joined", out.display());
        return Err(ModelError::from(Fault::general(reason, "name another folder for the whole")).into());
    }
    let _held = lock(out)?;
    let mut records = blocks.iter().map(|block| &block.record);
    let Some(mut whole) = records.next().cloned() else {
        return Err(
            ModelError::from(Fault::general("no blocks were given", "name the folders to join")).into()
        );
    };
    records.for_each(|record| whole.absorb(record));
    if tables::read_record(out).is_ok() {
        // What an earlier run left would stand beside the new tables.
        clear_kept(out).and_then(|()| clear(out)).map_err(unusable)?;
    }
    for dir in dirs {
        copy_particles(dir, out)?;
    }
    let probes = blocks.iter().any(|block| block.dir.join("tables/probes.parquet").exists());
    let covariance = blocks.iter().any(|block| block.dir.join("tables/covariance.parquet").exists());
    let mut source = Folders { blocks, loaded: None };
    let columns = match source.blocks.first() {
        Some(first) => {
            // As many rows as one realization has.
            let rows = tables::read_statistics(&first.dir)?.len();
            tables::read_series_head(&first.dir, 1, rows)?.columns
        }
        None => Columns::default(),
    };
    let (times, histograms) = (whole.times.clone(), whole.histograms.clone());
    let wanted = Wanted { times: &times, columns: &columns, covariance, histograms: &histograms, probes };
    assemble(&mut source, out, &wanted, None)?;
    tables::write_record(out, &whole)?;
    release(out);
    Ok(whole)
}

/// Puts the blocks in order and tells what keeps them from being joined.
fn check(blocks: &mut [Block]) -> Result<(), ModelError> {
    let mut faults = Vec::new();
    blocks.sort_by_key(|block| block.record.realizations);
    for Block { dir, record } in blocks.iter() {
        if record.status != "finished" {
            faults.push(Fault::general(
                format!("{}: the run is {}, not finished", dir.display(), record.status),
                "finish it with --resume, or run it again",
            ));
        }
    }
    for pair in blocks.windows(2) {
        let (first, second) = (pair[0].dir.display(), pair[1].dir.display());
        let (a, b) = (&pair[0].record, &pair[1].record);
        for (what, differs) in [
            ("models", a.model.hash != b.model.hash),
            ("seeds", a.seed != b.seed),
            ("program versions", a.version != b.version),
        ] {
            if differs {
                faults.push(Fault::general(
                    format!("{first} and {second} have different {what}"),
                    "blocks of one ensemble come from the same model, seed and program",
                ));
            }
        }
        let [from, to] = [b.realizations[0], a.realizations[1]];
        if from < to {
            faults.push(Fault::general(
                format!("{first} and {second} overlap: realizations {from}..{}", to.min(b.realizations[1])),
                "leave one of them out",
            ));
        } else if from > to {
            faults.push(Fault::general(
                format!("realizations {to}..{from} are missing between {first} and {second}"),
                format!("run them with --realizations {to}..{from}"),
            ));
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(ModelError { faults }) }
}

/// Copies the particle tables of a block; each realization has a folder of its own.
fn copy_particles(from: &Path, to: &Path) -> Result<(), RunError> {
    for (realization, part, path) in tables::list_particles(from) {
        let folder = to.join(format!("tables/particles/realization={realization:04}"));
        let target = folder.join(format!("part-{part:05}.parquet"));
        std::fs::create_dir_all(&folder).and_then(|()| std::fs::copy(&path, &target)).map_err(|error| {
            RunError::File { path: target.display().to_string(), reason: error.to_string() }
        })?;
    }
    Ok(())
}

/// Realizations in the folders of blocks, one block in memory at a time.
struct Folders {
    blocks: Vec<Block>,
    loaded: Option<(usize, SeriesTable, BTreeMap<u32, Vec<ProbeRows>>)>,
}

impl Source for Folders {
    fn realizations(&self) -> Vec<u32> {
        self.blocks.iter().flat_map(|b| b.record.realizations[0]..b.record.realizations[1]).collect()
    }

    fn realization(
        &mut self,
        number: u32,
        see: &mut dyn FnMut(&Piece) -> Result<(), RunError>,
    ) -> Result<Option<Share>, RunError> {
        let Some(at) = self.blocks.iter().position(|b| {
            let [from, to] = b.record.realizations;
            (from..to).contains(&number)
        }) else {
            return Ok(None);
        };
        if self.loaded.as_ref().is_none_or(|loaded| loaded.0 != at) {
            let dir = &self.blocks[at].dir;
            let mut probes: BTreeMap<u32, Vec<ProbeRows>> = BTreeMap::new();
            if dir.join("tables/probes.parquet").exists() {
                for rows in tables::read_probes(dir)? {
                    probes.entry(rows.realization).or_default().push(rows);
                }
            }
            self.loaded = Some((at, tables::read_series(dir)?, probes));
        }
        let Some((_, series, probes)) = &self.loaded else { return Ok(None) };
        let Ok(found) = series.blocks.binary_search_by_key(&number, |block| block.realization) else {
            let path = self.blocks[at].dir.join("tables/series.parquet").display().to_string();
            return Err(RunError::File { path, reason: format!("realization {number} is missing") });
        };
        see(&Piece {
            realization: number,
            first: 0,
            outputs: series.times.len() as u32,
            amount: series.blocks[found].amount.clone(),
            concentration: series.blocks[found].concentration.clone(),
            // A whole realization is not taken apart: no marks are needed.
            probes: probes.get(&number).cloned().unwrap_or_default(),
            marks: Vec::new(),
        })?;
        Ok(None)
    }
}
