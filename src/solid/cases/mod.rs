//! Elastic solids against exact answers; the cases that take longer are in [`crate::validation`].

mod beam;
mod hourglass;
mod patch;
mod tension;
mod turn;
mod waves;

use crate::random::mix;
use crate::solid::{Elastic, Hold, Law, Material, Options, Setup};
use crate::space::{Domain, KernelKind};
use crate::vector::Vector;

/// A number between -1 and 1, always the same one for the same key.
fn any(key: usize) -> f64 {
    (mix(key as u64) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Centres of a lattice of `counts` cells of side `spacing` from the origin on, the last axis fastest.
fn lattice<const D: usize>(counts: [usize; D], spacing: f64) -> Vec<Vector<D>> {
    (0..counts.iter().product::<usize>())
        .map(|index| {
            let mut rest = index;
            let mut place = Vector::zeros();
            for k in (0..D).rev() {
                place[k] = ((rest % counts[k]) as f64 + 0.5) * spacing;
                rest /= counts[k];
            }
            place
        })
        .collect()
}

/// A material of density one and Young's modulus one.
fn material(law: Law) -> Material {
    Material::of_young(law, 1.0, 1.0, 0.3)
}

/// What free particles of a lattice of side `spacing` make, in a box without sides; h = 1.6 spacings.
fn setup<const D: usize>(places: Vec<Vector<D>>, spacing: f64, law: Law) -> Setup<D> {
    let n = places.len();
    Setup {
        domain: Domain {
            min: Vector::from_element(-1e3),
            max: Vector::from_element(1e3),
            periodic: [false; D],
        },
        kernel: KernelKind::Lucy,
        cutoff: 1.6 * spacing,
        places,
        volumes: vec![spacing.powi(D as i32); n],
        holds: vec![Hold::Free; n],
        material: material(law),
        options: Options::default(),
    }
}

/// The times at which a sampled curve goes through zero, by straight lines between samples.
#[derive(Default)]
struct Crossings {
    last: Option<(f64, f64)>,
    times: Vec<f64>,
}

impl Crossings {
    fn see(&mut self, time: f64, value: f64) {
        if let Some((before, was)) = self.last.replace((time, value))
            && (was < 0.0) != (value < 0.0)
        {
            self.times.push(before + (time - before) * was / (was - value));
        }
    }
}

/// The time from the first zero of `look` to the one `periods` later, in steps of `dt`.
fn period<const D: usize>(
    solid: &mut Elastic<D>,
    dt: f64,
    periods: usize,
    look: impl Fn(&Elastic<D>) -> f64,
) -> f64 {
    let mut zeros = Crossings::default();
    while zeros.times.len() < 2 * periods + 1 {
        solid.step(dt).expect("stable");
        zeros.see(solid.time(), look(solid));
    }
    (zeros.times[2 * periods] - zeros.times[0]) / periods as f64
}
