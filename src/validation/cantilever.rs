//! A clamped plate that swings (Jacob et al. 2021, section 4.5 and table 2).

use super::beams::{Beam, Ends, Swing, elastic, swing};
use super::findings::{Curves, Findings};
use super::flow::stated;
use super::{Row, Scope, Shipped, Verdict, planned, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, GREY, palette};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::plan::Arena;
use crate::solid::{Form, Jaumann, Setup};
use crate::statistics::convergence_order;

/// Period in plane strain, s: the finite elements of [`Beam::reference`] converge to it from below (0.25490, 0.25510,
/// 0.25518, 0.25521, 0.25522 with 4 to 64 of them across).
const REFERENCE: f64 = 0.2552;
/// Particles across, and the periods printed for V0 = 1e-3, s.
const PRINTED: [(usize, f64); 3] = [(10, 0.2747), (20, 0.2605), (30, 0.2539)];
/// Largest relative errors that pass.
const LIMITS: [f64; 3] = [0.03, 0.012, 0.007];
/// Largest change of energy over ten periods, and of the period, that pass.
const KEPT: [f64; 2] = [0.01, 1e-3];
/// Velocity of the tip over the sound speed, as small as makes no difference.
const SMALL: f64 = 1e-4;

/// The plate as the model that is shipped has it.
fn setup(across: usize, support: f64) -> Result<Setup<2>, RunError> {
    let shipped = Shipped { model: include_str!("../../models/cantilever.yaml"), reactions: None };
    let values =
        [format!("particles.spacing={} mm", 20.0 / across as f64), format!("solids.plate.support={support}")];
    planned(&shipped, &values, |plan, _| match &plan.arena {
        Arena::Plane(particles) => Ok(particles.solids[0].setup.clone()),
        _ => Err(super::failed("the cantilever lies in a plane".into())),
    })
}

/// Periods at 10 and 20 particles across (30, ten large swings, a wider kernel and the form of Jaumann in full).
pub fn plate(scope: Scope) -> Result<Verdict, RunError> {
    timed(
        "cantilever: free vibration of a clamped plate (period, s; error: relative to the reference)",
        || {
            let elements = Beam::published(10, Ends::Cantilever).reference(1);
            let mut case = Case {
                rows: vec![Row {
                    quantity: "finite elements, 160 x 16 with nine nodes".into(),
                    ours: elements,
                    reference: Some(REFERENCE),
                    error: (elements / REFERENCE - 1.0).abs(),
                    limit: 2e-4,
                    ..Row::default()
                }],
                ..Case::default()
            };
            case.small(scope)?;
            if scope.takes("ten periods", false) {
                case.large(20)?;
            }
            for (across, printed) in PRINTED {
                if scope.takes(&format!("support 3 {across}"), false) {
                    let found = case.swung(across, 3.0, SMALL, 1)?;
                    case.compare(
                        format!("h = 3 spacings, Ny = {across}"),
                        found.period,
                        Some(printed),
                        f64::INFINITY,
                    );
                }
            }
            for (across, printed) in &PRINTED[..2] {
                if scope.takes(&format!("jaumann {across}"), false) {
                    case.jaumann(*across, *printed)?;
                }
            }
            Ok(case.draw())
        },
    )
}

#[derive(Default)]
struct Case {
    rows: Vec<Row>,
    curves: Vec<Curves>,
    small: Vec<(usize, Swing)>,
    large: Option<Swing>,
    jaumann: Vec<(String, Swing)>,
}

impl Case {
    fn compare(&mut self, quantity: String, ours: f64, published: Option<f64>, limit: f64) -> f64 {
        let error = (ours / REFERENCE - 1.0).abs();
        let told = if limit.is_finite() {
            String::new()
        } else {
            format!(" ({:+.2} %)", 100.0 * (ours / REFERENCE - 1.0))
        };
        self.rows.push(Row {
            quantity: quantity + &told,
            ours,
            published,
            reference: Some(REFERENCE),
            error,
            limit,
        });
        error
    }

