//! A hot cylinder in a cold square cavity (Moukalled & Acharya 1996; Jacob et al. 2021, section 4.4).

mod drawing;
mod states;

use super::findings::Findings;
use super::flow::{End, stated};
use super::table::Table;
use super::{Row, Scope, Shipped, Verdict, failed, timed, with_plan};
use crate::error::RunError;
use crate::figures::contour::GridField;
use crate::plan::Arena;
use crate::samples::ParticleFrame;
use crate::simulation::Watch;
use states::{grid, read};

/// Of the model: side (m), free-fall speed (m/s), concentration of the cylinder (mol/m³), Schmidt number.
const SIDE: f64 = 1e-3;
const SPEED: f64 = 1e-3;
const HOT: f64 = 1.0;
const SCHMIDT: f64 = 0.7;
/// Radius of the cylinder over the side; it stands in the middle.
const RADIUS: f64 = 0.1;
/// Of the plane, m.
const THICKNESS: f64 = 1e-3;
/// Coarser runs are stated only.
const JUDGED_FROM: u32 = 100;
/// Root mean square error of c, and relative error of the peak and trough of v, that pass.
const C_LIMIT: f64 = 0.008;
const V_LIMIT: f64 = 0.04;
/// Errors of c and of the Nusselt number against the independent solution that pass: 1.5 and 2.7 times the largest found
/// from 100 x 100 on.
const C_EXACT_LIMIT: f64 = 0.004;
const NUSSELT_LIMIT: f64 = 0.01;

/// References of one Rayleigh number and what was published with them.
struct Rayleigh {
    exponent: i32,
    /// Free-fall times until the end.
    until: u32,
    /// States at the end that are averaged, one a free-fall time apart. At Ra = 1e6 the plume sways with a period of
    /// 13.4: two periods.
    states: u32,
    /// Moukalled & Acharya, digitised by others.
    digitised_c: &'static str,
    digitised_v: &'static str,
    /// Independent solution.
    solved: &'static str,
    /// Stored results of the seed's authors against the digitised data: root mean square of c, peak and trough of v.
    stored: [f64; 3],
    /// Mean Nusselt number: published for this geometry (Shu & Zhu 2002).
    nusselt: f64,
}

macro_rules! rayleigh {
    ($exponent:literal, $until:literal, $states:literal, $stored:expr, $nusselt:literal) => {
        Rayleigh {
            exponent: $exponent,
            until: $until,
            states: $states,
            digitised_c: include_str!(concat!("data/moukalled1996_c_ra1e", $exponent, ".csv")),
            digitised_v: include_str!(concat!("data/moukalled1996_vy_ra1e", $exponent, ".csv")),
            solved: include_str!(concat!("data/natural_convection_fd_ra1e", $exponent, ".csv")),
            stored: $stored,
            nusselt: $nusselt,
        }
    };
}

const RAYLEIGH: [Rayleigh; 3] = [
    rayleigh!(4, 20, 6, [0.0141, 18.04, -14.44], 2.07),
    rayleigh!(5, 40, 6, [0.0183, 94.60, -63.70], 3.83),
    rayleigh!(6, 80, 27, [0.0217, 232.7, -196.6], 6.11),
];

/// What a run came to.
struct Convection {
    rayleigh: &'static Rayleigh,
    across: u32,
    end: End,
    /// x from the cylinder to the wall, and c and v L/ν there.
    x: Vec<f64>,
    c: Vec<f64>,
    v: Vec<f64>,
    nusselt: f64,
    /// c on a grid over the cavity.
    field: GridField,
}

/// Ra = 1e4 with 50 x 50 (stated) and 100 x 100 particles (in full 1e5, 1e6 and 200 x 200 too).
pub fn cylinder(scope: Scope) -> Result<Verdict, RunError> {
    timed("natural_convection: hot cylinder in a cold square, Sc = 0.7 (v in ν/L)", || {
        let (mut rows, mut found) = (Vec::new(), Vec::new());
        for (k, rayleigh) in RAYLEIGH.iter().enumerate() {
            for across in [50, 100, 200] {
                if scope.takes(&format!("Ra 1e{} {across}", rayleigh.exponent), k == 0 && across < 200) {
                    let one = run(rayleigh, across)?;
                    rows.extend(judge(&one));
                    found.push(one);
                }
            }
        }
        let (curves, figures) = drawing::draw(&found);
        Ok(Findings { rows, curves, figures })
    })
}

