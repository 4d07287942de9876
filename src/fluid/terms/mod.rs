//! One equation each. A term is one-sided: what i gains from j, and touches nothing but its output.
//!
//! Volumes enter as 2 V_i V_j where the papers print (V_i² + V_j²), and as V_j W where they print V_j² W. For
//! equal volumes that is the same; where a solid has a finer lattice than the fluid only the product counts
//! every piece of volume once. Dividing 2 V_i V_j by m_i = rho_i V_i leaves 2 V_j / rho_i, so the force terms
//! sum 2 V_j (…) and the sweep divides by rho_i.

pub mod continuity;
pub mod density_diffusion;
pub mod pressure;
pub mod shift;
pub mod transport_stress;
pub mod viscosity;

pub use continuity::Continuity;
pub use density_diffusion::DensityDiffusion;
pub use pressure::Pressure;
pub use shift::Shift;
pub use transport_stress::TransportStress;
pub use viscosity::Viscosity;
