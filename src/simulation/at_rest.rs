//! Event-driven realizations on particles that stay where they are: no step, no splitting.

use super::each::{Found, each};
use super::events;
use super::keep::{Keep, PIECE, Share, Shown};
use super::particles::Ready;
use super::realization::Reservoirs;
use super::{Finish, Watch};
use crate::chemistry::sampling_numbers::poisson;
use crate::chemistry::ssa::System;
use crate::model::Method;
use crate::random::{Purpose, stream};
use crate::sampling::{Lens, Observed};
use std::time::Instant;

impl<const D: usize> Ready<'_, D> {
    /// Realizations one by one.
    pub(super) fn run_events(
        &self,
        realizations: &[u32],
        method: Method,
        watch: &Watch,
        keep: &dyn Keep,
    ) -> Finish {
        watch.begin(realizations.len() as u64, "realizations");
        let system = self.system();
        let lens = Lens::new(self.plan, &self.scene);
        each(realizations, 1, watch, |numbers| {
            numbers.iter().map(|&n| (n, self.one(&system, &lens, method, n, (watch, keep)))).collect()
        })
    }

    /// The reactions and hops of the scene, with sponges as births and deaths and with held Poisson numbers by
    /// their means.
    fn system(&self) -> System<'_> {
        let mut system = System::new(&self.plan.reactor, &self.frozen);
        for sponge in &Reservoirs::new(self.plan, &self.scene).sponges {
            system.add_sponge(&sponge.voxels, sponge.species, sponge.rate, &sponge.targets);
        }
        for (species, voxels, _) in &self.start.held_poisson {
            system.hold_means(voxels, *species);
        }
        system
    }

    fn one(
        &self,
        system: &System,
        lens: &Lens<D>,
        method: Method,
        number: u32,
        (watch, keep): (&Watch, &dyn Keep),
    ) -> Found {
        let begun = Instant::now();
        let (model, count) = (&self.plan.model, self.plan.reactor.species.len());
        let key = (model.run.seed, u64::from(number));
        let amounts = self.start.deal(key);
        let mut seen = Shown::new(Observed::new(number), keep, PIECE);
        let Some(mut played) = events::start(method, &model.chemistry, system, amounts, key)? else {
            return Ok(false);
        };
        let mut reservoirs = stream(key.0, key.1, Purpose::Reservoirs);
        let mut shown = Vec::new();
        let times = &model.output.times;
        let share = events::play(system, played.as_mut(), times, watch, |time, amounts| {
            // A held Poisson number is dealt anew whenever it is shown; it acts by its mean.
            shown.clear();
            shown.extend_from_slice(amounts);
            for (s, voxels, means) in &self.start.held_poisson {
                for (&voxel, &mean) in voxels.iter().zip(means) {
                    shown[voxel as usize * count + s] = poisson(&mut reservoirs, mean) as f64;
                }
            }
            lens.look(&shown, time, false, &mut seen.observed);
            seen.looked();
        })?;
        let Some(share) = share else { return Ok(false) };
        seen.finish(Share { seconds: begun.elapsed().as_secs_f64(), ..share })?;
        Ok(true)
    }
}
