//! **GilleSPH**: stochastic chemistry in moving fluids and living walls.
//!
//! Data flows one way; a module uses only what stands above it:
//!
//! ```text
//! YAML -> checked Model -> compiled Plan<D> -> stepping -> Samples -> statistics -> tables, figures, report
//! ```

pub mod error;
pub mod quantity;
pub mod random;
pub mod vector;

pub mod chemistry;
pub mod geometry;

pub mod fluid;
pub mod model;

pub mod plan;
pub mod simulation;

pub mod record;
pub mod sampling;
pub mod statistics;

pub mod figures;
pub mod report;
pub mod tables;
pub mod vtk;

pub mod ensemble;
pub mod results;
pub mod validation;

pub mod cli;
