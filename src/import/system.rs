//! What the species of a file come to: molecules, volumes, seconds, and which of them reactions change.

use super::Options;
use super::document::{Assignment, Sbml, Species};
use super::log::{Log, Spot};
use super::math::Math;
use super::polynomial::Meaning;
use super::units::{Measure, Quantity, Units};
use super::values::{Values, check_symbols, with_rules};
use crate::chemistry::law::function_names;
use std::collections::BTreeMap;

/// A species that reactions change.
#[derive(Debug)]
pub(super) struct Variable {
    pub id: String,
    /// As it is called in the reactions file.
    pub label: String,
    /// What people call it; may be empty.
    pub name: String,
    /// Index into [`System::compartments`].
    pub compartment: usize,
    /// Molecules in one unit of its amount, after scaling.
    pub molecules: f64,
    /// Molecules that add one to the number its symbol stands for.
    pub molecules_per_value: f64,
    /// Its symbol stands for the amount.
    pub counted: bool,
    /// Molecules at the start.
    pub start: f64,
    pub spot: Spot,
}

/// A compartment that holds such species.
#[derive(Debug)]
pub(super) struct Volume {
    pub label: String,
    /// m³, after scaling.
    pub volume: f64,
}

/// The model with units resolved.
pub(super) struct System<'a> {
    pub sbml: &'a Sbml,
    pub units: &'a Units,
    pub variables: Vec<Variable>,
    pub compartments: Vec<Volume>,
    /// Values of all other symbols.
    pub constants: BTreeMap<String, f64>,
    /// Amounts are given in moles.
    pub moles: bool,
    /// Molecules in the unit of substance that holds for the model, after scaling.
    pub molecules: f64,
    /// Times larger than in the file.
    pub scale: f64,
    /// s in the unit of time.
    pub second: f64,
    /// Amounts are read in a unit given by the user.
    pub substance: Option<Measure>,
}

impl Meaning for System<'_> {
    fn varies(&self, symbol: &str) -> bool {
        self.variables.iter().any(|v| v.id == symbol)
    }

    fn constant(&self, symbol: &str) -> Option<f64> {
        self.constants.get(symbol).copied()
    }
}

impl<'a> System<'a> {
    pub fn new(sbml: &'a Sbml, units: &'a Units, options: &Options, log: &mut Log) -> Option<System<'a>> {
        check_formulas(sbml, log);
        check_rules(sbml, log);
        if !log.faults.is_empty() {
            return None;
        }
        let moving: Vec<&Species> =
            sbml.species.iter().filter(|s| !s.held && !sbml.rules.contains_key(&s.id)).collect();
        if moving.is_empty() {
            log.fault(
                sbml.spot,
                "no species of this model is changed by reactions",
                "this program runs reaction networks",
            );
            return None;
        }
        let mut values = Values::new(sbml);
        let (compartments, indices) = volumes(sbml, units, &moving, options, &mut values, log)?;
        let scale = compartments.1;
        let model_unit = |log: &mut Log| {
            let name = sbml.defaults.substance.as_deref();
            // Level 3 has no substance unit of its own: one that all species state will do.
            let shared = moving[0].substance_units.as_deref();
            options
                .substance
                .unwrap_or_else(|| units.measure(name.or(shared), Quantity::Substance, sbml.spot, log))
        };
        let substance = model_unit(log);
        let second = units.measure(sbml.defaults.time.as_deref(), Quantity::Time, sbml.spot, log).size;
        let mut system = System {
            sbml,
            units,
            variables: Vec::new(),
            compartments: compartments.0,
            constants: BTreeMap::new(),
            moles: substance.moles,
            molecules: substance.size * scale,
            scale,
            second,
            substance: options.substance,
        };
        for (species, &compartment) in moving.iter().zip(&indices) {
            let unit = options.substance.unwrap_or_else(|| {
                let name = species.substance_units.as_deref().or(sbml.defaults.substance.as_deref());
                units.measure(name, Quantity::Substance, species.spot, log)
            });
            let (value, size) = (values.of(&species.id, log), values.of(&species.compartment, log));
            let (Some(value), Some(size)) = (value, size) else { continue };
            let molecules = unit.size * scale;
            let per_value = if species.counted { molecules } else { molecules * size };
            system.variables.push(Variable {
                id: species.id.clone(),
                label: label(&species.id, sbml),
                name: species.name.clone(),
                compartment,
                molecules,
                molecules_per_value: per_value,
                counted: species.counted,
                start: value * per_value,
                spot: species.spot,
            });
        }
        system.constants = constants(sbml, &mut values, log);
        log.faults.is_empty().then_some(system)
    }

    /// The variable of this id.
    pub fn variable(&self, id: &str) -> Option<&Variable> {
        self.variables.iter().find(|v| v.id == id)
    }

    /// The formula with assignment rules put in.
    pub fn written_out(&self, math: &Math, spot: Spot, log: &mut Log) -> Option<Math> {
        with_rules(self.sbml, &Assignment { math: math.clone(), spot }, log)
    }
}

/// The name in the reactions file: functions of rate expressions keep theirs.
pub(super) fn label(id: &str, sbml: &Sbml) -> String {
    let mut label = id.to_string();
    let taken = |name: &str| {
        sbml.species.iter().any(|s| s.id == name)
            || sbml.parameters.iter().any(|p| p.id == name)
            || sbml.compartments.iter().any(|c| c.id == name)
    };
    // "all" is the sum over compartments.
    while function_names().contains(&label.as_str()) || label == "all" || (label != id && taken(&label)) {
        label.push('_');
    }
    label
}

