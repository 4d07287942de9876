//! Profiles and map read off the particles of a state.

use super::{Convection, HOT, RADIUS, SIDE};
use crate::chemistry::AVOGADRO;
use crate::figures::contour::GridField;
use crate::fluid::{Domain, Kernel};
use crate::samples::ParticleFrame;
use crate::validation::reading::{Carriers, field};
use crate::vector::Vector;

/// Nodes of the map, 1/100 apart; inside the cylinder not a number.
pub fn grid() -> GridField {
    let line: Vec<f64> = (0..=100).map(|k| f64::from(k) / 100.0).collect();
    let inside = |x: f64, y: f64| (x - 0.5).hypot(y - 0.5) < RADIUS - 1e-9;
    let node = |y: f64| line.iter().map(move |&x| if inside(x, y) { f64::NAN } else { 0.0 });
    GridField { values: line.iter().flat_map(|&y| node(y)).collect(), x: line.clone(), y: line.clone() }
}

/// Adds a state with its share.
pub fn read(
    one: &mut Convection,
    frame: &ParticleFrame,
    domain: &Domain<2>,
    kernel: &Kernel<2>,
    share: f64,
    viscosity: f64,
) {
    let fluid: Vec<usize> = (0..frame.len()).filter(|&i| frame.group_name(i) == "cavity").collect();
    let positions: Vec<Vector<2>> =
        fluid.iter().map(|&i| Vector::from([frame.position[i][0], frame.position[i][1]])).collect();
    let c = |k: usize| frame.amounts[0][fluid[k]] / (AVOGADRO * frame.volume[fluid[k]] * HOT);
    let v = |k: usize| frame.velocity[fluid[k]][1] * SIDE / viscosity;
    let carriers = Carriers { positions: &positions, domain, kernel };
    let points: Vec<Vector<2>> = one.x.iter().map(|x| Vector::from([x * SIDE, 0.5 * SIDE])).collect();
    let add = |sum: &mut [f64], seen: Vec<f64>| {
        sum.iter_mut().zip(seen).for_each(|(sum, value)| *sum += share * value);
    };
    add(&mut one.c, field(&carriers, &points, c));
    add(&mut one.v, field(&carriers, &points, v));
    let nodes: Vec<Vector<2>> = (0..one.field.values.len())
        .map(|k| {
            Vector::from([one.field.x[k % one.field.x.len()], one.field.y[k / one.field.x.len()]]) * SIDE
        })
        .collect();
    add(&mut one.field.values, field(&carriers, &nodes, c));
}
