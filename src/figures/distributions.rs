//! Distribution of amounts across realizations, beside a Poisson and a normal law.

use super::colours::{BLACK, PALETTE};
use super::drawing::{Anchor, LABEL};
use super::panel::{Axis, Panel, grid};
use super::{Figure, Samples, WIDTH, clock};
use crate::quantity::readable::{Scale, significant};
use crate::statistics::{Summary, histogram, ln_gamma};

const PANELS: usize = 12;
/// Realizations below which a histogram is noise.
const ENOUGH: usize = 20;

/// A law this many times as high as the bars is left out.
const TOWERS: f64 = 2.5;

struct Sample {
    title: String,
    values: Vec<f64>,
    /// (low, high, count).
    bins: Vec<(f64, f64, u32)>,
    /// The fixed number of molecules of which these are a part, if there is one.
    total: Option<f64>,
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
                let title = title(samples, species, group, series.times[last]);
                let total = total(samples, c);
                list.push(Sample { title, bins: histogram(&values), values, total });
            }
        }
    }
    list.truncate(PANELS);
    if list.is_empty() {
        return None;
    }
    let columns = if list.len() == 4 { 2 } else { list.len().min(3) };
    let (mut d, frames) = grid(list.len(), columns, WIDTH.min(85.0 * columns as f64), 38.0);
    for (sample, frame) in list.iter().zip(frames) {
        panel(&mut d, sample, frame);
    }
    let law = match (list.iter().any(|s| s.total.is_some()), list.iter().all(|s| s.total.is_some())) {
        (_, true) => "binomial law (the total is fixed)",
        (true, _) => "Poisson law (binomial where the total is fixed)",
        _ => "Poisson law",
    };
    let (shown, all) = (series.blocks.len(), samples.record.finished as usize);
    let which = if shown < all { format!("the first {shown} of {all}") } else { shown.to_string() };
    let caption = format!(
        "Bars: {which} realizations; orange, solid: {law} of the same mean (left out where it is more than 2.5 times as high as the bars); black, dashed: normal law of the same mean and variance."
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
        let title = title(samples, &bin.species, &bin.group, bin.time);
        if list.last().is_none_or(|s| s.title != title) {
            let column = series.columns.find(&bin.group, &bin.species);
            let time = series.times.iter().position(|t| *t == bin.time);
            let values = time.zip(column).map_or_else(Vec::new, |(t, c)| series.across(t, c));
            let total = column.and_then(|c| total(samples, c));
            list.push(Sample { title, values, bins: Vec::new(), total });
        }
        if let Some(sample) = list.last_mut() {
            sample.bins.push((bin.low, bin.high, bin.count));
        }
    }
    list
}

fn title(samples: &Samples, species: &str, group: &str, time: f64) -> String {
    let time = clock(samples).show(time);
    if samples.series.columns.groups.iter().all(|g| g == "all") {
        format!("{species}, {time}")
    } else if group == "all" {
        format!("{species}, whole domain, {time}")
    } else {
        format!("{species} in {group}, {time}")
    }
}

/// The number N if column `c` plus others of the record never changes: the whole amount of a species that no reaction
/// makes, or a pair of species with a conserved sum.
fn total(samples: &Samples, c: usize) -> Option<f64> {
    let (series, names) = (&samples.series, &samples.series.columns);
    let (group, species) = (&names.groups[c], &names.species[c]);
    let fixed = |columns: &[usize]| -> Option<f64> {
        let width = names.len();
        let mut sums = series.blocks.iter().flat_map(|b| {
            (0..series.times.len())
                .map(move |t| columns.iter().map(|&k| b.amount[t * width + k]).sum::<f64>())
        });
        let first = sums.next()?;
        (first > 0.0 && first.fract() == 0.0 && sums.all(|s| s == first)).then_some(first)
    };
    let others = (0..names.len()).filter(|&k| k != c && names.groups[k] == *group);
    let whole = names.find("all", species).filter(|_| group != "all");
    whole.and_then(|k| fixed(&[k])).or_else(|| others.map(|k| fixed(&[c, k])).find_map(|total| total))
}

fn panel(d: &mut super::Drawing, sample: &Sample, frame: [f64; 4]) {
    let s = Summary::of(&sample.values);
    let (Some(first), Some(last)) = (sample.bins.first(), sample.bins.last()) else { return };
    let width = first.1 - first.0;
    let n = sample.values.len() as f64;
    let density = |log: f64| n * width * log.exp();
    let law = |x: f64| match sample.total {
        Some(n) if x > n => 0.0,
        Some(n) => {
            let p = s.mean / n;
            let ways = ln_gamma(n + 1.0) - ln_gamma(x + 1.0) - ln_gamma(n - x + 1.0);
            density(ways + x * p.ln() + (n - x) * (1.0 - p).ln())
        }
        None => density(x * s.mean.ln() - s.mean - ln_gamma(x + 1.0)),
    };
    let normal = |x: f64| {
        let z = (x - s.mean) / s.sd;
        density(-0.5 * z * z - (s.sd * (2.0 * std::f64::consts::PI).sqrt()).ln())
    };
    let air = (last.1 - first.0) * 0.08;
    // Whole numbers are centred on their bar.
    let shift = if width == 1.0 { 0.5 } else { 0.0 };
    let (low, high) = (first.0 - air - shift, last.1 + air - shift);
    let highest = |f: &dyn Fn(f64) -> f64| Some(f(s.mean)).filter(|v| v.is_finite()).unwrap_or(0.0);
    let bars = sample.bins.iter().map(|b| f64::from(b.2)).fold(highest(&normal), f64::max);
    // A law that towers over what was found (two states, bursts) would leave nothing of it to see.
    let comparable = highest(&law) <= TOWERS * bars;
    let peak = if comparable { bars.max(highest(&law)) } else { bars };
    // The words above the bars take a quarter of the frame.
    let top = peak / 0.74;
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
    if s.mean > 0.0 && comparable {
        let inside: Vec<[f64; 2]> = xs.iter().filter(|x| **x >= 0.0).map(|&x| p.at(x, law(x))).collect();
        d.line(&inside, 0.4, PALETTE[1]);
    }
    if s.sd > 0.0 {
        d.dashed(&curve(&normal), 0.3, BLACK);
    }
    let words = [
        format!("mean {}, sd {}", significant(s.mean, 4), significant(s.sd, 3)),
        format!("Fano factor {}", significant(s.fano, 3)),
    ];
    for (k, words) in words.iter().enumerate() {
        let at = [p.left + p.width - 1.5, p.top + 2.6 + 3.8 * k as f64];
        d.text(at, words, LABEL * 0.95, BLACK, Anchor::End);
    }
    p.axes(d, &sample.title);
}
