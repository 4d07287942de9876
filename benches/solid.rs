//! Particle-steps per second of elastic solids: a plate with h = 1.6 spacings, clamped at one end and bent, a block in
//! space, and the updated-Lagrangian form of the plate. `RAYON_NUM_THREADS=1 cargo bench --bench solid`; the rates stand
//! in the rows `item/s`, the fastest of the samples is the one to quote from a busy machine. With two threads the same
//! command without the variable.

use divan::Bencher;
use divan::counter::ItemsCount;
use gillesph::solid::{Elastic, Form, Hold, Jaumann, Law, Material, Options, Setup};
use gillesph::space::{Domain, KernelKind};
use gillesph::vector::Vector;

fn main() {
    divan::main();
}

/// Steps over which the rate of one sample is taken.
const STEPS: u64 = 20;

/// A block of `counts` particles on a lattice of spacing one, held in its first four layers.
fn block<const D: usize>(counts: [usize; D]) -> Setup<D> {
    let total: usize = counts.iter().product();
    let places: Vec<Vector<D>> = (0..total)
        .map(|index| {
            let mut rest = index;
            let mut place = Vector::zeros();
            for k in (0..D).rev() {
                place[k] = (rest % counts[k]) as f64;
                rest /= counts[k];
            }
            place
        })
        .collect();
    Setup {
        domain: Domain {
            min: Vector::from_element(-1e4),
            max: Vector::from_element(1e4),
            periodic: [false; D],
        },
        kernel: KernelKind::Lucy,
        cutoff: 1.6,
        volumes: vec![1.0; total],
        holds: places.iter().map(|x| if x[0] < 3.5 { Hold::Clamped } else { Hold::Free }).collect(),
        places,
        material: Material::of_young(Law::SaintVenantKirchhoff, 1.0, 1.0, 0.3),
        options: Options::default(),
    }
}

fn bent<const D: usize>(setup: Setup<D>) -> Elastic<D> {
    let mut solid = Elastic::new(setup).expect("a sound setup");
    solid.set_velocity(|x| Vector::from_fn(|k, _| if k == 1 { 1e-4 * x[0] } else { 0.0 }));
    solid
}

fn rate<const D: usize>(bencher: Bencher, mut solid: Elastic<D>) {
    let dt = solid.step_limit().expect("at rest");
    bencher.counter(ItemsCount::new(solid.len() as u64 * STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            solid.step(dt).expect("stable");
        }
    });
}

/// 4,000, 9,000 and 100,000 particles; 20, 30 and 100 across.
#[divan::bench(args = [20, 30, 100], sample_count = 20)]
fn plate(bencher: Bencher, across: usize) {
    rate(bencher, bent::<2>(block([10 * across, across])));
}

/// The same with the neo-Hookean law.
#[divan::bench(args = [30], sample_count = 20)]
fn plate_neo_hookean(bencher: Bencher, across: usize) {
    let mut setup = block::<2>([10 * across, across]);
    setup.material.law = Law::NeoHookean;
    rate(bencher, bent(setup));
}

/// 10,000 and 80,000 particles in space; 10 and 20 across.
#[divan::bench(args = [10, 20], sample_count = 20)]
fn block_in_space(bencher: Bencher, across: usize) {
    rate(bencher, bent::<3>(block([10 * across, across, across])));
}

/// The updated-Lagrangian form of the plate.
#[divan::bench(args = [30], sample_count = 20)]
fn plate_jaumann(bencher: Bencher, across: usize) {
    let mut solid = Jaumann::new(block::<2>([10 * across, across]), Form::default()).expect("a sound setup");
    solid.set_velocity(|x| Vector::<2>::new(0.0, 1e-4 * x[0]));
    let dt = solid.step_limit();
    bencher.counter(ItemsCount::new(solid.len() as u64 * STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            solid.step(dt).expect("stable");
        }
    });
}
