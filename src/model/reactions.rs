//! The reactions file: species, parameters, reactions -> a checked [`Network`].

mod rates;

use crate::chemistry::formula::{Formula, Term, equation_words};
use crate::chemistry::law::function_names;
use crate::chemistry::network::{Kinetics, Named, Network, Reaction, Representation, Species};
use crate::error::{Fault, Place};
use crate::model::node::{Key, Node, Value};
use crate::model::reader::{Faults, Fields, did_you_mean};
use crate::quantity::{Dimension, Quantity};
use rates::Rates;

/// Highest order of a mass-action reaction.
const HIGHEST_ORDER: u32 = 3;

/// Reads a reactions file, or the same mapping inside a model.
///
/// Every fault is pushed and reading goes on. What could be read comes back even then, so that the rest of a
/// model can be checked against the species; it may only be run if `faults` is empty.
pub fn read(node: &Node, faults: &mut Faults) -> Option<Network> {
    let mut fields = Fields::of(node, "reactions", faults)?;
    let name = fields.optional("name").and_then(|n| n.text(faults)).unwrap_or("reactions").to_string();
    if let Some(description) = fields.optional("description") {
        description.text(faults);
    }
    let kinetics = fields.optional("kinetics").and_then(|n| n.choice(KINETICS, faults));
    let kinetics = kinetics.unwrap_or(Kinetics::Concentration);
    let species_node = fields.required("species", faults);
    let species_place = fields.key_place("species").unwrap_or(fields.place());
    let species = species_node.map(|n| read_species(n, faults)).unwrap_or_default();
    let parameters = fields.optional("parameters").map(|n| read_parameters(n, &species, faults));
    let parameters = parameters.unwrap_or_default();
    let mut reactions = Vec::new();
    if let Some(list) = fields.optional("reactions").and_then(|n| Fields::of(n, "reactions", faults)) {
        let scope = Scope { kinetics, species: &species, parameters: &parameters, species_place };
        for (key, entry) in list.entries() {
            let read: Vec<Reaction> = read_reaction(key, entry, &scope, faults).unwrap_or_default();
            for reaction in read {
                // The backward direction of a pair may be called like another reaction.
                let repeated = list.entries().iter().filter(|(k, _)| k.name == key.name).count() > 1;
                if !repeated && reactions.iter().any(|r: &Reaction| r.name == reaction.name) {
                    faults.at(&key.place, format!("\"{}\" is given twice", reaction.name), "rename one");
                }
                reactions.push(reaction);
            }
        }
    }
    fields.finish(faults);
    species_node?;
    Some(Network { name, kinetics, species, parameters, reactions })
}

const KINETICS: &[(&str, Kinetics)] =
    &[("concentration", Kinetics::Concentration), ("molecules", Kinetics::Molecules)];

/// What the reactions of a file may refer to.
struct Scope<'a> {
    kinetics: Kinetics,
    species: &'a [Species],
    parameters: &'a [(String, Quantity)],
    /// Where species are declared.
    species_place: &'a Place,
}

/// `species: { A: { diffusion: … }, B: }`, or a list of names where nothing is to be said of them.
fn read_species(node: &Node, faults: &mut Faults) -> Vec<Species> {
    let mut all: Vec<Species> = Vec::new();
    if let Value::List(items) = &node.value {
        for item in items {
            let Some(name) = item.name(faults) else { continue };
            let key = Key { name: name.to_string(), place: item.place.clone() };
            if let Some(first) = all.iter().find(|s| s.name == name) {
                let remedy = format!("the first is on line {}", first.place.line);
                faults.at(&item.place, format!("\"{name}\" is given twice"), remedy);
            } else if allowed(&key, "species", faults) {
                all.push(plain_species(&key));
            }
        }
        return all;
    }
    let Some(fields) = Fields::of(node, "species", faults) else { return all };
    if fields.entries().is_empty() {
        faults.at(&node.place, "no species are declared", "write e.g. A: { diffusion: 100 um^2/s }");
    }
    for (key, entry) in fields.entries() {
        let mut species = plain_species(key);
        if entry.value != Value::Null
            && let Some(mut of) = Fields::of(entry, &format!("species \"{}\"", key.name), faults)
        {
            let diffusion = of.optional("diffusion");
            species.diffusion = diffusion
                .and_then(|n| n.non_negative(Dimension::DIFFUSIVITY, faults))
                .unwrap_or(species.diffusion);
            species.only_in = of.optional("only_in").and_then(|n| read_groups(n, faults));
            species.representation =
                of.optional("representation").and_then(|n| n.choice(&Representation::NAMED, faults));
            of.finish(faults);
        }
        if allowed(key, "species", faults) && !all.iter().any(|s| s.name == key.name) {
            all.push(species);
        }
    }
    all
}

