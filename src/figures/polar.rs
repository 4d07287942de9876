//! Quantities round a ring, drawn round a circle.

use super::colours::{GREY, PALE, PALETTE};
use super::drawing::{Anchor, HAIR, LABEL, TITLE};
use super::panel::range;
use super::probes::{BAND, OCCUPANCY, is_ring, quantities, unit};
use super::sections::sections;
use super::ticks::ticks;
use super::{Drawing, Figure, Samples, WIDTH, clock, slug};
use crate::quantity::readable::{Scale, significant};

/// Ligand and occupancy at the last time; without receptors, every quantity.
pub fn polar(samples: &Samples, name: &str) -> Option<Figure> {
    let mut quantities = quantities(samples, name);
    if quantities.iter().any(|q| q == OCCUPANCY) {
        let mobile = |q: &String| samples.record.species.iter().any(|s| s.name == *q && s.diffusion > 0.0);
        quantities.retain(|q| q == OCCUPANCY || mobile(q));
    }
    if !is_ring(samples, name) || quantities.is_empty() {
        return None;
    }
    let columns = match quantities.len() {
        1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let cell = (WIDTH / columns as f64).min(66.0);
    let row = cell + 8.0;
    let mut d = Drawing::new(cell * columns as f64, quantities.len().div_ceil(columns) as f64 * row);
    let (mut time, mut realizations) = (0.0, 0);
    for (k, quantity) in quantities.iter().enumerate() {
        let Some(b) = sections(samples, name, quantity).pop() else { continue };
        (time, realizations) = (b.time, b.realizations);
        let centre =
            [(k % columns) as f64 * cell + cell / 2.0, (k / columns) as f64 * row + cell / 2.0 + 7.0];
        let radius = cell / 2.0 - 9.0;
        let (low, high) = range(b.low.iter().chain(&b.high).copied());
        let scale = Scale::choose(low.abs().max(high.abs()), &unit(samples, name, quantity));
        let low = low.min(0.0) * scale.factor;
        // The outer circle is the first round value that holds everything.
        let rings = ticks(low, high * scale.factor * 1.3, 6);
        let step = if rings.len() > 1 { rings[1].0 - rings[0].0 } else { 1.0 };
        let edge = ((high * scale.factor / step - 1e-9).ceil() * step).max(low + step);
        let place = |s: f64, v: f64| {
            let r = radius * ((v - low) / (edge - low)).clamp(0.0, 1.0);
            [centre[0] + r * s.cos(), centre[1] - r * s.sin()]
        };
        for (v, _) in rings.iter().filter(|t| t.0 > low && t.0 <= edge * (1.0 + 1e-9)) {
            let circle: Vec<[f64; 2]> =
                (0..=72).map(|i| place(f64::from(i) * 5f64.to_radians(), *v)).collect();
            d.line(&circle, HAIR, PALE);
        }
        for quarter in 0..4 {
            let angle = f64::from(quarter) * std::f64::consts::FRAC_PI_2;
            d.line(&[centre, place(angle, edge)], HAIR, PALE);
            let far = radius + 4.0;
            let at = [centre[0] + far * angle.cos(), centre[1] - far * angle.sin()];
            d.text(at, &format!("{}°", quarter * 90), LABEL, GREY, Anchor::Middle);
        }
        let closed = |values: &[f64]| -> Vec<[f64; 2]> {
            let at = |(&s, &v): (&f64, &f64)| place(s, v * scale.factor);
            let points = b.s.iter().zip(values).map(at);
            points.chain(b.s.first().zip(values.first()).map(at)).collect()
        };
        if b.realizations >= BAND {
            let outer = closed(&b.high);
            d.area(
                &outer.into_iter().chain(closed(&b.low).into_iter().rev()).collect::<Vec<_>>(),
                PALETTE[0].faint(0.2),
            );
        }
        d.line(&closed(&b.mean), 0.45, PALETTE[0]);
        let unit = if scale.unit.is_empty() { String::new() } else { format!(" {}", scale.unit) };
        let words = format!("circles every {}{unit}", significant(step, 3));
        d.text(
            [centre[0], centre[1] - radius - 13.0],
            quantity,
            TITLE,
            super::colours::BLACK,
            Anchor::Middle,
        );
        d.text([centre[0], centre[1] - radius - 8.8], &words, LABEL * 0.92, GREY, Anchor::Middle);
    }
    let band = if realizations >= BAND { "; shaded: 5 to 95 % of them" } else { "" };
    let who = if realizations > 1 {
        format!("Mean of {realizations} realizations{band}.")
    } else {
        "One realization.".into()
    };
    Some(Figure {
        name: format!("probe_{}_polar", slug(name)),
        title: format!("{name} at {}", clock(samples).show(time)),
        caption: format!("{who} The centre is zero, the angle that of the place."),
        drawing: d,
        raster: false,
    })
}
