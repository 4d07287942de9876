//! A + B -> 0 between two reservoirs on a line.

use super::nodes::{GRIDS, Sample, free, grid, mean, norm, order, sampled};
use super::table::Table;
use super::{Row, Scope, Shipped, Verdict, frames, timed};
use crate::chemistry::AVOGADRO;
use crate::error::RunError;
use crate::samples::ParticleFrame;
use crate::statistics::relative_l2;

/// Times of the references, s, and their columns.
const TIMES: [(f64, &str); 5] = [(0.2, "t0.2"), (0.4, "t0.4"), (0.6, "t0.6"), (0.8, "t0.8"), (1.0, "t1")];

/// Profiles of A and B against finite differences at five times, continuous and (as the mean of an ensemble)
/// discrete. In units of 10 µm and 10 µM: diffusivity 0.1 1/s, K = 10 and 100 1/s.
pub fn front(scope: Scope) -> Result<Verdict, RunError> {
    let count = if scope.full { 2000 } else { 200 };
    timed("annihilation_front: A + B -> 0 on lines of 17, 33, 65 particles", || {
        let mut rows = Vec::new();
        for (rate, text) in [
            (10, include_str!("data/annihilation1d_K10.csv")),
            (100, include_str!("data/annihilation1d_K100.csv")),
        ] {
            rows.extend(profiles(rate, &Table::read(text), count)?);
        }
        Ok(rows)
    })
}

/// All rows of one rate: the continuous model on each grid, its order, and an ensemble on the finest grid.
fn profiles(rate: u32, table: &Table, count: u32) -> Result<Vec<Row>, RunError> {
    let shipped = Shipped {
        model: include_str!("../../models/annihilation_front.yaml"),
        reactions: Some(("annihilation.yaml", include_str!("../../reactions/annihilation.yaml"))),
    };
    let mut rows = Vec::new();
    let mut errors = [[0.0; 3]; TIMES.len()];
    for (g, n) in GRIDS.into_iter().enumerate() {
        let mut values = grid(n, 1);
        // K = k C0 with C0 = 10 µM.
        values.push(format!("reactions.reactions.annihilation.rate={} /uM/s", f64::from(rate) / 10.0));
        let continuous = ["chemistry.representation=continuous".into(), "run.realizations=1".into()];
        let scheme = frames(&shipped, &[&values[..], &continuous].concat())?;
        for (k, (time, column)) in TIMES.into_iter().enumerate() {
            let error = relative_l2(&both(&scheme, n, time), &reference(table, n, column));
            errors[k][g] = error;
            rows.push(Row {
                quantity: format!("K = {rate}, N = {n}, continuous at {time} s, relative L2 error"),
                ours: error,
                reference: Some(0.0),
                error,
                // Measured 5.0e-3 at worst, at 0.2 s on the coarsest grid, falling as the square of the spacing.
                limit: 6e-3 * (16.0 / (n - 1) as f64).powi(2),
                ..Row::default()
            });
        }
        if n == 65 {
            let drawn = frames(&shipped, &[&values[..], &ensemble(count)].concat())?;
            for (time, column) in TIMES {
                let exact = reference(table, n, column);
                let ours = both(&drawn, n, time);
                rows.push(sampled(
                    format!("K = {rate}, N = {n}, mean of {count} at {time} s, L2 error (deviations)"),
                    (norm(&ours, &exact, 1), None),
                    (&both(&scheme, n, time), &exact),
                    Sample { realizations: count, full: molecules_when_full(n), intervals: 1 },
                ));
            }
        }
    }
    for ((time, _), errors) in TIMES.into_iter().zip(&errors) {
        rows.push(order(format!("K = {rate}, order in the spacing at {time} s"), errors));
    }
    Ok(rows)
}

/// The values to set for an ensemble whose particles are all kept.
fn ensemble(count: u32) -> [String; 2] {
    [format!("run.realizations={count}"), format!("output.particles.realizations={count}")]
}

/// Molecules at 10 µM in a particle of the line, 1 µm x 1 µm across.
fn molecules_when_full(n: usize) -> f64 {
    1e-2 * AVOGADRO * 1e-12 * 10e-6 / (n - 1) as f64
}

/// A and then B at the free nodes, over 10 µM.
fn both(frames: &[ParticleFrame], n: usize, time: f64) -> Vec<f64> {
    let of = |species| mean(frames, species, time, molecules_when_full(n));
    [free(&of(0)), free(&of(1))].concat()
}

/// The same of the reference.
fn reference(table: &Table, n: usize, column: &str) -> Vec<f64> {
    let of = |letter: char| table.every(&format!("{letter}_{column}"), 64 / (n - 1));
    [free(&of('a')), free(&of('b'))].concat()
}
