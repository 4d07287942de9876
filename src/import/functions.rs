//! Function definitions put in where they are called.

use super::document::{Function, Sbml};
use super::log::{Log, Spot};
use super::math::{LARGEST, Math, Operation};
use std::collections::BTreeMap;

/// Functions may call functions this deep.
const DEEPEST: usize = 50;

/// Puts the functions into every formula of a model.
pub(super) fn inline(sbml: &mut Sbml, log: &mut Log) {
    let functions = std::mem::take(&mut sbml.functions);
    let mut put_in = |math: &mut Math, spot: Spot| {
        if let Some(done) = put_in(math, &functions, spot, 0, log) {
            *math = done;
        }
    };
    for assignment in sbml.initial.values_mut().chain(sbml.rules.values_mut()) {
        put_in(&mut assignment.math, assignment.spot);
    }
    for reaction in &mut sbml.reactions {
        if let Some(law) = &mut reaction.law {
            put_in(law, reaction.law_spot);
        }
        for reference in reaction.left.iter_mut().chain(&mut reaction.right) {
            if let Some(formula) = &mut reference.formula {
                put_in(formula, reference.spot);
            }
        }
    }
    sbml.functions = functions;
}

fn put_in(
    math: &Math,
    functions: &BTreeMap<String, Function>,
    spot: Spot,
    depth: usize,
    log: &mut Log,
) -> Option<Math> {
    let Math::Apply(operation, arguments) = math else { return Some(math.clone()) };
    let mut done = Vec::with_capacity(arguments.len());
    for argument in arguments {
        done.push(put_in(argument, functions, spot, depth, log)?);
    }
    let Operation::Call(name) = operation else { return Some(Math::Apply(operation.clone(), done)) };
    let Some(function) = functions.get(name) else {
        let remedy = "define it in listOfFunctionDefinitions";
        log.fault(spot, format!("the function \"{name}\" is not defined"), remedy);
        return None;
    };
    if function.arguments.len() != done.len() {
        let (wanted, found) = (function.arguments.len(), done.len());
        let reason = format!("the function \"{name}\" takes {wanted} arguments, found {found}");
        log.fault(spot, reason, "correct the call");
        return None;
    }
    if depth > DEEPEST {
        let reason = format!("the function \"{name}\" is defined by itself");
        log.fault(function.spot, reason, "functions may call only others");
        return None;
    }
    // The body first: names in it are its own arguments, not what is handed over.
    let body = put_in(&function.body, functions, function.spot, depth + 1, log)?;
    let value = |symbol: &str| {
        let at = function.arguments.iter().position(|argument| argument == symbol)?;
        Some(done[at].clone())
    };
    let result = body.replaced(&value);
    if result.size() > LARGEST {
        let reason = format!("the function \"{name}\" grows too large where it is put in");
        log.fault(spot, reason, "simplify it");
        return None;
    }
    Some(result)
}
