//! **GilleSPH**: stochastic chemistry in moving fluids and living walls.
//!
//! Data flows one way; a module uses only what stands above it:
//!
//! ```text
//! YAML -> checked Model -> compiled Plan -> stepping -> samples -> statistics -> tables, figures, report
//! ```
//!
//! | module | one line |
//! |---|---|
//! | [`error`], [`packet`], [`quantity`], [`random`], [`vector`] | faults with file, line and remedy; files that outlive a crash; numbers with units; named random streams; small vectors |
//! | [`chemistry`] | networks, propensities, exact samplers and rate equations on a weighted graph of voxels |
//! | [`geometry`] | shapes as signed distances, and the lattices that fill them |
//! | [`fluid`] | SPH-BVF: one file per equation, fused in one pass; conductances for the chemistry |
//! | [`model`] | YAML -> [`model::Model`], all faults at once; strings and units end here |
//! | [`plan`] | [`model::Model`] -> [`plan::Plan`]: reactor, particles, bodies, columns to observe |
//! | [`record`], [`samples`], [`scene`] | what a run says of itself; what it has shown; particles at an instant |
//! | [`sampling`], [`simulation`] | what is seen when; realizations on one flow, at rest, or event driven |
//! | [`statistics`], [`tables`] | pure functions on slices; Parquet in and out |
//! | [`comparison`] | two runs side by side: what differs, what would have been seen |
//! | [`figures`], [`report`], [`vtk`] | plots, the page, ParaView: read tables and record only |
//! | [`ensemble`] | many realizations from plan to tables: journal, states to resume from, joining blocks, sweeps |
//! | [`cluster`] | an ensemble as many jobs: folders of blocks, scripts for schedulers, where each block stands |
//! | [`import`] | models of other programs (SBML) -> files as a user would write them |
//! | [`validation`], [`cli`] | published cases; the command line |
//!
//! The joint between flow and chemistry is one value, [`chemistry::Links`], and the volumes: the chemistry never
//! sees a kernel, the fluid never a species.
//!
//! ```
//! use gillesph::{model, plan::Plan, simulation::{Ready, Watch}};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("decay.yaml");
//! std::fs::write(&path, "
//! name: decay
//! reactions: { species: [A], reactions: { decay: { equation: A -> 0, rate: 1 1/s } } }
//! domain: { kind: well_mixed, volume: 1 fL }
//! initial: { A: 100 }
//! run: { until: 1 s, realizations: 4 }
//! output: { times: [1 s] }
//! ")?;
//! let plan = Plan::new(model::load::model(&path, &[])?, 4)?;
//! let outcome = Ready::new(&plan)?.run(&[0, 1, 2, 3], &Watch::silent());
//! assert!(outcome.observed.iter().all(|one| one.series.amount[0] < 100.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod error;
pub mod packet;
pub mod quantity;
pub mod random;
pub mod vector;

pub mod chemistry;
pub mod geometry;

pub mod space;

pub mod solid;

pub mod fluid;
pub mod model;

pub mod plan;
pub mod record;
pub mod samples;
pub mod scene;

pub mod sampling;
pub mod simulation;

pub mod statistics;
pub mod tables;

pub mod comparison;

pub mod figures;
pub mod report;
pub mod vtk;

pub mod ensemble;

pub mod cluster;
pub mod import;
pub mod validation;

pub mod cli;
