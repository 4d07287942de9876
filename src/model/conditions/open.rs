//! Open ends of the box: what holds where particles enter and leave.

use super::{Condition, What, amounts};
use crate::chemistry::Network;
use crate::model::domain::{Boundary, ParticleDomain};
use crate::model::fluid::field::{self, Field};
use crate::model::initial::Amount;
use crate::model::names::axis_name;
use crate::model::node::{Node, Value};
use crate::model::reader::{Faults, Fields};
use crate::quantity::Dimension;

/// What is prescribed at an open end.
#[derive(Clone, Debug, PartialEq)]
pub enum EndModel {
    /// m/s.
    Velocity(Field),
    /// Pa.
    Pressure(f64),
}

/// `open: { at: x_min, velocity: ["1 mm/s * y / (10 um)", 0], species: { L: 1 uM } }` or `open: { at: x_max, pressure: 0 }`
pub(super) fn open(
    node: &Node,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Option<What> {
    let d = domain.dimensions;
    let mut fields = Fields::of(node, "open", faults)?;
    let end = fields.required("at", faults).and_then(|n| end_named(n, domain, faults));
    let velocity =
        fields.optional("velocity").map(|n| field::read(n, d, Dimension::VELOCITY, network, faults));
    let pressure = fields.optional("pressure").map(|n| n.quantity(Dimension::PRESSURE, faults));
    let species = amounts(&mut fields, domain, network, faults);
    fields.finish(faults);
    if species.iter().any(|(_, amount)| !matches!(amount, Amount::Concentration(_) | Amount::Field(_))) {
        faults.at(
            &node.place,
            "what enters is a concentration",
            "give it with a unit, e.g. species: { L: 1 uM }",
        );
        return None;
    }
    let what = match (velocity, pressure) {
        (Some(velocity), None) => EndModel::Velocity(velocity?),
        (None, Some(pressure)) => EndModel::Pressure(pressure?),
        _ => {
            faults.at(
                &node.place,
                "an open end has either a velocity or a pressure",
                "for example { at: x_min, velocity: [1 mm/s, 0] } and { at: x_max, pressure: 0 }",
            );
            return None;
        }
    };
    let (axis, upper) = end?;
    Some(What::Open { axis, upper, end: what, species })
}

fn end_named(node: &Node, domain: &ParticleDomain, faults: &mut Faults) -> Option<(usize, bool)> {
    let name = node.text(faults)?;
    for axis in 0..domain.dimensions {
        for (upper, word) in [(false, "min"), (true, "max")] {
            if name != format!("{}_{word}", axis_name(axis)) {
                continue;
            }
            if domain.boundaries[axis] != Boundary::Open {
                faults.at(
                    &node.place,
                    format!("the box is not open along {}", axis_name(axis)),
                    format!("set boundaries: {{ {}: open }}", axis_name(axis)),
                );
                return None;
            }
            return Some((axis, upper));
        }
    }
    faults.at(&node.place, format!("`{name}` is no end of the box"), "ends are x_min, x_max, y_min, ...");
    None
}

/// How many of the conditions are open ends, read or not.
fn stated(node: &Node) -> usize {
    let Value::Map(conditions) = &node.value else { return 0 };
    let is_open = |body: &Node| matches!(&body.value, Value::Map(kinds) if kinds.iter().any(|(kind, _)| kind.name == "open"));
    conditions.iter().filter(|(_, body)| is_open(body)).count()
}

/// Both ends of an open axis must be described, and one of them must let the pressure out.
pub(super) fn check(
    node: Option<&Node>,
    domain: &ParticleDomain,
    found: &[Condition],
    at: &Node,
    faults: &mut Faults,
) {
    let open: Vec<usize> =
        (0..domain.dimensions).filter(|&axis| domain.boundaries[axis] == Boundary::Open).collect();
    let Some(&axis) = open.first() else { return };
    let place = node.map_or(&at.place, |node| &node.place);
    let name = axis_name(axis);
    if open.len() > 1 {
        faults.at(
            &at.place,
            "two axes are open",
            "only one can be; make the other periodic, no_slip or free_slip",
        );
        return;
    }
    if domain.fluid.is_none() {
        faults.at(
            &at.place,
            "particles enter and leave with a fluid, and none moves here",
            "add the section `fluid:`, or close the box",
        );
        return;
    }
    let of = |which: bool| -> Vec<(&Condition, &EndModel)> {
        let end = |c| match c {
            &Condition { what: What::Open { upper, ref end, .. }, .. } if upper == which => Some((c, end)),
            _ => None,
        };
        found.iter().filter_map(end).collect()
    };
    // One that could not be read is told by what is wrong with it.
    let unread = node.is_some_and(|node| stated(node) > of(false).len() + of(true).len());
    for (upper, word) in [(false, "min"), (true, "max")] {
        let there = of(upper);
        if there.is_empty() && !unread {
            faults.at(
                place,
                format!("the box is open along {name}, and nothing says what enters or leaves at {name}_{word}"),
                format!("add a condition, e.g. conditions: {{ end: {{ open: {{ at: {name}_{word}, pressure: 0 }} }} }}"),
            );
        } else if let [_, second, ..] = there[..] {
            faults.at(
                &second.0.place,
                format!("a second condition for the end {name}_{word}"),
                "keep one of them",
            );
        }
    }
    if let ([(_, EndModel::Velocity(_))], [(second, EndModel::Velocity(_))]) = (&of(false)[..], &of(true)[..])
    {
        faults.at(
            &second.place,
            "both ends have a given velocity: nothing sets the pressure, and what enters need not leave",
            "give one end a pressure, e.g. pressure: 0",
        );
    }
    for condition in found {
        if let What::Held { group, .. } = &condition.what
            && domain.groups[*group].material == crate::model::Material::Fluid
        {
            faults.at(
                &condition.place,
                format!("`{}` flows, and its particles leave the box", domain.groups[*group].name),
                "let what enters carry the concentration (species: of the open end), or use a sponge in a zone",
            );
        }
    }
}
