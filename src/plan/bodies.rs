//! How the solids of a model move, and what of it cannot be.

use super::ParticlePlan;
use super::particles::narrow;
use crate::error::Fault;
use crate::fluid::{Deformation, Domain, Free, Motion};
use crate::geometry::shape::embed;
use crate::model::conditions::{Condition, WallMotion, WallName, What};
use crate::model::names::axis_name;
use crate::model::{Boundary, ParticleDomain};
use crate::quantity::readable::show_vector;
use crate::vector::Vector;
use std::sync::Arc;

/// Step of the difference quotients in time of a displacement, in h/U: of what swings with an amplitude of h/1000 at the
/// speed U the acceleration is right to 3e-5, and of what is slow rounding leaves 1e-6.
const INSTANT: f64 = 5e-5;
/// Step of those in space, in spacings.
const NEARBY: f64 = 1e-3;

/// The motion of a wall as its conditions say.
pub(super) fn motion<const D: usize>(domain: &ParticleDomain, wall: WallName) -> Motion<D> {
    match domain.conditions.iter().find(|condition| moves(condition, wall)).map(|condition| &condition.what) {
        Some(What::FreeBody { body, .. }) => Free {
            density: body.density,
            velocity: narrow(&body.velocity),
            rate: body.rate.into(),
            acceleration: narrow(&body.acceleration),
        }
        .motion(),
        Some(What::MovingWall { motion, .. }) => prescribed(domain, motion),
        _ => Motion::Still,
    }
}

fn prescribed<const D: usize>(domain: &ParticleDomain, motion: &WallMotion) -> Motion<D> {
    match motion {
        WallMotion::Belt(velocity) => Motion::Belt { velocity: narrow(velocity) },
        WallMotion::Travel(velocity) => Motion::Translating { velocity: narrow(velocity) },
        WallMotion::Oscillate { velocity, frequency } => {
            Motion::Oscillating { amplitude: narrow(velocity), frequency: std::f64::consts::TAU * frequency }
        }
        WallMotion::Rotate { centre, rate, axis } => {
            let periodic = std::array::from_fn(|k| domain.boundaries[k] == Boundary::Periodic);
            let ends = Domain { min: narrow(&domain.min), max: narrow(&domain.max), periodic };
            Motion::Rotating { centre: narrow(centre), rate: (axis * *rate).into(), domain: Some(ends) }
        }
        WallMotion::Deform(field) => {
            let field = field.clone();
            let speed = domain.fluid.as_ref().map_or(1.0, |fluid| fluid.speed);
            Motion::Deforming(Deformation {
                displacement: Arc::new(move |x: &Vector<D>, t: f64| narrow(&field.at(&embed(x), t))),
                instant: INSTANT * domain.support * domain.spacing / speed,
                nearby: NEARBY * domain.spacing,
            })
        }
    }
}

/// Whether a condition says how a wall moves.
fn moves(condition: &Condition, wall: WallName) -> bool {
    match &condition.what {
        What::MovingWall { wall: named, .. } => *named == wall,
        What::FreeBody { group, .. } => WallName::Group(*group) == wall,
        _ => false,
    }
}

/// Walls told to move twice, free bodies at a wall, displacements that do not begin at zero.
pub(super) fn check<const D: usize>(
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
    faults: &mut Vec<Fault>,
) {
    for (k, condition) in domain.conditions.iter().enumerate() {
        let wall = match &condition.what {
            What::MovingWall { wall, .. } => *wall,
            What::FreeBody { group, .. } => WallName::Group(*group),
            _ => continue,
        };
        if let Some(other) = domain.conditions[..k].iter().find(|other| moves(other, wall)) {
            faults.push(Fault::at(
                &condition.place,
                format!("`{}` already says how this wall moves", other.name),
                "remove one of the two",
            ));
        }
        let WallName::Group(g) = wall else { continue };
        let slides = matches!(&condition.what, What::MovingWall { motion: WallMotion::Belt(_), .. });
        if let Some(k) = domain.groups[g].crosses.filter(|_| !slides) {
            faults.push(Fault::at(
                &condition.place,
                format!(
                    "`{}` moves and reaches a periodic side along {} at the start",
                    domain.groups[g].name,
                    axis_name(k)
                ),
                "put it inside the box at the start; it may cross the side later",
            ));
        }
        let own = || plan.particles.iter().zip(&plan.home).filter(|(_, home)| usize::from(**home) == g);
        if matches!(condition.what, What::FreeBody { .. }) {
            at_a_side(domain, plan, (condition, g), own().map(|(placed, _)| placed.position), faults);
        }
        if let What::MovingWall { motion: WallMotion::Deform(field), .. } = &condition.what {
            let astray =
                own().map(|(placed, _)| embed(&placed.position)).find(|x| field.at(x, 0.0).norm() != 0.0);
            if let Some(x) = astray {
                let u = field.at(&x, 0.0);
                faults.push(Fault::at(
                    &condition.place,
                    format!(
                        "the displacement of `{}` is {:.3e} m at t = 0 at {}, or no number",
                        domain.groups[g].name,
                        u.norm(),
                        show_vector(x.as_slice(), "m")
                    ),
                    "it is relative to the shape of the group: let it begin at zero, e.g. times (1 - exp(-t / (1 ms)))",
                ));
            }
        }
    }
}

/// A free body needs a layer of fluid between itself and every wall of the box.
fn at_a_side<const D: usize>(
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
    (condition, g): (&Condition, usize),
    places: impl Iterator<Item = Vector<D>>,
    faults: &mut Vec<Fault>,
) {
    let least = 0.999 * domain.spacing;
    for x in places {
        for k in (0..D).filter(|&k| domain.boundaries[k] != Boundary::Periodic) {
            let gap = (x[k] - plan.domain.min[k]).min(plan.domain.max[k] - x[k]);
            if gap < least {
                faults.push(Fault::at(
                    &condition.place,
                    format!(
                        "the free body `{}` touches the end of the box along {} at the start",
                        domain.groups[g].name,
                        axis_name(k)
                    ),
                    "leave at least one spacing of fluid between them: move the body, or make the box larger",
                ));
                return;
            }
        }
    }
}
