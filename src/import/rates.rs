//! Kinetic laws -> mass action or rate laws, one or two directions.
//!
//! A law of SBML is extent per time: with ν molecules in a unit of extent and τ s in one of time, a law v makes
//! ν v / τ events per s. A mass-action law κ Π s^p in numbers s = X / m (m molecules add one to s) has the
//! propensity (ν/τ) κ Π X … (X-p+1) / m^p.

use super::document::Reaction;
use super::log::{Log, Spot};
use super::math::{Math, Operation};
use super::polynomial::{Meaning, Powers, Term, expand, falling, significant};
use super::sides::{self, Side};
use super::split::{Sign, sign, split, sum};
use super::system::System;
use super::units::Quantity;
use super::values::Values;
use crate::chemistry::AVOGADRO;

/// Highest order of a mass-action reaction in a reactions file.
const HIGHEST_ORDER: u32 = 3;

/// One direction of a reaction, its rate in the kinetics of the reactions file.
#[derive(Debug)]
pub(super) struct Direction {
    pub name: String,
    pub left: Side,
    pub right: Side,
    pub rate: Rate,
    /// Where the law stands.
    pub spot: Spot,
}

/// The rate is `factor` times a formula in the numbers of the file.
#[derive(Debug)]
pub(super) enum Rate {
    /// Formula of constants.
    MassAction { factor: f64, constant: Math },
    /// Formula of constants and species; each symbol of a species stands for `per_variable` times what it
    /// is in the reactions file.
    Law { factor: f64, math: Math },
}

/// A reaction with units and rules worked in.
pub(super) struct Prepared<'a> {
    reaction: &'a Reaction,
    left: Side,
    right: Side,
    law: Math,
    /// Events per s in one unit of the law.
    events: f64,
    /// Compartments of all species it changes or reads.
    pub compartments: Vec<usize>,
}

/// How rates are to be given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// `kinetics: molecules`.
    Molecules,
    /// `kinetics: concentration`; a reaction's species share a compartment.
    Concentration,
}

/// Works out sides, law and units of a reaction; `None` after a fault, or if it changes nothing.
pub(super) fn prepare<'a>(
    reaction: &'a Reaction,
    system: &System,
    values: &mut Values,
    log: &mut Log,
) -> Option<Prepared<'a>> {
    let (left, right) = sides::read(reaction, system, values, log)?;
    let law = system.written_out(reaction.law.as_ref()?, reaction.law_spot, log)?;
    let (mut sorted_left, mut sorted_right) = (left.clone(), right.clone());
    sorted_left.sort_unstable();
    sorted_right.sort_unstable();
    if sorted_left == sorted_right {
        log.note(format!("reaction \"{}\" changes no amount: left out", reaction.id));
        return None;
    }
    let extent = reaction.substance_units.as_deref().or(system.sbml.defaults.extent.as_deref());
    let molecules = match (system.substance, extent) {
        (Some(unit), _) => unit.size * system.scale,
        (None, Some(name)) => {
            system.units.measure(Some(name), Quantity::Substance, reaction.law_spot, log).size * system.scale
        }
        (None, None) => system.molecules,
    };
    for &(index, _) in left.iter().chain(&right) {
        check_extent(reaction, index, molecules, system, log);
    }
    let second = match &reaction.time_units {
        Some(name) => system.units.measure(Some(name), Quantity::Time, reaction.law_spot, log).size,
        None => system.second,
    };
    let mut compartments: Vec<usize> =
        left.iter().chain(&right).map(|&(index, _)| system.variables[index].compartment).collect();
    law.symbols(&mut |symbol| compartments.extend(system.variable(symbol).map(|v| v.compartment)));
    compartments.sort_unstable();
    compartments.dedup();
    Some(Prepared { reaction, left, right, law, events: molecules / second, compartments })
}

