//! Rings and spherical shells under pressure from inside: Lamé (1852); Timoshenko & Goodier (1951), sections 28 and 136.

use super::findings::{Curves, Findings};
use super::flow::stated;
use super::{Row, Scope, Verdict, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, palette};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::solid::{Hold, Law, Material, Options, Relaxation, Setup, Turgor, Vessel, Wall};
use crate::space::{Domain, KernelKind};
use crate::statistics::convergence_order;
use crate::vector::Vector;
use std::time::Instant;

/// Radii of the wall of a yeast cell (SPH-BVF, section 5), m, and of a thin one of the same outer radius.
const OUTER: f64 = 10e-6;
const THICK: f64 = 7.5e-6;
const THIN: f64 = 9e-6;
/// Young's modulus (Pa) and Poisson's ratio of the published wall; the pressure (Pa) keeps strains at 1e-5.
const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3975;
const PRESSURE: f64 = 1.0;
/// Largest relative errors that pass.
const LIMIT: f64 = 0.02;
const QUANTITIES: [&str; 3] = ["radial displacement", "radial stress", "hoop stress"];

/// A wall under pressure: of each particle its radius at rest, then u, σ_rr and σ_θθ, ours and exact.
struct Round {
    rows: Vec<[f64; 7]>,
    seconds: f64,
}

/// u, σ_rr and σ_θθ at a radius: plane strain in 2D.
fn exact<const D: usize>(r: f64, inner: f64) -> [f64; 3] {
    let d = D as i32;
    let (k, bulge) = (PRESSURE * inner.powi(d) / (OUTER.powi(d) - inner.powi(d)), (OUTER / r).powi(d));
    let around = if D == 2 { bulge } else { 0.5 * bulge };
    let spread =
        if D == 2 { 1.0 - 2.0 * POISSON + bulge } else { 1.0 - 2.0 * POISSON + (1.0 + POISSON) * around };
    let factor = if D == 2 { 1.0 + POISSON } else { 1.0 };
    [factor * k * r * spread / YOUNG, k * (1.0 - bulge), k * (1.0 + around)]
}

fn round<const D: usize>(inner: f64, layers: usize) -> Result<Round, RunError> {
    let begun = Instant::now();
    let spacing = (OUTER - inner) / layers as f64;
    let built = Wall::<D>::round(&Vector::zeros(), inner, OUTER, spacing);
    let n = built.places.len();
    let far = 3.0 * OUTER;
    let setup = Setup {
        domain: Domain {
            min: Vector::from_element(-far),
            max: Vector::from_element(far),
            periodic: [false; D],
        },
        kernel: KernelKind::Lucy,
        cutoff: 1.6 * spacing,
        places: built.places,
        volumes: built.volumes,
        holds: vec![Hold::Free; n],
        material: Material::of_young(Law::NeoHookean, 1100.0, YOUNG, POISSON),
        options: Options::default(),
    };
    let turgor = Turgor { pressure: PRESSURE, stiffness: 0.0, rise: 0.0 };
    let relaxation = Relaxation { tolerance: 1e-6, rounds: 200_000, ..Relaxation::default() };
    let mut vessel = Vessel::new(setup, built.wall, turgor, None, relaxation)?;
    vessel.relax(0.0)?;
    let normals = vessel.wall.normals(&vessel.solid);
    let rows = vessel
        .wall
        .stresses(&vessel.solid, &normals)
        .iter()
        .enumerate()
        .map(|(i, stress)| {
            let x = vessel.solid.places()[i];
            let (r, out) = (x.norm(), x / x.norm());
            let plane: f64 = (0..D).map(|k| stress[(k, k)]).sum();
            let across: f64 = (0..D)
                .flat_map(|a| (0..D).map(move |b| (a, b)))
                .map(|(a, b)| out[a] * stress[(a, b)] * out[b])
                .sum();
            let u = (vessel.solid.position(i) - x).dot(&out);
            let [e, f, g] = exact::<D>(r, inner);
            [r, u, across, (plane - across) / (D as f64 - 1.0), e, f, g]
        })
        .collect();
    Ok(Round { rows, seconds: begun.elapsed().as_secs_f64() })
}

impl Round {
    /// Root of the mean square errors of u, σ_rr and σ_θθ, over those of u and of both stresses together.
    fn errors(&self) -> [f64; 3] {
        let sum = |of: &dyn Fn(&[f64; 7]) -> f64| self.rows.iter().map(|row| of(row).powi(2)).sum::<f64>();
        let whole = sum(&|row| row[5].hypot(row[6]));
        let over = [sum(&|row| row[4]), whole, whole];
        [0, 1, 2].map(|k| (sum(&|row: &[f64; 7]| row[1 + k] - row[4 + k]) / over[k]).sqrt())
    }
}

