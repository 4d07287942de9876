//! Table 2.3 of the dissertation on the sSSA-SDPD hybrid: A + B -> 0 on a line between two reservoirs.

use super::compact;
use super::nodes::{FULL, GRIDS, Sample, free, grid, mean, molecules, norm, ours, printed, sampled};
use super::table::Table;
use super::{Row, Scope, Shipped, Verdict, frames, timed};
use crate::error::RunError;

/// Printed errors of the deterministic scheme and of 100 realizations.
const PRINTED: [f64; 3] = [1.856e-4, 1.698e-4, 2.325e-4];
const PRINTED_SAMPLED: [f64; 3] = [7.285e-4, 5.334e-4, 6.644e-4];
const REALIZATIONS: u32 = 100;
/// Cut-offs in spacings that the printed numbers follow from.
const SUPPORT: [f64; 3] = [1.8, 1.5, 1.8];
/// K = k C0, 1/s.
const RATE: [u32; 3] = [1600, 3200, 6400];
/// What the stated settings give at 65 particles, where the printed number does not follow from them.
const AT_65: f64 = 5.11e-5;
/// Measured 1.20e-4, 1.88e-5, 3.4e-6 for our operator; at 17 particles the front is one spacing wide.
const LIMITS: [f64; 3] = [1.5e-4, 2.5e-5, 4.5e-6];
const TIME: f64 = 1.0;

/// The printed operator, ours, and whole molecules on 17 and 33 particles (and 65 in full).
pub fn line(scope: Scope) -> Result<Verdict, RunError> {
    let shipped = Shipped { model: include_str!("../../models/validation/table_2_3.yaml"), reactions: None };
    let table = Table::read(include_str!("data/annihilation1d_t1.csv"));
    timed("table_2_3: A + B -> 0 on a line (errors of A)", || {
        let mut rows = Vec::new();
        for (k, n) in GRIDS.into_iter().enumerate() {
            let exact = table.every(&format!("a_K{}", RATE[k]), 64 / (n - 1));
            let mut case = grid(n, 1);
            case.push(format!("particles.support={}", SUPPORT[k]));
            // Per pair of molecules.
            let rate = f64::from(RATE[k]) / FULL;
            case.push(format!("reactions.reactions.annihilation.rate={rate} 1/s"));
            let seen = mean(&frames(&shipped, &case)?, 0, TIME, FULL);
            let theirs = compact::annihilation(n, f64::from(RATE[k]));
            let error = norm(&seen, &theirs, n - 1);
            rows.push(if n == 65 {
                Row {
                    quantity: "N = 65, printed operator (print not reproducible)".into(),
                    ours: error,
                    published: Some(PRINTED[k]),
                    reference: Some(AT_65),
                    error: (error / AT_65 - 1.0).abs(),
                    limit: 1e-2,
                }
            } else {
                printed(format!("N = {n}, printed operator, compact differences"), error, PRINTED[k])
            });
            let values = [&case[..], &ours()].concat();
            let scheme = mean(&frames(&shipped, &values)?, 0, TIME, FULL);
            let error = norm(&scheme, &exact, n - 1);
            rows.push(Row {
                quantity: format!("N = {n}, our operator, converged reference"),
                ours: error,
                published: Some(PRINTED[k]),
                reference: Some(0.0),
                error,
                limit: LIMITS[k],
            });
            if n < 65 || scope.full {
                let sample = [&values[..], &molecules(REALIZATIONS)].concat();
                let drawn = mean(&frames(&shipped, &sample)?, 0, TIME, FULL);
                rows.push(sampled(
                    format!("N = {n}, {REALIZATIONS} realizations (deviations)"),
                    (norm(&drawn, &exact, n - 1), Some(PRINTED_SAMPLED[k])),
                    (free(&scheme), free(&exact)),
                    Sample { realizations: REALIZATIONS, full: FULL, intervals: n - 1 },
                ));
            }
        }
        Ok(rows)
    })
}
