//! Elastic solids: total-Lagrangian smoothed particle hydrodynamics. Knows particles, never a fluid or a species.
//!
//! | file | idea |
//! |---|---|
//! | [`material`] | stress as a function of the deformation gradient |
//! | [`bonds`] | neighbours of the undeformed solid, the corrected gradient |
//! | [`elastic`], `force`, `step` | a solid in motion; its internal forces; one step |
//! | [`limit`] | its fastest mode and the longest stable step |
//! | [`measure`] | momentum, energy, stress |
//! | [`relax`] | equilibrium without motion |
//! | [`shell`], [`surface`] | closed walls column by column; their surfaces and the volume inside |
//! | [`turgor`] | the pressure of what a wall encloses |

pub mod bonds;
pub mod elastic;
mod force;
pub mod limit;
pub mod material;
pub mod measure;
pub mod relax;
pub mod shell;
mod step;
pub mod surface;
pub mod turgor;

pub use elastic::{Elastic, Hold, Options, Setup};
pub use material::{Law, Material};
pub use relax::{Relaxation, Relaxed};
pub use shell::Wall;
pub use turgor::Turgor;
