//! The volume of the convex hull of points, in 2D its area.

use crate::vector::Vector;

/// The volume of the convex hull, m^D; zero for points in a plane.
#[must_use]
pub fn hull_volume<const D: usize>(points: &[Vector<D>]) -> f64 {
    let centre = points.iter().sum::<Vector<D>>() / points.len().max(1) as f64;
    if D == 2 {
        return flat(points.iter().map(|x| [x[0] - centre[0], x[1] - centre[1]]).collect());
    }
    solid(&points.iter().map(|x| Vector::<3>::from_fn(|k, _| x[k] - centre[k])).collect::<Vec<_>>())
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
        (x - a).dot(&normal) > 1e-12 * size * normal.norm()
    };
    let Some(mut faces) = first(points, size) else { return 0.0 };
    let mut seen: Vec<(usize, usize)> = Vec::new();
    for (number, x) in points.iter().enumerate() {
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
    if height.abs() <= 1e-12 * size * normal.norm() {
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
        // By hand; rounding.
        assert!((hull_volume(&flat) - 4.5).abs() < 1e-13, "{}", hull_volume(&flat));
        assert!((hull_volume(&cube) - 27.0).abs() < 1e-12, "{}", hull_volume(&cube));
        assert_eq!(hull_volume(&cube[..4]), 0.0);
    }

    #[test]
    fn a_convex_body_is_its_own_hull() {
        use crate::solid::{Wall, surface::volume};
        let built = Wall::<3>::round(&Vector::from_element(1.0), 0.8, 1.2, 0.1);
        let nodes = built.wall.middle(|i| built.places[i]);
        // A geodesic sphere is convex up to the choice of diagonals, of second order in the spacing.
        assert!((hull_volume(&nodes) / volume(&nodes, &built.wall.faces) - 1.0).abs() < 1e-3);
    }
}
