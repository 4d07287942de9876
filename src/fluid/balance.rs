//! The pressure that goes with a velocity: that of an incompressible flow. A start without it rings.
//!
//! div v = 0 at all times asks for -∇²p = rho tr(∇v ∇v), with no flux of momentum through walls. The Laplacian
//! is that of friction, Σ 2 V_j F (p_i - p_j) over fluid neighbours, so that V_i times it is symmetric and never
//! negative; conjugate gradients solve it up to a constant, which is chosen for a mean of zero. Solids are left
//! out (Neumann conditions); a periodic box or a closed one, the same. Fluid parted by walls has a constant for each part.

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
        let regions = self.regions();
        let mut source = self.source();
        let means = self.means(&regions, |i| source[i]);
        for ((source, mean), side) in source.iter_mut().zip(means).zip(&self.sides) {
            *source -= mean * side.volume;
        }
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
        let means = self.means(&regions, |i| pressure[i] * self.sides[i].volume);
        let (state, c) = (self.setup.state, self.sound_speed);
        for (((side, own), p), mean) in self.sides.iter_mut().zip(&self.own).zip(&pressure).zip(means) {
            if !side.is_solid() {
                side.density = state.density(p - mean, own.rest_density, c);
                side.pressure = state.pressure(side.density, own.rest_density, c);
                side.volume = own.mass / side.density;
                side.invert();
            }
        }
    }

    /// V_i rho_i tr(∇v ∇v) of the fluid, zero for solids.
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
        for ((source, spread), side) in source.iter_mut().zip(&spread).zip(&self.sides) {
            if !side.is_solid() {
                *source = side.volume * side.density * (spread * spread).trace();
            }
        }
        source
    }

    /// For each particle the number of the connected part of the fluid it belongs to, itself for solids.
    fn regions(&self) -> Vec<u32> {
        fn root(parent: &mut [u32], mut i: u32) -> u32 {
            while parent[i as usize] != i {
                parent[i as usize] = parent[parent[i as usize] as usize];
                i = parent[i as usize];
            }
            i
        }
        let mut parent: Vec<u32> = (0..self.sides.len() as u32).collect();
        self.each_way(|i, j, _, _| {
            if !self.sides[j].is_solid() {
                let (a, b) = (root(&mut parent, i as u32), root(&mut parent, j as u32));
                parent[a.max(b) as usize] = a.min(b);
            }
        });
        (0..parent.len() as u32).map(|i| root(&mut parent, i)).collect()
    }

    /// Means over the part of the fluid that each particle belongs to of what it holds, `held(i)`, over its volume.
    fn means(&self, regions: &[u32], held: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.sides.len()];
        for (i, side) in self.sides.iter().enumerate().filter(|(_, side)| !side.is_solid()) {
            let (sum, volume) = &mut sums[regions[i] as usize];
            *sum += held(i);
            *volume += side.volume;
        }
        let mean = |&region: &u32| {
            let (sum, volume) = sums[region as usize];
            if volume > 0.0 { sum / volume } else { 0.0 }
        };
        regions.iter().map(mean).collect()
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

#[cfg(test)]
mod tests {
    use crate::fluid::{Body, BodyKind, Domain, Flow, Motion, Placed, Setup, Slip};
    use crate::vector::Vector;

    /// Two chambers parted by walls, a vortex in one: it has the pressure of a vortex, and the other has none.
    #[test]
    fn fluid_parted_by_walls_is_balanced_part_by_part() {
        let n = 12;
        let place = |i: i32| Vector::<2>::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5);
        let particles = (0..n * (2 * n + 8)).map(|i| {
            let row = i / n;
            let solid = (n..n + 4).contains(&row) || row >= 2 * n + 4;
            Placed { position: place(i), volume: 1.0, body: u8::from(solid) }
        });
        let wall = BodyKind::Solid { slip: Slip::NoSlip, motion: Motion::Still, surface: None };
        let edge = f64::from(n);
        let mut flow = Flow::new(Setup {
            domain: Domain {
                min: Vector::zeros(),
                max: Vector::<2>::new(edge, 2.0 * edge + 8.0),
                periodic: [true; 2],
            },
            cutoff: 3.0,
            spacing: 1.0,
            particles: particles.collect(),
            bodies: vec![
                Body { name: "fluid".into(), kind: BodyKind::Fluid { density: 1.0, viscosity: 1.0 } },
                Body { name: "walls".into(), kind: wall },
            ],
            reference_length: edge,
            ..Setup::default()
        })
        .expect("sound");
        let turn = std::f64::consts::TAU / edge;
        flow.set_velocity(|x| {
            let inside = x[1] < edge;
            let (a, b) =
                ((turn * x[0]).sin() * (turn * x[1]).cos(), (turn * x[0]).cos() * (turn * x[1]).sin());
            if inside { Vector::<2>::new(-a, b) } else { Vector::zeros() }
        });
        let seen = flow.snapshot();
        let largest = |low: f64, high: f64| {
            let all = seen.position.iter().zip(&seen.pressure).zip(&seen.volume_fraction);
            let there = all.filter(|((x, _), share)| **share < 1.0 && x[1] > low && x[1] < high);
            there.map(|((_, p), _)| p.abs()).fold(0.0, f64::max)
        };
        // Of the vortex -rho U²/4 (cos 2kx + cos 2ky) without walls.
        let (one, other) = (largest(0.0, edge), largest(edge + 4.0, 2.0 * edge + 4.0));
        assert!((0.2..1.0).contains(&one) && other < 1e-9, "{one} {other}");
    }
}
