//! Painting values per particle onto a map of the domain.

use super::colours::{BLACK, Colour, PALE, WHITE};
use super::drawing::{Anchor, HAIR, LABEL, text_width};
use super::panel::{Axis, Panel};
use super::ticks::ticks;
use super::{Drawing, Samples};
use crate::quantity::readable::Scale;
use crate::tables::ParticleFrame;

/// What is coloured: value per particle; not a number is painted pale.
pub(super) struct Field<'a> {
    pub frame: &'a ParticleFrame,
    pub values: Vec<f64>,
}

/// What colours mean: range in SI, unit, label.
pub(super) struct Bar<'a> {
    pub low: f64,
    pub high: f64,
    pub unit: &'a str,
    pub label: &'a str,
    pub colour: fn(f64) -> Colour,
}

/// Particle spacing, m, from its volume: the side of a square of the domain's depth, or of a cube.
pub(super) fn spacing(samples: &Samples, frame: &ParticleFrame, i: usize) -> f64 {
    let domain = &samples.record.domain;
    let volume = frame.volume.get(i).copied().unwrap_or(0.0);
    match domain.dimensions {
        2 if domain.thickness > 0.0 => (volume / domain.thickness).sqrt(),
        _ => volume.cbrt(),
    }
}

/// Whether a particle is shown: all in two dimensions, the middle layer in three.
pub(super) fn in_slice(samples: &Samples, frame: &ParticleFrame, i: usize) -> bool {
    let domain = &samples.record.domain;
    let (Some(low), Some(high)) = (domain.min.get(2), domain.max.get(2)) else { return true };
    domain.dimensions < 3
        || (frame.position[i][2] - 0.5 * (low + high)).abs() <= 0.51 * spacing(samples, frame, i)
}

/// A panel of the domain to scale with its corner at (left, top), `width` mm wide.
pub(super) fn map(samples: &Samples, left: f64, top: f64, width: f64) -> Panel {
    let domain = &samples.record.domain;
    let side =
        |a: usize| (domain.min.get(a).copied().unwrap_or(0.0), domain.max.get(a).copied().unwrap_or(1.0));
    let ((x0, x1), (y0, y1)) = (side(0), side(1));
    let scale = Scale::choose((x1 - x0).abs().max((y1 - y0).abs()), "m");
    let axis =
        |low, high, label: &str| Axis { low, high, scale: scale.clone(), label: label.into(), step: None };
    let height = width * (y1 - y0) / (x1 - x0);
    Panel { left, top, width, height, x: axis(x0, x1, "x"), y: axis(y0, y1, "y") }
}

/// Walls at rest whose outlines are known: which particles are theirs, and the outlines, m.
struct Walls<'a> {
    own: Vec<bool>,
    outlines: Vec<&'a [[f64; 2]]>,
}

