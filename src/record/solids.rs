//! What the record says of elastic solids.

use serde::{Deserialize, Serialize};

/// An elastic solid and the numbers that go with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolidRecord {
    pub name: String,
    pub particles: usize,
    /// At rest, m.
    pub spacing: f64,
    /// Where it is thinnest, m.
    pub thickness: f64,
    /// By name: `saint_venant_kirchhoff` or `neo_hookean`.
    pub law: String,
    /// By name: `total_lagrangian` or `jaumann`.
    pub method: String,
    /// kg/m³.
    pub density: f64,
    /// Pa.
    pub bulk_modulus: f64,
    pub shear_modulus: f64,
    pub youngs_modulus: f64,
    pub poisson_ratio: f64,
    /// √(K/ρ), m/s.
    pub sound_speed: f64,
    /// Longest step at the start, s, and what limits it.
    pub step: f64,
    pub limited_by: String,
    /// Particles that are clamped, and that are driven.
    pub clamped: usize,
    pub driven: usize,
    /// What softens it, in words; empty if nothing does.
    pub softening: String,
    /// Of a wall in balance with what it encloses, in words: its columns, how well it is in balance, the pressure inside, how
    /// it grows. Empty for what moves, and where there is none of it.
    #[serde(default)]
    pub columns: String,
    #[serde(default)]
    pub balance: String,
    #[serde(default)]
    pub turgor: String,
    #[serde(default)]
    pub growth: String,
}
