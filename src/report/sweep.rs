//! The page of a sweep: what was varied, what came out, how each point fared.

use super::html::{table, table_of_html};
use super::sections::{Verdict, checks};
use crate::error::RunError;
use crate::figures::sweep::{Outcomes, correlations, draw, each, half_width, name, printed};
use crate::figures::{self, escape};
use crate::quantity::readable::{grouped, show, significant};
use crate::record::{PointRecord, SweepRecord};
use crate::tables;
use rayon::prelude::*;
use std::path::Path;

/// Points listed at most; species with columns of their own.
const LISTED: usize = 500;
const SPECIES: usize = 4;

/// Draws `figures/` and writes `report.html` in a sweep's folder.
///
/// # Errors
/// As of a run.
pub fn write(dir: &Path) -> Result<(), RunError> {
    let outcomes = Outcomes::read(dir)?;
    let drawn = draw(&outcomes);
    let folder = dir.join("figures");
    let shown = drawn
        .par_iter()
        .enumerate()
        .map(|(number, figure)| {
            figures::save(figure, &folder)?;
            super::inline(figure, number + 1, &folder)
        })
        .collect::<Result<Vec<String>, RunError>>()?;
    let amiss: Vec<Vec<String>> = outcomes.record.points.par_iter().map(|point| amiss(dir, point)).collect();
    let page = page(dir, &outcomes, &shown, &amiss);
    tables::write_bytes(&dir.join("report.html"), page.as_bytes())
}

/// Failed checks and warnings of a point.
fn amiss(dir: &Path, point: &PointRecord) -> Vec<String> {
    let error = point.error.clone().into_iter();
    let Ok(record) = tables::read_record(&dir.join(&point.folder)) else { return error.collect() };
    let failed = checks(&record).into_iter().filter(|check| check.verdict == Verdict::Fail);
    let failed = failed.map(|check| format!("✗ {}: {}, allowed {}", check.name, check.found, check.allowed));
    error.chain(failed).chain(record.health.warnings).collect()
}

fn page(dir: &Path, outcomes: &Outcomes, figures: &[String], amiss: &[Vec<String>]) -> String {
    let record = &outcomes.record;
    let mut out = super::head(&record.name);
    out += &summary(outcomes, amiss);
    out += &parameters(record);
    if !figures.is_empty() {
        out += &format!("<h2>Outcome</h2>\n{}", figures.concat());
    }
    out += &ranks(outcomes);
    out += &points(dir, outcomes, amiss);
    out += &provenance(record);
    out + &super::foot(&record.program, &record.version)
}

fn summary(outcomes: &Outcomes, amiss: &[Vec<String>]) -> String {
    let record = &outcomes.record;
    let mut out = String::new();
    if !record.description.trim().is_empty() {
        out += &format!("<p class=\"what\">{}</p>\n", escape(record.description.trim()));
    }
    let (finished, all) = (record.finished().count(), record.points.len());
    let bad = |words: &&Vec<String>| words.iter().any(|w| w.starts_with('✗'));
    let (failed, noted) = (amiss.iter().filter(bad).count(), amiss.iter().filter(|w| !w.is_empty()).count());
    let whole = record.status == "finished" && failed == 0;
    let names: Vec<&str> = record.parameters.iter().map(name).collect();
    let design = match record.design.as_str() {
        "grid" => "a grid",
        "list" => "a list",
        _ => "a Latin hypercube",
    };
    let seeds =
        if record.common_random_numbers { "with the same random numbers" } else { "with a seed of its own" };
    out += &format!(
        "<div class=\"verdict{}\">\n<p>A sweep over {}: {design} of {all} points, {}, {seeds}.</p>\n",
        if whole { "" } else { " fail" },
        escape(&names.join(", ")),
        each(outcomes)
    );
    if finished < all {
        out += &format!(
            "<p><span class=\"fail\">✗ The sweep is {}</span>: {finished} of {all} points are finished and shown.</p>\n",
            escape(&record.status)
        );
    }
    out += &match (failed, noted) {
        (0, 0) => "<p><span class=\"pass\">✓ Every check passed at every point.</span></p>\n".to_string(),
        (0, n) => format!("<p><span class=\"none\">{n} points have something to note, below.</span></p>\n"),
        (n, _) => format!("<p><span class=\"fail\">✗ Checks failed at {n} points, below.</span></p>\n"),
    };
    out += "</div>\n<div class=\"facts\">\n";
    let mut facts = vec![
        (all.to_string(), "points"),
        (grouped(record.points.iter().map(|p| u64::from(p.finished)).sum()), "realizations"),
    ];
    let p = &record.performance;
    if p.reaction_events > 0 {
        facts.push((significant(p.reaction_events as f64, 3), "reaction events"));
    }
    if p.hops > 0 {
        facts.push((significant(p.hops as f64, 3), "diffusive hops"));
    }
    facts.push((show(p.wall_seconds, "s"), "wall time"));
    facts.push((record.seed.to_string(), "seed"));
    for (value, what) in facts {
        out += &format!("<div><b>{}</b><span>{what}</span></div>\n", escape(&value));
    }
    out + "</div>\n"
}

