//! What is prescribed in the buffers of open ends, step by step.

use rayon::prelude::*;

use crate::fluid::blocks::Block;
use crate::fluid::flow::Flow;
use crate::fluid::open::{End, Openings, Zone};
use crate::fluid::symmetric::Symmetric;
use crate::vector::Vector;

impl<const D: usize> Flow<D> {
    /// Notes who is in the buffers and near the ends, in the order of now.
    pub(super) fn note_ends(&mut self) {
        let Some(mut openings) = self.openings.take() else { return };
        let axis = openings.open.axis;
        let near = self.setup.skin;
        openings.buffer.clear();
        openings.rim.clear();
        openings.marked = vec![false; self.sides.len()];
        openings.touched = vec![false; self.blocks.len()];
        for (i, side) in self.sides.iter().enumerate() {
            match openings.zones[side.id as usize] {
                Zone::Buffer(end) => {
                    openings.buffer.push((i as u32, end));
                    openings.marked[i] = true;
                    openings.touched[i / Block::<D>::SIZE] = true;
                }
                Zone::Inside if !side.is_solid() => {
                    let close = |end: u8| {
                        matches!(openings.open.ends[usize::from(end)], End::Velocity(_))
                            && self.beyond(axis, end, &self.positions[i]) > -near
                    };
                    if close(0) || close(1) {
                        openings.rim.push(i as u32);
                    }
                }
                _ => {}
            }
        }
        self.openings = Some(openings);
    }

    /// Of each particle in a buffer the mean of `value` over the fluid of the box in reach, Σ V W value/Σ V W; of those
    /// further back the mean over those in front that have one, so that a buffer moves as one.
    fn extrapolate(&self, openings: &Openings<D>, value: impl Fn(usize) -> f64 + Sync) -> Vec<Option<f64>> {
        let marked = &openings.marked;
        let first = self.means_near(openings, |i, j| (marked[i] && !marked[j]).then(|| value(j)));
        let known = |i: usize| (first[i].0 > 0.0).then(|| first[i].1 / first[i].0);
        let second = self.means_near(openings, |i, j| {
            if marked[i] && first[i].0 <= 0.0 && marked[j] { known(j) } else { None }
        });
        let mean = |&(i, _): &(u32, u8)| {
            let (all, sum) = second[i as usize];
            known(i as usize).or_else(|| (all > 0.0).then(|| sum / all))
        };
        openings.buffer.iter().map(mean).collect()
    }

    /// Σ V_j W and Σ V_j W value(i, j) over the fluid neighbours j of i that have a value for it, by present index.
    fn means_near(
        &self,
        openings: &Openings<D>,
        value: impl Fn(usize, usize) -> Option<f64> + Sync,
    ) -> Vec<(f64, f64)> {
        let (size, kernel, sides) = (Block::<D>::SIZE, &self.kernel, &self.sides);
        let mut sums = vec![(0.0_f64, 0.0_f64); sides.len()];
        self.blocks.par_iter().zip(sums.par_chunks_mut(size)).zip(&openings.touched).for_each(
            |((block, sums), touched)| {
                if !touched {
                    return;
                }
                let first = block.first;
                let mut add = |i: usize, j: usize, x: &Vector<D>| {
                    if let Some(value) = value(i, j) {
                        let share = sides[j].volume * kernel.value(x.norm());
                        let sum = &mut sums[i - first];
                        *sum = (sum.0 + share, sum.1 + share * value);
                    }
                };
                for row in 0..block.near_solid.len() {
                    let i = first + row;
                    if sides[i].is_solid() {
                        continue;
                    }
                    for c in block.inner.row(row) {
                        add(i, c.j as usize, &c.x);
                        add(c.j as usize, i, &c.x);
                    }
                    for c in block.outer.row(row) {
                        add(i, c.j as usize, &c.x);
                    }
                }
            },
        );
        sums
    }

    /// Pressure and density of the buffers.
    pub(super) fn densities_at_ends(&mut self) {
        let Some(openings) = self.openings.take() else { return };
        let means = self.extrapolate(&openings, |j| self.sides[j].pressure);
        let (state, c) = (self.setup.state, self.sound_speed);
        for (&(i, end), mean) in openings.buffer.iter().zip(means) {
            let (side, own) = (&mut self.sides[i as usize], &self.own[i as usize]);
            let pressure = match openings.open.ends[usize::from(end)] {
                End::Pressure(pressure) => pressure,
                // Out of reach of the box what was there before stays.
                End::Velocity(_) => mean.unwrap_or(side.pressure),
            };
            side.density = state.density(pressure, own.rest_density, c);
            side.pressure = pressure;
            side.volume = own.mass / side.density;
            side.invert();
            // Its neighbourhood ends with the buffer; that of the fluid before it does not.
            side.moment = Symmetric::identity(1.0);
        }
        self.openings = Some(openings);
    }

    /// Velocities of the buffers for the coming step, and fluid sent back from ends where the stream comes in.
    pub(super) fn finish_ends(&mut self, dt: f64) {
        let Some(openings) = self.openings.take() else { return };
        let axis = openings.open.axis;
        let pulls = self.extrapolate(&openings, |j| self.own[j].acceleration[axis]);
        let speeds = self.extrapolate(&openings, |j| self.sides[j].velocity[axis]);
        let time = self.time;
        for ((&(i, end), pull), speed) in openings.buffer.iter().zip(pulls).zip(speeds) {
            let i = i as usize;
            let (position, side, own) = (&mut self.positions[i], &mut self.sides[i], &mut self.own[i]);
            // What a particle inside would have done is taken back.
            *position -= self.rates[i].correction;
            side.drift = Vector::zeros();
            match &openings.open.ends[usize::from(end)] {
                End::Velocity(stream) => {
                    side.velocity = stream(&self.domain.wrap(position), time);
                    own.acceleration = Vector::zeros();
                }
                End::Pressure(_) => {
                    side.velocity -= own.acceleration * (0.5 * dt);
                    let pull = pull.unwrap_or(0.0);
                    own.acceleration = Vector::from_fn(|k, _| if k == axis { pull } else { 0.0 });
                    side.velocity += own.acceleration * (0.5 * dt);
                    // Fluid that is drawn in has no past of its own here: it comes as fast as that before it goes on.
                    if let Some(speed) = speed.filter(|speed| (*speed > 0.0) == (end == 0)) {
                        side.velocity[axis] = speed;
                    }
                }
            }
        }
        for &i in &openings.rim {
            let place = self.positions[i as usize];
            for (end, kind) in (0_u8..).zip(&openings.open.ends) {
                let out = self.beyond(axis, end, &place);
                let End::Velocity(stream) = kind else { continue };
                if out > 0.0 {
                    let inward =
                        stream(&self.domain.wrap(&place), time)[axis] * if end == 0 { 1.0 } else { -1.0 };
                    if inward > 0.0 {
                        self.positions[i as usize][axis] += 2.0 * if end == 0 { out } else { -out };
                    }
                }
            }
        }
        self.openings = Some(openings);
    }
}
