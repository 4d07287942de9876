//! Elastic solids: total-Lagrangian smoothed particle hydrodynamics. Knows particles, never a fluid or a species.
//!
//! | file | idea |
//! |---|---|
//! | [`material`] | stress as a function of the deformation gradient |
//! | [`bonds`] | neighbours of the undeformed solid, the corrected gradient |
//! | [`elastic`], `force`, `step` | a solid in motion; its internal forces; one step |
//! | `consistent` | gradients that balance constant stress with its traction, conservative hourglass control |
//! | [`limit`] | its fastest mode and the longest stable step |
//! | [`measure`] | momentum, energy, stress |
//! | [`relax`], `unbalanced` | equilibrium without motion; why there is none |
//! | [`shell`], [`surface`] | closed walls column by column; their surfaces and the volume inside |
//! | [`turgor`] | the pressure of what a wall encloses |
//! | [`recover`] | stress of a wall by a fit over neighbours |
//! | [`growth`], [`insert`] | irreversible growth along a wall; new columns where it gets sparse |
//! | [`vessel`] | a wall always in equilibrium, as it softens and grows |
//! | [`outline`], [`hull`], [`breach`] | length, width and curvature of a projection; convex hulls; ways out |
//! | [`jaumann`], `nearby` | the updated-Lagrangian form, for comparison; neighbours of particles that move |
//! | [`body`] | what all forms show |
//! | [`state`] | what must be kept to go on later |

pub mod body;
pub mod bonds;
pub mod breach;
#[cfg(test)]
mod cases;
mod consistent;
pub mod elastic;
mod force;
pub mod growth;
pub mod hull;
pub mod insert;
pub mod jaumann;
pub mod limit;
pub mod material;
pub mod measure;
mod nearby;
pub mod outline;
pub mod recover;
pub mod relax;
pub mod shell;
pub mod state;
mod step;
pub mod surface;
pub mod turgor;
mod unbalanced;
pub mod vessel;

pub use body::Body;
pub use elastic::{Elastic, Hold, Options, Setup};
pub use insert::Birth;
pub use jaumann::{Form, Jaumann, JaumannState};
pub use limit::StepLimit;
pub use material::{Law, Material};
pub use relax::{Relaxation, Relaxed};
pub use shell::Wall;
pub use state::ElasticState;
pub use turgor::Turgor;
pub use vessel::{Growth, Vessel, VesselState};
