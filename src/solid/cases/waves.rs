//! Bars that vibrate along their length.

use super::{lattice, period, setup};
use crate::solid::{Elastic, Hold, Law};
use crate::vector::Vector;
use std::f64::consts::PI;

/// What a bar of length one is like.
#[derive(Clone, Copy)]
struct Bar {
    /// Particles along it.
    count: usize,
    /// Without free sides, so that c² = (K + 4 G/3)/ρ; else of height 1/10 in plane strain, c² = E/((1 - ν²) ρ).
    wide: bool,
    /// Its left end; the right one is free.
    clamped: bool,
    /// Half waves: odd halves of them with a clamp.
    mode: f64,
}

impl Bar {
    /// Length of a bar that had the frequency mode/2 c/L, less one.
    fn excess(self) -> f64 {
        let spacing = 1.0 / self.count as f64;
        let rows = if self.wide { 4 } else { self.count / 10 };
        let behind = if self.clamped { 3 } else { 0 };
        let mut places = lattice([self.count + behind, rows], spacing);
        places.iter_mut().for_each(|x| x[0] -= behind as f64 * spacing);
        let mut setup = setup(places, spacing, Law::SaintVenantKirchhoff);
        if self.wide {
            (setup.domain.min[1], setup.domain.max[1]) = (0.0, rows as f64 * spacing);
            setup.domain.periodic[1] = true;
        }
        for (hold, place) in setup.holds.iter_mut().zip(&setup.places) {
            if place[0] < 0.0 {
                *hold = Hold::Clamped;
            }
        }
        let material = setup.material;
        let square = match self.wide {
            true => material.bulk + 4.0 / 3.0 * material.shear,
            false => material.young() / (1.0 - material.poisson().powi(2)),
        };
        let mut solid = Elastic::new(setup).expect("a bar");
        let along = |x: f64| match self.clamped {
            true => (self.mode * PI * x).sin(),
            false => (self.mode * PI * x).cos(),
        };
        solid.set_velocity(|x| Vector::<2>::new(1e-5 * along(x[0]), 0.0));
        let dt = 0.5 * solid.step_limit().expect("at rest");
        let look = |solid: &Elastic<2>| {
            let moved = |i: usize| (solid.position(i) - solid.places()[i])[0];
            (0..solid.len()).map(|i| moved(i) * along(solid.places()[i][0])).sum()
        };
        0.5 * self.mode * square.sqrt() * period(&mut solid, dt, 1, look) - 1.0
    }
}

#[test]
fn a_free_bar_vibrates_at_its_frequencies() {
    for (wide, mode) in [(true, 1.0), (true, 2.0), (false, 1.0)] {
        let bar = |count| Bar { count, wide, clamped: false, mode }.excess();
        let (coarse, fine) = (bar(20), bar(40));
        assert!(fine.abs() < 0.005 && fine.abs() < 0.6 * coarse.abs(), "{mode}: {coarse} {fine}");
    }
}

/// A clamp acts about a spacing behind its face: what is clamped shares the strain of its neighbours. First order.
#[test]
fn a_clamped_bar_vibrates_at_its_frequencies() {
    for (wide, mode) in [(true, 0.5), (true, 1.5), (false, 0.5)] {
        let bar = |count: usize| Bar { count, wide, clamped: true, mode }.excess();
        let (coarse, fine) = (bar(40), bar(80));
        assert!((0.4..1.1).contains(&(coarse * 40.0)) && (0.4..1.1).contains(&(fine * 80.0)));
        // Without what is first order in the spacing.
        assert!((2.0 * fine - coarse).abs() < 2e-3, "{mode}: {coarse} {fine}");
    }
}
