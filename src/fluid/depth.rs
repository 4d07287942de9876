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

/// Whether two bodies keep their place relative to each other. Elastic ones are clamped where they touch still ones.
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
            let cell =
                Vector::<D>::from_fn(|k, _| (index / side.pow(k as u32) % side) as f64 - REACH as f64);
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