/// Amounts of a species must go by the unit of the law, else a reaction would not change it by whole molecules.
fn check_extent(reaction: &Reaction, index: usize, extent: f64, system: &System, log: &mut Log) {
    let variable = &system.variables[index];
    let species = system.sbml.species.iter().find(|s| s.id == variable.id);
    let conversion = species.and_then(|s| s.conversion.as_ref()).or(system.sbml.defaults.conversion.as_ref());
    let factor = conversion.map_or(Some(1.0), |id| system.constant(id)).unwrap_or(f64::NAN);
    let ratio = variable.molecules * factor / extent;
    // Units are products of a few rounded numbers.
    if ratio.is_nan() || (ratio - 1.0).abs() > 1e-9 {
        let reason = format!(
            "reaction \"{}\": one unit of its rate is {ratio:e} units of \"{}\", not one",
            reaction.id, variable.id
        );
        let remedy = "give rate and species the same unit of amount (or a conversionFactor between the two)";
        log.fault(variable.spot, reason, remedy);
    }
}

/// The directions of a prepared reaction.
pub(super) fn directions(prepared: &Prepared, form: Form, system: &System, log: &mut Log) -> Vec<Direction> {
    let Prepared { reaction, left, right, law, .. } = prepared;
    let id = &reaction.id;
    if let Some(whole) = mass_action(prepared, law, (left, right), id, form, system, log) {
        return vec![whole];
    }
    if sign(law, system) == Sign::Plus {
        return vec![by_law(prepared, law, (left, right), id, form, system)];
    }
    let products: Vec<&str> = right.iter().map(|&(i, _)| system.variables[i].id.as_str()).collect();
    let makes = |term: &Math| products.is_empty() || term.mentions(&|symbol| products.contains(&symbol));
    let parts = split(law, system).filter(|(_, backward)| backward.iter().all(makes));
    let Some((forward, backward)) = parts else {
        if reaction.reversible && !products.is_empty() && makes(law) {
            log.fault(
                reaction.law_spot,
                format!("the net rate of the reversible reaction \"{id}\" cannot be told apart into its two directions"),
                "write it as forward minus backward rate, each zero or more, or as two reactions: chance acts on each direction by itself",
            );
        } else {
            log.note(format!(
                "the law of \"{id}\" may become negative: a run in which it does stops and says so"
            ));
        }
        return vec![by_law(prepared, law, (left, right), id, form, system)];
    };
    let mut found = Vec::new();
    for (terms, sides, name) in
        [(forward, (left, right), id.clone()), (backward, (right, left), format!("{id}_reverse"))]
    {
        let Some(rate) = sum(terms) else { continue };
        let mass = mass_action(prepared, &rate, sides, &name, form, system, log);
        found.push(mass.unwrap_or_else(|| by_law(prepared, &rate, sides, &name, form, system)));
    }
    found
}

/// The direction by mass action, if its law is of that form.
fn mass_action(
    prepared: &Prepared,
    law: &Math,
    (left, right): (&Side, &Side),
    name: &str,
    form: Form,
    system: &System,
    log: &mut Log,
) -> Option<Direction> {
    let terms = significant(expand(law, system)?);
    let per_value = |id: &str| system.variable(id).map_or(1.0, |v| v.molecules_per_value);
    let term: &Term = match terms.as_slice() {
        [one] => one,
        // k S (S - 1) in amounts is mass action as it is said for single molecules.
        several => {
            let (powers, _) = falling(several, &|id| per_value(id).recip())?;
            let powers: Powers = powers.into_iter().filter(|(_, power)| *power > 0).collect();
            several.iter().find(|t| t.powers == powers)?
        }
    };
    if term.value < 0.0 {
        return None;
    }
    let (left, right) = with_catalysts(&term.powers, left, right, system)?;
    let order: u32 = left.iter().map(|&(_, nu)| nu).sum();
    if order > HIGHEST_ORDER {
        return None;
    }
    if terms.len() == 1 && left.iter().any(|&(_, nu)| nu > 1) {
        log.note(format!(
            "\"{name}\": the law of bulk amounts, k S^2, is read as mass action: single molecules meet as S (S - 1)"
        ));
    }
    let mut factor = prepared.events;
    for (id, &power) in &term.powers {
        factor /= per_value(id).powi(power as i32);
    }
    match form {
        Form::Molecules => {
            factor *= left.iter().flat_map(|&(_, nu)| 1..=nu).map(f64::from).product::<f64>();
        }
        Form::Concentration => factor *= molar(prepared, system).powi(order as i32 - 1),
    }
    let (scalar, constant) = split_constant(&term.constant, system);
    let rate = Rate::MassAction { factor: factor * scalar, constant };
    Some(Direction { name: name.to_string(), left, right, rate, spot: prepared.reaction.law_spot })
}

