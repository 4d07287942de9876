//! Flows with exact solutions: Poiseuille, Couette, Taylor-Green; momentum in a periodic box.

use gillesph::fluid::{Body, BodyKind, Domain, Flow, Motion, Placed, Setup, Slip};
use gillesph::vector::Vector;
use std::f64::consts::PI;

type V = Vector<2>;

/// A channel of width one along x, `n` particles across, three layers of wall on each side, rho = 1; the lattice
/// of the walls `finer` times as fine.
fn channel(n: i32, finer: i32, viscosity: f64, speed: f64, body_force: V, upper: Motion<2>) -> Flow<2> {
    let spacing = 1.0 / f64::from(n);
    let length = 8;
    let mut particles = Vec::new();
    let mut layers = |rows: std::ops::Range<i32>, body, spacing: f64, columns| {
        for (row, column) in rows.flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let position = V::new(f64::from(column) + 0.5, f64::from(row) + 0.5) * spacing;
            particles.push(Placed { position, volume: spacing * spacing, body });
        }
    };
    layers(0..n, 0, spacing, length);
    let fine = spacing / f64::from(finer);
    layers(-3 * finer..0, 1, fine, length * finer);
    layers(n * finer..(n + 3) * finer, 2, fine, length * finer);
    let wall = |name: &str, motion| Body {
        name: name.to_owned(),
        kind: BodyKind::Solid { slip: Slip::NoSlip, motion, surface: None },
    };
    let setup = Setup {
        domain: Domain {
            min: V::zeros(),
            max: V::new(f64::from(length) * spacing, 1.0),
            periodic: [true, false],
        },
        cutoff: 3.0 * spacing,
        spacing,
        particles,
        bodies: vec![
            Body { name: "fluid".to_owned(), kind: BodyKind::Fluid { density: 1.0, viscosity } },
            wall("lower", Motion::Still),
            wall("upper", upper),
        ],
        reference_speed: speed,
        sound_speed: Some(10.0 * speed),
        body_force,
        ..Setup::default()
    };
    Flow::new(setup).expect("the channel is sound")
}

/// Relative L2 error of the velocity along x of the fluid.
fn error(flow: &Flow<2>, exact: impl Fn(f64) -> f64) -> f64 {
    let seen = flow.snapshot();
    let (mut wrong, mut all) = (0.0, 0.0);
    for i in 0..seen.position.len() {
        if seen.volume_fraction[i] < 1.0 {
            let u = exact(seen.position[i][1]);
            wrong += (seen.velocity[i][0] - u).powi(2);
            all += u * u;
        }
    }
    (wrong / all).sqrt()
}

fn poiseuille(n: i32, finer: i32) -> f64 {
    // Re = 1: largest speed g/(8 nu) = 1, width 1, nu = 1.
    let mut flow = channel(n, finer, 1.0, 1.0, V::new(8.0, 0.0), Motion::Still);
    // The slowest mode decays as exp(-pi² t): 5e-5 of the start are left.
    flow.settle(1.0).expect("stable");
    assert_eq!(flow.health().penetrations, 0);
    error(&flow, |y| 4.0 * y * (1.0 - y))
}

#[test]
fn poiseuille_reaches_the_parabola() {
    // Published for SPH-BVF at this resolution: 3.4e-2; the mirrored wall velocity should give 1e-2 or better.
    let e = poiseuille(20, 1);
    println!("Poiseuille Ny = 20: L2 {e:.2e}");
    assert!(e < 1e-2, "{e}");
}

#[test]
fn walls_of_a_finer_lattice_do_not_change_the_flow() {
    // With the printed V_i² + V_j² walls of a quarter of the volume would push and rub with 5/8 of the strength.
    let e = poiseuille(20, 2);
    println!("Poiseuille Ny = 20, walls twice as fine: L2 {e:.2e}");
    assert!(e < 1e-2, "{e}");
}

