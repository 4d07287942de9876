//! What is known before a run to come out wrong or badly: each a warning with numbers, and what would do.

use super::ParticlePlan;
use super::flow::reference_length;
use crate::error::Fault;
use crate::fluid::{Body, BodyKind, LARGEST_DENSITY_CHANGE, LARGEST_MACH, Method, Setup};
use crate::model::conditions::What;
use crate::model::names::axis_name;
use crate::model::{Boundary, FluidModel, Material, Model, ParticleDomain, SolidModel};
use crate::quantity::readable::{show, significant};

/// Strength of the shift below which particles are hardly kept in order.
const WEAK_SHIFT: f64 = 1.0;
/// Share of the pressure expected along a flow above which a hydrostatic pressure across an open end matters.
const ACROSS: f64 = 0.1;

/// All that holds of a plan; `fast` is the largest speed stated, m/s.
#[must_use]
pub fn warnings<const D: usize>(
    model: &Model,
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
    fast: f64,
) -> Vec<Fault> {
    let (Some(fluid), Some(setup)) = (&domain.fluid, &plan.flow) else { return Vec::new() };
    let all = [
        compressed(fluid, plan, setup, fast),
        driven(model, domain, fluid, setup),
        hydrostatic_at_ends(domain, plan, setup),
        disordered(model, plan, setup),
        lukewarm(model, setup),
    ];
    all.into_iter().flatten().chain(turning_solids(domain)).collect()
}

/// The sound speed at which speeds (m/s) and pressures to be expected change the density by 1 %, m/s.
pub(super) fn stiff_enough<const D: usize>(plan: &ParticlePlan<D>, setup: &Setup<D>, fast: f64) -> f64 {
    let ends = plan.openings.as_ref().map_or(0.0, |openings| openings.open.largest_pressure());
    setup.pressed_sound_speed(ends).max(10.0 * fast)
}

/// A stated sound speed that is enough for the speeds, and not for the pressures.
fn compressed<const D: usize>(
    fluid: &FluidModel,
    plan: &ParticlePlan<D>,
    setup: &Setup<D>,
    fast: f64,
) -> Option<Fault> {
    let (c, place) = (fluid.sound_speed?, fluid.places.sound_speed.as_ref()?);
    let enough = stiff_enough(plan, setup, fast);
    // The square of their ratio is the change over 1 %.
    let change = 0.01 * (setup.pressed_sound_speed(0.0).max(stiff_enough(plan, setup, 0.0)) / c).powi(2);
    (change > LARGEST_DENSITY_CHANGE && fast <= LARGEST_MACH * c).then(|| {
        Fault::at(
            place,
            format!(
                "with a sound speed of {} the pressures to be expected, friction or weight, change the density by some {} %, above {} %",
                show(c, "m/s"),
                significant(100.0 * change, 2),
                100.0 * LARGEST_DENSITY_CHANGE
            ),
            format!("set fluid.sound_speed: {enough:.2e} m/s, or auto"),
        )
    })
}

/// A force along the flow that would drive it far beyond what its sound speed is chosen for.
fn driven<const D: usize>(
    model: &Model,
    domain: &ParticleDomain,
    fluid: &FluidModel,
    setup: &Setup<D>,
) -> Option<Fault> {
    let along = |k: &usize| matches!(domain.boundaries[*k], Boundary::Periodic | Boundary::Open);
    let pull = (0..D).filter(along).map(|k| setup.body_force[k].powi(2)).sum::<f64>().sqrt();
    let force = domain.conditions.iter().find(|one| matches!(one.what, What::Force { .. }))?;
    let (width, of) = reference_length(domain, fluid);
    let mut speed = pull * (model.run.until + fluid.settle);
    let mut how = "in the time of the run".to_owned();
    let steady = pull * width * width * fluid.density / (8.0 * fluid.viscosity);
    if setup.has_solids() && steady < speed {
        speed = steady;
        how = format!("in a plain channel of {} ({of})", show(width, "m"));
    }
    let c = fluid.sound_speed.unwrap_or_else(|| setup.automatic_sound_speed());
    (speed > LARGEST_MACH * c).then(|| {
        Fault::at(
            &force.place,
            format!(
                "the force `{}` would drive the fluid at up to {} {how}, which is {:.2} of the sound speed of {} that goes with a fluid.speed of {}",
                force.name,
                show(speed, "m/s"),
                speed / c,
                show(c, "m/s"),
                show(fluid.speed, "m/s")
            ),
            "set fluid.speed to the largest speed there will be, or make the force weaker",
        )
    })
}

