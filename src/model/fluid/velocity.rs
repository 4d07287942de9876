//! The velocity of the fluid at the start, one value or expression for each component.

use crate::chemistry::Network;
use crate::chemistry::law::{Expression, Program};
use crate::model::node::{Node, Value};
use crate::model::reader::Faults;
use crate::quantity::{Dimension, Quantity};
use crate::vector::Vector;

/// Components of a velocity in m/s, each a program of x, y, z (m).
#[derive(Clone, Debug, Default)]
pub struct Velocity {
    /// None where the fluid is at rest.
    components: Vec<Program>,
}

impl Velocity {
    /// Whether it is zero everywhere.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.components.iter().all(|component| component.constant() == Some(0.0))
    }

    /// The velocity at a place (m), m/s.
    #[must_use]
    pub fn at(&self, place: &Vector<3>) -> Vector<3> {
        Vector::from_fn(|k, _| {
            self.components.get(k).map_or(0.0, |component| component.eval(place.as_slice()))
        })
    }

    /// The velocity, if it is the same everywhere, m/s.
    #[must_use]
    pub fn uniform(&self) -> Option<Vector<3>> {
        let all: Option<Vec<f64>> = self.components.iter().map(Program::constant).collect();
        all.map(|all| Vector::from_fn(|k, _| all.get(k).copied().unwrap_or(0.0)))
    }
}

/// `[1 mm/s, 0]`, or expressions of position: `["1 mm/s * sin(2 * pi * y / (1 mm))", 0]`.
pub(in crate::model) fn read(
    node: &Node,
    d: usize,
    network: &Network,
    faults: &mut Faults,
) -> Option<Velocity> {
    let items = node.list(faults)?;
    if items.len() != d {
        faults.at(
            &node.place,
            format!("expected {d} components, found {}", items.len()),
            "one for each dimension, e.g. [1 mm/s, 0]; each may be an expression of x, y, z",
        );
        return None;
    }
    let components: Vec<Option<Program>> =
        items.iter().map(|item| component(item, d, network, faults)).collect();
    Some(Velocity { components: components.into_iter().collect::<Option<Vec<Program>>>()? })
}

fn component(node: &Node, d: usize, network: &Network, faults: &mut Faults) -> Option<Program> {
    let Value::Text(text) = &node.value else {
        return node.quantity(Dimension::VELOCITY, faults).map(Program::constant_of);
    };
    let starts_as_number =
        text.trim_start().starts_with(|c: char| c.is_ascii_digit() || c == '.' || c == '-');
    if Quantity::parse(text).is_ok() || starts_as_number && !text.contains(['*', '(', '+']) {
        // The reader of quantities says best what is wrong with one.
        return node.quantity(Dimension::VELOCITY, faults).map(Program::constant_of);
    }
    let axes = ["x", "y", "z"].map(|name| (name, Dimension::LENGTH));
    let compiled = Expression::parse(text, &node.place)
        .map_err(|fault| vec![fault])
        .and_then(|expression| expression.compile(&axes[..d], &network.parameters, Dimension::VELOCITY));
    compiled.map_err(|found| faults.list.extend(found)).ok()
}
