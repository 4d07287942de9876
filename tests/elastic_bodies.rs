//! Elastic bodies in a fluid: momentum, the pressure they feel, how they give way, and that fluid stays outside.

use gillesph::fluid::{Body, BodyKind, Coupled, Domain, Flow, KernelKind, Motion, Placed, Setup, Slip};
use gillesph::solid::{self, Elastic, Hold, Law, Material, Options};
use gillesph::vector::Vector;
use std::sync::Arc;

/// The elastic solid of some places, each a cube of edge `spacing`.
fn solid<const D: usize>(
    places: &[Vector<D>],
    spacing: f64,
    domain: &Domain<D>,
    material: Material,
    clamped: impl Fn(&Vector<D>) -> bool,
    options: Options<D>,
) -> Elastic<D> {
    Elastic::new(solid::Setup {
        domain: domain.clone(),
        kernel: KernelKind::Lucy,
        cutoff: 1.6 * spacing,
        places: places.to_vec(),
        volumes: vec![spacing.powi(D as i32); places.len()],
        holds: places.iter().map(|x| if clamped(x) { Hold::Clamped } else { Hold::Free }).collect(),
        material,
        options,
    })
    .expect("a sound solid")
}

fn elastic<const D: usize>(flow: &Flow<D>) -> &Elastic<D> {
    flow.elastic_bodies().next().expect("one body").1.solid()
}

fn bodies<const D: usize>(
    fluid: (f64, f64),
    solid: Elastic<D>,
    surface: Arc<dyn Fn(&Vector<D>) -> f64 + Send + Sync>,
) -> Vec<Body<D>> {
    let motion = Coupled::motion(solid).expect("a sound solid");
    vec![
        Body { name: "fluid".into(), kind: BodyKind::Fluid { density: fluid.0, viscosity: fluid.1 } },
        Body {
            name: "solid".into(),
            kind: BodyKind::Solid { slip: Slip::NoSlip, motion, surface: Some(surface) },
        },
    ]
}

/// A soft ball (2D: a disc) in the middle of a periodic box of side one with `n` particles along each edge; rho = nu = 1.
fn ball<const D: usize>(n: i32, density: f64, young: f64) -> Flow<D> {
    let (spacing, radius) = (1.0 / f64::from(n), 0.22);
    let centre = Vector::<D>::from_element(0.5);
    let domain = Domain { min: Vector::zeros(), max: Vector::from_element(1.0), periodic: [true; D] };
    let places: Vec<Vector<D>> = (0..n.pow(D as u32))
        .map(|index| Vector::from_fn(|k, _| (f64::from(index / n.pow(k as u32) % n) + 0.5) * spacing))
        .collect();
    let inside = |x: &&Vector<D>| (**x - centre).norm() < radius;
    let mine: Vec<Vector<D>> = places.iter().filter(inside).copied().collect();
    let material = Material::of_young(Law::NeoHookean, density, young, 0.3);
    let mut solid = solid(&mine, spacing, &domain, material, |_| false, Options::default());
    solid.set_velocity(|_| Vector::from_fn(|k, _| 0.3 - 0.2 * k as f64));
    let particles = places.iter().map(|x| Placed {
        position: *x,
        volume: spacing.powi(D as i32),
        body: u8::from(inside(&x)),
    });
    let setup = Setup {
        particles: particles.collect(),
        domain,
        cutoff: 2.8 * spacing,
        spacing,
        bodies: bodies((1.0, 1.0), solid, Arc::new(move |x: &Vector<D>| (x - centre).norm() - radius)),
        ..Setup::default()
    };
    let mut flow = Flow::new(setup).expect("a sound setup");
    let wave = std::f64::consts::TAU;
    flow.set_velocity(|x| Vector::from_fn(|k, _| (wave * x[(k + 1) % D]).sin() + 0.1));
    flow
}

