//! Walls in balance against exact answers: Lamé, growth, Lockhart, columns put in.

use super::*;
use crate::solid::{Hold, Law, Material, Options};
const TIGHT: Relaxation = Relaxation { tolerance: 1e-7, rounds: 100_000, stretch: 8.0 };

/// A wall about the origin, outer radius one.
fn vessel<const D: usize>(
    inner: f64,
    layers: usize,
    young: f64,
    pressure: f64,
    growth: Option<Growth>,
) -> Vessel<D> {
    let spacing = (1.0 - inner) / layers as f64;
    let built = Wall::<D>::round(&Vector::zeros(), inner, 1.0, spacing);
    let n = built.places.len();
    let setup = Setup {
        domain: Domain {
            min: Vector::from_element(-9.0),
            max: Vector::from_element(9.0),
            periodic: [false; D],
        },
        kernel: KernelKind::Lucy,
        cutoff: 1.6 * spacing,
        places: built.places,
        volumes: built.volumes,
        holds: vec![Hold::Free; n],
        material: Material::of_young(Law::NeoHookean, 1000.0, young, 0.3),
        options: Options::default(),
    };
    Vessel::new(setup, built.wall, Turgor { pressure, stiffness: 0.0, rise: 0.0 }, growth, TIGHT).unwrap()
}

/// Root mean square errors of radial displacement, radial and hoop stress against Lamé's solution, over their size.
fn lame<const D: usize>(inner: f64, layers: usize) -> [f64; 3] {
    let (p, nu, d) = (1e-4, 0.3, D as i32);
    let mut vessel = vessel::<D>(inner, layers, 1.0, p, None);
    vessel.relax(0.0).unwrap();
    let normals = vessel.wall.normals(&vessel.solid);
    let stresses = vessel.wall.stresses(&vessel.solid, &normals);
    let k = p * inner.powi(d) / (1.0 - inner.powi(d));
    let (mut error, mut size) = ([0.0; 3], [0.0; 3]);
    for (i, stress) in stresses.iter().enumerate() {
        let x = vessel.solid.places()[i];
        let (r, out) = (x.norm(), crate::solid::recover::space(&(x / x.norm())));
        let (u, across) = ((vessel.solid.position(i) - x).dot(&x) / r, out.dot(&(stress * out)));
        let bulge = r.powi(-d);
        let exact = if D == 2 {
            [(1.0 + nu) * k * ((1.0 - 2.0 * nu) * r + 1.0 / r), k * (1.0 - bulge), k * (1.0 + bulge)]
        } else {
            let u = k * ((1.0 - 2.0 * nu) * r + (1.0 + nu) * 0.5 / (r * r));
            [u, k * (1.0 - bulge), k * (1.0 + 0.5 * bulge)]
        };
        let plane: f64 = (0..D).map(|a| stress[(a, a)]).sum();
        let hoop = (plane - across) / (D as f64 - 1.0);
        for (at, (ours, exact)) in [u, across, hoop].into_iter().zip(exact).enumerate() {
            error[at] += (ours - exact).powi(2);
            size[at] += exact * exact;
        }
    }
    // Both stresses against the size of the whole stress.
    let whole = size[1] + size[2];
    [(error[0] / size[0]).sqrt(), (error[1] / whole).sqrt(), (error[2] / whole).sqrt()]
}

#[test]
fn rings_and_shells_under_pressure_follow_lame() {
    // Measured: 0.5, 0.7 and 1.1 % (thick ring), 0.2, 0.2 and 0.4 % (thin), 0.8, 1.5 and 1.5 % (shell).
    for [u, across, hoop] in [lame::<2>(0.75, 4), lame::<2>(0.9, 4), lame::<3>(0.75, 4)] {
        assert!(u < 0.02 && across < 0.02 && hoop < 0.02, "{u} {across} {hoop}");
    }
    let errors: Vec<[f64; 3]> = [4, 6, 8].into_iter().map(|layers| lame::<2>(0.75, layers)).collect();
    for (k, name) in ["displacement", "radial stress", "hoop stress"].into_iter().enumerate() {
        let order = (errors[0][k] / errors[2][k]).log2();
        // First order at least, within what changes with the number of layers.
        assert!(errors[2][k] < errors[0][k] && order > 0.4, "{name}: order {order}");
    }
}

