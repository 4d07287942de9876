//! The `probes:` of an output: lines, rings and surfaces.

use super::conditions::{WallName, What, wall_named};
use super::domain::{Domain, ParticleDomain};
use super::names::{axis_name, group_index, pad, species_named};
use super::node::Node;
use super::reader::{Faults, Fields};
use crate::chemistry::Network;
use crate::quantity::Dimension;
use crate::quantity::readable::length;
use crate::vector::Vector;

/// A place where fields are read off.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    pub name: String,
    pub shape: ProbeShape,
    /// Species read off.
    pub species: Vec<usize>,
    /// Whether velocities are read off too.
    pub velocity: bool,
}

/// Where a probe looks.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbeShape {
    /// Points at equal distances, both ends included.
    Line { from: Vector<3>, to: Vector<3>, points: usize },
    /// Sectors of a ring (2D) in which the particles of a group are summed; angle 0 along +x, counter-clockwise.
    Ring { centre: Vector<3>, inner: f64, outer: f64, sectors: usize, group: Option<usize> },
    /// What passes a surface that holds, lets in or takes up molecules: net amount that enters, in time.
    Surface { wall: WallName },
}

/// Reads the probes of an output.
pub(super) fn read(node: &Node, domain: &Domain, network: &Network, faults: &mut Faults) -> Vec<Probe> {
    let Domain::Particles(particles) = domain else {
        faults.at(&node.place, "probes belong to a domain of kind particles", "remove them");
        return Vec::new();
    };
    let Some(fields) = Fields::of(node, "probes", faults) else { return Vec::new() };
    let mut found = Vec::new();
    for (key, node) in fields.entries() {
        let Some(mut fields) = Fields::of(node, "probe", faults) else { continue };
        let (line, ring) = (fields.optional("line"), fields.optional("ring"));
        let surface = fields.optional("surface");
        let species = match fields.optional("species") {
            None => Some((0..network.species.len()).collect()),
            Some(n) => n
                .list(faults)
                .map(|items| items.iter().filter_map(|item| species_named(item, network, faults)).collect()),
        };
        let velocity = match fields.optional("velocity") {
            None => Some(particles.fluid.is_some() && line.is_some()),
            Some(n) => n.boolean(faults),
        };
        fields.finish(faults);
        let shape = match (line, ring, surface) {
            (Some(n), None, None) => read_line(n, particles, faults),
            (None, Some(n), None) => read_ring(n, particles, domain, faults),
            (None, None, Some(n)) => read_surface(n, particles, faults),
            _ => {
                faults.at(
                    &node.place,
                    "a probe is a line, a ring or a surface",
                    "for example line: { from: [0, 0], to: [1 um, 0], points: 101 }",
                );
                None
            }
        };
        if let (Some(shape), Some(species), Some(velocity)) = (shape, species, velocity) {
            found.push(Probe { name: key.name.clone(), shape, species, velocity });
        }
    }
    found
}

fn read_surface(node: &Node, domain: &ParticleDomain, faults: &mut Faults) -> Option<ProbeShape> {
    let wall = wall_named(node, domain, faults)?;
    let acts = domain.conditions.iter().any(|condition| match &condition.what {
        What::HeldSurface { wall: at, .. }
        | What::Flux { wall: at, .. }
        | What::Absorbing { wall: at, .. } => *at == wall,
        _ => false,
    });
    if !acts {
        faults.at(
            &node.place,
            "no molecules pass this surface",
            "give it a condition: held (at: surface), flux or absorbing",
        );
        return None;
    }
    Some(ProbeShape::Surface { wall })
}

fn at_least(
    fields: &mut Fields,
    key: &'static str,
    least: i64,
    usual: usize,
    faults: &mut Faults,
) -> Option<usize> {
    let Some(n) = fields.optional(key) else { return Some(usual) };
    let value = n.integer(faults)?;
    if value < least || value > 1_000_000 {
        faults.at(&n.place, format!("{value} {key}"), format!("give a number from {least} to a million"));
        return None;
    }
    Some(value as usize)
}

fn read_line(node: &Node, domain: &ParticleDomain, faults: &mut Faults) -> Option<ProbeShape> {
    let d = domain.dimensions;
    let mut fields = Fields::of(node, "line", faults)?;
    let mut end = |key: &'static str, faults: &mut Faults| {
        let node = fields.required(key, faults)?;
        let x = pad(&node.vector(Dimension::LENGTH, d, faults)?);
        if outside(&x, domain) > 0.0 {
            faults.at(&node.place, format!("the line's end `{key}` lies outside the box"), box_words(domain));
        }
        Some(x)
    };
    let from = end("from", faults);
    let to = end("to", faults);
    let points = at_least(&mut fields, "points", 2, 101, faults);
    fields.finish(faults);
    Some(ProbeShape::Line { from: from?, to: to?, points: points? })
}

/// How far a place lies outside the box, m; up to a billionth of the box is rounding.
fn outside(x: &Vector<3>, domain: &ParticleDomain) -> f64 {
    let (min, max) = (&domain.min, &domain.max);
    let beyond: Vector<3> = Vector::from_fn(|k, _| (min[k] - x[k]).max(x[k] - max[k]).max(0.0));
    let far = beyond.norm();
    if far <= 1e-9 * (max - min).norm() { 0.0 } else { far }
}

fn box_words(domain: &ParticleDomain) -> String {
    let side =
        |k: usize| format!("{} from {} to {}", axis_name(k), length(domain.min[k]), length(domain.max[k]));
    let sides: Vec<String> = (0..domain.dimensions).map(side).collect();
    format!("move it into the box: {}", sides.join(", "))
}

fn read_ring(
    node: &Node,
    particles: &ParticleDomain,
    domain: &Domain,
    faults: &mut Faults,
) -> Option<ProbeShape> {
    let mut fields = Fields::of(node, "ring", faults)?;
    if particles.dimensions != 2 {
        faults.at(&node.place, "a ring probe needs 2 dimensions", "use a line");
        return None;
    }
    let centre = fields.required("centre", faults).and_then(|n| n.vector(Dimension::LENGTH, 2, faults));
    let inner = fields.required("inner", faults).and_then(|n| n.non_negative(Dimension::LENGTH, faults));
    let outer = fields.required("outer", faults).and_then(|n| n.positive(Dimension::LENGTH, faults));
    let sectors = at_least(&mut fields, "sectors", 3, 72, faults);
    let group = match fields.optional("in") {
        None => None,
        Some(n) => Some(group_index(n.text(faults)?, &n.place, &domain.group_names(), faults)?),
    };
    fields.finish(faults);
    let (centre, inner, outer) = (pad(&centre?), inner?, outer?);
    if inner >= outer {
        faults.at(
            &node.place,
            "the ring has no width: `inner` is not less than `outer`",
            "make `outer` larger",
        );
    }
    if outside(&centre, particles) > outer {
        faults.at(&node.place, "the ring lies outside the box", box_words(particles));
    }
    Some(ProbeShape::Ring { centre, inner, outer, sectors: sectors?, group })
}
