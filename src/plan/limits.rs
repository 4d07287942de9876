//! What would not fit: memory and numbers of steps.

use crate::error::{Fault, ModelError};
use crate::model::{Domain, Integrator, Model};

/// More steps than this are refused.
pub const MOST_STEPS: f64 = 1e9;

/// Rough numbers of a model before anything is made.
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimate {
    pub voxels: f64,
    /// Neighbours within the cut-off.
    pub neighbours: f64,
    pub bytes: f64,
}

/// Counts voxels and memory of a model for a number of realizations.
#[must_use]
pub fn estimate(model: &Model, realizations: u32) -> Estimate {
    let species = model.network.species.len() as f64;
    let (voxels, neighbours) = match &model.domain {
        Domain::WellMixed { .. } => (1.0, 0.0),
        Domain::Graph { volumes, links, .. } => {
            (volumes.len() as f64, 2.0 * links.len() as f64 / volumes.len() as f64)
        }
        Domain::Particles(domain) => {
            let d = domain.dimensions as i32;
            let content = |min: &crate::vector::Vector<3>, max: &crate::vector::Vector<3>| -> f64 {
                (0..domain.dimensions).map(|k| (max[k] - min[k]).max(0.0)).product()
            };
            let count: f64 = domain
                .groups
                .iter()
                .filter(|group| group.material.is_filled())
                .map(|group| {
                    let (low, high) = group.shape.bounds(&domain.min, &domain.max);
                    content(&low, &high) / group.spacing.powi(d)
                })
                .sum();
            let ball = [2.0, std::f64::consts::PI, 4.0 / 3.0 * std::f64::consts::PI][domain.dimensions - 1];
            (count, ball * domain.support.powi(d))
        }
    };
    let columns = (model.domain.group_names().len() + 1) as f64 * species;
    // Frames for the particle tables are kept until a realization is finished: place, velocity, four numbers.
    let frames = model.output.particles.as_ref().map_or(0.0, |(times, written)| {
        f64::from(realizations.min(*written)) * times.len() as f64 * voxels * (82.0 + 8.0 * species)
    });
    // A particle's state and lists; a neighbour's entry in lists, links and tables; a realization's amounts,
    // clocks and scratch; a number of the series and its concentration.
    // Flows that differ run side by side, one on a core.
    let cores = std::thread::available_parallelism().map_or(1.0, |n| n.get() as f64);
    let flows = if model.flows_differ() { f64::from(realizations).min(cores).max(1.0) } else { 1.0 };
    let bytes = flows * voxels * (400.0 + neighbours * 40.0)
        + f64::from(realizations) * voxels * (16.0 * species + 8.0)
        + f64::from(realizations) * columns * model.output.times.len() as f64 * 32.0
        + frames;
    Estimate { voxels, neighbours, bytes }
}

/// Memory that is free, bytes, where the system tells.
#[must_use]
pub fn available_memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib * 1024.0)
}

/// Refuses a model that needs more memory than there is.
pub fn check_memory(model: &Model, realizations: u32) -> Result<(), ModelError> {
    let need = estimate(model, realizations);
    let there = available_memory().unwrap_or(64.0 * 1024.0_f64.powi(3));
    if need.bytes <= 0.9 * there && need.voxels < f64::from(u32::MAX) {
        return Ok(());
    }
    // What one realization would need says which section asks for too much.
    let by_size = estimate(model, 1).bytes > 0.5 * need.bytes;
    let (place, remedy) = if by_size {
        (
            &model.places.domain,
            "make the spacing coarser or the domain smaller, or write fewer particle tables (output.particles: { times: [...] })",
        )
    } else {
        (
            &model.places.run,
            "run fewer realizations at a time (--realizations A..B) and join them by `gillesph merge`, or look less often (output.every)",
        )
    };
    Err(Fault::at(
        place,
        format!(
            "the model would need about {} of memory, and {} are free: {:.3e} voxels with {:.0} neighbours each, {realizations} realizations, {} output times",
            bytes(need.bytes),
            bytes(there),
            need.voxels,
            need.neighbours,
            model.output.times.len()
        ),
        remedy,
    )
    .into())
}

/// An amount of memory in words.
fn bytes(n: f64) -> String {
    let units = [(1e15, ""), (1e12, "TB"), (1e9, "GB"), (1e6, "MB")];
    match units.iter().find(|(size, _)| n >= *size) {
        Some((_, "")) => format!("{:.1e} TB", n / 1e12),
        Some((size, unit)) => format!("{:.1} {unit}", n / size),
        None => format!("{:.0} kB", n / 1e3),
    }
}

/// Refuses a step of forward Euler, if that is the integrator, with which diffusion alone would be unstable.
pub fn check_euler(model: &Model, longest: f64) -> Result<(), ModelError> {
    match (model.chemistry.integrator, model.chemistry.step) {
        (Integrator::Euler, Some(step)) if step > longest * (1.0 + 1e-9) => Err(Fault::at(
            &model.places.chemistry,
            format!("forward Euler is unstable with a step of {step:.3e} s"),
            format!(
                "make chemistry.step shorter, at best below {:.3e} s, or remove `integrator`",
                0.5 * longest
            ),
        )
        .into()),
        _ => Ok(()),
    }
}

/// Refuses a run of too many steps.
pub fn check_steps(
    place: &crate::error::Place,
    what: &str,
    step: f64,
    limited_by: &str,
    duration: f64,
) -> Result<(), ModelError> {
    let steps = duration / step;
    if steps <= MOST_STEPS {
        return Ok(());
    }
    Err(Fault::at(
        place,
        format!("{steps:.3e} {what} steps of {step:.3e} s would be needed for {duration:.3e} s; at most 1e9 are allowed"),
        format!("the step is set by {limited_by}; relax that, or make run.until shorter"),
    )
    .into())
}