fn plain_species(key: &Key) -> Species {
    Species {
        name: key.name.clone(),
        diffusion: 0.0,
        only_in: None,
        representation: None,
        place: key.place.clone(),
    }
}

/// Whether a species or parameter may be called this.
fn allowed(key: &Key, what: &str, faults: &mut Faults) -> bool {
    let name = &key.name;
    if !crate::model::reader::is_name(name) {
        let remedy = "a name starts with a letter or \"_\" and goes on with letters, digits or \"_\"";
        faults.at(&key.place, format!("\"{name}\" is no name of a {what}"), remedy);
        return false;
    }
    if function_names().contains(&name.as_str()) {
        let reason = format!("\"{name}\" is a function of rate expressions and no name of a {what}");
        faults.at(&key.place, reason, format!("call it e.g. \"{name}_\""));
        return false;
    }
    true
}

/// One group name or a list of them.
fn read_groups(node: &Node, faults: &mut Faults) -> Option<Vec<Named>> {
    let items = match &node.value {
        Value::List(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    if items.is_empty() {
        faults.at(&node.place, "an empty list of groups", "leave \"only_in\" out for everywhere");
        return None;
    }
    let mut groups: Vec<Named> = Vec::new();
    for item in items {
        let name = match &item.value {
            // Volumes of a graph are named after their index unless they have a name.
            Value::Integer(index) if *index >= 0 => index.to_string(),
            _ => match item.text(faults) {
                Some(text) => text.to_string(),
                None => continue,
            },
        };
        if !groups.iter().any(|group| group.name == name) {
            groups.push(Named { name, place: item.place.clone() });
        }
    }
    (!groups.is_empty()).then_some(groups)
}

fn read_parameters(node: &Node, species: &[Species], faults: &mut Faults) -> Vec<(String, Quantity)> {
    let mut all: Vec<(String, Quantity)> = Vec::new();
    let Some(fields) = Fields::of(node, "parameters", faults) else { return all };
    for (key, entry) in fields.entries() {
        let quantity = entry.any_quantity(faults);
        if let Some(same) = species.iter().find(|s| s.name == key.name) {
            let at = &same.place;
            let remedy =
                format!("rename one; the species is at {}:{}:{}", at.source.path, at.line, at.column);
            faults.at(&key.place, format!("\"{}\" is a species and a parameter", key.name), remedy);
        } else if allowed(key, "parameter", faults) && !all.iter().any(|(name, _)| *name == key.name) {
            // A parameter with a fault stays known, so that its uses are not reported as well.
            all.push((key.name.clone(), quantity.unwrap_or(Quantity::bare(1.0))));
        }
    }
    all
}

/// The one or two directions of a declared reaction; `None` if anything is wrong with it.
fn read_reaction(key: &Key, node: &Node, scope: &Scope, faults: &mut Faults) -> Option<Vec<Reaction>> {
    let before = faults.list.len();
    let what = format!("reaction \"{}\"", key.name);
    let mut fields = Fields::of(node, &what, faults)?;
    if key.name.trim().is_empty() {
        faults.at(
            &key.place,
            "a reaction without a name",
            "write a name before the colon, e.g. binding: { … }",
        );
    }
    let equation = fields.required("equation", faults);
    let written = Rates {
        rate: fields.optional("rate"),
        reverse: fields.optional("reverse"),
        law: fields.optional("law"),
    };
    let only_in = fields.optional("only_in").and_then(|n| read_groups(n, faults));
    if let Some(description) = fields.optional("description") {
        description.text(faults);
    }
    fields.finish(faults);
    let Some(equation) = equation else {
        written.check_alone(&what, &key.place, scope, faults);
        return None;
    };
    let text = equation.text(faults)?;
    let formula = match Formula::parse(text) {
        Ok(formula) => formula,
        Err(fault) => {
            let place = equation.place.inside(fault.offset, fault.width);
            faults.push(Fault::at(&place, format!("{what}: {}", fault.reason), fault.remedy));
            written.check_alone(&what, &key.place, scope, faults);
            return None;
        }
    };
    let left = resolve(&formula.left, &what, equation, scope, faults);
    let right = resolve(&formula.right, &what, equation, scope, faults);
    if written.law.is_none() {
        for (side, direction) in [(&formula.left, "rate"), (&formula.right, "reverse")] {
            if direction == "rate" || formula.reversible {
                check_order(side, &what, equation, faults);
            }
        }
    }
    let order = |side: &[Term]| side.iter().map(|t| t.multiplicity).fold(0, u32::saturating_add);
    let orders = (order(&formula.left), order(&formula.right));
    let (forward, backward) = written.read(&what, key, equation, &formula, orders, scope, faults);
    let (left, right) = (left?, right?);
    let direction = |name: String, from: &[(usize, u32)], to: &[(usize, u32)], rate| Reaction {
        name,
        equation: words(from, to, scope.species),
        reactants: from.to_vec(),
        products: to.to_vec(),
        rate,
        only_in: only_in.clone(),
        place: key.place.clone(),
    };
    let mut sorted = (left.clone(), right.clone());
    sorted.0.sort_unstable();
    sorted.1.sort_unstable();
    if sorted.0 == sorted.1 {
        let place = equation.place.inside(0, text.chars().count());
        let reason = format!("{what} changes nothing: both sides are the same");
        faults.at(&place, reason, "remove it, or correct the equation");
    }
    if faults.list.len() > before {
        return None;
    }
    let mut reactions = vec![direction(key.name.clone(), &left, &right, forward?)];
    if let Some(rate) = backward {
        reactions.push(direction(format!("{} (reverse)", key.name), &right, &left, rate));
    }
    Some(reactions)
}

fn words(from: &[(usize, u32)], to: &[(usize, u32)], species: &[Species]) -> String {
    let named = |side: &[(usize, u32)]| -> Vec<(&str, u32)> {
        side.iter().map(|&(s, nu)| (species[s].name.as_str(), nu)).collect()
    };
    equation_words(&named(from), &named(to))
}

/// Species of one side by index; `None` if one is unknown.
fn resolve(
    side: &[Term],
    what: &str,
    equation: &Node,
    scope: &Scope,
    faults: &mut Faults,
) -> Option<Vec<(usize, u32)>> {
    let mut out = Vec::new();
    let mut known = true;
    for term in side {
        if let Some(index) = scope.species.iter().position(|s| s.name == term.name) {
            out.push((index, term.multiplicity));
            continue;
        }
        known = false;
        let near = did_you_mean(&term.name, scope.species.iter().map(|s| s.name.as_str()));
        let at = scope.species_place;
        let declared = format!("species are declared in {}:{}", at.source.path, at.line);
        let remedy = if near.is_empty() { declared } else { format!("{near} {declared}") };
        // The name without its multiplicity.
        let width = term.name.chars().count();
        let place = equation.place.inside(term.offset + term.width - width, width);
        faults.at(&place, format!("{what}: unknown species \"{}\"", term.name), remedy);
    }
    known.then_some(out)
}

fn check_order(side: &[Term], what: &str, equation: &Node, faults: &mut Faults) {
    let order = side.iter().map(|t| t.multiplicity).fold(0, u32::saturating_add);
    if order > HIGHEST_ORDER
        && let (Some(first), Some(last)) = (side.first(), side.last())
    {
        let place = equation.place.inside(first.offset, last.offset + last.width - first.offset);
        faults.at(
            &place,
            format!("{what} is of order {order}; mass action goes up to {HIGHEST_ORDER}"),
            "split it into elementary steps, or give a \"law\"",
        );
    }
}

#[cfg(test)]
pub(crate) mod tests;
