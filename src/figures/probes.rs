//! Quantities along lines and rings: mean and band across realizations at several times.

use super::colours::{BLACK, Colour, viridis};
use super::drawing::{Anchor, LABEL};
use super::panel::{Axis, MARGIN, Panel, grid, legend};
use super::polar::polar;
use super::sections::{Section, sections};
use super::solids::is_outline;
use super::{Drawing, Figure, Samples, WIDTH, clock, slug};
use crate::quantity::readable::Scale;

/// Realizations from which a 5 to 95 % band says something.
pub(super) const BAND: usize = 5;
/// The quantity that stands for itself on a ring of receptors.
pub(super) const OCCUPANCY: &str = "occupancy";
/// Kinds of probes that show one number a time.
const POINTS: [&str; 3] = ["surface", "point", "solid"];
const TURN: f64 = 2.0 * std::f64::consts::PI;

/// Figures of each probe: receptors round a ring, the other quantities, a polar view.
pub fn probes(samples: &Samples) -> Vec<Figure> {
    let mut names: Vec<&str> = Vec::new();
    for row in &samples.probes {
        // Lines through one-dimensional models are drawn with their species together.
        let drawn = samples.record.domain.dimensions == 1 && !is_ring(samples, &row.probe);
        // A surface, a point or a whole solid has no extent along which to draw.
        let drawn = drawn
            || samples.record.probes.iter().any(|p| p.name == row.probe && POINTS.contains(&p.kind.as_str()))
            || is_outline(samples, &row.probe);
        if !names.contains(&row.probe.as_str()) && !drawn {
            names.push(&row.probe);
        }
    }
    names
        .into_iter()
        .flat_map(|name| [occupancy(samples, name), cartesian(samples, name), polar(samples, name)])
        .flatten()
        .collect()
}

fn occupancy(samples: &Samples, name: &str) -> Option<Figure> {
    if !is_ring(samples, name) || !quantities(samples, name).iter().any(|q| q == OCCUPANCY) {
        return None;
    }
    let sections = sections(samples, name, OCCUPANCY);
    let width = 130.0;
    let (mut d, frames) = grid(1, 1, width, 64.0);
    let mut p = panel(samples, name, OCCUPANCY, &sections, *frames.first()?);
    p.x.label.clear();
    let shown = curves(samples, &mut d, &p, &sections, true);
    p.axes(&mut d, "");
    let sides = match downstream(samples) {
        true => ["downstream", "upper side", "upstream", "lower side", "downstream"],
        false => ["+x", "+y", "−x", "−y", "+x"],
    };
    for (k, side) in sides.iter().enumerate() {
        let at = [p.left + p.width * k as f64 / 4.0, p.top + p.height + 6.6];
        d.text(at, side, LABEL * 0.92, BLACK, Anchor::Middle);
    }
    let below = [p.left + p.width / 2.0, p.top + p.height + 11.0];
    d.text(below, "angle (degrees)", LABEL, BLACK, Anchor::Middle);
    d.width += 5.0;
    d.height += 9.5;
    let bottom = d.height - 3.0;
    legend(&mut d, MARGIN[0], bottom, &shown);
    Some(Figure {
        name: format!("probe_{}_occupancy", slug(name)),
        title: format!("Occupancy (bound fraction) round {name}"),
        caption: caption(&sections),
        drawing: d,
        raster: false,
    })
}

/// Whether angle 0 points downstream: the fluid moves towards +x on the whole.
fn downstream(samples: &Samples) -> bool {
    let Some(frame) = samples.frames.last() else { return false };
    let sum = |axis: usize| frame.velocity.iter().map(|v| v[axis]).sum::<f64>();
    sum(0) > 2.0 * sum(1).abs()
}

