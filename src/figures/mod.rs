//! Figures of a run, drawn from its tables and its record alone.
//!
//! A figure is a [`Drawing`]: marks in millimetres of print. It is saved as SVG and PNG; a raster of
//! particles as PNG only.

mod bitmap;
pub mod colours;
pub mod contour;
mod distributions;
pub mod drawing;
mod fields;
pub mod maps;
mod overview;
mod painting;
pub mod panel;
pub mod plot;
mod polar;
mod probes;
mod profiles;
mod sections;
mod setup;
pub mod solids;
mod svg;
pub mod sweep;
mod ticks;
mod time;

pub use bitmap::write_png;
pub use drawing::Drawing;
pub use svg::{escape, svg};

use crate::error::RunError;
use crate::quantity::readable::Scale;
use crate::record::RunRecord;
use crate::statistics::Summary;
use crate::tables::{self, Bin, ParticleFrame, ProbeRows, SeriesTable};
use std::path::Path;

/// Width of a figure over the full text width, mm.
pub const WIDTH: f64 = 170.0;

/// A figure with its file name (no ending), title and caption.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub name: String,
    pub title: String,
    pub caption: String,
    pub drawing: Drawing,
    /// Thousands of marks: PNG only.
    pub raster: bool,
}

/// Everything figures are drawn from; what a run did not record is empty.
#[derive(Clone, Debug)]
pub struct Samples {
    pub record: RunRecord,
    /// Of the first realizations, as many as fit a fixed memory.
    pub series: SeriesTable,
    /// Of the amounts at the last time, column by column, over all realizations.
    pub ends: Vec<Summary>,
    pub probes: Vec<ProbeRows>,
    pub histograms: Vec<Bin>,
    /// Covariances were asked for.
    pub covariance: bool,
    /// Species of the particle frames.
    pub species: Vec<String>,
    /// Frames of the first realization, thinned to a few dozen; the first and last are kept.
    pub frames: Vec<ParticleFrame>,
}

impl Samples {
    /// Reads the record and the tables below `dir`.
    ///
    /// # Errors
    /// [`RunError::File`] if the record is missing or a table that exists cannot be read.
    pub fn read(dir: &Path) -> Result<Samples, RunError> {
        let record = tables::read_record(dir)?;
        let has = |name: &str| dir.join("tables").join(name).exists();
        let mut statistics =
            if has("statistics.parquet") { tables::read_statistics(dir)? } else { Vec::new() };
        let rows = statistics.len();
        let series = if has("series.parquet") {
            let realizations = (MOST_ROWS / rows.max(1)).max(FEWEST);
            tables::read_series_head(dir, realizations, rows.max(1))?
        } else {
            SeriesTable::default()
        };
        let ends = statistics.split_off(rows.saturating_sub(series.columns.len()));
        let ends = ends.into_iter().map(|row| row.summary).collect();
        let probes =
            if has("probes.parquet") { tables::read_probes_head(dir, MOST_ROWS)? } else { Vec::new() };
        let histograms = if has("histogram.parquet") { tables::read_histograms(dir)? } else { Vec::new() };
        let (species, frames) = first_realization(dir)?;
        let covariance = has("covariance.parquet");
        Ok(Samples { record, series, ends, probes, histograms, covariance, species, frames })
    }
}

/// Rows of a table that figures are drawn from, and realizations in any case.
const MOST_ROWS: usize = 1_000_000;
const FEWEST: usize = 20;

fn first_realization(dir: &Path) -> Result<(Vec<String>, Vec<ParticleFrame>), RunError> {
    const MOST: usize = 32;
    let parts = tables::list_particles(dir);
    let first = parts.first().map(|p| p.0);
    let (mut species, mut kept, mut last) = (Vec::new(), Vec::new(), None);
    let (mut seen, mut stride) = (0usize, 1usize);
    for (_, _, path) in parts.iter().filter(|p| Some(p.0) == first) {
        let (names, frames) = tables::read_particles(path)?;
        species = names;
        for frame in frames {
            if seen.is_multiple_of(stride) {
                kept.push(frame);
                last = None;
            } else {
                last = Some(frame);
            }
            seen += 1;
            if kept.len() > MOST {
                // Every second one goes: memory stays bounded however long the run.
                let mut index = 0;
                kept.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                stride *= 2;
            }
        }
    }
    kept.extend(last);
    Ok((species, kept))
}

