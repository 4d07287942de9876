//! `rate`, `reverse` and `law` of a reaction -> [`Rate`], with the dimension its order asks for.

use super::Scope;
use crate::chemistry::formula::Formula;
use crate::chemistry::law::{Expression, Program};
use crate::chemistry::network::{Kinetics, Rate};
use crate::error::{Fault, Place};
use crate::model::node::{Key, Node, Value};
use crate::model::reader::Faults;
use crate::quantity::{Dimension, Quantity};

/// The rates of a reaction as written.
pub(super) struct Rates<'a> {
    pub rate: Option<&'a Node>,
    pub reverse: Option<&'a Node>,
    pub law: Option<&'a Node>,
}

impl Rates<'_> {
    /// Rates of both directions; `None` after a fault, and for a direction that does not exist.
    #[allow(clippy::too_many_arguments)] // The reaction around it in full, for messages.
    pub fn read(
        &self,
        what: &str,
        key: &Key,
        equation: &Node,
        formula: &Formula,
        orders: (u32, u32),
        scope: &Scope,
        faults: &mut Faults,
    ) -> (Option<Rate>, Option<Rate>) {
        self.consistent(what, &key.place, faults);
        match self.reverse {
            Some(reverse) if !formula.reversible => {
                let reason = format!("{what}: \"reverse\" belongs to an equation with \"<->\"");
                faults.at(&reverse.place, reason, "write <-> in the equation, or remove \"reverse\"");
            }
            None if formula.reversible && self.law.is_none() => {
                let reason = format!("{what}: an equation with \"<->\" needs \"reverse\"");
                faults.at(&equation.place, reason, "add \"reverse: …\", or write -> for one direction");
            }
            _ => {}
        }
        if let Some(law) = self.law {
            if formula.reversible {
                let reason = format!("{what}: a law belongs to one direction");
                faults.at(&law.place, reason, "write two reactions with ->, each with its own law");
            }
            return (read_law(law, what, scope, faults).map(Rate::Law), None);
        }
        let forward = self.rate.and_then(|n| constant(n, what, Some(orders.0), scope, faults));
        let backward = self.reverse.and_then(|n| constant(n, what, Some(orders.1), scope, faults));
        (forward.map(Rate::MassAction), backward.map(Rate::MassAction))
    }

    /// Checks what can be checked of the rates where the equation could not be read.
    pub fn check_alone(&self, what: &str, place: &Place, scope: &Scope, faults: &mut Faults) {
        self.consistent(what, place, faults);
        for node in [self.rate, self.reverse].into_iter().flatten() {
            constant(node, what, None, scope, faults);
        }
        if let Some(law) = self.law {
            read_law(law, what, scope, faults);
        }
    }

    fn consistent(&self, what: &str, place: &Place, faults: &mut Faults) {
        match (self.rate.or(self.reverse), self.rate, self.law) {
            (Some(rate), _, Some(_)) => {
                let reason = format!("{what} has a rate and a law");
                faults.at(&rate.place, reason, "keep \"rate\" for mass action or \"law\" for an expression");
            }
            (_, None, None) => {
                faults.at(place, format!("{what}: \"rate\" is missing"), "add \"rate: …\" or \"law: …\"");
            }
            _ => {}
        }
    }
}

/// A rate constant: a number, a quantity, a parameter, or an expression of parameters. Without `order` only
/// the text is checked.
fn constant(node: &Node, what: &str, order: Option<u32>, scope: &Scope, faults: &mut Faults) -> Option<f64> {
    let expected = order.map(|order| match scope.kinetics {
        Kinetics::Concentration => Dimension::rate_constant(order),
        Kinetics::Molecules => Dimension::RATE,
    });
    let value = match &node.value {
        Value::Text(text) => rate_text(node, text, what, order, expected, scope, faults)?,
        _ => node.number(faults)?,
    };
    if value < 0.0 || !value.is_finite() {
        let reason = format!("{what}: a rate may not be negative, found {}", node.plain());
        faults.at(&node.place, reason, "for the other direction use <-> and \"reverse\"");
        return None;
    }
    Some(value)
}