fn run(rayleigh: &'static Rayleigh, across: u32) -> Result<Convection, RunError> {
    let shipped =
        Shipped { model: include_str!("../../models/validation/natural_convection.yaml"), reactions: None };
    let ra = 10f64.powi(rayleigh.exponent);
    let viscosity = SPEED * SIDE * (SCHMIDT / ra).sqrt();
    let seen: Vec<String> = (0..rayleigh.states).rev().map(|k| format!("{} s", rayleigh.until - k)).collect();
    let values = [
        format!("particles.spacing={} m", SIDE / f64::from(across)),
        format!("fluid.viscosity={} Pa s", 1000.0 * viscosity),
        format!("reactions.species.C.diffusion={} m^2/s", viscosity / SCHMIDT),
        format!("run.until={} s", rayleigh.until),
        "output.every=1 s".into(),
        format!("output.particles.times=[{}]", seen.join(", ")),
        "output.probes={ supply: { surface: cylinder } }".into(),
    ];
    let begun = std::time::Instant::now();
    with_plan(&shipped, &values, |plan, ready, _| {
        let outcome = ready.run(&[0], &Watch::silent());
        if let Some(error) = outcome.error {
            return Err(error);
        }
        let flow = outcome.tally.flow.ok_or_else(|| failed("the model has no flow".into()))?;
        let Arena::Plane(arena) = &plan.arena else { return Err(failed("the model is not plane".into())) };
        let end = End {
            time: plan.model.run.until,
            penetrations: flow.penetrations,
            largest_density_change: flow.largest_density_change,
            particle_steps: outcome.tally.particle_steps,
            seconds: begun.elapsed().as_secs_f64(),
        };
        let frames: Vec<&ParticleFrame> = outcome.observed.iter().flat_map(|one| &one.frames).collect();
        let mut one = Convection {
            rayleigh,
            across,
            end,
            x: (0..=160).map(|k| 0.5 + RADIUS + (0.5 - RADIUS) * f64::from(k) / 160.0).collect(),
            c: vec![0.0; 161],
            v: vec![0.0; 161],
            nusselt: 0.0,
            field: grid(),
        };
        for frame in &frames {
            read(&mut one, frame, &arena.domain, &arena.kernel(), 1.0 / frames.len() as f64, viscosity);
        }
        // What leaves the cylinder in κ ΔC; the published number is half of it.
        let seen = |time: f64| frames.iter().any(|frame| frame.time == time);
        let supplied: Vec<f64> = outcome
            .observed
            .iter()
            .flat_map(|one| &one.probes)
            .filter(|rows| rows.probe == "supply" && seen(rows.time))
            .flat_map(|rows| rows.value.iter().copied())
            .collect();
        let supply = supplied.iter().sum::<f64>() / supplied.len() as f64;
        one.nusselt = 0.5 * supply / (viscosity / SCHMIDT * HOT * THICKNESS);
        Ok(one)
    })
}

/// Linear between neighbours of a table; not a number outside.
fn between(x: &[f64], y: &[f64], at: f64) -> f64 {
    (1..x.len())
        .find(|&k| x[k - 1] <= at && at <= x[k])
        .map_or(f64::NAN, |k| y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / (x[k] - x[k - 1]).max(1e-12))
}

/// Largest and smallest value.
fn extremes(values: &[f64]) -> [f64; 2] {
    values
        .iter()
        .filter(|v| v.is_finite())
        .fold([f64::NEG_INFINITY, f64::INFINITY], |[a, b], &v| [a.max(v), b.min(v)])
}

/// Root of the mean square of a profile less a table, where both are known.
fn rms(x: &[f64], y: &[f64], at: &[f64], wanted: &[f64]) -> f64 {
    let wrong: Vec<f64> =
        at.iter().zip(wanted).map(|(&at, w)| between(x, y, at) - w).filter(|e| e.is_finite()).collect();
    (wrong.iter().map(|e| e * e).sum::<f64>() / wrong.len() as f64).sqrt()
}

