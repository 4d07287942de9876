//! Linear displacements of a disordered cloud: gradient, stress and energy are exact.

use super::{any, lattice, setup};
use crate::solid::{Elastic, Hold, Law, Material};
use crate::space::matrix::{Matrix, determinant};
use crate::vector::Vector;

/// Relative rounding of sums over some ten neighbours.
const ROUNDING: f64 = 1e-12;

fn cloud<const D: usize>(counts: [usize; D], law: Law) -> Elastic<D> {
    let mut places = lattice(counts, 0.1);
    for (i, place) in places.iter_mut().enumerate() {
        *place += Vector::from_fn(|k, _| 0.02 * any(D * i + k));
    }
    Elastic::new(setup(places, 0.1, law)).expect("spanned by neighbours")
}

/// Displaces linearly and returns the stress, which must be the same everywhere; 3 x 3, Cauchy.
fn stressed<const D: usize>(solid: &mut Elastic<D>, f: &Matrix<D>) -> nalgebra::Matrix3<f64> {
    solid.displace(|x| f * x - x).expect("not inverted");
    let stress = solid.stress(0);
    for i in 0..solid.len() {
        assert!((solid.gradient(i) - f).norm() < ROUNDING);
        assert!((solid.stress(i) - stress).norm() < ROUNDING);
        assert!((solid.volume(i) / solid.volumes[i] - determinant(f)).abs() < ROUNDING);
    }
    stress
}

/// λ and G.
fn lame(material: &Material) -> (f64, f64) {
    (material.bulk - 2.0 / 3.0 * material.shear, material.shear)
}

#[test]
fn simple_shear_is_exact() {
    let g = 0.4;
    let shear = Matrix::<2>::new(1.0, g, 0.0, 1.0);
    let mut solid = cloud([14, 9], Law::NeoHookean);
    let (_, mu) = lame(&solid.material);
    // σ = G (F Fᵀ - 1) at constant volume.
    let stress = stressed(&mut solid, &shear);
    let exact = nalgebra::Matrix3::new(g * g, g, 0.0, g, 0.0, 0.0, 0.0, 0.0, 0.0) * mu;
    assert!((stress - exact).norm() < ROUNDING);
    let energy = 0.5 * mu * g * g * solid.volumes.iter().sum::<f64>();
    assert!((solid.elastic_energy() / energy - 1.0).abs() < ROUNDING);

    let mut solid = cloud([14, 9], Law::SaintVenantKirchhoff);
    let (lambda, mu) = lame(&solid.material);
    let stress = stressed(&mut solid, &shear);
    // S = λ γ²/2 1 + G (0, γ; γ, γ²), σ = F S Fᵀ, out of the plane λ γ²/2.
    let across = (0.5 * lambda + mu) * g * g;
    let along = mu * g + g * across;
    let xx = 0.5 * lambda * g * g + 2.0 * mu * g * g + g * g * across;
    let exact = nalgebra::Matrix3::new(xx, along, 0.0, along, across, 0.0, 0.0, 0.0, 0.5 * lambda * g * g);
    assert!((stress - exact).norm() < ROUNDING);
}

#[test]
fn uniform_tension_is_exact() {
    let a = 1.3_f64;
    // Saint Venant-Kirchhoff, free across: E_yy = -λ/(λ + 2 G) E_xx.
    let mut solid = cloud([14, 9], Law::SaintVenantKirchhoff);
    let (lambda, mu) = lame(&solid.material);
    let b = (1.0 - lambda / (lambda + 2.0 * mu) * (a * a - 1.0)).sqrt();
    let stress = stressed(&mut solid, &Matrix::<2>::new(a, 0.0, 0.0, b));
    let along = a / b * 0.5 * (a * a - 1.0) * 4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu);
    assert!((stress[(0, 0)] - along).abs() < ROUNDING && stress[(1, 1)].abs() < ROUNDING);

    // Neo-Hookean in space, free across: G (b² - 1) + λ ln(a b²) = 0.
    let mut solid = cloud([7, 6, 6], Law::NeoHookean);
    let (mut low, mut high) = (0.5, 1.0);
    for _ in 0..60 {
        let b: f64 = 0.5 * (low + high);
        let across = mu * (b * b - 1.0) + lambda * (a * b * b).ln();
        (low, high) = if across < 0.0 { (b, high) } else { (low, b) };
    }
    let stress = stressed(&mut solid, &Matrix::<3>::from_diagonal(&[a, low, low].into()));
    let along = mu * (a * a - low * low) / (a * low * low);
    assert!((stress[(0, 0)] - along).abs() < ROUNDING);
    assert!(stress[(1, 1)].abs() < ROUNDING && stress[(2, 2)].abs() < ROUNDING);
}

#[test]
fn a_rigid_turn_stresses_nothing() {
    let (sin, cos) = 1.1_f64.sin_cos();
    for law in [Law::SaintVenantKirchhoff, Law::NeoHookean] {
        let mut solid = cloud([14, 9], law);
        let stress = stressed(&mut solid, &Matrix::<2>::new(cos, -sin, sin, cos));
        assert!(stress.norm() < ROUNDING && solid.elastic_energy() < ROUNDING);
        assert!(solid.forces.iter().all(|f| f.norm() < ROUNDING));
    }
}

/// The rim of a square is driven linearly: what is inside comes to rest linearly too.
#[test]
fn a_square_follows_its_rim() {
    let target = Matrix::<2>::new(1.08, 0.12, -0.05, 0.96);
    for law in [Law::SaintVenantKirchhoff, Law::NeoHookean] {
        let n = 12;
        let mut setup = setup(lattice([n, n], 0.1), 0.1, law);
        for (i, hold) in setup.holds.iter_mut().enumerate() {
            let rim = |k: usize| k < 2 || k >= n - 2;
            if rim(i / n) || rim(i % n) {
                *hold = Hold::Driven(std::sync::Arc::new(move |x, t: f64| (target * x - x) * t.min(1.0)));
            }
        }
        setup.options.drag = 4.0;
        let mut solid = Elastic::new(setup).expect("a square");
        let dt = 0.5 * solid.step_limit().expect("at rest");
        solid.advance(12.0, dt).expect("stable");
        let far = (0..solid.len())
            .map(|i| (solid.position(i) - target * solid.places()[i]).norm())
            .fold(0.0, f64::max);
        // What eleven time units of drag leave of a spacing.
        assert!(far < 1e-9, "{far}");
    }
}
