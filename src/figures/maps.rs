//! Maps of a plane flow: particles coloured by a value, level lines.

use super::colours::{Colour, GREY, PALE, WHITE};
use super::contour::GridField;
use super::drawing::LABEL;
use super::painting::{Bar, colour_bar};
use super::panel::{Axis, Panel, range};
use super::{Drawing, Figure};
use crate::quantity::readable::Scale;

/// A part of the plane that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    pub title: String,
    /// Left, right, lower, upper end.
    pub ends: [f64; 4],
    /// Labels of the axes.
    pub labels: [String; 2],
}

/// Sides of a panel and the sheet around it, mm.
const SIDE: f64 = 66.0;
const LEFT: f64 = 15.0;
const TOP: f64 = 6.0;
const BOTTOM: f64 = 11.0;
const BAR: f64 = 22.0;

impl Window {
    fn panel(&self, left: f64) -> Panel {
        let axis = |low, high, label: &String| Axis {
            low,
            high,
            scale: Scale::plain(""),
            label: label.clone(),
            step: None,
        };
        let [x0, x1, y0, y1] = self.ends;
        let scale = SIDE / (x1 - x0).max(y1 - y0);
        let (width, height) = (scale * (x1 - x0), scale * (y1 - y0));
        let (x, y) = (axis(x0, x1, &self.labels[0]), axis(y0, y1, &self.labels[1]));
        Panel { left, top: TOP, width, height, x, y }
    }
}

/// Particles at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    pub window: Window,
    pub position: Vec<[f64; 2]>,
    pub value: Vec<f64>,
    /// Diameter of a particle, in units of the window.
    pub size: f64,
}

/// Particles as discs coloured by a value from zero, side by side; all panels share the colours.
#[must_use]
pub fn particles(name: &str, title: &str, caption: &str, clouds: &[Cloud], label: &str) -> Figure {
    let high = range(clouds.iter().flat_map(|c| c.value.iter().copied())).1;
    let bar = Bar { low: 0.0, high, unit: "", label, colour: super::colours::viridis };
    let cell = LEFT + SIDE + 3.0;
    let width = clouds.len() as f64 * cell;
    let mut d = Drawing::new(width + BAR, TOP + SIDE + BOTTOM);
    for (k, cloud) in clouds.iter().enumerate() {
        let panel = cloud.window.panel(k as f64 * cell + LEFT);
        let radius = 0.5 * cloud.size * panel.width / (panel.x.high - panel.x.low);
        for (place, value) in cloud.position.iter().zip(&cloud.value) {
            d.circle(panel.at(place[0], place[1]), radius, super::colours::viridis(value / high));
        }
        trim(&mut d, &panel, radius);
        panel.axes(&mut d, &cloud.window.title);
    }
    colour_bar(&mut d, width + 2.0, TOP, SIDE, &bar);
    Figure { name: name.into(), title: title.into(), caption: caption.into(), drawing: d, raster: true }
}

/// Takes away what reaches out of the frame by up to `width`, mm.
fn trim(d: &mut Drawing, panel: &Panel, width: f64) {
    let (l, t, w, h) = (panel.left, panel.top, panel.width, panel.height);
    for corner in [[l - width, t - width], [l - width, t + h]] {
        d.rectangle(corner, [w + 2.0 * width, width], WHITE);
    }
    for corner in [[l - width, t], [l + w, t]] {
        d.rectangle(corner, [width, h], WHITE);
    }
}

/// Level lines of one panel: the field, and the levels with their colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Levels {
    pub window: Window,
    pub field: GridField,
    pub levels: Vec<(f64, Colour)>,
    /// Filled outlines, such as obstacles.
    pub solid: Vec<Vec<[f64; 2]>>,
    /// Broken straight lines: from, to.
    pub marks: Vec<[[f64; 2]; 2]>,
}

/// Level lines side by side, with words below.
#[must_use]
pub fn level_lines(
    name: &str,
    title: &str,
    caption: &str,
    panels: &[Levels],
    words: &[(String, Colour)],
) -> Figure {
    let cell = LEFT + SIDE + 3.0;
    let mut d = Drawing::new(panels.len() as f64 * cell, TOP + SIDE + BOTTOM);
    for (k, one) in panels.iter().enumerate() {
        let panel = one.window.panel(k as f64 * cell + LEFT);
        let inside = |p: &[f64; 2]| {
            (panel.x.low..=panel.x.high).contains(&p[0]) && (panel.y.low..=panel.y.high).contains(&p[1])
        };
        for (level, colour) in &one.levels {
            for line in one.field.level(*level) {
                let points: Vec<[f64; 2]> = line
                    .iter()
                    .map(|p| if inside(p) { panel.at(p[0], p[1]) } else { [f64::NAN; 2] })
                    .collect();
                d.line(&points, 0.25, *colour);
            }
        }
        for outline in &one.solid {
            let points: Vec<[f64; 2]> = outline.iter().map(|p| panel.at(p[0], p[1])).collect();
            d.area(&points, PALE);
            d.line(&points, 0.25, GREY);
        }
        for [from, to] in &one.marks {
            d.dashed(&[panel.at(from[0], from[1]), panel.at(to[0], to[1])], 0.25, GREY);
        }
        panel.axes(&mut d, &one.window.title);
    }
    if !words.is_empty() {
        let entries: Vec<(String, Colour, f64)> = words.iter().map(|(w, c)| (w.clone(), *c, 0.4)).collect();
        let top = d.height + 2.0;
        super::panel::legend(&mut d, LEFT, top, &entries);
        d.height += 2.0 + LABEL + 2.0;
    }
    Figure { name: name.into(), title: title.into(), caption: caption.into(), drawing: d, raster: false }
}

/// The outline of a disc.
#[must_use]
pub fn disc(centre: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let corner = |k: u32| std::f64::consts::TAU * f64::from(k) / 120.0;
    (0..=120).map(|k| [centre[0] + radius * corner(k).cos(), centre[1] + radius * corner(k).sin()]).collect()
}
