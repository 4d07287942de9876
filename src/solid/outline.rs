//! The shape of a projection, measured on the outer surface of a closed wall.
//!
//! The body is the circle (sphere) fitted to the half of the surface that turns away from the tip; the tip is the node
//! farthest from its centre.

use crate::solid::hull::hull_volume;
use crate::solid::shell::Wall;
use crate::solid::surface::volume;
use crate::space::matrix::{Matrix, determinant, dyad, inverse};
use crate::vector::Vector;

/// What is measured of a projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline<const D: usize> {
    /// Where the tip is, m.
    pub tip: Vector<D>,
    /// From the body's centre to the tip, of length one.
    pub direction: Vector<D>,
    /// Radius of the body, m.
    pub radius: f64,
    /// How far the tip stands out of the body, m.
    pub length: f64,
    /// Full width at half the length, m.
    pub width: f64,
    /// Of the circle (sphere) through the tip and those around it, 1/m; negative where it caves in.
    pub tip_curvature: f64,
    /// Volume of the convex hull over the body's own.
    pub hull_ratio: f64,
}

impl<const D: usize> Outline<D> {
    /// Angle of the direction in the x-y plane, rad.
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.direction[1].atan2(self.direction[0])
    }

    /// Measures the surface of `nodes` (m) on the mesh of a wall.
    #[must_use]
    pub fn new(wall: &Wall<D>, nodes: &[Vector<D>]) -> Outline<D> {
        let middle = nodes.iter().sum::<Vector<D>>() / nodes.len().max(1) as f64;
        let farthest = |centre: &Vector<D>| {
            let far = |x: &Vector<D>| (x - centre).norm_squared();
            nodes.iter().enumerate().max_by(|a, b| far(a.1).total_cmp(&far(b.1))).map_or(0, |one| one.0)
        };
        let (mut centre, mut radius) = round(nodes.iter()).unwrap_or((middle, 0.0));
        let mut tip = farthest(&centre);
        // The half depends on the tip and the tip on the half; they settle in a few rounds.
        for _ in 0..8 {
            let axis = nodes[tip] - centre;
            let behind = nodes.iter().filter(|x| (*x - middle).dot(&axis) <= 0.0);
            let Some((better, its)) = round(behind) else { break };
            (centre, radius) = (better, its);
            let next = farthest(&centre);
            if next == tip {
                break;
            }
            tip = next;
        }
        let reach = (nodes[tip] - centre).norm();
        let direction = (nodes[tip] - centre) / reach.max(f64::MIN_POSITIVE);
        let length = reach - radius;
        Outline {
            tip: nodes[tip],
            direction,
            radius,
            length,
            width: width(wall, nodes, &centre, &direction, radius + 0.5 * length),
            tip_curvature: curvature(wall, nodes, tip, &direction),
            hull_ratio: hull_volume(nodes) / volume(nodes, &wall.faces),
        }
    }
}

/// Centre and radius of the circle (sphere) that fits best (Kåsa 1976); none if the points lie in a plane.
fn round<'a, const D: usize>(
    points: impl Iterator<Item = &'a Vector<D>> + Clone,
) -> Option<(Vector<D>, f64)> {
    let count = points.clone().count();
    let mean = points.clone().sum::<Vector<D>>() / count.max(1) as f64;
    let (mut moment, mut third, mut square) = (Matrix::<D>::zeros(), Vector::<D>::zeros(), 0.0);
    for x in points.map(|x| x - mean) {
        moment += dyad(&x, &x);
        third += x * x.norm_squared();
        square += x.norm_squared();
    }
    let flat = determinant(&moment) <= 1e-9 * (square / D as f64).powi(D as i32);
    if count <= D || flat {
        return None;
    }
    let centre = inverse(&moment) * third * 0.5;
    Some((mean + centre, (centre.norm_squared() + square / count as f64).sqrt()))
}

/// Width of the surface where it crosses the plane at `height` (m) along `axis` from `centre`: in 2D from one side to the
/// other, in 3D twice the mean distance from the middle of the crossings.
fn width<const D: usize>(
    wall: &Wall<D>,
    nodes: &[Vector<D>],
    centre: &Vector<D>,
    axis: &Vector<D>,
    height: f64,
) -> f64 {
    let level = |node: u32| (nodes[node as usize] - centre).dot(axis) - height;
    let crossings: Vec<Vector<D>> = wall
        .edges()
        .iter()
        .filter(|edge| (level(edge[0]) > 0.0) != (level(edge[1]) > 0.0))
        .map(|&[a, b]| {
            let (below, above) = (level(a), level(b));
            nodes[a as usize] + (nodes[b as usize] - nodes[a as usize]) * (below / (below - above))
        })
        .collect();
    if crossings.is_empty() {
        return 0.0;
    }
    let middle = crossings.iter().sum::<Vector<D>>() / crossings.len() as f64;
    2.0 * crossings.iter().map(|x| (x - middle).norm()).sum::<f64>() / crossings.len() as f64
}

