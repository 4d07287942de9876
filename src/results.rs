//! The folder of a run: its tables, its record, its report.

use crate::error::{Fault, ModelError, RunError};
use crate::record::RunRecord;
use crate::sampling::Observed;
use crate::tables::{self, Columns, ParticleFrame, ProbeRows, SeriesBlock};
use std::path::Path;

/// All that a run leaves behind but its particle tables and its figures.
#[derive(Clone, Debug)]
pub struct Results {
    pub record: RunRecord,
    /// Output times seen, s.
    pub times: Vec<f64>,
    pub columns: Columns,
    /// In order of realization.
    pub blocks: Vec<SeriesBlock>,
    pub probes: Vec<ProbeRows>,
    pub covariance: bool,
}

impl Results {
    /// Writes tables and record; the record last, so that a folder with a finished record is complete.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, dir: &Path) -> Result<(), RunError> {
        let (times, columns, blocks) = (&self.times, &self.columns, &self.blocks);
        let rest = || -> Result<(), RunError> {
            if self.covariance {
                tables::write_covariance(dir, times, columns, blocks)?;
            }
            if !self.record.histograms.is_empty() {
                tables::write_histograms(dir, times, columns, blocks, &self.record.histograms)?;
            }
            if !self.probes.is_empty() {
                tables::write_probes(dir, &self.probes)?;
            }
            Ok(())
        };
        // Each table is a file of its own; the long one takes as long as the others together.
        let (series, (statistics, rest)) = rayon::join(
            || tables::write_series(dir, times, columns, blocks),
            || (tables::write_statistics(dir, times, columns, blocks), rest()),
        );
        series.and(statistics).and(rest)?;
        tables::write_record(dir, &self.record)
    }

    /// Reads a folder back.
    ///
    /// # Errors
    /// A file that is missing or cannot be read.
    pub fn read(dir: &Path) -> Result<Results, RunError> {
        let record = tables::read_record(dir)?;
        let series = tables::read_series(dir)?;
        let probes =
            if dir.join("tables/probes.parquet").exists() { tables::read_probes(dir)? } else { Vec::new() };
        Ok(Results {
            record,
            times: series.times,
            columns: series.columns,
            blocks: series.blocks,
            probes,
            covariance: dir.join("tables/covariance.parquet").exists(),
        })
    }

    /// Adds realizations that were just observed and writes their particle tables.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn add(&mut self, dir: &Path, observed: Vec<Observed>, vtk: bool) -> Result<(), RunError> {
        let species: Vec<String> = self.record.species.iter().map(|s| s.name.clone()).collect();
        for one in observed {
            let realization = one.series.realization;
            if !one.frames.is_empty() {
                tables::write_particles(dir, realization, 0, &species, &one.frames)?;
                if vtk {
                    write_vtk(dir, realization, &one.frames, &species)?;
                }
            }
            self.blocks.push(one.series);
            self.probes.extend(one.probes);
        }
        self.blocks.sort_by_key(|block| block.realization);
        self.probes.sort_by_key(|rows| rows.realization);
        Ok(())
    }
}

/// ParaView files of a realization below `vtk/`: one `.vtu` per output time and a `.pvd` that lists them.
fn write_vtk(
    dir: &Path,
    realization: u32,
    frames: &[ParticleFrame],
    species: &[String],
) -> Result<(), RunError> {
    let folder = dir.join("vtk");
    let mut listed = Vec::new();
    for (k, frame) in frames.iter().enumerate() {
        let name = format!("realization-{realization:04}-{k:05}.vtu");
        crate::vtk::write_vtu(&folder.join(&name), frame, species)?;
        listed.push((frame.time, name));
    }
    crate::vtk::write_pvd(&folder.join(format!("realization-{realization:04}.pvd")), &listed)
}

/// Joins blocks of one ensemble. The blocks must come from the same program, model and seed, and follow each
/// other without overlap or gap.
///
/// # Errors
/// What does not fit, all of it.
pub fn join(mut parts: Vec<(String, Results)>) -> Result<Results, ModelError> {
    let mut faults = Vec::new();
    parts.sort_by_key(|(_, part)| part.record.realizations);
    for (name, part) in &parts {
        if part.record.status != "finished" {
            faults.push(Fault::general(
                format!("{name}: the run is {}, not finished", part.record.status),
                "finish it with --resume, or run it again",
            ));
        }
    }
    for pair in parts.windows(2) {
        let ((first, a), (second, b)) = (&pair[0], &pair[1]);
        let (a, b) = (&a.record, &b.record);
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
    if !faults.is_empty() {
        return Err(ModelError { faults });
    }
    let mut parts = parts.into_iter().map(|(_, part)| part);
    let Some(mut whole) = parts.next() else {
        return Err(Fault::general("no blocks were given", "name the folders to join").into());
    };
    for part in parts {
        whole.record.absorb(&part.record);
        whole.blocks.extend(part.blocks);
        whole.probes.extend(part.probes);
    }
    Ok(whole)
}
