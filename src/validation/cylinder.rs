//! Spin-up of the fluid inside a cylinder that starts to turn.

use super::bessel::{j, zeros_of_j1};
use super::findings::{Curves, Findings};
use super::flow::{judged, watch_plane};
use super::{Scope, Shipped, Verdict, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, palette};
use crate::figures::maps::{Cloud, Window, particles};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::vector::Vector;

/// As in the model: radius (m), angular velocity (1/s), kinematic viscosity (m²/s), centre (m).
const RADIUS: f64 = 0.5;
const OMEGA: f64 = 2.0;
const VISCOSITY: f64 = 0.02;
const CENTRE: [f64; 2] = [0.6, 0.6];
/// Largest root mean square error over ΩR; stated, not published.
const LIMIT: f64 = 0.01;
/// Errors are judged from this time on: the layer is then six particles thick.
const FROM: f64 = 0.4;
const EVERY: f64 = 0.1;
const SHOWN: [usize; 4] = [4, 8, 16, 40];

/// v(r, t) = Ω r + 2 Ω R Σ J₁(β r/R)/(β J₀(β)) exp(-ν β² t/R²), β the zeros of J₁.
struct SpinUp {
    /// Zeros, and J₀ at them.
    modes: Vec<[f64; 2]>,
}

impl SpinUp {
    fn new() -> SpinUp {
        SpinUp { modes: zeros_of_j1(60).into_iter().map(|beta| [beta, j(0, beta)]).collect() }
    }

    fn speed(&self, r: f64, t: f64) -> f64 {
        let part = r / RADIUS;
        let mode = |&[beta, j0]: &[f64; 2]| {
            let decay = (-VISCOSITY * (beta / RADIUS).powi(2) * t).exp();
            // Modes that are gone need no Bessel function.
            if decay < 1e-14 { 0.0 } else { j(1, beta * part) / (beta * j0) * decay }
        };
        OMEGA * r + 2.0 * OMEGA * RADIUS * self.modes.iter().map(mode).sum::<f64>()
    }
}

/// 25 particles along the radius.
pub fn spin_up(_scope: Scope) -> Result<Verdict, RunError> {
    timed(
        "spinning_cylinder: spin-up, 25 particles along the radius (root mean square error, ΩR = 1)",
        || {
            let shipped = Shipped {
                model: include_str!("../../models/validation/spinning_cylinder.yaml"),
                reactions: None,
            };
            let exact = SpinUp::new();
            let around = |x: &Vector<2>| x - Vector::from(CENTRE);
            let (mut times, mut errors, mut profiles) = (Vec::new(), Vec::new(), Vec::new());
            let mut clouds = Vec::new();
            let end = watch_plane(&shipped, &[], EVERY, |look| {
                let t = look.time;
                // Turning to the left: velocity perpendicular to the radius.
                let wrong = |x: &Vector<2>, v: &Vector<2>| {
                    let r = around(x);
                    let wanted = Vector::from([-r[1], r[0]]) * (exact.speed(r.norm(), t) / r.norm());
                    (v - wanted).norm()
                };
                if SHOWN.contains(&times.len()) {
                    let tangential = |(x, v): (&Vector<2>, &Vector<2>)| {
                        let r = around(x);
                        [r.norm(), (r[0] * v[1] - r[1] * v[0]) / r.norm()]
                    };
                    let mut profile: Vec<[f64; 2]> = look.particles().map(tangential).collect();
                    profile.sort_by(|a, b| a[0].total_cmp(&b[0]));
                    profiles.push((t, profile));
                }
                if [8, 40].contains(&times.len()) {
                    clouds.push(Cloud {
                        window: Window {
                            title: format!("t = {t:.1} s"),
                            ends: [-1.05, 1.05, -1.05, 1.05],
                            labels: ["x / R".into(), "y / R".into()],
                        },
                        position: look.position.iter().map(|x| (around(x) / RADIUS).into()).collect(),
                        value: look.velocity.iter().map(|v| v.norm()).collect(),
                        size: look.plan.cutoff / 3.0 / RADIUS,
                    });
                }
                times.push(t);
                errors.push(if t > 0.0 { look.rms(wrong) } else { 0.0 });
                true
            })?;
            let from = times.iter().position(|&t| t >= FROM - 1e-9).unwrap_or(0);
            let worst = errors[from..].iter().copied().fold(0.0, f64::max);
            let mut rows = vec![
                judged(format!("worst error from t = {FROM} s on"), worst, None, LIMIT),
                judged("error at the end".into(), errors.last().copied().unwrap_or(f64::NAN), None, LIMIT),
            ];
            rows.extend(end.rows("R = 25 spacings"));
            let mut traces = Vec::new();
            let mut curves =
                vec![Curves::new("error", [("t", times.clone()), ("rms_error", errors.clone())])];
            let fine: Vec<f64> = (1..=100).map(|k| f64::from(k) / 100.0).collect();
            for (k, (t, profile)) in profiles.iter().enumerate() {
                let (r, v): (Vec<f64>, Vec<f64>) = profile.iter().map(|p| (p[0] / RADIUS, p[1])).unzip();
                let some = |v: &[f64]| v.iter().step_by(20).copied().collect::<Vec<f64>>();
                let speed: Vec<f64> = fine.iter().map(|&r| exact.speed(r * RADIUS, *t)).collect();
                traces.push(Trace::new("exact", &fine, &speed, Style::Line, BLACK));
                traces.push(Trace::new(
                    &format!("t = {t:.1} s"),
                    &some(&r),
                    &some(&v),
                    Style::Points,
                    palette(k),
                ));
                curves.push(Curves::new(&format!("profile_{k}"), [("r_over_R", r), ("v_over_omega_R", v)]));
            }
            traces.sort_by_key(|trace| trace.style == Style::Points);
            let percent: Vec<f64> = errors.iter().map(|e| 100.0 * e).collect();
            let panels = [
                Plot {
                    title: "a  tangential velocity".into(),
                    x: Ruler::linear("r / R").from(0.0, 1.0),
                    y: Ruler::linear("v / ΩR"),
                    traces,
                },
                Plot {
                    title: "b  error".into(),
                    x: Ruler::linear("t (s)"),
                    y: Ruler::linear("rms error / ΩR (%)"),
                    traces: vec![Trace::new("", &times, &percent, Style::Line, palette(0))],
                },
            ];
            let figures = vec![
                plots(
                    "spinning_cylinder",
                    "Spin-up inside a cylinder",
                    "a: every twentieth particle over the exact solution. b: root mean square error over time.",
                    &panels,
                    2,
                    50.0,
                ),
                particles(
                    "spinning_cylinder_particles",
                    "Particles inside the spinning cylinder",
                    "Coloured by speed.",
                    &clouds,
                    "speed / ΩR",
                ),
            ];
            Ok(Findings { rows, curves, figures })
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_starts_at_rest_and_ends_as_a_solid() {
        let exact = SpinUp::new();
        // At νt/R² = 0.002 the middle has felt nothing; the sum must cancel Ωr.
        assert!(exact.speed(0.1, 0.025).abs() < 1e-9);
        assert!((exact.speed(RADIUS, 1.0) - OMEGA * RADIUS).abs() < 1e-9);
        assert!((exact.speed(0.3, 100.0) - OMEGA * 0.3).abs() < 1e-12);
    }
}
