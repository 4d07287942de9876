//! The tables of the page.

use super::html::{table, table_of_html, typeset};
use super::measures;
use crate::figures::{Samples, escape};
use crate::fluid::{LARGEST_DENSITY_CHANGE, LARGEST_MACH};
use crate::quantity::readable::{grouped, show, significant};
use crate::record::{ModelText, RunRecord};

/// How a check came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Pass,
    Fail,
    /// For information; no limit applies.
    Open,
}

/// A check of a run: what was found, what was allowed.
pub struct Check {
    pub name: String,
    pub found: String,
    pub allowed: String,
    pub verdict: Verdict,
}

/// Relative deviation of a conserved sum that rounding explains, over millions of additions.
const ROUNDING: f64 = 1e-9;
/// Drift of total momentum over its largest value that rounding explains.
const MOMENTUM: f64 = 1e-6;

/// Every check that applies to a run.
pub fn checks(record: &RunRecord) -> Vec<Check> {
    let health = &record.health;
    let judge = |ok: bool| if ok { Verdict::Pass } else { Verdict::Fail };
    let mut out = Vec::new();
    let lost = health.molecules_created_or_lost;
    // Continuous species carry rounding, so the limit scales with the molecules there are.
    let scale = health.conservation.iter().map(|c| c.start.abs()).fold(1.0, f64::max);
    out.push(Check {
        name: "Molecules created or lost".into(),
        found: significant(lost, 3),
        allowed: "0".into(),
        verdict: judge(lost.abs() <= ROUNDING * scale),
    });
    for c in &health.conservation {
        let exempt = !c.exempt.is_empty();
        out.push(Check {
            name: format!("Conserved sum {} (starts at {})", c.sum, significant(c.start, 6)),
            found: format!("deviates by {}", significant(c.largest_deviation, 3)),
            allowed: if exempt { format!("free: {}", c.exempt) } else { "0 (rounding)".into() },
            verdict: if exempt {
                Verdict::Open
            } else {
                judge(c.largest_deviation <= ROUNDING * c.start.abs().max(1.0))
            },
        });
    }
    let mut bounded = |name: &str, value: Option<f64>, limit: f64| {
        if let Some(value) = value {
            out.push(Check {
                name: name.into(),
                found: significant(value, 3),
                allowed: if limit == 0.0 { "0".into() } else { format!("≤ {}", significant(limit, 2)) },
                verdict: judge(value.abs() <= limit),
            });
        }
    };
    bounded("Particles inside a wall", health.penetrations.map(|n| n as f64), 0.0);
    bounded("Largest Mach number", health.largest_mach, LARGEST_MACH);
    bounded("Largest change of density", health.largest_density_change, LARGEST_DENSITY_CHANGE);
    bounded("Drift of momentum", health.momentum_drift, MOMENTUM);
    if let Some(n) = health.bounces {
        out.push(Check {
            name: "Positions corrected at walls".into(),
            found: grouped(n),
            allowed: "for information".into(),
            verdict: Verdict::Open,
        });
    }
    out
}

/// Checks, reservoirs and warnings.
pub fn health(samples: &Samples) -> String {
    let record = &samples.record;
    let row = |c: Check| {
        let mark = match c.verdict {
            Verdict::Pass => "<span class=\"pass\">✓ pass</span>",
            Verdict::Fail => "<span class=\"fail\">✗ fail</span>",
            Verdict::Open => "<span class=\"none\">–</span>",
        };
        vec![escape(&c.name), escape(&c.found), escape(&c.allowed), mark.to_string()]
    };
    let rows: Vec<Vec<String>> =
        checks(record).into_iter().chain(measures::checks(samples)).map(row).collect();
    let mut out = String::from("<h2>Checks</h2>\n");
    out += &table_of_html(&["check", "found", "allowed", ""], &[1], &rows);
    let supplied: Vec<Vec<String>> =
        record.health.molecules_supplied.iter().map(|(s, n)| vec![s.clone(), significant(*n, 6)]).collect();
    if !supplied.is_empty() {
        out += "<h3>Molecules brought in by reservoirs (net, all realizations)</h3>\n";
        out += &table(&["species", "molecules"], &[1], &supplied);
    }
    if !record.health.warnings.is_empty() {
        out += "<h3>Warnings</h3>\n";
        out += &list(&record.health.warnings);
    }
    out
}