/// Radius of the inner surface (outer one at rest: 1) of a neo-Hookean ring under pressure, plane strain: shooting on
/// dP_R/dR = (P_Θ - P_R)/R, λ_r = r', λ_θ = r/R, P_k = G (λ_k - 1/λ_k) + λ ln(λ_r λ_θ)/λ_k.
fn inflated(inner: f64, pressure: f64, material: &Material) -> f64 {
    let (g, lame) = (material.shear, material.bulk - 2.0 / 3.0 * material.shear);
    let stress = |a: f64, b: f64| g * (a - 1.0 / a) + lame * (a * b).ln() / a;
    // λ_r of a radial stress, by Newton's method.
    let radial = |p: f64, hoop: f64| {
        let mut a = 1.0;
        for _ in 0..50 {
            let slope = g * (1.0 + 1.0 / (a * a)) + lame * (1.0 - (a * hoop).ln()) / (a * a);
            a -= (stress(a, hoop) - p) / slope;
        }
        a
    };
    // Radial stress that is left outside when the inner surface goes to `r`.
    let outside = |r: f64| {
        let (steps, mut at) = (400, [r, -pressure * r / inner]);
        let h = (1.0 - inner) / f64::from(steps);
        let rate = |x: f64, at: [f64; 2]| {
            let (hoop, a) = (at[0] / x, radial(at[1], at[0] / x));
            [a, (stress(hoop, a) - at[1]) / x]
        };
        for k in 0..steps {
            let x = inner + h * f64::from(k);
            let a = rate(x, at);
            let b = rate(x + 0.5 * h, [at[0] + 0.5 * h * a[0], at[1] + 0.5 * h * a[1]]);
            at = [at[0] + h * b[0], at[1] + h * b[1]];
        }
        at[1]
    };
    let (mut low, mut high) = (inner, 1.6 * inner);
    for _ in 0..60 {
        let r = 0.5 * (low + high);
        if outside(r) < 0.0 { low = r } else { high = r }
    }
    low
}

#[test]
fn a_ring_blown_up_by_a_quarter_follows_the_exact_solution() {
    let mut vessel = vessel::<2>(0.75, 4, 1.0, 0.05, None);
    vessel.relax(0.0).unwrap();
    let exact = inflated(0.75, 0.05, &vessel.solid.material);
    let inner = vessel.wall.inner(|i| vessel.solid.position(i));
    let ours = inner.iter().map(|x| x.norm()).sum::<f64>() / inner.len() as f64;
    // Measured: 0.5 %.
    assert!(exact > 0.85 && ((ours - exact) / (exact - 0.75)).abs() < 0.02, "{ours} {exact}");
}

#[test]
fn a_wall_without_equilibrium_is_told() {
    // A neo-Hookean ring holds no more than about G ln(outer/inner) = 0.11. A little above it is stretched far or comes to
    // no rest; far above it particles turn inside out as the load comes all at once.
    for pressure in [0.105, 0.14, 0.5, 3.0] {
        let told = vessel::<2>(0.75, 4, 1.0, pressure, None).relax(0.0).unwrap_err().to_string();
        assert!(told.contains("no equilibrium") && told.contains("balloons"), "{pressure}: {told}");
    }
}

#[test]
fn a_tolerance_below_rounding_is_told_as_such() {
    let mut vessel = vessel::<2>(0.75, 4, 1.0, 0.01, None);
    vessel.relaxation = Relaxation { tolerance: 1e-15, rounds: 4000, stretch: 8.0 };
    let told = vessel.relax(0.0).unwrap_err().to_string();
    assert!(told.contains("all but balanced") && told.contains("mechanics.tolerance: 1e-12"), "{told}");
    assert!(!told.contains("balloons"), "{told}");
}

