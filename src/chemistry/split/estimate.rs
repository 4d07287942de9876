//! How large the error of splitting is: the rate equations with the step and with half of it.
//!
//! Strang splitting is of second order, so that of the difference between the two 4/3 is the error of the longer
//! step. Where that is not small the order is not to be trusted, and the step is halved on. It is the error of the
//! means in mean field; sampled models have it as well.

use super::Frozen;
use crate::chemistry::diffusion::continuous::Flow;
use crate::chemistry::diffusion::{ALL, Jumps};
use crate::chemistry::rate_equations::{Books, RateEquations, Voxel};
use crate::chemistry::reactor::Reactor;
use crate::error::RunError;

/// An error found by halving the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplittingError {
    /// Σ_voxels |error| / Σ_voxels amount of the species where it is largest.
    pub relative: f64,
    pub species: usize,
    /// Steps compared.
    pub steps: u64,
}

/// What acts on the amounts besides reactions and diffusion, for a time in s.
pub type Feed<'a> = dyn Fn(&mut [f64], f64) + 'a;

/// Elementary operations spent on it at most; some tenths of a second.
const BUDGET: f64 = 5e7;

/// Operations of a reaction in a voxel: a step of the rate equations.
const PER_REACTION: f64 = 50.0;

/// The error after `steps` steps of `step` seconds from `amounts` on the frozen geometry, or after as many as the
/// budget allows; not a number if even one is too much. `feed` is what acts besides reactions and diffusion, for a
/// time in s, before and after each step. `None` where nothing is split, or where the rate equations fail.
#[must_use]
pub fn splitting_error(
    reactor: &Reactor,
    frozen: &Frozen,
    amounts: &[f64],
    (step, steps): (f64, u64),
    feed: Option<&Feed>,
) -> Option<SplittingError> {
    let diffusing: Vec<usize> = (0..reactor.species_count()).filter(|&s| frozen.table(s).is_some()).collect();
    let reacting: usize = (0..frozen.voxels())
        .map(|i| {
            let (sampled, integrated) = frozen.reactions(i);
            sampled.len() + integrated.len()
        })
        .sum();
    if diffusing.is_empty() || reacting == 0 && feed.is_none() || steps == 0 {
        return None;
    }
    // What one step costs: each stage of diffusion goes once over the entries of its table.
    let cost = |step: f64| -> f64 {
        let moves = diffusing.iter().filter_map(|&s| Some((frozen.ways(s)?, reactor.diffusivity[s])));
        let diffusion: f64 = moves
            .map(|(table, diffusivity)| {
                let (jumps, pieces) = Jumps::expected(diffusivity * table.rate * step);
                (table.entries() * jumps.tail.len() * pieces) as f64
            })
            .sum();
        diffusion + 2.0 * PER_REACTION * reacting as f64
    };
    let mut spent = cost(step) + 2.0 * cost(0.5 * step);
    let compared = steps.min((BUDGET / spent) as u64);
    if compared == 0 {
        return Some(SplittingError { relative: f64::NAN, species: 0, steps: 0 });
    }
    let mut field = MeanField { reactor, frozen, equations: RateEquations::default(), flow: Flow::default() };
    let mut run = |step: f64, steps: u64| -> Result<Vec<f64>, RunError> {
        let mut state = amounts.to_vec();
        for _ in 0..steps {
            if let Some(feed) = feed {
                feed(&mut state, 0.5 * step);
            }
            field.step(&mut state, step)?;
            if let Some(feed) = feed {
                feed(&mut state, 0.5 * step);
            }
        }
        Ok(state)
    };
    let count = reactor.species_count();
    let apart = |whole: &[f64], halved: &[f64], s: usize| {
        let total: f64 = halved.iter().skip(s).step_by(count).sum();
        let off: f64 = (s..whole.len()).step_by(count).map(|slot| (whole[slot] - halved[slot]).abs()).sum();
        // Less than a molecule in all is no measure.
        off / total.max(1.0)
    };
    let largest = |whole: &[f64], halved: &[f64]| {
        let found = (0..count).map(|s| (s, apart(whole, halved, s)));
        found.fold((0, 0.0), |most, next| if next.1 > most.1 { next } else { most })
    };
    let whole = run(step, compared).ok()?;
    let mut finer = run(0.5 * step, 2 * compared).ok()?;
    let (mut species, mut error) = largest(&whole, &finer);
    let mut last = 4.0 / 3.0;
    for halvings in 2..=MOST_HALVINGS {
        if error * last < SMALL {
            break;
        }
        let parts = 1_u32 << halvings;
        spent += f64::from(parts) * cost(step / f64::from(parts));
        if spent * compared as f64 > 4.0 * BUDGET {
            break;
        }
        let finest = run(step / f64::from(parts), u64::from(parts) * compared).ok()?;
        let (_, still) = largest(&finer, &finest);
        finer = finest;
        (species, error) = largest(&whole, &finer);
        last = 1.0 + 1.0 / (f64::from(parts).powi(2) - 1.0);
        if still < 0.05 * error {
            break;
        }
    }
    Some(SplittingError { relative: last * error, species, steps: compared })
}