fn check_formulas(sbml: &Sbml, log: &mut Log) {
    for assignment in sbml.initial.values().chain(sbml.rules.values()) {
        check_symbols(sbml, assignment, log);
    }
    for reaction in &sbml.reactions {
        if let Some(math) = reaction.law.clone() {
            check_symbols(sbml, &Assignment { math, spot: reaction.law_spot }, log);
        }
        for reference in reaction.left.iter().chain(&reaction.right) {
            if let Some(math) = reference.formula.clone() {
                check_symbols(sbml, &Assignment { math, spot: reference.spot }, log);
            }
        }
    }
}

/// Rules may define parameters and species that no reaction changes; sizes only if they are constant.
fn check_rules(sbml: &Sbml, log: &mut Log) {
    for (id, rule) in &sbml.rules {
        let Some(math) = with_rules(sbml, rule, log) else { continue };
        let varies = math.mentions(&|symbol| {
            sbml.species.iter().any(|s| s.id == symbol && !s.held && !sbml.rules.contains_key(symbol))
        });
        if varies && sbml.compartments.iter().any(|c| c.id == *id) {
            let reason = format!("compartment \"{id}\" changes its size, which is not supported");
            log.fault(rule.spot, reason, "give it a fixed size");
        }
        let used = sbml.reactions.iter().any(|r| r.left.iter().chain(&r.right).any(|s| s.species == *id));
        let species = sbml.species.iter().find(|s| s.id == *id);
        if used && species.is_some_and(|s| !s.held) {
            let reason = format!("species \"{id}\" is given by a rule and changed by reactions");
            log.fault(rule.spot, reason, "keep one of the two");
        } else if species.is_some() {
            log.note(format!("species \"{id}\" is given by a rule: it enters the rates and is not listed"));
        }
    }
}

type Volumes = ((Vec<Volume>, f64), Vec<usize>);

/// Compartments of the moving species (with the scale applied), and the index of each species' one.
fn volumes(
    sbml: &Sbml,
    units: &Units,
    moving: &[&Species],
    options: &Options,
    values: &mut Values,
    log: &mut Log,
) -> Option<Volumes> {
    let mut ids: Vec<&str> = Vec::new();
    let mut indices = Vec::new();
    for species in moving {
        let id = species.compartment.as_str();
        if !sbml.compartments.iter().any(|c| c.id == id) {
            let reason =
                format!("species \"{}\" lies in compartment \"{id}\", which is not declared", species.id);
            log.fault(species.spot, reason, "declare the compartment");
            continue;
        }
        let known = ids.iter().position(|other| *other == id);
        indices.push(known.unwrap_or(ids.len()));
        if known.is_none() {
            ids.push(id);
        }
    }
    let mut found = Vec::new();
    for compartment in ids.iter().filter_map(|id| sbml.compartments.iter().find(|c| c.id == *id)) {
        if compartment.dimensions != 3.0 {
            log.fault(
                compartment.spot,
                format!(
                    "compartment \"{}\" has {} dimensions; species live in volumes here",
                    compartment.id, compartment.dimensions
                ),
                "give the compartment the volume of a thin layer, and its species amounts",
            );
        }
        let name = compartment.units.as_deref().or(sbml.defaults.volume.as_deref());
        let unit = if compartment.dimensions == 3.0 {
            units.measure(name, Quantity::Volume, compartment.spot, log).size
        } else {
            1.0
        };
        let size = values.of(&compartment.id, log).unwrap_or(1.0);
        if size <= 0.0 {
            let reason = format!("compartment \"{}\" has the size {size}", compartment.id);
            log.fault(compartment.spot, reason, "sizes are larger than zero");
        }
        found.push(Volume { label: label(&compartment.id, sbml), volume: size * unit });
    }
    if !log.faults.is_empty() {
        return None;
    }
    let largest = found.iter().map(|v| v.volume).fold(0.0, f64::max);
    let scale = options.volume.map_or(1.0, |volume| volume / largest);
    found.iter_mut().for_each(|v| v.volume *= scale);
    Some(((found, scale), indices))
}

/// Values of everything that does not change and that a formula may mention.
fn constants(sbml: &Sbml, values: &mut Values, log: &mut Log) -> BTreeMap<String, f64> {
    let mut used: Vec<String> = Vec::new();
    let mut see = |symbol: &str| used.push(symbol.to_string());
    for reaction in &sbml.reactions {
        for math in reaction
            .law
            .iter()
            .chain(reaction.left.iter().chain(&reaction.right).filter_map(|r| r.formula.as_ref()))
        {
            math.symbols(&mut see);
        }
    }
    // A law may mention what a rule defines, and that what another rule defines.
    sbml.rules.values().for_each(|rule| rule.math.symbols(&mut see));
    used.extend(sbml.species.iter().filter_map(|s| s.conversion.clone()));
    used.extend(sbml.defaults.conversion.clone());
    used.sort();
    used.dedup();
    let changes = |id: &str| sbml.species.iter().any(|s| s.id == id && !s.held);
    used.retain(|id| !changes(id) && !sbml.rules.contains_key(id));
    used.into_iter().filter_map(|id| values.of(&id, log).map(|value| (id, value))).collect()
}
