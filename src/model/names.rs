//! Names of axes, species and groups as a user writes them, and coordinates padded to three.

use super::node::Node;
use super::reader::{Faults, nearest};
use crate::chemistry::Network;
use crate::error::Place;
use crate::vector::Vector;

/// The name of a coordinate axis.
#[must_use]
pub fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}

/// The name of a side of the box, e.g. `x_min`.
#[must_use]
pub fn side_name(axis: usize, upper: bool) -> String {
    format!("{}_{}", axis_name(axis), if upper { "max" } else { "min" })
}

/// The species a node names, or a fault with the nearest known name.
pub fn species_named(node: &Node, network: &Network, faults: &mut Faults) -> Option<usize> {
    let name = node.text(faults)?;
    species_index(name, &node.place, network, faults)
}

/// The species of this name, or a fault with the nearest known name.
pub fn species_index(name: &str, place: &Place, network: &Network, faults: &mut Faults) -> Option<usize> {
    let found = network.species.iter().position(|species| species.name == name);
    if found.is_none() {
        let names: Vec<&str> = network.species.iter().map(|species| species.name.as_str()).collect();
        faults.at(place, format!("unknown species `{name}`"), did_you_mean(name, &names, "species"));
    }
    found
}

/// The group of this name, or a fault with the nearest known name.
pub fn group_index(name: &str, place: &Place, groups: &[String], faults: &mut Faults) -> Option<usize> {
    let found = groups.iter().position(|group| group == name);
    if found.is_none() && groups.is_empty() {
        faults.at(
            place,
            format!("unknown group `{name}`: a well-mixed volume has no groups"),
            "remove it, or choose a domain of kind graph or particles",
        );
    } else if found.is_none() {
        let names: Vec<&str> = groups.iter().map(String::as_str).collect();
        faults.at(place, format!("unknown group `{name}`"), did_you_mean(name, &names, "groups"));
    }
    found
}

fn did_you_mean(word: &str, known: &[&str], what: &str) -> String {
    match nearest(word, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`? The {what} are: {}", known.join(", ")),
        None => format!("the {what} are: {}", known.join(", ")),
    }
}

/// Coordinates padded with zeros to three.
#[must_use]
pub fn pad(x: &[f64]) -> Vector<3> {
    Vector::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0))
}
