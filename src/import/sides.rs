//! Reactants and products of a reaction: whole numbers of the species that change.

use super::document::{Reaction, Reference};
use super::log::Log;
use super::polynomial::Meaning;
use super::system::System;
use super::values::Values;

/// One side: indices of variables and how many molecules of each.
pub(super) type Side = Vec<(usize, u32)>;

/// Stoichiometries above this are taken for a slip.
const MOST: f64 = 1000.0;

/// Reads both sides; species held constant drop out.
pub(super) fn read(
    reaction: &Reaction,
    system: &System,
    values: &mut Values,
    log: &mut Log,
) -> Option<(Side, Side)> {
    let left = side(&reaction.left, reaction, system, values, log);
    let right = side(&reaction.right, reaction, system, values, log);
    Some((left?, right?))
}

fn side(
    references: &[Reference],
    reaction: &Reaction,
    system: &System,
    values: &mut Values,
    log: &mut Log,
) -> Option<Side> {
    let mut out: Vec<(usize, f64)> = Vec::new();
    let mut fine = true;
    for reference in references {
        let Some(index) = system.variables.iter().position(|v| v.id == reference.species) else {
            if !system.sbml.species.iter().any(|s| s.id == reference.species) {
                let reason =
                    format!("reaction \"{}\": unknown species \"{}\"", reaction.id, reference.species);
                log.fault(reference.spot, reason, "declare it in listOfSpecies");
                fine = false;
            }
            continue;
        };
        match amount(reference, system, values, log) {
            Some(amount) => match out.iter_mut().find(|(i, _)| *i == index) {
                Some(same) => same.1 += amount,
                None => out.push((index, amount)),
            },
            None => fine = false,
        }
    }
    for &(index, amount) in &out {
        if amount < 0.0 || amount.fract() != 0.0 || amount > MOST {
            let spot = references.iter().find(|r| r.species == system.variables[index].id);
            log.fault(
                spot.map_or(reaction.spot, |r| r.spot),
                format!(
                    "reaction \"{}\" has {amount} of \"{}\": molecules are whole numbers from 0 to {MOST}",
                    reaction.id, system.variables[index].id
                ),
                "multiply all stoichiometries of the reaction by a number that makes them whole, and divide its law by it",
            );
            fine = false;
        }
    }
    out.retain(|(_, amount)| *amount != 0.0);
    fine.then(|| out.into_iter().map(|(index, amount)| (index, amount as u32)).collect())
}

/// The stoichiometry, from its number, its formula, or what is assigned to its id.
fn amount(reference: &Reference, system: &System, values: &mut Values, log: &mut Log) -> Option<f64> {
    let formula = match (&reference.formula, &reference.id) {
        (Some(math), _) => math.clone(),
        (None, Some(id)) => match system.sbml.rules.get(id).or_else(|| system.sbml.initial.get(id)) {
            Some(assignment) => assignment.math.clone(),
            None => return Some(reference.stoichiometry),
        },
        (None, None) => return Some(reference.stoichiometry),
    };
    let by_initial = reference.id.as_ref().is_some_and(|id| !system.sbml.rules.contains_key(id))
        && reference.formula.is_none();
    let written = system.written_out(&formula, reference.spot, log)?;
    // An initial assignment fixes a number for good; any other formula must not follow the amounts.
    if !by_initial && !system.is_constant(&written) {
        let reason = format!(
            "the stoichiometry of \"{}\" changes with the amounts, which is not supported",
            reference.species
        );
        log.fault(reference.spot, reason, "give a whole number");
        return None;
    }
    values.evaluate(&formula, log)
}
