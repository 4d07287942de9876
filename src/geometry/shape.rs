//! Regions of space as signed distances.

use crate::quantity::readable::significant;
use crate::vector::Vector;

/// A closed region. Places have three coordinates; in fewer dimensions the others are zero and
/// a [`Shape::Box`] reaches to infinity along them.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All of space (what no other group claims).
    EverythingElse,
    Box {
        min: Vector<3>,
        max: Vector<3>,
    },
    /// A disc in 2D, a ball in 3D, an interval in 1D.
    Ball {
        centre: Vector<3>,
        radius: f64,
    },
    /// A ring in 2D, a spherical shell in 3D.
    Shell {
        centre: Vector<3>,
        inner: f64,
        outer: f64,
    },
    /// The side of a plane to which its unit normal points.
    HalfSpace {
        point: Vector<3>,
        normal: Vector<3>,
    },
    Union(Vec<Shape>),
    /// The first shape without the others.
    Difference(std::boxed::Box<Shape>, Vec<Shape>),
}

/// A place of `D` coordinates among those of three.
#[must_use]
pub fn embed<const D: usize>(x: &Vector<D>) -> Vector<3> {
    Vector::from_fn(|k, _| if k < D { x[k] } else { 0.0 })
}

impl Shape {
    /// Distance to the surface, m, negative inside. Exact for the simple shapes; for unions and differences the
    /// sign is exact and the size a lower bound.
    #[must_use]
    pub fn signed_distance(&self, x: &Vector<3>) -> f64 {
        match self {
            Shape::EverythingElse => f64::NEG_INFINITY,
            Shape::Box { min, max } => {
                let mut outside = 0.0;
                let mut inside = f64::NEG_INFINITY;
                for k in 0..3 {
                    let d = (min[k] - x[k]).max(x[k] - max[k]);
                    outside += d.max(0.0).powi(2);
                    inside = inside.max(d);
                }
                if inside > 0.0 { outside.sqrt() } else { inside }
            }
            Shape::Ball { centre, radius } => (x - centre).norm() - radius,
            Shape::Shell { centre, inner, outer } => {
                let r = (x - centre).norm();
                (inner - r).max(r - outer)
            }
            Shape::HalfSpace { point, normal } => -(x - point).dot(normal),
            Shape::Union(parts) => {
                parts.iter().map(|part| part.signed_distance(x)).fold(f64::INFINITY, f64::min)
            }
            Shape::Difference(whole, holes) => {
                holes.iter().map(|hole| -hole.signed_distance(x)).fold(whole.signed_distance(x), f64::max)
            }
        }
    }

    /// Whether a place belongs to the region (its surface included).
    #[must_use]
    pub fn holds(&self, x: &Vector<3>) -> bool {
        self.signed_distance(x) <= 0.0
    }

    /// The axis-parallel box round the region, cut to the given one.
    #[must_use]
    pub fn bounds(&self, min: &Vector<3>, max: &Vector<3>) -> (Vector<3>, Vector<3>) {
        let (low, high) = match self {
            Shape::EverythingElse | Shape::HalfSpace { .. } => (*min, *max),
            Shape::Box { min, max } => (*min, *max),
            Shape::Ball { centre, radius: reach } | Shape::Shell { centre, outer: reach, .. } => {
                (centre.add_scalar(-reach), centre.add_scalar(*reach))
            }
            Shape::Union(parts) => parts
                .iter()
                .map(|part| part.bounds(min, max))
                .fold((*max, *min), |a, b| (a.0.inf(&b.0), a.1.sup(&b.1))),
            Shape::Difference(whole, _) => whole.bounds(min, max),
        };
        (low.sup(min), high.inf(max))
    }

