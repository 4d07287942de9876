//! Amounts at the end in numbers.

use super::html::table;
use crate::figures::Samples;
use crate::quantity::readable::{show, significant};
use crate::statistics::{covariance, variance};

/// Amounts at the end, across realizations.
pub fn numbers(samples: &Samples) -> String {
    let series = &samples.series;
    let Some(last) = series.times.len().checked_sub(1) else { return String::new() };
    let several = series.blocks.len() > 1;
    let mut rows = Vec::new();
    for c in 0..series.columns.len() {
        let Some(s) = samples.ends.get(c) else { continue };
        if s.count == 0 || (s.max == 0.0 && s.min == 0.0) {
            continue;
        }
        let mut row =
            vec![series.columns.groups[c].clone(), series.columns.species[c].clone(), significant(s.mean, 6)];
        if several {
            let more = [s.sem, s.sd, s.q05, s.median, s.q95, s.fano];
            row.extend(more.iter().map(|v| significant(*v, 4)));
        }
        rows.push(row);
    }
    let head = ["group", "species", "mean", "± s.e.m.", "sd", "5 %", "median", "95 %", "Fano"];
    let head = if several { &head[..] } else { &["group", "species", "amount"] };
    let unit = format!("<h2>Amounts at {}</h2>\n<p>In molecules.</p>\n", show(series.times[last], "s"));
    if rows.is_empty() { String::new() } else { unit + &table(head, &[2, 3, 4, 5, 6, 7, 8], &rows) }
}

/// Correlations between amounts at the end, when covariances were asked for.
pub fn correlations(samples: &Samples) -> String {
    const MOST: usize = 12;
    let series = &samples.series;
    let Some(last) = series.times.len().checked_sub(1).filter(|_| samples.covariance) else {
        return String::new();
    };
    let several = series.columns.groups.iter().any(|g| g != "all");
    let varying: Vec<(String, Vec<f64>)> = (0..series.columns.len())
        .filter(|&c| !(several && series.columns.groups[c] == "all"))
        .map(|c| {
            let (group, species) = (&series.columns.groups[c], &series.columns.species[c]);
            let name = if several { format!("{species} in {group}") } else { species.clone() };
            (name, series.across(last, c))
        })
        .filter(|(_, values)| variance(values) > 0.0)
        .take(MOST)
        .collect();
    if varying.len() < 2 {
        return String::new();
    }
    let mut head = vec![""];
    head.extend(varying.iter().map(|v| v.0.as_str()));
    let row = |(name, x): &(String, Vec<f64>)| {
        let correlation = |(_, y): &(String, Vec<f64>)| {
            let r = covariance(x, y) / (variance(x) * variance(y)).sqrt();
            format!("{r:.3}").replace('-', "−")
        };
        std::iter::once(name.clone()).chain(varying.iter().map(correlation)).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = varying.iter().map(row).collect();
    let numeric: Vec<usize> = (1..=varying.len()).collect();
    format!(
        "<h3>Correlations at {}</h3>\n<p>Covariance over the standard deviations, {} realizations; all times stand in <code>tables/covariance.parquet</code>.</p>\n{}",
        show(series.times[last], "s"),
        series.blocks.len(),
        table(&head, &numeric, &rows)
    )
}