fn momentum_is_kept<const D: usize>(n: i32, density: f64, steps: u64) {
    let mut flow = ball::<D>(n, density, 30.0);
    let total = |flow: &Flow<D>| flow.health().momentum + elastic(flow).momentum();
    let seen = flow.snapshot();
    let scale: f64 = (0..seen.volume.len()).map(|i| seen.velocity[i].norm() * seen.volume[i]).sum();
    let before = total(&flow);
    let dt = flow.step_limit().seconds;
    flow.advance(dt, steps).expect("stable");
    flow.advance(0.5 * dt, 5).expect("stable");
    let drift = (total(&flow) - before).norm() / scale;
    let (body, health) = (elastic(&flow), flow.health());
    let stretch = (0..body.len()).map(|i| body.stretch(i)).fold(0.0, f64::max);
    println!("{D}D, density {density}: drift {drift:.1e}, stretch {stretch:.3}, bounces {}", health.bounces);
    // A few thousand additions of rounding errors of 1e-16 of the largest.
    assert!(drift < 1e-12, "{drift}");
    assert!(stretch > 1.01, "it must have been deformed");
    assert_eq!(health.penetrations, 0);
}

#[test]
fn momentum_of_fluid_and_solid_is_kept() {
    for density in [0.5, 1.0, 2.0] {
        momentum_is_kept::<2>(24, density, 400);
    }
    momentum_is_kept::<3>(14, 1.0, 100);
}

#[test]
fn a_flow_with_an_elastic_body_goes_on_from_an_image() {
    let mut straight = ball::<2>(20, 0.7, 30.0);
    let dt = straight.step_limit().seconds;
    straight.advance(dt, 60).expect("stable");
    let file = postcard::to_allocvec(&straight.image()).expect("serializes");
    straight.advance(dt, 60).expect("stable");
    let mut resumed = ball::<2>(20, 0.7, 30.0);
    resumed.restore(postcard::from_bytes(&file).expect("deserializes")).expect("fits");
    resumed.advance(dt, 60).expect("stable");
    assert_eq!(straight.snapshot(), resumed.snapshot());
    assert_eq!(elastic(&straight).image(), elastic(&resumed).image());
    assert!(ball::<2>(22, 0.7, 30.0).restore(straight.image()).is_none());
}

/// Places in the middle of the cells of width `spacing` between two corners.
fn lattice(low: [f64; 2], high: [f64; 2], spacing: f64) -> Vec<Vector<2>> {
    let count = |k: usize| ((high[k] - low[k]) / spacing).round() as i32;
    let at = |k: usize, n: i32| low[k] + (f64::from(n) + 0.5) * spacing;
    let rows = (0..count(1)).flat_map(|j| (0..count(0)).map(move |i| (i, j)));
    rows.map(|(i, j)| Vector::<2>::new(at(0, i), at(1, j))).collect()
}

/// Still water of depth one under a lid, periodic in x, g = 1 downwards, over a floor and before a solid between two
/// corners; c² = 50. What of the solid is below y = 0, or all of it, is clamped.
fn tank(width: f64, low: [f64; 2], high: [f64; 2], ratio: f64, material: Material, clamped: bool) -> Flow<2> {
    let spacing = 1.0 / 20.0;
    let edge = ratio * spacing;
    let domain = Domain {
        min: Vector::<2>::new(0.0, low[1].min(0.0)),
        max: Vector::<2>::new(width, 1.0),
        periodic: [true, false],
    };
    let covers =
        move |x: &Vector<2>| (low[0] - x[0]).max(x[0] - high[0]).max(low[1] - x[1]).max(x[1] - high[1]);
    let mine = lattice(low, high, edge);
    let options = Options { drag: 30.0, ..Options::default() };
    // One row more: corrected sums give way as if held a spacing below the first row that is.
    let held = move |x: &Vector<2>| clamped || x[1] < edge;
    let solid = solid(&mine, edge, &domain, material, held, options);
    let mut particles = Vec::new();
    let floor = domain.min[1];
    for position in lattice([0.0, floor - 0.2], [width, 1.2], spacing) {
        if covers(&position) > 0.0 && (floor == 0.0 || position[1] > 0.0) {
            let body = if (0.0..1.0).contains(&position[1]) { 0 } else { 2 };
            particles.push(Placed { position, volume: spacing * spacing, body });
        }
    }
    particles.extend(mine.iter().map(|x| Placed { position: *x, volume: edge * edge, body: 1 }));
    let mut bodies = bodies((1.0, 0.05), solid, Arc::new(covers));
    bodies.push(Body {
        name: "walls".into(),
        kind: BodyKind::Solid { slip: Slip::NoSlip, motion: Motion::Still, surface: None },
    });
    let setup = Setup {
        domain,
        cutoff: 3.0 * spacing,
        spacing,
        particles,
        bodies,
        reference_speed: 0.2,
        sound_speed: Some(50.0_f64.sqrt()),
        body_force: Vector::<2>::new(0.0, -1.0),
        ..Setup::default()
    };
    Flow::new(setup).expect("a sound setup")
}

