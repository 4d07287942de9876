//! Rate expressions.

/// A compiled expression: a stack program over numbered variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {}
