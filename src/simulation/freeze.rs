//! The chemistry's view of a scene: volumes, conductances, what is held, and what faces a surface.

use crate::chemistry::GroupSet;
use crate::chemistry::network::{Rate, Surface};
use crate::chemistry::split::Frozen;
use crate::error::RunError;
use crate::fluid::exchange::Exchange;
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
    let known = exchanges(plan, scene);
    let links = |habitat| match known.iter().find(|(other, _)| *other == habitat) {
        Some((_, exchange)) => Cow::Borrowed(&exchange.links),
        None => Cow::Owned(scene.exchange(habitat).links),
    };
    let (volumes, home, current) = (&scene.volumes, &scene.home, &scene.current);
    let frozen = Frozen::build_per_habitat(&plan.reactor, links, volumes, home, current, held)?;
    Ok(frozen.with_surfaces(&plan.reactor, current, &weights(plan, scene, &known)))
}

/// What is exchanged in each habitat of species that diffuse or pass a surface.
fn exchanges<const D: usize>(plan: &Plan, scene: &Scene<D>) -> Vec<(GroupSet, Exchange)> {
    let mut known: Vec<(GroupSet, Exchange)> = Vec::new();
    let reactor = &plan.reactor;
    let passing = surface_species(plan).map(|(_, _, s)| s);
    let diffusing = (0..reactor.species_count()).filter(|&s| reactor.diffusivity[s] > 0.0);
    for habitat in diffusing.chain(passing).map(|s| reactor.habitat[s]) {
        if !known.iter().any(|(other, _)| *other == habitat) {
            known.push((habitat, scene.exchange(habitat)));
        }
    }
    known
}

/// The surface reactions: number, surface, species.
fn surface_species(plan: &Plan) -> impl Iterator<Item = (usize, &Surface, usize)> {
    plan.network.reactions.iter().enumerate().filter_map(|(r, reaction)| match &reaction.rate {
        Rate::Surface(surface) => reaction.change().first().map(|&(s, _)| (r, surface, s)),
        _ => None,
    })
}

/// Of each surface reaction the factor of its propensity in the voxels that face the surface.
fn weights<const D: usize>(
    plan: &Plan,
    scene: &Scene<D>,
    exchanges: &[(GroupSet, Exchange)],
) -> Vec<(usize, Vec<(u32, f64)>)> {
    let mut known: Vec<((usize, GroupSet), Vec<Facing>)> = Vec::new();
    let mut found = Vec::new();
    for (r, surface, s) in surface_species(plan) {
        let key = (surface.number, plan.reactor.habitat[s]);
        if !known.iter().any(|(other, _)| *other == key) {
            let exchange = exchanges.iter().find(|(habitat, _)| *habitat == key.1);
            let facing = exchange.map(|(_, exchange)| scene.facing(key.0, key.1, exchange));
            known.push((key, facing.unwrap_or_default()));
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
