//! Event-driven realizations, wherever the voxels stay: which method, and how a realization is played.

use super::Watch;
use super::keep::Share;
use crate::chemistry::ssa::{
    CompositionRejection, Direct, EventMethod, Key, Ledger, NextReaction, NextSubvolume, System, TauLeaping,
};
use crate::error::RunError;
use crate::model::{Chemistry, Method};

/// Parts of an output interval between which a realization can be stopped.
const SLICES: u32 = 8;

/// One realization by the method of this name; `None` if it is not event driven.
pub(super) fn start<'a>(
    method: Method,
    chemistry: &Chemistry,
    system: &'a System<'a>,
    amounts: Vec<f64>,
    key: Key,
) -> Result<Option<Box<dyn EventMethod + 'a>>, RunError> {
    Ok(Some(match method {
        Method::Direct => Box::new(Direct::new(system, amounts, key)?),
        Method::NextReaction => Box::new(NextReaction::new(system, amounts, key)?),
        Method::CompositionRejection => Box::new(CompositionRejection::new(system, amounts, key)?),
        Method::NextSubvolume => Box::new(NextSubvolume::new(system, amounts, key)?),
        Method::TauLeaping => Box::new(TauLeaping::new(system, amounts, chemistry.tolerance, key)?),
        Method::Split => return Ok(None),
    }))
}

/// Plays a realization through the output `times` and lets `look` see the amounts at each; `None` if it was
/// stopped.
pub(super) fn play(
    system: &System,
    method: &mut dyn EventMethod,
    times: &[f64],
    watch: &Watch,
    mut look: impl FnMut(f64, &[f64]),
) -> Result<Option<Share>, RunError> {
    let begun = free_totals(system, method.amounts());
    for (time, seen) in halts(times) {
        if watch.stopped() {
            return Ok(None);
        }
        method.advance(time)?;
        if seen {
            look(time, method.amounts());
        }
    }
    Ok(Some(share(system, &begun, method.ledger())))
}

/// The output times, seen, and some between them so that the wish to stop is heard; the course of exact methods
/// does not depend on those.
pub(super) fn halts(times: &[f64]) -> Vec<(f64, bool)> {
    let mut from = 0.0;
    let mut found = Vec::with_capacity(times.len() * SLICES as usize);
    for &time in times {
        let part = |slice: u32| from + (time - from) * f64::from(slice) / f64::from(SLICES);
        found.extend((1..SLICES).map(|slice| (part(slice), false)));
        found.push((time, true));
        from = time;
    }
    found
}

/// What a realization came to, from its free totals at the start and its books.
pub(super) fn share(system: &System, begun: &[f64], ledger: &Ledger) -> Share {
    let end = free_totals(system, &ledger.amounts);
    let lost = (0..end.len())
        .map(|s| {
            let made = system.reactor.made(&ledger.fired, s);
            (end[s] - begun[s] - made - ledger.supplied[s]).abs()
        })
        .sum();
    Share { counters: ledger.counters, supplied: ledger.supplied.clone(), lost, ..Share::default() }
}

/// Molecules of each species where it is not held: whole numbers, so that the books close exactly.
pub(super) fn free_totals(system: &System, amounts: &[f64]) -> Vec<f64> {
    let count = system.reactor.species_count();
    let free = |slot: &usize| !system.frozen.is_held(*slot);
    (0..count)
        .map(|s| (s..amounts.len()).step_by(count).filter(free).map(|slot| amounts[slot]).sum())
        .collect()
}

/// Name and source of a method.
pub(super) fn words(method: Method) -> &'static str {
    match method {
        Method::Direct => "direct method (Gillespie 1976), exact",
        Method::NextReaction => "next reaction method (Gibson & Bruck 2000), exact",
        Method::CompositionRejection => {
            "composition-rejection method (Slepoy, Thompson & Plimpton 2008), exact"
        }
        Method::NextSubvolume => "next subvolume method (Elf & Ehrenberg 2004), exact",
        Method::TauLeaping => "tau-leaping (Cao, Gillespie & Petzold 2006), approximate",
        Method::Split => "diffusion and reaction in turn, Strang splitting",
    }
}

/// What is approximate about an event-driven method, in words.
pub(super) fn approximations(method: Method, chemistry: &Chemistry) -> Vec<String> {
    if method != Method::TauLeaping {
        return Vec::new();
    }
    vec![format!(
        "tau-leaping: propensities are held constant over leaps in which none is expected to change by more than {} of itself; leaps that would make a count negative are taken again at half the length",
        chemistry.tolerance
    )]
}
