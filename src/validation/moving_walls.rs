//! Walls that move along a fluid at rest: a lid that starts, a plate that oscillates.

use super::findings::{Curves, Findings};
use super::flow::{End, judged, watch_plane};
use super::{Scope, Shipped, Verdict, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, palette};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use std::f64::consts::PI;

/// m²/s; of both models, as are H = 1 m and U = 1 m/s.
const VISCOSITY: f64 = 0.1;
/// Angular frequency of the plate, 1/s.
const OMEGA: f64 = 5.0;
const ACROSS: u32 = 40;
const ALONG: u32 = 16;
/// Terms of the series: the last one kept is exp(-4 π²·40000 ν t) at the start and 1e-7 later.
const TERMS: u32 = 200;
/// Largest root mean square error, U = 1; stated, not published. One per cent is what a plot shows.
const LIMIT: f64 = 0.01;

/// Decay rate of mode n, 1/s.
fn rate(n: f64) -> f64 {
    (n * PI).powi(2) * VISCOSITY
}

/// Start of plane Couette flow below a lid.
fn started(y: f64, t: f64) -> f64 {
    let term = |n: u32| {
        let k = f64::from(n);
        let sign = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * 2.0 / (k * PI) * (-rate(k) * t).exp() * (k * PI * y).sin()
    };
    y + (1..=TERMS).map(term).sum::<f64>()
}

/// Above a plate of velocity sin ωt from t = 0 on, a wall at rest at y = 1:
/// u = (1 - y) sin ωt - Σ 2/(nπ) sin(nπy) ω (λ cos ωt + ω sin ωt - λ e^(-λt))/(λ² + ω²), λ the decay rate of mode n.
fn oscillating(y: f64, t: f64) -> f64 {
    let (sin, cos) = (OMEGA * t).sin_cos();
    let term = |n: u32| {
        let (k, rate) = (f64::from(n), rate(f64::from(n)));
        let driven = OMEGA * (rate * cos + OMEGA * sin - rate * (-rate * t).exp());
        2.0 / (k * PI) * (k * PI * y).sin() * driven / (rate * rate + OMEGA * OMEGA)
    };
    (1.0 - y) * sin - (1..=TERMS).map(term).sum::<f64>()
}

/// One of the two flows.
struct Wall {
    name: &'static str,
    title: &'static str,
    model: &'static str,
    exact: fn(f64, f64) -> f64,
    every: f64,
    /// Errors are judged from this time on.
    from: f64,
    /// Looks that are drawn.
    shown: &'static [usize],
}

/// A lid that starts.
pub fn couette_start(_scope: Scope) -> Result<Verdict, RunError> {
    against(&Wall {
        name: "couette_start",
        title: "Start of plane Couette flow",
        model: include_str!("../../models/validation/couette_start.yaml"),
        exact: started,
        every: 0.1,
        // ν t/H² = 0.02: the layer is 6 particles thick.
        from: 0.2,
        shown: &[2, 5, 10, 20, 50],
    })
}

/// A plate that oscillates: judged over the third period.
pub fn stokes_second(_scope: Scope) -> Result<Verdict, RunError> {
    let period = 2.0 * PI / OMEGA;
    against(&Wall {
        name: "stokes_second",
        title: "Oscillating plate",
        model: include_str!("../../models/validation/stokes_second.yaml"),
        exact: oscillating,
        every: period / 16.0,
        from: 2.0 * period,
        shown: &[36, 40, 44, 48],
    })
}

