//! The volume of the convex hull of points, in 2D its area.

use crate::random::mix;
use crate::vector::Vector;

/// The volume of the convex hull, m^D; zero for points in a plane.
#[must_use]
pub fn hull_volume<const D: usize>(points: &[Vector<D>]) -> f64 {
    let centre = points.iter().sum::<Vector<D>>() / points.len().max(1) as f64;
    if D == 2 {
        return flat(points.iter().map(|x| [x[0] - centre[0], x[1] - centre[1]]).collect());
    }
    let mut found: Vec<Vector<3>> =
        points.iter().map(|x| Vector::<3>::from_fn(|k, _| x[k] - centre[k])).collect();
    let size = found.iter().map(Vector::norm).fold(0.0, f64::max);
    for (i, x) in found.iter_mut().enumerate() {
        *x += Vector::<3>::from_fn(|k, _| APART * size * shift(3 * i + k));
    }
    solid(&found)
}

/// Points are moved by that part of the size of them all, so that no four lie in a plane: what a face sees is then never
/// in doubt. The volume is as exact.
const APART: f64 = 1e-8;

/// A number between -1 and 1 of its own for every `i`.
fn shift(i: usize) -> f64 {
    (mix(i as u64) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Monotone chain (Andrew 1979).
fn flat(mut points: Vec<[f64; 2]>) -> f64 {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turn =
        |o: [f64; 2], a: [f64; 2], b: [f64; 2]| (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    let mut twice = 0.0;
    for round in 0..2 {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for &point in &points {
            while chain.len() > 1 && turn(chain[chain.len() - 2], chain[chain.len() - 1], point) <= 0.0 {
                chain.pop();
            }
            chain.push(point);
        }
        twice += chain.windows(2).map(|w| w[0][0] * w[1][1] - w[0][1] * w[1][0]).sum::<f64>();
        if round == 0 {
            points.reverse();
        }
    }
    0.5 * twice
}

/// One point after the other: the faces that see it give way to a cone from their rim.
fn solid(points: &[Vector<3>]) -> f64 {
    let size = points.iter().map(Vector::norm).fold(0.0, f64::max);
    let above = |face: &[usize; 3], x: &Vector<3>| {
        let [a, b, c] = face.map(|i| points[i]);
        let normal = (b - a).cross(&(c - a));
        (x - a).dot(&normal) > 0.0
    };
    let Some(mut faces) = first(points, size) else { return 0.0 };
    // A corner must not be asked whether it sees its own faces: rounding would answer.
    let corners = faces.concat();
    let mut seen: Vec<(usize, usize)> = Vec::new();
    for (number, x) in points.iter().enumerate().filter(|one| !corners.contains(&one.0)) {
        seen.clear();
        faces.retain(|face| {
            let visible = above(face, x);
            if visible {
                seen.extend((0..3).map(|k| (face[k], face[(k + 1) % 3])));
            }
            !visible
        });
        seen.sort_unstable();
        for &(a, b) in &seen {
            if seen.binary_search(&(b, a)).is_err() {
                faces.push([a, b, number]);
            }
        }
        // A hull has fewer than two faces for each point; more would be a fault of rounding.
        if faces.len() > 2 * points.len() + 4 {
            return f64::NAN;
        }
    }
    faces.iter().map(|face| face.map(|i| points[i])).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
}

/// A tetrahedron of four of the points, faces outward; none if all lie in a plane.
fn first(points: &[Vector<3>], size: f64) -> Option<Vec<[usize; 3]>> {
    let all = 0..points.len();
    let farthest = |of: &dyn Fn(usize) -> f64| all.clone().max_by(|&a, &b| of(a).total_cmp(&of(b)));
    let a = farthest(&|i| points[i].norm())?;
    let b = farthest(&|i| (points[i] - points[a]).norm())?;
    let along = points[b] - points[a];
    let c = farthest(&|i| (points[i] - points[a]).cross(&along).norm())?;
    let normal = (points[c] - points[a]).cross(&along);
    let d = farthest(&|i| (points[i] - points[a]).dot(&normal).abs())?;
    let height = (points[d] - points[a]).dot(&normal);
    if height.abs() <= 1e-6 * size * normal.norm() {
        return None;
    }
    // Seen from outside the face opposite to d turns away from it.
    let (b, c) = if height > 0.0 { (b, c) } else { (c, b) };
    Some(vec![[a, b, c], [a, c, d], [c, b, d], [b, a, d]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_of_boxes() {
        let mut flat: Vec<Vector<2>> = Vec::new();
        let mut cube: Vec<Vector<3>> = Vec::new();
        for i in 0..4 {
            for j in 0..4 {
                flat.push(Vector::<2>::new(f64::from(i), 0.5 * f64::from(j)));
                for k in 0..4 {
                    cube.push(Vector::<3>::new(f64::from(i), 0.5 * f64::from(j), 2.0 * f64::from(k)));
                }
            }
        }
        // By hand; rounding, and the shift of the points.
        assert!((hull_volume(&flat) - 4.5).abs() < 1e-13, "{}", hull_volume(&flat));
        assert!((hull_volume(&cube) - 27.0).abs() < 1e-5, "{}", hull_volume(&cube));
        assert_eq!(hull_volume(&cube[..4]), 0.0);
    }

    #[test]
    fn many_points_in_a_ball_have_its_hull() {
        // 3000 points at random on a sphere and in it: V = 4/3 π less a few tenths of a per cent.
        let points: Vec<Vector<3>> = (0..6000)
            .map(|i| {
                let x = Vector::<3>::from_fn(|k, _| shift(7 + 5 * i + k)).normalize();
                if i % 2 == 0 { x } else { x * 0.5 }
            })
            .collect();
        let ratio = hull_volume(&points) / (4.0 / 3.0 * std::f64::consts::PI);
        assert!((0.99..1.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_convex_body_is_its_own_hull() {
        use crate::solid::{Wall, surface::volume};
        let built = Wall::<3>::round(&Vector::from_element(1.0), 0.8, 1.2, 0.1);
        let nodes = built.wall.middle(|i| built.places[i]);
        for shells in [0.2, 0.3, 0.4] {
            let built = Wall::<3>::round(&Vector::zeros(), 3.8, 5.0, shells);
            let nodes = built.wall.outer(|i| built.places[i]);
            assert!((hull_volume(&nodes) / volume(&nodes, &built.wall.faces) - 1.0).abs() < 1e-3);
        }
        // A geodesic sphere is convex up to the choice of diagonals, of second order in the spacing.
        assert!((hull_volume(&nodes) / volume(&nodes, &built.wall.faces) - 1.0).abs() < 1e-3);
    }
}