/// Rings of 4 to 8 layers, thick and thin, and spherical shells of 4 (6 as well in full).
pub fn walls(scope: Scope) -> Result<Verdict, RunError> {
    timed("lame: walls under pressure from inside (relative L2 error over the particles)", || {
        let (mut rows, mut curves, mut panels) = (Vec::new(), Vec::new(), Vec::new());
        type Run = fn(f64, usize) -> Result<Round, RunError>;
        let kinds: [(&str, Run, f64, [usize; 3]); 3] = [
            ("ring", round::<2>, THICK, [4, 6, 8]),
            ("thin ring", round::<2>, THIN, [4, 6, 8]),
            ("shell", round::<3>, THICK, [3, 4, 6]),
        ];
        for (kind, run, inner, every) in kinds {
            let (mut sizes, mut errors) = (Vec::new(), Vec::new());
            let mut drawn = None;
            for layers in every {
                if !scope.takes(&format!("{kind} {layers}"), kind != "shell" || layers < 6) {
                    continue;
                }
                let found = run(inner, layers)?;
                // Three layers are what is shown of the way there, not what is meant to be used.
                let limit = if layers > 3 { LIMIT } else { f64::INFINITY };
                for (name, error) in QUANTITIES.iter().zip(found.errors()) {
                    let quantity = format!("{kind}, {layers} layers, {} particles: {name}", found.rows.len());
                    rows.push(Row {
                        quantity,
                        ours: error,
                        reference: Some(0.0),
                        error,
                        limit,
                        ..Row::default()
                    });
                }
                rows.push(stated(format!("{kind}, {layers} layers: wall time, s"), found.seconds));
                sizes.push(1.0 / layers as f64);
                errors.push(found.errors());
                drawn = Some((layers, found));
            }
            if errors.len() > 1 {
                for (k, name) in QUANTITIES.iter().enumerate() {
                    let one: Vec<f64> = errors.iter().map(|e| e[k]).collect();
                    rows.push(stated(format!("{kind}: order of {name}"), convergence_order(&sizes, &one)));
                }
            }
            if let Some((layers, found)) = drawn {
                let column =
                    |k: usize, unit: f64| found.rows.iter().map(|r| r[k] * unit).collect::<Vec<f64>>();
                let names = ["r", "u", "srr", "stt", "u_exact", "srr_exact", "stt_exact"];
                let columns: Vec<(&str, Vec<f64>)> =
                    names.iter().enumerate().map(|(k, name)| (*name, column(k, 1.0))).collect();
                curves.push(Curves::new(&format!("{}_{layers}", kind.replace(' ', "_")), columns));
                panels.push(panel(kind, layers, &found, inner, panels.len()));
            }
        }
        let caption =
            "Stresses across the wall over those of Lamé (lines), every particle at its radius at rest.";
        let figures = vec![plots("lame", "Walls under pressure from inside", caption, &panels, 3, 46.0)];
        Ok(Findings { rows, curves, figures })
    })
}

fn panel(kind: &str, layers: usize, found: &Round, inner: f64, number: usize) -> Plot {
    let fine: Vec<f64> = (0..=60).map(|k| inner + (OUTER - inner) * f64::from(k) / 60.0).collect();
    let of = |r: f64| if kind == "shell" { exact::<3>(r, inner) } else { exact::<2>(r, inner) };
    let micro = |r: &[f64]| r.iter().map(|r| r * 1e6).collect::<Vec<f64>>();
    // Shells have thousands of particles, all alike.
    let mut every = (found.rows.len() / 300).max(1);
    // Of every layer some.
    while (2..=layers).any(|k| layers.is_multiple_of(k) && every.is_multiple_of(k)) {
        every += 1;
    }
    let some: Vec<&[f64; 7]> = found.rows.iter().step_by(every).collect();
    let radii: Vec<f64> = some.iter().map(|row| row[0]).collect();
    let mut traces = Vec::new();
    for (k, name) in [(1, "radial stress"), (2, "hoop stress")] {
        let line: Vec<f64> = fine.iter().map(|&r| of(r)[k]).collect();
        let points: Vec<f64> = some.iter().map(|row| row[1 + k]).collect();
        traces.push(Trace::new("", &micro(&radii), &points, Style::Points, palette(k)));
        traces.push(Trace::new(
            name,
            &micro(&fine),
            &line,
            Style::Line,
            if k == 1 { BLACK } else { palette(k) },
        ));
    }
    let letter = ["a", "b", "c"][number.min(2)];
    Plot {
        title: format!("{letter}  {kind}, {layers} layers"),
        x: Ruler::linear("r (µm)"),
        y: Ruler::linear("stress (Pa)"),
        traces,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_walls_carry_the_pressure_inside_and_nothing_outside() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-10 * PRESSURE, "{a} {b}");
        near(exact::<2>(THICK, THICK)[1], -PRESSURE);
        near(exact::<3>(THICK, THICK)[1], -PRESSURE);
        near(exact::<2>(OUTER, THICK)[1], 0.0);
        near(exact::<3>(OUTER, THICK)[1], 0.0);
        // Hooke's law around: ε_θθ = u/r.
        let [u, across, hoop] = exact::<2>(8e-6, THICK);
        near((1.0 + POISSON) * ((1.0 - POISSON) * hoop - POISSON * across), YOUNG * u / 8e-6);
        let [u, across, hoop] = exact::<3>(8e-6, THICK);
        near(hoop - POISSON * (hoop + across), YOUNG * u / 8e-6);
    }
}
