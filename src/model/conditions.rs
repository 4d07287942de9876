//! The `conditions:` of a model: sponges, held values, sources, barriers, moving walls, forces;
//! what happens at surfaces.

mod bodies;
mod buoyancy;
mod held;
mod open;
mod surface;

pub use bodies::FreeBody;
pub use buoyancy::Expansion;
pub use open::EndModel;

use super::domain::{Boundary, ParticleDomain};
use super::fluid::field::{self, Field};
use super::groups::Material;
use super::initial::{self, Amount, Deal};
use super::names::{axis_name, group_index, pad, species_index};
use super::node::{Node, Value};
use super::reader::{Faults, Fields};
use crate::chemistry::{Kinetics, Network};
use crate::error::Place;
use crate::quantity::Dimension;
use crate::quantity::readable::length;
use crate::vector::Vector;

/// A named condition on the domain.
#[derive(Clone, Debug)]
pub struct Condition {
    pub name: String,
    pub place: Place,
    pub what: What,
}

/// What a condition does. Groups and species by index.
#[derive(Clone, Debug)]
pub enum What {
    /// Draws velocity and amounts of what passes through towards a state, at a rate (1/s).
    Sponge { group: usize, rate: f64, velocity: Option<Vector<3>>, species: Vec<(usize, Amount)> },
    /// Keeps amounts at a value: a reservoir.
    Held { group: usize, species: Vec<(usize, Amount)>, deal: Deal },
    /// Makes molecules at a rate: mol/m³/s, or molecules/s in each particle by the network's kinetics.
    Source { group: usize, species: Vec<(usize, f64)> },
    /// A plane across an axis that no molecule passes by diffusion.
    Barrier { axis: usize, at: f64 },
    /// A wall that moves.
    MovingWall { wall: WallName, motion: WallMotion },
    /// A rigid body that moves with the forces of the fluid.
    FreeBody { group: usize, body: FreeBody },
    /// Particles enter or leave at an end of an open axis; what enters carries these concentrations.
    Open { axis: usize, upper: bool, end: EndModel, species: Vec<(usize, Amount)> },
    /// An acceleration of all fluid, m/s².
    Force { acceleration: Vector<3> },
    /// Concentrations make the fluid lighter or heavier; gravity in m/s².
    Buoyancy { gravity: Vector<3>, species: Vec<Expansion> },
    /// Keeps concentrations (mol/m³) at a surface.
    HeldSurface { wall: WallName, species: Vec<(usize, f64)> },
    /// Molecules enter through a surface, molecules/(m² s).
    Flux { wall: WallName, species: Vec<(usize, f64)> },
    /// A surface takes molecules up at κ (m/s) times their concentration at it; infinite if it takes all.
    Absorbing { wall: WallName, species: Vec<(usize, f64)> },
}

/// A wall: a group, or a side of the box (`x_min`, `x_max`, `y_min`, …).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallName {
    Group(usize),
    Side { axis: usize, upper: bool },
}

/// How a wall moves.
#[derive(Clone, Debug, PartialEq)]
pub enum WallMotion {
    /// The surface moves along itself, the particles stay (a belt, a lid); m/s.
    Belt(Vector<3>),
    /// The whole wall travels; m/s.
    Travel(Vector<3>),
    /// Velocity amplitude (m/s) times sin(2π frequency t): starts from rest; frequency in 1/s.
    Oscillate { velocity: Vector<3>, frequency: f64 },
    /// About a centre (2D: about z); rad/s.
    Rotate { centre: Vector<3>, rate: f64, axis: Vector<3> },
    /// Particles displaced by a function of place and time, m.
    Deform(Field),
}

