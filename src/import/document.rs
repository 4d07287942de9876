//! An SBML file as it stands: compartments, species, parameters, reactions, formulas; nothing is worked out.

use super::log::{Log, Spot};
use super::math::Math;
use super::mathml;
use roxmltree::Node;
use std::collections::BTreeMap;

/// A compartment.
#[derive(Debug)]
pub(super) struct Compartment {
    pub id: String,
    pub size: Option<f64>,
    pub dimensions: f64,
    pub units: Option<String>,
    pub spot: Spot,
}

/// A species.
#[derive(Debug)]
pub(super) struct Species {
    pub id: String,
    /// What people call it; may be empty.
    pub name: String,
    pub compartment: String,
    pub amount: Option<f64>,
    pub concentration: Option<f64>,
    pub substance_units: Option<String>,
    /// Its symbol stands for the amount, else for the concentration.
    pub counted: bool,
    /// Reactions do not change it.
    pub held: bool,
    pub conversion: Option<String>,
    pub spot: Spot,
}

/// A global parameter, or one of a single law under the name it has got here.
#[derive(Debug)]
pub(super) struct Parameter {
    pub id: String,
    pub value: Option<f64>,
    pub spot: Spot,
}

/// A function definition.
#[derive(Debug)]
pub(super) struct Function {
    pub arguments: Vec<String>,
    pub body: Math,
    pub spot: Spot,
}

/// An initial assignment or an assignment rule.
#[derive(Clone, Debug)]
pub(super) struct Assignment {
    pub math: Math,
    pub spot: Spot,
}

/// A reactant or product.
#[derive(Debug)]
pub(super) struct Reference {
    pub species: String,
    pub id: Option<String>,
    pub stoichiometry: f64,
    /// A formula in place of the number.
    pub formula: Option<Math>,
    pub spot: Spot,
}

/// A reaction.
#[derive(Debug)]
pub(super) struct Reaction {
    pub id: String,
    pub reversible: bool,
    pub left: Vec<Reference>,
    pub right: Vec<Reference>,
    /// Missing after a fault.
    pub law: Option<Math>,
    /// Units of the law alone (Level 2 Version 1).
    pub substance_units: Option<String>,
    pub time_units: Option<String>,
    pub spot: Spot,
    pub law_spot: Spot,
}

/// Units that hold for the whole model (Level 3).
#[derive(Debug, Default)]
pub(super) struct Defaults {
    pub substance: Option<String>,
    pub volume: Option<String>,
    pub time: Option<String>,
    pub extent: Option<String>,
    pub conversion: Option<String>,
}

/// The model in an SBML file.
#[derive(Debug)]
pub(super) struct Sbml {
    pub level: u32,
    pub version: u32,
    pub id: String,
    pub name: String,
    pub defaults: Defaults,
    pub compartments: Vec<Compartment>,
    pub species: Vec<Species>,
    pub parameters: Vec<Parameter>,
    pub functions: BTreeMap<String, Function>,
    pub initial: BTreeMap<String, Assignment>,
    pub rules: BTreeMap<String, Assignment>,
    pub reactions: Vec<Reaction>,
    pub spot: Spot,
}

/// The child element of this name in the language of the parent; packages use their own.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    let core = node.tag_name().namespace();
    node.children()
        .find(|n| n.is_element() && n.tag_name().name() == name && n.tag_name().namespace() == core)
}

/// The entries called `name` of the list called `list`.
pub(super) fn list<'a, 'i>(node: Node<'a, 'i>, list: &str, name: &str) -> Vec<Node<'a, 'i>> {
    let Some(list) = child(node, list) else { return Vec::new() };
    list.children().filter(|n| n.is_element() && n.tag_name().name() == name).collect()
}

