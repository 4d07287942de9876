//! Numbers read off the results of a run.

use crate::ensemble::Results;
use crate::statistics;

/// Amounts of a species in a group at a time, one per realization.
pub fn across(results: &Results, group: &str, species: &str, time: f64) -> Vec<f64> {
    let width = results.columns.len();
    let at = results.times.iter().position(|t| (t - time).abs() <= 1e-9 * time.max(1e-12));
    match (results.columns.find(group, species), at) {
        (Some(column), Some(row)) => results
            .blocks
            .iter()
            .filter_map(|block| block.amount.get(row * width + column).copied())
            .collect(),
        _ => Vec::new(),
    }
}

/// Mean over realizations of what a probe recorded at a time: places and values, by distance along it.
pub fn probe(results: &Results, name: &str, quantity: &str, time: f64) -> Vec<(f64, f64)> {
    let mut sums: Vec<(f64, f64, usize)> = Vec::new();
    for rows in &results.probes {
        if rows.probe != name
            || rows.quantity != quantity
            || (rows.time - time).abs() > 1e-9 * time.max(1e-12)
        {
            continue;
        }
        for (&s, &value) in rows.s.iter().zip(&rows.value) {
            match sums.iter_mut().find(|(at, ..)| *at == s) {
                Some((_, sum, count)) => {
                    *sum += value;
                    *count += 1;
                }
                None => sums.push((s, value, 1)),
            }
        }
    }
    sums.sort_by(|a, b| a.0.total_cmp(&b.0));
    sums.into_iter().map(|(s, sum, count)| (s, sum / count as f64)).collect()
}

/// How far a sample mean lies from the exact one, in standard errors of the exact variance.
pub fn mean_score(sample: &[f64], mean: f64, variance: f64) -> f64 {
    (statistics::mean(sample) - mean).abs() / (variance / sample.len() as f64).sqrt()
}

/// How far a sample variance lies from the exact one, in its standard errors; `fourth` is the fourth central
/// moment.
pub fn variance_score(sample: &[f64], variance: f64, fourth: f64) -> f64 {
    (statistics::variance(sample) - variance).abs()
        / ((fourth - variance * variance) / sample.len() as f64).sqrt()
}
