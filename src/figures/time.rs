//! Amounts, occupancy and Fano factor against time.

use super::colours::{GREY, PALETTE};
use super::panel::{Axis, Panel, grid, range};
use super::{Drawing, Figure, Samples, WIDTH};
use crate::statistics::{fano as fano_factor, mean, quantile};

/// Most panels of one figure, and most single realizations drawn into one.
const PANELS: usize = 24;
const LINES: usize = 20;
/// Realizations from which a 5 to 95 % band says something.
const BAND: usize = 5;

/// One quantity: its values realization by realization, each as long as the times.
pub(super) struct Curves {
    pub title: String,
    pub values: Vec<Vec<f64>>,
    /// SI unit of the values.
    pub unit: String,
    pub label: String,
}

/// Amount of every species in every group where it ever occurs.
pub fn amounts(samples: &Samples) -> Option<Figure> {
    let names = &samples.series.columns;
    let mut curves: Vec<Curves> = (0..names.len())
        .filter(|&c| !repeats(samples, c))
        .map(|c| amount(samples, c))
        .filter(|c| c.values.iter().flatten().any(|v| *v != 0.0))
        .collect();
    let left_out = curves.len().saturating_sub(PANELS);
    curves.truncate(PANELS);
    let mut caption = words(samples);
    if left_out > 0 {
        caption += &format!(" {left_out} more series stand in the tables.");
    }
    figure(samples, "amounts", "Amounts against time", &caption, &curves)
}

fn amount(samples: &Samples, c: usize) -> Curves {
    Curves {
        title: title(samples, c),
        values: column(samples, c),
        unit: "molecules".into(),
        label: "amount".into(),
    }
}

/// What a reader asks for first: occupancy, or the amount over the domain that changes most (with its species).
pub(super) fn headline(samples: &Samples) -> Option<(Curves, Option<&str>)> {
    if samples.series.times.len() < 2 {
        return None;
    }
    if let Some(first) = occupancies(samples).into_iter().next() {
        return Some((first, None));
    }
    let names = &samples.series.columns;
    let change = |c: &usize| {
        let values = column(samples, *c);
        let (low, high) = range(values.iter().flatten().copied());
        high - low
    };
    let all = (0..names.len()).filter(|&c| names.groups[c] == "all");
    let c = all.max_by(|a, b| change(a).total_cmp(&change(b)))?;
    Some((amount(samples, c), Some(&names.species[c])))
}

/// Share of bound receptors wherever an immobile pair X, Y with conserved X + Y and X + … -> Y lives.
pub fn occupancy(samples: &Samples) -> Option<Figure> {
    let curves = occupancies(samples);
    figure(samples, "occupancy", "Occupancy (bound fraction)", &words(samples), &curves)
}

fn occupancies(samples: &Samples) -> Vec<Curves> {
    let names = &samples.series.columns;
    let (mut curves, mut places) = (Vec::new(), Vec::new());
    for (free, bound) in pairs(samples) {
        for c in 0..names.len() {
            let group = &names.groups[c];
            let Some(b) = names.find(group, &bound).filter(|_| names.species[c] == free) else { continue };
            // The sum over the domain repeats the one group the pair lives in.
            if group == "all" && names.groups.iter().any(|g| g != "all") {
                continue;
            }
            let (x, y) = (column(samples, c), column(samples, b));
            let share = |x: &Vec<f64>, y: &Vec<f64>| x.iter().zip(y).map(|(x, y)| y / (x + y)).collect();
            let values: Vec<Vec<f64>> = x.iter().zip(&y).map(|(x, y)| share(x, y)).collect();
            if values.iter().flatten().any(|v| v.is_finite()) {
                let title = format!("{bound}/({free} + {bound})");
                places.push(format!(" in {group}"));
                curves.push(Curves { title, values, unit: "1".into(), label: "occupancy".into() });
            }
        }
    }
    if curves.len() > 1 {
        curves.iter_mut().zip(places).for_each(|(curve, place)| curve.title += &place);
    }
    curves
}

/// Variance over mean across realizations.
pub fn fano(samples: &Samples) -> Option<Figure> {
    let series = &samples.series;
    // The Fano factor of n realizations scatters by √(2/n): below ten it says nothing.
    if series.blocks.len() < 10 {
        return None;
    }
    let names = &series.columns;
    let curve = |c: usize| Curves {
        title: title(samples, c),
        values: vec![(0..series.times.len()).map(|t| fano_factor(&series.across(t, c))).collect()],
        unit: "1".into(),
        label: "variance / mean".into(),
    };
    let curves: Vec<Curves> = (0..names.len())
        .filter(|&c| !repeats(samples, c))
        .map(curve)
        .filter(|c| c.values[0].iter().any(|v| v.is_finite() && *v > 0.0))
        .take(PANELS)
        .collect();
    let caption = format!(
        "Variance over mean of the amount across {} realizations. Dashed and shaded: a Poisson distribution has 1 and, in samples of this size, lies in the band 19 times out of 20.",
        series.blocks.len()
    );
    figure(samples, "fano", "Fano factor against time", &caption, &curves)
}

/// Whether a column is the sum over the domain of a species that occurs in one group only, or that never changes.
fn repeats(samples: &Samples, c: usize) -> bool {
    let names = &samples.series.columns;
    let other = |k: usize| names.groups[k] != "all" && names.species[k] == names.species[c];
    if names.groups[c] != "all" || !(0..names.len()).any(other) {
        return false;
    }
    let whole = column(samples, c);
    let first = whole.first().and_then(|v| v.first());
    whole.iter().flatten().all(|v| Some(v) == first)
        || (0..names.len()).any(|k| other(k) && column(samples, k) == whole)
}

