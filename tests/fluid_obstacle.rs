//! A slow flow past a disc, driven by a plug of fluid that moves at a given velocity.

use std::f64::consts::TAU;
use std::sync::Arc;

use gillesph::fluid::{
    Body, BodyKind, Domain, Flow, KernelKind, Motion, Options, Placed, Setup, Slip, Sponge,
};
use gillesph::vector::Vector;

type V = Vector<2>;

const LENGTH: f64 = 42e-6;
const WIDTH: f64 = 20e-6;
const RADIUS: f64 = 2.5e-6;
const SPEED: f64 = 1.25e-3;

/// Box of 42 x 20 um, periodic along x, disc of radius 2.5 um at (22, 10) um as rings at half the spacing of
/// the fluid, plug in 0-2 um at 1.25 mm/s: Re = 0.025 in water.
fn channel(spacing: f64, walls: Slip, spin: f64) -> Flow<2> {
    let centre = V::new(22e-6, 10e-6);
    let (columns, rows) = ((LENGTH / spacing).round() as i32, (WIDTH / spacing).round() as i32);
    let (dx, dy) = (LENGTH / f64::from(columns), WIDTH / f64::from(rows));
    let mut particles = Vec::new();
    for row in -3..rows + 3 {
        for column in 0..columns {
            let position = V::new((f64::from(column) + 0.5) * dx, (f64::from(row) + 0.5) * dy);
            let body = u8::from(!(0..rows).contains(&row));
            if body == 1 || (position - centre).norm() > RADIUS + 0.1 * spacing {
                particles.push(Placed { position, volume: dx * dy, body });
            }
        }
    }
    let rings = (2.0 * RADIUS / spacing).round();
    let width = RADIUS / rings;
    for ring in 0..rings as i32 {
        let r = (f64::from(ring) + 0.5) * width;
        let count = (TAU * r / width).round().max(1.0);
        for k in 0..count as i32 {
            let angle = TAU * f64::from(k) / count;
            let position = centre + V::new(r * angle.cos(), r * angle.sin());
            particles.push(Placed { position, volume: TAU * r * width / count, body: 2 });
        }
    }
    let disc: Arc<dyn Fn(&V) -> f64 + Send + Sync> = Arc::new(move |x| (x - centre).norm() - RADIUS);
    let solid = |name: &str, slip, motion, surface| Body {
        name: name.to_owned(),
        kind: BodyKind::Solid { slip, motion, surface },
    };
    let motion = if spin == 0.0 {
        Motion::Still
    } else {
        Motion::Rotating { centre, rate: [0.0, 0.0, spin], domain: None }
    };
    let setup = Setup {
        domain: Domain { min: V::zeros(), max: V::new(LENGTH, WIDTH), periodic: [true, false] },
        kernel: KernelKind::Lucy,
        cutoff: 3.0 * spacing,
        spacing,
        particles,
        bodies: vec![
            Body { name: "water".to_owned(), kind: BodyKind::Fluid { density: 1000.0, viscosity: 1e-3 } },
            solid("walls", walls, Motion::Still, None),
            solid("cell", Slip::NoSlip, motion, Some(disc)),
        ],
        reference_speed: SPEED,
        reference_length: WIDTH,
        sound_speed: None,
        pressure_scale: None,
        body_force: V::zeros(),
        buoyancy: V::zeros(),
        sponges: vec![Sponge {
            region: Arc::new(|x: &V| x[0] <= 2e-6),
            rate: 1e9,
            velocity: Arc::new(|_| V::new(SPEED, 0.0)),
        }],
        initial_velocity: V::zeros(),
        method: Default::default(),
        friction: Default::default(),
        state: Default::default(),
        noise: None,
        options: Options::default(),
    };
    Flow::new(setup).expect("the channel is sound")
}

/// Mean velocity along x of the fluid between two places, in units of the pump's.
fn flux(flow: &Flow<2>, from: f64, to: f64) -> f64 {
    let seen = flow.snapshot();
    let (mut sum, mut area) = (0.0, 0.0);
    for i in 0..seen.position.len() {
        if seen.volume_fraction[i] < 1.0 && (from..to).contains(&seen.position[i][0]) {
            sum += seen.velocity[i][0] * seen.volume[i];
            area += seen.volume[i];
        }
    }
    sum / area / SPEED
}

fn sound(flow: &Flow<2>) {
    let health = flow.health();
    assert_eq!(health.penetrations, 0);
    assert!(health.largest_mach < 0.1 && health.largest_density_change < 0.03, "{health:?}");
    assert!(health.warnings.is_empty(), "{health:?}");
    // What the pump moves passes every section, up to sampling by particles (a few of some 250).
    for (from, to) in [(5e-6, 10e-6), (30e-6, 35e-6)] {
        let part = flux(flow, from, to);
        assert!((part - 1.0).abs() < 0.03, "{part}");
    }
}

#[test]
fn a_slow_flow_past_a_disc_keeps_out_of_it() {
    let mut flow = channel(0.8e-6, Slip::FreeSlip, 0.0);
    // The start-up takes a few micro-seconds of viscous and sound time; this is some 1 % of a passage.
    flow.settle(0.2e-3).expect("stable");
    sound(&flow);
}

#[test]
fn a_spinning_disc_pumps_but_takes_no_fluid_in() {
    let mut flow = channel(0.8e-6, Slip::NoSlip, SPEED / RADIUS);
    flow.settle(0.2e-3).expect("stable");
    let health = flow.health();
    assert_eq!(health.penetrations, 0);
    assert!(health.largest_density_change < 0.05, "{health:?}");
}

#[test]
#[ignore = "two minutes"]
fn two_passages_stay_stable() {
    for walls in [Slip::FreeSlip, Slip::NoSlip] {
        let mut flow = channel(0.8e-6, walls, 0.0);
        flow.settle(32e-3).expect("stable");
        let health = flow.health();
        println!("{walls:?}: flux {:.4}, {health:?}", flux(&flow, 30e-6, 35e-6));
        if walls == Slip::FreeSlip {
            sound(&flow);
        } else {
            // Ten times the pressure that the estimate expects, so several times the leak through the plug.
            assert!(health.penetrations == 0 && health.largest_density_change < 0.03, "{health:?}");
            assert!((flux(&flow, 30e-6, 35e-6) - 1.0).abs() < 0.1);
        }
    }
}