#[test]
fn a_particle_turned_inside_out_by_no_load_is_told_as_such() {
    use crate::solid::unbalanced::Lost;
    let solid = vessel::<2>(0.75, 4, 1.0, 0.0, None).solid;
    let told = |risen, eases| {
        let lost = Lost::Inverted { error: Box::new(solid.inverted(7)), risen };
        solid.unbalanced(lost, eases, &TIGHT).to_string()
    };
    let (alone, loaded, rising) = (told(1.0, false), told(1.0, true), told(0.4, false));
    assert!(
        alone.contains("particle 7") && alone.contains("crushed") && !alone.contains("balloons"),
        "{alone}"
    );
    assert!(loaded.contains("under a quarter") && rising.contains("balloons"), "{loaded} {rising}");
}

#[test]
fn the_period_is_that_of_the_slowest_mode() {
    // A thin ring breathes with ω² = E/((1 - ν²) ρ r²).
    let breath = std::f64::consts::TAU * 0.95 * (1000.0 * (1.0 - 0.09_f64)).sqrt();
    let mut vessel = vessel::<2>(0.9, 3, 1.0, 1e-3, None);
    // Near rounding the last rounds show no mode.
    vessel.relaxation.tolerance = 1e-12;
    let period = vessel.relax(0.0).unwrap().period;
    // Measured: 1.1 %, the curvature of the wall.
    assert!((period / breath - 1.0).abs() < 0.03, "{period} for {breath}");
    // A little softer on one side it is in balance soon, too soon for that mode to show.
    vessel.relaxation.tolerance = 1e-4;
    let places = vessel.solid.places().to_vec();
    for (softness, x) in vessel.solid.softness_mut().iter_mut().zip(places) {
        *softness = if x[0] > 0.8 { 0.999 } else { 1.0 };
    }
    vessel.advance(1.0, &[]).unwrap();
    assert!(vessel.last().lasted > 0.0 && vessel.last().lasted < period, "{:?}", vessel.last());
    assert!(vessel.last().period >= period, "{:?}", vessel.last());
}

#[test]
fn turgor_below_zero_is_told() {
    let mut vessel = vessel::<2>(0.75, 4, 1.0, 0.0, None);
    vessel.turgor = Turgor { pressure: 0.0, stiffness: 0.1, rise: 0.0 };
    vessel.relax(0.0).unwrap();
    // The wall grows of itself, without more liquid.
    let normals = vessel.wall.normals(&vessel.solid);
    let along = |n: &Vector<2>| Vector::<2>::from_fn(|k, _| [-n[1], n[0]][k]);
    let rates: Vec<Rates<2>> =
        normals.iter().flat_map(|n| [Rates { directions: [along(n), *n], rates: [0.1, 0.1] }; 4]).collect();
    vessel.solid.grow(&rates, 1.0);
    vessel.solid.renew().unwrap();
    let told = vessel.relax(0.0).unwrap_err().to_string();
    assert!(told.contains("holds more than its liquid fills") && told.contains("stiffness"), "{told}");
}

#[test]
fn free_growth_that_fits_is_free_of_stress() {
    fn grown<const D: usize>() {
        let mut vessel = vessel::<D>(0.75, 3, 1.0, 0.0, None);
        let rates: Vec<Rates<D>> = vessel
            .wall
            .normals(&vessel.solid)
            .iter()
            .flat_map(|_| {
                vec![
                    Rates {
                        directions: std::array::from_fn(|k| Matrix::<D>::identity().column(k).into()),
                        rates: [0.1; D]
                    };
                    3
                ]
            })
            .collect();
        let delivered = vessel.solid.grow(&rates, 1.0);
        vessel.solid.strain().unwrap();
        vessel.solid.pull();
        vessel.relax(0.0).unwrap();
        let factor = 0.1_f64.exp();
        for i in 0..vessel.solid.len() {
            // To the tolerance of the relaxation, of a strain of 1e-4.
            let ratio = vessel.solid.position(i).norm() / vessel.solid.places()[i].norm();
            assert!((ratio / factor - 1.0).abs() < 1e-6, "{ratio}");
            assert!(vessel.solid.stress(i).norm() < 1e-6);
        }
        let grown = vessel.start.2 * (0.1 * D as f64).exp_m1();
        assert!((delivered / grown - 1.0).abs() < 1e-12);
    }
    grown::<2>();
    grown::<3>();
}

/// Growth for `dt` without new columns.
fn grow<const D: usize>(vessel: &mut Vessel<D>, dt: f64, phi: &[f64]) {
    let mut left = dt;
    while left > 1e-9 * dt {
        left -= vessel.grow(left, phi).unwrap();
    }
}