/// Reads all conditions of a document.
pub fn read(node: &Node, domain: &ParticleDomain, network: &Network, faults: &mut Faults) -> Vec<Condition> {
    let Some(fields) = Fields::of(node, "conditions", faults) else { return Vec::new() };
    let mut found = Vec::new();
    for (key, node) in fields.entries() {
        let Value::Map(kinds) = &node.value else {
            faults.at(&node.place, "a condition is a mapping with one key, its kind", KINDS);
            continue;
        };
        let [(kind, body)] = kinds.as_slice() else {
            faults.at(&node.place, format!("a condition has one kind; here are {}", kinds.len()), KINDS);
            continue;
        };
        let what = match kind.name.as_str() {
            "sponge" => sponge(body, domain, network, faults),
            "held" => held::held(body, domain, network, faults),
            "source" => source(body, domain, network, faults),
            "barrier" => barrier(body, domain, faults),
            "moving_wall" => moving_wall(body, domain, network, faults),
            "free_body" => bodies::free_body(body, domain, network, faults),
            "open" => open::open(body, domain, network, faults),
            "force" => force(body, domain, faults),
            "buoyancy" => buoyancy::buoyancy(body, domain, network, faults),
            "flux" => surface::flux(body, domain, network, faults),
            "absorbing" => surface::absorbing(body, domain, network, faults),
            other => {
                faults.at(&kind.place, format!("unknown condition `{other}`"), KINDS);
                None
            }
        };
        if let Some(what) = what {
            found.push(Condition { name: key.name.clone(), place: key.place.clone(), what });
        }
    }
    found
}

const KINDS: &str = "kinds are: sponge, held, source, barrier, moving_wall, free_body, open, force, buoyancy, flux, absorbing";

/// Whether the ends of an open axis are described; `at` says which axes are open.
pub(super) fn check_ends(node: Option<&Node>, domain: &ParticleDomain, at: &Node, faults: &mut Faults) {
    open::check(node, domain, &domain.conditions, at, faults);
}

fn group(fields: &mut Fields, domain: &ParticleDomain, faults: &mut Faults) -> Option<usize> {
    let node = fields.required("in", faults)?;
    let names: Vec<String> = domain.groups.iter().map(|group| group.name.clone()).collect();
    group_index(node.text(faults)?, &node.place, &names, faults)
}

