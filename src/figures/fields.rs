//! Fields on particles: concentration of each mobile species, speed, pressure.

use super::colours::{BLACK, Colour, PALE, WHITE, diverging, viridis};
use super::drawing::{Anchor, HAIR, LABEL, text_width};
use super::panel::{Axis, Panel, range};
use super::ticks::ticks;
use super::{Drawing, Figure, Samples, WIDTH, clock, slug, spread};
use crate::chemistry::AVOGADRO;
use crate::quantity::readable::Scale;
use crate::statistics::quantile;
use crate::tables::ParticleFrame;

/// Most snapshots of one field.
const SNAPSHOTS: usize = 4;
/// Room for the colour bar, mm.
const BAR: f64 = 20.0;

/// What is coloured: value per particle; not a number is painted pale.
struct Field<'a> {
    frame: &'a ParticleFrame,
    values: Vec<f64>,
}

/// Snapshots of the concentration of every species that diffuses.
pub fn concentrations(samples: &Samples) -> Vec<Figure> {
    if samples.record.domain.dimensions < 2 {
        return Vec::new();
    }
    let figure = |(k, name): (usize, &String)| -> Option<Figure> {
        let species = samples.record.species.iter().find(|s| s.name == *name)?;
        if species.diffusion == 0.0 {
            return None;
        }
        let fields: Vec<Field<'_>> = spread(samples.frames.len(), SNAPSHOTS)
            .into_iter()
            .map(|f| {
                let frame = &samples.frames[f];
                let lives = |i: usize| {
                    species.only_in.is_empty() || species.only_in.iter().any(|g| g == frame.group_name(i))
                };
                let value = |i: usize| if lives(i) { concentration(frame, k, i) } else { f64::NAN };
                Field { frame, values: (0..frame.len()).map(value).collect() }
            })
            .collect();
        let every: Vec<f64> =
            fields.iter().flat_map(|f| f.values.iter().copied()).filter(|v| v.is_finite()).collect();
        if every.iter().all(|v| *v == 0.0) {
            return None;
        }
        // Single molecules make single bright voxels; the scale ends where all but 0.5 % of them do.
        let high = quantile(&every, 0.995).max(f64::MIN_POSITIVE);
        let saturated = every.iter().any(|v| *v > high);
        let bar = Bar { low: 0.0, high, unit: "mol/m^3", label: &format!("[{name}]"), colour: viridis };
        let drawing = snapshots(samples, &fields, &bar, false);
        let mut caption =
            "One realization; amount over particle volume. Grey: particles the species cannot enter."
                .to_string();
        if saturated {
            caption += " The 0.5 % highest values share the last colour.";
        }
        caption += slice_words(samples);
        let title = format!("Concentration of {name}");
        Some(Figure { name: format!("field_{}", slug(name)), title, caption, drawing, raster: true })
    };
    samples.species.iter().enumerate().filter_map(figure).collect()
}

/// Speed with arrows, and pressure, in the last frame.
pub fn flow(samples: &Samples) -> Vec<Figure> {
    let mut out = Vec::new();
    let Some(frame) = samples.frames.last().filter(|_| samples.record.domain.dimensions > 1) else {
        return out;
    };
    let fluid = |i: usize| {
        let name = frame.group_name(i);
        samples.record.domain.groups.iter().any(|g| g.name == name && g.material == "fluid")
    };
    let speed: Vec<f64> =
        frame.velocity.iter().map(|v| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()).collect();
    let fastest = range(speed.iter().copied()).1;
    if speed.iter().any(|v| *v > 0.0) {
        // What rests and is not fluid is ground, not slow flow.
        let ground = |i: usize| speed[i] == 0.0 && !fluid(i);
        let values = (0..frame.len()).map(|i| if ground(i) { f64::NAN } else { speed[i] }).collect();
        let field = [Field { frame, values }];
        let bar = Bar { low: 0.0, high: fastest, unit: "m/s", label: "speed", colour: viridis };
        out.push(Figure {
            name: "velocity".into(),
            title: "Velocity".into(),
            caption: format!(
                "Speed (colour) and direction (arrows, length by speed) at the end.{}",
                slice_words(samples)
            ),
            drawing: snapshots(samples, &field, &bar, true),
            raster: true,
        });
    }
    let value = |i: usize| if fluid(i) { frame.pressure[i] } else { f64::NAN };
    let pressure: Vec<f64> = (0..frame.len().min(frame.pressure.len())).map(value).collect();
    let (low, high) = range(pressure.iter().copied());
    if pressure.iter().any(|p| p.is_finite() && *p != 0.0) {
        let largest = low.abs().max(high.abs());
        let both = low < -0.05 * largest && high > 0.05 * largest;
        let (low, high, colour): (_, _, fn(f64) -> Colour) =
            if both { (-largest, largest, diverging) } else { (low, high, viridis) };
        let bar = Bar { low, high, unit: "Pa", label: "pressure", colour };
        out.push(Figure {
            name: "pressure".into(),
            title: "Pressure".into(),
            caption: format!(
                "Pressure of the fluid at the end, relative to its background.{}",
                slice_words(samples)
            ),
            drawing: snapshots(samples, &[Field { frame, values: pressure }], &bar, false),
            raster: true,
        });
    }
    out
}

