//! Plane channel flow from rest to the parabola (Jacob et al. 2021, section 4.1 and table 1).

use super::findings::{Curves, Findings};
use super::flow::{End, judged, watch_plane};
use super::{Row, Scope, Shipped, Verdict, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, GREY, palette};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::statistics::convergence_order;

/// Particles across.
const ACROSS: [u32; 5] = [20, 40, 80, 160, 320];
/// Errors printed for the kernels.
const PRINTED: [(&str, [f64; 5]); 3] = [
    ("lucy", [3.425e-2, 6.598e-3, 4.601e-3, 1.505e-3, 9.340e-4]),
    ("cubic_spline", [2.169e-2, 1.690e-2, 9.512e-3, 5.786e-3, 6.620e-4]),
    ("wendland", [3.153e-2, 2.864e-2, 7.022e-3, 1.408e-2, 1.206e-2]),
];
/// Largest errors that pass, of the default kernel.
const LIMITS: [f64; 5] = [6e-3, 2e-3, 1e-3, 5e-4, 3e-4];
/// Lowest order over all resolutions that passes.
const ORDER: f64 = 1.3;
/// Particles along the channel.
const ALONG: u32 = 16;

/// u/U of y/W, Eq. (50).
fn exact(y: f64) -> f64 {
    4.0 * y * (1.0 - y)
}

/// The channel at one resolution.
struct Channel {
    across: u32,
    end: End,
    /// Eq. (51): root of the mean square of u - u(y) over the fluid; U = 1.
    error: f64,
    /// y and u of the fluid, by y.
    profile: Vec<[f64; 2]>,
    /// Time and mean velocity on the way.
    growth: [Vec<f64>; 2],
}

/// Errors at 20 to 80 particles across (all, and the other kernels, in full).
pub fn channel(scope: Scope) -> Result<Verdict, RunError> {
    timed("poiseuille: plane channel, Re = 10, from rest to steady (root mean square error, U = 1)", || {
        let wanted = ACROSS.iter().filter(|&&n| scope.takes(&n.to_string(), n <= ACROSS[2]));
        let channels = wanted.map(|&n| run(n, None)).collect::<Result<Vec<Channel>, RunError>>()?;
        let mut rows = judge("", &channels, PRINTED[0].1, Some(LIMITS));
        for channel in &channels {
            rows.extend(channel.end.rows(&format!("Ny = {}", channel.across)));
        }
        if scope.full {
            for (kernel, printed) in &PRINTED[1..] {
                let others = ACROSS[..3]
                    .iter()
                    .map(|&n| run(n, Some(kernel)))
                    .collect::<Result<Vec<Channel>, RunError>>()?;
                rows.extend(judge(&format!("{kernel}: "), &others, *printed, None));
            }
        }
        Ok(draw(rows, &channels))
    })
}

fn run(across: u32, kernel: Option<&str>) -> Result<Channel, RunError> {
    let shipped = Shipped { model: include_str!("../../models/validation/poiseuille.yaml"), reactions: None };
    let spacing = 1.0 / f64::from(across);
    let mut values = vec![
        format!("particles.spacing={spacing} m"),
        format!("domain.max=[{} m, 1 m]", f64::from(ALONG) * spacing),
        "output.probes={}".into(),
    ];
    values.extend(kernel.map(|kernel| format!("particles.kernel={kernel}")));
    let (mut error, mut profile, mut growth) = (f64::NAN, Vec::new(), [Vec::new(), Vec::new()]);
    let end = watch_plane(&shipped, &values, 0.5, |look| {
        error = look.rms(|x, v| v[0] - exact(x[1]));
        profile = look.particles().map(|(x, v)| [x[1], v[0]]).collect();
        growth[0].push(look.time);
        growth[1].push(look.velocity.iter().map(|v| v[0]).sum::<f64>() / look.velocity.len() as f64);
        true
    })?;
    profile.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Ok(Channel { across, end, error, profile, growth })
}

/// Errors, their fall from one resolution to the next, and the order.
fn judge(what: &str, channels: &[Channel], printed: [f64; 5], limits: Option<[f64; 5]>) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut judged_errors = Vec::new();
    let places: Vec<usize> =
        channels.iter().filter_map(|c| ACROSS.iter().position(|&n| n == c.across)).collect();
    for (channel, &k) in channels.iter().zip(&places) {
        let limit = limits.map_or(f64::INFINITY, |limits| limits[k]);
        let name = format!("{what}Ny = {}, L2 error", channel.across);
        rows.push(judged(name, channel.error, Some(printed[k]), limit));
        judged_errors.push(channel.error);
    }
    let printed: Vec<f64> = places.iter().map(|&k| printed[k]).collect();
    let judge = |limit: f64| if limits.is_some() { limit } else { f64::INFINITY };
    if channels.len() < 2 {
        return rows;
    }
    let growth = judged_errors.windows(2).map(|w| w[1] / w[0]).fold(0.0, f64::max);
    rows.push(Row {
        quantity: format!("{what}largest ratio of an error to the one before (must fall)"),
        ours: growth,
        published: Some(printed.windows(2).map(|w| w[1] / w[0]).fold(0.0, f64::max)),
        error: growth,
        limit: judge(0.999),
        ..Row::default()
    });
    let spacing: Vec<f64> = channels.iter().map(|c| 1.0 / f64::from(c.across)).collect();
    let order = convergence_order(&spacing, &judged_errors);
    // Nothing is left to converge where the coarsest channel is nearer than the finest need be.
    let done = judged_errors[0] <= LIMITS[LIMITS.len() - 1];
    let note = if done { " (not judged: all below the limit of the finest)" } else { "" };
    rows.push(Row {
        quantity: format!("{what}order over all (error: what is missing to {ORDER}){note}"),
        ours: order,
        published: Some(convergence_order(&spacing, &printed)),
        error: (ORDER - order).max(0.0),
        limit: if done { f64::INFINITY } else { judge(0.0) },
        ..Row::default()
    });
    rows
}

