//! How deep a solid particle lies behind the surface that the fluid sees, and how that surface is bent.
//!
//! A wall may be made of several bodies that lie against each other: then the surface of the particle's own body may be
//! covered by another one. With the depth behind that surface a cell of a ring and a disc in it, 6 spacings across, let
//! the fluid pass with 0.1 of its speed one spacing away.

use crate::fluid::motion::Motion;
use crate::fluid::setup::{BodyKind, Setup, Surface};
use crate::space::domain::Domain;
use crate::vector::Vector;

/// Where a solid particle lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover {
    /// Way to the nearest surface, m; zero where that is not known.
    pub depth: f64,
    /// Divergence of the normal out of the solid there, 1/m: (D - 1)/R of a ball; at most one over the cut-off.
    pub curvature: f64,
}

/// The bodies that stay together with one of them, as one solid.
struct Solid<'a, const D: usize> {
    /// Its own first.
    surfaces: Vec<&'a Surface<D>>,
    domain: &'a Domain<D>,
    spacing: f64,
    cutoff: f64,
}

/// The [`Cover`] of every particle of a setup at t = 0; of fluid zeros.
#[must_use]
pub fn covers<const D: usize>(setup: &Setup<D>) -> Vec<Cover> {
    let solids: Vec<Option<Solid<D>>> =
        (0..setup.bodies.len()).map(|body| Solid::around(setup, body)).collect();
    setup
        .particles
        .iter()
        .map(|placed| {
            let none = Cover { depth: 0.0, curvature: 0.0 };
            solids[usize::from(placed.body)].as_ref().map_or(none, |solid| solid.cover(&placed.position))
        })
        .collect()
}

/// Whether two bodies move alike, so that what the fluid sees is the surface of both. Elastic ones are clamped where they
/// touch still ones; a belt keeps its place, but its surface has a velocity of its own.
fn stay_together<const D: usize>(one: &Motion<D>, other: &Motion<D>) -> bool {
    let rests = |motion: &Motion<D>| matches!(motion, Motion::Still | Motion::Elastic(_));
    match (one, other) {
        (Motion::Free(_), _) | (_, Motion::Free(_)) => false,
        _ => (rests(one) && rests(other)) || one == other,
    }
}