/// Archimedes: pressure times area below less that above is the weight of the water displaced.
#[test]
fn pressure_on_a_body_is_that_of_the_water_for_all_spacings() {
    for ratio in [0.5, 1.0, 2.0] {
        let material = Material::of_young(Law::SaintVenantKirchhoff, 1.0, 1.0, 0.3);
        let mut flow = tank(1.2, [0.4, 0.3], [0.8, 0.7], ratio, material, true);
        let dt = flow.step_limit().seconds;
        flow.advance(dt, (3.0 / dt) as u64).expect("stable");
        let (mut force, mut sides) = (Vector::<2>::zeros(), 0.0);
        let mut samples = 0.0;
        for _ in 0..20 {
            flow.advance(dt, 10).expect("stable");
            for one in flow.reactions() {
                force += one.force;
                sides += one.force[0].abs();
            }
            samples += 1.0;
        }
        let (lift, across) = (force[1] / samples / 0.16, force[0] / sides);
        let health = flow.health();
        println!(
            "spacing ratio {ratio}: lift {lift:.4} of the weight of the water, across {across:.1e}, {:?}",
            health.largest_density_change
        );
        // Within some per cent: the body is eight particles of the fluid wide, and four of its own where they are the
        // larger ones.
        assert!((lift - 1.0).abs() < 0.06, "{lift}");
        assert!(across.abs() < 0.02, "{across}");
        assert_eq!(health.penetrations, 0);
    }
}

