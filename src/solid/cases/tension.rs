//! Plates and rods pulled at their ends, free all round: what the middle comes to.

use super::{lattice, setup};
use crate::solid::{Elastic, Law};

/// Stretch along and across, and stress along, in the middle of a bar pulled by `stress` (force over area at rest).
fn pulled<const D: usize>(counts: [usize; D], law: Law, stress: f64) -> (f64, f64, f64) {
    let places = lattice(counts, 0.1);
    let mut setup = setup(places.clone(), 0.1, law);
    setup.options.drag = 0.8;
    setup.options.viscosity = 0.05;
    let mut solid = Elastic::new(setup).expect("a bar");
    let length = counts[0] as f64 * 0.1;
    for (load, place) in solid.loads_mut().iter_mut().zip(&places) {
        let end = if place[0] < 0.1 { -1.0 } else { f64::from(place[0] > length - 0.1) };
        load[0] = end * stress * 0.1_f64.powi(D as i32 - 1);
    }
    let dt = solid.step_limit().expect("at rest");
    solid.advance(60.0, dt).expect("stable");
    assert!(solid.kinetic_energy() < 1e-10 * solid.elastic_energy());
    let middle: Vec<usize> =
        (0..solid.len()).filter(|&i| (places[i][0] - 0.5 * length).abs() < 0.1).collect();
    let mean = |of: &dyn Fn(usize) -> f64| middle.iter().map(|&i| of(i)).sum::<f64>() / middle.len() as f64;
    (
        mean(&|i| solid.gradient(i)[(0, 0)]),
        mean(&|i| solid.gradient(i)[(1, 1)]),
        mean(&|i| solid.stress(i)[(0, 0)]),
    )
}

#[test]
fn a_plate_in_tension_stretches_as_its_law_says() {
    let (a, b, sigma) = pulled([30, 8], Law::SaintVenantKirchhoff, 0.1);
    // P = a S, S = (a² - 1)/2 E/(1 - ν²), and ν/(1 - ν) of the strain across.
    let modulus = 1.0 / (1.0 - 0.09);
    let exact = root(|a| a * 0.5 * (a * a - 1.0) * modulus - 0.1);
    let across = (1.0 - 0.3 / 0.7 * (exact * exact - 1.0)).sqrt();
    assert!((a / exact - 1.0).abs() < 3e-3 && (b / across - 1.0).abs() < 3e-3);
    assert!((sigma * across / 0.1 - 1.0).abs() < 1e-2);
}

#[test]
fn a_rod_in_tension_stretches_as_its_law_says() {
    let (a, b, sigma) = pulled([20, 5, 5], Law::NeoHookean, 0.1);
    let material = super::material(Law::NeoHookean);
    let (lambda, mu) = (material.bulk - 2.0 / 3.0 * material.shear, material.shear);
    let across = |a: f64| root_in(0.5, 1.0, |b| mu * (b * b - 1.0) + lambda * (a * b * b).ln());
    // P_xx = G (a - 1/a) + λ ln J/a.
    let exact = root(|a| mu * (a - 1.0 / a) + lambda * (a * across(a).powi(2)).ln() / a - 0.1);
    assert!((a / exact - 1.0).abs() < 1e-2 && (b / across(exact) - 1.0).abs() < 1e-2);
    assert!((sigma * across(exact).powi(2) / 0.1 - 1.0).abs() < 2e-2);
}

/// Where a rising function is zero.
fn root_in(mut low: f64, mut high: f64, of: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        (low, high) = if of(middle) < 0.0 { (middle, high) } else { (low, middle) };
    }
    low
}

fn root(of: impl Fn(f64) -> f64) -> f64 {
    root_in(1.0, 2.0, of)
}