fn title(samples: &Samples, c: usize) -> String {
    let names = &samples.series.columns;
    match names.groups[c].as_str() {
        _ if names.groups.iter().all(|g| *g == names.groups[0]) => names.species[c].clone(),
        "all" => format!("{}, whole domain", names.species[c]),
        group => format!("{} in {group}", names.species[c]),
    }
}

/// How mean, band and single realizations are drawn.
pub(super) fn words(samples: &Samples) -> String {
    let (shown, all) = (samples.series.blocks.len(), samples.record.finished as usize);
    if shown < all {
        return format!(
            "Of the first {shown} of {all} realizations; thick: mean; shaded: 5 to 95 %; thin: {} single ones.",
            shown.min(LINES)
        );
    }
    match shown {
        1 => "One realization.".into(),
        n if n < BAND => format!("Thick: mean of {n} realizations; thin: single realizations."),
        n => format!(
            "Thick: mean of {n} realizations; shaded: 5 to 95 % of them; thin: {} single realizations.",
            n.min(LINES)
        ),
    }
}

fn column(samples: &Samples, c: usize) -> Vec<Vec<f64>> {
    let (series, width) = (&samples.series, samples.series.columns.len());
    series.blocks.iter().map(|b| (0..series.times.len()).map(|t| b.amount[t * width + c]).collect()).collect()
}

/// (free, bound) of each receptor.
fn pairs(samples: &Samples) -> Vec<(String, String)> {
    let record = &samples.record;
    let immobile = |name: &str| record.species.iter().any(|s| s.name == name && s.diffusion == 0.0);
    let binds = |free: &str, bound: &str| {
        record.reactions.iter().any(|r| {
            let Some((left, right)) = r.equation.split_once("->") else { return false };
            let left: Vec<&str> = left.trim_end_matches('<').split(" + ").map(str::trim).collect();
            left.len() > 1 && left.contains(&free) && right.split(" + ").any(|p| p.trim() == bound)
        })
    };
    let mut out = Vec::new();
    for law in &record.conservation_laws {
        let terms: Vec<&str> = law.split('+').map(str::trim).collect();
        let [a, b] = terms[..] else { continue };
        if immobile(a) && immobile(b) {
            if binds(a, b) {
                out.push((a.to_string(), b.to_string()));
            } else if binds(b, a) {
                out.push((b.to_string(), a.to_string()));
            }
        }
    }
    out
}

fn figure(samples: &Samples, name: &str, title: &str, caption: &str, curves: &[Curves]) -> Option<Figure> {
    let times = &samples.series.times;
    if curves.is_empty() || times.len() < 2 {
        return None;
    }
    let columns = match curves.len() {
        1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let width = if columns == 1 { 110.0 } else { WIDTH };
    let (mut d, frames) = grid(curves.len(), columns, width, [58.0, 44.0, 34.0][columns - 1]);
    // The Fano factor of n Poisson (or normal) numbers scatters by √(2/(n - 1)) about 1; 1.96 of these hold 95 %.
    let scatter = 1.96 * (2.0 / (samples.series.blocks.len() as f64 - 1.0).max(1.0)).sqrt();
    let reference = (name == "fano").then_some(scatter);
    for (curve, frame) in curves.iter().zip(frames) {
        draw_curves(&mut d, times, curve, frame, reference);
    }
    Some(Figure {
        name: name.into(),
        title: title.into(),
        caption: caption.into(),
        drawing: d,
        raster: false,
    })
}

/// One panel: band, single realizations, mean; with `reference` the level 1 and a band about it.
pub(super) fn draw_curves(
    d: &mut Drawing,
    times: &[f64],
    curve: &Curves,
    frame: [f64; 4],
    reference: Option<f64>,
) {
    let n = curve.values.len();
    let band = reference.map_or(vec![], |s| vec![(1.0 - s).max(0.0), 1.0 + s]);
    let shown = range(curve.values.iter().flatten().copied());
    // What lies far below the reference is shown on its own scale.
    let band = band.into_iter().filter(|_| shown.1 > 0.5);
    let y = Axis::covering(curve.values.iter().flatten().copied().chain(band), &curve.unit, &curve.label)
        .with_air();
    let x = Axis::covering(times.iter().copied(), "s", "time");
    let p = Panel { left: frame[0], top: frame[1], width: frame[2], height: frame[3], x, y };
    let colour = PALETTE[0];
    let at = |t: usize| -> Vec<f64> { curve.values.iter().map(|v| v[t]).filter(|v| v.is_finite()).collect() };
    let over = |f: &dyn Fn(&[f64]) -> f64| -> Vec<f64> { (0..times.len()).map(|t| f(&at(t))).collect() };
    if let Some(scatter) = reference.filter(|s| p.y.high > 1.0 - s) {
        let level = |v: f64| vec![v; times.len()];
        p.band(d, times, &level(1.0 - scatter), &level(1.0 + scatter), GREY.faint(0.2));
        p.level(d, 1.0);
    }
    if n >= BAND {
        let (low, high) = (over(&|v| quantile(v, 0.05)), over(&|v| quantile(v, 0.95)));
        p.band(d, times, &low, &high, colour.faint(0.18));
    }
    if n > 1 {
        for values in curve.values.iter().take(LINES) {
            p.curve(d, times, values, 0.1, GREY.faint(0.55));
        }
    }
    p.curve(d, times, &over(&mean), 0.45, colour);
    p.axes(d, &curve.title);
}