/// Profiles over the parabola, errors across, errors against resolution, the way to the steady state.
fn draw(rows: Vec<Row>, channels: &[Channel]) -> Findings {
    let fine: Vec<f64> = (0..=100).map(|k| f64::from(k) / 100.0).collect();
    let parabola: Vec<f64> = fine.iter().map(|&y| exact(y)).collect();
    let mut curves = Vec::new();
    let (mut profiles, mut errors, mut ways) = (Vec::new(), Vec::new(), Vec::new());
    for (k, channel) in channels.iter().enumerate() {
        let name = format!("Ny = {}", channel.across);
        let y: Vec<f64> = channel.profile.iter().map(|p| p[0]).collect();
        let u: Vec<f64> = channel.profile.iter().map(|p| p[1]).collect();
        let wrong: Vec<f64> = channel.profile.iter().map(|p| p[1] - exact(p[0])).collect();
        if k == 0 {
            profiles.push(Trace::new(&format!("particles, {name}"), &y, &u, Style::Points, BLACK));
        }
        let (bins, mean) = averaged(&y, &wrong, channel.across as usize);
        errors.push(Trace::new(&name, &bins, &mean, Style::Line, palette(k)));
        ways.push(Trace::new(&name, &channel.growth[0], &channel.growth[1], Style::Line, palette(k)));
        curves.push(Curves::new(
            &format!("profile_{}", channel.across),
            [("y", y), ("u", u), ("error", wrong)],
        ));
    }
    profiles.push(Trace::new("exact", &fine, &parabola, Style::Line, GREY));
    let n: Vec<f64> = channels.iter().map(|c| f64::from(c.across)).collect();
    let ours: Vec<f64> = channels.iter().map(|c| c.error).collect();
    let place = |c: &Channel| ACROSS.iter().position(|&n| n == c.across);
    let published: Vec<f64> =
        channels.iter().map(|c| place(c).map_or(f64::NAN, |k| PRINTED[0].1[k])).collect();
    let second: Vec<f64> = n.iter().map(|fine| ours[0] * (n[0] / fine).powi(2)).collect();
    curves.push(Curves::new(
        "convergence",
        [("across", n.clone()), ("error", ours.clone()), ("published", published.clone())],
    ));
    let u = || Ruler::linear("u / U");
    let panels = [
        Plot {
            title: "a  velocity".into(),
            x: Ruler::linear("y / W").from(0.0, 1.0),
            y: u(),
            traces: profiles,
        },
        Plot {
            title: "b  error".into(),
            x: Ruler::linear("y / W").from(0.0, 1.0),
            y: Ruler::linear("(u − exact) / U"),
            traces: errors,
        },
        Plot {
            title: "c  convergence".into(),
            x: Ruler::logarithmic("particles across"),
            y: Ruler::logarithmic("L2 error / U"),
            traces: vec![
                Trace::new("GilleSPH", &n, &ours, Style::Line, BLACK),
                Trace::new("", &n, &ours, Style::Points, BLACK),
                // No colour of a resolution.
                Trace::new("Jacob et al. 2021", &n, &published, Style::Points, palette(ACROSS.len())),
                Trace::new("second order", &n, &second, Style::Dashed, GREY),
            ],
        },
        Plot {
            title: "d  from rest".into(),
            x: Ruler::linear("t (s)"),
            y: Ruler::linear("mean u / U"),
            traces: ways,
        },
    ];
    let figure = plots(
        "poiseuille",
        "Plane Poiseuille flow, Re = 10",
        "a: every particle of the coarsest channel over the parabola. b: error, mean of each layer of one spacing. c: root mean square error \
         against the number of particles across. d: mean velocity from rest.",
        &panels,
        2,
        46.0,
    );
    Findings { rows, curves, figures: vec![figure] }
}

/// Means of y and of a value in `count` layers of 0 to 1.
fn averaged(y: &[f64], value: &[f64], count: usize) -> (Vec<f64>, Vec<f64>) {
    let mut sums = vec![[0.0; 3]; count];
    for (y, value) in y.iter().zip(value) {
        let sum = &mut sums[((y * count as f64) as usize).min(count - 1)];
        *sum = [sum[0] + y, sum[1] + value, sum[2] + 1.0];
    }
    sums.iter().filter(|s| s[2] > 0.0).map(|s| (s[0] / s[2], s[1] / s[2])).unzip()
}
