//! Decaying vortices in a periodic box (Taylor & Green 1937; Jacob et al. 2021, section 4.2).

use super::findings::{Curves, Findings};
use super::flow::{End, across, judged, watch_plane};
use super::{Row, Scope, Shipped, Verdict, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, palette};
use crate::figures::maps::{Cloud, Window, particles};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::vector::Vector;
use std::f64::consts::TAU;

/// Particles along a side, and the largest errors that pass.
const SIDES: [(u32, f64); 3] = [(50, 0.02), (100, 0.01), (200, 0.005)];
/// Printed for all three: "about 2 %" of the largest speed.
const PRINTED: f64 = 0.02;
const REYNOLDS: f64 = 100.0;
/// Kinetic energy is looked at at this time.
const ENERGY_AT: f64 = 2.0;
const ENERGY_LIMIT: f64 = 0.02;
/// Particles are drawn at these times.
const SHOWN: [f64; 2] = [0.1, 0.5];

/// exp(b t), b = -8 π²/Re.
fn decay(t: f64) -> f64 {
    (-2.0 * TAU * TAU / REYNOLDS * t).exp()
}

/// Eqs (52), (53).
fn exact(x: &Vector<2>, t: f64) -> Vector<2> {
    let [x, y] = [TAU * x[0], TAU * x[1]];
    Vector::from([-x.cos() * y.sin(), x.sin() * y.cos()]) * decay(t)
}

/// A run at one resolution, over time.
#[derive(Default)]
struct Decay {
    side: u32,
    end: End,
    time: Vec<f64>,
    fastest: Vec<f64>,
    /// Relative error of the largest speed, Eq. (54).
    wrong: Vec<f64>,
    /// Relative L2 error of the field.
    field: Vec<f64>,
    /// Kinetic energy over the exact one.
    energy: Vec<f64>,
    clouds: Vec<Cloud>,
}

/// 50² particles (in full 100² and 200² too) to t = 5.
pub fn vortices(scope: Scope) -> Result<Verdict, RunError> {
    timed("taylor_green: decaying vortices, Re = 100, from a lattice, to t = 5", || {
        let sides: Vec<_> =
            SIDES.iter().filter(|(n, _)| scope.takes(&n.to_string(), *n == 50)).copied().collect();
        let runs = sides.iter().map(|&(side, _)| run(side)).collect::<Result<Vec<Decay>, RunError>>()?;
        let mut rows = Vec::new();
        for (one, &(side, limit)) in runs.iter().zip(&sides) {
            rows.extend(judge(one, side, limit));
        }
        Ok(draw(rows, &runs))
    })
}

fn run(side: u32) -> Result<Decay, RunError> {
    let shipped =
        Shipped { model: include_str!("../../models/validation/taylor_green.yaml"), reactions: None };
    let mut one = Decay { side, ..Decay::default() };
    let end = watch_plane(&shipped, &across(side), 0.1, |look| {
        let t = look.time;
        if t > 0.0 {
            one.time.push(t);
            one.fastest.push(look.fastest());
            one.wrong.push(look.fastest() / decay(t) - 1.0);
            let size = look.rms(|x, _| exact(x, t).norm());
            one.field.push(look.rms(|x, v| (v - exact(x, t)).norm()) / size);
            // Mean of |v|²/2 is a quarter of the square of the largest speed.
            one.energy.push(look.kinetic_energy() / (0.25 * decay(t).powi(2)));
        }
        if SHOWN.iter().any(|shown| (t - shown).abs() < 1e-6) {
            one.clouds.push(Cloud {
                window: Window {
                    title: format!("t = {t:.1} L/U"),
                    ends: [0.0, 1.0, 0.0, 1.0],
                    labels: ["x / L".into(), "y / L".into()],
                },
                position: look.position.iter().map(|x| [x[0], x[1]]).collect(),
                value: look.velocity.iter().map(|v| v.norm()).collect(),
                size: 1.0 / f64::from(side),
            });
        }
        true
    })?;
    one.end = end;
    Ok(one)
}

fn judge(one: &Decay, side: u32, limit: f64) -> Vec<Row> {
    let worst = |values: &[f64]| values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let mean = one.wrong.iter().map(|v| v.abs()).sum::<f64>() / one.wrong.len() as f64;
    let at = one.time.iter().position(|t| (t - ENERGY_AT).abs() < 1e-6);
    let energy = at.map_or(f64::NAN, |k| one.energy[k]);
    let name = |what: &str| format!("{side} x {side}: {what}");
    let mut rows = vec![
        judged(name("worst relative error of the largest speed"), worst(&one.wrong), Some(PRINTED), limit),
        super::flow::stated(name("mean relative error of the largest speed"), mean),
        judged(name("worst relative L2 error of the field"), worst(&one.field), None, limit),
        Row {
            quantity: name("kinetic energy at t = 2 over the exact one"),
            ours: energy,
            reference: Some(1.0),
            error: (energy - 1.0).abs(),
            limit: ENERGY_LIMIT,
            ..Row::default()
        },
    ];
    rows.extend(one.end.rows(&format!("{side} x {side}")));
    rows
}

fn draw(rows: Vec<Row>, runs: &[Decay]) -> Findings {
    let mut curves = Vec::new();
    let (mut speeds, mut errors, mut fields, mut energies) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (k, one) in runs.iter().enumerate() {
        let name = format!("{0} x {0}", one.side);
        let percent = |values: &[f64]| values.iter().map(|v| 100.0 * v).collect::<Vec<f64>>();
        let trace = |y: &[f64]| Trace::new(&name, &one.time, y, Style::Line, palette(k));
        speeds.push(trace(&one.fastest));
        errors.push(trace(&percent(&one.wrong)));
        fields.push(trace(&percent(&one.field)));
        energies.push(trace(&percent(&one.energy.iter().map(|e| e - 1.0).collect::<Vec<f64>>())));
        curves.push(Curves::new(
            &format!("decay_{}", one.side),
            [
                ("t", one.time.clone()),
                ("largest_speed", one.fastest.clone()),
                ("error_largest_speed", one.wrong.clone()),
                ("relative_l2", one.field.clone()),
                ("kinetic_energy_over_exact", one.energy.clone()),
            ],
        ));
    }
    if let Some(first) = runs.first() {
        let exact: Vec<f64> = first.time.iter().map(|&t| decay(t)).collect();
        speeds.push(Trace::new("exact", &first.time, &exact, Style::Dashed, BLACK));
    }
    let t = || Ruler::linear("t U / L");
    let panels = [
        Plot { title: "a  decay".into(), x: t(), y: Ruler::logarithmic("largest speed / U"), traces: speeds },
        Plot { title: "b  largest speed".into(), x: t(), y: Ruler::linear("error (%)"), traces: errors },
        Plot { title: "c  field".into(), x: t(), y: Ruler::linear("relative L2 error (%)"), traces: fields },
        Plot { title: "d  kinetic energy".into(), x: t(), y: Ruler::linear("error (%)"), traces: energies },
    ];
    let mut figures = vec![plots(
        "taylor_green",
        "Taylor-Green vortices, Re = 100",
        "a: largest speed over time. b: its error relative to the exact one of that time. c: root mean square error \
         of the velocity over that of the exact one. d: error of the kinetic energy.",
        &panels,
        2,
        46.0,
    )];
    if let Some(first) = runs.first() {
        figures.push(particles(
            "taylor_green_particles",
            "Particles of the Taylor-Green vortices",
            "Coloured by speed; started from a square lattice.",
            &first.clouds,
            "speed / U",
        ));
    }
    Findings { rows, curves, figures }
}