    /// From where to where the region reaches along an axis, m; infinite where it has no end, or none is known.
    #[must_use]
    pub fn reach(&self, axis: usize) -> (f64, f64) {
        match self {
            Shape::EverythingElse | Shape::HalfSpace { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Shape::Box { min, max } => (min[axis], max[axis]),
            Shape::Ball { centre, radius: reach } | Shape::Shell { centre, outer: reach, .. } => {
                (centre[axis] - reach, centre[axis] + reach)
            }
            Shape::Union(parts) => parts
                .iter()
                .map(|part| part.reach(axis))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1))),
            Shape::Difference(whole, _) => whole.reach(axis),
        }
    }

    /// The same region elsewhere, `by` (m) further along an axis.
    #[must_use]
    pub fn shifted(&self, axis: usize, by: f64) -> Shape {
        let moved = |x: &Vector<3>| {
            let mut x = *x;
            x[axis] += by;
            x
        };
        let all = |parts: &[Shape]| parts.iter().map(|part| part.shifted(axis, by)).collect();
        match self {
            Shape::EverythingElse => Shape::EverythingElse,
            Shape::Box { min, max } => Shape::Box { min: moved(min), max: moved(max) },
            Shape::Ball { centre, radius } => Shape::Ball { centre: moved(centre), radius: *radius },
            Shape::Shell { centre, inner, outer } => {
                Shape::Shell { centre: moved(centre), inner: *inner, outer: *outer }
            }
            Shape::HalfSpace { point, normal } => Shape::HalfSpace { point: moved(point), normal: *normal },
            Shape::Union(parts) => Shape::Union(all(parts)),
            Shape::Difference(whole, holes) => {
                Shape::Difference(std::boxed::Box::new(whole.shifted(axis, by)), all(holes))
            }
        }
    }

    /// Closed polygons that draw the region in the x-y plane, m.
    #[must_use]
    pub fn outlines(&self, min: &Vector<3>, max: &Vector<3>) -> Vec<Vec<[f64; 2]>> {
        let circle = |centre: &Vector<3>, radius: f64| -> Vec<[f64; 2]> {
            (0..=96)
                .map(|k| {
                    let angle = f64::from(k) / 96.0 * std::f64::consts::TAU;
                    [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
                })
                .collect()
        };
        match self {
            Shape::EverythingElse | Shape::HalfSpace { .. } => Vec::new(),
            Shape::Box { .. } => {
                let (low, high) = self.bounds(min, max);
                let corners = [
                    [low[0], low[1]],
                    [high[0], low[1]],
                    [high[0], high[1]],
                    [low[0], high[1]],
                    [low[0], low[1]],
                ];
                vec![corners.to_vec()]
            }
            Shape::Ball { centre, radius } => vec![circle(centre, *radius)],
            Shape::Shell { centre, inner, outer } => vec![circle(centre, *outer), circle(centre, *inner)],
            Shape::Union(parts) => parts.iter().flat_map(|part| part.outlines(min, max)).collect(),
            Shape::Difference(whole, holes) => {
                let mut lines = whole.outlines(min, max);
                lines.extend(holes.iter().flat_map(|hole| hole.outlines(min, max)));
                lines
            }
        }
    }

    /// The region in words, lengths in µm.
    #[must_use]
    pub fn words(&self, dimensions: usize) -> String {
        let um = |v: f64| format!("{}", (v * 1e6 * 1e6).round() / 1e6).replace('-', "−");
        let place = |v: &Vector<3>| match dimensions {
            1 => um(v[0]),
            _ => format!("({})", (0..dimensions).map(|k| um(v[k])).collect::<Vec<_>>().join(", ")),
        };
        let (ball, shell) = if dimensions == 3 { ("ball", "shell") } else { ("disc", "ring") };
        match self {
            Shape::EverythingElse => "everything else".into(),
            Shape::Box { min, max } => format!("box {} to {} µm", place(min), place(max)),
            Shape::Ball { centre, radius } => {
                format!("{ball}, centre {} µm, radius {} µm", place(centre), um(*radius))
            }
            Shape::Shell { centre, inner, outer } => {
                format!("{shell}, centre {} µm, radii {} to {} µm", place(centre), um(*inner), um(*outer))
            }
            Shape::HalfSpace { point, normal } => {
                let n: Vec<String> = (0..dimensions).map(|k| significant(normal[k], 6)).collect();
                format!("half-space from {} µm towards ({})", place(point), n.join(", "))
            }
            Shape::Union(parts) => {
                parts.iter().map(|part| part.words(dimensions)).collect::<Vec<_>>().join(" and ")
            }
            Shape::Difference(whole, holes) => format!(
                "{} without {}",
                whole.words(dimensions),
                holes.iter().map(|hole| hole.words(dimensions)).collect::<Vec<_>>().join(" and ")
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> Vector<3> {
        Vector::from([x, y, 0.0])
    }

    #[test]
    fn distances_are_exact_for_simple_shapes() {
        let infinite = f64::INFINITY;
        let square = Shape::Box { min: [0.0, 0.0, -infinite].into(), max: [2.0, 1.0, infinite].into() };
        assert_eq!(square.signed_distance(&at(1.0, 0.5)), -0.5);
        assert_eq!(square.signed_distance(&at(5.0, 5.0)), 5.0);
        let ring = Shape::Shell { centre: at(0.0, 0.0), inner: 1.0, outer: 2.0 };
        assert_eq!(ring.signed_distance(&at(1.25, 0.0)), -0.25);
        assert_eq!(ring.signed_distance(&at(0.25, 0.0)), 0.75);
        let plane = Shape::HalfSpace { point: at(0.0, 1.0), normal: at(0.0, 1.0) };
        assert!(plane.holds(&at(0.0, 2.0)) && !plane.holds(&at(0.0, 0.5)));
    }

    #[test]
    fn differences_and_unions_combine() {
        let disc = |x: f64| Shape::Ball { centre: at(x, 0.0), radius: 1.0 };
        let moon = Shape::Difference(Box::new(disc(0.0)), vec![disc(1.0)]);
        assert!(moon.holds(&at(-0.5, 0.0)) && !moon.holds(&at(0.5, 0.0)));
        let two = Shape::Union(vec![disc(0.0), disc(3.0)]);
        assert!(two.holds(&at(3.5, 0.0)) && !two.holds(&at(1.5, 0.0)));
        assert_eq!((two.reach(0), two.reach(1)), ((-1.0, 4.0), (-1.0, 1.0)));
        assert!(moon.shifted(1, 2.0).holds(&at(-0.5, 2.0)) && !moon.shifted(1, 2.0).holds(&at(0.5, 2.0)));
    }
}
