//! What all terms have in common: forces are opposite, sums over a material keep its mass.

use super::*;
use crate::fluid::particles::{Material, Side};
use crate::fluid::pass::{Approach, Pair};
use crate::fluid::setup::Friction;
use crate::fluid::symmetric::Symmetric;
use crate::space::kernel::{Kernel, KernelKind};
use crate::vector::Vector;
use rand::{Rng, SeedableRng};

type V = Vector<3>;

/// A fluid particle at rest of a density and pressure, volume and viscosity one.
pub fn side<const D: usize>(density: f64, pressure: f64) -> Side<D> {
    Side {
        velocity: Vector::zeros(),
        drift: Vector::zeros(),
        density,
        volume: 1.0,
        inverse_density: 1.0 / density,
        inverse_root: 1.0,
        id: 0,
        material: Material::Fluid,
        body: 0,
        pressure,
        viscosity: 1.0,
        moment: Symmetric::identity(1.0),
        uneven: false,
        held: false,
        reach: 0.0,
    }
}

/// Two fluid particles of any state and the pair seen from i.
fn pairs() -> Vec<(Side<3>, Side<3>, Pair<3>)> {
    let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(29);
    let kernel = Kernel::<3>::new(KernelKind::Lucy, 1.0);
    (0..50)
        .map(|_| {
            let mut any = || random.random::<f64>();
            let mut vector = || V::from_fn(|_, _| 0.8 * any() - 0.4);
            let (x, a, b, c, d) = (vector(), vector(), vector(), vector(), vector());
            let mut state = |velocity, drift| {
                let mut side = Side {
                    velocity,
                    drift,
                    volume: 0.1 + any(),
                    viscosity: 0.1 + any(),
                    ..side(0.5 + any(), any() - 0.5)
                };
                side.invert();
                side
            };
            let f = kernel.f(x.norm());
            (state(a, b), state(c, d), Pair { x, f, f_shift: f, inverse_square: 1.0 / x.norm_squared() })
        })
        .collect()
}

/// Force of a term between i and j plus that between j and i, relative to their size.
fn residue(term: impl Fn(&Pair<3>, &Side<3>, &Side<3>, &mut V)) -> f64 {
    let mut worst = 0.0_f64;
    for (i, j, pair) in pairs() {
        let back = Pair { x: -pair.x, ..pair };
        let (mut on_i, mut on_j) = (V::zeros(), V::zeros());
        term(&pair, &i, &j, &mut on_i);
        term(&back, &j, &i, &mut on_j);
        assert!(on_i.norm() > 0.0);
        worst = worst.max((on_i + on_j).norm() / on_i.norm());
    }
    worst
}

#[test]
fn every_force_is_antisymmetric() {
    // Rounding of a dozen operations.
    assert!(residue(|p, i, j, out| Pressure::Weighted.pair(p, i, j, out)) < 1e-13);
    assert!(residue(|p, i, j, out| Pressure::Squares.pair(p, i, j, out)) < 1e-13);
    assert!(residue(|p, i, j, out| TransportStress.pair(p, i, j, out)) < 1e-13);
    for form in [Friction::Morris, Friction::EspanolRevenga] {
        let friction = |p: &Pair<3>, i: &Side<3>, j: &Side<3>, out: &mut V| {
            let rub = viscosity::between_fluids(i, j) * p.f;
            Viscosity { form }.pair(rub, &p.x, &(i.velocity - j.velocity), out);
        };
        assert!(residue(friction) < 1e-13);
    }
    // The printed switch is the exception.
    assert!(residue(|p, i, j, out| Pressure::Switched.pair(p, i, j, out)) > 1.0);
}

/// Both directions of the approach of i and j.
fn approach(i: &Side<3>, j: &Side<3>, p: &Pair<3>) -> (Approach<3>, Approach<3>) {
    let there = Approach::new(&p.x, p.f, i, j);
    (there, there.back())
}

#[test]
fn density_diffusion_keeps_the_mass_sum_and_stays_in_its_material() {
    let diffusion = DensityDiffusion { strength: 0.3 };
    for (i, mut j, pair) in pairs() {
        let (there, back) = approach(&i, &j, &pair);
        let (mut to_i, mut to_j) = (0.0, 0.0);
        diffusion.pair(&there, &i, &j, &mut to_i);
        diffusion.pair(&back, &j, &i, &mut to_j);
        assert_eq!(to_i, -to_j);
        j.body = 1;
        let before = to_i;
        diffusion.pair(&there, &i, &j, &mut to_i);
        assert_eq!(to_i, before);
    }
}

