//! Points of solids, and solids as a whole, against time.

use super::panel::grid;
use super::probes::{quantities, unit};
use super::time::{Curves, draw_curves, words};
use super::{Figure, Samples, WIDTH, slug};
use std::collections::BTreeMap;

/// A figure of each point and each solid: a panel a quantity.
pub fn histories(samples: &Samples) -> Vec<Figure> {
    let kinds = ["point", "solid"];
    let probes = samples.record.probes.iter().filter(|probe| kinds.contains(&probe.kind.as_str()));
    probes.filter_map(|probe| history(samples, &probe.name, &probe.kind)).collect()
}

fn history(samples: &Samples, name: &str, kind: &str) -> Option<Figure> {
    let mut all: Vec<(Vec<f64>, Curves)> = Vec::new();
    for quantity in quantities(samples, name) {
        let mut by_realization: BTreeMap<u32, Vec<(f64, f64)>> = BTreeMap::new();
        for row in samples.probes.iter().filter(|row| row.probe == name && row.quantity == quantity) {
            let values = row.value.first().copied().unwrap_or(f64::NAN);
            by_realization.entry(row.realization).or_default().push((row.time, values));
        }
        let times: Vec<f64> = by_realization.values().next()?.iter().map(|(time, _)| *time).collect();
        let values: Vec<Vec<f64>> = by_realization
            .into_values()
            .filter(|values| values.len() == times.len())
            .map(|values| values.into_iter().map(|(_, value)| value).collect())
            .collect();
        if times.len() < 2 {
            return None;
        }
        let title = quantity.replace('_', " ");
        all.push((
            times,
            Curves { title, values, unit: unit(samples, name, &quantity), label: String::new() },
        ));
    }
    if all.is_empty() {
        return None;
    }
    let columns = match all.len() {
        1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let width = if columns == 1 { 110.0 } else { WIDTH };
    let (mut drawing, frames) = grid(all.len(), columns, width, [58.0, 44.0, 34.0][columns - 1]);
    for ((times, curves), frame) in all.iter().zip(frames) {
        draw_curves(&mut drawing, times, curves, frame, None);
    }
    let caption = match all.first()?.1.values.len() {
        1 if samples.record.finished > 1 => "Of the one motion that serves every realization.".into(),
        1 => "One realization.".into(),
        _ => words(samples),
    };
    let what = if kind == "point" { "Displacement and velocity of" } else { "The solid" };
    Some(Figure {
        name: format!("{kind}_{}", slug(name)),
        title: format!("{what} {name}"),
        caption,
        drawing,
        raster: false,
    })
}
