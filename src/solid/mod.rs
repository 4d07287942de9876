//! Elastic solids: total-Lagrangian smoothed particle hydrodynamics. Knows particles, never a fluid or a species.
//!
//! | file | idea |
//! |---|---|
//! | [`material`] | stress as a function of the deformation gradient |
//! | [`bonds`] | neighbours of the undeformed solid, the corrected gradient |
//! | [`elastic`], `force`, `step` | a solid in motion; its internal forces; one step |
//! | [`limit`] | its fastest mode and the longest stable step |
//! | [`measure`] | momentum, energy, stress |
//! | [`jaumann`], `nearby` | the updated-Lagrangian form, for comparison; neighbours of particles that move |
//! | [`state`] | what must be kept to go on later |

pub mod bonds;
#[cfg(test)]
mod cases;
pub mod elastic;
mod force;
pub mod jaumann;
pub mod limit;
pub mod material;
pub mod measure;
mod nearby;
pub mod state;
mod step;

pub use elastic::{Elastic, Hold, Options, Setup};
pub use jaumann::{Form, Jaumann, JaumannState};
pub use limit::StepLimit;
pub use material::{Law, Material};
pub use state::ElasticState;
