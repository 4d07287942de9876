//! The equations of a solid by name, and the numbers of those that have some.

use super::Mechanics;
use crate::model::node::Node;
use crate::model::reader::{Faults, Fields};
use crate::quantity::Dimension;
use crate::solid;

/// Equations by name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Form {
    /// From the undeformed solid.
    #[default]
    TotalLagrangian,
    /// From step to step, with the stress rate of Jaumann.
    Jaumann(solid::Form),
}

/// Whether it is the form of Jaumann.
const NAMES: [(&str, bool); 2] = [("total_lagrangian", false), ("jaumann", true)];
/// What the form of Jaumann does not know.
const FOREIGN: [(&str, &str); 6] = [
    ("law", "its stress grows with the rate of strain, by no law of the strain itself"),
    ("hourglass", "it knows no place at rest to which hourglass control could lead back"),
    ("viscosity", "its viscosity is jaumann.artificial_viscosity"),
    ("softening", "its stress is what was gathered with the moduli of the past"),
    ("turgor", "turgor is that of walls in balance"),
    ("growth", "growth is that of walls in balance"),
];

impl Form {
    /// As it is named in a model.
    #[must_use]
    pub fn name(self) -> &'static str {
        let updated = matches!(self, Form::Jaumann(_));
        NAMES.iter().find(|(_, is)| *is == updated).map_or("", |(name, _)| name)
    }
}

/// `method: jaumann` with `jaumann: { artificial_stress: 0.2, artificial_viscosity: 0.05, corrected_gradients: true }`;
/// `fluid` is whether there is one.
pub(super) fn read(
    fields: &mut Fields,
    (mechanics, fluid): (Mechanics, bool),
    faults: &mut Faults,
) -> Option<Form> {
    let method = fields.optional("method").map(|n| n.choice(&NAMES, faults));
    let numbers = fields.optional("jaumann");
    let form = numbers.map(|n| jaumann(n, faults));
    match method {
        None | Some(Some(false)) => {
            if let Some(n) = numbers {
                faults.at(
                    &n.place,
                    "these are numbers of the form of Jaumann, which this solid does not have",
                    "add method: jaumann, or remove `jaumann`",
                );
            }
            return Some(Form::TotalLagrangian);
        }
        Some(None) => return None,
        Some(Some(true)) => {}
    }
    for (key, why) in FOREIGN {
        if let Some(place) = fields.key_place(key).cloned() {
            faults.at(
                &place,
                format!("the form of Jaumann knows no `{key}`: {why}"),
                format!("remove `{key}`, or set method: total_lagrangian"),
            );
        }
    }
    let at = fields.key_place("method").cloned().unwrap_or_else(|| fields.place().clone());
    if mechanics != Mechanics::Dynamic {
        faults.at(
            &at,
            "the form of Jaumann knows no place at rest, and so no balance",
            "set method: total_lagrangian, or mechanics: { mode: dynamic }",
        );
    }
    if fluid {
        faults.at(
            &at,
            "the form of Jaumann is for solids alone: no fluid moves it",
            "set method: total_lagrangian, or fluid: { method: none }",
        );
    }
    form.unwrap_or_else(|| Some(solid::Form::default())).map(Form::Jaumann)
}

fn jaumann(node: &Node, faults: &mut Faults) -> Option<solid::Form> {
    let usual = solid::Form::default();
    let mut fields = Fields::of(node, "jaumann", faults)?;
    let mut number = |key: &'static str, usual: f64| {
        fields.optional(key).map_or(Some(usual), |n| n.non_negative(Dimension::NONE, faults))
    };
    let artificial_stress = number("artificial_stress", usual.artificial_stress);
    let artificial_viscosity = number("artificial_viscosity", usual.artificial_viscosity);
    let corrected =
        fields.optional("corrected_gradients").map_or(Some(usual.corrected), |n| n.boolean(faults));
    fields.finish(faults);
    Some(solid::Form {
        artificial_stress: artificial_stress?,
        artificial_viscosity: artificial_viscosity?,
        corrected: corrected?,
    })
}
