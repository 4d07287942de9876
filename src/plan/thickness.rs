//! How thin a shape is.

use crate::geometry::Shape;
use crate::geometry::shape::embed;
use crate::space::{Domain, Grid};
use crate::vector::Vector;

/// The least thickness of a shape filled with particles a `spacing` (m) apart, and where: twice the least depth of
/// those points that lie deeper than all round them. Rounded ends and corners do not count.
pub(super) fn thinnest<const D: usize>(
    shape: &Shape,
    places: &[Vector<D>],
    spacing: f64,
) -> (f64, Vector<3>) {
    let depth = |x: &Vector<D>| -shape.signed_distance(&embed(x));
    let depths: Vec<f64> = places.iter().map(&depth).collect();
    let everywhere = Domain { min: Vector::zeros(), max: Vector::zeros(), periodic: [false; D] };
    let reach = 1.6 * spacing;
    let grid = Grid::build(places, &everywhere, reach);
    let mut least = (f64::INFINITY, Vector::zeros());
    for (i, place) in places.iter().enumerate() {
        let mut deepest = true;
        grid.for_each_near(place, places, |j, _, _| deepest &= depths[j] <= depths[i] + 1e-9 * spacing);
        if deepest {
            let (x, deep) = climb(place, spacing, depth);
            if 2.0 * deep < least.0 {
                least = (2.0 * deep, embed(&x));
            }
        }
    }
    least
}

/// The deepest point within about a spacing of a place, by trial.
fn climb<const D: usize>(
    start: &Vector<D>,
    spacing: f64,
    depth: impl Fn(&Vector<D>) -> f64,
) -> (Vector<D>, f64) {
    let (mut x, mut deep) = (*start, depth(start));
    let mut step = 0.5 * spacing;
    while step > 1e-3 * spacing {
        let mut better = false;
        // Along the axes and between them: beside an end it is deeper along both only.
        for code in 0..3_usize.pow(D as u32) {
            let trial =
                x + Vector::<D>::from_fn(|k, _| (code / 3_usize.pow(k as u32) % 3) as f64 - 1.0) * step;
            let found = depth(&trial);
            if found > deep && (trial - start).norm() <= spacing {
                (x, deep, better) = (trial, found, true);
            }
        }
        if !better {
            step *= 0.5;
        }
    }
    (x, deep)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Fill, Lattice, fill};
    use crate::random::{Purpose, stream};

    fn of(shape: &Shape, spacing: f64) -> f64 {
        let region = Fill { shape, without: vec![], lattice: Lattice::Fitted, spacing, jitter: 0.0 };
        let mut random = stream(1, 0, Purpose::Placement);
        let found = fill::<2>(&region, &[-5.0, -5.0].into(), &[5.0, 5.0].into(), &mut random);
        let places: Vec<Vector<2>> = found.into_iter().map(|(x, _)| x).collect();
        thinnest(shape, &places, spacing).0
    }

    #[test]
    fn thickness_of_shapes_is_that_of_their_narrowest_part() {
        let rod = |x: [f64; 2], y: [f64; 2]| Shape::Box {
            min: [x[0], y[0], f64::NEG_INFINITY].into(),
            max: [x[1], y[1], f64::INFINITY].into(),
        };
        // Trial steps end at a thousandth of a spacing.
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-3, "{a} for {b}");
        for across in [2.0, 3.0, 4.0, 7.0] {
            near(of(&rod([-2.0, 2.0], [0.0, 0.4]), 0.4 / across), 0.4);
        }
        near(of(&Shape::Shell { centre: Vector::zeros(), inner: 2.0, outer: 2.5 }, 0.1), 0.5);
        near(of(&Shape::Ball { centre: Vector::zeros(), radius: 1.0 }, 0.13), 2.0);
        let flag = Shape::Union(vec![rod([0.0, 1.0], [0.0, 1.0]), rod([1.0, 3.0], [0.4, 0.7])]);
        near(of(&flag, 0.05), 0.3);
    }
}
