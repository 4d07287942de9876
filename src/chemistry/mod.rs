//! Chemistry: reaction networks, propensities, exact samplers and rate equations on a weighted graph of
//! voxels. Knows amounts, volumes and [`Links`]; never a particle, never a file.

pub mod analysis;
pub mod deal;
pub mod diffusion;
pub mod drawing;
pub mod formula;
pub mod law;
pub mod links;
pub mod network;
pub mod propensity;
pub mod rate_equations;
pub mod reactor;
pub mod reservoir;
pub mod sampling_numbers;
pub mod split;
pub mod ssa;
pub mod words;

pub use links::Links;
pub use network::{Kinetics, Network, Rate, Reaction, Representation, Species};
pub use propensity::Propensities;
pub use reactor::{GroupSet, Reactor};

/// The Avogadro constant, 1/mol (SI, exact).
pub const AVOGADRO: f64 = 6.022_140_76e23;