/// Against the digitised data where the independent solution says they can be met, and against that solution.
fn judge(one: &Convection) -> Vec<Row> {
    let what = format!("Ra 1e{}, {1} x {1}", one.rayleigh.exponent, one.across);
    let [c, v] = [one.rayleigh.digitised_c, one.rayleigh.digitised_v].map(Table::read);
    let solved = Table::read(one.rayleigh.solved);
    let [sx, sc, sv] = ["x", "c", "vy"].map(|name| solved.every(name, 1));
    let (cx, cc) = (c.every("x", 1), c.every("c", 1));
    let in_doubt = |text: String, doubt: bool| if doubt { format!("{text} (data in doubt)") } else { text };
    let digitised = rms(&one.x, &one.c, &cx, &cc);
    let doubt = rms(&sx, &sc, &cx, &cc) > C_LIMIT;
    let mut rows = vec![
        Row {
            quantity: in_doubt(format!("{what}: c, rms from digitised"), doubt),
            ours: digitised,
            published: Some(one.rayleigh.stored[0]),
            reference: Some(0.0),
            error: digitised,
            limit: if doubt { f64::INFINITY } else { C_LIMIT },
        },
        super::flow::judged(
            format!("{what}: c, rms from independent solution"),
            rms(&one.x, &one.c, &sx, &sc),
            None,
            C_EXACT_LIMIT,
        ),
    ];
    let (ours, theirs, exact) = (extremes(&one.v), extremes(&v.every("vy", 1)), extremes(&sv));
    for (k, name) in ["peak", "trough"].into_iter().enumerate() {
        let doubt = (theirs[k] / exact[k] - 1.0).abs() > V_LIMIT;
        for (reference, source, doubt) in [(theirs[k], "digitised", doubt), (exact[k], "independent", false)]
        {
            rows.push(Row {
                quantity: in_doubt(format!("{what}: {name} of v, {source}"), doubt),
                ours: ours[k],
                published: Some(one.rayleigh.stored[k + 1]),
                reference: Some(reference),
                error: (ours[k] / reference - 1.0).abs(),
                limit: if doubt { f64::INFINITY } else { V_LIMIT },
            });
        }
    }
    let numbers = Table::read(include_str!("data/natural_convection_fd_nusselt.csv"));
    let row = (0..numbers.len())
        .find(|&row| (numbers.number(row, "ra").log10() - f64::from(one.rayleigh.exponent)).abs() < 1e-6);
    let nusselt = row.map_or(f64::NAN, |row| numbers.number(row, "nu"));
    rows.push(Row {
        quantity: format!("{what}: mean Nusselt number, independent"),
        ours: one.nusselt,
        published: Some(one.rayleigh.nusselt),
        reference: Some(nusselt),
        error: (one.nusselt / nusselt - 1.0).abs(),
        limit: NUSSELT_LIMIT,
    });
    if one.across < JUDGED_FROM {
        rows.iter_mut().for_each(|row| row.limit = f64::INFINITY);
    }
    rows.push(stated(format!("{what}: ended at t U/L"), one.end.time));
    rows.extend(one.end.rows(&what));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_between_their_points() {
        let (x, y) = ([0.0, 1.0, 3.0], [0.0, 2.0, -2.0]);
        assert_eq!((between(&x, &y, 0.5), between(&x, &y, 2.0)), (1.0, 0.0));
        assert!(between(&x, &y, 4.0).is_nan());
        assert_eq!(extremes(&[f64::NAN, 2.0, -2.0]), [2.0, -2.0]);
        // Off by 0.5 at the one point that is known.
        assert_eq!(rms(&x, &y, &[0.5, 7.0], &[0.5, 0.0]), 0.5);
    }

    #[test]
    fn digitised_data_are_in_doubt_where_the_independent_solution_leaves_them() {
        for (rayleigh, doubt) in
            RAYLEIGH.iter().zip([[false, false, true], [false, true, false], [true, true, true]])
        {
            let solved = Table::read(rayleigh.solved);
            let [sx, sc, sv] = ["x", "c", "vy"].map(|name| solved.every(name, 1));
            let (c, v) = (Table::read(rayleigh.digitised_c), Table::read(rayleigh.digitised_v));
            let (theirs, exact) = (extremes(&v.every("vy", 1)), extremes(&sv));
            let off = |k: usize| (theirs[k] / exact[k] - 1.0).abs() > V_LIMIT;
            let c_off = rms(&sx, &sc, &c.every("x", 1), &c.every("c", 1)) > C_LIMIT;
            assert_eq!([c_off, off(0), off(1)], doubt, "Ra 1e{}", rayleigh.exponent);
        }
    }
}
