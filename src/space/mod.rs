//! The space particles share: the box, who is near whom, and how near counts.
//!
//! | file | idea |
//! |---|---|
//! | [`kernel`] | W and its gradient |
//! | [`domain`] | the box: corners, periodic axes, the shortest way |
//! | [`neighbours`] | cells of a cut-off's width |
//! | [`matrix`] | small square matrices of `D` rows |

pub mod domain;
pub mod kernel;
pub mod matrix;
pub mod neighbours;

pub use domain::Domain;
pub use kernel::{Kernel, KernelKind};
pub use neighbours::Grid;