fn against(wall: &Wall) -> Result<Verdict, RunError> {
    timed(&format!("{}: {} across (root mean square error, U = 1)", wall.name, ACROSS), || {
        let shipped = Shipped { model: wall.model, reactions: None };
        let spacing = 1.0 / f64::from(ACROSS);
        let values = [
            format!("particles.spacing={spacing} m"),
            format!("domain.max=[{} m, 1 m]", f64::from(ALONG) * spacing),
        ];
        let (mut times, mut errors, mut profiles) = (Vec::new(), Vec::new(), Vec::new());
        let end = watch_plane(&shipped, &values, wall.every, |look| {
            let t = look.time;
            if wall.shown.contains(&times.len()) {
                let mut profile: Vec<[f64; 2]> = look.particles().map(|(x, v)| [x[1], v[0]]).collect();
                profile.sort_by(|a, b| a[0].total_cmp(&b[0]));
                profiles.push((t, profile));
            }
            times.push(t);
            errors.push(look.rms(|x, v| (v[0] - (wall.exact)(x[1], t)).hypot(v[1])));
            true
        })?;
        let judged_from = times.iter().position(|&t| t >= wall.from - 1e-9).unwrap_or(0);
        let worst = errors[judged_from..].iter().copied().fold(0.0, f64::max);
        let last = errors.last().copied().unwrap_or(f64::NAN);
        let mut rows = vec![
            judged(format!("worst error from t = {:.2} s on", wall.from), worst, None, LIMIT),
            judged("error at the end".into(), last, None, LIMIT),
        ];
        rows.extend(End::rows(&end, &format!("Ny = {ACROSS}")));
        Ok(draw(wall, rows, &times, &errors, &profiles))
    })
}

fn draw(
    wall: &Wall,
    rows: Vec<super::Row>,
    times: &[f64],
    errors: &[f64],
    profiles: &[(f64, Vec<[f64; 2]>)],
) -> Findings {
    let fine: Vec<f64> = (0..=200).map(|k| f64::from(k) / 200.0).collect();
    let mut traces = Vec::new();
    let mut curves = vec![Curves::new("error", [("t", times.to_vec()), ("rms_error", errors.to_vec())])];
    for (k, (t, profile)) in profiles.iter().enumerate() {
        let (y, u): (Vec<f64>, Vec<f64>) = profile.iter().map(|p| (p[0], p[1])).unzip();
        // One row of particles is enough to see.
        let some = |v: &[f64]| v.iter().step_by(ALONG as usize).copied().collect::<Vec<f64>>();
        traces.push(Trace::new(&format!("t = {t:.2} s"), &some(&y), &some(&u), Style::Points, palette(k)));
        let exact: Vec<f64> = fine.iter().map(|&y| (wall.exact)(y, *t)).collect();
        traces.push(Trace::new("exact", &fine, &exact, Style::Line, BLACK));
        curves.push(Curves::new(&format!("profile_{k}"), [("y", y), ("u", u)]));
    }
    // Lines below points.
    traces.sort_by_key(|trace| trace.style == Style::Points);
    let percent: Vec<f64> = errors.iter().map(|e| 100.0 * e).collect();
    let panels = [
        Plot {
            title: "a  velocity".into(),
            x: Ruler::linear("y / H").from(0.0, 1.0),
            y: Ruler::linear("u / U"),
            traces,
        },
        Plot {
            title: "b  error".into(),
            x: Ruler::linear("t (s)"),
            y: Ruler::linear("rms error / U (%)"),
            traces: vec![Trace::new("", times, &percent, Style::Line, palette(0))],
        },
    ];
    let caption =
        "a: one particle of each layer over the exact solution. b: root mean square error over time.";
    Findings { rows, curves, figures: vec![plots(wall.name, wall.title, caption, &panels, 2, 50.0)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_meet_their_walls_and_the_thin_layer() {
        for t in [0.3, 2.0] {
            assert!(started(0.0, t).abs() < 1e-12 && (started(1.0, t) - 1.0).abs() < 1e-12);
            assert!((oscillating(0.0, t) - (OMEGA * t).sin()).abs() < 1e-12);
        }
        // A layer that does not feel the floor: 1 - erf(d/sqrt(4νt)); at d = sqrt(4νt)/2 that is erfc(0.5).
        let t = 0.05;
        let d = 0.5 * (4.0 * VISCOSITY * t).sqrt();
        assert!((started(1.0 - d, t) - 0.479_500_122).abs() < 1e-6);
        // After many periods exp(-y/δ) sin(ωt - y/δ), the wall at five δ being felt by e^-5 twice.
        let (y, t) = (0.3, 40.0);
        let k = y / (2.0 * VISCOSITY / OMEGA).sqrt();
        assert!((oscillating(y, t) - (-k).exp() * (OMEGA * t - k).sin()).abs() < 1e-3);
    }
}
