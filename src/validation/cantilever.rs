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

/// Period in plane strain, s, of converged finite elements; those of [`Beam::reference`] come to it from below (0.2548954,
/// 0.2551035, 0.2551802, 0.2552106, 0.2552230 with 4 to 64 of them across).
const REFERENCE: f64 = 0.2552;
/// Particles across, and the periods printed for V0 = 1e-3, s.
const PRINTED: [(usize, f64); 3] = [(10, 0.2747), (20, 0.2605), (30, 0.2539)];
/// Largest relative errors that pass.
const LIMITS: [f64; 3] = [0.03, 0.012, 0.007];
/// Largest change of energy over ten periods, and of the period, that pass.
const KEPT: [f64; 2] = [0.01, 1e-3];
/// Kinds of the updated-Lagrangian form.
const FORMS: usize = 3;
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
                    limit: 3e-4,
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
        for (name, form, support, part) in forms.into_iter().take(FORMS) {
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
        let (mut deflections, mut updated) = (Vec::new(), Vec::new());
        for (k, (across, found)) in self.small.iter().enumerate() {
            deflections.push(line(&format!("Ny = {across}"), found, &scaled(found), palette(k + 2)));
            self.curves.push(columns(&format!("deflection_{across}"), found));
        }
        for (k, (name, found)) in self.jaumann.iter().enumerate() {
            self.curves.push(columns(&format!("jaumann_{k}"), found));
            // Finer ones move alike.
            if k < FORMS {
                updated.push(line(&format!("Jaumann, {name}"), found, &scaled(found), palette(k + 4)));
            }
        }
        let time = || Ruler::linear("t / T of the reference");
        let mut panel = |title: &str, x: Ruler, y: Ruler, traces: Vec<Trace>| {
            if !traces.is_empty() {
                let letter = ["a", "b", "c", "d", "e"][panels.len().min(4)];
                panels.push(Plot { title: format!("{letter}  {title}"), x, y, traces });
            }
        };
        let deflection = || Ruler::linear("deflection / largest");
        panel("small swings", time(), deflection(), deflections);
        if self.small.len() > 1 {
            let n = || Ruler::logarithmic("particles across");
            panel("error of the period", n(), Ruler::logarithmic("relative error"), self.convergence());
        }
        if let Some(found) = &self.large {
            // What is allowed is one per cent.
            let energy = Ruler::linear("energy / first").from(0.99, 1.01);
            panel("energy, V0 = 0.01", time(), energy, vec![line("", found, &found.energies, BLACK)]);
            let (x, y) = (Ruler::linear("x (mm)"), Ruler::linear("y (mm)"));
            panel("bent most, V0 = 0.01", x, y, rows(&found.bent));
            self.curves.push(columns("ten_periods", found));
        }
        panel("updated-Lagrangian form", time(), deflection(), updated);
        let caption = "Deflection along the first mode over its largest; relative error of the period against finite elements in plane \
                       strain (the periods of Jacob et al. pass it and go on); ten periods of V0 = 0.01 with 20 particles across: energy \
                       within the per cent that is allowed, and rows of particles; the form of Jaumann with 10 across.";
        let figures = vec![plots("cantilever", "A clamped plate swings", caption, &panels, 2, 50.0)];
        Findings { rows: self.rows, curves: self.curves, figures }
    }

    fn convergence(&self) -> Vec<Trace> {
        let n: Vec<f64> = self.small.iter().map(|(across, _)| *across as f64).collect();
        let error = |period: f64| (period / REFERENCE - 1.0).abs();
        let ours: Vec<f64> = self.small.iter().map(|(_, found)| error(found.period)).collect();
        let (printed_n, printed): (Vec<f64>, Vec<f64>) =
            PRINTED.iter().map(|&(across, period)| (across as f64, error(period))).unzip();
        let first: Vec<f64> = n.iter().map(|fine| ours[0] * n[0] / fine).collect();
        vec![
            Trace::new("GilleSPH", &n, &ours, Style::Line, BLACK),
            Trace::new("", &n, &ours, Style::Points, BLACK),
            Trace::new("Jacob et al. 2021", &printed_n, &printed, Style::Points, palette(1)),
            Trace::new("first order", &n, &first, Style::Dashed, GREY),
        ]
    }
}

fn columns(name: &str, found: &Swing) -> Curves {
    let of = [("t", &found.times), ("deflection", &found.deflections), ("energy", &found.energies)];
    Curves::new(name, of.map(|(name, values)| (name, values.clone())))
}

/// Lines through every third row of particles, mm.
fn rows(bent: &[[f64; 4]]) -> Vec<Trace> {
    let mut levels: Vec<f64> = bent.iter().map(|p| p[3]).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let last = levels.len().saturating_sub(1);
    let chosen = levels.iter().enumerate().filter(|(k, _)| k % 3 == 0 || *k == last);
    chosen
        .map(|(_, level)| {
            let mut row: Vec<&[f64; 4]> = bent.iter().filter(|p| (p[3] - level).abs() < 1e-9).collect();
            row.sort_by(|a, b| a[2].total_cmp(&b[2]));
            let along = |k: usize| row.iter().map(|p| 1e3 * p[k]).collect::<Vec<f64>>();
            Trace::new("", &along(0), &along(1), Style::Line, BLACK)
        })
        .collect()
}