/// Open ends hold one pressure over their whole height.
fn hydrostatic_at_ends<const D: usize>(
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
    setup: &Setup<D>,
) -> Option<Fault> {
    plan.openings.as_ref()?;
    let (rho, lengths) = (domain.fluid.as_ref()?.density, setup.domain.lengths());
    let closed = |k: &usize| matches!(domain.boundaries[*k], Boundary::NoSlip | Boundary::FreeSlip);
    let press = |k: usize| (setup.body_force[k].abs() + setup.buoyancy[k]) * lengths[k] * rho;
    let k = (0..D).filter(closed).max_by(|a, b| press(*a).total_cmp(&press(*b)))?;
    let acts = |what: &What| matches!(what, What::Force { .. } | What::Buoyancy { .. });
    let condition = domain.conditions.iter().find(|one| acts(&one.what))?;
    (press(k) > ACROSS * setup.expected_pressure()).then(|| {
        Fault::at(
            &condition.place,
            format!(
                "`{}` presses along {} with up to {}, and the pressure at an open end is the same over its height: fluid will turn round there",
                condition.name,
                axis_name(k),
                show(press(k), "Pa")
            ),
            "leave its component across the flow out where it only adds a pressure, or keep what is looked at far from the ends",
        )
    })
}

/// A shift too weak to keep particles in order.
fn disordered<const D: usize>(model: &Model, plan: &ParticlePlan<D>, setup: &Setup<D>) -> Option<Fault> {
    let a = setup.shift(plan.openings.is_some());
    (setup.options.shift.is_none() && a > 0.0 && a < WEAK_SHIFT).then(|| {
        Fault::at(
            &model.places.fluid,
            format!(
                "particles are kept in order by a shift of {} where 2 is usual, for friction holds no more of it in this flow: they may clump",
                significant(a, 2)
            ),
            "a finer spacing, or a lower fluid.speed if that is more than there will be; compare with fluid.options.shift: 1",
        )
    })
}

/// Fluid with thermal noise next to solids: their pressure is that of a density only where all rest, and the shift of the
/// transport velocity is no part of the bath.
fn lukewarm<const D: usize>(model: &Model, setup: &Setup<D>) -> Option<Fault> {
    if setup.noise.is_none() || !setup.has_solids() {
        return None;
    }
    let moving = |body: &&Body<D>| matches!(&body.kind, BodyKind::Solid { motion, .. } if motion.moves());
    let (what, remedy) = match setup.bodies.iter().find(moving) {
        Some(body) => (
            format!(
                "`{}` moves: next to solids a fluid with thermal noise then comes out too hot, between plates 14 spacings apart by 6 % in the mean (free slip 9 %)",
                body.name
            ),
            "mind the temperature the report tells; with solids at rest and method: sdpd it is that of the bath",
        ),
        None if setup.method == Method::SphBvf => (
            "next to walls the default fluid with thermal noise comes out too cold, between plates 14 spacings apart by 2 % in the mean (free slip 4 %)".to_owned(),
            "set fluid.method: sdpd, which holds the temperature next to walls too",
        ),
        None => return None,
    };
    Some(Fault::at(&model.places.fluid, what, remedy))
}

/// Elastic solids that nothing holds.
fn turning_solids(domain: &ParticleDomain) -> Vec<Fault> {
    let free = |solid: &&SolidModel| {
        solid.clamped.is_none()
            && solid.driven.is_none()
            && solid.turgor.is_none()
            && domain.groups[solid.group].material == Material::Solid
    };
    let warning = |solid: &SolidModel| {
        Fault::at(
            &solid.places.entry,
            "an elastic solid that nothing holds turns too fast in a shear, up to twice: the friction it feels has no couple for its own rotation",
            "hold it (clamped, driven), or take a free_body if it is stiff",
        )
    };
    if domain.fluid.is_none() || domain.dimensions == 1 {
        return Vec::new();
    }
    domain.solids.iter().filter(free).map(warning).collect()
}