/// Every figure the samples allow, in the order of the report.
#[must_use]
pub fn draw(samples: &Samples) -> Vec<Figure> {
    let mut out = Vec::new();
    out.extend(overview::overview(samples));
    out.extend(setup::setup(samples));
    out.extend(fields::concentrations(samples));
    out.extend(fields::flow(samples));
    out.extend(solids::solids(samples));
    out.extend(profiles::profiles(samples));
    out.extend(time::occupancy(samples));
    out.extend(time::amounts(samples));
    out.extend(probes::probes(samples));
    out.extend(distributions::distributions(samples));
    out.extend(time::fano(samples));
    out
}

/// Saves a figure below `dir` (as `name.png`, and `name.svg` unless it is a raster), each file as a whole or not at all.
///
/// # Errors
/// [`RunError::File`] if a file cannot be written.
pub fn save(figure: &Figure, dir: &Path) -> Result<(), RunError> {
    let png = dir.join(format!("{}.png", figure.name));
    let fault = |reason: String| RunError::File { path: png.display().to_string(), reason };
    std::fs::create_dir_all(dir).map_err(|e| fault(e.to_string()))?;
    // plotters chooses the format by the ending, so the temporary name keeps it.
    let temporary = dir.join(format!(".writing-{}.png", figure.name));
    write_png(&figure.drawing, &temporary).map_err(|reason| {
        // Half a picture is of no use; if even that stays, the folder says so.
        let _ = std::fs::remove_file(&temporary);
        fault(reason)
    })?;
    std::fs::rename(&temporary, &png).map_err(|e| fault(e.to_string()))?;
    if !figure.raster {
        tables::write_bytes(&dir.join(format!("{}.svg", figure.name)), svg(&figure.drawing).as_bytes())?;
    }
    Ok(())
}

/// The unit in which a run tells its times, one for all its figures.
pub(crate) fn clock(samples: &Samples) -> Scale {
    Scale::choose(samples.record.times.last().copied().unwrap_or(0.0), "s")
}

/// A name that is safe in a file name.
pub(crate) fn slug(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// Up to four of the recorded times that tell most: those of the distributions asked for, the end, the middle and the
/// quarters. The start is left out where two later times are known.
pub(crate) fn moments(samples: &Samples, times: &[f64]) -> Vec<usize> {
    let asked: Vec<f64> = samples.record.histograms.iter().flat_map(|h| h.times.iter().copied()).collect();
    choose(times, &asked)
}

fn choose(times: &[f64], asked: &[f64]) -> Vec<usize> {
    const MOST: usize = 4;
    let later: Vec<usize> = (0..times.len()).filter(|&k| times[k] > 0.0).collect();
    let Some(&last) = later.last().filter(|_| later.len() > 1) else { return (0..times.len()).collect() };
    let end = times[last];
    let asked = spread(asked.len(), MOST).into_iter().map(|k| asked[k]);
    let mut chosen: Vec<usize> = Vec::new();
    for target in asked.chain([1.0, 0.5, 0.25, 0.75].map(|part| part * end)) {
        let away = |k: usize| (times[k] - target).abs();
        let nearest = later.iter().copied().min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(last);
        let apart = |&c: &usize| (times[c] - times[nearest]).abs() > 0.1 * end;
        if chosen.len() < MOST && chosen.iter().all(apart) {
            chosen.push(nearest);
        }
    }
    chosen.sort_unstable();
    chosen
}

/// Up to `most` indices spread evenly over 0..count, first and last among them.
pub(crate) fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|k| (2 * k * (count - 1) + most - 1) / (2 * (most - 1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_show_the_times_that_were_asked_for() {
        let times: Vec<f64> = (0..=40).map(|k| f64::from(k) * 0.1).collect();
        assert_eq!(choose(&times, &[]), [10, 20, 30, 40]);
        assert_eq!(choose(&times, &[0.5, 4.0]), [5, 10, 20, 40]);
        assert_eq!((choose(&[0.0, 1.0], &[]), choose(&[], &[])), (vec![0, 1], vec![]));
    }
}
