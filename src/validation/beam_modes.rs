//! Other beams than the published one: a slender one, a free one, one clamped at both ends, a second mode, one in space.

use super::beams::{Beam, Ends, Swing, elastic};
use super::findings::{Curves, Findings};
use super::flow::stated;
use super::{Row, Scope, Verdict, timed};
use crate::error::RunError;
use crate::figures::colours::{GREY, palette};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::statistics::convergence_order;

/// A beam and what is asked of it.
struct Kind {
    name: &'static str,
    ends: Ends,
    /// Length over height.
    slender: f64,
    mode: usize,
    plane: bool,
    /// Particles across; the last only in full.
    across: [usize; 3],
    /// Largest relative errors that pass: a tenth more than was measured. The order is judged on its own.
    limits: [f64; 3],
}

/// Clamps act about a spacing behind their face: errors of first order where there is one, of second where not.
const KINDS: [Kind; 5] = [
    Kind {
        name: "slender cantilever, L/H = 20",
        ends: Ends::Cantilever,
        slender: 20.0,
        mode: 1,
        plane: true,
        across: [6, 10, 20],
        limits: [0.055, 0.024, 0.009],
    },
    Kind {
        name: "cantilever, second mode",
        ends: Ends::Cantilever,
        slender: 10.0,
        mode: 2,
        plane: true,
        across: [6, 10, 20],
        limits: [0.067, 0.032, 0.013],
    },
    Kind {
        name: "free at both ends",
        ends: Ends::Free,
        slender: 10.0,
        mode: 1,
        plane: true,
        across: [6, 10, 20],
        limits: [0.042, 0.016, 0.0042],
    },
    Kind {
        name: "clamped at both ends",
        ends: Ends::Clamped,
        slender: 10.0,
        mode: 1,
        plane: true,
        across: [6, 10, 20],
        limits: [0.09, 0.047, 0.021],
    },
    Kind {
        name: "cantilever in space, square section",
        ends: Ends::Cantilever,
        slender: 10.0,
        mode: 1,
        plane: false,
        across: [4, 6, 10],
        limits: [0.115, 0.055, 0.021],
    },
];

impl Kind {
    fn run(&self, across: usize) -> Result<(Swing, f64), RunError> {
        let published = Beam::published(across, self.ends);
        let beam = Beam { length: self.slender * published.height, ..published };
        let swing = (self.mode, 1e-4 * beam.material.sound_speed(), 1);
        match self.plane {
            true => Ok((elastic::<2>(&beam, beam.setup(), swing)?, beam.reference(self.mode))),
            false => Ok((elastic::<3>(&beam, beam.setup(), swing)?, beam.theory(self.mode, false))),
        }
    }
}

/// Periods against finite elements in plane strain and, in space, the theory of Timoshenko.
pub fn beams(scope: Scope) -> Result<Verdict, RunError> {
    timed(
        "beam_modes: beams other than the published one (period, s; error: relative to the reference)",
        || {
            let (mut rows, mut traces, mut columns) = (Vec::new(), Vec::new(), Vec::new());
            for (k, kind) in KINDS.iter().enumerate() {
                let (mut spacing, mut errors, mut seconds) = (Vec::new(), Vec::new(), 0.0);
                for (&across, limit) in kind.across.iter().zip(kind.limits) {
                    if !scope.takes(&format!("{} {across}", kind.name), across != kind.across[2]) {
                        continue;
                    }
                    let (found, reference) = kind.run(across)?;
                    let error = (found.period / reference - 1.0).abs();
                    rows.push(Row {
                        quantity: format!("{}: Ny = {across}", kind.name),
                        ours: found.period,
                        reference: Some(reference),
                        error,
                        limit,
                        ..Row::default()
                    });
                    spacing.push(1.0 / across as f64);
                    errors.push(error);
                    seconds += found.seconds;
                }
                if errors.len() > 1 {
                    let order = convergence_order(&spacing, &errors);
                    rows.push(Row {
                        quantity: format!("{}: order (error: what is missing to 1)", kind.name),
                        ours: order,
                        error: (1.0 - order).max(0.0),
                        limit: 0.0,
                        ..Row::default()
                    });
                }
                rows.push(stated(format!("{}: wall time, s", kind.name), seconds));
                let across: Vec<f64> = spacing.iter().map(|s| 1.0 / s).collect();
                traces.push(Trace::new(kind.name, &across, &errors, Style::Line, palette(k)));
                traces.push(Trace::new("", &across, &errors, Style::Points, palette(k)));
                columns.push(Curves::new(&format!("beam_{k}"), [("across", across), ("error", errors)]));
            }
            for (name, order) in [("first order", 1), ("second order", 2)] {
                let line = [4.0, 20.0].map(|n: f64| 0.12 * (4.0 / n).powi(order));
                traces.push(Trace::new(name, &[4.0, 20.0], &line, Style::Dashed, GREY));
            }
            let panel = Plot {
                title: "error of the period".into(),
                x: Ruler::logarithmic("particles across"),
                y: Ruler::logarithmic("relative error"),
                traces,
            };
            let caption = "Relative error of the period of small swings against finite elements in plane strain; in space against the theory of \
                       Timoshenko.";
            let figures =
                vec![plots("beam_modes", "Beams other than the published one", caption, &[panel], 1, 70.0)];
            Ok(Findings { rows, curves: columns, figures })
        },
    )
}
