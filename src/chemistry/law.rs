//! Rate expressions: `vmax * S / (km + S)`, read once, checked for dimensions, compiled to a flat program.
//!
//! Operators by rising precedence: comparisons, `+ -`, `* /`, unary minus, `^` (to the right); functions are
//! listed in [`function_names`]. A number may carry a unit after a space (`10 um`, `1 uM/s`); a number
//! without one is SI and fits any dimension. Comparisons give 1 or 0.

mod compile;
mod dimensions;
mod lexer;
mod parser;
mod program;

pub use program::Program;

use crate::error::{Fault, Place};
use crate::quantity::{Dimension, Quantity, TextFault};
use parser::Tree;

/// A parsed rate expression.
#[derive(Clone, Debug)]
pub struct Expression {
    tree: Tree,
    text: String,
    place: Place,
}

impl Expression {
    /// Reads an expression; `place` is where its first character stands.
    ///
    /// # Errors
    /// The first place where the text is no expression.
    pub fn parse(text: &str, place: &Place) -> Result<Expression, Fault> {
        match parser::parse(text) {
            Ok(tree) => Ok(Expression { tree, text: text.trim().to_string(), place: place.clone() }),
            Err(fault) => Err(fault_at(place, fault)),
        }
    }

    /// Compiles for these variables (numbered as given) and constants; the result must have the dimension
    /// `expected`. Constants without dimension and bare numbers fit any dimension.
    ///
    /// # Errors
    /// Unknown names, dimensions that do not fit, constant parts that are not finite; all of them.
    pub fn compile(
        &self,
        variables: &[(&str, Dimension)],
        constants: &[(String, Quantity)],
        expected: Dimension,
    ) -> Result<Program, Vec<Fault>> {
        let names = compile::Names { variables, constants };
        let mut faults = compile::names(&self.tree, &names);
        if faults.is_empty() {
            faults = dimensions::check(&self.tree, &names, expected);
        }
        let program =
            if faults.is_empty() { compile::program(&self.tree, &names, &self.text) } else { Err(faults) };
        program.map_err(|faults| faults.into_iter().map(|f| fault_at(&self.place, f)).collect())
    }

    /// The names it uses that are no functions or built-in constants, each once, in order.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        self.tree.visit(&mut |tree| {
            if let parser::Kind::Name(name) = &tree.kind
                && name != "pi"
                && !names.contains(&name.as_str())
            {
                names.push(name);
            }
        });
        names
    }
}

/// Names of functions and built-in constants; species and parameters may not take them.
#[must_use]
pub fn function_names() -> Vec<&'static str> {
    parser::FUNCTIONS.iter().map(|f| f.name).chain(["pi"]).collect()
}

fn fault_at(place: &Place, fault: TextFault) -> Fault {
    Fault::at(&place.inside(fault.offset, fault.width), fault.reason, fault.remedy)
}

#[cfg(test)]
mod tests;
