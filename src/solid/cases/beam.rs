//! A beam: the period of the linearised stiffness and that of the motion.

use super::{lattice, period, setup};
use crate::solid::{Elastic, Hold, Law};
use crate::vector::Vector;

/// Lowest angular frequency and its mode, by inverse iteration on the matrix of the linearised forces.
fn lowest(solid: &mut Elastic<2>) -> (f64, Vec<Vector<2>>) {
    let free: Vec<usize> = (0..solid.len()).filter(|&i| matches!(solid.holds[i], Hold::Free)).collect();
    let n = 2 * free.len();
    let mut stiffness = nalgebra::DMatrix::<f64>::zeros(n, n);
    for column in 0..n {
        let mut mode = vec![Vector::zeros(); solid.len()];
        mode[free[column / 2]][column % 2] = 1.0;
        let pull = solid.linear_acceleration(&mode).expect("at rest");
        for row in 0..n {
            stiffness[(row, column)] = -pull[free[row / 2]][row % 2];
        }
    }
    // All masses are equal: what comes of an energy is symmetric, but for the rounding of the differences. Hourglass
    // control does not come of one.
    if solid.options.hourglass == 0.0 {
        assert!((&stiffness - stiffness.transpose()).amax() < 1e-8 * stiffness.amax());
    }
    let solve = stiffness.lu();
    let mut mode = nalgebra::DVector::from_element(n, 1.0);
    let mut square = 0.0;
    // The next mode is 6 times as fast: 36 times less of it is left each round.
    for _ in 0..12 {
        let next = solve.solve(&mode).expect("a clamped beam is stiff");
        square = mode.norm() / next.norm();
        mode = next.normalize();
    }
    let mut all = vec![Vector::zeros(); solid.len()];
    for (k, value) in mode.iter().enumerate() {
        all[free[k / 2]][k % 2] = *value;
    }
    (square.sqrt(), all)
}

fn beam(law: Law, hourglass: f64) -> Elastic<2> {
    let mut setup = setup(lattice([33, 5], 0.2), 0.2, law);
    setup.options.hourglass = hourglass;
    for i in 0..3 * 5 {
        setup.holds[i] = Hold::Clamped;
    }
    Elastic::new(setup).expect("a sound beam")
}

#[test]
fn the_linearised_stiffness_knows_the_period_of_the_motion() {
    for (law, hourglass) in [(Law::SaintVenantKirchhoff, 0.1), (Law::NeoHookean, 0.0)] {
        let mut solid = beam(law, hourglass);
        let (frequency, mode) = lowest(&mut solid);
        // A displacement of 1e-3 of the length: its square is what is left of the nonlinear.
        let largest = mode.iter().map(|u| u.norm()).fold(0.0, f64::max);
        let places = solid.places().to_vec();
        let shape = |x: &Vector<2>| {
            let i = places.iter().position(|p| p == x).expect("one of them");
            mode[i] * (6e-3 * frequency / largest)
        };
        solid.set_velocity(shape);
        let dt = solid.step_limit().expect("at rest");
        // The deflection along the mode.
        let look = |solid: &Elastic<2>| {
            (0..solid.len()).map(|i| (solid.position(i) - solid.places()[i]).dot(&mode[i])).sum()
        };
        let moved = period(&mut solid, dt, 1, look);
        let linear = 2.0 * std::f64::consts::PI / frequency;
        // Steps of a 1e4th of a period lengthen it by 1e-8; the rest is amplitude and rounding of the matrix.
        assert!((moved / linear - 1.0).abs() < 2e-5, "{law:?}: {moved} {linear}");
    }
}

/// Largest relative change of energy over some four periods of a swing of a fifth of the length, in steps of `part` of
/// the longest.
fn drift(part: f64) -> f64 {
    let mut solid = beam(Law::SaintVenantKirchhoff, 0.0);
    solid.set_velocity(|x| Vector::<2>::new(0.0, 6e-3 * (x[0] - 0.6).powi(2)));
    let before = solid.kinetic_energy();
    let dt = part * solid.step_limit().expect("at rest");
    let (mut worst, mut slowest) = (0.0_f64, before);
    while solid.time() < 1000.0 {
        solid.step(dt).expect("stable");
        worst = worst.max(((solid.kinetic_energy() + solid.elastic_energy()) / before - 1.0).abs());
        slowest = slowest.min(solid.kinetic_energy());
    }
    // It did swing: at the turn hardly anything was kinetic.
    assert!(slowest < 0.1 * before, "{}", slowest / before);
    worst
}

#[test]
fn energy_is_kept_over_periods_of_a_large_swing() {
    let (whole, half) = (drift(1.0), drift(0.5));
    // The leapfrog keeps it to (ω dt)² of the modes that are excited: no drift, a quarter with half the step.
    assert!(whole < 6e-4 && half < 0.3 * whole, "{whole} {half}");
}