    fn swung(&self, across: usize, support: f64, part: f64, periods: usize) -> Result<Swing, RunError> {
        let beam = Beam { support, ..Beam::published(across, Ends::Cantilever) };
        elastic(&beam, setup(across, support)?, (1, part * beam.material.sound_speed(), periods))
    }

    /// Periods of small swings, their errors and order.
    fn small(&mut self, scope: Scope) -> Result<(), RunError> {
        let (mut spacing, mut errors) = (Vec::new(), Vec::new());
        for ((across, printed), limit) in PRINTED.into_iter().zip(LIMITS) {
            if !scope.takes(&across.to_string(), across < 30) {
                continue;
            }
            let found = self.swung(across, 1.6, SMALL, 1)?;
            errors.push(self.compare(format!("Ny = {across}, V0 -> 0"), found.period, Some(printed), limit));
            spacing.push(1.0 / across as f64);
            self.rows.push(stated(format!("Ny = {across}: wall time of one period, s"), found.seconds));
            let rate = 1e-6 * found.particle_steps / found.seconds;
            self.rows.push(stated(format!("Ny = {across}: million particle-steps per second"), rate));
            self.small.push((across, found));
        }
        if errors.len() > 1 {
            let growth = errors.windows(2).map(|w| w[1] / w[0]).fold(0.0, f64::max);
            self.rows.push(Row {
                quantity: "largest ratio of an error to the one before (must fall)".into(),
                ours: growth,
                error: growth,
                limit: 0.999,
                ..Row::default()
            });
            let order = convergence_order(&spacing, &errors);
            self.rows.push(Row {
                quantity: "order over all (error: what is missing to 1)".into(),
                ours: order,
                error: (1.0 - order).max(0.0),
                limit: 0.0,
                ..Row::default()
            });
        }
        Ok(())
    }

    /// Ten periods of V0 = 1e-2.
    fn large(&mut self, across: usize) -> Result<(), RunError> {
        let found = self.swung(across, 1.6, 1e-2, 10)?;
        let what = format!("Ny = {across}, V0 = 0.01");
        self.compare(format!("{what}: period"), found.period, None, f64::INFINITY);
        for (name, ours, limit) in [
            ("energy after ten periods over that before", found.energy, KEPT[0]),
            ("tenth period over the first", found.last / found.period, KEPT[1]),
        ] {
            let quantity = format!("{what}: {name}");
            let error = (ours - 1.0).abs();
            self.rows.push(Row { quantity, ours, reference: Some(1.0), error, limit, ..Row::default() });
        }
        self.rows.push(stated(format!("{what}: wall time, s"), found.seconds));
        self.large = Some(found);
        Ok(())
    }

    /// The updated-Lagrangian form: as printed, and with corrected gradients and h = 1.6 spacings.
    fn jaumann(&mut self, across: usize, printed: f64) -> Result<(), RunError> {
        let forms = [
            ("as printed, h = 3 spacings", Form::printed(), 3.0, 1e-3),
            ("corrected, h = 1.6 spacings", Form::default(), 1.6, 1e-3),
            (
                "no artificial stress or viscosity, V0 -> 0",
                Form { artificial_stress: 0.0, artificial_viscosity: 0.0, ..Form::default() },
                1.6,
                SMALL,
            ),
        ];
        for (name, form, support, part) in forms {
            let beam = Beam { support, ..Beam::published(across, Ends::Cantilever) };
            let setup = setup(across, support)?;
            let places = setup.places.clone();
            let mut solid = Jaumann::new(setup, form)?;
            let (shape, speed) = (beam.shape(1), part * beam.material.sound_speed());
            solid.set_velocity(|x| crate::vector::Vector::<2>::new(0.0, speed * shape(x[0])));
            let dt = solid.step_limit();
            let found = swing(&mut solid, &places, shape, (dt, REFERENCE, 2))?;
            let what = format!("Jaumann, {name}, Ny = {across}");
            self.compare(what.clone(), found.period, Some(printed), f64::INFINITY);
            self.rows.push(stated(format!("{what}: energy left after two periods"), found.energy));
            self.rows.push(stated(format!("{what}: wall time, s"), found.seconds));
            self.jaumann.push((format!("{name}, Ny = {across}"), found));
        }
        Ok(())
    }

