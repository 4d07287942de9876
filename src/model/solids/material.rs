//! What an elastic solid is made of.

use crate::model::reader::{Faults, Fields};
use crate::quantity::Dimension;
use crate::solid::{Law, Material};

const LAWS: [(&str, Law); 2] =
    [("saint_venant_kirchhoff", Law::SaintVenantKirchhoff), ("neo_hookean", Law::NeoHookean)];

/// A law as it is named in a model.
#[must_use]
pub fn law_name(law: Law) -> &'static str {
    LAWS.iter().find(|(_, other)| *other == law).map_or("", |(name, _)| name)
}

/// `density`, `law` and one pair of moduli: `youngs_modulus` and `poisson_ratio`, or `bulk_modulus` and
/// `shear_modulus`.
pub(super) fn read(fields: &mut Fields, faults: &mut Faults) -> Option<Material> {
    let density = fields.required("density", faults).and_then(|n| n.positive(Dimension::DENSITY, faults));
    let law = fields.optional("law").map_or(Some(Law::default()), |n| n.choice(&LAWS, faults));
    let nodes =
        ["youngs_modulus", "poisson_ratio", "bulk_modulus", "shear_modulus"].map(|key| fields.optional(key));
    let [young, poisson, bulk, shear] = nodes;
    let written = |node: Option<&crate::model::node::Node>| node.is_some();
    let (by_young, by_bulk) = (written(young) || written(poisson), written(bulk) || written(shear));
    let mut modulus =
        |node: Option<&crate::model::node::Node>| node.and_then(|n| n.positive(Dimension::PRESSURE, faults));
    let (young, bulk, shear) = (modulus(young), modulus(bulk), modulus(shear));
    let poisson = poisson.and_then(|n| {
        let value = n.number(faults)?;
        if value > -1.0 && value < 0.5 {
            return Some(value);
        }
        faults.at(
            &n.place,
            format!("a Poisson ratio of {value}"),
            "it lies between -1 and 0.5, both excluded; rubber and tissue come to 0.45 to 0.499",
        );
        None
    });
    match (by_young, by_bulk) {
        (true, true) => {
            let extra = nodes[2].or(nodes[3]).map(|n| &n.place);
            faults.at(
                extra.unwrap_or(fields.place()),
                "two pairs of moduli describe this solid",
                "keep youngs_modulus and poisson_ratio, or bulk_modulus and shear_modulus",
            );
            return None;
        }
        (false, false) => {
            faults.at(
                fields.place(),
                "no moduli say how stiff this solid is",
                "add youngs_modulus and poisson_ratio, or bulk_modulus and shear_modulus",
            );
            return None;
        }
        _ => {}
    }
    let (one, other) = if by_young {
        (("youngs_modulus", nodes[0]), ("poisson_ratio", nodes[1]))
    } else {
        (("bulk_modulus", nodes[2]), ("shear_modulus", nodes[3]))
    };
    for ((missing, node), (given, _)) in [(one, other), (other, one)] {
        if node.is_none() {
            faults.at(
                fields.place(),
                format!("`{given}` alone does not say how stiff this solid is"),
                format!("add {missing}"),
            );
        }
    }
    let (density, law) = (density?, law?);
    Some(if by_young {
        Material::of_young(law, density, young?, poisson?)
    } else {
        Material { law, density, bulk: bulk?, shear: shear? }
    })
}
