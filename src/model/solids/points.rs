//! `output.points`: material points of elastic solids that are followed.

use crate::model::domain::{Domain, ParticleDomain};
use crate::model::groups::Material;
use crate::model::names::{group_index, pad};
use crate::model::node::{Node, Value};
use crate::model::reader::{Faults, Fields};
use crate::quantity::Dimension;
use crate::vector::Vector;

/// A material point that is followed: where it is in the solid at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub name: String,
    pub group: usize,
    /// m.
    pub at: Vector<3>,
}

/// `points: { tip: { solid: rod, at: [102.5 um, 50 um] } }`.
pub(in crate::model) fn read(node: &Node, domain: &Domain, faults: &mut Faults) -> Vec<Point> {
    let Domain::Particles(domain) = domain else {
        faults.at(&node.place, "points belong to a domain of kind particles", "remove them");
        return Vec::new();
    };
    let Some(fields) = Fields::of(node, "points", faults) else { return Vec::new() };
    let mut found = Vec::new();
    for (key, node) in fields.entries() {
        if domain.groups.iter().any(|group| group.name == key.name) {
            faults.at(
                &key.place,
                format!("the name `{}` is that of a group", key.name),
                "give the point another name",
            );
        }
        found.extend(point(&key.name, node, domain, faults));
    }
    found
}

fn point(name: &str, node: &Node, domain: &ParticleDomain, faults: &mut Faults) -> Option<Point> {
    let mut fields = Fields::of(node, &format!("point `{name}`"), faults)?;
    let names: Vec<String> = domain.groups.iter().map(|group| group.name.clone()).collect();
    let group = fields.required("solid", faults).and_then(|n| {
        let group = group_index(n.text(faults)?, &n.place, &names, faults)?;
        let of = &domain.groups[group];
        if of.material != Material::Solid && !of.unread {
            faults.at(&n.place, format!("group `{}` is no elastic solid", of.name), "name a solid");
            return None;
        }
        Some(group)
    });
    let at = fields.required("at", faults);
    let place = at.and_then(|n| n.vector(Dimension::LENGTH, domain.dimensions, faults));
    fields.finish(faults);
    let (group, place) = (group?, pad(&place?));
    if domain.solids.iter().any(|solid| solid.group == group && solid.growth.is_some()) {
        faults.at(
            &node.place,
            format!(
                "the point `{name}` is in a wall that grows, whose particles at rest do not stay the same"
            ),
            "remove it: length, width and direction of the wall are in the table of probes",
        );
        return None;
    }
    let of = &domain.groups[group];
    // On its surface is in it, up to rounding and the ends of a lattice.
    if !of.unread && of.shape.signed_distance(&place) > 0.5 * of.spacing {
        faults.at(
            &at?.place,
            format!("the point `{name}` lies outside `{}` at rest", of.name),
            "give a place of the undeformed solid",
        );
        return None;
    }
    Some(Point { name: name.into(), group, at: place })
}

/// What solids and points show stands beside the probes, under their names.
pub(in crate::model) fn check_names(
    probes: Option<&Node>,
    points: &[Point],
    domain: &Domain,
    faults: &mut Faults,
) {
    let (Some(Node { value: Value::Map(probes), .. }), Domain::Particles(domain)) = (probes, domain) else {
        return;
    };
    for (key, _) in probes {
        let solid = domain.groups.iter().any(|g| g.material == Material::Solid && g.name == key.name);
        let what = match points.iter().any(|point| point.name == key.name) {
            _ if solid => "a solid",
            true => "a point",
            false => continue,
        };
        faults.at(&key.place, format!("the name `{}` is that of {what}", key.name), "rename the probe");
    }
}
