//! The numbers of a flow: how fast and how wide it is, and what of it does not go with the speed that is stated.

use super::ParticlePlan;
use super::caution::stiff_enough;
use crate::error::{Fault, Place};
use crate::fluid::{Body, BodyKind, End, LARGEST_MACH, Motion};
use crate::geometry::Shape;
use crate::geometry::shape::embed;
use crate::model::conditions::{Condition, WallMotion, WallName, What};
use crate::model::names::{axis_name, side_name};
use crate::model::{Boundary, FluidModel, Model, ParticleDomain};
use crate::quantity::readable::{show, show_vector};
use crate::vector::Vector;

/// Instants of a run, and particles before a body, at which speeds are looked up.
const LOOKS: u32 = 64;
const PARTICLES: usize = 2000;
/// What moves faster than stated by less than this counts as stated: particles lie half a spacing before a surface.
const FASTER: f64 = 1.05;
/// Share of a belt's velocity that may lead through its surface: at the ends of a flat one corners count in part.
const THROUGH: f64 = 0.5;

/// Something that moves: how fast (m/s), what it is in words, and where that is stated.
pub struct Mover<'a> {
    pub speed: f64,
    pub what: String,
    place: &'a Place,
}

/// The width across which a flow is sheared, m, and what it is: as stated, the narrowest extent between walls, else the
/// shortest of the box.
#[must_use]
pub fn reference_length(domain: &ParticleDomain, fluid: &FluidModel) -> (f64, String) {
    if let Some(length) = fluid.length {
        return (length, "fluid.length".into());
    }
    let extent = |k: usize| domain.max[k] - domain.min[k];
    let closed = |k: &usize| !matches!(domain.boundaries[*k], Boundary::Periodic | Boundary::Open);
    let narrowest = |axes: Vec<usize>| axes.into_iter().min_by(|a, b| extent(*a).total_cmp(&extent(*b)));
    match narrowest((0..domain.dimensions).filter(closed).collect()) {
        Some(k) => (extent(k), format!("the width between the walls along {}", axis_name(k))),
        None => {
            let k = narrowest((0..domain.dimensions).collect()).unwrap_or(0);
            (extent(k), format!("the box along {}", axis_name(k)))
        }
    }
}

/// The fastest of what is stated of a flow: `fluid.speed`, the velocity at the start, walls, ends and sponges.
#[must_use]
pub fn fastest<'a, const D: usize>(
    model: &'a Model,
    domain: &'a ParticleDomain,
    plan: &ParticlePlan<D>,
) -> Option<Mover<'a>> {
    let fluid = domain.fluid.as_ref()?;
    let stated = Mover { speed: fluid.speed, what: "fluid.speed".into(), place: &fluid.places.speed };
    let others = movers(model, domain, plan).into_iter();
    Some(others.fold(stated, |most, one| if one.speed > FASTER * most.speed { one } else { most }))
}

/// All that is stated to move.
fn movers<'a, const D: usize>(
    model: &'a Model,
    domain: &'a ParticleDomain,
    plan: &ParticlePlan<D>,
) -> Vec<Mover<'a>> {
    let (Some(setup), Some(fluid)) = (&plan.flow, &domain.fluid) else { return Vec::new() };
    let mut found = Vec::new();
    let start = setup.particles.iter().filter(|placed| placed.body == 0);
    let start = start.map(|placed| plan.velocity.at(&embed(&placed.position)).norm()).fold(0.0, f64::max);
    found.push(Mover { speed: start, what: "the fluid at the start".into(), place: &fluid.places.velocity });
    let times = || (0..=LOOKS).map(|k| model.run.until * f64::from(k) / f64::from(LOOKS));
    for condition in &domain.conditions {
        let (speed, what) = match &condition.what {
            What::MovingWall { .. } | What::FreeBody { .. } => {
                let Some(number) = moved(domain, condition, &setup.bodies) else { continue };
                let BodyKind::Solid { surface, .. } = &setup.bodies[number].kind else { continue };
                // The fluid before it: what lies deeper in a rotor, or behind it, is not touched.
                let near = |x: &Vector<D>| surface.as_ref().is_none_or(|s| s(x).abs() < 0.75 * setup.spacing);
                let own = || {
                    let fluid = setup.particles.iter().filter(|placed| placed.body == 0);
                    fluid.filter(|placed| near(&placed.position))
                };
                let stride = own().count().div_ceil(PARTICLES).max(1);
                let speed =
                    speed(&setup.bodies[number], || own().map(|p| &p.position).step_by(stride), times());
                (speed, format!("the wall `{}`", setup.bodies[number].name))
            }
            What::Sponge { velocity: Some(velocity), .. } => {
                (velocity.norm(), format!("the sponge `{}`", condition.name))
            }
            What::Open { upper, .. } => {
                let Some(openings) = &plan.openings else { continue };
                let End::Velocity(stream) = &openings.open.ends[usize::from(*upper)] else { continue };
                let all = || setup.particles.iter().filter(|placed| placed.body == openings.open.fluid);
                let stride = all().count().div_ceil(PARTICLES).max(1);
                let at =
                    |t: f64| all().step_by(stride).map(|p| stream(&p.position, t).norm()).fold(0.0, f64::max);
                (times().map(at).fold(0.0, f64::max), format!("what enters by `{}`", condition.name))
            }
            _ => continue,
        };
        found.push(Mover { speed, what, place: &condition.place });
    }
    found
}

