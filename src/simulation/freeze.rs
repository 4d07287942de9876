//! The chemistry's view of a scene: volumes, conductances, what is held, and what faces a surface.

use crate::chemistry::GroupSet;
use crate::chemistry::network::Rate;
use crate::chemistry::split::Frozen;
use crate::error::RunError;
use crate::fluid::surface::Facing;
use crate::plan::Plan;
use crate::plan::start::Start;
use crate::scene::Scene;
use std::borrow::Cow;

/// Freezes a scene.
pub(super) fn freeze<const D: usize>(
    plan: &Plan,
    scene: &Scene<D>,
    start: &Start,
) -> Result<Frozen, RunError> {
    let held: &[bool] = if start.held.iter().any(|&held| held) { &start.held } else { &[] };
    let links = |habitat| Cow::Owned(scene.links(habitat));
    let (volumes, home, current) = (&scene.volumes, &scene.home, &scene.current);
    let frozen = Frozen::build_per_habitat(&plan.reactor, links, volumes, home, current, held)?;
    Ok(frozen.with_surfaces(&plan.reactor, current, &weights(plan, scene)))
}

/// Of each surface reaction the factor of its propensity in the voxels that face the surface.
fn weights<const D: usize>(plan: &Plan, scene: &Scene<D>) -> Vec<(usize, Vec<(u32, f64)>)> {
    let mut known: Vec<((usize, GroupSet), Vec<Facing>)> = Vec::new();
    let mut found = Vec::new();
    for (r, reaction) in plan.network.reactions.iter().enumerate() {
        let (Rate::Surface(surface), Some(&(s, _))) = (&reaction.rate, reaction.change().first()) else {
            continue;
        };
        let key = (surface.number, plan.reactor.habitat[s]);
        if !known.iter().any(|(other, _)| *other == key) {
            known.push((key, scene.facing(surface.number, key.1)));
        }
        let facing = known.iter().find(|(other, _)| *other == key).map_or(&[][..], |(_, facing)| facing);
        let diffusivity = plan.reactor.diffusivity[s];
        let weight = |f: &Facing| {
            let volume = scene.volumes[f.voxel as usize];
            (f.voxel, surface.kind.weight(volume, f.area, f.distance, diffusivity))
        };
        found.push((r, facing.iter().map(weight).collect()));
    }
    found
}
