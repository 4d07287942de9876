//! The chemistry steps on particles: what bounds them, what they cost in accuracy, and how a run tells of them.

use super::solids::AT_EACH;
use super::{Ready, event_driven, shortest};
use crate::chemistry::network::{Surface, SurfaceKind};
use crate::chemistry::split::{Feed, Frozen, SplittingError, StepBounds, splitting_error, step_bounds};
use crate::chemistry::{AVOGADRO, Rate};
use crate::model::{FlowFile, Integrator};
use crate::plan::start::Start;
use crate::plan::{Lift, ParticlePlan, Plan};
use crate::quantity::readable::show;
use crate::record::{StepRecord, StepsRecord};
use crate::scene::Scene;
use crate::simulation::clock::Interval;
use crate::simulation::realization::Reservoirs;
use crate::simulation::{FORWARD_EULER, euler_caveat, events, hybrids};

impl<const D: usize> Ready<'_, D> {
    /// Steps and what limits them.
    #[must_use]
    pub fn steps(&self) -> StepsRecord {
        if let Some(method) = event_driven(self.plan) {
            return StepsRecord {
                method: events::words(method).into(),
                approximations: events::approximations(method, &self.plan.model.chemistry)
                    .into_iter()
                    .chain(self.scene.plan.weights.caveat().map(String::from))
                    .collect(),
                ..StepsRecord::default()
            };
        }
        let longest = self.clock.iter().map(Interval::tick).fold(0.0, f64::max);
        let ticks: u64 = self.clock.iter().map(|i| i.ticks).sum();
        let limited_by = if longest < 0.5 * self.chemistry_step {
            "the output times".to_string()
        } else {
            self.chemistry_limit.clone()
        };
        let finest = self
            .clock
            .iter()
            .filter(|i| i.fluid_steps > 0)
            .map(|i| i.tick() / i.fluid_steps as f64)
            .fold(0.0, f64::max);
        let discrete = self.plan.reactor.discrete.iter().filter(|&&d| d).count();
        let euler = self.plan.model.chemistry.integrator == Integrator::Euler;
        let method = match discrete {
            0 if euler => FORWARD_EULER,
            _ if self.plan.reactor.hybrid.is_some() => {
                "each species discrete or continuous voxel by voxel, Strang splitting"
            }
            0 => "rate equations, diffusion by the exact exponential, Strang splitting",
            n if n == self.plan.reactor.discrete.len() => {
                "exact sampling of diffusion and reaction in turn, Strang splitting"
            }
            _ => "discrete and continuous species side by side, Strang splitting",
        };
        let replayed = matches!(self.plan.model.flow, Some(FlowFile::Replay(_)));
        let split = match (self.moves() || replayed, self.splitting.is_some() || self.frozen.reacts()) {
            (true, true) => "motion, diffusion and reaction",
            (true, false) => "motion and diffusion",
            (false, true) => "diffusion and reaction",
            (false, false) => "",
        };
        let in_time = if euler {
            Some(euler_caveat(longest))
        } else {
            let order = || {
                format!("splitting of {split}: second order in the chemistry step of {}", show(longest, "s"))
            };
            (!split.is_empty()).then(order)
        };
        StepsRecord {
            fluid: self.fluid.as_ref().map(|(_, limited_by)| StepRecord {
                step: finest,
                count: self.clock.iter().map(|i| i.ticks * i.fluid_steps).sum(),
                limited_by: if self.clock.iter().all(|i| i.fluid_steps <= 1) {
                    "the chemistry step".into()
                } else {
                    limited_by.clone()
                },
            }),
            solid: shortest(&self.solid_steps).map(|limit| StepRecord {
                step: if self.scene.plan.is_balanced() { longest } else { limit.seconds },
                count: match self.fluid {
                    None if self.scene.plan.is_balanced() => ticks,
                    // Several of its own in each step of the fluid.
                    Some(_) => {
                        let each =
                            |i: &Interval| (i.tick() / i.fluid_steps.max(1) as f64 / limit.seconds).ceil();
                        self.clock.iter().map(|i| i.ticks * i.fluid_steps * each(i) as u64).sum()
                    }
                    None => (self.plan.model.run.until / limit.seconds).ceil() as u64,
                },
                limited_by: if self.scene.plan.is_balanced() {
                    AT_EACH.into()
                } else {
                    limit.limited_by.clone()
                },
            }),
            chemistry: Some(StepRecord { step: longest, count: ticks, limited_by }),
            method: method.into(),
            approximations: hybrids::approximations(self.plan, in_time, self.splitting.as_ref())
                .into_iter()
                .chain(self.scene.plan.weights.caveat().map(String::from))
                .collect(),
            splitting_error: self.splitting.map(|(error, _)| error.relative),
            shared_flow: (self.moves() || replayed) && !self.plan.model.flows_differ(),
        }
    }
}

