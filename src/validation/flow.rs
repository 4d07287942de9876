//! Flows of shipped models, looked at while they run.

use super::{Row, Shipped, failed, planned};
use crate::error::RunError;
use crate::fluid::{Flow, Snapshot};
use crate::plan::{Arena, ParticlePlan};
use crate::scene::Scene;
use crate::vector::Vector;
use std::time::Instant;

/// A flow at one time.
pub struct Look<'a, const D: usize> {
    /// s.
    pub time: f64,
    pub plan: &'a ParticlePlan<D>,
    /// m^D; of each fluid particle, as the two below.
    pub volume: Vec<f64>,
    /// m.
    pub position: Vec<Vector<D>>,
    /// Momentum velocity, m/s.
    pub velocity: Vec<Vector<D>>,
    /// kg/m³.
    pub density: Vec<f64>,
}

impl<'a, const D: usize> Look<'a, D> {
    fn new(plan: &'a ParticlePlan<D>, flow: &Flow<D>) -> Look<'a, D> {
        let Snapshot { position, velocity, density, volume, .. } = flow.snapshot();
        let fluid: Vec<usize> = (0..position.len()).filter(|&i| plan.flows(plan.home[i])).collect();
        Look {
            time: flow.time(),
            plan,
            volume: fluid.iter().map(|&i| volume[i]).collect(),
            position: fluid.iter().map(|&i| position[i]).collect(),
            velocity: fluid.iter().map(|&i| velocity[i]).collect(),
            density: fluid.iter().map(|&i| density[i]).collect(),
        }
    }

    /// Places and velocities.
    pub fn particles(&self) -> impl Iterator<Item = (&Vector<D>, &Vector<D>)> {
        self.position.iter().zip(&self.velocity)
    }

    /// Largest speed, m/s.
    #[must_use]
    pub fn fastest(&self) -> f64 {
        self.velocity.iter().map(|v| v.norm()).fold(0.0, f64::max)
    }

    /// Σ m v²/2 per unit of what is not simulated, J/m^(3-D).
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        let mass = self.density.iter().zip(&self.volume).map(|(rho, v)| rho * v);
        mass.zip(&self.velocity).map(|(m, v)| 0.5 * m * v.norm_squared()).sum()
    }

    /// Root of the mean square of what `difference` makes of place and velocity.
    #[must_use]
    pub fn rms(&self, difference: impl Fn(&Vector<D>, &Vector<D>) -> f64) -> f64 {
        let sum: f64 = self.particles().map(|(x, v)| difference(x, v).powi(2)).sum();
        (sum / self.position.len() as f64).sqrt()
    }
}

/// How a flow ended.
#[derive(Clone, Debug, Default)]
pub struct End {
    /// When, s.
    pub time: f64,
    pub penetrations: u64,
    pub largest_density_change: f64,
    pub particle_steps: u64,
    /// Wall time, s.
    pub seconds: f64,
}

impl End {
    /// Rows every case has: penetrations (none allowed), density change, wall time.
    #[must_use]
    pub fn rows(&self, what: &str) -> Vec<Row> {
        let penetrations = self.penetrations as f64;
        vec![
            Row {
                quantity: format!("{what}: penetrations"),
                ours: penetrations,
                reference: Some(0.0),
                error: penetrations,
                limit: 0.0,
                ..Row::default()
            },
            Row {
                quantity: format!("{what}: largest density change"),
                ours: self.largest_density_change,
                reference: Some(0.0),
                error: self.largest_density_change,
                // What the program warns of.
                limit: 0.05,
                ..Row::default()
            },
            stated(format!("{what}: wall time, s"), self.seconds),
            stated(
                format!("{what}: million particle-steps per second"),
                1e-6 * self.particle_steps as f64 / self.seconds,
            ),
        ]
    }
}

/// A number that is told, not judged.
#[must_use]
pub fn stated(quantity: String, ours: f64) -> Row {
    Row { quantity, ours, limit: f64::INFINITY, ..Row::default() }
}

/// An error against zero with a limit.
#[must_use]
pub fn judged(quantity: String, error: f64, published: Option<f64>, limit: f64) -> Row {
    Row { quantity, ours: error, published, reference: Some(0.0), error, limit }
}

/// The values to set for a square lattice of `n` across a box of side one.
#[must_use]
pub fn across(n: u32) -> Vec<String> {
    vec![format!("particles.spacing={} m", 1.0 / f64::from(n))]
}

/// When a flow is looked at, and how it steps.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// s.
    pub every: f64,
    /// Part of the longest step that is taken.
    pub share: f64,
}

impl From<f64> for Pace {
    fn from(every: f64) -> Pace {
        Pace { every, share: 1.0 }
    }
}

/// Runs the flow of a plane model and looks at it at a pace (and at the start) until `see` has seen enough (`false`)
/// or the model's end.
pub fn watch_plane(
    shipped: &Shipped,
    overrides: &[String],
    pace: impl Into<Pace>,
    see: impl FnMut(&Look<2>) -> bool,
) -> Result<End, RunError> {
    watch_plane_from(shipped, overrides, pace, |_| {}, see)
}

/// The same from what `prepare` makes of the flow at the start.
pub fn watch_plane_from(
    shipped: &Shipped,
    overrides: &[String],
    pace: impl Into<Pace>,
    prepare: impl FnOnce(&mut Flow<2>),
    see: impl FnMut(&Look<2>) -> bool,
) -> Result<End, RunError> {
    planned(shipped, overrides, |plan, _| match &plan.arena {
        Arena::Plane(arena) => watch(arena, plan.model.run.until, pace.into(), prepare, see),
        _ => Err(failed("the model is not plane".into())),
    })
}

/// The same in space.
pub fn watch_space(
    shipped: &Shipped,
    overrides: &[String],
    pace: impl Into<Pace>,
    see: impl FnMut(&Look<3>) -> bool,
) -> Result<End, RunError> {
    planned(shipped, overrides, |plan, _| match &plan.arena {
        Arena::Space(arena) => watch(arena, plan.model.run.until, pace.into(), |_| {}, see),
        _ => Err(failed("the model is not in space".into())),
    })
}

fn watch<const D: usize>(
    plan: &ParticlePlan<D>,
    until: f64,
    Pace { every, share }: Pace,
    prepare: impl FnOnce(&mut Flow<D>),
    mut see: impl FnMut(&Look<D>) -> bool,
) -> Result<End, RunError> {
    let begun = Instant::now();
    let mut flow = Scene::new(plan, 0)?.flow.ok_or_else(|| failed("the model has no flow".into()))?;
    prepare(&mut flow);
    let longest = share * flow.step_limit().seconds;
    let looks = (until / every).round().max(1.0) as u32;
    let steps = (until / f64::from(looks) / longest).ceil().max(1.0);
    let dt = until / f64::from(looks) / steps;
    let mut go_on = see(&Look::new(plan, &flow));
    for _ in 0..looks {
        if !go_on {
            break;
        }
        flow.advance(dt, steps as u64)?;
        go_on = see(&Look::new(plan, &flow));
    }
    let health = flow.health();
    Ok(End {
        time: flow.time(),
        penetrations: health.penetrations,
        largest_density_change: health.largest_density_change,
        particle_steps: flow.particle_steps(),
        seconds: begun.elapsed().as_secs_f64(),
    })
}