/// The body that a condition moves.
fn moved<const D: usize>(
    domain: &ParticleDomain,
    condition: &Condition,
    bodies: &[Body<D>],
) -> Option<usize> {
    let name = match &condition.what {
        What::MovingWall { wall: WallName::Group(group), .. } => domain.groups[*group].name.clone(),
        What::MovingWall { wall: WallName::Side { axis, upper }, .. } => side_name(*axis, *upper),
        What::FreeBody { group, .. } => domain.groups[*group].name.clone(),
        _ => return None,
    };
    bodies.iter().position(|body| body.name == name)
}

/// Largest speed of a body at some places and instants, m/s.
fn speed<'p, const D: usize, P: Iterator<Item = &'p Vector<D>>>(
    body: &Body<D>,
    places: impl Fn() -> P,
    times: impl Iterator<Item = f64>,
) -> f64 {
    let BodyKind::Solid { motion, .. } = &body.kind else { return 0.0 };
    match motion {
        Motion::Oscillating { amplitude, .. } => amplitude.norm(),
        Motion::Free(rigid) => rigid.free.velocity.norm(),
        Motion::Deforming(_) => {
            let at = |t: f64| places().map(|x| motion.velocity(x, t).norm()).fold(0.0, f64::max);
            times.map(at).fold(0.0, f64::max)
        }
        _ => places().map(|x| motion.velocity(x, 0.0).norm()).fold(0.0, f64::max),
    }
}

/// Warnings: what is faster than the speed that is stated, and a sound speed too low for it.
#[must_use]
pub fn warnings<const D: usize>(
    model: &Model,
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
) -> Vec<Fault> {
    let (Some(fluid), Some(fastest)) = (&domain.fluid, fastest(model, domain, plan)) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    if fastest.speed > fluid.speed {
        found.push(Fault::at(
            fastest.place,
            format!(
                "{} moves at {}, faster than the fluid.speed of {} that steps and sound speed are chosen for",
                fastest.what,
                show(fastest.speed, "m/s"),
                show(fluid.speed, "m/s")
            ),
            format!("set fluid.speed: {:.3e} m/s", fastest.speed),
        ));
    }
    let enough =
        plan.flow.as_ref().map_or(10.0 * fastest.speed, |setup| stiff_enough(plan, setup, fastest.speed));
    if let (Some(c), Some(place)) = (fluid.sound_speed, &fluid.places.sound_speed)
        && fastest.speed > LARGEST_MACH * c
    {
        found.push(Fault::at(
            place,
            format!(
                "a Mach number of {:.2}, above {LARGEST_MACH}: {} {} {} with a sound speed of {}",
                fastest.speed / c,
                fastest.what,
                if fastest.what == "fluid.speed" { "is" } else { "moves at" },
                show(fastest.speed, "m/s"),
                show(c, "m/s")
            ),
            format!("set fluid.sound_speed: {enough:.2e} m/s, or auto"),
        ));
    }
    found.extend(super::caution::warnings(model, domain, plan, fastest.speed));
    belts(domain, plan, &mut found);
    found
}

/// Belts whose velocity leads through the surface that the fluid touches.
fn belts<const D: usize>(domain: &ParticleDomain, plan: &ParticlePlan<D>, found: &mut Vec<Fault>) {
    let Some(setup) = &plan.flow else { return };
    let step = 1e-4 * setup.spacing;
    for condition in &domain.conditions {
        let What::MovingWall { wall: WallName::Group(g), motion: WallMotion::Belt(velocity) } =
            &condition.what
        else {
            continue;
        };
        let shape = &domain.groups[*g].shape;
        if *shape == Shape::EverythingElse || velocity.norm() == 0.0 {
            continue;
        }
        let distance = |x: &Vector<3>| shape.signed_distance(x);
        let through = |x: &Vector<3>| {
            let slope = |k: usize| {
                let mut on = *x;
                on[k] += step;
                (distance(&on) - distance(x)) / step
            };
            let normal: Vector<3> = Vector::from_fn(|k, _| if k < D { slope(k) } else { 0.0 });
            normal.dot(velocity).abs() / (normal.norm() * velocity.norm())
        };
        let touching = setup.particles.iter().filter(|placed| placed.body == 0);
        let touching = touching.map(|placed| embed(&placed.position));
        let worst = touching.filter(|x| distance(x).abs() < setup.spacing).map(|x| (through(&x), x)).fold(
            None,
            |most: Option<(f64, Vector<3>)>, one| match most {
                Some(most) if most.0 >= one.0 => Some(most),
                _ => Some(one),
            },
        );
        if let Some((share, x)) = worst.filter(|(share, _)| *share > THROUGH) {
            found.push(Fault::at(
                &condition.place,
                format!(
                    "the belt `{}` moves through its own surface, by {:.0} % of its velocity at {}",
                    domain.groups[*g].name,
                    100.0 * share,
                    show_vector(&x.as_slice()[..D], "m")
                ),
                "a belt slides along its surface while its particles stay: set travels: true, or give a rotation",
            ));
        }
    }
}
