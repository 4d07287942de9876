//! Tables of a run from what its realizations have shown, in order of realization, read as often as needed: the
//! memory does not grow with realizations or output times, and the bytes depend on nothing but what was shown.

use super::books::Books;
use crate::error::RunError;
use crate::record::HistogramRecord;
use crate::simulation::{Piece, Share};
use crate::statistics::{Accumulator, CoMoments, Histogram, Quantiles, Summary};
use crate::tables::{
    Bin, Columns, CovarianceWriter, ProbesWriter, SeriesBlock, SeriesWriter, StatisticsWriter,
    TimeAverageRow, averages_of, averages_of_all, write_histograms, write_time_averages,
};
use std::ops::Range;
use std::path::Path;

/// Realizations up to which quantiles are those of all values; beyond, a sketch ([`Quantiles`]).
pub const EXACT_UP_TO: usize = 10_000;

/// Memory for the values of one reading, bytes.
const MEMORY: usize = 512 << 20;

/// Realizations that can be read one after the other, any number of times.
pub trait Source {
    /// Their numbers, in order.
    fn realizations(&self) -> Vec<u32>;

    /// Calls `see` with the pieces of a realization in order of time; its share of the books if it has one.
    ///
    /// # Errors
    /// Those of `see`, and what cannot be read.
    fn realization(
        &mut self,
        number: u32,
        see: &mut dyn FnMut(&Piece) -> Result<(), RunError>,
    ) -> Result<Option<Share>, RunError>;
}

/// What tables are asked for.
pub struct Wanted<'a> {
    /// Output times to be told of, s.
    pub times: &'a [f64],
    pub columns: &'a Columns,
    pub covariance: bool,
    pub histograms: &'a [HistogramRecord],
    pub probes: bool,
}

/// Sums over the realizations at some of the output times.
struct Cells {
    times: Range<usize>,
    width: usize,
    moments: Vec<Accumulator>,
    quantiles: Vec<Quantiles>,
    products: Vec<CoMoments>,
}

impl Cells {
    fn new(times: Range<usize>, width: usize, covariance: bool) -> Cells {
        let count = times.len() * width;
        Cells {
            width,
            moments: vec![Accumulator::default(); count],
            quantiles: vec![Quantiles::new(EXACT_UP_TO); count],
            products: if covariance { vec![CoMoments::new(width); times.len()] } else { Vec::new() },
            times,
        }
    }

    fn see(&mut self, piece: &Piece) {
        if self.width == 0 {
            return;
        }
        for (row, amounts) in piece.amount.chunks_exact(self.width).enumerate() {
            let Some(t) = (piece.first as usize + row).checked_sub(self.times.start) else { continue };
            if t >= self.times.len() {
                break;
            }
            let cells = t * self.width..(t + 1) * self.width;
            let sums = self.moments[cells.clone()].iter_mut().zip(&mut self.quantiles[cells]);
            for ((moments, quantiles), &amount) in sums.zip(amounts) {
                moments.push(amount);
                quantiles.push(amount);
            }
            if let Some(products) = self.products.get_mut(t) {
                products.push(amounts);
            }
        }
    }

    fn summaries(&self) -> Vec<Summary> {
        self.moments.iter().zip(&self.quantiles).map(|(m, q)| Summary::from(m, q)).collect()
    }
}

/// Output times that are summed up in one reading of `realizations`.
fn batch(realizations: usize, width: usize, covariance: bool) -> usize {
    let cell = 8 * realizations.min(EXACT_UP_TO) + 256;
    let products = if covariance { 8 * width * width } else { 0 };
    (MEMORY / (cell * width + products).max(1)).max(1)
}