/// A soft floor of height H under water of depth L. With M = K + 4G/3 it gives way by u = (p + rho g H/2) H/M under the
/// pressure p on it and its own weight, and the water under the lid expands as much: p = rho g L/2 - rho c² u/L.
#[test]
fn a_soft_floor_gives_way_under_the_water() {
    for ratio in [0.5, 1.0, 2.0] {
        let (height, depth) = (0.4, 0.6);
        let material = Material::of_young(Law::SaintVenantKirchhoff, 1.0, 50.0, 0.3);
        let stiffness = material.bulk + 4.0 / 3.0 * material.shear;
        let mut flow = tank(0.6, [0.0, -0.4], [0.6, height], ratio, material, false);
        let dt = flow.step_limit().seconds;
        flow.advance(dt, (4.0 / dt) as u64).expect("stable");
        let soft = height / stiffness;
        let foreseen = -0.5 * soft * (depth + height) / (1.0 + 50.0 * soft / depth);
        let pressure = 0.5 * depth + 50.0 * foreseen / depth;
        let push = |flow: &Flow<2>| flow.reactions().map(|one| one.force[1]).sum::<f64>();
        let mut force = 0.0;
        for _ in 0..20 {
            flow.advance(dt, 20).expect("stable");
            force += push(&flow) / 20.0;
        }
        let body = elastic(&flow);
        let top = body.places().iter().map(|x| x[1]).fold(0.0, f64::max);
        let row: Vec<usize> = (0..body.len()).filter(|&i| body.places()[i][1] == top).collect();
        let moved: f64 = row.iter().map(|&i| (body.position(i) - body.places()[i])[1]).sum();
        let moved = moved / row.len() as f64;
        println!(
            "spacing ratio {ratio}: {moved:.5} of {foreseen:.5}, {:.4} of {:.4}",
            force / 0.6,
            -pressure
        );
        // Four rows in all of the coarsest floor.
        assert!((moved / foreseen - 1.0).abs() < 0.1);
        // The level of pressure hangs on hundredths of a spacing that the floor gives way: of the water's own pressure.
        assert!((force / 0.6 + pressure).abs() < 0.04 * depth);
        assert_eq!(flow.health().penetrations, 0);
    }
}
/// A flap on the floor of a periodic channel, fluid driven along it; rho = nu = 1. It is bent as the theory of
/// beams says of the loads on its particles, whatever its density:
/// u = Σ F y² (3 L - y)/(6 E' I), E' = E/(1 - ν²), I = W³/12.
#[test]
fn a_flap_bends_as_a_beam_under_the_loads_of_the_fluid() {
    let (spacing, edge, height, width) = (0.05, 0.025, 0.5, 0.15);
    let (young, poisson) = (2e4, 0.3);
    for density in [0.5, 1.0, 2.0] {
        let domain =
            Domain { min: Vector::<2>::zeros(), max: Vector::<2>::new(2.0, 1.0), periodic: [true, false] };
        let (low, high) = ([1.0, 0.0], [1.0 + width, height]);
        let covers = move |x: &Vector<2>| (low[0] - x[0]).max(x[0] - high[0]).max(x[1] - high[1]);
        let mine = lattice(low, high, edge);
        let material = Material::of_young(Law::SaintVenantKirchhoff, density, young, poisson);
        let solid = solid(&mine, edge, &domain, material, |x| x[1] < edge, Options::default());
        let mut particles: Vec<Placed<2>> = lattice([0.0, -0.15], [2.0, 1.15], spacing)
            .into_iter()
            .filter(|x| covers(x) > 0.0 || x[1] < 0.0)
            .map(|position| {
                let body = if (0.0..1.0).contains(&position[1]) { 0 } else { 2 };
                Placed { position, volume: spacing * spacing, body }
            })
            .collect();
        particles.extend(mine.iter().map(|x| Placed { position: *x, volume: edge * edge, body: 1 }));
        let mut bodies = bodies((1.0, 1.0), solid, Arc::new(covers));
        bodies.push(Body {
            name: "walls".into(),
            kind: BodyKind::Solid { slip: Slip::NoSlip, motion: Motion::Still, surface: None },
        });
        let setup = Setup {
            domain,
            cutoff: 2.8 * spacing,
            spacing,
            particles,
            bodies,
            sound_speed: Some(15.0),
            body_force: Vector::<2>::new(5.0, 0.0),
            ..Setup::default()
        };
        let mut flow = Flow::new(setup).expect("a sound setup");
        let steps = (1.0 / flow.step_limit().seconds).ceil();
        flow.advance(1.0 / steps, steps as u64).expect("stable");
        let number = flow.elastic_bodies().next().expect("one body").0;
        let body = elastic(&flow);
        let top = body.places().iter().map(|x| x[1]).fold(0.0, f64::max);
        let row: Vec<usize> = (0..body.len()).filter(|&i| body.places()[i][1] == top).collect();
        let tip =
            row.iter().map(|&i| (body.position(i) - body.places()[i])[0]).sum::<f64>() / row.len() as f64;
        let mut foreseen = 0.0;
        for one in flow.reactions().filter(|one| one.body == number) {
            // Bent by little: heights are those at rest.
            let y = one.position[1];
            // The drive pulls at the flap too.
            let pull = 5.0 * density * edge * edge;
            foreseen += (one.force[0] + pull) * y * y * (3.0 * height - y);
        }
        foreseen /= 6.0 * young / (1.0 - poisson * poisson) * width.powi(3) / 12.0;
        println!(
            "density {density}: tip {tip:.5}, theory {foreseen:.5}, solid energy {:.1e}, {:?}",
            body.kinetic_energy(),
            flow.health()
        );
        assert!(tip > 0.01);
        // Six particles across: I is less by 1/6²; shear bends a beam as short as this by a few per cent more.
        assert!((tip / foreseen - 1.0).abs() < 0.05, "{tip} {foreseen}");
        assert_eq!(flow.health().penetrations, 0);
    }
}
