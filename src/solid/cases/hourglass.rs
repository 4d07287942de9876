//! Hourglass control, momentum, drag and viscosity.

use super::{any, lattice, setup};
use crate::solid::{Elastic, Law};
use crate::space::Kernel;
use crate::space::KernelKind;
use crate::vector::Vector;

/// A cloud off its lattice, displaced at random by up to a tenth of a spacing.
fn shaken<const D: usize>(counts: [usize; D], hourglass: f64) -> Elastic<D> {
    let mut places = lattice(counts, 0.1);
    for (i, place) in places.iter_mut().enumerate() {
        *place += Vector::from_fn(|k, _| 0.02 * any(D * i + k));
    }
    let mut setup = setup(places, 0.1, Law::NeoHookean);
    setup.options.hourglass = hourglass;
    setup.options.viscosity = 0.3;
    let mut solid = Elastic::new(setup).expect("spanned by neighbours");
    let places = solid.places().to_vec();
    let key = |x: &Vector<D>| places.iter().position(|p| p == x).expect("one of them") * D + 7_000_000;
    solid.set_velocity(|x| Vector::from_fn(|k, _| 0.1 * any(key(x) + k + 1_000_000)));
    solid.displace(|x| Vector::from_fn(|k, _| 0.01 * any(key(x) + k))).expect("not inverted");
    solid
}

fn momenta<const D: usize>(counts: [usize; D]) {
    let solid = shaken(counts, 0.1);
    let size: f64 = solid.forces.iter().map(|f| f.norm()).sum();
    let force = solid.forces.iter().fold(Vector::<D>::zeros(), |sum, f| sum + f);
    // Rounding: forces of a pair are equal and opposite.
    assert!(force.norm() < 1e-14 * size, "{} of {size}", force.norm());
    for a in 0..D {
        for b in 0..a {
            let turn: f64 = (0..solid.len())
                .map(|i| {
                    let (x, f) = (solid.position(i), solid.forces[i]);
                    x[a] * f[b] - x[b] * f[a]
                })
                .sum();
            // Σ torques = Σ V (P Fᵀ - F Pᵀ), and P Fᵀ is symmetric; the control pulls along the line of a pair.
            assert!(turn.abs() < 1e-13 * size, "{turn} of {size}");
        }
    }
}

#[test]
fn forces_conserve_momentum_and_angular_momentum() {
    momenta([9, 8]);
    momenta([5, 6, 4]);
}

/// Periodic square of lattice points.
fn square(hourglass: f64) -> Elastic<2> {
    let mut setup = setup(lattice([8, 8], 0.1), 0.1, Law::SaintVenantKirchhoff);
    setup.domain.min = Vector::<2>::zeros();
    setup.domain.max = Vector::<2>::new(0.8, 0.8);
    setup.domain.periodic = [true; 2];
    setup.options.hourglass = hourglass;
    Elastic::new(setup).expect("a square")
}

#[test]
fn a_checkerboard_is_free_without_control_and_costs_with_it() {
    let board = |x: &Vector<2>| {
        let black = ((x[0] + x[1]) / 0.1).round() as i64 % 2 == 0;
        Vector::<2>::new(if black { 1e-3 } else { -1e-3 }, 0.0)
    };
    let work = |hourglass: f64| {
        let mut solid = square(hourglass);
        solid.displace(board).expect("not inverted");
        assert!((0..solid.len()).all(|i| (solid.gradient(i) - nalgebra::Matrix2::identity()).norm() < 1e-13));
        (0..solid.len()).map(|i| solid.forces[i].dot(&board(&solid.places()[i]))).sum::<f64>()
    };
    assert!(work(0.0).abs() < 1e-18);
    // Linear in its strength, and against the displacement.
    let (some, more) = (work(0.1), work(0.2));
    assert!(some < 0.0 && (more / some - 2.0).abs() < 1e-9, "{some} {more}");
}

#[test]
fn hourglass_control_lets_every_linear_displacement_pass() {
    let slope = nalgebra::Matrix2::new(0.1, -0.3, 0.2, -0.05);
    let forces = |hourglass: f64| {
        let mut solid = shaken([9, 8], hourglass);
        solid.velocities.fill(Vector::zeros());
        solid.displace(|x| slope * x).expect("not inverted");
        solid.forces.clone()
    };
    let (without, with) = (forces(0.0), forces(5.0));
    let size: f64 = without.iter().map(|f| f.norm()).sum();
    assert!(without.iter().zip(&with).all(|(a, b)| (a - b).norm() < 1e-13 * size));
}

#[test]
fn drag_is_exact() {
    let mut setup = setup(lattice([6, 5], 0.1), 0.1, Law::NeoHookean);
    setup.options.drag = 3.0;
    let mut solid = Elastic::new(setup).expect("a sheet");
    solid.set_velocity(|_| Vector::<2>::new(0.2, -0.1));
    solid.advance(0.7, 0.05).expect("stable");
    // A body that moves as a whole feels nothing else.
    let left = solid.velocities()[7] / (-3.0_f64 * 0.7).exp();
    assert!((left - Vector::<2>::new(0.2, -0.1)).norm() < 1e-13);
}

/// Of a plane wave on a lattice viscosity takes γ = (η/ρ) Σ_j V (W0/R²) (1 - cos k·X) cos² of the angle to the motion.
#[test]
fn viscosity_damps_a_wave_at_its_rate() {
    let wave = 2.0 * std::f64::consts::PI / 0.8;
    let mut setup = setup(lattice([8, 8], 0.1), 0.1, Law::SaintVenantKirchhoff);
    setup.domain.min = Vector::<2>::zeros();
    setup.domain.max = Vector::<2>::new(0.8, 0.8);
    setup.domain.periodic = [true; 2];
    // So soft that nothing swings.
    (setup.material.bulk, setup.material.shear) = (1e-12, 1e-12);
    setup.options.hourglass = 0.0;
    setup.options.viscosity = 0.02;
    let kernel = Kernel::<2>::new(KernelKind::Lucy, setup.cutoff);
    let mut rate = 0.0;
    for a in -1..=1 {
        for b in -1..=1 {
            let x = Vector::<2>::new(0.1 * f64::from(a), 0.1 * f64::from(b));
            let r2 = x.norm_squared();
            if r2 > 0.0 {
                let part = 0.01 * kernel.value(r2.sqrt()) / r2 * (x[1] * x[1] / r2);
                rate += 0.02 * part * (1.0 - (wave * x[0]).cos());
            }
        }
    }
    let mut solid = Elastic::new(setup).expect("a square");
    let shape = |x: &Vector<2>| (wave * x[0]).sin();
    solid.set_velocity(|x| Vector::<2>::new(0.0, 1e-6 * shape(x)));
    let (time, dt) = (1.0 / rate, 1e-4 / rate);
    solid.advance(time, dt).expect("stable");
    let left: f64 = (0..solid.len())
        .map(|i| solid.velocities()[i][1] * shape(&solid.places()[i]) / (0.5 * solid.len() as f64))
        .sum();
    // Half a step's lag of the velocity in the force.
    assert!((-(left / 1e-6).ln() - 1.0).abs() < 2e-4, "{left}");
}
