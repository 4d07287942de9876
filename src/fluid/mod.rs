//! The fluid: weakly compressible smoothed particle hydrodynamics with a transport velocity and walls found
//! from a volume fraction (SPH-BVF). Knows particles, never a species.
//!
//! | file | idea |
//! |---|---|
//! | [`order`], [`candidates`], [`blocks`] | particles in the order of a space-filling curve; who may come near whom; neighbour lists in blocks of them |
//! | [`setup`], [`motion`] | what a flow is made of; how solids move |
//! | [`depth`], [`mirror`], `carried` | next to solids: how deep their particles lie; what they show; what of the drift's momentum counts |
//! | [`particles`], [`pass`], [`physics`], [`terms`] | state; the sweeps over pairs; what they add up; one equation each |
//! | [`wide`] | the sweeps and the lists once more for processors with AVX2 |
//! | [`noise`], `filter`, `reaction` | thermal noise; Shepard's filter; what the fluid does to solids |
//! | [`flow`], [`integrate`], [`limit`], `fault` | the flow as a whole; one time step; the longest stable one; what is said when it blows up |
//! | [`wall`], `sponge` | walls and pumps and what they do to particles |
//! | [`rigid`], [`elastic`], [`bodies`], [`deform`] | a body the fluid moves; one it bends too; those of a flow; solids that deform as told |
//! | [`open`], `buffers` | ends where particles enter and leave; what is prescribed beyond them |
//! | [`observe`], `thermometer` | snapshots and health of a flow; its temperature |
//! | [`weights`], [`exchange`], [`interpolate`] | conductances for the chemistry, ours and as printed; fields at points |
//! | `outline`, `edges`, [`surface`] | mirror images behind obstacles; where voxels end without; what they face of a surface |
//!
//! Sources: Jacob et al. 2021 (SPH-BVF); Adami, Hu & Adams 2012, 2013; Antuono et al. 2010. All SI.

mod balance;
pub mod blocks;
pub mod bodies;
mod buffers;
pub mod candidates;
mod carried;
pub mod deform;
pub mod depth;
mod edges;
pub mod elastic;
pub mod exchange;
mod fault;
mod filter;
pub mod flow;
mod image;
pub mod integrate;
pub mod interpolate;
pub mod limit;
pub mod mirror;
pub mod motion;
pub mod noise;
pub mod observe;
pub mod open;
pub mod order;
mod outline;
pub mod particles;
pub mod pass;
pub mod physics;
pub mod reaction;
pub mod rigid;
pub mod setup;
mod sponge;
mod state;
pub mod surface;
pub mod symmetric;
pub mod terms;
mod thermometer;
pub mod wall;
pub mod weights;
pub mod wide;

pub use crate::space::{Domain, Grid, Kernel, KernelKind};
pub use bodies::BodyState;
pub use deform::Deformation;
pub use elastic::Coupled;
pub use exchange::{Barrier, Voxels};
pub use flow::Flow;
pub use image::Image;
pub use interpolate::Interpolator;
pub use limit::StepLimit;
pub use motion::Motion;
pub use observe::{FlowHealth, LARGEST_DENSITY_CHANGE, LARGEST_MACH, Snapshot};
pub use open::{End, Open};
pub use rigid::Free;
pub use setup::{
    Body, BodyKind, EquationOfState, Friction, Method, Noise, Options, Placed, Setup, Slip, Sponge,
};
pub use weights::Weights;