/// The error of splitting with the steps of the clock, the particles at rest.
pub(super) fn estimate<const D: usize>(
    plan: &Plan,
    scene: &Scene<D>,
    frozen: &Frozen,
    start: &Start,
    clock: &[Interval],
) -> Option<(SplittingError, f64)> {
    if plan.model.chemistry.integrator == Integrator::Euler {
        return None; // nothing is split
    }
    let longest = clock.iter().map(Interval::tick).fold(0.0, f64::max);
    let ticks: u64 = clock.iter().map(|i| i.ticks).sum();
    let count = plan.reactor.species.len();
    let sponges = Reservoirs::new(plan, scene).sponges;
    let feed = |state: &mut [f64], dt: f64| {
        for sponge in &sponges {
            let gone = -(-sponge.rate * dt).exp_m1();
            for (&i, &target) in sponge.voxels.iter().zip(&sponge.targets) {
                let n = &mut state[i as usize * count + sponge.species];
                *n += (target - *n) * gone;
            }
        }
    };
    let feed: Option<&Feed> = if sponges.is_empty() { None } else { Some(&feed) };
    let error = splitting_error(&plan.reactor, frozen, &start.means(), (longest, ticks), feed)?;
    Some((error, error.steps as f64 * longest))
}

/// Bounds of the chemistry step, from the amounts at the start with what sponges and surfaces hold put in.
pub(super) fn bounds<const D: usize>(
    plan: &Plan,
    scene: &Scene<D>,
    frozen: &Frozen,
    start: &Start,
) -> StepBounds {
    let count = plan.reactor.species.len();
    let mut amounts = start.means();
    for sponge in &Reservoirs::new(plan, scene).sponges {
        for (&i, &target) in sponge.voxels.iter().zip(&sponge.targets) {
            amounts[i as usize * count + sponge.species] = target;
        }
    }
    for reaction in &plan.network.reactions {
        if let Rate::Surface(Surface { kind: SurfaceKind::Held(c), .. }) = &reaction.rate {
            let s = reaction.products[0].0;
            // The highest concentration anywhere counts, so one voxel stands for all.
            if let Some(i) = (0..scene.volumes.len()).find(|&i| plan.reactor.habitat[s].holds(scene.home[i]))
            {
                let n = &mut amounts[i * count + s];
                *n = n.max(AVOGADRO * c * scene.volumes[i]);
            }
        }
    }
    step_bounds(&plan.reactor, frozen, &amounts, plan.model.chemistry.hops, plan.model.chemistry.change)
}

/// Largest acceleration by buoyancy to be expected, m/s²: the largest difference from the reference among the amounts
/// at the start, what sponges draw to and what surfaces hold.
pub(super) fn buoyant_pull<const D: usize>(
    plan: &Plan,
    arena: &ParticlePlan<D>,
    scene: &Scene<D>,
    start: &Start,
) -> f64 {
    let (count, means) = (plan.reactor.species.len(), start.means());
    let sponges = Reservoirs::new(plan, scene).sponges;
    let pull = |lift: &Lift<D>| -> f64 {
        let s = lift.species;
        let there = (0..scene.volumes.len()).map(|i| (i, means[i * count + s]));
        let drawn = sponges
            .iter()
            .filter(|sponge| sponge.species == s)
            .flat_map(|sponge| sponge.voxels.iter().map(|&i| i as usize).zip(sponge.targets.iter().copied()));
        let concentrations = there
            .filter(|&(i, _)| plan.reactor.habitat[s].holds(arena.home[i]))
            .chain(drawn)
            .map(|(i, n)| n / (AVOGADRO * scene.volumes[i]));
        let held = plan.network.reactions.iter().filter_map(|reaction| match &reaction.rate {
            Rate::Surface(Surface { kind: SurfaceKind::Held(c), .. }) if reaction.products[0].0 == s => {
                Some(*c)
            }
            _ => None,
        });
        let most = concentrations.chain(held).fold(0.0_f64, |most, c| most.max((c - lift.reference).abs()));
        lift.gravity.norm() * lift.expansion.abs() * most
    };
    arena.lifts.iter().map(pull).sum()
}