/// Radius of the middle and mass of a thin ring over those at the start after growing under constant turgor, and the
/// worst of growth over that of Lockhart's law with the stress p r_i/t of the moment.
fn lockhart_ring(steps: u32, young: f64) -> (f64, f64) {
    let (phi, yields) = (0.04, 3.0);
    let mut vessel = vessel::<2>(0.9, 3, young, 1.0, Some(Growth { yields, insert_at: 9.0, reserve: 0 }));
    vessel.relax(0.0).unwrap();
    let (n, dt) = (vessel.solid.len(), 0.25 / f64::from(steps));
    let mut worst: f64 = 0.0;
    for _ in 0..steps {
        let pull = |vessel: &Vessel<2>| {
            let at = |i| vessel.solid.position(i);
            let size =
                |nodes: Vec<Vector<2>>| nodes.iter().map(|x| x.norm()).sum::<f64>() / nodes.len() as f64;
            let (inner, outer) = (size(vessel.wall.inner(at)), size(vessel.wall.outer(at)));
            inner / (outer - inner)
        };
        let (before, mass) = (pull(&vessel), vessel.mass());
        grow(&mut vessel, dt, &vec![phi; n]);
        // The mean of both ends is second order in the step.
        let exact = phi * (0.5 * (before + pull(&vessel)) - yields);
        worst = worst.max(((vessel.mass() / mass).ln() / dt / exact - 1.0).abs());
    }
    assert!(vessel.imbalance().abs() < 1e-12, "{}", vessel.imbalance());
    let middle = vessel.wall.middle(|i| vessel.solid.position(i));
    (middle.iter().map(|x| x.norm()).sum::<f64>() / middle.len() as f64, worst)
}

#[test]
fn a_ring_above_yield_grows_as_lockhart_says() {
    let (stiff, worst) = lockhart_ring(10, 300.0);
    // Measured 0.1 %: the wall is a tenth of the radius and strained by 3 %.
    assert!(stiff > 1.0 && worst < 0.01, "{worst}");
    // Midpoint: halving the step divides what is left by four.
    let radius = [8, 16, 32].map(|steps| lockhart_ring(steps, 60.0).0);
    let ratio = (radius[0] - radius[1]) / (radius[1] - radius[2]);
    assert!((3.0..5.0).contains(&ratio), "{ratio}");
}

/// Columns, mass, volume inside and width of a wall that has grown on one side to more than twice its length there.
fn grown_in(steps: u32) -> (usize, [f64; 3]) {
    let growth = Growth { yields: 1.0, insert_at: 1.5, reserve: 200 };
    let mut vessel = vessel::<2>(0.75, 4, 60.0, 1.0, Some(growth));
    vessel.relaxation.tolerance = 1e-4;
    vessel.relax(0.0).unwrap();
    let near = |x: &Vector<2>| 0.15 * (-8.0 * (x - Vector::<2>::x()).norm_squared()).exp();
    let mut phi: Vec<f64> = vessel.solid.places().iter().map(near).collect();
    for _ in 0..steps {
        for birth in vessel.advance(2.4 / f64::from(steps), &phi).unwrap() {
            // In order: donors may be new themselves, and nobody is left out.
            assert_eq!(birth.particle, phi.len());
            phi.push(birth.donors.iter().map(|one| 0.5 * phi[one.0]).sum());
        }
    }
    assert!(vessel.largest_stretch() > 2.2 && vessel.imbalance().abs() < 1e-12 && vessel.escapes() == 0);
    (vessel.wall.columns, [vessel.mass(), vessel.inside().volume, vessel.thinnest()])
}

#[test]
fn columns_come_in_as_fast_as_the_wall_grows_whatever_the_step() {
    // In one step it would be stretched 2.2 times before the first column came.
    let (columns, one) = grown_in(1);
    let (others, many) = grown_in(16);
    // Measured: 98 columns of 88; mass and volume equal to 1e-5, the thinnest place to 1e-3.
    assert!(columns > 90 && columns == others, "{columns} {others}");
    for (one, many) in one.into_iter().zip(many) {
        assert!((one / many - 1.0).abs() < 0.01, "{one} {many}");
    }
}

