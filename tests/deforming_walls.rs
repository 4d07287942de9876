//! Walls that deform: Stokes' second problem said in two ways, and a wave that runs along a channel.

mod face;

use face::Bench;
use gillesph::fluid::{Body, BodyKind, Deformation, Domain, Flow, Motion, Placed, Setup, Slip};
use gillesph::vector::Vector;
use std::f64::consts::TAU;
use std::sync::Arc;

type V = Vector<2>;

/// Fluid of height one and `length` on a floor that moves under a roof at rest; rho = nu = 1.
fn channel(n: i32, length: f64, floor: Motion<2>, roof: Motion<2>, speed: f64) -> Flow<2> {
    let spacing = 1.0 / f64::from(n);
    let columns = (length / spacing).round() as i32;
    let mut particles = Vec::new();
    for row in -4..n + 4 {
        for column in 0..columns {
            let position = V::new(f64::from(column) + 0.5, f64::from(row) + 0.5) * spacing;
            let body = if row < 0 { 1 } else { 2 * u8::from(row >= n) };
            particles.push(Placed { position, volume: spacing * spacing, body });
        }
    }
    let solid = |name: &str, motion, upper: bool| Body {
        name: name.into(),
        kind: BodyKind::Solid {
            slip: Slip::NoSlip,
            motion,
            surface: Some(Arc::new(move |x: &V| if upper { 1.0 - x[1] } else { x[1] })),
        },
    };
    // The box ends behind the walls, so that they may move through its place.
    let setup = Setup {
        domain: Domain {
            min: V::new(0.0, -4.0 * spacing),
            max: V::new(f64::from(columns) * spacing, 1.0 + 4.0 * spacing),
            periodic: [true, false],
        },
        cutoff: 3.0 * spacing,
        spacing,
        particles,
        bodies: vec![
            Body { name: "fluid".into(), kind: BodyKind::Fluid { density: 1.0, viscosity: 1.0 } },
            solid("floor", floor, false),
            solid("roof", roof, true),
        ],
        reference_speed: speed,
        ..Setup::default()
    };
    Flow::new(setup).expect("a sound setup")
}

fn deforming(instant: f64, displacement: impl Fn(&V, f64) -> V + Send + Sync + 'static) -> Motion<2> {
    Motion::Deforming(Deformation { displacement: Arc::new(displacement), instant, nearby: 1e-4 })
}

#[test]
fn stokes_second_problem_said_both_ways() {
    let frequency = TAU * 4.0;
    let oscillating = Motion::Oscillating { amplitude: V::new(1.0, 0.0), frequency };
    let displaced = deforming(1e-3, move |_, t| V::new((1.0 - (frequency * t).cos()) / frequency, 0.0));
    let mut one = channel(16, 0.75, oscillating, Motion::Still, 1.0);
    let mut other = channel(16, 0.75, displaced, Motion::Still, 1.0);
    let steps = (0.3 / one.step_limit().seconds).ceil();
    for flow in [&mut one, &mut other] {
        flow.advance(0.3 / steps, steps as u64).expect("stable");
    }
    let (a, b) = (one.snapshot(), other.snapshot());
    let worst = (0..a.velocity.len()).map(|i| (a.velocity[i] - b.velocity[i]).norm()).fold(0.0, f64::max);
    println!("Stokes' second problem said in two ways: {worst:.1e} apart");
    // Difference quotients (1e-13), and what friction leaves of their sum over 4000 steps.
    assert!(worst < 1e-8, "{worst}");
}

/// Both walls carry a wave of amplitude 0.12 towards larger x. No fluid passes into them, the fluid keeps its volume
/// while each place along the channel is pumped, and in the mean it is carried along with the wave.
#[test]
fn a_wave_of_the_walls_pumps() {
    let (length, speed, amplitude) = (2.0, 20.0, 0.12);
    let wave = move |sign: f64| {
        deforming(1e-5, move |x: &V, t: f64| {
            let phase = TAU * (x[0] - speed * t) / length;
            V::new(0.0, sign * amplitude * (1.0 - (-(t / 0.02_f64).powi(2)).exp()) * phase.sin())
        })
    };
    // The walls move at up to amplitude times TAU speed/length = 7.5.
    let mut flow = channel(20, length, wave(1.0), wave(-1.0), 10.0);
    let steps = (0.3 / flow.step_limit().seconds).ceil();
    flow.advance(0.3 / steps, steps as u64).expect("stable");
    let (seen, health) = (flow.snapshot(), flow.health());
    let mut count = 0.0;
    let mut mean = V::zeros();
    let (mut swept, mut slices) = (0.0_f64, [0.0; 8]);
    for i in 0..seen.position.len() {
        if seen.volume_fraction[i] < 1.0 {
            mean += seen.velocity[i];
            count += 1.0;
            slices[(seen.position[i][0] / length * 8.0) as usize % 8] += seen.volume[i];
        }
    }
    for (k, volume) in slices.iter().enumerate() {
        // Mean of 1 - 2 amplitude sin(phase) over the slice.
        let phase = |edge: f64| TAU * (edge * length / 8.0 - speed * 0.3) / length;
        let (a, b) = (phase(k as f64), phase(k as f64 + 1.0));
        let height = 1.0 - 2.0 * amplitude * (a.cos() - b.cos()) / (b - a);
        swept = swept.max((volume / (height * length / 8.0) - 1.0).abs());
    }
    mean /= count;
    // Free pumping between plates, long waves, no inertia: mean flow 3 φ²/(2 + φ²) of the wave speed, φ = 2 amplitude
    // (Shapiro, Jaffrin & Weinberg 1969). This wave is no longer than twice the width: a scale, no reference.
    let phi: f64 = 2.0 * amplitude;
    let expected = 3.0 * phi * phi / (2.0 + phi * phi) * speed;
    println!(
        "wave: mean velocity {:.3} (long waves {expected:.3}), slices within {swept:.3}, density {:.4}, {} penetrations, {} bounces",
        mean[0], health.largest_density_change, health.penetrations, health.bounces
    );
    assert_eq!(health.penetrations, 0);
    assert!(mean[0] > 0.3 * expected && mean[0] < 1.5 * expected && mean[1].abs() < 0.05 * speed);
    // What the walls sweep the fluid leaves: ten columns of particles to a slice, one more or less at its edges.
    assert!(swept < 0.1, "{swept}");
    assert!((slices.iter().sum::<f64>() / length - 1.0).abs() < 0.01);
}

