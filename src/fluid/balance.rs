//! The pressure that goes with a velocity: that of an incompressible flow. A start without it rings.
//!
//! div v = 0 at all times asks for -∇²p = rho tr(∇v ∇v), with no flux of momentum through walls. The Laplacian
//! is that of friction, Σ 2 V_j F (p_i - p_j) over fluid neighbours, so that V_i times it is symmetric and never
//! negative; conjugate gradients solve it up to a constant, which is chosen for a mean of zero. Solids are left
//! out (Neumann conditions); a periodic box or a closed one, the same.

use crate::fluid::flow::Flow;
use crate::fluid::particles::Material;
use crate::vector::Vector;
use nalgebra::SMatrix;

/// Residual, relative to the right-hand side, at which the pressure is good enough: far below the 1 % the pairs
/// themselves err.
const TOLERANCE: f64 = 1e-6;
/// Most rounds; a box of n particles across takes about n.
const ROUNDS: usize = 2000;

impl<const D: usize> Flow<D> {
    /// Sets pressure and density of the fluid to those of an incompressible flow of the present velocities. Asks for
    /// the contacts of [`Flow::densities`] and the mirrored velocities of [`Flow::mirrors`].
    pub(super) fn balance_pressure(&mut self) {
        let source = self.source();
        let scale = inner(&source, &source);
        if scale == 0.0 {
            return;
        }
        let mut pressure = vec![0.0; source.len()];
        let mut residual = source;
        let mut direction = residual.clone();
        let mut image = vec![0.0; residual.len()];
        let mut left = scale;
        for _ in 0..ROUNDS {
            if left <= TOLERANCE * TOLERANCE * scale {
                break;
            }
            self.laplacian(&direction, &mut image);
            let bend = inner(&direction, &image);
            if bend <= 0.0 {
                break;
            }
            let step = left / bend;
            for i in 0..pressure.len() {
                pressure[i] += step * direction[i];
                residual[i] -= step * image[i];
            }
            let now = inner(&residual, &residual);
            for (d, r) in direction.iter_mut().zip(&residual) {
                *d = r + now / left * *d;
            }
            left = now;
        }
        let (mut sum, mut volume) = (0.0, 0.0);
        for (side, p) in self.sides.iter().zip(&pressure).filter(|(side, _)| !side.is_solid()) {
            sum += p * side.volume;
            volume += side.volume;
        }
        let (state, c) = (self.setup.state, self.sound_speed);
        for ((side, own), p) in self.sides.iter_mut().zip(&self.own).zip(&pressure) {
            if !side.is_solid() {
                side.density = state.density(p - sum / volume, own.rest_density, c);
                side.pressure = state.pressure(side.density, own.rest_density, c);
                side.volume = own.mass / side.density;
                side.invert();
            }
        }
    }

    /// V_i rho_i tr(∇v ∇v) of the fluid less its mean, zero for solids.
    fn source(&self) -> Vec<f64> {
        let mut spread = vec![SMatrix::<f64, D, D>::zeros(); self.sides.len()];
        self.each_way(|i, j, x, f| {
            let (side, other) = (&self.sides[i], &self.sides[j]);
            if other.material == Material::FreeSlip {
                return; // it shows a mirrored velocity as if the fluid stuck to it
            }
            spread[i] += (side.velocity - other.velocity) * (x * (f * other.volume)).transpose();
        });
        let mut source = vec![0.0; self.sides.len()];
        let (mut sum, mut volume) = (0.0, 0.0);
        for ((source, spread), side) in source.iter_mut().zip(&spread).zip(&self.sides) {
            if !side.is_solid() {
                *source = side.volume * side.density * (spread * spread).trace();
                sum += *source;
                volume += side.volume;
            }
        }
        for (source, side) in source.iter_mut().zip(&self.sides).filter(|(_, side)| !side.is_solid()) {
            *source -= sum * side.volume / volume;
        }
        source
    }

    /// Σ_j 2 V_i V_j F (p_i - p_j) over the fluid.
    fn laplacian(&self, p: &[f64], image: &mut [f64]) {
        image.fill(0.0);
        self.each_way(|i, j, _, f| {
            if !self.sides[j].is_solid() {
                image[i] += 2.0 * self.sides[i].volume * self.sides[j].volume * f * (p[i] - p[j]);
            }
        });
    }

    /// Calls `see(i, j, x_i - x_j, F)` for every fluid particle i and all its neighbours j.
    pub(super) fn each_way(&self, mut see: impl FnMut(usize, usize, Vector<D>, f64)) {
        for block in &self.blocks {
            for row in 0..block.near_solid.len() {
                let i = block.first + row;
                if self.sides[i].is_solid() {
                    continue;
                }
                for c in block.inner.row(row) {
                    see(i, c.j as usize, c.x, c.weight);
                    see(c.j as usize, i, -c.x, c.weight);
                }
                for c in block.outer.row(row).chain(block.row(row)) {
                    see(i, c.j as usize, c.x, c.weight);
                }
            }
        }
    }
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