#[test]
fn columns_that_have_just_come_in_can_divide_at_once() {
    let growth = Growth { yields: 1.0, insert_at: 1.2, reserve: 400 };
    let mut vessel = vessel::<2>(0.75, 3, 60.0, 1.0, Some(growth));
    vessel.relaxation.tolerance = 1e-4;
    vessel.relax(0.0).unwrap();
    // As if it had been three times as fine at the start: each edge is split twice.
    vessel.start.1 = vessel.start.1.map(|edge| edge / 3.0);
    let n = vessel.solid.len();
    let births = vessel.advance(1e-3, &vec![0.01; n]).unwrap();
    assert!(births.iter().any(|birth| birth.donors.iter().any(|donor| donor.0 >= n)));
    assert!(vessel.imbalance().abs() < 1e-12 && vessel.wall.columns >= 4 * n / 3);
}

#[test]
fn a_vessel_goes_on_from_a_state_as_if_nothing_had_been() {
    let growth = Growth { yields: 1.0, insert_at: 1.2, reserve: 200 };
    let new = || vessel::<2>(0.75, 3, 20.0, 1.0, Some(growth));
    let phi = |vessel: &Vessel<2>| -> Vec<f64> {
        (0..vessel.solid.len()).map(|i| 0.05 * f64::from(vessel.solid.position(i)[0] > 0.9)).collect()
    };
    let mut straight = new();
    straight.relax(0.0).unwrap();
    let mut births = 0;
    for _ in 0..4 {
        births += straight.advance(0.3, &phi(&straight)).unwrap().len();
    }
    let file = postcard::to_allocvec(&straight.image()).unwrap();
    let mut resumed = new();
    resumed.restore(postcard::from_bytes(&file).unwrap()).expect("fits");
    for vessel in [&mut straight, &mut resumed] {
        for _ in 0..4 {
            births += vessel.advance(0.3, &phi(vessel)).unwrap().len();
        }
    }
    assert!(births > 0 && straight.image() == resumed.image());
    // One of fewer columns belongs to another setup.
    let mut larger = vessel::<2>(0.9, 3, 20.0, 1.0, None);
    assert!(larger.restore(new().image()).is_none());
}

#[test]
fn columns_come_in_without_a_jump() {
    let growth = Growth { yields: 1.0, insert_at: 1.5, reserve: 200 };
    let mut vessel = vessel::<2>(0.75, 4, 20.0, 1.0, Some(growth));
    vessel.relax(0.0).unwrap();
    let phi: Vec<f64> = vessel
        .solid
        .places()
        .iter()
        .map(|x| 0.1 * (-8.0 * (x - Vector::<2>::x()).norm_squared()).exp())
        .collect();
    let mut phi = phi;
    let mut came = 0;
    for _ in 0..12 {
        grow(&mut vessel, 0.1, &phi);
        let (mass, inside) = (vessel.mass(), vessel.inside().volume);
        let before: Vec<_> = vessel.wall.stresses(&vessel.solid, &vessel.wall.normals(&vessel.solid));
        let births = vessel.insert().unwrap();
        came += births.len();
        for birth in &births {
            phi.push(birth.donors.iter().map(|one| 0.5 * phi[one.0]).sum());
        }
        if !births.is_empty() {
            assert!((vessel.mass() / mass - 1.0).abs() < 1e-13);
            let after = vessel.wall.stresses(&vessel.solid, &vessel.wall.normals(&vessel.solid));
            let change = before.iter().zip(&after).map(|(a, b)| (a - b).norm_squared()).sum::<f64>().sqrt();
            let size = before.iter().map(|a| a.norm_squared()).sum::<f64>().sqrt();
            let swell = vessel.inside().volume / inside - 1.0;
            // Measured: stress 1.3, 1.0 and 0.9 %, most of it at the new columns; volume 0.16, 0.02 and 0.02 %.
            assert!(change < 0.02 * size && swell.abs() < 3e-3, "{} {swell}", change / size);
        }
    }
    assert!(came > 0 && vessel.imbalance().abs() < 1e-12 && vessel.escapes() == 0);
}
