//! What the split sampler says of itself: where hybrid species were carried how, and what splitting costs.

use crate::chemistry::split::{Modes, SplittingError};
use crate::model::Domain;
use crate::plan::Plan;
use crate::quantity::readable::{show, significant};
use crate::record::{HybridRecord, StepsRecord};

/// Where hybrid species were carried how in one realization, from its modes and group and home group of each voxel.
pub(super) fn history(plan: &Plan, modes: &Modes, (groups, home): (&[usize], &[u8])) -> Vec<HybridRecord> {
    let Some(hybrid) = &plan.reactor.hybrid else { return Vec::new() };
    let names = plan.model.domain.group_names();
    let mut found = Vec::new();
    for (k, &s) in hybrid.species.iter().enumerate() {
        for g in 0..names.len().max(1) {
            let voxels: Vec<usize> = (0..groups.len())
                .filter(|&i| groups[i] == g && plan.reactor.habitat[s].holds(home[i]))
                .collect();
            if voxels.is_empty() {
                continue;
            }
            let mut record = HybridRecord {
                species: plan.reactor.species[s].clone(),
                group: names.get(g).cloned().unwrap_or_else(|| "all".into()),
                realizations: 1,
                ..HybridRecord::default()
            };
            for &i in &voxels {
                let ([up, down], share) = modes.history(k, i);
                record.to_continuous += u64::from(up);
                record.to_discrete += u64::from(down);
                record.continuous += share;
            }
            record.continuous /= voxels.len() as f64;
            found.push(record);
        }
    }
    found
}

/// Approximations that hybrid species and splitting bring, in words.
pub(super) fn approximations(
    plan: &Plan,
    splitting: Option<String>,
    found: Option<&(SplittingError, f64)>,
) -> Vec<String> {
    let mut words: Vec<String> = splitting.into_iter().collect();
    if let (Some(words), Some((error, duration))) = (words.first_mut(), found) {
        words.push_str(&if error.relative.is_nan() {
            String::from("; the error of so long a step takes too long to estimate")
        } else {
            format!(
                "; estimated relative error {} of {} after {} (rate equations with shorter steps{})",
                significant(error.relative, 2),
                plan.reactor.species[error.species],
                show(*duration, "s"),
                if moving(plan) { ", the particles at rest" } else { "" }
            )
        });
    }
    if let Some(hybrid) = &plan.reactor.hybrid {
        let names: Vec<&str> = hybrid.species.iter().map(|&s| plan.reactor.species[s].as_str()).collect();
        words.push(format!(
            "{}: rate equations, without fluctuations, in voxels of {} molecules or more, until fewer than {}",
            names.join(", "),
            significant(hybrid.above, 4),
            significant(hybrid.below, 4)
        ));
    }
    words
}

/// A warning if events did not happen for want of a whole molecule of a continuous species.
pub(super) fn withheld(expected: f64) -> Option<String> {
    (expected > 0.5).then(|| {
        format!(
            "{} events (expected number) did not happen because a continuous species held less than one molecule in the voxel; make it discrete or hybrid",
            significant(expected, 3)
        )
    })
}

fn moving(plan: &Plan) -> bool {
    matches!(&plan.model.domain, Domain::Particles(domain) if domain.moves())
}

/// A splitting error from which on a run warns.
const COARSE: f64 = 0.05;

/// A warning if the chemistry step is too long for the numbers to be trusted.
pub(super) fn coarse(steps: &StepsRecord) -> Option<String> {
    let error = steps.splitting_error.filter(|error| *error >= COARSE)?;
    Some(format!(
        "the chemistry step is too long: the splitting error is estimated at {} %; make chemistry.step shorter or leave it out",
        significant(100.0 * error, 2)
    ))
}
