//! A drawing as SVG, in millimetres.

use super::colours::Colour;
use super::drawing::{Anchor, Drawing, Mark};
use std::fmt::Write;

/// The drawing as an SVG document whose size is that of print.
#[must_use]
pub fn svg(drawing: &Drawing) -> String {
    let (w, h) = (drawing.width, drawing.height);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w:.1}mm\" height=\"{h:.1}mm\" viewBox=\"0 0 {w:.2} {h:.2}\" \
         font-family=\"'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif\">\n\
         <rect width=\"{w:.2}\" height=\"{h:.2}\" fill=\"#ffffff\"/>\n"
    );
    for mark in &drawing.marks {
        // Writing to a String cannot fail.
        let _ = write_mark(&mut out, mark);
    }
    out.push_str("</svg>\n");
    out
}

fn write_mark(out: &mut String, mark: &Mark) -> std::fmt::Result {
    match mark {
        Mark::Line { points, width, colour, dash } => {
            let dash = if *dash { " stroke-dasharray=\"1.2 0.8\"" } else { "" };
            let paint = paint("stroke", *colour);
            writeln!(
                out,
                "<polyline fill=\"none\" {paint} stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash} points=\"{}\"/>",
                list(points)
            )
        }
        Mark::Area { points, colour } => {
            writeln!(out, "<polygon {} points=\"{}\"/>", paint("fill", *colour), list(points))
        }
        Mark::Rectangle { corner: [x, y], size: [w, h], colour } => {
            let paint = paint("fill", *colour);
            writeln!(out, "<rect x=\"{x:.3}\" y=\"{y:.3}\" width=\"{w:.3}\" height=\"{h:.3}\" {paint}/>")
        }
        Mark::Circle { centre: [x, y], radius, colour } => {
            writeln!(
                out,
                "<circle cx=\"{x:.3}\" cy=\"{y:.3}\" r=\"{radius:.3}\" {}/>",
                paint("fill", *colour)
            )
        }
        Mark::Text { at: [x, y], text, size, colour, anchor, turned } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let turn =
                if *turned { format!(" transform=\"rotate(-90 {x:.3} {y:.3})\"") } else { String::new() };
            // Half the height of capitals (0.73 em) below the point centres them on it.
            let (fill, shift) = (paint("fill", *colour), size * 0.36);
            writeln!(
                out,
                "<text x=\"{x:.3}\" y=\"{y:.3}\" dy=\"{shift:.3}\" font-size=\"{size}\" text-anchor=\"{anchor}\" {fill}{turn}>{}</text>",
                escape(text)
            )
        }
    }
}

fn paint(what: &str, c: Colour) -> String {
    let opacity =
        if c.opacity < 1.0 { format!(" {what}-opacity=\"{:.3}\"", c.opacity) } else { String::new() };
    format!("{what}=\"#{:02x}{:02x}{:02x}\"{opacity}", c.red, c.green, c.blue)
}

fn list(points: &[[f64; 2]]) -> String {
    let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.3},{y:.3}")).collect();
    points.join(" ")
}

/// Text safe inside XML and HTML.
#[must_use]
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::super::colours::BLACK;
    use super::*;

    #[test]
    fn marks_become_elements_and_gaps_break_lines() {
        let mut d = Drawing::new(80.0, 60.0);
        d.line(&[[0.0, 0.0], [1.0, 1.0], [f64::NAN, 0.0], [2.0, 2.0], [3.0, 3.0]], 0.3, BLACK.faint(0.5));
        d.text([1.0, 1.0], "a < b", 3.0, BLACK, Anchor::End);
        let text = svg(&d);
        assert_eq!(text.matches("<polyline").count(), 2);
        assert!(
            text.contains("a &lt; b")
                && text.contains("stroke-opacity=\"0.500\"")
                && text.contains("width=\"80.0mm\"")
        );
        assert!(!text.contains("NaN"));
    }
}
