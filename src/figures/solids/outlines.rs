//! The outlines of a solid at successive times in one figure, coloured by time; of several realizations those at the end.

use super::outline;
use crate::figures::colours::{BLACK, Colour, GREY, viridis};
use crate::figures::painting::{Bar, colour_bar};
use crate::figures::panel::{Axis, Panel, range};
use crate::figures::{Drawing, Figure, Samples, WIDTH, slug, spread};
use crate::quantity::readable::Scale;
use crate::statistics::quantile;
use crate::tables::ProbeRows;

/// Most outlines in time, and most realizations beside.
const LINES: usize = 24;
/// Room around the map and for the colour bar, mm.
const LEFT: f64 = 15.0;
const ABOVE: f64 = 6.0;
const BELOW: f64 = 11.0;
const BAR: f64 = 20.0;

/// Time as a colour; the light end vanishes on white.
fn shade(part: f64) -> Colour {
    viridis(0.9 * part)
}

/// Outlines of the first realization, and of all at the end.
pub fn outlines(samples: &Samples, name: &str) -> Option<Figure> {
    let probe = outline(name);
    let quantity = &samples.probes.iter().find(|r| r.probe == probe)?.quantity;
    let rows = super::rows(samples, &probe, quantity);
    let first = rows.first()?.realization;
    let mut own: Vec<&ProbeRows> = rows.iter().copied().filter(|r| r.realization == first).collect();
    own.sort_by(|a, b| a.time.total_cmp(&b.time));
    let last = own.last()?.time;
    let others: Vec<&ProbeRows> = rows.iter().copied().filter(|r| r.time == last).take(LINES).collect();
    let own: Vec<&ProbeRows> = spread(own.len(), LINES).into_iter().map(|k| own[k]).collect();
    let panels = if others.len() > 1 { 2.0 } else { 1.0 };
    let every = || own.iter().chain(&others).flat_map(|r| &r.position);
    let (x, y) = (range(every().map(|p| p[0])), range(every().map(|p| p[1])));
    let air = 0.04 * (x.1 - x.0).max(y.1 - y.0);
    let (x, y) = ((x.0 - air, x.1 + air), (y.0 - air, y.1 + air));
    let aspect = (y.1 - y.0) / (x.1 - x.0);
    let width = ((WIDTH - BAR) / panels - LEFT - 2.0).min(110.0 / aspect).min(90.0);
    let height = width * aspect;
    let sheet = panels * (LEFT + width + 2.0) + BAR;
    let mut d = Drawing::new(sheet, height + ABOVE + BELOW);
    let scale = Scale::choose([x.0, x.1, y.0, y.1].map(f64::abs).into_iter().fold(0.0, f64::max), "m");
    let axis = |ends: (f64, f64), label: &str| Axis {
        low: ends.0,
        high: ends.1,
        scale: scale.clone(),
        label: label.into(),
        step: None,
    };
    let panel = |k: f64| Panel {
        left: LEFT + k * (LEFT + width + 2.0),
        top: ABOVE,
        width,
        height,
        x: axis(x, "x"),
        y: axis(y, "y"),
    };
    let begin = own.first()?.time;
    for row in &own {
        let part = if last > begin { (row.time - begin) / (last - begin) } else { 1.0 };
        draw(&mut d, &panel(0.0), row, 0.3, shade(part));
    }
    let bar = Bar { low: begin, high: last, unit: "s", label: "time", colour: shade };
    panel(0.0).axes(&mut d, if panels > 1.0 { "one realization" } else { "" });
    let mut caption = "Outline at successive times, coloured by time, to scale.".to_string();
    if panels > 1.0 {
        for row in &others {
            draw(&mut d, &panel(1.0), row, 0.15, GREY);
        }
        draw(&mut d, &panel(1.0), others[0], 0.35, BLACK);
        panel(1.0).axes(&mut d, &format!("{} realizations at the end", others.len()));
        caption += " Right: outlines at the end; black: the realization of the left side.";
    }
    colour_bar(&mut d, sheet - BAR + 2.0, ABOVE, height.min(60.0), &bar);
    Some(Figure {
        name: format!("solid_{}_outlines", slug(name)),
        title: format!("Outlines of {name}"),
        caption,
        drawing: d,
        raster: false,
    })
}

/// A line through the points in their order; closed if its ends are neighbours.
fn draw(d: &mut Drawing, panel: &Panel, row: &ProbeRows, width: f64, colour: Colour) {
    let mut order: Vec<usize> = (0..row.position.len()).collect();
    order.sort_by(|&a, &b| row.s[a].total_cmp(&row.s[b]));
    let mut points: Vec<[f64; 3]> = order.iter().map(|&k| row.position[k]).collect();
    let away = |a: &[f64; 3], b: &[f64; 3]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let steps: Vec<f64> = points.windows(2).map(|w| away(&w[0], &w[1])).collect();
    if let (Some(&first), Some(last)) = (points.first(), points.last())
        && away(&first, last) <= 2.0 * quantile(&steps, 0.9)
    {
        points.push(first);
    }
    let points: Vec<[f64; 2]> = points.iter().map(|p| panel.at(p[0], p[1])).collect();
    d.line(&points, width, colour);
}
