//! The set-up to scale: domain, groups at the start, outlines, probes.

use super::colours::{BLACK, Colour, palette};
use super::drawing::{Anchor, LABEL, text_width};
use super::painting::{in_slice, map, spacing};
use super::solids::is_outline;
use super::{Drawing, Figure, Samples, WIDTH};

/// The set-up of a model in two or three dimensions.
pub fn setup(samples: &Samples) -> Option<Figure> {
    let domain = &samples.record.domain;
    if domain.dimensions < 2 || domain.min.len() < 2 || domain.max.len() < 2 {
        return None;
    }
    let (left, top) = (15.0, 4.0);
    let shape = map(samples, 0.0, 0.0, 1.0).height;
    let width = (WIDTH - left - 4.0).min(85.0 / shape.max(0.1));
    let panel = map(samples, left, top, width);
    let mut d = Drawing::new(left + width + 4.0, top + panel.height + 10.0);
    let mm = width / (panel.x.high - panel.x.low);
    // The fluid is the pale ground, everything else carries the palette.
    let mut solids = 0;
    let colours: Vec<(String, Colour)> = domain
        .groups
        .iter()
        .map(|g| {
            let colour = if g.material == "fluid" {
                Colour::hex(0xcf_e3f1)
            } else {
                solids += 1;
                palette(solids)
            };
            (g.name.clone(), colour)
        })
        .collect();
    if let Some(frame) = samples.frames.first() {
        for i in (0..frame.len()).filter(|&i| in_slice(samples, frame, i)) {
            let Some((_, colour)) = colours.iter().find(|(n, _)| n == frame.group_name(i)) else { continue };
            let radius = (0.42 * spacing(samples, frame, i) * mm).max(0.1);
            d.circle(panel.at(frame.position[i][0], frame.position[i][1]), radius, *colour);
        }
    }
    for (group, (_, colour)) in domain.groups.iter().zip(&colours) {
        for outline in &group.outlines {
            let mut points: Vec<[f64; 2]> = outline.iter().map(|p| panel.at(p[0], p[1])).collect();
            points.extend(points.first().copied());
            let edge = if group.material == "fluid" { BLACK } else { *colour };
            d.line(&points, 0.25, edge);
        }
    }
    let mut entries: Vec<(String, Colour, bool)> =
        colours.iter().map(|(name, colour)| (name.clone(), *colour, false)).collect();
    for probe in samples.record.probes.iter().filter(|p| !is_outline(samples, &p.name)) {
        let Some(row) = samples.probes.iter().find(|r| r.probe == probe.name) else { continue };
        let mut points: Vec<[f64; 2]> = row.position.iter().map(|p| panel.at(p[0], p[1])).collect();
        if probe.kind == "ring" {
            points.extend(points.first().copied());
        }
        if points.len() > 1 {
            d.dashed(&points, 0.3, BLACK);
            entries.push((format!("probe {}", probe.name), BLACK, true));
        }
    }
    panel.axes(&mut d, "");
    key(&mut d, left, &entries);
    let words: Vec<String> = domain
        .groups
        .iter()
        .filter(|g| !g.shape.is_empty())
        .map(|g| format!("{}: {}", g.name, g.shape))
        .collect();
    let layer = if domain.dimensions == 3 { "Middle layer, seen along z. " } else { "" };
    let caption = format!("{layer}To scale, at the start. {}.", words.join("; "));
    Some(Figure { name: "setup".into(), title: "Set-up".into(), caption, drawing: d, raster: true })
}

/// Coloured dots and dashes with names, wrapped below the panel.
fn key(d: &mut Drawing, left: f64, entries: &[(String, Colour, bool)]) {
    let (mut x, mut y) = (left, d.height + 1.5);
    for (name, colour, dashed) in entries {
        let need = 9.0 + text_width(name, LABEL);
        if x > left && x + need > d.width {
            (x, y) = (left, y + 4.5);
        }
        if *dashed {
            d.dashed(&[[x, y], [x + 4.0, y]], 0.3, *colour);
        } else {
            d.circle([x + 2.0, y], 1.2, *colour);
        }
        d.text([x + 5.2, y], name, LABEL, BLACK, Anchor::Start);
        x += need;
    }
    d.height = y + 3.0;
}
