//! Shapes as people write them.

use super::names::pad;
use super::node::{Node, Value};
use super::reader::{Faults, Fields};
use crate::geometry::Shape;
use crate::quantity::Dimension;
use crate::vector::Vector;

const NAMES: &str = "everything_else, box, disc, ball, ring, shell, half_space, union, difference";

/// Reads a shape: the word `everything_else`, or a mapping with one key that names it.
pub fn read(node: &Node, d: usize, faults: &mut Faults) -> Option<Shape> {
    if matches!(&node.value, Value::Text(word) if word == "everything_else") {
        return Some(Shape::EverythingElse);
    }
    let Value::Map(entries) = &node.value else {
        faults.at(&node.place, "a shape was expected", format!("one of: {NAMES}"));
        return None;
    };
    let [(key, inner)] = entries.as_slice() else {
        faults.at(
            &node.place,
            format!("a shape is one of: {NAMES}; here are {} keys", entries.len()),
            "for several shapes use union: [...] or difference: [...]",
        );
        return None;
    };
    match key.name.as_str() {
        "box" => {
            let mut fields = Fields::of(inner, "box", faults)?;
            let min = fields.required("min", faults).and_then(|n| n.vector(Dimension::LENGTH, d, faults));
            let max = fields.required("max", faults).and_then(|n| n.vector(Dimension::LENGTH, d, faults));
            fields.finish(faults);
            let (min, max) = (min?, max?);
            if min.iter().zip(&max).any(|(a, b)| a >= b) {
                faults.at(
                    &inner.place,
                    "the box is empty",
                    "each entry of max must be larger than the one of min",
                );
                return None;
            }
            let open = |x: &[f64], end: f64| Vector::from_fn(|k, _| x.get(k).copied().unwrap_or(end));
            Some(Shape::Box { min: open(&min, f64::NEG_INFINITY), max: open(&max, f64::INFINITY) })
        }
        "disc" | "ball" => {
            let mut fields = Fields::of(inner, &key.name, faults)?;
            let centre =
                fields.required("centre", faults).and_then(|n| n.vector(Dimension::LENGTH, d, faults));
            let radius =
                fields.required("radius", faults).and_then(|n| n.positive(Dimension::LENGTH, faults));
            fields.finish(faults);
            Some(Shape::Ball { centre: pad(&centre?), radius: radius? })
        }
        "ring" | "shell" => {
            let mut fields = Fields::of(inner, &key.name, faults)?;
            let centre =
                fields.required("centre", faults).and_then(|n| n.vector(Dimension::LENGTH, d, faults));
            let inner_radius =
                fields.required("inner", faults).and_then(|n| n.positive(Dimension::LENGTH, faults));
            let outer = fields.required("outer", faults).and_then(|n| n.positive(Dimension::LENGTH, faults));
            fields.finish(faults);
            let (inner_radius, outer) = (inner_radius?, outer?);
            if outer <= inner_radius {
                faults.at(&inner.place, "the ring is empty", "outer must be larger than inner");
                return None;
            }
            Some(Shape::Shell { centre: pad(&centre?), inner: inner_radius, outer })
        }
        "half_space" => {
            let mut fields = Fields::of(inner, "half_space", faults)?;
            let point = fields.required("point", faults).and_then(|n| n.vector(Dimension::LENGTH, d, faults));
            let normal = fields.required("normal", faults).and_then(|n| n.vector(Dimension::NONE, d, faults));
            fields.finish(faults);
            let normal = pad(&normal?);
            if normal.norm() == 0.0 {
                faults.at(&inner.place, "the normal is zero", "it points into the half-space, e.g. [0, 1]");
                return None;
            }
            Some(Shape::HalfSpace { point: pad(&point?), normal: normal.normalize() })
        }
        "union" => {
            let parts = inner.list(faults)?;
            Some(Shape::Union(parts.iter().filter_map(|part| read(part, d, faults)).collect()))
        }
        "difference" => {
            let parts: Vec<Shape> =
                inner.list(faults)?.iter().filter_map(|part| read(part, d, faults)).collect();
            let Some((whole, holes)) = parts.split_first() else {
                faults.at(
                    &inner.place,
                    "a difference needs at least one shape",
                    "difference: [whole, hole, ...]",
                );
                return None;
            };
            Some(Shape::Difference(Box::new(whole.clone()), holes.to_vec()))
        }
        other => {
            let known: Vec<&str> = NAMES.split(", ").collect();
            let remedy = match super::reader::nearest(other, known.iter().copied()) {
                Some(near) => format!("did you mean `{near}`? Shapes are: {NAMES}"),
                None => format!("shapes are: {NAMES}"),
            };
            faults.at(&key.place, format!("unknown shape `{other}`"), remedy);
            None
        }
    }
}
