//! Buoyancy: a species makes the fluid lighter or heavier.

use super::What;
use crate::chemistry::Network;
use crate::model::domain::ParticleDomain;
use crate::model::names::{pad, species_index, species_named};
use crate::model::node::{Node, Value};
use crate::model::reader::{Faults, Fields};
use crate::quantity::Dimension;

/// How a species changes the density of the fluid (Boussinesq): rho = rho0 (1 - expansion (C - reference)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expansion {
    pub species: usize,
    /// m³/mol; positive if the species makes the fluid lighter.
    pub expansion: f64,
    /// mol/m³.
    pub reference: f64,
}

/// `buoyancy: { species: C, expansion: 0.1 L/mol, reference: 1 mM, gravity: [0, -9.81 m/s^2] }`, or for several
/// species `buoyancy: { gravity: [...], species: { C: { expansion: ..., reference: ... }, S: ... } }`.
pub(super) fn buoyancy(
    node: &Node,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Option<What> {
    let mut fields = Fields::of(node, "buoyancy", faults)?;
    let gravity = fields
        .required("gravity", faults)
        .and_then(|n| n.vector(Dimension::ACCELERATION, domain.dimensions, faults));
    let mut species = Vec::new();
    match fields.required("species", faults) {
        Some(n) if matches!(n.value, Value::Map(_)) => {
            for (key, inner) in Fields::of(n, "species", faults)?.entries() {
                let index = species_index(&key.name, &key.place, network, faults);
                let Some(mut own) = Fields::of(inner, &format!("species `{}`", key.name), faults) else {
                    continue;
                };
                let found = expansion(&mut own, index, faults);
                own.finish(faults);
                species.extend(found);
            }
        }
        Some(n) => {
            let index = species_named(n, network, faults);
            species.extend(expansion(&mut fields, index, faults));
        }
        None => {}
    }
    fields.finish(faults);
    if domain.fluid.is_none() {
        faults.at(
            &node.place,
            "buoyancy moves a fluid, and none moves here",
            "describe it by `fluid:`, or remove this",
        );
        return None;
    }
    Some(What::Buoyancy { gravity: pad(&gravity?), species })
}

fn expansion(fields: &mut Fields, species: Option<usize>, faults: &mut Faults) -> Option<Expansion> {
    let expansion =
        fields.required("expansion", faults).and_then(|n| n.quantity(Dimension::SOLUTAL_EXPANSION, faults));
    let reference = match fields.optional("reference") {
        Some(n) => n.non_negative(Dimension::CONCENTRATION, faults),
        None => Some(0.0),
    };
    Some(Expansion { species: species?, expansion: expansion?, reference: reference? })
}
