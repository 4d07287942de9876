//! One equation each. A term is what i gains from j, and touches nothing but its output.
//!
//! Volumes enter as 2 V_i V_j where the papers print (V_i² + V_j²), and as V_j W where they print V_j² W. For
//! equal volumes that is the same; where a solid has a finer lattice than the fluid only the product counts
//! every piece of volume once. A term gives the force over V_i V_j: the sweep adds V_j of it to the force per
//! volume of i and, the forces being antisymmetric, takes V_i of it from that of j.

pub mod continuity;
pub mod density_diffusion;
pub mod moment;
pub mod pressure;
pub mod shift;
pub mod transport_stress;
pub mod viscosity;

pub use continuity::Continuity;
pub use density_diffusion::DensityDiffusion;
pub use moment::Moment;
pub use pressure::Pressure;
pub use shift::Shift;
pub use transport_stress::TransportStress;
pub use viscosity::Viscosity;

#[cfg(test)]
pub(crate) mod tests;