impl<'a> Walls<'a> {
    /// Those whose particles lie within their outlines, all but a few.
    fn of(samples: &'a Samples, frame: &ParticleFrame) -> Walls<'a> {
        const FEW: f64 = 0.02;
        let mut found = Walls { own: vec![false; frame.len()], outlines: Vec::new() };
        let walls = samples.record.domain.groups.iter().filter(|g| g.material == "wall");
        for group in walls.filter(|g| !g.outlines.is_empty()) {
            let outlines: Vec<&[[f64; 2]]> = group.outlines.iter().map(Vec::as_slice).collect();
            let members: Vec<usize> =
                (0..frame.len()).filter(|&i| frame.group_name(i) == group.name).collect();
            let outside =
                members.iter().filter(|&&i| !holds(&outlines, frame.position[i][0], frame.position[i][1]));
            if outside.count() as f64 <= FEW * members.len() as f64 {
                members.iter().for_each(|&i| found.own[i] = true);
                found.outlines.extend(outlines);
            }
        }
        found
    }

    /// Whether a particle and a point are both of the walls, or both not.
    fn agree(&self, i: usize, inside: bool) -> bool {
        self.own[i] == inside
    }

    fn hold(&self, x: f64, y: f64) -> bool {
        holds(&self.outlines, x, y)
    }
}

/// Whether a point lies within an odd number of closed polygons.
fn holds(outlines: &[&[[f64; 2]]], x: f64, y: f64) -> bool {
    let crossings = |outline: &[[f64; 2]]| {
        let edges = outline.windows(2).filter(|edge| (edge[0][1] > y) != (edge[1][1] > y));
        let at = |[a, b]: [[f64; 2]; 2]| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        edges.filter(|edge| at([edge[0], edge[1]]) > x).count()
    };
    outlines.iter().map(|outline| crossings(outline)).sum::<usize>() % 2 == 1
}

/// Every point of the sheet takes the colour of the nearest particle, in walls at rest of theirs and outside of the others;
/// no further than one and a half spacings; where nothing moves, about as far as the corner of its square or cube. In three
/// dimensions the sheet is the middle plane.
pub(super) fn paint(samples: &Samples, d: &mut Drawing, panel: &Panel, field: &Field<'_>, bar: &Bar<'_>) {
    /// Size of a point, mm: two pixels of the PNG.
    const POINT: f64 = 0.2;
    let frame = field.frame;
    let all = || 0..frame.len().min(field.values.len());
    let solid = samples.record.domain.dimensions == 3;
    let reach = match (samples.record.steps.fluid.is_some(), solid) {
        (true, _) => 1.5,
        (false, true) => 0.9,
        (false, false) => 0.75,
    };
    // How far a particle lies before or behind the sheet, m.
    let domain = &samples.record.domain;
    let middle = if solid { 0.5 * (domain.min[2] + domain.max[2]) } else { 0.0 };
    let aside = |i: usize| if solid { frame.position[i][2] - middle } else { 0.0 };
    let near = |i: &usize| aside(*i).abs() <= reach * spacing(samples, frame, *i);
    let shown: Vec<usize> = all().filter(near).collect();
    let cell = shown.iter().map(|&i| spacing(samples, frame, i)).fold(0.0, f64::max);
    if cell <= 0.0 {
        return;
    }
    let walls = Walls::of(samples, frame);
    let key = |x: f64, y: f64| ((x / cell).floor() as i64, (y / cell).floor() as i64);
    let mut cells: std::collections::HashMap<(i64, i64), Vec<usize>> = std::collections::HashMap::new();
    for &i in &shown {
        cells.entry(key(frame.position[i][0], frame.position[i][1])).or_default().push(i);
    }
    let nearest = |x: f64, y: f64| -> Option<usize> {
        let (kx, ky) = key(x, y);
        let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| (kx + a, ky + b)));
        let away = |i: usize| {
            (frame.position[i][0] - x).powi(2) + (frame.position[i][1] - y).powi(2) + aside(i).powi(2)
        };
        let inside = walls.hold(x, y);
        let candidates = around.filter_map(|k| cells.get(&k)).flatten().copied();
        let candidates = candidates.filter(|&i| walls.agree(i, inside));
        let near = candidates.map(|i| (away(i), i)).min_by(|a, b| a.0.total_cmp(&b.0));
        near.filter(|n| n.0 <= (reach * cell).powi(2)).map(|n| n.1)
    };
    let (columns, rows) = ((panel.width / POINT).ceil() as usize, (panel.height / POINT).ceil() as usize);
    for row in 0..rows {
        let top = panel.top + row as f64 * POINT;
        let high = POINT.min(panel.top + panel.height - top);
        let y = panel.y.high - (row as f64 + 0.5) * POINT / panel.height * (panel.y.high - panel.y.low);
        let at = |c: usize| {
            let x = panel.x.low + (c as f64 + 0.5) * POINT / panel.width * (panel.x.high - panel.x.low);
            nearest(x, y)
        };
        // Neighbouring points of one particle become one rectangle.
        let (mut start, mut current) = (0, at(0));
        for c in 1..=columns {
            let next = if c < columns { at(c) } else { None };
            if c < columns && next == current {
                continue;
            }
            if let Some(i) = current {
                let left = panel.left + start as f64 * POINT;
                let right = (panel.left + c as f64 * POINT).min(panel.left + panel.width);
                let value = field.values[i];
                let part = (value - bar.low) / (bar.high - bar.low);
                let colour = if value.is_finite() { (bar.colour)(part) } else { PALE };
                d.rectangle([left, top], [right - left, high], colour);
            }
            (start, current) = (c, next);
        }
    }
}