/// Curvature of the circle (sphere) through a node and its neighbours of first and second degree, 1/m.
fn curvature<const D: usize>(wall: &Wall<D>, nodes: &[Vector<D>], tip: usize, outward: &Vector<D>) -> f64 {
    let mut near = vec![tip as u32];
    for _ in 0..2 {
        let known = near.clone();
        near.extend(wall.faces.iter().filter(|face| face.iter().any(|node| known.contains(node))).flatten());
        near.sort_unstable();
        near.dedup();
    }
    let points = near.iter().map(|&node| &nodes[node as usize]);
    let side = |centre: Vector<D>| (nodes[tip] - centre).dot(outward).signum();
    round(points).map_or(0.0, |(centre, radius)| side(centre) / radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit ball with a rod of half width 0.3 that ends in half a ball, the tip at 2.
    fn finger<const D: usize>(axis: Vector<D>) -> Outline<D> {
        let built = Wall::<D>::round(&Vector::from_element(5.0), 0.95, 1.05, 0.02);
        let nodes: Vec<Vector<D>> = built
            .wall
            .middle(|i| built.places[i])
            .iter()
            .map(|x| {
                let d = (x - Vector::from_element(5.0)).normalize();
                let along = d.dot(&axis);
                let aside = d - axis * along;
                // Where the ray first leaves ball, rod and cap together.
                let (mut low, mut high) = (1.0, 2.0);
                for _ in 0..60 {
                    let r = 0.5 * (low + high);
                    let (z, w) = (r * along, r * aside.norm());
                    let inside = z > 0.0 && if z > 1.7 { (z - 1.7).hypot(w) < 0.3 } else { w < 0.3 };
                    if inside { low = r } else { high = r }
                }
                Vector::from_element(5.0) + d * if low > 1.0 { low } else { 1.0 }
            })
            .collect();
        Outline::new(&built.wall, &nodes)
    }

    #[test]
    fn a_finger_is_measured() {
        // The nodes are a fiftieth apart: angle, tip and width to their distance or better.
        let (flat, round) = (finger(Vector::<2>::new(0.6, 0.8)), finger(Vector::<3>::new(0.0, 0.0, -1.0)));
        for (length, width, curvature) in
            [(flat.length, flat.width, flat.tip_curvature), (round.length, round.width, round.tip_curvature)]
        {
            assert!((length - 1.0).abs() < 2e-3, "{length}");
            assert!((width - 0.6).abs() < 0.03, "{width}");
            assert!((curvature - 1.0 / 0.3).abs() < 0.1, "{curvature}");
        }
        assert!((flat.angle() - 0.8_f64.atan2(0.6)).abs() < 0.02 && (round.direction[2] + 1.0).abs() < 1e-3);
        // Tangents from the ball to the cap meet them at θ from the axis, cos θ = (1 - 0.3)/1.7.
        let (pi, theta) = (std::f64::consts::PI, (0.7_f64 / 1.7).acos());
        let hull = (pi - theta) + 0.09 * theta + 1.3 * 1.7 * theta.sin();
        // The ball less its segment in the rod, the rod from there on, half the cap.
        let neck = 0.3_f64.asin();
        let own = (pi - neck) + 0.3 * neck.cos() + 0.6 * (1.7 - neck.cos()) + 0.045 * pi;
        // Rays along the rod's sides are far apart.
        assert!((flat.hull_ratio / (hull / own) - 1.0).abs() < 0.02, "{}", flat.hull_ratio);
    }

    #[test]
    fn a_ball_has_no_projection() {
        let built = Wall::<2>::round(&Vector::zeros(), 0.8, 1.0, 0.05);
        let outline = Outline::new(&built.wall, &built.wall.outer(|i| built.places[i]));
        // Rounding; its own hull.
        assert!(outline.length.abs() < 1e-12 && (outline.hull_ratio - 1.0).abs() < 1e-12);
        assert!((outline.tip_curvature - 1.0).abs() < 1e-9 && (outline.radius - 1.0).abs() < 1e-12);
    }
}
