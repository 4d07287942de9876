//! Fields on particles: concentration of each mobile species, speed, pressure.

use super::colours::{Colour, diverging, viridis};
use super::painting::{Bar, Field, colour_bar, draw_arrows, map, paint};
use super::panel::range;
use super::solids::is_strained;
use super::{Drawing, Figure, Samples, WIDTH, clock, moments, slug};
use crate::chemistry::AVOGADRO;
use crate::statistics::quantile;
use crate::tables::ParticleFrame;

/// Room for the colour bar, mm.
const BAR: f64 = 20.0;

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
        let times: Vec<f64> = samples.frames.iter().map(|f| f.time).collect();
        let fields: Vec<Field<'_>> =
            moments(samples, &times).into_iter().map(|f| field(samples, &samples.frames[f], k)).collect();
        let every: Vec<f64> =
            fields.iter().flat_map(|f| f.values.iter().copied()).filter(|v| v.is_finite()).collect();
        if every.iter().all(|v| *v == 0.0) {
            return None;
        }
        let label = format!("[{name}]");
        let bar = bar(&fields, &label);
        let saturated = every.iter().any(|v| *v > bar.high);
        let drawing = snapshots(samples, &fields, &bar, false);
        let mut caption =
            "One realization; amount over particle volume. Grey: particles the species does not enter."
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

/// Concentration of species `k` of the frames; NaN in groups it never stands in.
pub(super) fn field<'a>(samples: &Samples, frame: &'a ParticleFrame, k: usize) -> Field<'a> {
    let (columns, species) = (&samples.series.columns, samples.species.get(k));
    let listed: Vec<&str> = (0..columns.len())
        .filter(|&c| Some(&columns.species[c]) == species)
        .map(|c| columns.groups[c].as_str())
        .collect();
    let several = listed.iter().any(|g| *g != "all");
    let lives = |i: usize| !several || listed.contains(&frame.group_name(i));
    let value = |i: usize| if lives(i) { concentration(frame, k, i) } else { f64::NAN };
    Field { frame, values: (0..frame.len()).map(value).collect() }
}

/// Colours from zero. Single molecules make single bright voxels: the scale ends where all but 0.5 % of them do.
pub(super) fn bar<'a>(fields: &[Field<'_>], label: &'a str) -> Bar<'a> {
    let every: Vec<f64> =
        fields.iter().flat_map(|f| f.values.iter().copied()).filter(|v| v.is_finite()).collect();
    let high = quantile(&every, 0.995).max(f64::MIN_POSITIVE);
    Bar { low: 0.0, high, unit: "mol/m^3", label, colour: viridis }
}

/// Speed with arrows, and pressure, in the last frame.
pub fn flow(samples: &Samples) -> Vec<Figure> {
    let mut out = Vec::new();
    let Some(frame) = samples.frames.last().filter(|_| samples.record.domain.dimensions > 1) else {
        return out;
    };
    // A zone marks a part of the fluid, or of a solid.
    let fluid = |i: usize| {
        if is_strained(frame, i) {
            return false;
        }
        let name = frame.group_name(i);
        let flows = |material: &str| material == "fluid" || material == "zone";
        samples.record.domain.groups.iter().any(|g| g.name == name && flows(&g.material))
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
                "Speed (colour) and direction (arrows, length by speed) {}.{}",
                instant(samples, frame.time),
                slice_words(samples)
            ),
            drawing: snapshots(samples, &field, &bar, true),
            raster: true,
        });
    }
    let value = |i: usize| if fluid(i) { frame.pressure[i] } else { f64::NAN };
    let pressure: Vec<f64> = (0..frame.len().min(frame.pressure.len())).map(value).collect();
    let (low, high) = range(pressure.iter().copied());
    let flows = samples.record.domain.groups.iter().any(|group| group.material == "fluid");
    if flows && pressure.iter().any(|p| p.is_finite() && *p != 0.0) {
        let largest = low.abs().max(high.abs());
        let both = low < -0.05 * largest && high > 0.05 * largest;
        let (low, high, colour): (_, _, fn(f64) -> Colour) =
            if both { (-largest, largest, diverging) } else { (low, high, viridis) };
        let bar = Bar { low, high, unit: "Pa", label: "pressure", colour };
        out.push(Figure {
            name: "pressure".into(),
            title: "Pressure".into(),
            caption: format!(
                "Pressure of the fluid {}, relative to its background.{}",
                instant(samples, frame.time),
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

/// `at the end`, or at which time before it.
pub(super) fn instant(samples: &Samples, time: f64) -> String {
    let end = samples.record.times.last().copied().unwrap_or(time);
    if time >= end * (1.0 - 1e-9) { "at the end".into() } else { format!("at {}", clock(samples).show(time)) }
}

fn slice_words(samples: &Samples) -> &'static str {
    if samples.record.domain.dimensions == 3 { " Middle layer, seen along z." } else { "" }
}

fn snapshots(samples: &Samples, fields: &[Field<'_>], bar: &Bar<'_>, arrows: bool) -> Drawing {
    let unit = map(samples, 0.0, 0.0, 1.0);
    // Tall domains and three square ones stand side by side, wide ones in two columns.
    let columns = if fields.len() == 1 {
        1
    } else if unit.height > 1.3 || (unit.height > 0.7 && fields.len() == 3) {
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