/// Reads a model.
pub(super) fn read(model: Node, level: u32, version: u32, log: &mut Log) -> Sbml {
    let text = |key: &str| model.attribute(key).map(str::to_string);
    let mut sbml = Sbml {
        level,
        version,
        id: text("id").unwrap_or_default(),
        name: text("name").unwrap_or_default(),
        defaults: Defaults {
            substance: text("substanceUnits"),
            volume: text("volumeUnits"),
            time: text("timeUnits"),
            extent: text("extentUnits"),
            conversion: text("conversionFactor"),
        },
        compartments: Vec::new(),
        species: Vec::new(),
        parameters: Vec::new(),
        functions: BTreeMap::new(),
        initial: BTreeMap::new(),
        rules: BTreeMap::new(),
        reactions: Vec::new(),
        spot: Spot::of(model),
    };
    for node in list(model, "listOfCompartments", "compartment") {
        let Some(id) = identifier(node, "id", log) else { continue };
        sbml.compartments.push(Compartment {
            id,
            size: number(node, "size", log),
            dimensions: number(node, "spatialDimensions", log).unwrap_or(3.0),
            units: node.attribute("units").map(str::to_string),
            spot: Spot::of(node),
        });
    }
    for node in list(model, "listOfSpecies", "species") {
        sbml.species.extend(species(node, log));
    }
    for node in list(model, "listOfParameters", "parameter") {
        sbml.parameters.extend(parameter(node, log));
    }
    for node in list(model, "listOfFunctionDefinitions", "functionDefinition") {
        let (Some(id), Some((arguments, body))) = (identifier(node, "id", log), mathml::lambda(node, log))
        else {
            continue;
        };
        sbml.functions.insert(id, Function { arguments, body, spot: Spot::of(node) });
    }
    for node in list(model, "listOfInitialAssignments", "initialAssignment") {
        if let Some((id, assignment)) = assignment(node, "symbol", log) {
            sbml.initial.insert(id, assignment);
        }
    }
    for node in list(model, "listOfRules", "assignmentRule") {
        if let Some((id, assignment)) = assignment(node, "variable", log) {
            sbml.rules.insert(id, assignment);
        }
    }
    let mut taken: Vec<String> =
        model.descendants().filter_map(|n| n.attribute("id")).map(str::to_string).collect();
    for node in list(model, "listOfReactions", "reaction") {
        if let Some(reaction) = reaction(node, &mut sbml.parameters, &mut taken, log) {
            sbml.reactions.push(reaction);
        }
    }
    unique(&sbml, log);
    sbml
}

/// Names are used once.
fn unique(sbml: &Sbml, log: &mut Log) {
    let ids = (sbml.compartments.iter().map(|c| (&c.id, c.spot)))
        .chain(sbml.species.iter().map(|s| (&s.id, s.spot)))
        .chain(sbml.parameters.iter().map(|p| (&p.id, p.spot)))
        .chain(sbml.reactions.iter().map(|r| (&r.id, r.spot)));
    let mut seen = std::collections::BTreeSet::new();
    for (id, spot) in ids {
        if !seen.insert(id) {
            log.fault(spot, format!("the id \"{id}\" is given twice"), "rename one");
        }
    }
}

fn species(node: Node, log: &mut Log) -> Option<Species> {
    let attribute = |key: &str| node.attribute(key).map(str::to_string);
    Some(Species {
        id: identifier(node, "id", log)?,
        name: attribute("name").unwrap_or_default(),
        compartment: identifier(node, "compartment", log)?,
        amount: number(node, "initialAmount", log),
        concentration: number(node, "initialConcentration", log),
        substance_units: attribute("substanceUnits"),
        counted: flag(node, "hasOnlySubstanceUnits", false),
        held: flag(node, "boundaryCondition", false) || flag(node, "constant", false),
        conversion: attribute("conversionFactor"),
        spot: Spot::of(node),
    })
}

fn parameter(node: Node, log: &mut Log) -> Option<Parameter> {
    let id = identifier(node, "id", log)?;
    Some(Parameter { id, value: number(node, "value", log), spot: Spot::of(node) })
}

fn assignment(node: Node, key: &str, log: &mut Log) -> Option<(String, Assignment)> {
    let id = identifier(node, key, log)?;
    Some((id, Assignment { math: mathml::of(node, log)?, spot: Spot::of(node) }))
}

