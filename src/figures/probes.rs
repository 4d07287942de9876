//! Quantities along lines and rings: mean and band across realizations at several times.

use super::colours::{BLACK, Colour, GREY, PALE, PALETTE, viridis};
use super::drawing::{Anchor, HAIR, LABEL, TITLE};
use super::panel::{Axis, MARGIN, Panel, grid, legend, range};
use super::{Drawing, Figure, Samples, WIDTH, clock, slug, spread};
use crate::quantity::readable::Scale;
use crate::statistics::{mean, quantile};
use crate::tables::ProbeRows;

/// Most times drawn into one panel.
const TIMES: usize = 4;

/// Mean and 5 to 95 % band of one quantity along a probe at one time.
struct Band {
    time: f64,
    s: Vec<f64>,
    mean: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
    realizations: usize,
}

/// A figure for each probe, and a polar one for each ring.
pub fn probes(samples: &Samples) -> Vec<Figure> {
    let mut names: Vec<&str> = Vec::new();
    for row in &samples.probes {
        if !names.contains(&row.probe.as_str()) {
            names.push(&row.probe);
        }
    }
    names.into_iter().flat_map(|name| [cartesian(samples, name), polar(samples, name)]).flatten().collect()
}

fn cartesian(samples: &Samples, name: &str) -> Option<Figure> {
    let ring = is_ring(samples, name);
    let quantities = quantities(samples, name);
    let columns = if quantities.len() == 1 { 1 } else { 2 };
    let width = if columns == 1 { 110.0 } else { WIDTH };
    let (mut d, frames) = grid(quantities.len(), columns, width, if columns == 1 { 58.0 } else { 42.0 });
    let mut shown: Vec<(String, Colour, f64)> = Vec::new();
    let mut realizations = 0;
    for (quantity, frame) in quantities.iter().zip(frames) {
        let bands = bands(samples, name, quantity);
        let unit = unit(samples, name, quantity);
        let y =
            Axis::covering(bands.iter().flat_map(|b| b.low.iter().chain(&b.high)).copied(), &unit, quantity);
        let mut x = Axis::covering(bands.iter().flat_map(|b| b.s.iter().copied()), "m", "distance");
        if ring {
            let scale = Scale { factor: 180.0 / std::f64::consts::PI, unit: "degrees".into() };
            let high = x.low + 2.0 * std::f64::consts::PI;
            x = Axis { high, scale, label: "angle".into(), step: Some(90.0), ..x };
        }
        let p =
            Panel { left: frame[0], top: frame[1], width: frame[2], height: frame[3], x, y: y.with_air() };
        shown.clear();
        for (k, b) in bands.iter().enumerate() {
            // The light end of viridis vanishes on white.
            let colour = viridis(0.85 * k as f64 / (TIMES - 1) as f64);
            let closed = |values: &[f64], turn: f64| -> Vec<f64> {
                values.iter().copied().chain(values.first().filter(|_| ring).map(|v| v + turn)).collect()
            };
            let s = closed(&b.s, 2.0 * std::f64::consts::PI);
            p.band(&mut d, &s, &closed(&b.low, 0.0), &closed(&b.high, 0.0), colour.faint(0.15));
            p.curve(&mut d, &s, &closed(&b.mean, 0.0), 0.4, colour);
            shown.push((clock(samples).show(b.time), colour, 0.5));
            realizations = b.realizations;
        }
        p.axes(&mut d, quantity);
    }
    if shown.is_empty() {
        return None;
    }
    d.height += 5.0;
    let bottom = d.height - 3.0;
    legend(&mut d, MARGIN[0], bottom, &shown);
    let what = if ring { "around" } else { "along" };
    let caption = format!("Mean of {realizations} realizations; shaded: 5 to 95 % of them.");
    Some(Figure {
        name: format!("probe_{}", slug(name)),
        title: format!("Quantities {what} {name}"),
        caption,
        drawing: d,
        raster: false,
    })
}

