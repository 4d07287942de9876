//! A drawing: a list of marks on a sheet, in millimetres of print from the upper left corner.

use super::colours::Colour;

/// Font size of labels, mm: 8 points.
pub const LABEL: f64 = 2.82;
/// Font size of panel titles, mm: 9 points.
pub const TITLE: f64 = 3.18;
/// Width of frames and ticks, mm: half a point.
pub const HAIR: f64 = 0.18;

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// One mark; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    Line {
        points: Vec<[f64; 2]>,
        width: f64,
        colour: Colour,
        dash: bool,
    },
    Area {
        points: Vec<[f64; 2]>,
        colour: Colour,
    },
    Rectangle {
        corner: [f64; 2],
        size: [f64; 2],
        colour: Colour,
    },
    Circle {
        centre: [f64; 2],
        radius: f64,
        colour: Colour,
    },
    /// Vertically centred on the point; `turned` reads upwards.
    Text {
        at: [f64; 2],
        text: String,
        size: f64,
        colour: Colour,
        anchor: Anchor,
        turned: bool,
    },
}

/// A sheet with marks on it, painted in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Width of the sheet, mm.
    pub width: f64,
    /// Height of the sheet, mm.
    pub height: f64,
    pub marks: Vec<Mark>,
}

impl Drawing {
    /// An empty sheet.
    #[must_use]
    pub fn new(width: f64, height: f64) -> Drawing {
        Drawing { width, height, marks: Vec::new() }
    }

    /// A line through points; a break wherever a coordinate is not a number.
    pub fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Colour) {
        for part in points.split(|p| !(p[0].is_finite() && p[1].is_finite())).filter(|p| p.len() > 1) {
            self.marks.push(Mark::Line { points: part.to_vec(), width, colour, dash: false });
        }
    }

    /// A dashed line.
    pub fn dashed(&mut self, points: &[[f64; 2]], width: f64, colour: Colour) {
        self.marks.push(Mark::Line { points: points.to_vec(), width, colour, dash: true });
    }

    /// A filled polygon; points that are not numbers are left out.
    pub fn area(&mut self, points: &[[f64; 2]], colour: Colour) {
        let points: Vec<_> =
            points.iter().copied().filter(|p| p[0].is_finite() && p[1].is_finite()).collect();
        if points.len() > 2 {
            self.marks.push(Mark::Area { points, colour });
        }
    }

    /// A filled rectangle.
    pub fn rectangle(&mut self, corner: [f64; 2], size: [f64; 2], colour: Colour) {
        self.marks.push(Mark::Rectangle { corner, size, colour });
    }

    /// A disc.
    pub fn circle(&mut self, centre: [f64; 2], radius: f64, colour: Colour) {
        self.marks.push(Mark::Circle { centre, radius, colour });
    }

    /// A line of text, vertically centred on its point.
    pub fn text(&mut self, at: [f64; 2], text: &str, size: f64, colour: Colour, anchor: Anchor) {
        self.marks.push(Mark::Text { at, text: text.into(), size, colour, anchor, turned: false });
    }

    /// A line of text that reads upwards, centred on its point.
    pub fn text_upwards(&mut self, at: [f64; 2], text: &str, size: f64, colour: Colour) {
        let anchor = Anchor::Middle;
        self.marks.push(Mark::Text { at, text: text.into(), size, colour, anchor, turned: true });
    }
}

/// Width of a text, mm: DejaVu Sans is 0.6 em wide on average.
#[must_use]
pub fn text_width(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}