/// Both sides with species that only speed the reaction up; `None` if exponents and reactants do not fit.
fn with_catalysts(powers: &Powers, left: &Side, right: &Side, system: &System) -> Option<(Side, Side)> {
    let power = |index: usize| powers.get(&system.variables[index].id).copied().unwrap_or(0);
    if left.iter().any(|&(index, nu)| power(index) != nu) {
        return None;
    }
    let (mut left, mut right) = (left.clone(), right.clone());
    for (index, variable) in system.variables.iter().enumerate() {
        if power(index) == 0 || left.iter().any(|&(i, _)| i == index) {
            continue;
        }
        // A square of a species that stays is a formula rather than a meeting of molecules.
        if powers.get(&variable.id) != Some(&1) {
            return None;
        }
        left.push((index, 1));
        match right.iter_mut().find(|(i, _)| *i == index) {
            Some(same) => same.1 += 1,
            None => right.push((index, 1)),
        }
    }
    Some((left, right))
}

fn by_law(
    prepared: &Prepared,
    law: &Math,
    (left, right): (&Side, &Side),
    name: &str,
    form: Form,
    system: &System,
) -> Direction {
    let (scalar, math) = split_constant(law, system);
    let per = match form {
        Form::Molecules => 1.0,
        Form::Concentration => molar(prepared, system),
    };
    let rate = Rate::Law { factor: prepared.events * scalar / per, math };
    Direction {
        name: name.to_string(),
        left: left.clone(),
        right: right.clone(),
        rate,
        spot: prepared.reaction.law_spot,
    }
}

/// What the symbol of a species stands for, over what it is in the reactions file.
pub(super) fn per_variable(index: usize, form: Form, system: &System) -> f64 {
    let variable = &system.variables[index];
    match form {
        Form::Molecules => variable.molecules_per_value.recip(),
        Form::Concentration => {
            AVOGADRO * system.compartments[variable.compartment].volume / variable.molecules_per_value
        }
    }
}

/// N_A V of the compartment in which a reaction happens.
fn molar(prepared: &Prepared, system: &System) -> f64 {
    let compartment = prepared.compartments.first().copied().unwrap_or(0);
    AVOGADRO * system.compartments[compartment].volume
}

/// Numbers and compartment sizes among the factors of a formula, multiplied up; and the rest.
fn split_constant(math: &Math, system: &System) -> (f64, Math) {
    let mut scalar = 1.0;
    let rest = without_scalars(math, &mut scalar, false, system);
    (scalar, rest.unwrap_or(Math::Number(1.0)))
}

fn without_scalars(math: &Math, scalar: &mut f64, below: bool, system: &System) -> Option<Math> {
    let size = |symbol: &str| {
        let is_size = system.sbml.compartments.iter().any(|c| c.id == symbol);
        is_size.then(|| system.constant(symbol)).flatten()
    };
    let mut take = |value: f64| {
        if below {
            *scalar /= value;
        } else {
            *scalar *= value;
        }
    };
    match math {
        Math::Number(value) => take(*value),
        Math::Symbol(symbol) => match size(symbol) {
            Some(value) => take(value),
            None => return Some(math.clone()),
        },
        Math::Apply(Operation::Multiply, parts) => {
            let mut rest: Vec<Math> =
                parts.iter().filter_map(|part| without_scalars(part, scalar, below, system)).collect();
            return if rest.len() > 1 { Some(Math::Apply(Operation::Multiply, rest)) } else { rest.pop() };
        }
        Math::Apply(Operation::Divide, parts) if parts.len() == 2 => {
            let above = without_scalars(&parts[0], scalar, below, system);
            let under = without_scalars(&parts[1], scalar, !below, system);
            return match (above, under) {
                (above, None) => above,
                (above, Some(under)) => {
                    Some(Math::two(Operation::Divide, above.unwrap_or(Math::Number(1.0)), under))
                }
            };
        }
        Math::Apply(Operation::Negate, parts) if parts.len() == 1 => {
            *scalar = -*scalar;
            return without_scalars(&parts[0], scalar, below, system);
        }
        Math::Apply(..) => return Some(math.clone()),
    }
    None
}
