//! The updated-Lagrangian form: small swings are those of the total-Lagrangian one; the rate of Jaumann is objective,
//! but not with the gradient as printed at edges.

use super::{lattice, setup};
use crate::solid::{Elastic, Form, Hold, Jaumann, Law};
use crate::space::matrix::Matrix;
use crate::vector::Vector;

/// Angular velocity, 1/s.
const SPIN: f64 = 1.0;

fn rod(corrected: bool) -> Jaumann<2> {
    let mut setup = setup(lattice([20, 5], 0.1), 0.1, Law::SaintVenantKirchhoff);
    // Pulled at its ends by nothing but its turn: stresses of ρ (Ω L)²/8 < 1e-2.
    setup.options.courant = 0.5;
    Jaumann::new(setup, Form { artificial_stress: 0.0, artificial_viscosity: 0.0, corrected }).expect("a rod")
}

/// Largest stress and where the rod has turned to, after a quarter of a turn about its middle.
fn turned(corrected: bool, stress: Option<Matrix<2>>) -> (Jaumann<2>, f64) {
    let mut solid = rod(corrected);
    let middle = Vector::<2>::new(1.0, 0.25);
    let quarter = 0.5 * std::f64::consts::PI / SPIN;
    let steps = 2_000;
    let dt = quarter / f64::from(steps);
    for i in 0..solid.len() {
        if let Some(stress) = stress {
            solid.set_stress(i, &stress);
        }
        // Each particle is led round the middle: no force moves it.
        solid.holds[i] = Hold::Driven(std::sync::Arc::new(move |x, t: f64| {
            let (sin, cos) = (SPIN * t).sin_cos();
            let away = x - middle;
            Matrix::<2>::new(cos, -sin, sin, cos) * away - away
        }));
    }
    for _ in 0..steps {
        solid.step(dt).expect("stable");
    }
    let largest =
        (0..solid.len()).map(|i| solid.stress(i).fixed_view::<2, 2>(0, 0).norm()).fold(0.0, f64::max);
    (solid, largest)
}

#[test]
fn a_rigid_turn_leaves_a_rod_without_stress() {
    // Corrected gradients see no strain in chords of a circle, of any length: rounding only.
    let (_, stress) = turned(true, None);
    assert!(stress < 1e-12, "{stress}");
    // As printed edges and corners strain: they gain a stress of some per cent of the modulus in a quarter turn.
    let (_, printed) = turned(false, None);
    assert!(printed > 1e-3, "{printed}");
}

#[test]
fn a_rigid_turn_turns_the_stress() {
    let stress = Matrix::<2>::new(0.03, 0.01, 0.01, -0.02);
    let (solid, _) = turned(true, Some(stress));
    let quarter = Matrix::<2>::new(0.0, -1.0, 1.0, 0.0);
    let exact = quarter * stress * quarter.transpose();
    for i in 0..solid.len() {
        let now = solid.stress(i);
        // 2000 turns, each exact for the angle its chords have; their sum lacks (Ω dt)²/12 of the angle.
        assert!((now.fixed_view::<2, 2>(0, 0) - exact).norm() < 1e-7 * stress.norm().max(1.0));
        assert!(
            (solid.position(i) - Vector::<2>::new(1.25 - solid.places()[i][1], solid.places()[i][0] - 0.75))
                .norm()
                < 1e-9
        );
    }
    // With the stress along z of plane strain: ν (σ_xx + σ_yy).
    assert!((solid.stress(0)[(2, 2)] - 0.3 * 0.01).abs() < 1e-12);
}

#[test]
fn small_swings_are_those_of_the_total_lagrangian_form() {
    let mut setup = setup(lattice([33, 5], 0.2), 0.2, Law::SaintVenantKirchhoff);
    setup.options.hourglass = 0.0;
    setup.holds[..15].fill(Hold::Clamped);
    let push = |x: &Vector<2>| Vector::<2>::new(0.0, 1e-6 * (x[0] - 0.6).powi(2));
    let mut total = Elastic::new(setup.clone()).expect("a beam");
    let form = Form { artificial_stress: 0.0, artificial_viscosity: 0.0, corrected: true };
    let mut updated = Jaumann::new(setup, form).expect("a beam");
    total.set_velocity(push);
    updated.set_velocity(push);
    let (dt, mut largest, mut apart) = (0.5 * updated.step_limit(), 0.0_f64, 0.0_f64);
    let (mut stress, mut strain) = ([0.0_f64; 2], [0.0_f64; 2]);
    // About a quarter of a period.
    for _ in 0..1000 {
        total.step(dt).expect("stable");
        updated.step(dt).expect("stable");
        for i in 0..total.len() {
            largest = largest.max((total.position(i) - total.places()[i]).norm());
            apart = apart.max((total.position(i) - updated.position(i)).norm());
            let most = |of: &mut [f64; 2], size: f64, off: f64| *of = [of[0].max(size), of[1].max(off)];
            let (sigma, f) = (total.stress(i), total.gradient(i) - Matrix::identity());
            most(&mut stress, sigma.norm(), (sigma - updated.stress(i)).norm());
            most(&mut strain, f.norm(), (total.gradient(i) - updated.gradient(i)).norm());
        }
    }
    // They part with the square of the displacement.
    assert!(apart < 1e-4 * largest, "{apart} of {largest}");
    // Stress and deformation half a step before, at the middle of which the gradient of the velocity is taken.
    assert!(stress[1] < 1e-3 * stress[0] && strain[1] < 1e-3 * strain[0], "{stress:?} {strain:?}");
    let energy = |kinetic: f64, elastic: f64| kinetic + elastic;
    let (a, b) = (
        energy(total.kinetic_energy(), total.elastic_energy()),
        energy(updated.kinetic_energy(), updated.elastic_energy()),
    );
    assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
}

#[test]
fn momentum_is_conserved_as_printed_and_corrected() {
    for form in [Form::printed(), Form::default()] {
        let mut places = lattice([9, 8], 0.1);
        places.iter_mut().enumerate().for_each(|(i, x)| x[0] += 0.01 * super::any(i));
        let mut solid = Jaumann::new(setup(places, 0.1, Law::NeoHookean), form).expect("a sheet");
        solid.set_velocity(|x| Vector::<2>::new(0.01 * (7.0 * x[1]).sin(), 0.02 * (5.0 * x[0]).cos()));
        let (before, size) = (solid.momentum(), solid.mass(0) * 72.0 * 0.01);
        let dt = solid.step_limit();
        for _ in 0..200 {
            solid.step(dt).expect("stable");
        }
        // Rounding of 200 sums.
        assert!((solid.momentum() - before).norm() < 1e-13 * size);
    }
}
