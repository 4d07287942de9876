//! Maps of the outcome over two parameters.

use super::{Outcome, Outcomes, at_the_end, each, label, name};
use crate::figures::colours::{BLACK, viridis};
use crate::figures::drawing::{Anchor, HAIR, LABEL, TITLE, text_width};
use crate::figures::painting::{Bar, colour_bar};
use crate::figures::panel::range;
use crate::figures::{Drawing, Figure};
use crate::quantity::readable::significant;

/// Values of each parameter from which a map says more than curves.
const ENOUGH: usize = 3;
/// Longest side of a map, room on its left, above, below, and on its right with the bar of colours, mm.
const SIDE: f64 = 48.0;
const LEFT: f64 = 18.0;
const TOP: f64 = 7.0;
const BOTTOM: f64 = 11.0;
const RIGHT: f64 = 19.0;

/// A map of the mean of each species, the first parameter along x.
pub(super) fn map(outcomes: &Outcomes) -> Option<Figure> {
    let first = outcomes.species.first()?;
    let distinct = |parameter: usize| {
        let mut values = first.value(parameter);
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let sides = [distinct(0), distinct(1)];
    if sides.iter().any(|values| values.len() < ENOUGH) {
        return None;
    }
    let columns = outcomes.species.len().min(2);
    let rows = outcomes.species.len().div_ceil(columns);
    let (cell, row) = (LEFT + SIDE + RIGHT, TOP + SIDE + BOTTOM);
    let mut d = Drawing::new(columns as f64 * cell, rows as f64 * row);
    for (k, one) in outcomes.species.iter().enumerate() {
        let corner = [(k % columns) as f64 * cell + LEFT, (k / columns) as f64 * row + TOP];
        panel(&mut d, outcomes, one, &sides, corner);
    }
    let [a, b] = [0, 1].map(|k| name(&outcomes.record.parameters[k]));
    Some(Figure {
        name: "map".into(),
        title: format!("Mean outcome over {a} and {b}"),
        caption: format!(
            "Mean amounts over the whole domain {}, {}. One field for each point, whatever the distance of the values.",
            at_the_end(outcomes),
            each(outcomes)
        ),
        drawing: d,
        raster: false,
    })
}

fn panel(d: &mut Drawing, outcomes: &Outcomes, one: &Outcome, sides: &[Vec<f64>; 2], [left, top]: [f64; 2]) {
    let (low, high) = range(one.summaries.iter().map(|s| s.mean));
    let bar = Bar { low, high, unit: "molecules", label: "mean amount", colour: viridis };
    let [width, height] = [0, 1].map(|k| SIDE / sides[k].len() as f64);
    let index = |parameter: usize, value: f64| sides[parameter].iter().position(|v| *v == value);
    for (values, summary) in one.values.iter().zip(&one.summaries) {
        let (Some(i), Some(j)) = (index(0, values[0]), index(1, values[1])) else { continue };
        let part = if high > low { (summary.mean - low) / (high - low) } else { 0.5 };
        let corner = [left + i as f64 * width, top + SIDE - (j + 1) as f64 * height];
        // A shade more than the field, so that no seam shows between two.
        d.rectangle(corner, [width + 0.03, height + 0.03], viridis(part));
    }
    let ends = [[left, top], [left + SIDE, top], [left + SIDE, top + SIDE], [left, top + SIDE], [left, top]];
    d.line(&ends, HAIR, BLACK);
    let written = |values: &[f64]| values.iter().map(|v| significant(*v, 3)).collect::<Vec<_>>();
    let (across, up) = (written(&sides[0]), written(&sides[1]));
    let need = across.iter().map(|t| text_width(t, LABEL) + 2.0).fold(0.0, f64::max);
    for i in (0..across.len()).step_by((need / width).ceil().max(1.0) as usize) {
        let x = left + (i as f64 + 0.5) * width;
        d.line(&[[x, top + SIDE], [x, top + SIDE + 1.0]], HAIR, BLACK);
        d.text([x, top + SIDE + 3.0], &across[i], LABEL, BLACK, Anchor::Middle);
    }
    let mut widest: f64 = 0.0;
    for j in (0..up.len()).step_by((4.0 / height).ceil().max(1.0) as usize) {
        let y = top + SIDE - (j as f64 + 0.5) * height;
        d.line(&[[left - 1.0, y], [left, y]], HAIR, BLACK);
        d.text([left - 1.6, y], &up[j], LABEL, BLACK, Anchor::End);
        widest = widest.max(text_width(&up[j], LABEL));
    }
    let parameters = &outcomes.record.parameters;
    d.text([left + SIDE / 2.0, top + SIDE + 6.8], &label(&parameters[0]), LABEL, BLACK, Anchor::Middle);
    d.text_upwards([left - widest - 3.8, top + SIDE / 2.0], &label(&parameters[1]), LABEL, BLACK);
    d.text([left, top - 2.6], &one.species, TITLE, BLACK, Anchor::Start);
    colour_bar(d, left + SIDE + 2.0, top, SIDE, &bar);
}