/// Writes the tables of a run below `dir`, but for those of the particles; `books` takes note of what it sees.
///
/// # Errors
/// What cannot be read or written.
pub fn assemble(
    source: &mut dyn Source,
    dir: &Path,
    wanted: &Wanted,
    mut books: Option<&mut Books>,
) -> Result<(), RunError> {
    let (numbers, width, last) = (source.realizations(), wanted.columns.len(), wanted.times.len());
    let batch = batch(numbers.len(), width, wanted.covariance);
    let mut series = SeriesWriter::new(dir, wanted.times, wanted.columns)?;
    let mut probes = if wanted.probes { Some(ProbesWriter::new(dir)?) } else { None };
    let mut statistics = StatisticsWriter::new(dir, wanted.columns)?;
    let mut covariance =
        if wanted.covariance { Some(CovarianceWriter::new(dir, wanted.columns)?) } else { None };
    let mut averages = Averages::new(wanted);
    let mut bins = Vec::new();
    for from in (0..last.max(1)).step_by(batch) {
        let mut cells = Cells::new(from..(from + batch).min(last), width, wanted.covariance);
        for &number in &numbers {
            let share = source.realization(number, &mut |piece| {
                cells.see(piece);
                if from > 0 {
                    return Ok(());
                }
                let rows = last.saturating_sub(piece.first as usize).min(piece.outputs as usize) * width;
                if let Some(books) = &mut books {
                    books.see(piece);
                }
                averages.see(piece);
                series.push(
                    number,
                    piece.first as usize,
                    &piece.amount[..rows],
                    &piece.concentration[..rows],
                )?;
                let end = wanted.times.last().copied().unwrap_or(f64::NEG_INFINITY);
                match &mut probes {
                    Some(probes) => {
                        piece.probes.iter().filter(|p| p.time <= end).try_for_each(|p| probes.push(p))
                    }
                    None => Ok(()),
                }
            })?;
            if let (Some(share), Some(books), 0) = (share, &mut books, from) {
                books.tally.take(&share);
            }
        }
        let summaries = cells.summaries();
        statistics.push(&wanted.times[cells.times.clone()], &summaries)?;
        if let Some(covariance) = &mut covariance {
            let times = &wanted.times[cells.times.clone()];
            times.iter().zip(&cells.products).try_for_each(|(&time, m)| covariance.push(time, m))?;
        }
        bins.extend(histograms(source, &numbers, wanted, &cells.times, &summaries)?);
    }
    averages.write(dir)?;
    series.finish()?;
    probes.map_or(Ok(()), ProbesWriter::finish)?;
    statistics.finish()?;
    covariance.map_or(Ok(()), CovarianceWriter::finish)?;
    if wanted.histograms.is_empty() { Ok(()) } else { write_histograms(dir, &bins) }
}

/// Realizations whose averages over time are told one by one, and output times up to which they are.
const AVERAGED: u32 = 100;
const LONGEST: usize = 100_000;

/// Averages over the second half of the run, where the output times allow them.
struct Averages<'a> {
    wanted: &'a Wanted<'a>,
    /// The realization under way.
    block: SeriesBlock,
    rows: Vec<TimeAverageRow>,
    seen: u32,
}

impl<'a> Averages<'a> {
    fn new(wanted: &'a Wanted<'a>) -> Averages<'a> {
        Averages { wanted, block: SeriesBlock::default(), rows: Vec::new(), seen: 0 }
    }

    fn see(&mut self, piece: &Piece) {
        let (times, columns) = (self.wanted.times, self.wanted.columns);
        if self.seen >= AVERAGED || times.len() > LONGEST {
            return;
        }
        if piece.first == 0 {
            self.block = SeriesBlock { realization: piece.realization, ..SeriesBlock::default() };
        }
        self.block.amount.extend(&piece.amount);
        if self.block.amount.len() >= times.len() * columns.len() {
            let block = std::mem::take(&mut self.block);
            let half = 0.5 * times.last().copied().unwrap_or(0.0);
            self.rows.extend(averages_of(times, columns, &block, half).into_iter().flatten());
            self.seen += 1;
        }
    }

    fn write(mut self, dir: &Path) -> Result<(), RunError> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let all = averages_of_all(&self.rows, self.wanted.columns.len());
        self.rows.extend(all);
        write_time_averages(dir, &self.rows)
    }
}

/// The distributions asked for at some of the output times, whose summaries choose the bins.
fn histograms(
    source: &mut dyn Source,
    numbers: &[u32],
    wanted: &Wanted,
    times: &Range<usize>,
    summaries: &[Summary],
) -> Result<Vec<Bin>, RunError> {
    let width = wanted.columns.len();
    let mut asked = Vec::new();
    for one in wanted.histograms {
        let Some(column) = wanted.columns.find(&one.group, &one.species) else { continue };
        for &time in &one.times {
            let Some(t) = nearest(wanted.times, time).filter(|t| times.contains(t)) else { continue };
            let histogram = Histogram::new(&summaries[(t - times.start) * width + column]);
            asked.push((t, column, one, histogram));
        }
    }
    if asked.is_empty() {
        return Ok(Vec::new());
    }
    for &number in numbers {
        source.realization(number, &mut |piece| {
            for (t, column, _, histogram) in &mut asked {
                let row = t.checked_sub(piece.first as usize);
                let value = row.and_then(|row| piece.amount.get(row * width + *column));
                value.into_iter().for_each(|&value| histogram.push(value));
            }
            Ok(())
        })?;
    }
    let mut bins = Vec::new();
    for (t, _, one, histogram) in asked {
        for (low, high, count) in histogram.bins() {
            let (group, species) = (one.group.clone(), one.species.clone());
            bins.push(Bin { time: wanted.times[t], group, species, low, high, count });
        }
    }
    Ok(bins)
}

fn nearest(times: &[f64], time: f64) -> Option<usize> {
    (0..times.len()).min_by(|&a, &b| (times[a] - time).abs().total_cmp(&(times[b] - time).abs()))
}
