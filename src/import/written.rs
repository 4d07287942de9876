//! Directions and constants as the texts of a reactions file, each checked by the reader of rate expressions.

use super::law_text::{NoWord, number, text, tidy};
use super::log::Log;
use super::math::{Math, Operation};
use super::polynomial::Meaning;
use super::rates::{Direction, Form, Rate, per_variable};
use super::sides::Side;
use super::system::{System, label};
use crate::chemistry::formula::equation_words;
use crate::chemistry::law::Expression;
use crate::quantity::{Dimension, Quantity};
use std::collections::BTreeMap;

/// A reaction of the reactions file.
#[derive(Debug)]
pub(super) struct Entry {
    pub name: String,
    pub equation: String,
    /// The key, `rate` or `law`, and its text.
    pub key: &'static str,
    pub rate: String,
    /// Of the other direction, in an equation with `<->`.
    pub reverse: Option<String>,
}

/// A parameter of the reactions file.
#[derive(Debug)]
pub(super) struct Constant {
    pub label: String,
    pub text: String,
    /// Its number in the SBML file, where that is another one.
    pub was: Option<f64>,
}

/// The texts of a network.
#[derive(Debug)]
pub(super) struct Network {
    pub reactions: Vec<Entry>,
    pub parameters: Vec<Constant>,
}

/// What a parameter is, if it is the constant of mass action and nothing else: factor and order.
type Direct = Option<(f64, u32)>;

impl Network {
    pub fn new(system: &System, directions: &[Direction], form: Form, log: &mut Log) -> Option<Network> {
        let uses = uses(system, directions);
        let mut reactions: Vec<Entry> = Vec::new();
        for (at, direction) in directions.iter().enumerate() {
            let mut name = direction.name.clone();
            while reactions.iter().any(|r| r.name == name)
                || name != direction.name && directions.iter().any(|d| d.name == name)
            {
                name.push('_');
            }
            let (Rate::MassAction { factor, .. } | Rate::Law { factor, .. }) = &direction.rate;
            if !factor.is_finite() {
                let reason = format!("a constant factor of the law of \"{name}\" is not finite");
                log.fault(direction.spot, reason, "look for a division by zero");
                continue;
            }
            let equation = equation(&direction.left, &direction.right, system);
            let found = match &direction.rate {
                Rate::MassAction { factor, constant } => {
                    let order = direction.left.iter().map(|&(_, nu)| nu).sum();
                    let rate = mass_action(*factor, constant, order, &uses, direction, system, form, log);
                    rate.map(|rate| ("rate", rate))
                }
                Rate::Law { factor, math } => {
                    law(*factor, math, direction, system, form, log).map(|law| ("law", law))
                }
            };
            // After a fault the others are still looked at.
            let Some((key, rate)) = found else { continue };
            if key == "rate" && turns_back(at, directions) {
                // Mass action both ways is one pair.
                if let Some(last) = reactions.last_mut() {
                    last.equation = last.equation.replacen("->", "<->", 1);
                    last.reverse = Some(rate);
                }
                continue;
            }
            reactions.push(Entry { name, equation, key, rate, reverse: None });
        }
        let parameters = uses.iter().map(|(id, direct)| constant(id, *direct, system, form)).collect();
        log.faults.is_empty().then_some(Network { reactions, parameters })
    }
}

/// Whether a direction is the way back of the one before it, both by mass action.
fn turns_back(at: usize, directions: &[Direction]) -> bool {
    let Some(before) = at.checked_sub(1).map(|k| &directions[k]) else { return false };
    let here = &directions[at];
    let mass = |d: &Direction| matches!(d.rate, Rate::MassAction { .. });
    here.name == format!("{}_reverse", before.name)
        && mass(before)
        && mass(here)
        && (&here.left, &here.right) == (&before.right, &before.left)
}

/// Every constant that a rate mentions, and what it is.
fn uses(system: &System, directions: &[Direction]) -> BTreeMap<String, Direct> {
    let mut uses: BTreeMap<String, Direct> = BTreeMap::new();
    let mut meet = |id: &str, direct: Direct| {
        uses.entry(id.to_string())
            .and_modify(|known| *known = known.filter(|k| Some(*k) == direct))
            .or_insert(direct);
    };
    for direction in directions {
        match &direction.rate {
            Rate::MassAction { factor, constant: Math::Symbol(id) } => {
                let order = direction.left.iter().map(|&(_, nu)| nu).sum();
                meet(id, Some((tidy(*factor), order)));
            }
            Rate::MassAction { constant: math, .. } | Rate::Law { math, .. } => {
                worded(math, system).symbols(&mut |id| {
                    if !system.varies(id) {
                        meet(id, None);
                    }
                });
            }
        }
    }
    uses
}

fn constant(id: &str, direct: Direct, system: &System, form: Form) -> Constant {
    let value = system.constant(id).unwrap_or(f64::NAN);
    let label = label(id, system.sbml);
    match direct {
        Some((factor, order)) => {
            let (unit, in_unit) = rate_unit(form, order);
            let here = tidy(value * factor * in_unit);
            let was = (here != value).then_some(value);
            Constant { label, text: format!("{} {unit}", number(here)), was }
        }
        None => Constant { label, text: number(value), was: None },
    }
}

/// A unit for constants of mass action, and how many of it are one in SI.
fn rate_unit(form: Form, order: u32) -> (&'static str, f64) {
    match (form, order) {
        (Form::Molecules, _) | (_, 1) => ("1/s", 1.0),
        (_, 0) => ("M/s", 1e-3),
        (_, 2) => ("/M/s", 1e3),
        _ => ("/M^2/s", 1e6),
    }
}

