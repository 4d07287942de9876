//! The `initial:` of a model: how much of what, where.

use super::domain::Domain;
use super::names::{group_index, pad, species_index};
use super::node::{Node, Value};
use super::reader::{Faults, Fields};
use crate::chemistry::law::{Expression, Program};
use crate::chemistry::{AVOGADRO, Network};
use crate::error::Place;
use crate::quantity::{Dimension, Quantity};
use crate::vector::Vector;

/// An amount as a user states it.
#[derive(Clone, Debug)]
pub enum Amount {
    /// Molecules in the volume, or in all of a group together.
    Molecules(f64),
    /// Molecules in every particle of a group.
    PerParticle(f64),
    /// mol/m³.
    Concentration(f64),
    /// mol/m³ as an expression of x, y, z (m).
    Field(Program),
    /// Molecules in the one particle nearest to a place.
    At(Vector<3>, f64),
}

/// How a mean is turned into whole molecules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deal {
    /// The same whole numbers in every realization, as even as can be.
    Even,
    /// An independent Poisson number in every particle and realization.
    Poisson,
}

/// One entry of `initial:`.
#[derive(Clone, Debug)]
pub struct Initial {
    /// Index of the group or volume; everywhere the species may live if `None`.
    pub group: Option<usize>,
    pub species: usize,
    pub amount: Amount,
    pub deal: Deal,
    pub place: Place,
}

/// Reads all initial amounts of a document.
pub fn read(node: Option<&Node>, domain: &Domain, network: &Network, faults: &mut Faults) -> Vec<Initial> {
    let Some(fields) = node.and_then(|node| Fields::of(node, "initial", faults)) else { return Vec::new() };
    let mut found = Vec::new();
    let groups = domain.group_names();
    for (key, value) in fields.entries() {
        let is_species = network.species.iter().any(|species| species.name == key.name);
        let by_group = matches!(&value.value, Value::Map(entries)
            if entries.iter().any(|(k, _)| network.species.iter().any(|s| s.name == k.name)));
        if is_species {
            entry(None, &key.name, &key.place, value, domain, network, faults, &mut found);
        } else if groups.contains(&key.name) || by_group {
            let Some(group) = group_index(&key.name, &key.place, &groups, faults) else { continue };
            let Some(inner) = Fields::of(value, &key.name, faults) else { continue };
            for (species, value) in inner.entries() {
                entry(Some(group), &species.name, &species.place, value, domain, network, faults, &mut found);
            }
        } else {
            // Neither: the message lists the species, the commoner case.
            species_index(&key.name, &key.place, network, faults);
        }
    }
    found
}

#[allow(clippy::too_many_arguments)] // one entry is just these
fn entry(
    group: Option<usize>,
    name: &str,
    place: &Place,
    value: &Node,
    domain: &Domain,
    network: &Network,
    faults: &mut Faults,
    found: &mut Vec<Initial>,
) {
    let Some(species) = species_index(name, place, network, faults) else { return };
    let mut push = |group, value: &Node, faults: &mut Faults| {
        let (dimensions, deal) = match domain {
            Domain::Particles(particles) => (particles.dimensions, deal(value, faults)),
            _ => (0, deal(value, faults)),
        };
        if let Some(amount) = amount(value, dimensions, network, faults) {
            found.push(Initial { group, species, amount, deal, place: value.place.clone() });
        }
    };
    match (&value.value, domain) {
        (Value::List(items), Domain::Graph { volumes, .. }) if group.is_none() => {
            if items.len() != volumes.len() {
                faults.at(
                    &value.place,
                    format!("{} amounts for {} volumes", items.len(), volumes.len()),
                    "give one amount, or one per volume",
                );
                return;
            }
            for (i, item) in items.iter().enumerate() {
                push(Some(i), item, faults);
            }
        }
        (_, Domain::Graph { names, .. }) if group.is_none() => {
            // One value goes for every volume in which the species may live.
            let only_in = network.species[species].only_in.as_ref();
            for (i, name) in names.iter().enumerate() {
                if only_in.is_none_or(|list| list.iter().any(|named| named.name == *name)) {
                    push(Some(i), value, faults);
                }
            }
        }
        _ => push(group, value, faults),
    }
}

fn deal(node: &Node, faults: &mut Faults) -> Deal {
    let Value::Map(entries) = &node.value else { return Deal::Even };
    entries
        .iter()
        .find(|(key, _)| key.name == "deal")
        .and_then(|(_, n)| n.choice(&[("even", Deal::Even), ("poisson", Deal::Poisson)], faults))
        .unwrap_or(Deal::Even)
}

