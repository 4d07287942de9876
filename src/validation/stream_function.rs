//! The stream function of a flow in a closed unit square, from velocities read off at the edges of a grid.

use crate::figures::contour::GridField;
use crate::vector::Vector;

/// A grid of `cells` x `cells` over the unit square.
#[derive(Clone, Copy, Debug)]
pub struct Mesh {
    pub cells: usize,
}

impl Mesh {
    fn width(self) -> f64 {
        1.0 / self.cells as f64
    }

    /// Where velocities are wanted: the middles of the inner upright edges row by row, then of the level ones.
    #[must_use]
    pub fn places(self) -> Vec<Vector<2>> {
        let (n, d) = (self.cells, self.width());
        let upright = (0..n).flat_map(|j| (1..n).map(move |i| [i as f64 * d, (j as f64 + 0.5) * d]));
        let level = (1..n).flat_map(|j| (0..n).map(move |i| [(i as f64 + 0.5) * d, j as f64 * d]));
        upright.chain(level).map(Vector::from).collect()
    }

    /// Stream function ψ with u = ∂ψ/∂y, v = -∂ψ/∂x and ψ = 0 at the walls, from velocities at [`Mesh::places`].
    ///
    /// The ψ whose differences along the edges are nearest to those of the velocities: on every inner node the
    /// five-point sum of ψ equals the circulation round it. What diverges in the velocities drops out.
    #[must_use]
    pub fn stream_function(self, velocity: &[Vector<2>]) -> GridField {
        let (n, d) = (self.cells, self.width());
        let u = |i: usize, j: usize| velocity.get(j * (n - 1) + i - 1).map_or(f64::NAN, |v| v[0]);
        let v = |i: usize, j: usize| velocity.get(n * (n - 1) + (j - 1) * n + i).map_or(f64::NAN, |v| v[1]);
        let circulation = |i: usize, j: usize| d * (u(i, j) - u(i, j - 1) - v(i, j) + v(i - 1, j));
        let nodes = n + 1;
        let mut psi = vec![0.0; nodes * nodes];
        let right: Vec<f64> =
            (1..n).flat_map(|j| (1..n).map(move |i| (i, j))).map(|(i, j)| circulation(i, j)).collect();
        // Successive over-relaxation with the best factor of the square (Young 1954) loses a digit in about
        // n/2.7 rounds; twelve are wanted.
        let factor = 2.0 / (1.0 + (std::f64::consts::PI * d).sin());
        for _ in 0..5 * n {
            for j in 1..n {
                for i in 1..n {
                    let k = j * nodes + i;
                    let around = psi[k - 1] + psi[k + 1] + psi[k - nodes] + psi[k + nodes];
                    let wanted = 0.25 * (around - right[(j - 1) * (n - 1) + i - 1]);
                    psi[k] += factor * (wanted - psi[k]);
                }
            }
        }
        let line: Vec<f64> = (0..nodes).map(|k| k as f64 * d).collect();
        GridField { x: line.clone(), y: line, values: psi }
    }
}

/// The velocity u = ∂ψ/∂y, v = -∂ψ/∂x at a place, of a stream function that is bilinear between the nodes of a square grid.
#[must_use]
pub fn velocity_of(psi: &GridField, place: &Vector<2>) -> Vector<2> {
    let (nodes, d) = (psi.x.len(), psi.x[1] - psi.x[0]);
    let cell = |s: f64| ((s / d).floor().max(0.0) as usize).min(nodes - 2);
    let (i, j) = (cell(place[0]), cell(place[1]));
    let (s, t) = (place[0] / d - i as f64, place[1] / d - j as f64);
    let at = |i: usize, j: usize| psi.values[j * nodes + i];
    let up = |i: usize| (at(i, j + 1) - at(i, j)) / d;
    let right = |j: usize| (at(i + 1, j) - at(i, j)) / d;
    Vector::from([up(i) * (1.0 - s) + up(i + 1) * s, -right(j) * (1.0 - t) - right(j + 1) * t])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_known_vortex_is_found_again_whatever_diverges() {
        let mesh = Mesh { cells: 64 };
        // ψ = sin²(πx) sin²(πy), and a gradient on top that carries no circulation.
        let velocity = |x: &Vector<2>| {
            let (a, b) = (PI * x[0], PI * x[1]);
            let curl = [a.sin().powi(2) * (2.0 * b).sin() * PI, -(2.0 * a).sin() * b.sin().powi(2) * PI];
            Vector::from([curl[0] + 0.1 * PI * a.cos() * b.sin(), curl[1] + 0.1 * PI * a.sin() * b.cos()])
        };
        let values: Vec<Vector<2>> = mesh.places().iter().map(velocity).collect();
        let psi = mesh.stream_function(&values);
        let wrong = |i: usize, j: usize| {
            let exact = ((PI * psi.x[i]).sin() * (PI * psi.y[j]).sin()).powi(2);
            (psi.at(i, j) - exact).abs()
        };
        let nodes = (0..65).flat_map(|j| (0..65).map(move |i| (i, j)));
        let worst = nodes.map(|(i, j)| wrong(i, j)).fold(0.0, f64::max);
        // Second order: (2π/64)²/24 of the largest value of 1 is 4e-4.
        assert!(worst < 5e-4, "{worst}");
        let x = Vector::from([0.3, 0.61]);
        let (a, b) = (PI * x[0], PI * x[1]);
        let curl = Vector::from([a.sin().powi(2) * (2.0 * b).sin(), -(2.0 * a).sin() * b.sin().powi(2)]) * PI;
        // First order across the cells: half a cell times π² ψ'' of order one, at most.
        assert!((velocity_of(&psi, &x) - curl).norm() < 0.1, "{} {curl}", velocity_of(&psi, &x));
    }
}