#[test]
fn the_rates_of_density_differ_as_their_equations_say() {
    for (mut i, mut j, pair) in pairs() {
        let rate = |form: Continuity, i: &Side<3>, j: &Side<3>| {
            let mut out = 0.0;
            form.pair(&approach(i, j, &pair).0, i, j, &mut out);
            out
        };
        // Eq. (17) less ours: (rho_i w_i + rho_j w_j) - ½ (rho_j - rho_i)(w_i + w_j), along grad W = -F x.
        let more =
            i.drift * i.density + j.drift * j.density - (i.drift + j.drift) * (0.5 * (j.density - i.density));
        let expected = -pair.f * more.dot(&pair.x);
        let found = rate(Continuity::Printed, &i, &j) - rate(Continuity::Advected, &i, &j);
        // Rounding of a dozen operations of size one.
        assert!((found - expected).abs() < 1e-13 * pair.f.max(1.0));
        // Without drift and with equal densities all are one.
        (i.drift, j.drift, j.density) = (V::zeros(), V::zeros(), i.density);
        let one = rate(Continuity::Advected, &i, &j);
        assert_eq!(rate(Continuity::Printed, &i, &j), one);
        assert_eq!(rate(Continuity::Summed, &i, &j), one);
    }
}

#[test]
fn a_free_slip_solid_has_no_friction_and_a_no_slip_one_that_of_the_fluid() {
    for (i, mut j, _) in pairs() {
        j.material = Material::FreeSlip;
        assert_eq!(viscosity::with_solid(&i, &j), 0.0);
        j.material = Material::NoSlip;
        assert_eq!(viscosity::with_solid(&i, &j), i.viscosity);
    }
}

#[test]
fn expansion_lowers_the_density_at_the_rate_of_its_divergence() {
    // v = x on a cubic lattice: d rho/dt = -rho div v = -3 rho, up to the lattice sum of Lucy at h = 3.
    let kernel = Kernel::<3>::new(KernelKind::Lucy, 3.0);
    let centre = side::<3>(2.0, 0.0);
    let mut rate = 0.0;
    for index in 0..343 {
        let place = V::new(f64::from(index % 7), f64::from(index / 7 % 7), f64::from(index / 49))
            - V::from_element(3.0);
        if place != V::zeros() {
            let other = Side { velocity: place, ..centre };
            let inverse_square = 1.0 / place.norm_squared();
            let pair = Pair { x: -place, f: kernel.f(place.norm()), f_shift: 0.0, inverse_square };
            Continuity::Advected.pair(&approach(&centre, &other, &pair).0, &centre, &other, &mut rate);
        }
    }
    assert!((rate / -6.0 - 1.0).abs() < 0.01, "{rate}");
}

#[test]
fn both_forms_of_friction_have_the_same_shear_viscosity() {
    // v = (y, 0, 0) around a particle; the stress is -½ Σ V_j x⊗force per volume: its (x, y) part is eta.
    let kernel = Kernel::<3>::new(KernelKind::Lucy, 4.0);
    for form in [Friction::Morris, Friction::EspanolRevenga] {
        let mut stress = 0.0;
        for index in 0..729 {
            let x = V::new(f64::from(index % 9), f64::from(index / 9 % 9), f64::from(index / 81))
                - V::from_element(4.0);
            if x != V::zeros() {
                let mut out = V::zeros();
                Viscosity { form }.pair(kernel.f(x.norm()), &x, &V::new(x[1], 0.0, 0.0), &mut out);
                stress -= 0.5 * out[0] * x[1];
            }
        }
        // The lattice sum of the fourth moment at h = 4: about a per cent.
        assert!((stress - 1.0).abs() < 0.02, "{form:?}: {stress}");
    }
}

#[test]
fn friction_beyond_the_second_order_is_of_the_fourth() {
    // v = (0, cos kx) on a square lattice, h = 3: rate of decay over k² at x = 0, gradients from the same sums.
    let kernel = Kernel::<2>::new(KernelKind::Lucy, 3.0);
    let around = |centre: Vector<2>| {
        (0..49).filter_map(move |n| {
            let step = Vector::<2>::new(f64::from(n % 7) - 3.0, f64::from(n / 7) - 3.0);
            (step.norm() > 0.5).then_some(centre + step)
        })
    };
    let here = Vector::<2>::zeros();
    let moment: f64 = around(here).map(|y| kernel.f(y.norm()) * y[0] * y[0]).sum();
    let error = |k: f64, fourth: bool| {
        let v = |x: Vector<2>| (k * x[0]).cos();
        let slope = |x: Vector<2>| {
            let sum: f64 = around(x).map(|y| kernel.f((x - y).norm()) * (v(x) - v(y)) * (x - y)[0]).sum();
            sum / moment
        };
        let at = |x: Vector<2>| Side { velocity: Vector::<2>::new(0.0, v(x)), ..side(1.0, 0.0) };
        let i = at(here);
        let rate: f64 = around(here)
            .map(|y| {
                let j = at(y);
                let apart = if fourth {
                    let flux = viscosity::THETA * (slope(here) + slope(y));
                    2.0 * viscosity::beyond_the_second_order(&i, &j)[1] - flux * (here - y)[0]
                } else {
                    2.0 * (i.velocity - j.velocity)[1]
                };
                kernel.f(y.norm()) * apart / moment
            })
            .sum();
        (rate / (k * k) - 1.0).abs()
    };
    let order = |fourth: bool| (error(0.2, fourth) / error(0.1, fourth)).log2();
    // The next terms are smaller by (kh)²/20 or so.
    assert!((order(false) - 2.0).abs() < 0.05, "{}", order(false));
    assert!((order(true) - 4.0).abs() < 0.1, "{}", order(true));
}
