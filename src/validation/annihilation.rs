//! A + B -> 0 between two reservoirs on a line.

use super::series::probe;
use super::table::Table;
use super::{Row, Shipped, Verdict, run, timed};
use crate::error::RunError;
use crate::statistics::relative_l2;

/// Profiles of A and B against finite differences at five times, continuous and (as the mean of an ensemble)
/// discrete. In units of 10 µm and 10 µM: diffusivity 0.1 1/s, K = 10 1/s.
pub fn front(full: bool) -> Result<Verdict, RunError> {
    let shipped = Shipped {
        model: include_str!("../../models/annihilation_front.yaml"),
        reactions: Some(("annihilation.yaml", include_str!("../../reactions/annihilation.yaml"))),
    };
    let table = Table::read(include_str!("data/annihilation1d_K10.csv"));
    let count = if full { 2000 } else { 200 };
    timed("annihilation_front: A + B -> 0 on 65 particles, K = 10", || {
        let continuous =
            run(&shipped, &["chemistry.representation=continuous".into(), "run.realizations=1".into()])?;
        let discrete = run(&shipped, &[format!("run.realizations={count}")])?;
        let mut rows = Vec::new();
        for (kind, results) in [("continuous", &continuous), ("ensemble mean", &discrete)] {
            for (time, column) in [(0.2, "t0.2"), (0.4, "t0.4"), (0.6, "t0.6"), (0.8, "t0.8"), (1.0, "t1")] {
                let (mut ours, mut exact) = (Vec::new(), Vec::new());
                for (species, letter) in [("A", "a"), ("B", "b")] {
                    ours.extend(probe(results, "profile", species, time).iter().map(|(_, c)| c / 1e-2));
                    exact
                        .extend((0..table.len()).map(|row| table.number(row, &format!("{letter}_{column}"))));
                }
                let error = if ours.len() == exact.len() { relative_l2(&ours, &exact) } else { f64::NAN };
                // Measured 8.5e-4 at worst, second order in the spacing; the mean of an ensemble adds its
                // sampling error, 941 molecules in a particle at most.
                let sampling = 2.0 / (941.0 * f64::from(count)).sqrt();
                let limit = if kind == "continuous" { 1.5e-3 } else { 1.5e-3 + sampling };
                rows.push(Row {
                    quantity: format!("{kind}: A and B at {time} s, relative L2 error"),
                    ours: error,
                    published: None,
                    reference: Some(0.0),
                    error,
                    limit,
                });
            }
        }
        Ok(rows)
    })
}
