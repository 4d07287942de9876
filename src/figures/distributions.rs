//! Distribution of amounts across realizations, beside a Poisson and a normal law.

use super::colours::{BLACK, GREY, PALETTE};
use super::drawing::{Anchor, LABEL};
use super::panel::{Axis, Panel, grid};
use super::{Figure, Samples, WIDTH, clock};
use crate::quantity::readable::{Scale, significant};
use crate::statistics::{Summary, histogram, ln_gamma};

const PANELS: usize = 12;
/// Realizations below which a histogram is noise.
const ENOUGH: usize = 20;

struct Sample {
    title: String,
    values: Vec<f64>,
    /// (low, high, count).
    bins: Vec<(f64, f64, u32)>,
}

/// The distributions asked for; without any, those of every varying amount at the last time.
pub fn distributions(samples: &Samples) -> Option<Figure> {
    let series = &samples.series;
    if series.blocks.len() < ENOUGH {
        return None;
    }
    let mut list: Vec<Sample> = asked(samples);
    if list.is_empty() {
        let last = series.times.len().checked_sub(1)?;
        let several = series.columns.groups.iter().any(|g| g != "all");
        for c in 0..series.columns.len() {
            let (group, species) = (&series.columns.groups[c], &series.columns.species[c]);
            let values = series.across(last, c);
            if Summary::of(&values).variance > 0.0 && !(several && group == "all") {
                let title = format!("{species} in {group}, {}", clock(samples).show(series.times[last]));
                list.push(Sample { title, bins: histogram(&values), values });
            }
        }
    }
    list.truncate(PANELS);
    if list.is_empty() {
        return None;
    }
    let columns = list.len().min(3);
    let (mut d, frames) = grid(list.len(), columns, WIDTH.min(85.0 * columns as f64), 38.0);
    for (sample, frame) in list.iter().zip(frames) {
        panel(&mut d, sample, frame);
    }
    let caption = format!(
        "Bars: {} realizations; orange: Poisson law of the same mean; grey, dashed: normal law of the same mean and variance.",
        series.blocks.len()
    );
    Some(Figure {
        name: "distributions".into(),
        title: "Distributions across realizations".into(),
        caption,
        drawing: d,
        raster: false,
    })
}

fn asked(samples: &Samples) -> Vec<Sample> {
    let series = &samples.series;
    let mut list: Vec<Sample> = Vec::new();
    for bin in &samples.histograms {
        let title = format!("{} in {}, {}", bin.species, bin.group, clock(samples).show(bin.time));
        if list.last().is_none_or(|s| s.title != title) {
            let column = series.columns.find(&bin.group, &bin.species);
            let time = series.times.iter().position(|t| *t == bin.time);
            let values = time.zip(column).map_or_else(Vec::new, |(t, c)| series.across(t, c));
            list.push(Sample { title, values, bins: Vec::new() });
        }
        if let Some(sample) = list.last_mut() {
            sample.bins.push((bin.low, bin.high, bin.count));
        }
    }
    list
}

fn panel(d: &mut super::Drawing, sample: &Sample, frame: [f64; 4]) {
    let s = Summary::of(&sample.values);
    let (Some(first), Some(last)) = (sample.bins.first(), sample.bins.last()) else { return };
    let width = first.1 - first.0;
    let n = sample.values.len() as f64;
    let density = |log: f64| n * width * log.exp();
    let poisson = |x: f64| density(x * s.mean.ln() - s.mean - ln_gamma(x + 1.0));
    let normal = |x: f64| {
        let z = (x - s.mean) / s.sd;
        density(-0.5 * z * z - (s.sd * (2.0 * std::f64::consts::PI).sqrt()).ln())
    };
    let air = (last.1 - first.0) * 0.08;
    // Whole numbers are centred on their bar.
    let shift = if width == 1.0 { 0.5 } else { 0.0 };
    let (low, high) = (first.0 - air - shift, last.1 + air - shift);
    let top = sample.bins.iter().map(|b| f64::from(b.2)).fold(normal(s.mean), f64::max) * 1.25;
    let axis = |low, high, label: &str, unit: &str| Axis {
        low,
        high,
        scale: Scale::plain(unit),
        label: label.into(),
        step: None,
    };
    let p = Panel {
        left: frame[0],
        top: frame[1],
        width: frame[2],
        height: frame[3],
        x: axis(low, high, "amount", "molecules"),
        y: axis(0.0, top, "realizations", ""),
    };
    for &(from, to, count) in sample.bins.iter().filter(|b| b.2 > 0) {
        let (a, b) = (p.at(from - shift, f64::from(count)), p.at(to - shift, 0.0));
        let gap = (0.08 * (b[0] - a[0])).min(0.2);
        d.rectangle([a[0] + gap / 2.0, a[1]], [b[0] - a[0] - gap, b[1] - a[1]], PALETTE[0].faint(0.45));
    }
    let xs: Vec<f64> = (0..=160).map(|k| low + (high - low) * f64::from(k) / 160.0).collect();
    let curve = |f: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> { xs.iter().map(|&x| p.at(x, f(x))).collect() };
    if s.mean > 0.0 {
        let inside: Vec<[f64; 2]> = xs.iter().filter(|x| **x >= 0.0).map(|&x| p.at(x, poisson(x))).collect();
        d.line(&inside, 0.4, PALETTE[1]);
    }
    if s.sd > 0.0 {
        d.dashed(&curve(&normal), 0.3, GREY);
    }
    let words = format!("mean {}, sd {}", significant(s.mean, 4), significant(s.sd, 3));
    d.text([p.left + p.width - 1.5, p.top + 2.6], &words, LABEL * 0.95, BLACK, Anchor::End);
    p.axes(d, &sample.title);
}
