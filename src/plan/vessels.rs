//! Elastic walls that enclose something and are always in balance with it: columns, turgor, growth, a reserve.

use super::ParticlePlan;
use crate::error::{Fault, Place};
use crate::fluid::Placed;
use crate::geometry::Shape;
use crate::model::groups::Group;
use crate::model::solids::{Growth as GrowthModel, Placement};
use crate::model::{Mechanics, ParticleDomain, SolidModel};
use crate::solid::{Growth, Relaxation, Turgor, Wall};
use crate::vector::Vector;

/// What makes a solid of a plan a vessel.
#[derive(Clone, Debug)]
pub struct VesselPlan<const D: usize> {
    pub wall: Wall<D>,
    pub turgor: Turgor,
    pub growth: Option<Growth>,
    /// Rate of growth, 1/(Pa s), and the species and concentration (mol/m³) by which.
    pub rate: f64,
    pub by: Option<(usize, f64)>,
    pub relaxation: Relaxation,
}

/// Places and volumes of the columns of a ring or spherical shell; none of another shape.
pub(super) fn columns<const D: usize>(
    solid: &SolidModel,
    group: &Group,
) -> Option<(Wall<D>, Vec<(Vector<D>, f64)>)> {
    let (Shape::Shell { centre, inner, outer }, Placement::Layers, true) =
        (&group.shape, solid.placement, D > 1)
    else {
        return None;
    };
    let built = Wall::<D>::round(&Vector::from_fn(|k, _| centre[k]), *inner, *outer, solid.spacing);
    Some((built.wall, built.places.into_iter().zip(built.volumes).collect()))
}

/// The vessel of a solid of `particles` particles, if the model is in balance.
pub(super) fn vessel<const D: usize>(
    domain: &ParticleDomain,
    solid: &SolidModel,
    particles: usize,
    faults: &mut Vec<Fault>,
) -> Option<VesselPlan<D>> {
    let entry = &solid.places.entry;
    let mut refuse = |place: &Place, reason: &str, remedy: &str| {
        faults.push(Fault::at(place, reason, remedy));
    };
    let Mechanics::QuasiStatic { tolerance } = domain.mechanics else {
        if solid.turgor.is_some() {
            refuse(
                entry,
                "turgor is that of a wall in balance with it",
                "add mechanics: { mode: quasi_static }",
            );
        }
        return None;
    };
    if domain.fluid.is_some() {
        refuse(entry, "a wall in balance knows no fluid but its turgor", "set fluid: { method: none }");
    }
    let held = solid.places.clamped.as_ref().or(solid.places.driven.as_ref());
    if let Some(place) = held {
        refuse(
            place,
            "a wall in balance with its turgor is held by nothing",
            "remove `clamped` and `driven`: it stays where it is",
        );
    }
    for (name, place) in &solid.places.in_motion {
        let reason = format!("`{name}` has no effect on what is in balance at every chemistry step");
        refuse(place, &reason, "remove it, or let the solid move: mechanics: { mode: dynamic }");
    }
    let Some((wall, _)) = columns::<D>(solid, &domain.groups[solid.group]) else {
        let remedy = "for another solid remove `mechanics`: it then moves, and `drag` brings it to rest; for a closed wall give it \
                      placement: layers, and its group the shape of a ring (2D) or spherical shell (3D)";
        refuse(entry, "the quasi-static mode is that of closed walls, column by column", remedy);
        return None;
    };
    if wall.columns * wall.layers != particles {
        refuse(entry, "another group lies on the surface of the wall", "move one of them");
        return None;
    }
    let turgor = solid.turgor.map_or(Turgor { pressure: 0.0, stiffness: 0.0, rise: 0.0 }, |t| Turgor {
        pressure: t.pressure,
        stiffness: t.stiffness,
        rise: t.rise,
    });
    if solid.growth.is_some_and(|growth| growth.reserve > MOST_RESERVE) {
        let remedy = format!(
            "a reserve of {MOST_RESERVE} particles is the most; a few times those of the wall are plenty"
        );
        let place = solid.places.growth.as_ref().unwrap_or(entry);
        refuse(place, "growth.reserve is more than fits in memory", &remedy);
        return None;
    }
    let growth = solid.growth.map(|growth| Growth {
        yields: growth.yield_stress,
        insert_at: growth.insert_at,
        reserve: growth.reserve / wall.layers,
    });
    Some(VesselPlan {
        wall,
        turgor,
        growth,
        rate: solid.growth.map_or(0.0, |growth| growth.rate),
        by: solid.growth.and_then(|growth| growth.by),
        relaxation: Relaxation { tolerance, ..Relaxation::default() },
    })
}

/// Most particles in reserve.
const MOST_RESERVE: usize = 10_000_000;

/// Particles in reserve of a vessel: voxels that are nowhere until they are needed.
pub(super) fn reserve<const D: usize>(
    vessel: &VesselPlan<D>,
    growth: Option<&GrowthModel>,
    (corner, volume): (Vector<D>, f64),
) -> Vec<Placed<D>> {
    let count = growth.map_or(0, |growth| growth.reserve / vessel.wall.layers * vessel.wall.layers);
    vec![Placed { position: corner, volume, body: 0 }; count]
}

impl<const D: usize> ParticlePlan<D> {
    /// Whether all that moves is in balance at every chemistry step.
    #[must_use]
    pub fn is_balanced(&self) -> bool {
        self.solids.iter().any(|solid| solid.vessel.is_some())
    }
}