#[test]
#[ignore = "ten seconds"]
fn poiseuille_converges() {
    let errors: Vec<f64> = [20, 40, 80].into_iter().map(|n| poiseuille(n, 1)).collect();
    println!("Poiseuille Ny = 20, 40, 80: L2 {errors:?}");
    // Published: 3.4e-2, 6.6e-3, 4.6e-3.
    assert!(errors[1] < 6.6e-3 && errors[2] < 4.6e-3, "{errors:?}");
}

#[test]
fn couette_with_a_belt_reaches_the_straight_line() {
    let mut flow = channel(16, 1, 1.0, 1.0, V::zeros(), Motion::Belt { velocity: V::new(1.0, 0.0) });
    flow.settle(1.0).expect("stable");
    // As for Poiseuille; the line itself is a solution of the discrete equations up to the disorder.
    let e = error(&flow, |y| y);
    println!("Couette Ny = 16: L2 {e:.2e}");
    assert!(e < 1e-2, "{e}");
}

/// A periodic box of side one with `n`² particles and the Taylor-Green vortex of speed one as initial state.
fn taylor_green(n: i32, reynolds: f64) -> Flow<2> {
    let spacing = 1.0 / f64::from(n);
    let mut particles = Vec::new();
    for row in 0..n {
        for column in 0..n {
            let position = V::new(f64::from(column) + 0.5, f64::from(row) + 0.5) * spacing;
            particles.push(Placed { position, volume: spacing * spacing, body: 0 });
        }
    }
    let setup = Setup {
        domain: Domain { min: V::zeros(), max: V::new(1.0, 1.0), periodic: [true, true] },
        cutoff: 3.0 * spacing,
        spacing,
        particles,
        bodies: vec![Body {
            name: "fluid".to_owned(),
            kind: BodyKind::Fluid { density: 1.0, viscosity: 1.0 / reynolds },
        }],
        sound_speed: Some(10.0),
        ..Setup::default()
    };
    let mut flow = Flow::new(setup).expect("the box is sound");
    flow.set_velocity(|x| {
        let (x, y) = (2.0 * PI * x[0], 2.0 * PI * x[1]);
        V::new(-x.cos() * y.sin(), x.sin() * y.cos())
    });
    flow
}

#[test]
fn taylor_green_decays_at_the_exact_rate() {
    let mut flow = taylor_green(25, 100.0);
    let energy = |flow: &Flow<2>| flow.snapshot().velocity.iter().map(V::norm_squared).sum::<f64>();
    let before = energy(&flow);
    let duration = 0.5;
    flow.settle(duration).expect("stable");
    let rate = -0.5 * (energy(&flow) / before).ln() / duration;
    let exact = 8.0 * PI * PI / 100.0;
    println!("Taylor-Green Re = 100, 25²: decay rate {:.4} of the exact one", rate / exact);
    // Friction of the second order is 2.5 % too slow at 2 pi h = 0.75; ours of the fourth comes within 0.8 %. A wrong factor
    // in the viscosity is 50 or 100 %.
    assert!((rate / exact - 1.0).abs() < 0.02, "{}", rate / exact);
}

#[test]
fn a_periodic_box_keeps_its_momentum() {
    let mut flow = taylor_green(20, 100.0);
    let before = flow.health().momentum;
    let dt = flow.step_limit().seconds;
    flow.advance(dt, 200).expect("stable");
    let change = (flow.health().momentum - before).norm();
    // Sum of |momentum| is about 0.6; 200 steps of 400 sums of 28 terms: rounding of some 1e-14 at most.
    assert!(change < 1e-12, "{change:e}");
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let mut flow = channel(24, 1, 0.1, 1.0, V::new(0.8, 0.0), Motion::Still);
            let dt = flow.step_limit().seconds;
            flow.advance(dt, 60).expect("stable");
            flow.snapshot()
        })
    };
    assert_eq!(run(1), run(3));
}
