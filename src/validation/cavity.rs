//! Lid-driven cavity (Ghia, Ghia & Shin 1982; Jacob et al. 2021, section 4.3).

mod drawing;
mod lines;

use super::findings::Findings;
use super::flow::{End, across, judged, stated, watch_plane_from};
use super::stream_function::{Mesh, velocity_of};
use super::table::Table;
use super::vortices::{Corner, Extent, corner};
use super::{Row, Scope, Shipped, Verdict, timed};
use crate::error::RunError;
use crate::figures::contour::GridField;
use crate::figures::maps::Cloud;
use crate::fluid::Flow;
use crate::statistics::mean;
use crate::vector::Vector;
use lines::{Line, Wanted, rms, stations};

/// Velocity is averaged over the last time units, L/U.
const WINDOW: f64 = 5.0;
const EVERY: f64 = 0.25;
/// Change of the mean kinetic energy from one window to the next below which the flow is steady.
const STEADY: f64 = 1e-3;
/// Cells of the grid of the stream function.
const CELLS: usize = 128;

/// A resolution of a Reynolds number.
struct Case {
    reynolds: u32,
    side: u32,
    /// Longest time, L/U.
    until: f64,
    /// Largest root mean square error of u and v at Ghia's stations.
    limit: f64,
    /// Part of the default set.
    quick: bool,
    /// Whether it begins with the mean flow of the coarser resolution: from rest the core takes hundreds of L/U to turn.
    nested: bool,
}

const CASES: [Case; 6] = [
    Case { reynolds: 100, side: 50, until: 40.0, limit: 0.003, quick: true, nested: false },
    // Smaller than at 50 x 50: judged against what that came to, below.
    Case { reynolds: 100, side: 100, until: 40.0, limit: 0.003, quick: false, nested: false },
    Case { reynolds: 1000, side: 100, until: 80.0, limit: 0.02, quick: false, nested: false },
    Case { reynolds: 1000, side: 200, until: 80.0, limit: 0.01, quick: false, nested: false },
    Case { reynolds: 10_000, side: 100, until: 300.0, limit: f64::INFINITY, quick: false, nested: false },
    Case { reynolds: 10_000, side: 200, until: 100.0, limit: f64::INFINITY, quick: false, nested: true },
];

/// What a cavity may be off the independent solution, if that is more than off Ghia's tables.
const SOLVED_LIMIT: f64 = 0.004;

/// Width and height of the corner vortices at Re = 1000: of the independent solution, and as read off the paper, to 0.05 at
/// best (its left one is 0.027 narrower).
const LEFT: [Extent; 2] = [Extent { width: 0.227, height: 0.171 }, Extent { width: 0.20, height: 0.15 }];
const RIGHT: [Extent; 2] = [Extent { width: 0.303, height: 0.366 }, Extent { width: 0.30, height: 0.35 }];
/// What they may be off the solution.
const VORTEX_LIMIT: f64 = 0.02;

/// What a cavity came to.
struct Steady {
    reynolds: u32,
    side: u32,
    end: End,
    /// u on the upright line, v on the level one.
    lines: [Line; 2],
    psi: GridField,
    cloud: Cloud,
    /// Change of the mean kinetic energy from the window before the last.
    change: f64,
    energy: [Vec<f64>; 2],
}

/// Re = 100 at 50² (in full all of the published resolutions).
pub fn lid(scope: Scope) -> Result<Verdict, RunError> {
    timed("cavity: sliding lid, against Ghia, Ghia & Shin (walls left out; means of the last 5 L/U)", || {
        let cases: Vec<&Case> = CASES
            .iter()
            .filter(|case| scope.takes(&format!("Re {} {}", case.reynolds, case.side), case.quick))
            .collect();
        let mut found: Vec<Steady> = Vec::new();
        let mut rows = Vec::new();
        for case in cases {
            let coarser = found.iter().find(|other| other.reynolds == case.reynolds);
            let steady = run(case, coarser.filter(|_| case.nested).map(|coarse| &coarse.psi))?;
            rows.extend(judge(case, &steady));
            if let Some(coarse) = coarser.filter(|_| case.limit.is_finite()) {
                for (k, letter) in ["u", "v"].into_iter().enumerate() {
                    let error = |line: &Line| {
                        rms(&line.ours, if line.solved.is_empty() { &line.ghia } else { &line.solved })
                    };
                    let ratio = error(&steady.lines[k]) / error(&coarse.lines[k]);
                    rows.push(Row {
                        quantity: format!("Re {}: error of {letter} over the coarser one", case.reynolds),
                        ours: ratio,
                        error: ratio,
                        limit: 0.999,
                        ..Row::default()
                    });
                }
            }
            found.push(steady);
        }
        let (curves, figures) = drawing::draw(&found);
        Ok(Findings { rows, curves, figures })
    })
}

