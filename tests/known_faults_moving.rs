//! Voxels that move: molecules conserved over a million steps, and the order of the splitting.

mod chemistry_cases;
use chemistry_cases::*;
use gillesph::chemistry::split::{Frozen, SplitState};
use gillesph::chemistry::{GroupSet, Links, Reactor};
use gillesph::fluid::exchange::{Voxels, links};
use gillesph::fluid::weights::Weights;
use gillesph::space::domain::Domain;
use gillesph::space::kernel::{Kernel, KernelKind};
use gillesph::vector::Vector;

/// Sixteen particles in a periodic box of 4², carried along the vortices u = 0.2 (sin(πy/2), sin(πx/2)) and
/// breathing by a fifth in volume.
struct Vortices {
    domain: Domain<2>,
    kernel: Kernel<2>,
    positions: Vec<Vector<2>>,
    volumes: Vec<f64>,
    time: f64,
}

impl Vortices {
    fn new() -> Vortices {
        let mut flow = Vortices {
            domain: Domain { min: Vector::zeros(), max: Vector::from_element(4.0), periodic: [true; 2] },
            kernel: Kernel::new(KernelKind::Lucy, 1.9),
            positions: (0..16)
                .map(|i| Vector::<2>::new((i % 4) as f64 + 0.5, (i / 4) as f64 + 0.5))
                .collect(),
            volumes: Vec::new(),
            time: 0.0,
        };
        flow.breathe();
        flow
    }

    fn breathe(&mut self) {
        self.volumes = (0..16).map(|i| 1.0 + 0.2 * (self.time + 0.7 * f64::from(i)).sin()).collect();
    }

    fn advance(&mut self, dt: f64) {
        for x in &mut self.positions {
            let turn = std::f64::consts::FRAC_PI_2 * *x;
            *x += 0.2 * dt * Vector::<2>::new(turn[1].sin(), turn[0].sin());
            *x = self.domain.wrap(x);
        }
        self.time += dt;
        self.breathe();
    }

    fn freeze(&self, reactor: &Reactor) -> Frozen {
        let voxels = Voxels {
            positions: &self.positions,
            volumes: &self.volumes,
            hosts: &[true; 16],
            domain: &self.domain,
            barriers: &[],
            obstacles: &[],
        };
        let mut links = links(&voxels, &self.kernel, Weights::Normalised, 1.0);
        links.conductance.iter_mut().for_each(|g| *g *= UNIT);
        let volumes: Vec<f64> = self.volumes.iter().map(|v| v * UNIT).collect();
        Frozen::build(reactor, &links, &volumes, &[0; 16], &[0; 16], &[]).unwrap()
    }
}

/// A + B <-> C over a million steps, volumes and links new in each: A + C and B + C stay to the molecule, no
/// count falls below zero, and the books of hops and events add up.
#[test]
fn molecules_are_conserved_over_a_million_steps() {
    let reactor = discrete(
        &[("A", 0.5), ("B", 0.1), ("C", 0.02)],
        &[(&[(0, 1), (1, 1)], &[(2, 1)], 0.2), (&[(2, 1)], &[(0, 1), (1, 1)], 0.5)],
    );
    let mut flow = Vortices::new();
    let start: Vec<f64> =
        (0..16).flat_map(|i| [f64::from(i % 3), f64::from(5 * u8::from(i == 3)), 1.0]).collect();
    let mut state = SplitState::new(&reactor, start, 141, 0);
    let kept = |state: &SplitState| [state.total(0) + state.total(2), state.total(1) + state.total(2)];
    let before = kept(&state);
    let (made, dt) = (state.total(2), 0.01);
    let mut frozen = flow.freeze(&reactor);
    for _ in 0..1_000_000 {
        state.react(&reactor, &frozen, flow.time, 0.5 * dt).unwrap();
        state.diffuse(&reactor, &frozen, flow.time, 0.5 * dt).unwrap();
        flow.advance(dt);
        frozen = flow.freeze(&reactor);
        state.diffuse(&reactor, &frozen, flow.time, 0.5 * dt).unwrap();
        state.react(&reactor, &frozen, flow.time, 0.5 * dt).unwrap();
        assert_eq!(kept(&state), before);
        assert!(state.amounts.iter().all(|&n| n >= 0.0 && n.fract() == 0.0));
    }
    assert_eq!(state.total(2), made + state.made(&reactor, 2));
    assert_eq!(state.supplied, [0.0; 3]);
    println!("{} events, {} hops", state.counters.events, state.counters.hops);
    assert!(state.counters.events > 10_000 && state.counters.hops > 10_000);
}

