//! A vector by place and time, one value or expression for each component.

use crate::chemistry::Network;
use crate::chemistry::law::{Expression, Program};
use crate::model::node::{Node, Value};
use crate::model::reader::Faults;
use crate::quantity::{Dimension, Quantity};
use crate::vector::Vector;

/// Components in SI units, each a program of x, y, z (m, as many as there are dimensions) and t (s).
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    components: Vec<Program>,
}

impl Field {
    /// The value at a place (m) and time (s).
    #[must_use]
    pub fn at(&self, place: &Vector<3>, time: f64) -> Vector<3> {
        let d = self.components.len();
        let mut variables = [place[0], place[1], place[2], 0.0];
        variables[d.min(3)] = time;
        Vector::from_fn(|k, _| self.components.get(k).map_or(0.0, |program| program.eval(&variables[..=d])))
    }

    /// Component `k`, if it is the same everywhere and always.
    #[must_use]
    pub fn constant(&self, k: usize) -> Option<f64> {
        self.components.get(k).map_or(Some(0.0), Program::constant)
    }
}

/// `["0", "0.1 um * sin(2 * pi * t / (1 ms))"]`: one component for each dimension.
pub(in crate::model) fn read(
    node: &Node,
    d: usize,
    dimension: Dimension,
    network: &Network,
    faults: &mut Faults,
) -> Option<Field> {
    let items = node.list(faults)?;
    if items.len() != d {
        faults.at(
            &node.place,
            format!("expected {d} components, found {}", items.len()),
            "one for each dimension; each may be an expression of x, y, z and t",
        );
        return None;
    }
    let components: Vec<Option<Program>> =
        items.iter().map(|item| component(item, d, dimension, network, faults)).collect();
    Some(Field { components: components.into_iter().collect::<Option<Vec<Program>>>()? })
}

fn component(
    node: &Node,
    d: usize,
    dimension: Dimension,
    network: &Network,
    faults: &mut Faults,
) -> Option<Program> {
    let Value::Text(text) = &node.value else {
        return node.quantity(dimension, faults).map(Program::constant_of);
    };
    let starts_as_number =
        text.trim_start().starts_with(|c: char| c.is_ascii_digit() || c == '.' || c == '-');
    if Quantity::parse(text).is_ok() || starts_as_number && !text.contains(['*', '(', '+', '/']) {
        // The reader of quantities says best what is wrong with one.
        return node.quantity(dimension, faults).map(Program::constant_of);
    }
    let mut names: Vec<(&str, Dimension)> =
        ["x", "y", "z"].into_iter().take(d).map(|name| (name, Dimension::LENGTH)).collect();
    names.push(("t", Dimension::TIME));
    let compiled = Expression::parse(text, &node.place)
        .map_err(|fault| vec![fault])
        .and_then(|expression| expression.compile(&names, &network.parameters, dimension));
    compiled.map_err(|found| faults.list.extend(found)).ok()
}
