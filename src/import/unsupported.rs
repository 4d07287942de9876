//! What SBML has and this program does not: each use is named, all in one message.

use super::document::{child, list};
use super::log::{Log, Spot};
use roxmltree::Node;

/// Names everything in a model that cannot be taken over.
pub(super) fn name_all(sbml: Node, model: Node, log: &mut Log) {
    packages(sbml, log);
    for event in list(model, "listOfEvents", "event") {
        let delayed = child(event, "delay").is_some();
        log.fault(
            Spot::of(event),
            format!("event{} is not supported{}", named(event), if delayed { " (it has a delay, too)" } else { "" }),
            "remove it; run the stretches between events one after the other, each from what the last one left",
        );
    }
    if let Some(rules) = child(model, "listOfRules") {
        for rule in rules.children().filter(Node::is_element) {
            let of = rule.attribute("variable").map(|v| format!(" for \"{v}\"")).unwrap_or_default();
            match rule.tag_name().name() {
                "rateRule" => log.fault(
                    Spot::of(rule),
                    format!("a rate rule{of} is not supported"),
                    "write it as reactions that make and remove the variable",
                ),
                "algebraicRule" => log.fault(
                    Spot::of(rule),
                    "an algebraic rule is not supported",
                    "solve it for one variable and give an assignment rule",
                ),
                _ => {}
            }
        }
    }
    for reaction in list(model, "listOfReactions", "reaction") {
        if matches!(reaction.attribute("fast"), Some("true" | "1")) {
            log.fault(
                Spot::of(reaction),
                format!("fast reaction{} is not supported", named(reaction)),
                "give it a finite rate, large beside the others",
            );
        }
    }
    let constraints = list(model, "listOfConstraints", "constraint").len();
    if constraints > 0 {
        log.note(format!(
            "{constraints} constraint(s) left out: they only watch a run, they do not change it"
        ));
    }
}

/// Packages of Level 3: those that change what the model means are refused.
fn packages(sbml: Node, log: &mut Log) {
    for attribute in sbml.attributes() {
        let (Some(space), "required") = (attribute.namespace(), attribute.name()) else { continue };
        // http://www.sbml.org/sbml/level3/version1/fbc/version2
        let package = space.split('/').rev().nth(1).unwrap_or(space);
        if matches!(attribute.value().trim(), "true" | "1") {
            log.fault(
                Spot::of(sbml),
                format!("the package \"{package}\", which this model requires, is not supported"),
                "export the model as plain SBML core (for \"comp\": flattened)",
            );
        } else {
            log.note(format!("what the package \"{package}\" says is left out"));
        }
    }
}

fn named(node: Node) -> String {
    let name = node.attribute("id").or(node.attribute("name"));
    name.map(|name| format!(" \"{name}\"")).unwrap_or_default()
}
