//! Diffusion on a weighted graph of voxels, exact over a step of any length while the graph is frozen.
//!
//! A molecule of diffusivity D hops i -> j at rate D G_ij / V_i. Uniformised (Jensen 1953; Grassmann 1977):
//! it makes K ~ Poisson(Λ τ) virtual jumps of the chain P = 1 + Q / Λ, Λ ≥ max_i Σ_j D G_ij / V_i, where a
//! jump may lead back to where it started. P does not depend on D, so species of equal habitat share it where they pass
//! no surface.
//!
//! What enters and leaves through surfaces is linear too and belongs to the same chain: each way through a surface is a
//! row more, a [`Door`] to which molecules jump from the voxels before it and from which they come. So a concentration
//! held at a surface is exact over a step of any length, as diffusion is.

mod alias;
pub mod bath;
pub mod continuous;
pub mod discrete;
mod few;
pub mod hops;
pub mod jumps;

pub use bath::{ALL, Bath, Door, Open};
pub use hops::HopTable;
pub use jumps::Jumps;
