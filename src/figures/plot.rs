//! Plots of curves and points: several panels that share a legend, axes linear or logarithmic.

use super::colours::{BLACK, Colour};
use super::drawing::{Anchor, HAIR, LABEL, TITLE, text_width};
use super::panel::{Axis, MARGIN, Panel, grid, range};
use super::ticks::ticks;
use super::{Drawing, Figure, WIDTH};
use crate::quantity::readable::{Scale, significant};

/// How values are joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Style {
    Line,
    Dashed,
    /// Points as circles filled white.
    Points,
}

/// A named row of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// As the legend has it; not listed if empty.
    pub name: String,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub style: Style,
    pub colour: Colour,
}

impl Trace {
    /// A trace of one style and colour.
    #[must_use]
    pub fn new(name: &str, x: &[f64], y: &[f64], style: Style, colour: Colour) -> Trace {
        Trace { name: name.into(), x: x.to_vec(), y: y.to_vec(), style, colour }
    }
}

/// An axis of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Ruler {
    /// With its unit in brackets, if it has one.
    pub label: String,
    pub logarithmic: bool,
    /// Ends; those of the values if `None`.
    pub ends: Option<[f64; 2]>,
}

impl Ruler {
    /// A linear axis that covers the values.
    #[must_use]
    pub fn linear(label: &str) -> Ruler {
        Ruler { label: label.into(), logarithmic: false, ends: None }
    }

    /// A logarithmic one.
    #[must_use]
    pub fn logarithmic(label: &str) -> Ruler {
        Ruler { logarithmic: true, ..Ruler::linear(label) }
    }

    /// The same with given ends.
    #[must_use]
    pub fn from(self, low: f64, high: f64) -> Ruler {
        Ruler { ends: Some([low, high]), ..self }
    }

    /// What is drawn for a value.
    fn place(&self, value: f64) -> f64 {
        if !self.logarithmic {
            value
        } else if value > 0.0 {
            value.log10()
        } else {
            f64::NAN
        }
    }

    fn axis(&self, values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = match self.ends {
            Some([low, high]) => (self.place(low), self.place(high)),
            None => {
                let (low, high) = range(values.map(|v| self.place(v)));
                let air = 0.05 * (high - low).max(if self.logarithmic { 0.5 } else { 0.0 });
                (low - air, high + air)
            }
        };
        Axis { low, high, scale: Scale::plain(""), label: self.label.clone(), step: None }
    }

    /// Values on the sheet's scale and their labels.
    fn ticks(&self, axis: &Axis, count: usize) -> Vec<(f64, String)> {
        if !self.logarithmic {
            return ticks(axis.low, axis.high, count);
        }
        // Whole decades, with 2 and 5 between them where there are few, and all digits where those are too few.
        let found = |steps: &[f64]| -> Vec<(f64, String)> {
            let decades = axis.low.floor() as i32..=axis.high.ceil() as i32;
            let values = decades.flat_map(|k| steps.iter().map(move |m| m * 10f64.powi(k)));
            values
                .filter(|v| (axis.low - 1e-9..=axis.high + 1e-9).contains(&v.log10()))
                .map(|v| (v.log10(), significant(v, 1)))
                .collect()
        };
        let few = axis.high - axis.low < 1.6;
        let usual = found(if few { &[1.0, 2.0, 5.0] } else { &[1.0] });
        if usual.len() > 1 { usual } else { found(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]) }
    }
}

/// One panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    pub title: String,
    pub x: Ruler,
    pub y: Ruler,
    pub traces: Vec<Trace>,
}

/// A figure of panels in `columns` columns with frames `height` mm high and one legend below.
#[must_use]
pub fn plots(name: &str, title: &str, caption: &str, panels: &[Plot], columns: usize, height: f64) -> Figure {
    let width = if columns == 1 && panels.len() == 1 { 110.0 } else { WIDTH };
    let (mut d, frames) = grid(panels.len(), columns, width, height);
    for (plot, [left, top, width, height]) in panels.iter().zip(frames) {
        let x = plot.x.axis(plot.traces.iter().flat_map(|t| t.x.iter().copied()));
        let y = plot.y.axis(plot.traces.iter().flat_map(|t| t.y.iter().copied()));
        let panel = Panel { left, top, width, height, x, y };
        for trace in &plot.traces {
            draw(&mut d, &panel, plot, trace);
        }
        frame(&mut d, &panel, plot);
    }
    legend(&mut d, panels);
    Figure { name: name.into(), title: title.into(), caption: caption.into(), drawing: d, raster: false }
}

fn draw(d: &mut Drawing, panel: &Panel, plot: &Plot, trace: &Trace) {
    let inside = |axis: &Axis, v: f64| (axis.low..=axis.high).contains(&v);
    let points: Vec<[f64; 2]> = trace
        .x
        .iter()
        .zip(&trace.y)
        .map(|(&x, &y)| {
            let (x, y) = (plot.x.place(x), plot.y.place(y));
            // What lies outside the frame breaks a line.
            if inside(&panel.x, x) && inside(&panel.y, y) { panel.at(x, y) } else { [f64::NAN; 2] }
        })
        .collect();
    match trace.style {
        Style::Line => d.line(&points, 0.4, trace.colour),
        Style::Dashed => {
            for part in points.split(|p| !p[0].is_finite()).filter(|p| p.len() > 1) {
                d.dashed(part, 0.4, trace.colour);
            }
        }
        Style::Points => points.iter().filter(|p| p[0].is_finite()).for_each(|&p| dot(d, p, trace.colour)),
    }
}