/// From rest, or with the velocity of a stream function.
fn run(case: &Case, start: Option<&GridField>) -> Result<Steady, RunError> {
    let shipped = Shipped { model: include_str!("../../models/validation/cavity.yaml"), reactions: None };
    let mut values = across(case.side);
    values.push(format!("fluid.viscosity={} Pa s", 1.0 / f64::from(case.reynolds)));
    values.push(format!("run.until={} s", case.until));
    values.push(format!("output.particles.times=[{} s]", case.until));
    let mut lines = [
        (
            include_str!("data/ghia1982_u_vertical_centreline.csv"),
            include_str!("data/cavity_solved_u.csv"),
            "y",
            "u",
        ),
        (
            include_str!("data/ghia1982_v_horizontal_centreline.csv"),
            include_str!("data/cavity_solved_v.csv"),
            "x",
            "v",
        ),
    ]
    .map(|(ghia, solved, place, letter)| {
        stations(&Table::read(ghia), &Table::read(solved), place, letter, case.reynolds)
    });
    let mesh = Mesh { cells: CELLS };
    let wanted = Wanted::new(&lines, mesh);
    let keep = (WINDOW / EVERY).round() as usize;
    let mut energy = [Vec::new(), Vec::new()];
    let mut readings: std::collections::VecDeque<Vec<Vector<2>>> = std::collections::VecDeque::new();
    let (mut change, mut cloud) = (f64::NAN, drawing::cloud_of(None, case.side));
    let prepare = |flow: &mut Flow<2>| {
        if let Some(psi) = start {
            flow.set_velocity(|x| velocity_of(psi, x));
        }
    };
    let end = watch_plane_from(&shipped, &values, EVERY, prepare, |look| {
        energy[0].push(look.time);
        energy[1].push(look.kinetic_energy());
        change = drift(&energy[1], keep);
        // Reading costs as much as some steps: only where the end is in sight.
        if change < 10.0 * STEADY || look.time > case.until - WINDOW - 0.5 * EVERY {
            readings.push_back(wanted.read(look));
            if readings.len() > keep {
                readings.pop_front();
            }
        } else {
            readings.clear();
        }
        cloud = drawing::cloud_of(Some(look), case.side);
        change >= STEADY || readings.len() < keep
    })?;
    let averaged: Vec<Vector<2>> = (0..wanted.places.len())
        .map(|k| readings.iter().map(|r| r[k]).sum::<Vector<2>>() / readings.len() as f64)
        .collect();
    let psi = wanted.hand_out(&averaged, &mut lines, mesh);
    Ok(Steady { reynolds: case.reynolds, side: case.side, end, lines, psi, cloud, change, energy })
}

/// Relative change between the means of the last `keep` values and of those before; infinite where there are fewer.
/// (Single values swing by some 1e-3 with the particles.)
fn drift(values: &[f64], keep: usize) -> f64 {
    match values.len().checked_sub(2 * keep) {
        Some(first) => (mean(&values[first + keep..]) / mean(&values[first..first + keep]) - 1.0).abs(),
        None => f64::INFINITY,
    }
}

fn judge(case: &Case, steady: &Steady) -> Vec<Row> {
    let what = format!("Re {}, {1} x {1}", case.reynolds, case.side);
    let mut rows = Vec::new();
    for (line, letter) in steady.lines.iter().zip(["u on x = 0.5", "v on y = 0.5"]) {
        let own = rms(&line.solved, &line.ghia);
        let (note, limit) = match own > case.limit {
            true => (" (tables in doubt)", f64::INFINITY),
            false => ("", case.limit),
        };
        rows.push(judged(
            format!("{what}: {letter}, rms from Ghia{note}"),
            rms(&line.ours, &line.ghia),
            None,
            limit,
        ));
        if !line.solved.is_empty() {
            rows.push(judged(
                format!("{what}: the same, from the independent solution"),
                rms(&line.ours, &line.solved),
                None,
                case.limit.max(SOLVED_LIMIT),
            ));
            rows.push(stated(format!("{what}: the same, Ghia from the independent solution"), own));
        }
    }
    rows.push(stated(format!("{what}: change of kinetic energy, means of 5 L/U"), steady.change));
    rows.push(stated(format!("{what}: ended at t U/L"), steady.end.time));
    for (which, name, [solved, printed]) in [(Corner::Left, "left", LEFT), (Corner::Right, "right", RIGHT)] {
        let found = corner(&steady.psi, which);
        for (part, ours, solved, printed) in [
            ("width", found.map(|e| e.width), solved.width, printed.width),
            ("height", found.map(|e| e.height), solved.height, printed.height),
        ] {
            let quantity = format!("{what}: {part} of the {name} corner vortex");
            let ours = ours.unwrap_or(0.0);
            rows.push(if case.reynolds == 1000 {
                Row {
                    quantity,
                    ours,
                    published: Some(printed),
                    reference: Some(solved),
                    error: (ours - solved).abs(),
                    limit: VORTEX_LIMIT,
                }
            } else {
                stated(quantity, ours)
            });
        }
    }
    rows.extend(steady.end.rows(&what));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_is_that_of_means() {
        assert_eq!(drift(&[1.0, 3.0, 2.0], 2), f64::INFINITY);
        assert!((drift(&[9.0, 1.0, 3.0, 3.0, 2.0], 2) - 0.25).abs() < 1e-15);
    }
}
