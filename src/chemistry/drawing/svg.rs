//! The network as SVG: species as rounded boxes, reactions as dots, arrows between them.

use super::declared;
use super::layout::{Box2, place};
use crate::chemistry::network::Network;
use std::fmt::Write as _;

/// Half the height of a species' box.
const HALF_BOX: f64 = 16.0;
/// Radius of a reaction's dot.
const DOT: f64 = 6.0;
/// Mean advance of a character, as a part of the font size (Helvetica, Arial).
const ADVANCE: f64 = 0.6;

/// A line of the drawing: between a species and a reaction.
struct Edge {
    from: usize,
    to: usize,
    multiplicity: u32,
    head_at_end: bool,
    head_at_start: bool,
    /// Sideways shift, where a species both enters and leaves a reaction.
    bow: f64,
}

/// The network as an SVG picture.
#[must_use]
pub fn svg(network: &Network) -> String {
    let reactions = declared(network);
    let count = network.species.len();
    let width = |text: &str, font: f64| text.chars().count() as f64 * font * ADVANCE;
    let mut nodes: Vec<Box2> =
        network.species.iter().map(|s| Box2 { width: (width(&s.name, 14.0) + 22.0).max(44.0) }).collect();
    nodes.extend(
        reactions.iter().map(|one| Box2 {
            width: (width(&network.reactions[one.forward].name, 11.0) + 4.0).max(3.0 * DOT),
        }),
    );
    let mut edges: Vec<Edge> = Vec::new();
    for (k, one) in reactions.iter().enumerate() {
        let reaction = &network.reactions[one.forward];
        let both = |s: usize| {
            reaction.reactants.iter().any(|t| t.0 == s) && reaction.products.iter().any(|t| t.0 == s)
        };
        let bow = |s: usize| if both(s) { 9.0 } else { 0.0 };
        edges.extend(reaction.reactants.iter().map(|&(s, multiplicity)| Edge {
            from: s,
            to: count + k,
            multiplicity,
            head_at_end: false,
            head_at_start: one.reversible,
            bow: bow(s),
        }));
        edges.extend(reaction.products.iter().map(|&(s, multiplicity)| Edge {
            from: count + k,
            to: s,
            multiplicity,
            head_at_end: true,
            head_at_start: false,
            bow: bow(s),
        }));
    }
    let ends: Vec<(usize, usize)> = edges.iter().map(|e| (e.from, e.to)).collect();
    let layout = place(&nodes, &ends);
    let [w, h] = layout.size;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w:.0} {h:.0}\" width=\"{w:.0}\" height=\"{h:.0}\" \
         font-family=\"Helvetica, Arial, sans-serif\">\n<title>{}</title>\n\
         <defs><marker id=\"head\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"8\" markerHeight=\"8\" \
         orient=\"auto-start-reverse\"><path d=\"M0 1 L10 5 L0 9 z\" fill=\"#4a5568\"/></marker></defs>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        escaped(&network.name)
    );
    for (edge, bends) in edges.iter().zip(&layout.bends) {
        draw_edge(&mut out, edge, bends, &layout.centre, &nodes, count);
    }
    for (s, species) in network.species.iter().enumerate() {
        let [x, y] = layout.centre[s];
        let w = nodes[s].width;
        let _ = writeln!(
            out,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{w:.1}\" height=\"{:.1}\" rx=\"9\" fill=\"#e6f0fa\" stroke=\"#2b6cb0\" \
             stroke-width=\"1.5\"/><text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"14\" text-anchor=\"middle\" fill=\"#1a202c\">{}</text>",
            x - 0.5 * w,
            y - HALF_BOX,
            2.0 * HALF_BOX,
            y + 5.0,
            escaped(&species.name)
        );
    }
    for (k, one) in reactions.iter().enumerate() {
        let reaction = &network.reactions[one.forward];
        let [x, y] = layout.centre[count + k];
        let equation =
            if one.reversible { reaction.equation.replace("->", "<->") } else { reaction.equation.clone() };
        let _ = writeln!(
            out,
            "<g><title>{}</title><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{DOT}\" fill=\"#c05621\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"11\" text-anchor=\"middle\" fill=\"#4a5568\" stroke=\"white\" \
             stroke-width=\"3\" paint-order=\"stroke\">{}</text></g>",
            escaped(&equation),
            y + DOT + 14.0,
            escaped(&reaction.name)
        );
    }
    out.push_str("</svg>\n");
    out
}