/// A point as a ring.
fn dot(d: &mut Drawing, at: [f64; 2], colour: Colour) {
    d.circle(at, 0.8, colour);
    d.circle(at, 0.45, super::colours::WHITE);
}

/// Frame, ticks, labels and title.
fn frame(d: &mut Drawing, panel: &Panel, plot: &Plot) {
    let (l, t, w, h) = (panel.left, panel.top, panel.width, panel.height);
    d.line(&[[l, t], [l, t + h], [l + w, t + h], [l + w, t], [l, t]], HAIR, BLACK);
    let fits = |list: &Vec<(f64, String)>| {
        list.len() < 3 || list.iter().map(|t| text_width(&t.1, LABEL) + 2.5).sum::<f64>() <= w
    };
    let tries = (1..=7).rev().map(|count| plot.x.ticks(&panel.x, count));
    for (value, label) in tries.into_iter().find(fits).unwrap_or_else(|| plot.x.ticks(&panel.x, 1)) {
        let [x, _] = panel.at(value, panel.y.low);
        d.line(&[[x, t + h], [x, t + h + 1.0]], HAIR, BLACK);
        d.text([x, t + h + 3.0], &label, LABEL, BLACK, Anchor::Middle);
    }
    let mut widest: f64 = 0.0;
    for (value, label) in plot.y.ticks(&panel.y, (h / 8.0).clamp(2.0, 6.0) as usize) {
        let [_, y] = panel.at(panel.x.low, value);
        d.line(&[[l - 1.0, y], [l, y]], HAIR, BLACK);
        d.text([l - 1.6, y], &label, LABEL, BLACK, Anchor::End);
        widest = widest.max(text_width(&label, LABEL));
    }
    d.text([l + w / 2.0, t + h + 6.8], &plot.x.label, LABEL, BLACK, Anchor::Middle);
    d.text_upwards([l - widest - 4.4, t + h / 2.0], &plot.y.label, LABEL, BLACK);
    d.text([l, t - 2.6], &plot.title, TITLE, BLACK, Anchor::Start);
}

/// Every name once, in rows below the panels.
fn legend(d: &mut Drawing, panels: &[Plot]) {
    let mut listed: Vec<&Trace> = Vec::new();
    for trace in panels.iter().flat_map(|p| &p.traces).filter(|t| !t.name.is_empty()) {
        if listed.iter().all(|other| other.name != trace.name) {
            listed.push(trace);
        }
    }
    if listed.is_empty() {
        return;
    }
    let (mut left, mut top) = (MARGIN[0], d.height + 2.0);
    for trace in listed {
        let need = 10.0 + text_width(&trace.name, LABEL);
        if left + need > d.width && left > MARGIN[0] {
            (left, top) = (MARGIN[0], top + 4.5);
        }
        let line = [[left, top], [left + 5.0, top]];
        match trace.style {
            Style::Line => d.line(&line, 0.4, trace.colour),
            Style::Dashed => d.dashed(&line, 0.4, trace.colour),
            Style::Points => dot(d, [left + 2.5, top], trace.colour),
        }
        d.text([left + 6.2, top], &trace.name, LABEL, BLACK, Anchor::Start);
        left += need;
    }
    d.height = top + 3.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_are_ticks() {
        let ruler = Ruler::logarithmic("e").from(1e-4, 1e-1);
        let axis = ruler.axis([].into_iter());
        let labels: Vec<String> = ruler.ticks(&axis, 5).into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["0.0001", "0.001", "0.01", "0.1"]);
        assert!(ruler.place(0.0).is_nan());
        let narrow = Ruler::logarithmic("n").from(19.0, 42.0);
        let labels: Vec<String> =
            narrow.ticks(&narrow.axis([].into_iter()), 5).into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["20", "30", "40"]);
    }

    #[test]
    fn names_stand_in_the_legend_once_and_fit_the_sheet() {
        let trace = |k: usize| {
            Trace::new(&format!("a long name {}", k % 9), &[0.0, 1.0], &[0.0, 1.0], Style::Line, BLACK)
        };
        let plot = Plot {
            title: "t".into(),
            x: Ruler::linear("x"),
            y: Ruler::linear("y"),
            traces: (0..12).map(trace).collect(),
        };
        let figure = plots("n", "t", "c", &[plot.clone(), plot], 2, 40.0);
        let named = |mark: &&super::super::drawing::Mark| {
            matches!(mark, super::super::drawing::Mark::Text { text, at, .. }
                if text.starts_with("a long") && at[0] + text_width(text, LABEL) <= figure.drawing.width)
        };
        assert_eq!(figure.drawing.marks.iter().filter(named).count(), 9);
    }
}