/// An error below which that of the next halving follows from the order.
const SMALL: f64 = 0.01;
/// Halvings at most; the steps of a comparison that goes on are long, and few.
const MOST_HALVINGS: i32 = 7;

/// All species as real amounts.
struct MeanField<'a> {
    reactor: &'a Reactor,
    frozen: &'a Frozen,
    equations: RateEquations,
    flow: Flow,
}

impl MeanField<'_> {
    fn step(&mut self, state: &mut [f64], step: f64) -> Result<(), RunError> {
        self.react(state, 0.5 * step)?;
        self.diffuse(state, step);
        self.react(state, 0.5 * step)
    }

    fn react(&mut self, state: &mut [f64], dt: f64) -> Result<(), RunError> {
        let count = self.reactor.species_count();
        let mut all = Vec::new();
        let mut supplied = vec![0.0; count];
        for (i, row) in state.chunks_exact_mut(count).enumerate() {
            let (sampled, integrated) = self.frozen.reactions(i);
            all.clear();
            all.extend(sampled.iter().chain(integrated));
            if all.is_empty() {
                continue;
            }
            let held =
                if self.frozen.held.is_empty() { &[][..] } else { &self.frozen.held[i * count..][..count] };
            let voxel = Voxel {
                index: i,
                scale: self.frozen.scales[i],
                propensities: &self.reactor.propensities,
                integrated: &all,
                sampled: &[],
                weights: &self.frozen.weights,
                held,
            };
            let mut books = Books { supplied: &mut supplied, extents: &mut [] };
            let mut never = f64::INFINITY;
            self.equations.advance(self.reactor, voxel, row, &mut books, &mut never, (0.0, dt))?;
        }
        Ok(())
    }

    fn diffuse(&mut self, state: &mut [f64], dt: f64) {
        let count = self.reactor.species_count();
        for s in 0..count {
            let Some(table) = self.frozen.ways(s) else { continue };
            let (jumps, pieces) = Jumps::expected(self.reactor.diffusivity[s] * table.rate * dt);
            let mut baths = self.frozen.baths(s, |h| state[h * count + s]);
            for _ in 0..pieces {
                self.flow.diffuse(table, &jumps, (&mut *state, s, count), (&mut baths, ALL));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::Links;
    use crate::chemistry::network::Kinetics;
    use crate::chemistry::reactor::example::network;
    use crate::chemistry::split::SplitState;

    #[test]
    fn halving_tells_the_error() {
        // S0 + S1 -> 0 in five voxels in a row, the two starting at opposite ends.
        let mut network = network(Kinetics::Molecules, 2, &[(&[(0, 1), (1, 1)], &[], 0.05)]);
        network.species.iter_mut().for_each(|s| s.diffusion = 1.0);
        let reactor = Reactor::everywhere(&network, &[false; 2]);
        let pairs: Vec<(usize, usize, f64)> = (0..4).map(|i| (i, i + 1, 1.0)).collect();
        let links = Links::from_pairs(5, &pairs);
        let frozen = Frozen::build(&reactor, &links, &[1.0; 5], &[0; 5], &[0; 5], &[]).unwrap();
        let mut start = vec![0.0; 10];
        (start[0], start[9]) = (100.0, 80.0);
        let run = |steps: u64| {
            let mut state = SplitState::new(&reactor, start.clone(), 1, 0);
            for k in 0..steps {
                let dt = 0.8 / steps as f64;
                state.step(&reactor, &frozen, k as f64 * dt, dt).unwrap();
            }
            state.amounts
        };
        let exact = run(512);
        for steps in [4, 8, 16] {
            let seen = run(steps);
            let error = |s: usize| {
                let column = |x: &[f64]| -> f64 { x.iter().skip(s).step_by(2).sum() };
                let off: Vec<f64> = seen.iter().zip(&exact).map(|(a, b)| (a - b).abs()).collect();
                column(&off) / column(&exact)
            };
            let found =
                splitting_error(&reactor, &frozen, &start, (0.8 / steps as f64, steps), None).unwrap();
            assert_eq!(found.steps, steps);
            let ratio = found.relative / error(found.species);
            // The estimate is itself good to the next order in the step.
            assert!((ratio - 1.0).abs() < 0.2, "{steps}: {ratio}");
        }
        // Diffusion alone is not split.
        network.reactions.clear();
        let alone = Reactor::everywhere(&network, &[false; 2]);
        let frozen = Frozen::build(&alone, &links, &[1.0; 5], &[0; 5], &[0; 5], &[]).unwrap();
        assert_eq!(splitting_error(&alone, &frozen, &start, (0.1, 8), None), None);
    }
}