/// Species, reactions, laws, conditions, approximations.
pub fn chemistry(record: &RunRecord) -> String {
    let mut out = String::from("<h2>Model</h2>\n");
    let species: Vec<Vec<String>> = record
        .species
        .iter()
        .map(|s| {
            let diffusion = if s.diffusion == 0.0 { "immobile".into() } else { show(s.diffusion, "m^2/s") };
            let place = if s.only_in.is_empty() { "everywhere".into() } else { s.only_in.join(", ") };
            vec![s.name.clone(), diffusion, s.representation.clone(), place]
        })
        .collect();
    out += &table(&["species", "diffusivity", "carried as", "lives"], &[], &species);
    let reactions: Vec<Vec<String>> = record
        .reactions
        .iter()
        .map(|r| vec![escape(&r.name), escape(&r.equation.replace("->", "→")), typeset(&r.propensity)])
        .collect();
    out += &table_of_html(&["reaction", "equation", "propensity"], &[], &reactions);
    let particles = record.domain.kind == "particles";
    let groups: Vec<Vec<String>> = record
        .domain
        .groups
        .iter()
        .map(|g| {
            // Particles pass through a zone: it owns none.
            let owns = g.material != "zone";
            let volume = if owns { show(g.volume, "m^3") } else { "–".into() };
            if !particles {
                return vec![g.name.clone(), volume];
            }
            let number = if owns { grouped(g.particles as u64) } else { "–".into() };
            vec![g.name.clone(), g.material.clone(), number, volume, g.shape.clone()]
        })
        .collect();
    let (head, numeric): (&[&str], &[usize]) = if particles {
        (&["group", "material", "particles", "volume", "shape"], &[2, 3])
    } else {
        (&["volume", "size"], &[1])
    };
    out += &table(head, numeric, &groups);
    if !record.conservation_laws.is_empty() {
        let laws = escape(&record.conservation_laws.join("; "));
        out += &format!("<p><b>Conserved by the reactions:</b> {laws}.</p>\n");
    }
    if !record.conditions.is_empty() {
        out += &format!("<p><b>Conditions:</b></p>\n{}", list(&record.conditions));
    }
    let approximations = &record.steps.approximations;
    out += &format!("<p><b>Sampling:</b> {}", escape(&record.steps.method));
    if approximations.is_empty() {
        out += if record.steps.method.contains("exact") { ".</p>\n" } else { "; exact.</p>\n" };
    } else {
        out += &format!("; approximate in:</p>\n{}", list(approximations));
    }
    if !record.hybrid.is_empty() {
        let rows: Vec<Vec<String>> = record
            .hybrid
            .iter()
            .map(|h| {
                let share = format!("{} %", significant(100.0 * h.continuous, 3));
                let changes = [h.to_continuous, h.to_discrete].map(grouped);
                vec![h.species.clone(), h.group.clone(), share, changes[0].clone(), changes[1].clone()]
            })
            .collect();
        out += "<h3>Hybrid species: where they were real amounts</h3>\n";
        let head =
            ["species", "group", "voxels and steps continuous", "became continuous", "became discrete"];
        out += &table(&head, &[2, 3, 4], &rows);
    }
    out
}

/// Steps and what they cost.
pub fn cost(record: &RunRecord) -> String {
    let mut steps = Vec::new();
    for (name, step) in [
        ("fluid", &record.steps.fluid),
        ("solids", &record.steps.solid),
        ("chemistry", &record.steps.chemistry),
    ] {
        if let Some(s) = step {
            steps.push(vec![name.into(), show(s.step, "s"), grouped(s.count), s.limited_by.clone()]);
        }
    }
    let p = &record.performance;
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut row = |name: &str, value: String| rows.push(vec![name.into(), value]);
    let rate = |n: u64, seconds: f64| {
        if seconds > 0.0 { format!(" ({} /s)", significant(n as f64 / seconds, 3)) } else { String::new() }
    };
    if p.particle_steps > 0 {
        row("particle steps", grouped(p.particle_steps) + &rate(p.particle_steps, p.fluid_seconds));
        row("pair evaluations", grouped(p.pair_evaluations) + &rate(p.pair_evaluations, p.fluid_seconds));
    }
    if p.solid_particle_steps > 0 {
        // In a flow their time is part of its.
        let alone = if p.particle_steps == 0 { p.fluid_seconds } else { 0.0 };
        row(
            "steps of solid particles",
            grouped(p.solid_particle_steps) + &rate(p.solid_particle_steps, alone),
        );
        row("bonds evaluated", grouped(p.bond_evaluations) + &rate(p.bond_evaluations, alone));
    }
    if p.particle_steps + p.solid_particle_steps > 0 {
        row("time in motion", show(p.fluid_seconds, "s"));
    }
    row("reaction events", grouped(p.reaction_events));
    row("diffusive hops", grouped(p.hops));
    let events = p.reaction_events + p.hops;
    row("time in chemistry", show(p.chemistry_seconds, "s") + &rate(events, p.chemistry_seconds));
    row("wall time", show(p.wall_seconds, "s"));
    row("processor time", show(p.cpu_seconds, "s"));
    row("peak memory", format!("{} MiB", significant(p.peak_rss_bytes as f64 / 1_048_576.0, 3)));
    row("threads", p.threads.to_string());
    let flow = match (record.steps.shared_flow, record.solids.is_empty() || record.fluid.is_some()) {
        (true, true) => "<p>One flow served every realization.</p>\n",
        (true, false) => "<p>The solids moved once, for every realization alike.</p>\n",
        _ => "",
    };
    format!(
        "<h2>Steps and cost</h2>\n{}{flow}{}",
        table(&["part", "step", "steps", "limited by"], &[1, 2], &steps),
        table(&["cost", ""], &[1], &rows)
    )
}

/// Version, seed, hash and the model word for word.
pub fn provenance(record: &RunRecord) -> String {
    let mut rows = vec![
        vec!["program".to_string(), format!("{} {}", record.program, record.version)],
        vec!["seed".into(), record.seed.to_string()],
        vec!["realizations".into(), format!("{}..{}", record.realizations[0], record.realizations[1])],
        vec!["model hash (SHA-256)".into(), record.model.hash.clone()],
    ];
    if !record.model.overrides.is_empty() {
        rows.push(vec!["set on the command line".into(), record.model.overrides.join(", ")]);
    }
    format!("<h2>Provenance</h2>\n{}{}", table(&["what", ""], &[], &rows), files(&record.model))
}

/// The files of a model word for word.
pub fn files(model: &ModelText) -> String {
    let file = |(path, text): &(String, String)| {
        format!("<details><summary>{}</summary><pre>{}</pre></details>\n", escape(path), escape(text))
    };
    model.files.iter().map(file).collect()
}

fn list(items: &[String]) -> String {
    let items: Vec<String> = items.iter().map(|i| format!("<li>{}</li>", escape(i))).collect();
    format!("<ul>{}</ul>\n", items.concat())
}
