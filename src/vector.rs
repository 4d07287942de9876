//! Small vectors of `D` components, on nalgebra.

/// A vector of `D` components (a place in m, a velocity in m/s, …).
pub type Vector<const D: usize> = nalgebra::SVector<f64, D>;