fn amounts(
    fields: &mut Fields,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Vec<(usize, Amount)> {
    let Some(node) = fields.optional("species") else { return Vec::new() };
    let Some(species) = Fields::of(node, "species", faults) else { return Vec::new() };
    let mut found = Vec::new();
    for (key, value) in species.entries() {
        let index = species_index(&key.name, &key.place, network, faults);
        let amount = initial::amount(value, domain.dimensions, network, faults);
        if let (Some(index), Some(amount)) = (index, amount) {
            found.push((index, amount));
        }
    }
    found
}

fn sponge(node: &Node, domain: &ParticleDomain, network: &Network, faults: &mut Faults) -> Option<What> {
    let mut fields = Fields::of(node, "sponge", faults)?;
    let group = group(&mut fields, domain, faults);
    let rate = fields.required("rate", faults).and_then(|n| n.positive(Dimension::RATE, faults));
    let velocity = match fields.optional("velocity") {
        Some(n) if domain.fluid.is_none() => {
            faults.at(
                &n.place,
                "a velocity is that of a fluid, and none moves here",
                "describe it by `fluid:`, or remove this",
            );
            None
        }
        Some(n) => Some(pad(&n.vector(Dimension::VELOCITY, domain.dimensions, faults)?)),
        None => None,
    };
    let species = amounts(&mut fields, domain, network, faults);
    fields.finish(faults);
    for (_, amount) in &species {
        if !matches!(amount, Amount::Concentration(_) | Amount::Field(_)) {
            faults.at(
                &node.place,
                "a sponge draws towards a concentration",
                "give it with a unit, e.g. L: 1 uM",
            );
            return None;
        }
    }
    Some(What::Sponge { group: group?, rate: rate?, velocity, species })
}

fn source(node: &Node, domain: &ParticleDomain, network: &Network, faults: &mut Faults) -> Option<What> {
    let mut fields = Fields::of(node, "source", faults)?;
    let group = group(&mut fields, domain, faults);
    let species_node = fields.required("species", faults);
    fields.finish(faults);
    let dimension = match network.kinetics {
        Kinetics::Concentration => Dimension::CONCENTRATION / Dimension::TIME,
        Kinetics::Molecules => Dimension::RATE,
    };
    let mut species = Vec::new();
    for (key, value) in Fields::of(species_node?, "species", faults)?.entries() {
        let index = species_index(&key.name, &key.place, network, faults);
        let rate = value.non_negative(dimension, faults);
        if let (Some(index), Some(rate)) = (index, rate) {
            species.push((index, rate));
        }
    }
    Some(What::Source { group: group?, species })
}

fn barrier(node: &Node, domain: &ParticleDomain, faults: &mut Faults) -> Option<What> {
    let mut fields = Fields::of(node, "barrier", faults)?;
    let axis =
        fields.required("axis", faults).and_then(|n| n.choice(&[("x", 0), ("y", 1), ("z", 2)], faults));
    let at = fields.required("at", faults).and_then(|n| n.quantity(Dimension::LENGTH, faults));
    fields.finish(faults);
    let (axis, at) = (axis?, at?);
    if axis >= domain.dimensions || at < domain.min[axis] || at > domain.max[axis] {
        faults.at(
            &node.place,
            format!("the barrier across {} at {} lies outside the box", axis_name(axis), length(at)),
            "it must cut the box",
        );
        return None;
    }
    Some(What::Barrier { axis, at })
}

fn moving_wall(node: &Node, domain: &ParticleDomain, network: &Network, faults: &mut Faults) -> Option<What> {
    let d = domain.dimensions;
    let mut fields = Fields::of(node, "moving_wall", faults)?;
    let wall = solid_wall(&mut fields, domain, faults);
    if let Some(n) = fields.optional("displacement") {
        let displacement = field::read(n, d, Dimension::LENGTH, network, faults);
        return deforming(wall?, displacement?, (node, n), domain, faults);
    }
    let velocity = match fields.optional("velocity") {
        Some(n) => Some(pad(&n.vector(Dimension::VELOCITY, d, faults)?)),
        None => None,
    };
    let travels = match fields.optional("travels") {
        Some(n) => n.boolean(faults)?,
        None => false,
    };
    let frequency = match fields.optional("frequency") {
        Some(n) => Some(n.positive(Dimension::RATE, faults)?),
        None => None,
    };
    let rotation = match fields.optional("rotation") {
        Some(n) => Some(n.quantity(Dimension::RATE, faults)?),
        None => None,
    };
    let centre = match fields.optional("centre") {
        Some(n) => Some(pad(&n.vector(Dimension::LENGTH, d, faults)?)),
        None => None,
    };
    let axis = match fields.optional("axis") {
        Some(n) if d != 3 => {
            faults.at(
                &n.place,
                "an axis of rotation needs 3 dimensions",
                "remove it; in the plane walls turn about z",
            );
            return None;
        }
        Some(n) => {
            let axis = pad(&n.vector(Dimension::NONE, d, faults)?);
            if axis.norm() == 0.0 {
                faults.at(&n.place, "the axis of rotation is zero", "it is a direction, e.g. [0, 0, 1]");
                return None;
            }
            axis
        }
        None => Vector::from([0.0, 0.0, 1.0]),
    };
    fields.finish(faults);
    if domain.fluid.is_none() {
        faults.at(
            &node.place,
            "a wall that moves drives a fluid, and none moves here",
            "describe it by `fluid:`, or remove this",
        );
        return None;
    }
    let wall = wall?;
    let motion = match (velocity, frequency, rotation) {
        (Some(velocity), None, None) if travels => WallMotion::Travel(velocity),
        (Some(velocity), None, None) => WallMotion::Belt(velocity),
        (Some(velocity), Some(frequency), None) => WallMotion::Oscillate { velocity, frequency },
        (None, None, Some(rate)) => {
            let Some(centre) = centre.or_else(|| middle(wall, domain)) else {
                faults.at(
                    &node.place,
                    "a rotation needs a centre: the shape of the wall has no middle",
                    "for example { in: rotor, rotation: 10 1/s, centre: [0, 0] }",
                );
                return None;
            };
            WallMotion::Rotate { centre, rate, axis: axis.normalize() }
        }
        _ => {
            faults.at(
                &node.place,
                "a moving wall has a velocity (and perhaps a frequency), a rotation, or a displacement",
                "for example { in: lid, velocity: [1 mm/s, 0] } or { in: rotor, rotation: 10 1/s, centre: [0, 0] }",
            );
            return None;
        }
    };
    if let WallName::Side { axis, .. } = wall {
        let leaves = match &motion {
            WallMotion::Belt(velocity)
            | WallMotion::Travel(velocity)
            | WallMotion::Oscillate { velocity, .. } => velocity[axis] != 0.0,
            WallMotion::Rotate { .. } => true,
            WallMotion::Deform(_) => false,
        };
        if leaves {
            faults.at(
                &node.place,
                "a side of the box can only move along itself",
                "the box stays where it is; make the wall a group with a shape of its own",
            );
            return None;
        }
    }
    Some(What::MovingWall { wall, motion })
}

/// The middle of the shape of a group, m, where that has one.
fn middle(wall: WallName, domain: &ParticleDomain) -> Option<Vector<3>> {
    let WallName::Group(g) = wall else { return None };
    let reach = |k: usize| domain.groups[g].shape.reach(k);
    let ends = (0..domain.dimensions).map(reach);
    let middle =
        Vector::from_fn(|k, _| if k < domain.dimensions { 0.5 * (reach(k).0 + reach(k).1) } else { 0.0 });
    ends.into_iter().all(|(low, high)| low.is_finite() && high.is_finite()).then_some(middle)
}

/// A wall whose particles are displaced.
fn deforming(
    wall: WallName,
    displacement: Field,
    (node, at): (&Node, &Node),
    domain: &ParticleDomain,
    faults: &mut Faults,
) -> Option<What> {
    let Value::Map(entries) = &node.value else { return None };
    if let Some((key, _)) = entries.iter().find(|(key, _)| key.name != "in" && key.name != "displacement") {
        faults.at(
            &key.place,
            format!("`{}` does not go with `displacement`", key.name),
            "a displacement says all of the motion: remove one of the two",
        );
        return None;
    }
    if let WallName::Side { axis, .. } = wall
        && displacement.constant(axis) != Some(0.0)
    {
        faults.at(
            &at.place,
            format!("a side of the box cannot be displaced along {}", axis_name(axis)),
            "let a group of material: wall stand before the side, and displace that",
        );
        return None;
    }
    if domain.fluid.is_none() {
        faults.at(&node.place, "a wall deforms in a fluid, and none moves here", "add the section `fluid:`");
        return None;
    }
    Some(What::MovingWall { wall, motion: WallMotion::Deform(displacement) })
}

/// The wall that a node names: a group, or a side of the box that is not periodic.
pub(super) fn wall_named(node: &Node, domain: &ParticleDomain, faults: &mut Faults) -> Option<WallName> {
    let name = node.text(faults)?;
    for axis in 0..domain.dimensions {
        for upper in [false, true] {
            if name == format!("{}_{}", axis_name(axis), if upper { "max" } else { "min" }) {
                if domain.boundaries[axis] == Boundary::Periodic {
                    faults.at(
                        &node.place,
                        format!("the box is periodic along {}; there is no wall", axis_name(axis)),
                        "set the boundary to no_slip or free_slip",
                    );
                    return None;
                }
                if domain.boundaries[axis] == Boundary::Open {
                    faults.at(
                        &node.place,
                        format!("the box is open along {}; there is no wall", axis_name(axis)),
                        "say what enters and leaves there by `open: { at: ..., ... }`",
                    );
                    return None;
                }
                return Some(WallName::Side { axis, upper });
            }
        }
    }
    let names: Vec<String> = domain.groups.iter().map(|group| group.name.clone()).collect();
    Some(WallName::Group(group_index(name, &node.place, &names, faults)?))
}

/// The wall that `in` names, made of wall particles.
fn solid_wall(fields: &mut Fields, domain: &ParticleDomain, faults: &mut Faults) -> Option<WallName> {
    let node = fields.required("in", faults)?;
    let wall = wall_named(node, domain, faults)?;
    if let WallName::Group(g) = wall
        && !matches!(domain.groups[g].material, Material::Wall { .. })
    {
        faults.at(
            &node.place,
            format!("group `{}` is no wall", domain.groups[g].name),
            match domain.groups[g].material {
                Material::Solid | Material::Surface => {
                    "an elastic solid is moved by solids: driven, or by the fluid; name a wall"
                }
                _ => "set its material: wall",
            },
        );
        return None;
    }
    Some(wall)
}

fn force(node: &Node, domain: &ParticleDomain, faults: &mut Faults) -> Option<What> {
    let mut fields = Fields::of(node, "force", faults)?;
    let acceleration = fields
        .required("acceleration", faults)
        .and_then(|n| n.vector(Dimension::ACCELERATION, domain.dimensions, faults));
    fields.finish(faults);
    if domain.fluid.is_none() {
        faults.at(
            &node.place,
            "a force moves a fluid, and none moves here",
            "describe it by `fluid:`, or remove this",
        );
        return None;
    }
    Some(What::Force { acceleration: pad(&acceleration?) })
}