/// A disc that grows in a closed box: the volumes of its particles grow with it, and the fluid is pressed together by as much,
/// though the drift of its density is taken out all the time.
#[test]
fn a_growing_disc_presses_the_fluid() {
    let (n, radius, growth) = (30, 0.2, 0.04);
    let spacing = 1.0 / f64::from(n);
    let centre = V::new(0.5, 0.5);
    let place = |i: i32| V::new((f64::from(i % n) + 0.5) * spacing, (f64::from(i / n) + 0.5) * spacing);
    let particles: Vec<Placed<2>> = (0..n * n)
        .map(|i| {
            let body = u8::from((place(i) - centre).norm() < radius);
            Placed { position: place(i), volume: spacing * spacing, body }
        })
        .collect();
    let motion = deforming(1e-5, move |x: &V, t: f64| {
        (x - centre) * (growth * (1.0 - (-(t / 0.02_f64).powi(2)).exp()))
    });
    let surface: std::sync::Arc<dyn Fn(&V) -> f64 + Send + Sync> =
        std::sync::Arc::new(move |x| (x - centre).norm() - radius);
    let kind = BodyKind::Solid { slip: Slip::NoSlip, motion, surface: Some(surface) };
    let mut flow = Flow::new(Setup {
        domain: Domain { min: V::zeros(), max: V::new(1.0, 1.0), periodic: [true; 2] },
        cutoff: 3.0 * spacing,
        spacing,
        particles,
        bodies: vec![
            Body { name: "fluid".into(), kind: BodyKind::Fluid { density: 1.0, viscosity: 1.0 } },
            Body { name: "disc".into(), kind },
        ],
        reference_speed: 1.0,
        ..Setup::default()
    })
    .expect("sound");
    let volumes = |flow: &Flow<2>| {
        let seen = flow.snapshot();
        let (mut solid, mut fluid, mut density) = (0.0, 0.0, 0.0);
        for i in 0..seen.volume.len() {
            if seen.volume_fraction[i] < 1.0 {
                fluid += 1.0;
                density += seen.density[i];
            } else {
                solid += seen.volume[i];
            }
        }
        (solid, density / fluid)
    };
    let before = volumes(&flow);
    let steps = (0.1 / flow.step_limit().seconds).ceil();
    flow.advance(0.1 / steps, steps as u64).expect("stable");
    let after = volumes(&flow);
    let area = (1.0 + growth) * (1.0 + growth);
    println!("disc grown to {:.6} (exact {area:.6}), fluid to {:.5}", after.0 / before.0, after.1 / before.1);
    assert!((after.0 / before.0 - area).abs() < 1e-9);
    let pressed = 1.0 / (1.0 - before.0 * (area - 1.0) / (1.0 - before.0));
    // What is taken out is the mean of rho/rho0 - 1, which stands for the volume to first order: 1.2 %² / 2.
    assert!((after.1 / before.1 - pressed).abs() < 0.1 * (pressed - 1.0), "{} {pressed}", after.1 / before.1);
}

#[test]
fn a_displacement_in_a_model() {
    let bench = Bench::new();
    let text = std::fs::read_to_string(face::shipped("models/peristalsis.yaml")).unwrap();
    let text = text.replace("until: 3 ms", "until: 0.5 ms");
    let path = bench.model("m.yaml", &text);
    let run = face::record(&bench.run(&path, "out", &[]));
    let text = serde_json::to_string(&run).unwrap();
    assert!(text.contains("\"penetrations\":0"), "{text}");
}
