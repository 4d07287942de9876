//! A panel: a rectangle of the sheet with axes, into which values are drawn.

use super::colours::{BLACK, Colour, GREY};
use super::drawing::{Anchor, Drawing, HAIR, LABEL, TITLE, text_width};
use super::ticks::{ticks, ticks_every};
use crate::quantity::readable::Scale;

/// A value axis: range in SI and how it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub low: f64,
    pub high: f64,
    pub scale: Scale,
    pub label: String,
    /// Distance of ticks as shown, where the usual choice does not suit.
    pub step: Option<f64>,
}

impl Axis {
    /// An axis that covers the values, with the unit that suits them; `unit` in SI.
    #[must_use]
    pub fn covering(values: impl Iterator<Item = f64>, unit: &str, label: &str) -> Axis {
        let (low, high) = range(values);
        Axis {
            low,
            high,
            scale: Scale::choose(low.abs().max(high.abs()), unit),
            label: label.into(),
            step: None,
        }
    }

    /// Widened to hold zero if the data lie near it, and by a little air.
    #[must_use]
    pub fn with_air(mut self) -> Axis {
        if self.low > 0.0 && self.low < 0.5 * self.high {
            self.low = 0.0;
        }
        let span = self.high - self.low;
        let air = if span > 0.0 { 0.05 * span } else { self.high.abs().max(1.0) * 0.5 };
        self.high += air;
        if self.low != 0.0 || span <= 0.0 {
            self.low -= air;
            if self.low < 0.0 && self.low + air >= 0.0 {
                self.low = 0.0;
            }
        }
        self
    }
}

/// Smallest and largest number; 0 and 1 if there is none.
pub fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// The inside of a frame: corner and size in mm, and its two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub x: Axis,
    pub y: Axis,
}

impl Panel {
    /// A point of the sheet from values, kept within the frame.
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let part = |v: f64, a: &Axis| if a.high > a.low { (v - a.low) / (a.high - a.low) } else { 0.5 };
        // NaN passes through clamp and breaks a line.
        let (u, v) = (part(x, &self.x).clamp(0.0, 1.0), part(y, &self.y).clamp(0.0, 1.0));
        [self.left + u * self.width, self.top + (1.0 - v) * self.height]
    }

    /// Frame, ticks, labels and title.
    pub fn axes(&self, d: &mut Drawing, title: &str) {
        let (l, t, w, h) = (self.left, self.top, self.width, self.height);
        d.line(&[[l, t], [l, t + h], [l + w, t + h], [l + w, t], [l, t]], HAIR, BLACK);
        let (fx, fy) = (self.x.scale.factor, self.y.scale.factor);
        for (value, label) in self.x_ticks() {
            let [px, _] = self.at(value / fx, self.y.low);
            d.line(&[[px, t + h], [px, t + h + 1.0]], HAIR, BLACK);
            d.text([px, t + h + 3.0], &label, LABEL, BLACK, Anchor::Middle);
        }
        let mut widest: f64 = 0.0;
        for (value, label) in ticks(self.y.low * fy, self.y.high * fy, (h / 8.0).clamp(2.0, 6.0) as usize) {
            let [_, py] = self.at(self.x.low, value / fy);
            d.line(&[[l - 1.0, py], [l, py]], HAIR, BLACK);
            d.text([l - 1.6, py], &label, LABEL, BLACK, Anchor::End);
            widest = widest.max(text_width(&label, LABEL));
        }
        // Who leaves the label empty writes it.
        if !self.x.label.is_empty() {
            let words = self.x.scale.label(&self.x.label);
            d.text([l + w / 2.0, t + h + 6.8], &words, LABEL, BLACK, Anchor::Middle);
        }
        d.text_upwards([l - widest - 3.8, t + h / 2.0], &self.y.scale.label(&self.y.label), LABEL, BLACK);
        d.text([l, t - 2.6], title, TITLE, BLACK, Anchor::Start);
    }

    /// As many ticks as leave a gap between their labels.
    fn x_ticks(&self) -> Vec<(f64, String)> {
        let (low, high) = (self.x.low * self.x.scale.factor, self.x.high * self.x.scale.factor);
        if let Some(step) = self.x.step {
            return ticks_every(low, high, step);
        }
        let fits = |list: &Vec<(f64, String)>| {
            let need: f64 = list.iter().map(|t| text_width(&t.1, LABEL) + 2.5).sum();
            list.len() < 3 || need <= self.width
        };
        let tries = (1..=8).rev().map(|count| ticks(low, high, count));
        tries.into_iter().find(fits).unwrap_or_else(|| ticks(low, high, 1))
    }

    /// A curve through (x, y).
    pub fn curve(&self, d: &mut Drawing, x: &[f64], y: &[f64], width: f64, colour: Colour) {
        let points: Vec<[f64; 2]> = x.iter().zip(y).map(|(&x, &y)| self.at(x, y)).collect();
        d.line(&points, width, colour);
    }

    /// The area between two curves, broken where one is not a number.
    pub fn band(&self, d: &mut Drawing, x: &[f64], low: &[f64], high: &[f64], colour: Colour) {
        let rows: Vec<[f64; 3]> = x.iter().zip(low).zip(high).map(|((&x, &a), &b)| [x, a, b]).collect();
        for part in rows.split(|row| row.iter().any(|v| !v.is_finite())) {
            let lower = part.iter().map(|r| self.at(r[0], r[1]));
            let upper = part.iter().rev().map(|r| self.at(r[0], r[2]));
            d.area(&lower.chain(upper).collect::<Vec<_>>(), colour);
        }
    }

    /// A dashed horizontal line at a value.
    pub fn level(&self, d: &mut Drawing, y: f64) {
        if y >= self.y.low && y <= self.y.high {
            d.dashed(&[self.at(self.x.low, y), self.at(self.x.high, y)], HAIR, GREY);
        }
    }
}

/// Space a panel needs around its frame, mm: left, top, right, bottom.
pub const MARGIN: [f64; 4] = [17.0, 6.0, 4.0, 10.0];

/// A sheet of equal panels in rows, and the corner and size of each frame.
#[must_use]
pub fn grid(count: usize, columns: usize, width: f64, frame_height: f64) -> (Drawing, Vec<[f64; 4]>) {
    let columns = columns.min(count).max(1);
    let rows = count.div_ceil(columns).max(1);
    let (cell, row) = (width / columns as f64, frame_height + MARGIN[1] + MARGIN[3]);
    let frames = (0..count)
        .map(|k| {
            let (i, j) = (k % columns, k / columns);
            let corner = [i as f64 * cell + MARGIN[0], j as f64 * row + MARGIN[1]];
            [corner[0], corner[1], cell - MARGIN[0] - MARGIN[2], frame_height]
        })
        .collect();
    (Drawing::new(width, rows as f64 * row), frames)
}

/// Line samples with names, right of `left` at height `top`.
pub fn legend(d: &mut Drawing, mut left: f64, top: f64, entries: &[(String, Colour, f64)]) {
    for (name, colour, width) in entries {
        d.line(&[[left, top], [left + 5.0, top]], *width, *colour);
        d.text([left + 6.2, top], name, LABEL, BLACK, Anchor::Start);
        left += 10.0 + text_width(name, LABEL);
    }
}