impl<'a, const D: usize> Solid<'a, D> {
    fn around(setup: &'a Setup<D>, body: usize) -> Option<Solid<'a, D>> {
        let of = |body: usize| match &setup.bodies[body].kind {
            BodyKind::Solid { motion, surface: Some(surface), .. } => Some((motion, surface)),
            _ => None,
        };
        let (motion, surface) = of(body)?;
        let others = (0..setup.bodies.len()).filter(|&other| other != body).filter_map(of);
        let with = others.filter(|(its, _)| stay_together(motion, its)).map(|(_, surface)| surface);
        Some(Solid {
            surfaces: std::iter::once(surface).chain(with).collect(),
            domain: &setup.domain,
            spacing: setup.spacing,
            cutoff: setup.cutoff,
        })
    }

    fn cover(&self, place: &Vector<D>) -> Cover {
        let own = -self.surfaces[0](place);
        if own <= 0.0 {
            return Cover { depth: own, curvature: 0.0 };
        }
        let out = normal(&|x| self.surfaces[0](x), place, 1e-4 * self.spacing);
        let (depth, out) = match self.covered(&(place + out * (own + 1e-3 * self.spacing))) {
            false => (own, out),
            true => self.way_out(place).unwrap_or((own, out)),
        };
        Cover { depth, curvature: self.curvature(&(place + out * depth)) }
    }

    /// How deep (m) a place is at least inside; negative outside.
    fn inside(&self, place: &Vector<D>) -> f64 {
        let place = self.domain.wrap(place);
        self.surfaces.iter().map(|surface| -surface(&place)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn covered(&self, place: &Vector<D>) -> bool {
        self.inside(place) > 0.0
    }

    /// The shortest way out (m) and its direction, if it is shorter than two cut-offs: the best of many directions, then
    /// along the normal where it comes out.
    fn way_out(&self, place: &Vector<D>) -> Option<(f64, Vector<D>)> {
        let mut best: Option<(f64, Vector<D>)> = None;
        let mut consider = |direction: &Vector<D>| {
            let found = self.march(place, direction);
            if let Some(depth) = found
                && best.is_none_or(|(least, _)| depth < least)
            {
                best = Some((depth, *direction));
            }
        };
        // The directions to the cells around a cell, four deep.
        const REACH: usize = 4;
        let side = 2 * REACH + 1;
        for index in 0..side.pow(D as u32) {
            let cell = Vector::<D>::from_fn(|k, _| (index / side.pow(k as u32) % side) as f64 - REACH as f64);
            if cell.norm() > 0.0 {
                consider(&cell.normalize());
            }
        }
        for _ in 0..4 {
            let (depth, direction) = best?;
            let out = normal(&|x| -self.inside(x), &(place + direction * depth), 1e-3 * self.spacing);
            if let Some(along) = self.march(place, &out)
                && along < depth
            {
                best = Some((along, out));
            }
        }
        best
    }

    /// Way out along a direction, m.
    fn march(&self, place: &Vector<D>, direction: &Vector<D>) -> Option<f64> {
        // A step over every face between two bodies.
        let over = 1e-3 * self.spacing;
        let mut way = 0.0;
        while way < 2.0 * self.cutoff {
            let inside = self.inside(&(place + direction * way));
            if inside <= 0.0 {
                return Some(way + inside);
            }
            way += inside + over;
        }
        None
    }

    /// Divergence of the normal at a place of the surface, by difference quotients; limited, since what is bent more is an edge.
    fn curvature(&self, place: &Vector<D>) -> f64 {
        let (step, fine) = (0.05 * self.spacing, 1e-3 * self.spacing);
        let distance = |x: &Vector<D>| -self.inside(x);
        let divergence: f64 = (0..D)
            .map(|k| {
                let (mut low, mut high) = (*place, *place);
                low[k] -= step;
                high[k] += step;
                (normal(&distance, &high, fine)[k] - normal(&distance, &low, fine)[k]) / (2.0 * step)
            })
            .sum();
        // What rounding makes of a plane is none.
        if divergence.abs() * self.cutoff < 1e-6 {
            0.0
        } else {
            divergence.clamp(-1.0 / self.cutoff, 1.0 / self.cutoff)
        }
    }
}

/// Direction in which a distance grows, by difference quotients of `step` (m); none where it has none.
fn normal<const D: usize>(distance: &impl Fn(&Vector<D>) -> f64, place: &Vector<D>, step: f64) -> Vector<D> {
    let gradient = Vector::<D>::from_fn(|k, _| {
        let (mut low, mut high) = (*place, *place);
        low[k] -= step;
        high[k] += step;
        distance(&high) - distance(&low)
    });
    gradient.try_normalize(0.0).unwrap_or_else(Vector::zeros)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    type V = Vector<2>;

    fn solid<'a>(surfaces: Vec<&'a Surface<2>>, domain: &'a Domain<2>) -> Solid<'a, 2> {
        Solid { surfaces, domain, spacing: 1.0, cutoff: 3.0 }
    }

    #[test]
    fn a_disc_in_a_ring_lies_behind_the_rings_outer_face() {
        let domain = Domain { min: V::zeros(), max: V::new(20.0, 20.0), periodic: [true, false] };
        let centre = V::new(10.0, 10.0);
        let disc: Surface<2> = Arc::new(move |x: &V| (x - centre).norm() - 2.5);
        let ring: Surface<2> = Arc::new(move |x: &V| ((x - centre).norm() - 4.0).abs() - 1.5);
        // Of the disc first, of the ring first; both are R = 5.5 together.
        for (own, other, radius) in [(&disc, &ring, 1.3), (&ring, &disc, 2.9), (&ring, &disc, 5.2)] {
            for angle in [0.1_f64, 1.3, 2.9, 4.4] {
                let place = centre + V::new(angle.cos(), angle.sin()) * radius;
                let cover = solid(vec![own, other], &domain).cover(&place);
                // The way out is along the normal after four corrections; a step over a face is 1e-3.
                assert!((cover.depth - (5.5 - radius)).abs() < 2e-3, "{radius}: {cover:?}");
                assert!((cover.curvature * 5.5 - 1.0).abs() < 1e-2, "{radius}: {cover:?}");
            }
        }
        // Alone the ring has an inner face too.
        let cover = solid(vec![&ring], &domain).cover(&(centre + V::new(2.9, 0.0)));
        assert!(
            (cover.depth - 0.4).abs() < 1e-12 && (cover.curvature + 1.0 / 3.0).abs() < 1e-12,
            "{cover:?}"
        );
    }

    #[test]
    fn a_plane_is_not_bent_and_a_corner_lies_behind_both_walls() {
        let domain = Domain { min: V::zeros(), max: V::new(20.0, 20.0), periodic: [false; 2] };
        let floor: Surface<2> = Arc::new(|x: &V| x[1]);
        let side: Surface<2> = Arc::new(|x: &V| x[0]);
        let both = solid(vec![&floor, &side], &domain);
        assert_eq!(both.cover(&V::new(7.0, -1.5)), Cover { depth: 1.5, curvature: 0.0 });
        let corner = both.cover(&V::new(-1.5, -0.5));
        assert!((corner.depth - 2.5_f64.sqrt()).abs() < 5e-3, "{corner:?}");
        assert!(corner.curvature.abs() <= 1.0 / 3.0);
        // Fluid has no depth.
        assert!(both.cover(&V::new(1.0, 1.0)).depth < 0.0);
    }
}
