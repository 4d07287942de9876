//! The head of the page: what was run, what came out, whether the checks passed.

use super::sections::{Verdict, checks};
use crate::figures::{Samples, escape};
use crate::quantity::readable::{grouped, show, significant};
use std::fmt::Write;

/// Description, verdict, facts.
pub fn summary(samples: &Samples) -> String {
    let record = &samples.record;
    let mut out = String::new();
    if !record.description.trim().is_empty() {
        let _ = writeln!(out, "<p class=\"what\">{}</p>", escape(record.description.trim()));
    }
    let mut checks = checks(record);
    checks.extend(super::measures::checks(samples));
    let failed: Vec<&str> =
        checks.iter().filter(|c| c.verdict == Verdict::Fail).map(|c| c.name.as_str()).collect();
    let passed = checks.iter().filter(|c| c.verdict == Verdict::Pass).count();
    let finished = record.status == "finished";
    let class = if failed.is_empty() && finished { "verdict" } else { "verdict fail" };
    let _ = write!(out, "<div class=\"{class}\">\n<p>{}</p>\n", escape(&what_was_run(samples)));
    if let Some(sentence) = results(samples) {
        let _ = writeln!(out, "<p>{}</p>", escape(&sentence));
    }
    if !finished {
        let reason = record.error.as_deref().unwrap_or("what is shown is what was complete");
        let _ = writeln!(
            out,
            "<p><span class=\"fail\">✗ The run {}</span>: {}.</p>",
            escape(&match record.status.as_str() {
                "failed" => "failed".to_owned(),
                "interrupted" => "was interrupted".to_owned(),
                other => format!("is {other}"),
            }),
            escape(reason)
        );
    }
    let verdict = match (failed.is_empty(), passed) {
        (true, 0) => "<span class=\"none\">No check applies.</span>".to_string(),
        (true, 1) => "<span class=\"pass\">✓ The one check that applies passed.</span>".to_string(),
        (true, 2) => "<span class=\"pass\">✓ Both checks passed.</span>".to_string(),
        (true, n) => format!("<span class=\"pass\">✓ All {n} checks passed.</span>"),
        (false, _) => format!("<span class=\"fail\">✗ Failed: {}.</span>", escape(&failed.join("; "))),
    };
    let warnings = match record.health.warnings.len() {
        0 => String::new(),
        1 => " One warning, below.".into(),
        n => format!(" {n} warnings, below."),
    };
    let _ = write!(out, "<p>{verdict}{warnings}</p>\n</div>\n<div class=\"facts\">\n");
    for (value, name) in facts(samples) {
        let _ = writeln!(out, "<div><b>{}</b><span>{}</span></div>", escape(&value), escape(name));
    }
    out + "</div>\n"
}

fn what_was_run(samples: &Samples) -> String {
    let record = &samples.record;
    let domain = &record.domain;
    let place = match domain.kind.as_str() {
        "particles" => {
            let particles: usize =
                domain.groups.iter().filter(|g| g.material != "zone").map(|g| g.particles).sum();
            let sides: Vec<String> =
                domain.min.iter().zip(&domain.max).map(|(a, b)| show(b - a, "m")).collect();
            format!(
                "{} particles in {} ({}D)",
                grouped(particles as u64),
                sides.join(" × "),
                domain.dimensions
            )
        }
        "graph" => format!("{} compartments", domain.groups.len()),
        _ => {
            let volume: f64 = domain.groups.iter().map(|g| g.volume).sum();
            format!("a well-mixed volume of {}", show(volume, "m^3"))
        }
    };
    let count = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
    format!(
        "{} of {} and {} in {place}, {} long; {}.",
        count(record.finished as usize, "realization", "realizations"),
        count(record.species.len(), "species", "species"),
        count(record.reactions.len(), "reaction", "reactions"),
        show(record.times.last().copied().unwrap_or(0.0), "s"),
        record.steps.method
    )
}

/// Amounts over the domain at the end, in words.
fn results(samples: &Samples) -> Option<String> {
    let series = &samples.series;
    let last = series.times.len().checked_sub(1)?;
    let several = series.blocks.len() > 1;
    let mut parts = Vec::new();
    for c in (0..series.columns.len()).filter(|&c| series.columns.groups[c] == "all").take(6) {
        let Some(s) = samples.ends.get(c) else { continue };
        let spread = if several { format!(" ± {}", significant(s.sd, 2)) } else { String::new() };
        parts.push(format!("{} {}{spread}", series.columns.species[c], significant(s.mean, 5)));
    }
    if parts.is_empty() {
        return None;
    }
    let kind = if several { " (mean ± standard deviation)" } else { "" };
    Some(format!("Molecules at {}{kind}: {}.", show(series.times[last], "s"), parts.join(", ")))
}

fn facts(samples: &Samples) -> Vec<(String, &'static str)> {
    let (record, p) = (&samples.record, &samples.record.performance);
    let mut out = vec![(
        record.finished.to_string(),
        if record.finished == 1 { "realization" } else { "realizations" },
    )];
    if p.reaction_events > 0 {
        out.push((significant(p.reaction_events as f64, 3), "reaction events"));
    }
    if p.hops > 0 {
        out.push((significant(p.hops as f64, 3), "diffusive hops"));
    }
    if p.particle_steps > 0 {
        out.push((significant(p.particle_steps as f64, 3), "particle steps"));
    }
    out.push((show(p.wall_seconds, "s"), "wall time"));
    out.push((record.seed.to_string(), "seed"));
    out
}
