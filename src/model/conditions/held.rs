//! Held values: amounts of the particles of a group, or concentrations at a surface.

use super::{WallName, What, amounts, group, surface};
use crate::chemistry::Network;
use crate::model::domain::ParticleDomain;
use crate::model::groups::Material;
use crate::model::initial::{Amount, Deal};
use crate::model::names::axis_name;
use crate::model::node::{Node, Value};
use crate::model::reader::{Faults, Fields};

/// `held: { in: left, species: { A: 1 uM } }` holds the particles of a group; with `at: surface`, and always at a
/// side of the box (`in: x_min`), the concentration at the surface itself is held.
pub(super) fn held(
    node: &Node,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Option<What> {
    let mut fields = Fields::of(node, "held", faults)?;
    let named =
        fields.optional("species").is_some_and(|n| !matches!(&n.value, Value::Map(all) if all.is_empty()));
    if !named {
        faults.at(&node.place, "`held` holds no species", "say which and at what: species: { A: 1 uM }");
    }
    let at_surface = match fields.optional("at") {
        Some(n) => n.choice(&[("particles", false), ("surface", true)], faults)?,
        None => fields.optional("in").is_some_and(|n| names_a_side(n, domain)),
    };
    if at_surface {
        return at(fields, node, domain, network, faults);
    }
    let group = group(&mut fields, domain, faults);
    let species = amounts(&mut fields, domain, network, faults);
    let deal = match fields.optional("deal") {
        // A concentration is held in the mean: a fixed count could not show a fraction of a molecule.
        None if species
            .iter()
            .all(|(_, amount)| matches!(amount, Amount::Molecules(_) | Amount::PerParticle(_))) =>
        {
            Deal::Even
        }
        None => Deal::Poisson,
        Some(n) => n.choice(&[("count", Deal::Even), ("poisson", Deal::Poisson)], faults)?,
    };
    fields.finish(faults);
    let group = group?;
    if domain.groups[group].material == Material::Zone && domain.fluid.is_some() {
        faults.at(
            &node.place,
            format!(
                "`{}` is a zone that particles pass through; amounts cannot be held in it",
                domain.groups[group].name
            ),
            "use a sponge with a large rate",
        );
        return None;
    }
    Some(What::Held { group, species, deal })
}

fn names_a_side(node: &Node, domain: &ParticleDomain) -> bool {
    let Value::Text(name) = &node.value else { return false };
    (0..domain.dimensions).any(|axis| {
        let axis = axis_name(axis);
        *name == format!("{axis}_min") || *name == format!("{axis}_max")
    })
}

/// Concentrations held at a surface.
fn at(
    mut fields: Fields,
    node: &Node,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Option<What> {
    let wall: Option<WallName> = surface::surface_named(&mut fields, domain, faults);
    let stated = amounts(&mut fields, domain, network, faults);
    fields.finish(faults);
    let mut species = Vec::new();
    for (s, amount) in stated {
        let name = &network.species[s].name;
        match amount {
            _ if network.species[s].diffusion <= 0.0 => faults.at(
                &node.place,
                format!("`{name}` does not diffuse, so a surface cannot hold its concentration"),
                "give it a diffusion, or hold the particles of a group",
            ),
            Amount::Concentration(c) => species.push((s, c)),
            Amount::Molecules(0.0) => species.push((s, 0.0)),
            _ => faults.at(
                &node.place,
                format!("a surface holds one concentration, and that of `{name}` is given otherwise"),
                format!("give it with a unit, e.g. {name}: 1 uM"),
            ),
        }
    }
    Some(What::HeldSurface { wall: wall?, species })
}
