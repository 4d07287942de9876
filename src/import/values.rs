//! Values at the start, in the numbers and units of the file: attributes, initial assignments, rules.

use super::document::{Assignment, Sbml};
use super::log::Log;
use super::math::{LARGEST, Math};
use std::collections::BTreeMap;

/// Values of symbols at the start.
pub(super) struct Values<'a> {
    sbml: &'a Sbml,
    known: BTreeMap<String, Option<f64>>,
    /// Symbols whose value is being worked out.
    active: Vec<String>,
}

impl Values<'_> {
    pub fn new(sbml: &Sbml) -> Values<'_> {
        Values { sbml, known: BTreeMap::new(), active: Vec::new() }
    }

    /// What a symbol stands for in formulas: a size, a value, a species' amount or concentration. `None`
    /// after a fault.
    pub fn of(&mut self, id: &str, log: &mut Log) -> Option<f64> {
        if let Some(value) = self.known.get(id) {
            return *value;
        }
        let value = self.work_out(id, log);
        self.known.insert(id.to_string(), value);
        value
    }

    fn work_out(&mut self, id: &str, log: &mut Log) -> Option<f64> {
        let sbml = self.sbml;
        if let Some(Assignment { math, spot }) = sbml.rules.get(id).or_else(|| sbml.initial.get(id)) {
            if self.active.iter().any(|a| a == id) {
                log.fault(*spot, format!("the value of \"{id}\" depends on itself"), "break the circle");
                return None;
            }
            self.active.push(id.to_string());
            let value = self.evaluate(math, log);
            self.active.pop();
            let value = value?;
            if !value.is_finite() {
                log.fault(
                    *spot,
                    format!("the value of \"{id}\" comes out as {value}"),
                    "correct the formula",
                );
                return None;
            }
            return Some(value);
        }
        if let Some(compartment) = sbml.compartments.iter().find(|c| c.id == id) {
            if compartment.size.is_none() {
                log.note(format!("compartment \"{id}\" has no size: taken for 1 of its unit"));
            }
            return Some(compartment.size.unwrap_or(1.0));
        }
        if let Some(species) = sbml.species.iter().find(|s| s.id == id) {
            let (value, is_amount) = match (species.amount, species.concentration) {
                (Some(amount), _) => (amount, true),
                (None, Some(concentration)) => (concentration, false),
                (None, None) => {
                    log.note(format!("species \"{id}\" has no initial amount: taken for 0"));
                    (0.0, true)
                }
            };
            if value == 0.0 || is_amount == species.counted {
                return Some(value);
            }
            let size = self.of(&species.compartment, log)?;
            return Some(if is_amount { value / size } else { value * size });
        }
        if let Some(parameter) = sbml.parameters.iter().find(|p| p.id == id) {
            if parameter.value.is_none() {
                log.fault(parameter.spot, format!("parameter \"{id}\" has no value"), "add value=\"…\"");
            }
            return parameter.value;
        }
        let mut references = sbml.reactions.iter().flat_map(|r| r.left.iter().chain(&r.right));
        references.find(|r| r.id.as_deref() == Some(id)).map(|r| r.stoichiometry)
    }

    /// The value of a formula at the start; whoever asks reports symbols that nothing is known of.
    pub fn evaluate(&mut self, math: &Math, log: &mut Log) -> Option<f64> {
        math.value(&mut |symbol| self.of(symbol, log))
    }
}

/// Names every symbol in a formula that the file does not define; whether there was none.
pub(super) fn check_symbols(sbml: &Sbml, assignment: &Assignment, log: &mut Log) -> bool {
    let mut fine = true;
    assignment.math.symbols(&mut |symbol| {
        let references = || sbml.reactions.iter().flat_map(|r| r.left.iter().chain(&r.right));
        let known = sbml.compartments.iter().any(|c| c.id == symbol)
            || sbml.species.iter().any(|s| s.id == symbol)
            || sbml.parameters.iter().any(|p| p.id == symbol)
            || references().any(|r| r.id.as_deref() == Some(symbol));
        if known {
            return;
        }
        fine = false;
        if sbml.reactions.iter().any(|r| r.id == symbol) {
            let reason = format!("the rate of reaction \"{symbol}\" in a formula is not supported");
            log.fault(assignment.spot, reason, "write the rate out");
        } else {
            let remedy = "declare it as a parameter, species or compartment";
            log.fault(assignment.spot, format!("unknown symbol \"{symbol}\" in this formula"), remedy);
        }
    });
    fine
}

/// The formula with what assignment rules define put in.
pub(super) fn with_rules(sbml: &Sbml, assignment: &Assignment, log: &mut Log) -> Option<Math> {
    let mut math = assignment.math.clone();
    // Each round goes one rule deeper; more rounds than rules is a circle.
    for _ in 0..=sbml.rules.len() {
        if !math.mentions(&|symbol| sbml.rules.contains_key(symbol)) {
            return Some(math);
        }
        math = math.replaced(&|symbol| sbml.rules.get(symbol).map(|rule| rule.math.clone()));
        if math.size() > LARGEST {
            break;
        }
    }
    let reason = "assignment rules refer to each other in a circle, or grow too large where they are put in";
    log.fault(assignment.spot, reason, "simplify them");
    None
}
