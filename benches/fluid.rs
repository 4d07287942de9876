//! Particle-steps per second of whole fluid steps (neighbours, sweeps, walls, integration), from thermal velocities
//! and after a hundred steps off the lattice. `RAYON_NUM_THREADS=1 cargo bench --bench fluid`; the rates stand in the
//! rows `item/s`, the fastest of the samples is the one to quote from a busy machine. With two threads the same
//! command without the variable. Memory of a million particles: `cargo bench --bench fluid million`, which prints
//! the largest resident size at its end.

use divan::Bencher;
use divan::counter::ItemsCount;
use gillesph::fluid::{Body, BodyKind, Domain, Flow, Method, Motion, Noise, Options, Placed};
use gillesph::fluid::{Setup, Slip};
use gillesph::random::mix;
use gillesph::vector::Vector;

fn main() {
    divan::main();
    // Only the system knows; elsewhere than on Linux nothing is printed.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status.lines().filter(|line| line.starts_with("VmHWM")).for_each(|line| println!("{line}"));
}

/// Steps over which the rate of one sample is taken.
const STEPS: u64 = 20;

/// A box of `n` particles along each axis with thermal velocities of a hundredth of the sound speed. With `walls` the
/// last axis lies between three rows of wall and a disc or ball stands in the middle.
fn bath<const D: usize>(n: usize, method: Method, noise: bool, walls: bool) -> Flow<D> {
    let length = n as f64;
    let centre: Vector<D> = Vector::from_element(0.5 * length);
    let place = |index: usize, k: usize| index / n.pow(k as u32) % n;
    let particles = (0..n.pow(D as u32))
        .map(|index| {
            let position = Vector::from_fn(|k, _| place(index, k) as f64 + 0.5);
            let row = place(index, D - 1);
            let solid = walls && (row < 3 || row >= n - 3 || (position - centre).norm() < 0.1 * length);
            Placed { position, volume: 1.0, body: u8::from(solid) }
        })
        .collect();
    let mut domain = Domain { min: Vector::zeros(), max: Vector::from_element(length), periodic: [true; D] };
    if walls {
        (domain.periodic[D - 1], domain.min[D - 1], domain.max[D - 1]) = (false, 3.0, length - 3.0);
    }
    let wall = BodyKind::Solid { slip: Slip::NoSlip, motion: Motion::Still, surface: None };
    let setup = Setup {
        domain,
        // 20 and, in 3D, about 29 neighbours.
        cutoff: if D == 3 { 2.0 } else { 2.5 },
        spacing: 1.0,
        particles,
        bodies: vec![
            Body { name: "fluid".to_owned(), kind: BodyKind::Fluid { density: 1.0, viscosity: 0.5 } },
            Body { name: "wall".to_owned(), kind: wall },
        ],
        reference_length: length,
        sound_speed: Some(10.0),
        method,
        noise: noise.then_some(Noise { energy: 0.01, seed: 1, realization: 0 }),
        // The shift of a flow at reference speed one would stir a bath that is a hundred times slower.
        options: Options { shift: Some(2.0), ..Options::default() },
        ..Setup::default()
    };
    let mut flow = Flow::new(setup).expect("a sound setup");
    let seed = std::cell::Cell::new(1_u64);
    let uniform = || {
        seed.set(mix(seed.get()));
        (seed.get() >> 11) as f64 / (1_u64 << 53) as f64
    };
    // Twelve uniform deviates less six have the variance one.
    let normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    flow.set_velocity(|_| Vector::from_fn(|_, _| 0.1 * normal()));
    flow
}

fn rate<const D: usize>(bencher: Bencher, mut flow: Flow<D>, before: u64) {
    let dt = flow.step_limit().seconds;
    flow.advance(dt, before).expect("stable");
    let particles = flow.snapshot().position.len() as u64;
    bencher
        .counter(ItemsCount::new(particles * STEPS))
        .bench_local(|| flow.advance(dt, STEPS).expect("stable"));
}

/// The transport-velocity method in a periodic square of 10 000 particles, without and with noise.
#[divan::bench(args = [false, true], sample_count = 20, sample_size = 1)]
fn square(bencher: Bencher, noise: bool) {
    rate(bencher, bath::<2>(100, Method::SphBvf, noise, false), 100);
}

/// SDPD in the same square.
#[divan::bench(args = [false, true], sample_count = 20, sample_size = 1)]
fn square_sdpd(bencher: Bencher, noise: bool) {
    rate(bencher, bath::<2>(100, Method::Sdpd, noise, false), 100);
}

/// The transport-velocity method in a periodic cube of 10 648 particles.
#[divan::bench(args = [false, true], sample_count = 20, sample_size = 1)]
fn cube(bencher: Bencher, noise: bool) {
    rate(bencher, bath::<3>(22, Method::SphBvf, noise, false), 100);
}

/// SDPD in the same cube.
#[divan::bench(args = [false, true], sample_count = 20, sample_size = 1)]
fn cube_sdpd(bencher: Bencher, noise: bool) {
    rate(bencher, bath::<3>(22, Method::Sdpd, noise, false), 100);
}

/// A channel of 10 000 particles, walls and the disc in it included.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn channel_with_a_disc(bencher: Bencher) {
    rate(bencher, bath::<2>(100, Method::SphBvf, false, true), 100);
}

/// A million particles in 3D: to be set beside `cube_sdpd` and `cube` of the same sitting.
#[divan::bench(args = [false, true], sample_count = 2, sample_size = 1)]
fn million_sdpd(bencher: Bencher, noise: bool) {
    rate(bencher, bath::<3>(100, Method::Sdpd, noise, false), 2);
}

/// The transport-velocity method at a million.
#[divan::bench(args = [false, true], sample_count = 2, sample_size = 1)]
fn million(bencher: Bencher, noise: bool) {
    rate(bencher, bath::<3>(100, Method::SphBvf, noise, false), 2);
}