/// `n` voxels on a line whose volumes and conductances change in time as given functions do, or stay.
fn line_at(reactor: &Reactor, n: u32, time: f64, moving: bool) -> Frozen {
    let sway = if moving { 0.3 } else { 0.0 };
    let volumes: Vec<f64> =
        (0..n).map(|i| UNIT * (1.0 + sway * (2.0 * time + 0.9 * f64::from(i)).sin())).collect();
    let pairs: Vec<_> = (1..n)
        .map(|i| (i as usize - 1, i as usize, UNIT * (1.0 + sway * (3.0 * time - 0.5 * f64::from(i)).cos())))
        .collect();
    // The right half is another group: some reactions happen there only.
    let groups: Vec<u8> = (0..n).map(|i| u8::from(i >= n / 2)).collect();
    Frozen::build(reactor, &Links::from_pairs(n as usize, &pairs), &volumes, &groups, &groups, &[]).unwrap()
}

/// The Strang step of the program from 0 to 1: react, diffuse, move, diffuse, react.
fn advance(reactor: &Reactor, state: &mut SplitState, geometry: &[Frozen]) {
    let dt = 1.0 / (geometry.len() - 1) as f64;
    for (k, pair) in geometry.windows(2).enumerate() {
        let time = dt * k as f64;
        state.react(reactor, &pair[0], time, 0.5 * dt).unwrap();
        state.diffuse(reactor, &pair[0], time, 0.5 * dt).unwrap();
        state.diffuse(reactor, &pair[1], time + 0.5 * dt, 0.5 * dt).unwrap();
        state.react(reactor, &pair[1], time + 0.5 * dt, 0.5 * dt).unwrap();
    }
}

fn geometry(reactor: &Reactor, n: u32, steps: u32, moving: bool) -> Vec<Frozen> {
    (0..=steps).map(|k| line_at(reactor, n, f64::from(k) / f64::from(steps), moving)).collect()
}

/// Continuous A + B <-> C with diffusion: the error falls with the square of the step, on voxels at rest and on
/// voxels that change.
#[test]
fn splitting_is_second_order() {
    let net = network(
        &[("A", 1.0), ("B", 0.5), ("C", 0.1)],
        &[(&[(0, 1), (1, 1)], &[(2, 1)], 0.3), (&[(2, 1)], &[(0, 1), (1, 1)], 0.4)],
    );
    let reactor = Reactor::everywhere(&net, &[false; 3]);
    let start: Vec<f64> =
        (0..12).flat_map(|i| [10.0 - 0.8 * f64::from(i), 0.5 + 0.9 * f64::from(i), 0.0]).collect();
    for moving in [false, true] {
        let solve = |steps: u32| {
            let mut state = SplitState::new(&reactor, start.clone(), 0, 0);
            advance(&reactor, &mut state, &geometry(&reactor, 12, steps, moving));
            state.amounts
        };
        let reference = solve(1280);
        let error = |steps| {
            let n = solve(steps);
            n.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let errors = [10, 20, 40, 80].map(error);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            println!("moving {moving}: order {order:.3}");
            assert!((order - 2.0).abs() < 0.2, "moving {moving}: order {order}");
        }
    }
}

/// Molecules in a linear network: A starts in the left of two voxels and decays in the right one only. The mean
/// of the split sampler at a step is the continuous solution at the same step, and its distance from the limit
/// of small steps falls with the square of the step.
///
/// 1e8 molecules: the number left is binomial, its share has a standard error of 5e-5 at most, 4.5 of which are
/// allowed (chance 7e-6). The errors at 4, 8 and 16 steps are about 0.021, 0.0055 and 0.0014: the orders are
/// known to 0.014 and 0.053.
#[test]
fn mean_of_molecules_is_second_order() {
    const MOLECULES: f64 = 1e8;
    let net = network(&[("A", 2.0)], &[(&[(0, 1)], &[], 4.0)]);
    for moving in [false, true] {
        let left = |discrete: bool, steps: u32| {
            let reactor = Reactor::new(&net, &[discrete], &[GroupSet::ALL], &[GroupSet(0b10)]);
            let mut state = SplitState::new(&reactor, vec![MOLECULES, 0.0], 142, u64::from(steps));
            advance(&reactor, &mut state, &geometry(&reactor, 2, steps, moving));
            if discrete {
                assert_eq!(state.total(0), MOLECULES - state.counters.events as f64);
            }
            state.total(0) / MOLECULES
        };
        let exact = left(false, 2560);
        let errors = [4, 8, 16].map(|steps| {
            let (sampled, mean) = (left(true, steps), left(false, steps));
            let z = (sampled - mean) / (mean * (1.0 - mean) / MOLECULES).sqrt();
            println!(
                "moving {moving}, {steps} steps: {sampled:.5} left, {z:.2} standard errors, exact {exact:.5}"
            );
            assert!(z.abs() < 4.5, "moving {moving}, {steps} steps: {z:.2} standard errors");
            sampled - exact
        });
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            println!("moving {moving}: order {order:.3}");
            assert!((order - 2.0).abs() < 0.2, "moving {moving}: order {order}");
        }
    }
}
