//! How long a split step may be.

use super::Frozen;
use crate::chemistry::reactor::Reactor;

/// The longest chemistry step under two stated limits, and what sets it.
#[derive(Clone, Debug, PartialEq)]
pub struct StepBounds {
    /// Step at which a molecule of the fastest species makes the allowed number of hops, s.
    pub hops: f64,
    /// The species and voxel behind it, in words.
    pub hops_limited_by: String,
    /// Step at which reactions change an amount by the allowed relative change, s.
    pub reactions: f64,
    /// The species and voxel behind it, in words.
    pub reactions_limited_by: String,
}

impl StepBounds {
    /// The shorter of the two, s; infinite where nothing diffuses and nothing that diffuses reacts.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.hops.min(self.reactions)
    }

    /// What sets [`StepBounds::step`], in words.
    #[must_use]
    pub fn limited_by(&self) -> &str {
        if self.hops <= self.reactions { &self.hops_limited_by } else { &self.reactions_limited_by }
    }
}

/// Longest steps for at most `hops` expected hops per molecule and at most `change` expected relative
/// change of any amount by reactions, from the given `amounts`.
///
/// The rate of a species is its loss per molecule, Σ_r v_r |change| / n, at the voxel's amounts with every
/// diffusing species at the highest concentration it has anywhere (at least one molecule), since transport
/// may bring it there; species that do not diffuse stand at their own amounts. Reactions among species that
/// do not diffuse are sampled exactly over any step and set no limit.
#[must_use]
pub fn step_bounds(
    reactor: &Reactor,
    frozen: &Frozen,
    amounts: &[f64],
    hops: f64,
    change: f64,
) -> StepBounds {
    let nothing = || String::from("nothing");
    let mut bounds = StepBounds {
        hops: f64::INFINITY,
        hops_limited_by: nothing(),
        reactions: f64::INFINITY,
        reactions_limited_by: nothing(),
    };
    for s in 0..reactor.species_count() {
        let Some(table) = frozen.table(s) else { continue };
        let step = hops / (reactor.diffusivity[s] * table.rate);
        if step < bounds.hops {
            let fastest = table.leaving.iter().position(|&l| l == table.rate).unwrap_or(0);
            bounds.hops = step;
            bounds.hops_limited_by =
                format!("{hops} expected hops of a molecule of {} in voxel {fastest}", reactor.species[s]);
        }
    }
    let (rate, s, voxel) = fastest_loss(reactor, frozen, amounts);
    if rate > 0.0 {
        bounds.reactions = change / rate;
        bounds.reactions_limited_by = format!(
            "{change} expected relative change of {} by reactions in voxel {voxel}",
            reactor.species[s]
        );
    }
    bounds
}

/// Largest loss per molecule, 1/s, with its species and voxel.
///
/// What leaves through a surface does so in the step of diffusion, and limits no step.
fn fastest_loss(reactor: &Reactor, frozen: &Frozen, amounts: &[f64]) -> (f64, usize, usize) {
    let species = reactor.species_count();
    let propensities = &reactor.propensities;
    let diffuses: Vec<bool> = (0..species).map(|s| frozen.table(s).is_some()).collect();
    let mut highest = vec![0.0_f64; species]; // mol/m³
    for (row, scale) in amounts.chunks_exact(species.max(1)).zip(&frozen.scales) {
        for (h, n) in highest.iter_mut().zip(row) {
            *h = h.max(n * scale.inverse);
        }
    }
    let coupled: Vec<bool> = (0..propensities.len())
        .map(|r| {
            let changed = propensities.changes(r).iter().map(|&(s, _)| s);
            propensities.inputs(r).iter().copied().chain(changed).any(|s| diffuses[s as usize])
        })
        .collect();
    let mut largest = (0.0, 0, 0);
    let mut trial = vec![0.0; species];
    let mut loss = vec![0.0; species];
    for (i, (row, &scale)) in amounts.chunks_exact(species.max(1)).zip(&frozen.scales).enumerate() {
        for s in 0..species {
            let here = diffuses[s] && reactor.habitat[s].holds(frozen.home[i]);
            trial[s] = if here { (highest[s] * scale.molar).max(1.0) } else { row[s] };
        }
        loss.fill(0.0);
        let (sampled, integrated) = frozen.reactions(i);
        for r in sampled.iter().chain(integrated).map(|&r| r as usize).filter(|&r| coupled[r]) {
            let flux = propensities.flux_at(r, &trial, scale);
            for &(s, change) in propensities.changes(r).iter().filter(|&&(_, change)| change < 0.0) {
                loss[s as usize] += -change * flux;
            }
        }
        for s in 0..species {
            let rate = loss[s] / trial[s].max(1.0);
            if rate > largest.0 && !frozen.is_held(i * species + s) {
                largest = (rate, s, i);
            }
        }
    }
    largest
}
