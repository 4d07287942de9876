//! Shepard's filter of the density; for comparison with print.

use rayon::prelude::*;

use crate::fluid::blocks::Contact;
use crate::fluid::flow::Flow;

impl<const D: usize> Flow<D> {
    /// rho_i = Σ m_j W/Σ V_j W over the fluid of its own body, itself included; SPH-BVF Eq. (30). Takes the
    /// contacts of the sweep before.
    pub(super) fn filter_densities(&mut self) {
        let (kernel, sides, own) = (&self.kernel, &self.sides, &self.own);
        let alone = kernel.value(0.0);
        let filtered: Vec<Vec<f64>> = self
            .blocks
            .par_iter()
            .map(|block| {
                // Mass and volume around each particle of the block.
                let start = |row: usize| {
                    let i = block.first + row;
                    (own[i].mass * alone, sides[i].volume * alone)
                };
                let mut sums: Vec<(f64, f64)> = (0..block.near_solid.len()).map(start).collect();
                for row in 0..sums.len() {
                    let i = block.first + row;
                    let mut add = |to: usize, from: usize, c: &Contact<D>| {
                        if sides[to].body == sides[from].body {
                            let w = kernel.value(c.x.norm());
                            sums[to - block.first].0 += own[from].mass * w;
                            sums[to - block.first].1 += sides[from].volume * w;
                        }
                    };
                    for c in block.inner.row(row) {
                        add(i, c.j as usize, &c);
                        add(c.j as usize, i, &c);
                    }
                    for c in block.outer.row(row) {
                        add(i, c.j as usize, &c);
                    }
                }
                sums.into_iter().map(|(mass, volume)| mass / volume).collect()
            })
            .collect();
        let fluid = self.sides.iter_mut().zip(&self.own).zip(filtered.iter().flatten());
        for ((side, own), &density) in fluid.filter(|((side, _), _)| !side.is_solid()) {
            side.density = density;
            side.pressure = self.setup.state.pressure(density, own.rest_density, self.sound_speed);
            side.volume = own.mass / density;
            side.invert();
        }
    }
}
