//! A yeast cell in a stream of pheromone: the study of the sSSA-SDPD hybrid against finite elements.

use super::series::{across, probe};
use super::table::Table;
use super::{Row, Scope, Shipped, Verdict, run, timed};
use crate::ensemble::Results;
use crate::error::RunError;
use crate::statistics;

/// H, m; t_o = H/v_o, s; C_o, mol/m³.
const H: f64 = 20e-6;
const T_O: f64 = 16e-3;
const C_O: f64 = 1e-3;

/// Slip walls.
pub fn slip(scope: Scope) -> Result<Verdict, RunError> {
    compare(scope.full, &SLIP)
}

/// No-slip walls.
pub fn no_slip(scope: Scope) -> Result<Verdict, RunError> {
    compare(scope.full, &NO_SLIP)
}

struct Variant {
    title: &'static str,
    model: &'static str,
    lines: &'static str,
    totals: &'static str,
}

const SLIP: Variant = Variant {
    title: "pheromone_slip: yeast cell in a channel, slip walls",
    model: include_str!("../../models/pheromone_channel.yaml"),
    lines: include_str!("data/pheromone_slip_lines.csv"),
    totals: include_str!("data/pheromone_slip_total.csv"),
};

const NO_SLIP: Variant = Variant {
    title: "pheromone_no_slip: yeast cell in a channel, no-slip walls",
    model: include_str!("../../models/pheromone_channel_no_slip.yaml"),
    lines: include_str!("data/pheromone_noslip_lines.csv"),
    totals: include_str!("data/pheromone_noslip_total.csv"),
};

/// Continuous model at spacing 0.04 H (and 0.02 H in full), and an ensemble at 0.04 H beside it.
fn compare(full: bool, variant: &Variant) -> Result<Verdict, RunError> {
    let shipped = Shipped {
        model: variant.model,
        reactions: Some((
            "alpha_factor_binding.yaml",
            include_str!("../../reactions/alpha_factor_binding.yaml"),
        )),
    };
    let continuous = ["chemistry.representation=continuous".to_string(), "run.realizations=1".to_string()];
    timed(variant.title, || {
        let coarse = run(&shipped, &continuous)?;
        let mut rows = judge("spacing 0.04", &coarse, variant);
        rows.extend(sound("spacing 0.04", &coarse));
        if full {
            let mut overrides = continuous.to_vec();
            overrides.push("particles.spacing=0.4 um".into());
            overrides.push("groups.membrane.spacing=0.2 um".into());
            overrides.push("groups.interior.spacing=0.2 um".into());
            let fine = run(&shipped, &overrides)?;
            rows.extend(judge("spacing 0.02", &fine, variant));
            rows.extend(sound("spacing 0.02", &fine));
        }
        let ensemble = run(&shipped, &[])?;
        rows.extend(sound("ensemble", &ensemble));
        let exact = statistics::mean(&across(&coarse, "membrane", "RL", 2.0 * T_O));
        let sample = across(&ensemble, "membrane", "RL", 2.0 * T_O);
        rows.push(Row {
            quantity: "ensemble mean of RL against continuous (in standard errors)".into(),
            ours: statistics::mean(&sample),
            reference: Some(exact),
            error: (statistics::mean(&sample) - exact).abs() / statistics::sem(&sample),
            limit: 3.0,
            ..Row::default()
        });
        Ok(rows)
    })
}

/// Occupancy and ligand profiles at t* = 2 against finite elements.
fn judge(what: &str, results: &Results, variant: &Variant) -> Vec<Row> {
    let mut rows = Vec::new();
    let totals = Table::read(variant.totals);
    let end = 2.0 * T_O;
    let bound = statistics::mean(&across(results, "membrane", "RL", end));
    let free = statistics::mean(&across(results, "membrane", "R", end));
    let reference = (0..totals.len())
        .find(|&row| totals.number(row, "t") == 2.0)
        .map_or(f64::NAN, |row| totals.number(row, "mean_rl"));
    let occupancy = bound / (bound + free);
    rows.push(Row {
        quantity: format!("{what}: occupancy at t* = 2 (relative error)"),
        ours: occupancy,
        reference: Some(reference),
        error: (occupancy / reference - 1.0).abs(),
        limit: 0.05,
        ..Row::default()
    });
    let lines = Table::read(variant.lines);
    for (name, line, axis, offset) in [
        ("centreline_x", "y=0.5", "x", 0.1),
        ("cross_0", "x=xc", "y", 0.0),
        ("cross_plus", "x=xc+0.25", "y", 0.0),
        ("cross_minus", "x=xc-0.25", "y", 0.0),
    ] {
        let ours = probe(results, name, "L", end);
        let (mut found, mut exact, mut wanted) = (Vec::new(), Vec::new(), 0);
        for row in (0..lines.len()).filter(|&row| lines.text(row, "line") == line) {
            let (place, value) = (lines.number(row, axis), lines.number(row, "c_l_t2"));
            // The reference is empty inside the cell.
            wanted += usize::from(value.is_finite());
            let near = ours.iter().find(|(s, _)| (s / H + offset - place).abs() < 1e-6);
            if let (Some((_, c)), true) = (near, value.is_finite()) {
                found.push(c / C_O);
                exact.push(value);
            }
        }
        // Every point of the reference counts.
        let error = if found.len() < wanted { f64::NAN } else { statistics::relative_l2(&found, &exact) };
        rows.push(Row {
            quantity: format!("{what}: ligand along {name} at t* = 2, relative L2 error"),
            ours: error,
            reference: Some(0.0),
            error,
            limit: 0.05,
            ..Row::default()
        });
    }
    rows
}

/// Checks that must hold to the last molecule and particle.
fn sound(what: &str, results: &Results) -> Vec<Row> {
    let health = &results.record.health;
    let receptors = health.conservation.iter().find(|c| c.exempt.is_empty());
    let drift = receptors.map_or(f64::NAN, |c| c.largest_deviation / c.start);
    [
        ("penetrations", health.penetrations.map_or(f64::NAN, |n| n as f64), 0.0),
        ("molecules created or lost", health.molecules_created_or_lost, 0.0),
        // Whole molecules add up exactly; real amounts to rounding.
        ("R + RL, relative change", drift, if what == "ensemble" { 0.0 } else { 1e-9 }),
        ("largest density change", health.largest_density_change.unwrap_or(f64::NAN), 0.02),
    ]
    .into_iter()
    .map(|(name, value, limit)| Row {
        quantity: format!("{what}: {name}"),
        ours: value,
        reference: Some(0.0),
        error: value,
        limit,
        ..Row::default()
    })
    .collect()
}
