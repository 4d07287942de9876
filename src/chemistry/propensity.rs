//! Flat compiled propensity tables.

/// Compiled propensities of a network.
#[derive(Clone, Debug)]
pub struct Propensities {}