fn polar(samples: &Samples, name: &str) -> Option<Figure> {
    let quantities = quantities(samples, name);
    if !is_ring(samples, name) || quantities.is_empty() {
        return None;
    }
    let (columns, cell) = (quantities.len().min(3), WIDTH / 3.0);
    let rows = quantities.len().div_ceil(columns);
    let mut d = Drawing::new(cell * columns as f64, rows as f64 * (cell + 5.0));
    let mut time = 0.0;
    for (k, quantity) in quantities.iter().enumerate() {
        let Some(b) = bands(samples, name, quantity).pop() else { continue };
        time = b.time;
        let centre = [
            (k % columns) as f64 * cell + cell / 2.0,
            (k / columns) as f64 * (cell + 5.0) + cell / 2.0 + 5.0,
        ];
        let radius = cell / 2.0 - 9.0;
        let (low, high) = range(b.low.iter().chain(&b.high).copied());
        let low = low.min(0.0);
        let place = |s: f64, v: f64| {
            let r = if high > low { radius * ((v - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
            [centre[0] + r * s.cos(), centre[1] - r * s.sin()]
        };
        let turn = |v: f64| -> Vec<[f64; 2]> {
            (0..=72).map(|i| place(f64::from(i) * 5f64.to_radians(), v)).collect()
        };
        for part in [0.5, 1.0] {
            d.line(&turn(low + part * (high - low)), HAIR, PALE);
        }
        for quarter in 0..4 {
            let angle = f64::from(quarter) * std::f64::consts::FRAC_PI_2;
            d.line(&[centre, place(angle, high)], HAIR, PALE);
            let far = radius + 4.0;
            let at = [centre[0] + far * angle.cos(), centre[1] - far * angle.sin()];
            d.text(at, &format!("{}°", quarter * 90), LABEL, GREY, Anchor::Middle);
        }
        let edge = |values: &[f64]| b.s.iter().zip(values).map(|(&s, &v)| place(s, v)).collect::<Vec<_>>();
        let mut ring: Vec<[f64; 2]> = edge(&b.high);
        ring.extend(edge(&b.high).first());
        ring.extend(edge(&b.low).first());
        ring.extend(edge(&b.low).iter().rev());
        d.area(&ring, PALETTE[0].faint(0.2));
        let mut curve = edge(&b.mean);
        curve.extend(curve.first().copied());
        d.line(&curve, 0.45, PALETTE[0]);
        let scale = Scale::choose(low.abs().max(high), &unit(samples, name, quantity));
        d.text([centre[0] + 1.0, centre[1] - radius + 2.2], &scale.show(high), LABEL, BLACK, Anchor::Start);
        d.text([centre[0], centre[1] - radius - 8.5], quantity, TITLE, BLACK, Anchor::Middle);
    }
    Some(Figure {
        name: format!("probe_{}_polar", slug(name)),
        title: format!("{name} at {}", clock(samples).show(time)),
        caption:
            "Mean (line) and 5 to 95 % of the realizations (shaded); the outer circle carries its value."
                .into(),
        drawing: d,
        raster: false,
    })
}

fn is_ring(samples: &Samples, name: &str) -> bool {
    samples.record.probes.iter().any(|p| p.name == name && p.kind == "ring")
}

fn unit(samples: &Samples, name: &str, quantity: &str) -> String {
    let probe = samples.record.probes.iter().find(|p| p.name == name);
    probe.and_then(|p| p.quantities.get(quantity)).cloned().unwrap_or_default()
}

fn quantities(samples: &Samples, name: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for row in samples.probes.iter().filter(|r| r.probe == name) {
        if !out.contains(&row.quantity) {
            out.push(row.quantity.clone());
        }
    }
    out
}

fn bands(samples: &Samples, name: &str, quantity: &str) -> Vec<Band> {
    let rows: Vec<&ProbeRows> =
        samples.probes.iter().filter(|r| r.probe == name && r.quantity == quantity).collect();
    let mut times: Vec<f64> = rows.iter().map(|r| r.time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let band = |time: f64| {
        let at: Vec<&&ProbeRows> = rows.iter().filter(|r| r.time == time).collect();
        let s = at.first().map_or_else(Vec::new, |r| r.s.clone());
        let over = |f: &dyn Fn(&[f64]) -> f64| -> Vec<f64> {
            (0..s.len())
                .map(|k| {
                    let values: Vec<f64> =
                        at.iter().filter_map(|r| r.value.get(k).copied()).filter(|v| v.is_finite()).collect();
                    f(&values)
                })
                .collect()
        };
        let (low, high) = (over(&|v| quantile(v, 0.05)), over(&|v| quantile(v, 0.95)));
        Band { time, mean: over(&mean), low, high, realizations: at.len(), s }
    };
    spread(times.len(), TIMES).into_iter().map(|k| band(times[k])).collect()
}
