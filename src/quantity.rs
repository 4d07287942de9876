//! Numbers with units as people write them -> SI.

/// Powers of (metre, kilogram, second, kelvin, mole).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Dimension(pub [i8; 5]);

/// A value in SI units and its dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    pub value: f64,
    pub dimension: Dimension,
}
