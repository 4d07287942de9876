//! Shapes, and the lattices of particles that fill them. Lengths in m.

pub mod lattice;
pub mod shape;

pub use lattice::{Fill, Lattice, fill};
pub use shape::Shape;