/// Arrows of the mean velocity of each cell of a square grid.
pub(super) fn draw_arrows(
    samples: &Samples,
    d: &mut Drawing,
    panel: &Panel,
    frame: &ParticleFrame,
    fastest: f64,
) {
    const ACROSS: f64 = 22.0;
    let cell = (panel.x.high - panel.x.low) / ACROSS;
    let mut cells: std::collections::BTreeMap<(i64, i64), [f64; 5]> = std::collections::BTreeMap::new();
    // What rests would shorten the arrows beside it.
    let moves = |i: usize| frame.velocity[i] != [0.0; 3];
    for i in (0..frame.len()).filter(|&i| moves(i) && in_slice(samples, frame, i)) {
        let ([x, y, _], [u, v, _]) = (frame.position[i], frame.velocity[i]);
        let key = (((x - panel.x.low) / cell) as i64, ((y - panel.y.low) / cell) as i64);
        let sum = cells.entry(key).or_default();
        for (s, value) in sum.iter_mut().zip([x, y, u, v, 1.0]) {
            *s += value;
        }
    }
    for [x, y, u, v, n] in cells.into_values() {
        let speed = (u * u + v * v).sqrt() / n;
        if speed < 0.02 * fastest {
            continue;
        }
        let length = panel.width / ACROSS * 0.85 * (speed / fastest).sqrt();
        let (ex, ey) = (u / n / speed, -v / n / speed);
        let [cx, cy] = panel.at(x / n, y / n);
        // All of it on the sheet.
        let within = |c: f64, half: f64, low: f64, size: f64| {
            (c - low).min(size - half).max(half.min(0.5 * size)) + low
        };
        let cx = within(cx, (0.5 * ex * length).abs(), panel.left, panel.width);
        let cy = within(cy, (0.5 * ey * length).abs(), panel.top, panel.height);
        let tip = [cx + ex * length / 2.0, cy + ey * length / 2.0];
        let tail = [cx - ex * length / 2.0, cy - ey * length / 2.0];
        let head = (0.4 * length).min(1.3);
        let barb = |side: f64| {
            [tip[0] - head * ex + side * 0.4 * head * ey, tip[1] - head * ey - side * 0.4 * head * ex]
        };
        d.line(&[tail, tip], 0.2, WHITE);
        d.area(&[tip, barb(1.0), barb(-1.0)], WHITE);
    }
}

/// The bar beside a map, its upper left corner at (left, top).
pub(super) fn colour_bar(d: &mut Drawing, left: f64, top: f64, length: f64, bar: &Bar<'_>) {
    const STEPS: usize = 100;
    let scale = Scale::choose(bar.low.abs().max(bar.high.abs()), bar.unit);
    for k in 0..STEPS {
        let part = (k as f64 + 0.5) / STEPS as f64;
        let y = top + length * (1.0 - (k + 1) as f64 / STEPS as f64);
        d.rectangle([left, y], [3.0, length / STEPS as f64 + 0.05], (bar.colour)(part));
    }
    d.line(
        &[[left, top], [left + 3.0, top], [left + 3.0, top + length], [left, top + length], [left, top]],
        HAIR,
        BLACK,
    );
    let mut widest: f64 = 0.0;
    if bar.high > bar.low {
        for (value, label) in ticks(bar.low * scale.factor, bar.high * scale.factor, (length / 9.0) as usize)
        {
            let part = (value / scale.factor - bar.low) / (bar.high - bar.low);
            let y = top + length * (1.0 - part.clamp(0.0, 1.0));
            d.line(&[[left + 3.0, y], [left + 3.8, y]], HAIR, BLACK);
            d.text([left + 4.4, y], &label, LABEL, BLACK, Anchor::Start);
            widest = widest.max(text_width(&label, LABEL));
        }
    }
    d.text_upwards([left + widest + 7.2, top + length / 2.0], &scale.label(bar.label), LABEL, BLACK);
}