fn rate_text(
    node: &Node,
    text: &str,
    what: &str,
    order: Option<u32>,
    expected: Option<Dimension>,
    scope: &Scope,
    faults: &mut Faults,
) -> Option<f64> {
    let wrong = |found: Dimension| {
        let expected = expected.filter(|expected| *expected != found)?;
        let why = match (scope.kinetics, order) {
            (Kinetics::Concentration, Some(order)) => format!("the rate constant of order {order}"),
            _ => "a rate per combination of molecules (kinetics: molecules)".to_string(),
        };
        let reason = format!("{what}: found {found}, expected {expected} for {why}");
        let remedy = format!("give it in a unit like {}, or correct the equation", expected.unit());
        Some(Fault::at(&node.place, reason, remedy))
    };
    let as_quantity = Quantity::parse(text);
    if let Ok(quantity) = as_quantity {
        let bare = text.trim().parse::<f64>().is_ok();
        if let Some(fault) = wrong(quantity.dimension).filter(|_| !bare) {
            faults.push(fault);
            return None;
        }
        return Some(quantity.value);
    }
    if let Some((_, quantity)) = scope.parameters.iter().find(|(name, _)| name == text.trim()) {
        // A parameter without a unit is SI like any bare number.
        if let Some(fault) = wrong(quantity.dimension).filter(|_| !quantity.dimension.is_none()) {
            faults.push(fault);
            return None;
        }
        return Some(quantity.value);
    }
    let parsed = Expression::parse(text, &node.place);
    // A number followed by a misspelt unit is meant as a quantity, one with a parameter in it as an expression.
    if let Err(fault) = as_quantity {
        let numeric = text.trim_start().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        let mentions =
            |name: &str| text.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|w| w == name);
        if numeric && !text.contains(" * ") && !scope.parameters.iter().any(|(name, _)| mentions(name)) {
            let place = node.place.inside(fault.offset, fault.width);
            faults.push(Fault::at(&place, format!("{what}: {}", fault.reason), fault.remedy));
            return None;
        }
    }
    let compiled = parsed.map_err(|fault| vec![fault]).and_then(|expression| {
        if let Some(species) = scope.species.iter().find(|s| expression.names().contains(&s.name.as_str())) {
            let reason = format!("{what}: \"rate\" depends on the species \"{}\"", species.name);
            return Err(vec![Fault::at(
                &node.place,
                reason,
                "mass action is implied; for other laws use \"law\"",
            )]);
        }
        match expected {
            Some(expected) => expression.compile(&[], scope.parameters, expected).map(Some),
            None => Ok(None),
        }
    });
    match compiled {
        Ok(program) => program.and_then(|program| program.constant()),
        Err(list) => {
            list.into_iter().for_each(|fault| faults.push(named(fault, what)));
            None
        }
    }
}

fn named(fault: Fault, what: &str) -> Fault {
    if fault.reason.starts_with(what) {
        fault
    } else {
        Fault { reason: format!("{what}: {}", fault.reason), ..fault }
    }
}

/// A law: mol/m³/s of concentrations, or 1/s of counts.
fn read_law(node: &Node, what: &str, scope: &Scope, faults: &mut Faults) -> Option<Program> {
    let (variable, expected) = match scope.kinetics {
        Kinetics::Concentration => (Dimension::CONCENTRATION, Dimension::CONCENTRATION_RATE),
        Kinetics::Molecules => (Dimension::NONE, Dimension::RATE),
    };
    let program = match &node.value {
        Value::Text(text) => {
            let variables: Vec<(&str, Dimension)> =
                scope.species.iter().map(|s| (s.name.as_str(), variable)).collect();
            let expression = Expression::parse(text, &node.place).map_err(|fault| vec![fault]);
            match expression.and_then(|e| e.compile(&variables, scope.parameters, expected)) {
                Ok(program) => program,
                Err(list) => {
                    list.into_iter().for_each(|fault| faults.push(named(fault, what)));
                    return None;
                }
            }
        }
        _ => Program::constant_of(node.number(faults)?),
    };
    if program.constant().is_some_and(|value| value < 0.0) {
        faults.at(
            &node.place,
            format!("{what}: a law may not be negative"),
            "swap the sides of the equation",
        );
        return None;
    }
    Some(program)
}
