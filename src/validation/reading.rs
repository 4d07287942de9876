//! Fields of a plane flow at any place, by moving least squares of second order.
//!
//! A profile bends within a cut-off: weights that are exact for straight lines only would add h²u''/20 or so to
//! the error of the flow, 2e-3 of the lid's speed for 50 particles across a cavity. These are exact for parabolas.

use super::flow::Look;
use crate::fluid::{Domain, Grid, Kernel};
use crate::vector::Vector;
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

/// Particles that carry a field.
#[derive(Clone, Copy)]
pub struct Carriers<'a> {
    pub positions: &'a [Vector<2>],
    pub domain: &'a Domain<2>,
    pub kernel: &'a Kernel<2>,
}

/// Velocities of a flow at `points`, m/s; `known` are places of walls and their velocities. Not a number where too few
/// particles are near.
#[must_use]
pub fn velocities(look: &Look<2>, points: &[Vector<2>], known: &[(Vector<2>, Vector<2>)]) -> Vec<Vector<2>> {
    let kernel = look.plan.kernel();
    let carriers = Carriers { positions: &look.position, domain: &look.plan.domain, kernel: &kernel };
    let component = |axis: usize| {
        let known: Vec<(Vector<2>, f64)> = known.iter().map(|(x, v)| (*x, v[axis])).collect();
        readings(&carriers, points, &known, |i| look.velocity[i][axis])
    };
    let [u, v] = [component(0), component(1)];
    u.iter().zip(&v).map(|(u, v)| Vector::from([*u, *v])).collect()
}

/// A field of the particles at `points`.
#[must_use]
pub fn field(carriers: &Carriers, points: &[Vector<2>], value: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
    readings(carriers, points, &[], value)
}

/// A field at `points`; `known` are further places with their values, such as those of a surface, each
/// with the weight of a particle at the point itself.
#[must_use]
pub fn readings(
    carriers: &Carriers,
    points: &[Vector<2>],
    known: &[(Vector<2>, f64)],
    value: impl Fn(usize) -> f64 + Sync,
) -> Vec<f64> {
    let grid = Grid::build(carriers.positions, carriers.domain, carriers.kernel.cutoff());
    points.par_iter().map(|point| fit(point, &grid, carriers, known, &value)).collect()
}

/// The parabola that fits the particles in reach best, weighted by W, at the point.
fn fit(
    point: &Vector<2>,
    grid: &Grid<2>,
    carriers: &Carriers,
    known: &[(Vector<2>, f64)],
    value: &impl Fn(usize) -> f64,
) -> f64 {
    let h = carriers.kernel.cutoff();
    let weight = |r: f64| h * h * carriers.kernel.value(r);
    let mut near: Vec<(usize, Vector<2>, f64)> = Vec::new();
    grid.for_each_near(point, carriers.positions, |j, x, r2| near.push((j, -x / h, weight(r2.sqrt()))));
    near.sort_unstable_by_key(|&(j, _, _)| j);
    let mut matrix = SMatrix::<f64, 6, 6>::zeros();
    let mut right = SVector::<f64, 6>::zeros();
    let mut add = |y: Vector<2>, w: f64, value: f64| {
        let basis = SVector::<f64, 6>::from([1.0, y[0], y[1], y[0] * y[0], y[0] * y[1], y[1] * y[1]]);
        matrix += w * basis * basis.transpose();
        right += w * value * basis;
    };
    for &(j, y, w) in &near {
        add(y, w, value(j));
    }
    for (place, value) in known {
        let away = place - point;
        if away.norm() < h {
            add(away / h, weight(0.0), *value);
        }
    }
    // A breath of damping of the slopes and bends, for the few particles of a corner.
    let damping = 1e-8 * matrix[(0, 0)];
    for k in 1..6 {
        matrix[(k, k)] += damping;
    }
    match matrix.cholesky() {
        Some(factors) => factors.solve(&right)[0],
        None => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::KernelKind;
    use rand::{Rng, SeedableRng};

    #[test]
    fn parabolas_are_read_exactly_up_to_the_wall() {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        let mut place = || Vector::from([random.random::<f64>(), random.random::<f64>()]);
        let positions: Vec<Vector<2>> = (0..900).map(|_| place()).collect();
        let mut points: Vec<Vector<2>> = (0..40).map(|_| place()).collect();
        points.push(Vector::from([1.0, 0.5]));
        let domain = Domain { min: Vector::zeros(), max: Vector::from_element(1.0), periodic: [false; 2] };
        let kernel = Kernel::new(KernelKind::Lucy, 0.15);
        let carriers = Carriers { positions: &positions, domain: &domain, kernel: &kernel };
        let parabola = |x: &Vector<2>| 1.0 + x[0] - 2.0 * x[1] * x[1] + 3.0 * x[0] * x[1];
        for (x, found) in points.iter().zip(readings(&carriers, &points, &[], |i| parabola(&positions[i]))) {
            // The damping of 1e-8 of all weights, over the few per cent that the second moments are of it.
            assert!((found - parabola(x)).abs() < 1e-5, "{found}");
        }
    }
}
