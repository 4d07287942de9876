//! A wall that is bent as sharply as the kernel reaches, and made of two bodies: Couette's flow between two cylinders.

use std::f64::consts::TAU;
use std::sync::Arc;

use gillesph::fluid::{Body, BodyKind, Domain, Flow, KernelKind, Motion, Placed, Setup, Slip};
use gillesph::vector::Vector;

type V = Vector<2>;
type Distance = Arc<dyn Fn(&V) -> f64 + Send + Sync>;

/// Radii of the inner and the outer cylinder, and of the core within the inner, m.
const INNER: f64 = 3.2;
const OUTER: f64 = 12.0;
const CORE: f64 = 1.6;
/// Velocity of the inner cylinder, m/s.
const SPEED: f64 = 1.0;

/// Fluid on a lattice of `spacing` (m) between the cylinders; the inner a ring around a core, as rings of particles at half
/// that spacing.
fn annulus(spacing: f64) -> Flow<2> {
    let half = 16.0;
    let centre = V::new(half, half);
    let cells = (2.0 * half / spacing).round() as i32;
    let mut particles = Vec::new();
    for row in 0..cells {
        for column in 0..cells {
            let position = V::new(f64::from(column) + 0.5, f64::from(row) + 0.5) * spacing;
            let r = (position - centre).norm();
            if r > INNER + 0.3 * spacing {
                let body = u8::from(r > OUTER);
                particles.push(Placed { position, volume: spacing * spacing, body });
            }
        }
    }
    let rings = (2.0 * INNER / spacing).round();
    let width = INNER / rings;
    for ring in 0..rings as i32 {
        let r = (f64::from(ring) + 0.5) * width;
        let count = (TAU * r / width).round().max(1.0);
        for k in 0..count as i32 {
            let angle = TAU * f64::from(k) / count;
            let position = centre + V::new(angle.cos(), angle.sin()) * r;
            let body = if r > CORE { 2 } else { 3 };
            particles.push(Placed { position, volume: TAU * r * width / count, body });
        }
    }
    let solid = |name: &str, motion, distance: Distance| Body {
        name: name.to_owned(),
        kind: BodyKind::Solid { slip: Slip::NoSlip, motion, surface: Some(distance) },
    };
    let turning = || Motion::Rotating { centre, rate: [0.0, 0.0, SPEED / INNER], domain: None };
    let radius = move |x: &V| (x - centre).norm();
    let setup = Setup {
        domain: Domain { min: V::zeros(), max: V::new(2.0 * half, 2.0 * half), periodic: [true; 2] },
        kernel: KernelKind::Lucy,
        cutoff: 3.0 * spacing,
        spacing,
        particles,
        bodies: vec![
            Body { name: "fluid".to_owned(), kind: BodyKind::Fluid { density: 1.0, viscosity: 1.0 } },
            solid("outer", Motion::Still, Arc::new(move |x| OUTER - radius(x))),
            solid("ring", turning(), Arc::new(move |x| (radius(x) - INNER).max(CORE - radius(x)))),
            solid("core", turning(), Arc::new(move |x| radius(x) - CORE)),
        ],
        reference_speed: SPEED,
        reference_length: OUTER - INNER,
        sound_speed: None,
        pressure_scale: None,
        body_force: V::zeros(),
        buoyancy: Vector::zeros(),
        sponges: Vec::new(),
        initial_velocity: V::zeros(),
        method: Default::default(),
        friction: Default::default(),
        state: Default::default(),
        noise: None,
        options: Default::default(),
    };
    Flow::new(setup).expect("the annulus is sound")
}

/// Root mean square error of the velocity once it is steady, in units of the cylinder's.
fn error(spacing: f64) -> f64 {
    let mut flow = annulus(spacing);
    // The slowest mode decays with (OUTER - INNER)²/(π² ν), some 8 s.
    flow.settle(60.0).expect("stable");
    assert_eq!(flow.health().penetrations, 0);
    let seen = flow.snapshot();
    let (mut sum, mut count) = (0.0, 0.0);
    for i in 0..seen.position.len() {
        let x = seen.position[i] - V::new(16.0, 16.0);
        let r = x.norm();
        if seen.volume_fraction[i] < 1.0 {
            let exact = SPEED * INNER / (OUTER * OUTER - INNER * INNER) * (OUTER * OUTER / r - r);
            let turning = V::new(-x[1], x[0]) / r * exact;
            sum += (seen.velocity[i] - turning).norm_squared();
            count += 1.0;
        }
    }
    f64::sqrt(sum / count) / SPEED
}

/// The radius is 3.2 spacings, then 6.4: errors of 6.2e-3 and 6.3e-4.
#[test]
fn a_cylinder_as_small_as_the_kernel_drags_the_fluid_as_it_should() {
    let (coarse, fine) = (error(1.0), error(0.5));
    println!("{coarse:.2e} {fine:.2e}");
    assert!(coarse < 1e-2 && fine < 1.5e-3, "{coarse} {fine}");
}