    /// Deflections, errors over resolution, what large swings keep, the beam bent.
    fn draw(mut self) -> Findings {
        let mut panels = Vec::new();
        let line = |name: &str, found: &Swing, of: &[f64], colour| {
            let t: Vec<f64> = found.times.iter().map(|t| t / REFERENCE).collect();
            Trace::new(name, &t, of, Style::Line, colour)
        };
        let scaled = |found: &Swing| -> Vec<f64> {
            let largest = found.deflections.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            found.deflections.iter().map(|d| d / largest).collect()
        };
        let mut deflections = Vec::new();
        for (k, (across, found)) in self.small.iter().enumerate() {
            let name = format!("Ny = {across}");
            deflections.push(line(&name, found, &scaled(found), palette(k)));
            self.curves.push(Curves::new(
                &format!("deflection_{across}"),
                [
                    ("t", found.times.clone()),
                    ("deflection", found.deflections.clone()),
                    ("energy", found.energies.clone()),
                ],
            ));
        }
        for (k, (name, found)) in self.jaumann.iter().enumerate() {
            self.curves.push(Curves::new(
                &format!("jaumann_{k}"),
                [
                    ("t", found.times.clone()),
                    ("deflection", found.deflections.clone()),
                    ("energy", found.energies.clone()),
                ],
            ));
            deflections.push(line(&format!("Jaumann, {name}"), found, &scaled(found), palette(k + 3)));
        }
        let time = || Ruler::linear("t / T of the reference");
        panels.push(Plot {
            title: "a  deflection".into(),
            x: time(),
            y: Ruler::linear("deflection / largest"),
            traces: deflections,
        });
        if self.small.len() > 1 {
            panels.push(self.convergence());
        }
        if let Some(found) = &self.large {
            panels.push(Plot {
                title: "c  energy, V0 = 0.01".into(),
                x: time(),
                y: Ruler::linear("energy / first"),
                traces: vec![line("", found, &found.energies, BLACK)],
            });
            let column = |k: usize| found.bent.iter().map(|x| 1e3 * x[k]).collect::<Vec<f64>>();
            panels.push(Plot {
                title: "d  bent most, V0 = 0.01".into(),
                x: Ruler::linear("x (mm)"),
                y: Ruler::linear("y (mm)"),
                traces: vec![Trace::new("", &column(0), &column(1), Style::Points, BLACK)],
            });
            self.curves.push(Curves::new(
                "ten_periods",
                [
                    ("t", found.times.clone()),
                    ("deflection", found.deflections.clone()),
                    ("energy", found.energies.clone()),
                ],
            ));
        }
        let caption = "a: deflection along the first mode over its largest. b: relative error of the period against finite elements in plane \
                       strain; Jacob et al. print periods that pass the reference. c, d: ten periods of V0 = 0.01 with 20 particles across.";
        let figures = vec![plots("cantilever", "A clamped plate swings", caption, &panels, 2, 50.0)];
        Findings { rows: self.rows, curves: self.curves, figures }
    }

    fn convergence(&self) -> Plot {
        let n: Vec<f64> = self.small.iter().map(|(across, _)| *across as f64).collect();
        let error = |period: f64| (period / REFERENCE - 1.0).abs();
        let ours: Vec<f64> = self.small.iter().map(|(_, found)| error(found.period)).collect();
        let (printed_n, printed): (Vec<f64>, Vec<f64>) =
            PRINTED.iter().map(|&(across, period)| (across as f64, error(period))).unzip();
        let first: Vec<f64> = n.iter().map(|fine| ours[0] * n[0] / fine).collect();
        Plot {
            title: "b  error of the period".into(),
            x: Ruler::logarithmic("particles across"),
            y: Ruler::logarithmic("relative error"),
            traces: vec![
                Trace::new("GilleSPH", &n, &ours, Style::Line, BLACK),
                Trace::new("", &n, &ours, Style::Points, BLACK),
                Trace::new("Jacob et al. 2021", &printed_n, &printed, Style::Points, palette(7)),
                Trace::new("first order", &n, &first, Style::Dashed, GREY),
            ],
        }
    }
}