fn cartesian(samples: &Samples, name: &str) -> Option<Figure> {
    let ring = is_ring(samples, name);
    let mut all: Vec<(String, Vec<Section>)> = Vec::new();
    for quantity in quantities(samples, name) {
        // Occupancy has its own figure; it tells the same as the amounts of free and bound receptors.
        let told = quantity == OCCUPANCY || free_receptor(samples, name, &quantity);
        if !(ring && told) {
            let sections = sections(samples, name, &quantity);
            all.push((quantity, sections));
        }
    }
    let largest = |sections: &[Section]| {
        sections.iter().flat_map(|s| &s.mean).filter(|v| v.is_finite()).fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    let velocity = |q: &str| matches!(q, "vx" | "vy" | "vz");
    let fastest = all.iter().filter(|q| velocity(&q.0)).map(|q| largest(&q.1)).fold(0.0, f64::max);
    // A component a hundred times smaller than another is the noise of the particles' positions.
    let before = all.len();
    all.retain(|(q, sections)| !velocity(q) || largest(sections) >= 0.01 * fastest);
    let left_out = before - all.len();
    if all.is_empty() {
        return None;
    }
    let columns = match all.len() {
        1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let width = if columns == 1 { 110.0 } else { WIDTH };
    let (mut d, frames) = grid(all.len(), columns, width, [58.0, 44.0, 34.0][columns - 1]);
    let mut shown = Vec::new();
    for ((quantity, sections), frame) in all.iter().zip(frames) {
        let p = panel(samples, name, quantity, sections, frame);
        let entries = curves(samples, &mut d, &p, sections, ring);
        if entries.len() >= shown.len() {
            shown = entries;
        }
        p.axes(&mut d, quantity);
    }
    d.height += 5.0;
    let bottom = d.height - 3.0;
    legend(&mut d, MARGIN[0], bottom, &shown);
    let what = if ring { "around" } else { "along" };
    let most = all.iter().max_by_key(|(_, s)| realizations(s))?;
    let mut words = caption(&most.1);
    let once: Vec<&str> = all
        .iter()
        .filter(|(_, s)| realizations(s) == 1 && realizations(&most.1) > 1)
        .map(|(q, _)| q.as_str())
        .collect();
    if !once.is_empty() {
        words += &format!(" {}: of the one flow that serves every realization.", once.join(", "));
    }
    if left_out > 0 {
        words += " Velocity components below 1 % of the largest are left out.";
    }
    Some(Figure {
        name: format!("probe_{}", slug(name)),
        title: format!("Quantities {what} {name}"),
        caption: words,
        drawing: d,
        raster: false,
    })
}

/// Whether a quantity on a ring with occupancies is the concentration of an immobile species.
fn free_receptor(samples: &Samples, name: &str, quantity: &str) -> bool {
    let immobile = samples.record.species.iter().any(|s| s.name == quantity && s.diffusion == 0.0);
    immobile && quantities(samples, name).iter().any(|q| q == OCCUPANCY)
}

fn realizations(sections: &[Section]) -> usize {
    sections.iter().map(|s| s.realizations).max().unwrap_or(0)
}

fn caption(sections: &[Section]) -> String {
    match realizations(sections) {
        0 | 1 => "One realization.".into(),
        n if n < BAND => format!("Mean of {n} realizations."),
        n => format!("Mean of {n} realizations; shaded: 5 to 95 % of them."),
    }
}

fn panel(samples: &Samples, name: &str, quantity: &str, sections: &[Section], frame: [f64; 4]) -> Panel {
    let [left, top, width, height] = frame;
    let values = sections.iter().flat_map(|b| b.low.iter().chain(&b.high).chain(&b.mean)).copied();
    let y = Axis::covering(values, &unit(samples, name, quantity), quantity).with_air();
    let mut x = Axis::covering(sections.iter().flat_map(|b| b.s.iter().copied()), "m", "distance");
    if is_ring(samples, name) {
        let scale = Scale { factor: 360.0 / TURN, unit: "degrees".into() };
        x = Axis { low: 0.0, high: TURN, scale, label: "angle".into(), step: Some(90.0) };
    }
    Panel { left, top, width, height, x, y }
}

fn curves(
    samples: &Samples,
    d: &mut Drawing,
    p: &Panel,
    sections: &[Section],
    ring: bool,
) -> Vec<(String, Colour, f64)> {
    let mut shown = Vec::new();
    for (k, b) in sections.iter().enumerate() {
        // The light end of viridis vanishes on white.
        let colour = viridis(0.85 * k as f64 / (sections.len() - 1).max(1) as f64);
        // A ring closes: the last sector stands before the first and the first behind the last.
        let closed = |values: &[f64], turn: f64| -> Vec<f64> {
            let before = values.last().filter(|_| ring).map(|v| v - turn);
            let after = values.first().filter(|_| ring).map(|v| v + turn);
            before.into_iter().chain(values.iter().copied()).chain(after).collect()
        };
        let (s, low, high, mean) = if ring {
            cut(&closed(&b.s, TURN), [&closed(&b.low, 0.0), &closed(&b.high, 0.0), &closed(&b.mean, 0.0)])
        } else {
            (b.s.clone(), b.low.clone(), b.high.clone(), b.mean.clone())
        };
        if b.realizations >= BAND {
            p.band(d, &s, &low, &high, colour.faint(0.18));
        }
        p.curve(d, &s, &mean, 0.4, colour);
        shown.push((clock(samples).show(b.time), colour, 0.5));
    }
    shown
}

type Cut = (Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>);

/// Curves over -… to 2π + … cut to 0 … 2π, interpolated at both ends.
fn cut(s: &[f64], values: [&[f64]; 3]) -> Cut {
    let mut out: [Vec<f64>; 4] = Default::default();
    let mut push = |at: f64, row: [f64; 3]| {
        out[0].push(at);
        row.iter().zip(&mut out[1..]).for_each(|(v, list)| list.push(*v));
    };
    let row = |k: usize| values.map(|v| v[k]);
    for k in 0..s.len() {
        if (0.0..=TURN).contains(&s[k]) {
            push(s[k], row(k));
        }
        for edge in [0.0, TURN] {
            if k + 1 < s.len() && s[k] < edge && edge < s[k + 1] {
                let part = (edge - s[k]) / (s[k + 1] - s[k]);
                push(edge, [0, 1, 2].map(|v| values[v][k] + part * (values[v][k + 1] - values[v][k])));
            }
        }
    }
    let [s, low, high, mean] = out;
    (s, low, high, mean)
}

pub(super) fn is_ring(samples: &Samples, name: &str) -> bool {
    samples.record.probes.iter().any(|p| p.name == name && p.kind == "ring")
}

pub(super) fn unit(samples: &Samples, name: &str, quantity: &str) -> String {
    let probe = samples.record.probes.iter().find(|p| p.name == name);
    probe.and_then(|p| p.quantities.get(quantity)).cloned().unwrap_or_default()
}

pub(super) fn quantities(samples: &Samples, name: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for row in samples.probes.iter().filter(|r| r.probe == name) {
        if !out.contains(&row.quantity) {
            out.push(row.quantity.clone());
        }
    }
    out
}