/// Reads one amount: whole molecules, a concentration, an expression of position, or a mapping with one of
/// `molecules` (with `at`), `per_particle`, `concentration`.
pub fn amount(node: &Node, dimensions: usize, network: &Network, faults: &mut Faults) -> Option<Amount> {
    match &node.value {
        Value::Integer(_) | Value::Real(_) => molecules(node, faults).map(Amount::Molecules),
        Value::Text(text) => concentration(text, node, dimensions, network, faults),
        Value::Map(_) => {
            let mut fields = Fields::of(node, "amount", faults)?;
            let at = match fields.optional("at") {
                Some(n) => Some(pad(&n.vector(Dimension::LENGTH, dimensions, faults)?)),
                None => None,
            };
            fields.optional("deal");
            let total = fields.optional("molecules");
            let each = fields.optional("per_particle");
            let field = fields.optional("concentration");
            fields.finish(faults);
            match (total, each, field, at) {
                (Some(n), None, None, Some(place)) => Some(Amount::At(place, molecules(n, faults)?)),
                (Some(n), None, None, None) => Some(Amount::Molecules(molecules(n, faults)?)),
                (None, Some(n), None, None) => Some(Amount::PerParticle(molecules(n, faults)?)),
                (None, None, Some(n), None) => amount(n, dimensions, network, faults),
                _ => {
                    faults.at(
                        &node.place,
                        "an amount is one of: molecules (perhaps with at), per_particle, concentration",
                        "for example { molecules: 100, at: [5 um, 5 um] }",
                    );
                    None
                }
            }
        }
        _ => {
            faults.at(
                &node.place,
                "an amount was expected",
                "a whole number of molecules, or a concentration such as 20 nM",
            );
            None
        }
    }
}

/// A bare number: whole, not negative.
fn molecules(node: &Node, faults: &mut Faults) -> Option<f64> {
    let value = node.number(faults)?;
    if value < 0.0 || value.fract() != 0.0 || value > 9.0e15 {
        faults.at(
            &node.place,
            format!("expected a whole number of molecules from 0 to 9e15, found {}", node.plain()),
            "a bare number counts whole molecules, zero or more; for a concentration add a unit, e.g. 20 nM",
        );
        return None;
    }
    Some(value)
}

fn concentration(
    text: &str,
    node: &Node,
    dimensions: usize,
    network: &Network,
    faults: &mut Faults,
) -> Option<Amount> {
    if let Ok(quantity) = Quantity::parse(text) {
        if quantity.dimension == Dimension::AMOUNT {
            let count = quantity.value * AVOGADRO;
            if count < 0.0 || (count - count.round()).abs() > 1e-6 {
                faults.at(
                    &node.place,
                    format!("{count} molecules"),
                    "molecules are whole numbers, zero or more",
                );
                return None;
            }
            return Some(Amount::Molecules(count.round()));
        }
        if quantity.dimension.is_none() {
            faults.at(
                &node.place,
                format!("the text \"{text}\" has no unit"),
                "a concentration has one, e.g. 20 nM; a whole number of molecules is written without quotes",
            );
            return None;
        }
        return node.non_negative(Dimension::CONCENTRATION, faults).map(Amount::Concentration);
    }
    let axes = ["x", "y", "z"].map(|name| (name, Dimension::LENGTH));
    let looks_like_quantity = text.trim_start().starts_with(|c: char| c.is_ascii_digit() || c == '.')
        && !text.contains(['*', '(', '+'])
        || dimensions == 0;
    if looks_like_quantity {
        // Let the reader of quantities say what is wrong.
        return node.non_negative(Dimension::CONCENTRATION, faults).map(Amount::Concentration);
    }
    let compiled = Expression::parse(text, &node.place).map_err(|fault| vec![fault]).and_then(|expression| {
        expression.compile(&axes[..dimensions], &network.parameters, Dimension::CONCENTRATION)
    });
    // Bare numbers fit any dimension, so an expression of them alone would be taken for mol/m³.
    let bare =
        !names_a_unit(text) && network.parameters.iter().all(|(name, _)| !text.contains(name.as_str()));
    match compiled {
        Ok(_) if bare => {
            faults.at(
                &node.place,
                "the expression has no unit; expected a concentration",
                "multiply by one, e.g. 100 nM * exp(-x / (1 um))",
            );
            None
        }
        Ok(program) => Some(Amount::Field(program)),
        Err(found) => {
            faults.list.extend(found);
            None
        }
    }
}

/// Whether some word of a text is a unit that counts moles, such as `uM` or `mol/m^3`.
fn names_a_unit(text: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric())
        .filter(|word| word.starts_with(char::is_alphabetic))
        .filter_map(|word| Quantity::parse(&format!("1 {word}")).ok())
        .any(|quantity| quantity.dimension.0[4] != 0)
}