/// What was varied, from where to where.
fn parameters(record: &SweepRecord) -> String {
    let row = |(k, parameter): (usize, &crate::record::SweptRecord)| {
        let shown: Vec<f64> = record.points.iter().map(|p| p.values[k] * parameter.per_si).collect();
        let (low, high) = crate::figures::panel::range(shown.iter().copied());
        let mut distinct = shown;
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        let unit = printed(&parameter.unit);
        let with = |value: f64| format!("{} {unit}", significant(value, 4));
        vec![
            parameter.name.clone(),
            with(low),
            with(high),
            distinct.len().to_string(),
            if parameter.logarithmic { "logarithmic".into() } else { "linear".to_string() },
        ]
    };
    let rows: Vec<Vec<String>> = record.parameters.iter().enumerate().map(row).collect();
    format!("<h2>Swept</h2>\n{}", table(&["parameter", "from", "to", "values", "scale"], &[1, 2, 3], &rows))
}

/// Correlations of ranks, where there are several parameters.
fn ranks(outcomes: &Outcomes) -> String {
    let parameters = &outcomes.record.parameters;
    let points = outcomes.record.finished().count();
    if parameters.len() < 2 || points < 4 {
        return String::new();
    }
    let mut head = vec!["species"];
    head.extend(parameters.iter().map(name));
    let number = |r: f64| if r.is_finite() { format!("{r:.3}").replace('-', "−") } else { "–".into() };
    let row = |one: &figures::sweep::Outcome| {
        let found = correlations(outcomes, one).into_iter().map(number);
        std::iter::once(one.species.clone()).chain(found).collect()
    };
    let rows: Vec<Vec<String>> = outcomes.species.iter().map(row).collect();
    let numeric: Vec<usize> = (1..=parameters.len()).collect();
    format!(
        "<h3>Rank correlations</h3>\n<p>Spearman's, between each parameter and the mean amount at the end, {points} points.</p>\n{}",
        table(&head, &numeric, &rows)
    )
}

/// Every point: values, means at the end, what is amiss.
fn points(dir: &Path, outcomes: &Outcomes, amiss: &[Vec<String>]) -> String {
    let record = &outcomes.record;
    let shown = &outcomes.species[..outcomes.species.len().min(SPECIES)];
    let mut head = vec!["point".to_string()];
    head.extend(record.parameters.iter().map(|p| match p.unit.as_str() {
        "" => name(p).to_string(),
        unit => format!("{} ({})", name(p), printed(unit)),
    }));
    head.extend(shown.iter().map(|one| format!("mean {} ± 95 %", one.species)));
    head.push("".into());
    let mut rows = Vec::new();
    // Rows of the table hold finished points only, in their order.
    let mut row_of = 0;
    for (point, words) in record.points.iter().zip(amiss) {
        let finished = point.status == "finished";
        let mut row = vec![format!("{:04}", point.point)];
        let values = point.values.iter().zip(&record.parameters);
        row.extend(values.map(|(value, p)| significant(value * p.per_si, 4)));
        for one in shown {
            let summary = one.summaries.get(row_of).filter(|_| finished);
            row.push(summary.map_or_else(
                || "–".into(),
                |s| {
                    let half = half_width(s);
                    let half = if half.is_finite() {
                        format!(" ± {}", significant(half, 2))
                    } else {
                        String::new()
                    };
                    significant(s.mean, 5) + &half
                },
            ));
        }
        let notes: Vec<String> = words.iter().map(|word| escape(word)).collect();
        let status = match point.status.as_str() {
            "finished" => String::new(),
            other => format!("<span class=\"fail\">{}</span> ", escape(other)),
        };
        row = row.iter().map(|cell| escape(cell)).collect();
        let page = format!("{}/report.html", point.folder);
        if dir.join(&page).exists() {
            row[0] = format!("<a href=\"{page}\">{}</a>", row[0]);
        }
        row.push(status + &notes.join("; "));
        row_of += usize::from(finished);
        if rows.len() < LISTED {
            rows.push(row);
        }
    }
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let numeric: Vec<usize> = (1..head.len() - 1).collect();
    let more = match record.points.len().saturating_sub(LISTED) {
        0 => String::new(),
        n => format!(" {n} more points stand in <code>tables/sweep.parquet</code>."),
    };
    format!(
        "<h2>Points</h2>\n<p>Each is a run of its own in <code>points/</code>; <code>gillesph report DIR/points/0000</code> draws its figures again.{more}</p>\n{}",
        table_of_html(&head, &numeric, &rows)
    )
}

fn provenance(record: &SweepRecord) -> String {
    let mut rows = vec![
        vec!["program".to_string(), format!("{} {}", record.program, record.version)],
        vec!["seed".into(), record.seed.to_string()],
        vec!["realizations".into(), format!("{}..{}", record.realizations[0], record.realizations[1])],
        vec!["model hash (SHA-256)".into(), record.model.hash.clone()],
        vec!["processor time".into(), show(record.performance.cpu_seconds, "s")],
    ];
    if !record.model.overrides.is_empty() {
        rows.push(vec!["set on the command line".into(), record.model.overrides.join(", ")]);
    }
    format!(
        "<h2>Provenance</h2>\n{}{}",
        table(&["what", ""], &[], &rows),
        super::sections::files(&record.model)
    )
}
