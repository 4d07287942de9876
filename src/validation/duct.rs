//! Flow along a square duct in three dimensions.

use super::findings::{Curves, Findings};
use super::flow::{judged, watch_space};
use super::{Scope, Shipped, Verdict, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, palette};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use std::f64::consts::PI;

/// Largest relative L2 error at twenty particles across.
const LIMIT: f64 = 0.01;
/// Body force over viscosity of the model, 1/(m s).
const DRIVE: f64 = 13.5738;
/// Odd terms along each axis.
const TERMS: usize = 40;

/// u(y, z) = Σ 16 g/ν / (π⁴ m n (m² + n²)) sin(mπy) sin(nπz) over odd m, n; side one.
fn exact(y: f64, z: f64) -> f64 {
    let sines = |x: f64| -> Vec<f64> { (0..TERMS).map(|k| ((2 * k + 1) as f64 * PI * x).sin()).collect() };
    let (a, b) = (sines(y), sines(z));
    let mut sum = 0.0;
    for (k, a) in a.iter().enumerate() {
        for (l, b) in b.iter().enumerate() {
            let (m, n) = ((2 * k + 1) as f64, (2 * l + 1) as f64);
            sum += a * b / (m * n * (m * m + n * n));
        }
    }
    16.0 * DRIVE / PI.powi(4) * sum
}

/// 20 particles across (12 and 30 as well in full).
pub fn square_duct(scope: Scope) -> Result<Verdict, RunError> {
    timed("duct_3d: square duct in space, Re = 10, from rest to steady (relative L2 error)", || {
        let sides: Vec<u32> =
            [12, 20, 30].into_iter().filter(|n| scope.takes(&n.to_string(), *n == 20)).collect();
        let (mut rows, mut curves, mut profiles, mut middle) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (k, &side) in sides.iter().enumerate() {
            let shipped =
                Shipped { model: include_str!("../../models/validation/duct_3d.yaml"), reactions: None };
            let spacing = 1.0 / f64::from(side);
            let values = [
                format!("particles.spacing={spacing} m"),
                format!("domain.max=[{} m, 1 m, 1 m]", 9.0 * spacing),
            ];
            let (mut error, mut near, mut mean) = (f64::NAN, Vec::new(), [Vec::new(), Vec::new()]);
            let end = watch_space(&shipped, &values, 0.25, |look| {
                mean[0].push(look.time);
                mean[1].push(look.velocity.iter().map(|v| v[0]).sum::<f64>() / look.velocity.len() as f64);
                if look.time > 4.9 {
                    let size = look.rms(|x, _| exact(x[1], x[2]));
                    error = look.rms(|x, v| (v[0] - exact(x[1], x[2])).hypot(v[1].hypot(v[2]))) / size;
                    let layer = |x: f64| (x - 0.5).abs() < 0.6 * spacing;
                    near = look
                        .particles()
                        .filter(|(x, _)| layer(x[2]))
                        .map(|(x, v)| [x[1], v[0], exact(x[1], x[2])])
                        .collect();
                }
                true
            })?;
            let limit = if side >= 20 { LIMIT } else { f64::INFINITY };
            rows.push(judged(format!("{side} x {side} across: relative L2 error"), error, None, limit));
            rows.extend(end.rows(&format!("{side} x {side}")));
            let column = |c: usize| near.iter().map(|p| p[c]).collect::<Vec<f64>>();
            let name = format!("{side} x {side}");
            profiles.push(Trace::new(&name, &column(0), &column(1), Style::Points, palette(k)));
            middle.push(Trace::new(&name, &mean[0], &mean[1], Style::Line, palette(k)));
            curves.push(Curves::new(
                &format!("profile_{side}"),
                [("y", column(0)), ("u", column(1)), ("exact", column(2))],
            ));
        }
        let fine: Vec<f64> = (0..=100).map(|k| f64::from(k) / 100.0).collect();
        let half: Vec<f64> = fine.iter().map(|&y| exact(y, 0.5)).collect();
        profiles.insert(0, Trace::new("exact", &fine, &half, Style::Line, BLACK));
        let panels = [
            Plot {
                title: "a  middle of the duct".into(),
                x: Ruler::linear("y / W").from(0.0, 1.0),
                y: Ruler::linear("u / U"),
                traces: profiles,
            },
            Plot {
                title: "b  from rest".into(),
                x: Ruler::linear("t (s)"),
                y: Ruler::linear("mean u / U"),
                traces: middle,
            },
        ];
        let caption = "a: particles within 0.6 spacings of z = W/2 over the exact solution. b: mean velocity from rest.";
        let figures = vec![plots("duct_3d", "Flow along a square duct", caption, &panels, 2, 50.0)];
        Ok(Findings { rows, curves, figures })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_duct_runs_fastest_in_the_middle() {
        // White (1991): 0.0736713 of g W²/ν; 1 by the choice of the drive. The series is cut at some 1e-6.
        assert!((exact(0.5, 0.5) - 1.0).abs() < 2e-5);
        assert!(exact(0.0, 0.3).abs() < 1e-12);
    }
}
