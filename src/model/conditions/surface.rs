//! Conditions at a surface: molecules enter at a given flux, or are absorbed.

use super::{WallName, What, wall_named};
use crate::chemistry::{AVOGADRO, Network};
use crate::model::domain::ParticleDomain;
use crate::model::groups::Material;
use crate::model::names::species_index;
use crate::model::node::{Node, Value};
use crate::model::reader::{Faults, Fields};
use crate::quantity::Dimension;

/// Molecules per area and time; the same in moles.
const PER_AREA_AND_TIME: Dimension = Dimension([-2, 0, -1, 0, 0]);
const MOLES_PER_AREA_AND_TIME: Dimension = Dimension([-2, 0, -1, 0, 1]);

/// `flux: { in: x_min, species: { L: 500 /um^2/s } }`
pub(super) fn flux(
    node: &Node,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Option<What> {
    let (wall, species) = read(node, "flux", domain, network, faults, |value, faults| {
        let quantity = value.any_quantity(faults)?;
        if quantity.dimension == MOLES_PER_AREA_AND_TIME {
            return Some(value.non_negative(MOLES_PER_AREA_AND_TIME, faults)? * AVOGADRO);
        }
        value.non_negative(PER_AREA_AND_TIME, faults)
    })?;
    Some(What::Flux { wall, species })
}

/// `absorbing: { in: x_max, species: { L: 2 um/s } }`, or `L: perfect`.
pub(super) fn absorbing(
    node: &Node,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Option<What> {
    let (wall, species) = read(node, "absorbing", domain, network, faults, |value, faults| {
        if matches!(&value.value, Value::Text(word) if word == "perfect") {
            return Some(f64::INFINITY);
        }
        value.positive(Dimension::VELOCITY, faults)
    })?;
    for &(s, _) in &species {
        if network.species[s].diffusion <= 0.0 {
            faults.at(
                &node.place,
                format!("`{}` does not diffuse, so none of it reaches the surface", network.species[s].name),
                "give it a diffusion, or write a reaction that removes it",
            );
        }
    }
    Some(What::Absorbing { wall, species })
}

fn read(
    node: &Node,
    what: &str,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
    value: impl Fn(&Node, &mut Faults) -> Option<f64>,
) -> Option<(WallName, Vec<(usize, f64)>)> {
    let mut fields = Fields::of(node, what, faults)?;
    let wall = surface_named(&mut fields, domain, faults);
    let species_node = fields.required("species", faults);
    fields.finish(faults);
    let mut species = Vec::new();
    for (key, node) in Fields::of(species_node?, "species", faults)?.entries() {
        let index = species_index(&key.name, &key.place, network, faults);
        let value = value(node, faults);
        if let (Some(index), Some(value)) = (index, value) {
            species.push((index, value));
        }
    }
    Some((wall?, species))
}

/// A side of the box that is not periodic, or a group with an outline.
pub(super) fn surface_named(
    fields: &mut Fields,
    domain: &ParticleDomain,
    faults: &mut Faults,
) -> Option<WallName> {
    let node = fields.required("in", faults)?;
    let wall = wall_named(node, domain, faults)?;
    if let WallName::Group(g) = wall {
        let group = &domain.groups[g];
        let flows = group.material == Material::Fluid && domain.fluid.is_some();
        let shapeless = group.shape == crate::geometry::Shape::EverythingElse;
        if !group.material.is_filled() || flows || shapeless {
            faults.at(
                &node.place,
                format!("`{}` has no surface of its own", group.name),
                "name a side of the box (x_min, x_max, y_min, ...), or a group with a shape that stays in place",
            );
            return None;
        }
    }
    Some(wall)
}