#[allow(clippy::too_many_arguments)] // a rate in its surroundings
fn mass_action(
    factor: f64,
    constant: &Math,
    order: u32,
    uses: &BTreeMap<String, Direct>,
    direction: &Direction,
    system: &System,
    form: Form,
    log: &mut Log,
) -> Option<String> {
    let factor = tidy(factor);
    match constant {
        Math::Number(value) => {
            let (unit, in_unit) = rate_unit(form, order);
            return Some(format!("{} {unit}", number(tidy(factor * value * in_unit))));
        }
        Math::Symbol(id) if uses.get(id).is_some_and(Option::is_some) => return Some(label(id, system.sbml)),
        _ => {}
    }
    let whole = scaled(factor, worded(constant, system));
    let plain = |id: &str| (label(id, system.sbml), false);
    let expected = match form {
        Form::Molecules => Dimension::RATE,
        Form::Concentration => Dimension::rate_constant(order),
    };
    let found = text(&whole, &plain);
    checked(found, &[], expected, direction, system, log)
}

fn law(
    factor: f64,
    math: &Math,
    direction: &Direction,
    system: &System,
    form: Form,
    log: &mut Log,
) -> Option<String> {
    let whole = scaled(tidy(factor), worded(math, system));
    let (variable, expected) = match form {
        Form::Molecules => (Dimension::NONE, Dimension::RATE),
        Form::Concentration => (Dimension::CONCENTRATION, Dimension::CONCENTRATION_RATE),
    };
    let variables: Vec<(&str, Dimension)> =
        system.variables.iter().map(|v| (v.label.as_str(), variable)).collect();
    // With a written number before it a species fits any dimension, as numbers of SBML do.
    let spelled = |always: bool| {
        text(&whole, &|id: &str| {
            let index = system.variables.iter().position(|v| v.id == id);
            let unit = index.map_or(1.0, |index| tidy(per_variable(index, form, system)));
            let label = label(id, system.sbml);
            if index.is_some() && (always || unit != 1.0) {
                (format!("{} * {label}", number(unit)), true)
            } else {
                (label, false)
            }
        })
    };
    let plain = spelled(false);
    let fits = plain
        .as_ref()
        .is_ok_and(|found| compiles(found, &variables, expected, direction, system, log).is_ok());
    checked(if fits { plain } else { spelled(true) }, &variables, expected, direction, system, log)
}

/// The text if the reader of rate expressions takes it; else a fault at the law.
fn checked(
    found: Result<String, NoWord>,
    variables: &[(&str, Dimension)],
    expected: Dimension,
    direction: &Direction,
    system: &System,
    log: &mut Log,
) -> Option<String> {
    let name = &direction.name;
    let found = match found {
        Ok(found) => found,
        Err(NoWord(word)) => {
            let reason = format!("the law of \"{name}\" needs {word} of an amount, which is not supported");
            log.fault(direction.spot, reason, "write it with exp, ln, powers, min, max or piecewise");
            return None;
        }
    };
    match compiles(&found, variables, expected, direction, system, log) {
        Ok(()) => Some(found),
        Err(reason) => {
            let reason = format!("the law of \"{name}\" cannot be written as a rate expression: {reason}");
            log.fault(direction.spot, reason, "simplify it, or compute parts of it as parameters");
            None
        }
    }
}

fn compiles(
    found: &str,
    variables: &[(&str, Dimension)],
    expected: Dimension,
    direction: &Direction,
    system: &System,
    log: &Log,
) -> Result<(), String> {
    let constants: Vec<(String, Quantity)> =
        system.constants.iter().map(|(id, value)| (label(id, system.sbml), Quantity::bare(*value))).collect();
    let expression = Expression::parse(found, &log.place(direction.spot)).map_err(|fault| fault.reason)?;
    match expression.compile(variables, &constants, expected) {
        Ok(program) if program.constant().is_some_and(|value| value < 0.0 || !value.is_finite()) => {
            Err("it is negative or not finite".to_string())
        }
        Ok(_) => Ok(()),
        Err(faults) => Err(faults.into_iter().next().map(|fault| fault.reason).unwrap_or_default()),
    }
}

fn scaled(factor: f64, math: Math) -> Math {
    match math {
        Math::Number(value) => Math::Number(factor * value),
        math if factor == 1.0 => math,
        Math::Apply(Operation::Multiply, mut parts) => {
            parts.insert(0, Math::Number(factor));
            Math::Apply(Operation::Multiply, parts)
        }
        // f * (a / b) is (f * a) / b, with fewer parentheses.
        Math::Apply(Operation::Divide, mut parts) if parts.len() == 2 => {
            parts[0] = scaled(factor, parts[0].clone());
            Math::Apply(Operation::Divide, parts)
        }
        math => Math::two(Operation::Multiply, Math::Number(factor), math),
    }
}

/// Constant parts that rate expressions have no word for become numbers.
fn worded(math: &Math, system: &System) -> Math {
    let Math::Apply(operation, arguments) = math else { return math.clone() };
    let wordless = matches!(
        operation,
        Operation::Floor
            | Operation::Ceiling
            | Operation::Factorial
            | Operation::Arcsin
            | Operation::Arccos
            | Operation::Arctan
    );
    if wordless
        && system.is_constant(math)
        && let Some(value) = system.value(math)
    {
        return Math::Number(value);
    }
    Math::Apply(operation.clone(), arguments.iter().map(|a| worded(a, system)).collect())
}

fn equation(left: &Side, right: &Side, system: &System) -> String {
    let named = |side: &Side| -> Vec<(&str, u32)> {
        side.iter().map(|&(index, nu)| (system.variables[index].label.as_str(), nu)).collect()
    };
    equation_words(&named(left), &named(right))
}
