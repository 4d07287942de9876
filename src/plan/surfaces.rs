//! Surfaces through which molecules enter or leave: which they are, and whether they can.

use super::{Arena, Plan};
use crate::chemistry::Rate;
use crate::error::Fault;
use crate::model::conditions::{Condition, WallName, What};
use crate::model::{Domain, ParticleDomain};
use crate::quantity::readable::{length, show_vector};

/// Most species that may enter or leave through surfaces, all together.
const MOST: usize = 60;

/// The surfaces of a domain, numbered in the order of their conditions.
#[must_use]
pub fn surfaces(domain: &ParticleDomain) -> Vec<WallName> {
    domain
        .conditions
        .iter()
        .filter_map(|condition| match &condition.what {
            What::Flux { wall, .. } | What::Absorbing { wall, .. } | What::HeldSurface { wall, .. } => {
                Some(*wall)
            }
            _ => None,
        })
        .collect()
}

/// What an arena knows of one group: whether it stays in place, how deep its particles lie (m), the cut-off (m).
struct Body {
    stays: bool,
    depth: f64,
    cutoff: f64,
}

fn body(plan: &Plan, g: usize) -> Option<Body> {
    fn of<const D: usize>(plan: &super::ParticlePlan<D>, g: usize) -> Body {
        let shape = plan.still.iter().find(|(group, _)| usize::from(*group) == g).map(|(_, shape)| shape);
        let inside = |shape: &crate::geometry::Shape| {
            let own = plan.particles.iter().zip(&plan.home).filter(|(_, home)| usize::from(**home) == g);
            own.map(|(p, _)| -shape.signed_distance(&crate::geometry::shape::embed(&p.position)))
                .fold(0.0, f64::max)
        };
        Body { stays: shape.is_some(), depth: shape.map_or(0.0, inside), cutoff: plan.cutoff }
    }
    match &plan.arena {
        Arena::Compartments(_) => None,
        Arena::Line(p) => Some(of(p, g)),
        Arena::Plane(p) => Some(of(p, g)),
        Arena::Space(p) => Some(of(p, g)),
    }
}

/// Surfaces that move, that are too thin to be seen whole, or that a species passes anyway.
pub fn check(plan: &Plan, faults: &mut Vec<Fault>) {
    let Domain::Particles(domain) = &plan.model.domain else { return };
    let through = plan.network.reactions.iter().filter(|r| matches!(r.rate, Rate::Surface(_))).count();
    if through > MOST {
        faults.push(Fault::at(
            &plan.model.places.domain,
            format!("{through} species enter or leave through surfaces; at most {MOST} can"),
            "remove some of them",
        ));
    }
    for condition in &domain.conditions {
        let (What::Flux { wall, species }
        | What::Absorbing { wall, species }
        | What::HeldSurface { wall, species }) = &condition.what
        else {
            continue;
        };
        at_odds(domain, condition, (*wall, species), plan, faults);
        let WallName::Group(g) = *wall else { continue };
        let name = &domain.groups[g].name;
        let Some(body) = body(plan, g) else { continue };
        if !body.stays {
            faults.push(Fault::at(
                &condition.place,
                format!("`{name}` moves, and molecules pass only surfaces that stay"),
                "remove its motion, or exchange the molecules by a reaction in a zone",
            ));
        } else if body.depth < 0.75 * body.cutoff {
            faults.push(Fault::at(
                &condition.place,
                format!(
                    "`{name}` is {} deep, thinner than the kernel's cut-off of {}: its surface would not be seen whole",
                    show_vector(&[body.depth], "m"),
                    length(body.cutoff)
                ),
                "make the group thicker, or the spacing or support smaller",
            ));
        }
        for &(s, _) in species {
            if plan.reactor.habitat[s].holds(g as u8) {
                let species = &plan.reactor.species[s];
                faults.push(Fault::at(
                    &condition.place,
                    format!("`{species}` lives in `{name}` itself, so its surface is no boundary"),
                    format!("keep it out by `only_in` of the species or `holds: none` of `{name}`"),
                ));
            }
        }
    }
}

/// A species that a surface holds cannot enter or be absorbed there as well, nor be held or absorbed twice.
fn at_odds(
    domain: &ParticleDomain,
    condition: &Condition,
    (wall, species): (WallName, &[(usize, f64)]),
    plan: &Plan,
    faults: &mut Vec<Fault>,
) {
    let kind = |what: &What| match what {
        What::HeldSurface { .. } => "held",
        What::Absorbing { .. } => "absorbing",
        _ => "flux",
    };
    for earlier in domain.conditions.iter().take_while(|other| !std::ptr::eq(*other, condition)) {
        let (What::Flux { wall: there, species: theirs }
        | What::Absorbing { wall: there, species: theirs }
        | What::HeldSurface { wall: there, species: theirs }) = &earlier.what
        else {
            continue;
        };
        let (one, other) = (kind(&earlier.what), kind(&condition.what));
        // Molecules may enter by several fluxes, and be absorbed where others enter.
        let together = one == "flux" && other != "held" || other == "flux" && one != "held";
        if *there != wall || together {
            continue;
        }
        if let Some((s, _)) = species.iter().find(|(s, _)| theirs.iter().any(|(other, _)| other == s)) {
            faults.push(Fault::at(
                &condition.place,
                format!(
                    "`{}` of `{}` ({other}) is what `{}` ({one}) already rules at the same surface",
                    plan.reactor.species[*s], condition.name, earlier.name
                ),
                "remove one of the two: a surface that holds a concentration takes and gives what that needs",
            ));
        }
    }
}
