//! What makes a solid a living wall: softening, turgor, growth.

use super::Mechanics;
use crate::chemistry::Network;
use crate::geometry::Shape;
use crate::model::groups::Group;
use crate::model::names::species_named;
use crate::model::node::Node;
use crate::model::reader::{Faults, Fields};
use crate::quantity::Dimension;
use crate::quantity::readable::show;

/// A species softens the solid: G = G0 (1 - factor c/at); K stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softening {
    pub species: usize,
    pub factor: f64,
    /// mol/m³.
    pub at: f64,
}

/// Pressure inside: p = pressure - stiffness (V/V0 - 1), reached in the time `rise`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turgor {
    /// Pa.
    pub pressure: f64,
    /// Pa.
    pub stiffness: f64,
    /// s.
    pub rise: f64,
}

/// Growth along the wall: F_g' = rate (c/at) (σ - yield)+ F_g (Lockhart).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// 1/(Pa s).
    pub rate: f64,
    /// Pa.
    pub yield_stress: f64,
    /// Species and the concentration (mol/m³) at which `rate` holds; without it the wall grows everywhere alike.
    pub by: Option<(usize, f64)>,
    /// Stretch at which particles are put in.
    pub insert_at: f64,
    /// Particles kept in reserve.
    pub reserve: usize,
}

/// Whether a group is a ring in two dimensions or a spherical shell in three.
pub(super) fn is_wall(group: &Group, d: usize) -> bool {
    group.unread || (d >= 2 && matches!(group.shape, Shape::Shell { .. }))
}

/// Where a solid is: its group, the number of dimensions, how it moves.
type Where<'a> = (&'a Group, usize, Mechanics);

/// `{ by: E, factor: 0.99, at: 1 mol/m^3 }`.
pub(super) fn softening(node: &Node, network: &Network, faults: &mut Faults) -> Option<Softening> {
    let mut fields = Fields::of(node, "softening", faults)?;
    let species = fields.required("by", faults).and_then(|n| species_named(n, network, faults));
    let factor = fields.required("factor", faults).and_then(|n| n.non_negative(Dimension::NONE, faults));
    let at = fields.required("at", faults).and_then(|n| n.positive(Dimension::CONCENTRATION, faults));
    fields.finish(faults);
    Some(Softening { species: species?, factor: factor?, at: at? })
}

/// `{ pressure: 0.2 MPa, stiffness: 0 Pa, rise: 1 s }`.
pub(super) fn turgor(node: &Node, (group, d, _): Where, faults: &mut Faults) -> Option<Turgor> {
    let mut fields = Fields::of(node, "turgor", faults)?;
    let pressure = fields.required("pressure", faults).and_then(|n| {
        let pressure = n.quantity(Dimension::PRESSURE, faults)?;
        if pressure >= 0.0 {
            return Some(pressure);
        }
        faults.at(
            &n.place,
            format!("negative turgor is no turgor: {}", show(pressure, "Pa")),
            "it presses outwards; give zero or more",
        );
        None
    });
    let mut value = |key: &'static str, dimension| {
        fields.optional(key).map_or(Some(0.0), |n| n.non_negative(dimension, faults))
    };
    let stiffness = value("stiffness", Dimension::PRESSURE);
    let rise = value("rise", Dimension::TIME);
    fields.finish(faults);
    closed(node, "turgor", (group, d), faults);
    Some(Turgor { pressure: pressure?, stiffness: stiffness?, rise: rise? })
}

/// `{ rate: 1e-9 1/Pa/s, yield: 0.5 MPa, by: E, at: 1 mol/m^3, insert_at: 1.5, reserve: 400 }`.
pub(super) fn growth(
    node: &Node,
    (group, d, mechanics): Where,
    network: &Network,
    faults: &mut Faults,
) -> Option<Growth> {
    let mut fields = Fields::of(node, "growth", faults)?;
    let rate = fields
        .required("rate", faults)
        .and_then(|n| n.non_negative(Dimension::NONE / Dimension::PRESSURE / Dimension::TIME, faults));
    let yield_stress =
        fields.required("yield", faults).and_then(|n| n.non_negative(Dimension::PRESSURE, faults));
    let (by_node, at_node) = (fields.optional("by"), fields.optional("at"));
    let species = by_node.and_then(|n| species_named(n, network, faults));
    let at = at_node.and_then(|n| n.positive(Dimension::CONCENTRATION, faults));
    let by = match (by_node, at_node) {
        (None, None) => Some(None),
        (Some(_), Some(_)) => species.zip(at).map(Some),
        (given, _) => {
            let (missing, why) = match given {
                Some(_) => ("at", "the concentration at which the rate holds is missing"),
                None => ("by", "the species that makes the wall grow is missing"),
            };
            faults.at(&node.place, format!("growth: {why}"), format!("add \"{missing}: …\""));
            None
        }
    };
    let insert_at = fields.optional("insert_at").map_or(Some(1.5), |n| {
        let value = n.number(faults)?;
        if value > 1.1 && value <= 1.8 {
            return Some(value);
        }
        faults.at(
            &n.place,
            format!("particles would be put in at a stretch of {value}"),
            "give a stretch from 1.1 to 1.8: a wall stretched further leaks",
        );
        None
    });
    let reserve = fields.optional("reserve").map_or(Some(400), |n| n.count(faults).map(|n| n as usize));
    fields.finish(faults);
    closed(node, "growth", (group, d), faults);
    if mechanics == Mechanics::Dynamic {
        faults.at(
            &node.place,
            "a wall grows over times in which its oscillations are long gone",
            "add mechanics: { mode: quasi_static }",
        );
    }
    Some(Growth {
        rate: rate?,
        yield_stress: yield_stress?,
        by: by?,
        insert_at: insert_at?,
        reserve: reserve?,
    })
}

/// What needs an inside is refused where there is none.
fn closed(node: &Node, what: &str, (group, d): (&Group, usize), faults: &mut Faults) {
    if !is_wall(group, d) {
        faults.at(
            &node.place,
            format!("{what} needs a wall that encloses something, and `{}` is none", group.name),
            format!(
                "give the group the shape of a {}, e.g. shape: {{ {}: {{ centre: [...], inner: 4 um, outer: 5 um }} }}",
                if d == 3 { "spherical shell" } else { "ring" },
                if d == 3 { "shell" } else { "ring" }
            ),
        );
    }
}