/// A smooth line through the bends, from border to border, with its multiplicity beside the middle.
fn draw_edge(
    out: &mut String,
    edge: &Edge,
    bends: &[[f64; 2]],
    centre: &[[f64; 2]],
    nodes: &[Box2],
    species: usize,
) {
    let mut points = vec![centre[edge.from]];
    points.extend_from_slice(bends);
    points.push(centre[edge.to]);
    let last = points.len() - 1;
    // A species that enters and leaves a reaction is joined by two lines, one above the other.
    let shift = if edge.from < species { -edge.bow } else { edge.bow };
    if bends.is_empty() && shift != 0.0 {
        points.insert(
            1,
            [0.5 * (points[0][0] + points[1][0]), 0.5 * (points[0][1] + points[1][1]) + 2.0 * shift],
        );
    } else {
        points[1..last].iter_mut().for_each(|point| point[1] += shift);
    }
    let last = points.len() - 1;
    points[0] = border(points[0], points[1], edge.from, nodes, species, edge.head_at_start);
    points[last] = border(points[last], points[last - 1], edge.to, nodes, species, edge.head_at_end);
    let mut path = format!("M{:.1} {:.1}", points[0][0], points[0][1]);
    for k in 0..last {
        let ([x0, y0], [x1, y1]) = (points[k], points[k + 1]);
        // Horizontal tangents at bends keep lines clear of the boxes above and below.
        let dx = 0.4 * (x1 - x0);
        let (a, b) = if last == 1 {
            ([x0 + dx, y0 + 0.4 * (y1 - y0)], [x1 - dx, y1 - 0.4 * (y1 - y0)])
        } else {
            ([x0 + dx, y0], [x1 - dx, y1])
        };
        let _ = write!(path, " C{:.1} {:.1} {:.1} {:.1} {x1:.1} {y1:.1}", a[0], a[1], b[0], b[1]);
    }
    let start = if edge.head_at_start { " marker-start=\"url(#head)\"" } else { "" };
    let end = if edge.head_at_end { " marker-end=\"url(#head)\"" } else { "" };
    let _ = writeln!(
        out,
        "<path d=\"{path}\" fill=\"none\" stroke=\"#4a5568\" stroke-width=\"1.4\"{start}{end}/>"
    );
    if edge.multiplicity > 1 {
        let middle = last / 2;
        let (a, b) = (points[middle], points[middle + 1]);
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"12\" text-anchor=\"middle\" fill=\"#1a202c\" stroke=\"white\" \
             stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            0.5 * (a[0] + b[0]),
            0.5 * (a[1] + b[1]) - 5.0,
            edge.multiplicity
        );
    }
}

/// Where the line from `centre` towards `other` leaves the node.
fn border(
    centre: [f64; 2],
    other: [f64; 2],
    node: usize,
    nodes: &[Box2],
    species: usize,
    head: bool,
) -> [f64; 2] {
    let (dx, dy) = (other[0] - centre[0], other[1] - centre[1]);
    let room = if head { 2.0 } else { 0.0 };
    let t = if node < species {
        let (a, b) = (0.5 * nodes[node].width + room, HALF_BOX + room);
        (a / dx.abs().max(1e-9)).min(b / dy.abs().max(1e-9))
    } else {
        (DOT + room) / dx.hypot(dy).max(1e-9)
    };
    let t = t.min(0.5);
    [centre[0] + t * dx, centre[1] + t * dy]
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