/// mol/m³ of species `k` in particle `i`; NaN where the volume is not known.
pub(super) fn concentration(frame: &ParticleFrame, k: usize, i: usize) -> f64 {
    let volume = frame.volume.get(i).copied().unwrap_or(f64::NAN);
    let amount = frame.amounts.get(k).and_then(|a| a.get(i)).copied().unwrap_or(f64::NAN);
    if volume > 0.0 { amount / (AVOGADRO * volume) } else { f64::NAN }
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

fn slice_words(samples: &Samples) -> &'static str {
    if samples.record.domain.dimensions == 3 { " Middle layer, seen along z." } else { "" }
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

struct Bar<'a> {
    low: f64,
    high: f64,
    unit: &'a str,
    label: &'a str,
    colour: fn(f64) -> Colour,
}

fn snapshots(samples: &Samples, fields: &[Field<'_>], bar: &Bar<'_>, arrows: bool) -> Drawing {
    let unit = map(samples, 0.0, 0.0, 1.0);
    // Tall domains stand side by side, wide ones in two columns.
    let columns = if fields.len() == 1 {
        1
    } else if unit.height > 1.3 {
        fields.len()
    } else {
        2
    };
    let (left, below, above) = (15.0, 11.0, 6.0);
    let mut width = (WIDTH - BAR) / columns as f64 - left - 2.0;
    if columns == 1 {
        width = width.min(110.0 / unit.height.max(1.0));
    }
    let height = width * unit.height;
    let rows = fields.len().div_ceil(columns);
    let sheet = columns as f64 * (left + width + 2.0) + BAR;
    let mut d = Drawing::new(sheet, rows as f64 * (height + above + below));
    for (k, field) in fields.iter().enumerate() {
        let corner = [
            (k % columns) as f64 * (left + width + 2.0) + left,
            (k / columns) as f64 * (height + above + below) + above,
        ];
        let panel = map(samples, corner[0], corner[1], width);
        paint(samples, &mut d, &panel, field, bar);
        if arrows {
            draw_arrows(samples, &mut d, &panel, field.frame, bar.high);
        }
        panel.axes(&mut d, &clock(samples).show(field.frame.time));
    }
    let length = (d.height - above - below).min(60.0);
    colour_bar(&mut d, sheet - BAR + 2.0, above, length, bar);
    d
}

/// Every point of the sheet takes the colour of the nearest particle, no further than one and a half spacings.
fn paint(samples: &Samples, d: &mut Drawing, panel: &Panel, field: &Field<'_>, bar: &Bar<'_>) {
    /// Size of a point, mm: two pixels of the PNG.
    const POINT: f64 = 0.2;
    let frame = field.frame;
    let shown: Vec<usize> =
        (0..frame.len().min(field.values.len())).filter(|&i| in_slice(samples, frame, i)).collect();
    let cell = shown.iter().map(|&i| spacing(samples, frame, i)).fold(0.0, f64::max);
    if cell <= 0.0 {
        return;
    }
    let key = |x: f64, y: f64| ((x / cell).floor() as i64, (y / cell).floor() as i64);
    let mut cells: std::collections::HashMap<(i64, i64), Vec<usize>> = std::collections::HashMap::new();
    for &i in &shown {
        cells.entry(key(frame.position[i][0], frame.position[i][1])).or_default().push(i);
    }
    let nearest = |x: f64, y: f64| -> Option<usize> {
        let (kx, ky) = key(x, y);
        let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| (kx + a, ky + b)));
        let away = |i: usize| (frame.position[i][0] - x).powi(2) + (frame.position[i][1] - y).powi(2);
        let candidates = around.filter_map(|k| cells.get(&k)).flatten().copied();
        let near = candidates.map(|i| (away(i), i)).min_by(|a, b| a.0.total_cmp(&b.0));
        near.filter(|n| n.0 <= (1.5 * cell).powi(2)).map(|n| n.1)
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

fn draw_arrows(samples: &Samples, d: &mut Drawing, panel: &Panel, frame: &ParticleFrame, fastest: f64) {
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

fn colour_bar(d: &mut Drawing, left: f64, top: f64, length: f64, bar: &Bar<'_>) {
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