/// Reads a reaction; parameters of its law go to the others under a name of their own.
fn reaction(
    node: Node,
    parameters: &mut Vec<Parameter>,
    taken: &mut Vec<String>,
    log: &mut Log,
) -> Option<Reaction> {
    let id = identifier(node, "id", log)?;
    let spot = Spot::of(node);
    let mut side = |name: &str| -> Vec<Reference> {
        list(node, name, "speciesReference").into_iter().filter_map(|n| reference(n, log)).collect()
    };
    let (left, right) = (side("listOfReactants"), side("listOfProducts"));
    let mut reaction = Reaction {
        reversible: flag(node, "reversible", true),
        left,
        right,
        law: None,
        substance_units: None,
        time_units: None,
        spot,
        law_spot: spot,
        id,
    };
    let Some(law) = child(node, "kineticLaw") else {
        let reason = format!("reaction \"{}\" has no kinetic law", reaction.id);
        log.fault(spot, reason, "add a <kineticLaw>; without one the rate is unknown");
        return Some(reaction);
    };
    reaction.law_spot = Spot::of(law);
    reaction.substance_units = law.attribute("substanceUnits").map(str::to_string);
    reaction.time_units = law.attribute("timeUnits").map(str::to_string);
    let mut renamed: BTreeMap<String, String> = BTreeMap::new();
    let locals =
        [list(law, "listOfParameters", "parameter"), list(law, "listOfLocalParameters", "localParameter")];
    for mut local in locals.concat().into_iter().filter_map(|n| parameter(n, log)) {
        let mut name = format!("{}_{}", reaction.id, local.id);
        while taken.contains(&name) {
            name.push('_');
        }
        taken.push(name.clone());
        renamed.insert(std::mem::replace(&mut local.id, name.clone()), name);
        parameters.push(local);
    }
    let math = mathml::of(law, log)?;
    reaction.law = Some(math.replaced(&|symbol| renamed.get(symbol).cloned().map(Math::Symbol)));
    Some(reaction)
}

fn reference(node: Node, log: &mut Log) -> Option<Reference> {
    let formula = child(node, "stoichiometryMath").and_then(|n| mathml::of(n, log));
    // Level 2 Version 1 has fractions of whole numbers.
    let denominator = number(node, "denominator", log).unwrap_or(1.0);
    Some(Reference {
        species: identifier(node, "species", log)?,
        id: node.attribute("id").map(str::to_string),
        stoichiometry: number(node, "stoichiometry", log).unwrap_or(1.0) / denominator,
        formula,
        spot: Spot::of(node),
    })
}

/// An SBML name: letters, digits and `_`, not beginning with a digit.
fn identifier(node: Node, key: &str, log: &mut Log) -> Option<String> {
    let what = node.tag_name().name();
    let Some(id) = node.attribute(key) else {
        log.fault(Spot::of(node), format!("<{what}> without \"{key}\""), format!("add {key}=\"…\""));
        return None;
    };
    let legal = |(k, c): (usize, char)| c == '_' || c.is_ascii_alphabetic() || k > 0 && c.is_ascii_digit();
    if id.is_empty() || !id.chars().enumerate().all(legal) {
        let remedy = "ids have letters, digits and \"_\", and do not begin with a digit";
        log.fault(Spot::of(node), format!("\"{id}\" is no id of SBML"), remedy);
        return None;
    }
    Some(id.to_string())
}

fn number(node: Node, key: &str, log: &mut Log) -> Option<f64> {
    let text = node.attribute(key)?;
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Some(value),
        // "NaN" is how some programs write a value that rules or assignments give later.
        Ok(value) if value.is_nan() => None,
        _ => {
            let reason = format!("{key}=\"{text}\" is not a finite number");
            log.fault(Spot::of(node), reason, "correct it");
            None
        }
    }
}

fn flag(node: Node, key: &str, usual: bool) -> bool {
    node.attribute(key).map_or(usual, |text| matches!(text.trim(), "true" | "1"))
}
