//! Solids that the fluid moves.

use super::{WallName, What, solid_wall};
use crate::chemistry::Network;
use crate::model::domain::ParticleDomain;
use crate::model::names::pad;
use crate::model::node::Node;
use crate::model::reader::{Faults, Fields};
use crate::quantity::Dimension;
use crate::vector::Vector;

/// A rigid body that moves with the forces of the fluid, as it is at t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeBody {
    /// kg/m³.
    pub density: f64,
    /// m/s.
    pub velocity: Vector<3>,
    /// rad/s.
    pub rate: Vector<3>,
    /// Besides that of `force`, m/s².
    pub acceleration: Vector<3>,
}

/// `free_body: { in: bead, density: 1050 kg/m^3, velocity: [1 mm/s, 0], rotation: 10 1/s, acceleration: [0, -1 m/s^2] }`
pub(super) fn free_body(
    node: &Node,
    domain: &ParticleDomain,
    _network: &Network,
    faults: &mut Faults,
) -> Option<What> {
    let d = domain.dimensions;
    let mut fields = Fields::of(node, "free_body", faults)?;
    let place = fields.optional("in").map_or(&node.place, |n| &n.place).clone();
    let wall = solid_wall(&mut fields, domain, faults);
    let density = fields.required("density", faults).and_then(|n| n.positive(Dimension::DENSITY, faults));
    let mut vector = |fields: &mut Fields, key: &'static str, dimension| match fields.optional(key) {
        Some(n) => n.vector(dimension, d, faults).map(|x| pad(&x)),
        None => Some(Vector::zeros()),
    };
    let velocity = vector(&mut fields, "velocity", Dimension::VELOCITY);
    let acceleration = vector(&mut fields, "acceleration", Dimension::ACCELERATION);
    let rate = match fields.optional("rotation") {
        // In the plane about z; in space along the axis, or a vector.
        Some(n) if d == 3 => n.vector(Dimension::RATE, d, faults).map(|x| pad(&x)),
        Some(n) => n.quantity(Dimension::RATE, faults).map(|rate| Vector::from([0.0, 0.0, rate])),
        None => Some(Vector::zeros()),
    };
    fields.finish(faults);
    let WallName::Group(group) = wall? else {
        faults.at(
            &place,
            "a side of the box cannot move freely",
            "name a group of material: wall with a shape of its own",
        );
        return None;
    };
    if domain.groups[group].shape == crate::geometry::Shape::EverythingElse {
        faults.at(
            &place,
            format!("`{}` has no shape of its own, so it is no body", domain.groups[group].name),
            "give the group a shape, e.g. shape: { disc: { centre: [...], radius: ... } }",
        );
        return None;
    }
    if domain.fluid.is_none() {
        faults.at(
            &node.place,
            "a free body is moved by a fluid, and none moves here",
            "add the section `fluid:`",
        );
        return None;
    }
    let body = FreeBody { density: density?, velocity: velocity?, rate: rate?, acceleration: acceleration? };
    Some(What::FreeBody { group, body })
}
