//! Exact answers in one and two volumes.

use super::series::{across, mean_score, variance_score};
use super::{Row, Scope, Shipped, Verdict, run, timed};
use crate::error::RunError;
use crate::statistics;

/// Limits in standard errors: 4 for a mean, 4.5 for a variance (false alarm 6e-5 and 7e-6 each).
const MEAN_LIMIT: f64 = 4.0;
const VARIANCE_LIMIT: f64 = 4.5;

/// Mean and variance of a sample beside the exact ones.
fn moments(what: &str, sample: &[f64], mean: f64, variance: f64, fourth: f64) -> [Row; 2] {
    [
        Row {
            quantity: format!("{what}: mean (error in standard errors)"),
            ours: statistics::mean(sample),
            published: None,
            reference: Some(mean),
            error: mean_score(sample, mean, variance),
            limit: MEAN_LIMIT,
        },
        Row {
            quantity: format!("{what}: variance (error in standard errors)"),
            ours: statistics::variance(sample),
            published: None,
            reference: Some(variance),
            error: variance_score(sample, variance, fourth),
            limit: VARIANCE_LIMIT,
        },
    ]
}

/// Birth and death from nothing: Poisson at every time, mean N_A V k/d (1 - exp(-d t)).
pub fn birth_death(scope: Scope) -> Result<Verdict, RunError> {
    let shipped = Shipped {
        model: include_str!("../../models/birth_death.yaml"),
        reactions: Some(("birth_death.yaml", include_str!("../../reactions/birth_death.yaml"))),
    };
    let count = if scope.full { 200_000 } else { 20_000 };
    timed("birth_death: birth and death in 10 fL", || {
        let results = run(&shipped, &[format!("run.realizations={count}")])?;
        let mut rows = Vec::new();
        for time in [5.0_f64, 60.0] {
            // 1 nM/s in 10 fL; decay 0.1 1/s.
            let mean = 1e-6 * crate::chemistry::AVOGADRO * 1e-17 / 0.1 * (1.0 - (-0.1 * time).exp());
            let sample = across(&results, "all", "X", time);
            // A Poisson number has the fourth central moment m + 3 m².
            rows.extend(moments(&format!("X at {time} s"), &sample, mean, mean, mean + 3.0 * mean * mean));
        }
        Ok(rows)
    })
}

/// Two volumes of 1 and 0.25 fL, G = 0.5 µm, D = 1 µm²/s: binomial with
/// p = V0/(V0+V1) + V1/(V0+V1) exp(-D G (1/V0 + 1/V1) t).
pub fn two_compartments(scope: Scope) -> Result<Verdict, RunError> {
    let shipped = Shipped { model: include_str!("../../models/two_compartments.yaml"), reactions: None };
    let count = if scope.full { 100_000 } else { 10_000 };
    timed("two_compartments: 100 molecules in 1 fL and 0.25 fL", || {
        let results = run(&shipped, &[format!("run.realizations={count}")])?;
        let mut rows = Vec::new();
        for time in [0.1_f64, 0.5, 5.0] {
            let p = 0.8 + 0.2 * (-2.5 * time).exp();
            let sample = across(&results, "soma", "X", time);
            let variance = 100.0 * p * (1.0 - p);
            let fourth = variance * (1.0 + 3.0 * (100.0 - 2.0) * p * (1.0 - p));
            rows.extend(moments(&format!("X in soma at {time} s"), &sample, 100.0 * p, variance, fourth));
        }
        Ok(rows)
    })
}
