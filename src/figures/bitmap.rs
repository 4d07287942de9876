//! A drawing as PNG, drawn by plotters with an embedded font.

use super::colours::Colour;
use super::drawing::{Anchor, Drawing, Mark};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, FontTransform, RGBAColor, register_font};
use std::path::Path;
use std::sync::OnceLock;

/// Pixels per mm: 254 dots per inch.
const PIXELS: f64 = 10.0;
const FONT: &str = "DejaVu Sans";

/// Writes the drawing to `path`, which must end in `.png`.
///
/// # Errors
/// What the backend says, in words.
pub fn write_png(drawing: &Drawing, path: &Path) -> Result<(), String> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let known = REGISTERED.get_or_init(|| {
        let bytes: &'static [u8] = include_bytes!("../../assets/DejaVuSans.ttf");
        register_font(FONT, FontStyle::Normal, bytes).is_ok()
    });
    if !known {
        return Err("the embedded font cannot be read".into());
    }
    let size = ((drawing.width * PIXELS).round() as u32, (drawing.height * PIXELS).round() as u32);
    let area = BitMapBackend::new(path, size).into_drawing_area();
    area.fill(&WHITE).map_err(|e| e.to_string())?;
    for mark in &drawing.marks {
        paint(&area, mark)?;
    }
    area.present().map_err(|e| e.to_string())
}

type Sheet<'a> = DrawingArea<BitMapBackend<'a>, plotters::coord::Shift>;

fn paint(area: &Sheet<'_>, mark: &Mark) -> Result<(), String> {
    match mark {
        Mark::Line { points, width, colour, dash } => {
            let style = colour_of(*colour).stroke_width((width * PIXELS).round().max(1.0) as u32);
            let path: Vec<(i32, i32)> = points.iter().map(|&p| pixel(p)).collect();
            if *dash {
                let dashes = plotters::element::DashedPathElement::new(path, 12, 8, style);
                area.draw(&dashes).map_err(|e| e.to_string())
            } else {
                pieces(&path)
                    .into_iter()
                    .try_for_each(|piece| area.draw(&PathElement::new(piece.to_vec(), style)))
                    .map_err(|e| e.to_string())
            }
        }
        Mark::Area { points, colour } => {
            let path: Vec<(i32, i32)> = points.iter().map(|&p| pixel(p)).collect();
            area.draw(&Polygon::new(path, colour_of(*colour).filled())).map_err(|e| e.to_string())
        }
        Mark::Rectangle { corner: [x, y], size: [w, h], colour } => {
            let (from, to) = (pixel([*x, *y]), pixel([x + w, y + h]));
            area.draw(&Rectangle::new([from, to], colour_of(*colour).filled())).map_err(|e| e.to_string())
        }
        Mark::Circle { centre, radius, colour } => {
            let radius = (radius * PIXELS).round().max(1.0) as i32;
            area.draw(&Circle::new(pixel(*centre), radius, colour_of(*colour).filled()))
                .map_err(|e| e.to_string())
        }
        Mark::Text { at, text, size, colour, anchor, turned } => {
            let h_pos = match anchor {
                Anchor::Start => HPos::Left,
                Anchor::Middle => HPos::Center,
                Anchor::End => HPos::Right,
            };
            // ab_glyph scales by ascent + descent (1.164 em for DejaVu Sans), SVG by the em.
            let font = (FONT, size * PIXELS * 1.164).into_font();
            let font = if *turned { font.transform(FontTransform::Rotate270) } else { font };
            let colour = colour_of(*colour);
            // The box of a line of text reaches from ascent to descent; its middle lies above that of capitals.
            let shift = 0.13 * size;
            let at = if *turned { [at[0] + shift, at[1]] } else { [at[0], at[1] + shift] };
            let style = TextStyle::from(font).color(&colour).pos(Pos::new(h_pos, VPos::Center));
            area.draw(&Text::new(text.as_str(), pixel(at), style)).map_err(|e| e.to_string())
        }
    }
}

/// A line cut where it turns back sharply: plotters would draw a spike there.
fn pieces(path: &[(i32, i32)]) -> Vec<&[(i32, i32)]> {
    let (mut found, mut start) = (Vec::new(), 0);
    for (k, three) in path.windows(3).enumerate() {
        let way = |a: (i32, i32), b: (i32, i32)| (f64::from(b.0 - a.0), f64::from(b.1 - a.1));
        let (one, next) = (way(three[0], three[1]), way(three[1], three[2]));
        let along = one.0 * next.0 + one.1 * next.1;
        if along < -0.5 * one.0.hypot(one.1) * next.0.hypot(next.1) {
            found.push(&path[start..k + 2]);
            start = k + 1;
        }
    }
    found.push(&path[start..]);
    found
}

fn pixel([x, y]: [f64; 2]) -> (i32, i32) {
    ((x * PIXELS).round() as i32, (y * PIXELS).round() as i32)
}

fn colour_of(c: Colour) -> RGBAColor {
    RGBAColor(c.red, c.green, c.blue, c.opacity)
}
