//! What is measured of solids and of points that are followed, against time; across realizations at the end.

use crate::figures::colours::{BLACK, PALETTE};
use crate::figures::panel::{Axis, Panel, grid, range};
use crate::figures::probes::{BAND, quantities, unit};
use crate::figures::time::{Curves, draw_curves};
use crate::figures::{Figure, Samples, WIDTH, slug};
use crate::quantity::readable::significant;
use crate::statistics::{Summary, mean, quantile};

/// What comes first, in this order; other quantities follow as they stand in the tables.
const FIRST: [&str; 9] = [
    "length",
    "width",
    "tip_curvature",
    "hull_ratio",
    "direction",
    "volume_inside",
    "pressure_inside",
    "mass",
    "largest_stretch",
];
/// What says whether to trust the others: told in numbers, not drawn.
pub const HEALTH: [&str; 4] = ["escapes", "mass_balance", "residual", "time_ratio"];
/// Relative change that is rounding.
const ROUNDING: f64 = 1e-9;
/// Realizations below which a histogram is noise.
const ENOUGH: usize = 20;

/// One quantity over all times and realizations.
pub struct Course {
    pub quantity: String,
    pub unit: String,
    pub times: Vec<f64>,
    /// Realization by realization; not a number where there is none.
    pub values: Vec<Vec<f64>>,
}

impl Course {
    /// Values at the last time at which there are any.
    #[must_use]
    pub fn end(&self) -> Vec<f64> {
        let known =
            |t: usize| -> Vec<f64> { self.values.iter().map(|v| v[t]).filter(|v| v.is_finite()).collect() };
        (0..self.times.len()).rev().map(known).find(|v| !v.is_empty()).unwrap_or_default()
    }
}

/// Every quantity of a probe that shows one number a time, the ones people ask for first.
#[must_use]
pub fn courses(samples: &Samples, probe: &str) -> Vec<Course> {
    let mut names = quantities(samples, probe);
    names.sort_by_key(|q| FIRST.iter().position(|first| first == q).unwrap_or(FIRST.len()));
    names
        .into_iter()
        .map(|quantity| {
            let rows = super::rows(samples, probe, &quantity);
            let mut times: Vec<f64> = rows.iter().map(|r| r.time).collect();
            times.sort_by(f64::total_cmp);
            times.dedup();
            let mut numbers: Vec<u32> = rows.iter().map(|r| r.realization).collect();
            numbers.sort_unstable();
            numbers.dedup();
            let mut values = vec![vec![f64::NAN; times.len()]; numbers.len()];
            for row in rows {
                let at = times.binary_search_by(|t| t.total_cmp(&row.time));
                if let (Ok(n), Ok(t), Some(value)) =
                    (numbers.binary_search(&row.realization), at, row.value.first())
                {
                    values[n][t] = *value;
                }
            }
            Course { unit: unit(samples, probe, &quantity), quantity, times, values }
        })
        .collect()
}

/// A quantity at its end across realizations: mean, 5 and 95 %; least and greatest of all times.
#[must_use]
pub fn ends(course: &Course) -> [f64; 5] {
    let end = course.end();
    if course.quantity == "direction" {
        let (middle, _) = round(&end);
        return [middle, f64::NAN, f64::NAN, f64::NAN, f64::NAN];
    }
    let every = || course.values.iter().flatten().copied().filter(|v| v.is_finite());
    let (low, high) = (every().fold(f64::INFINITY, f64::min), every().fold(f64::NEG_INFINITY, f64::max));
    // What is rounding of the largest is nothing.
    let least = ROUNDING * low.abs().max(high.abs());
    [mean(&end), quantile(&end, 0.05), quantile(&end, 0.95), low, high]
        .map(|v| if v.abs() < least { 0.0 } else { v })
}

/// Mean of angles (rad), atan2 of their mean sine and cosine, and how far they agree: the length of the mean of the unit
/// vectors, one if all are the same, about 1/√n if they are anything.
#[must_use]
pub fn round(angles: &[f64]) -> (f64, f64) {
    let n = angles.len().max(1) as f64;
    let (sine, cosine) = angles.iter().fold((0.0, 0.0), |(s, c), a| (s + a.sin() / n, c + a.cos() / n));
    (sine.atan2(cosine), sine.hypot(cosine))
}

/// Measures of a solid against time.
pub fn course(samples: &Samples, name: &str) -> Option<Figure> {
    let courses = courses(samples, name);
    // A mean and a band of angles are not those of numbers; their distribution has a figure.
    let told = |c: &&Course| c.quantity != "direction" || c.values.len() == 1;
    let shown = courses.iter().filter(|c| !HEALTH.contains(&c.quantity.as_str()) && varies(c)).filter(told);
    let title = format!("Course of {name}");
    figure(
        shown.map(|c| (super::words(&c.quantity), c)).collect(),
        samples.record.finished,
        (&format!("solid_{}_course", slug(name)), title),
    )
}

/// Displacements of the points that were followed; what is a hundredth of the largest or less is left out.
pub fn points(samples: &Samples) -> Option<Figure> {
    let names = samples.record.probes.iter().filter(|p| p.kind == "point").map(|p| p.name.as_str());
    let all: Vec<(String, Course)> = names
        .flat_map(|name| courses(samples, name).into_iter().map(move |c| (name.to_string(), c)))
        .filter(|(_, c)| matches!(c.quantity.as_str(), "dx" | "dy" | "dz"))
        .collect();
    let size = |c: &Course| {
        c.values.iter().flatten().fold(0.0_f64, |m, v| if v.is_finite() { m.max(v.abs()) } else { m })
    };
    let largest = all.iter().map(|(_, c)| size(c)).fold(0.0, f64::max);
    let shown = all.iter().filter(|(_, c)| size(c) > 0.01 * largest);
    figure(
        shown.map(|(name, c)| (format!("{name}, {}", c.quantity), c)).collect(),
        samples.record.finished,
        ("solid_points", "Points that were followed".into()),
    )
}

/// Whether a course is more than rounding.
fn varies(course: &Course) -> bool {
    let (low, high) = range(course.values.iter().flatten().copied());
    high - low > ROUNDING * low.abs().max(high.abs())
}

fn figure(shown: Vec<(String, &Course)>, finished: u32, (name, title): (&str, String)) -> Option<Figure> {
    let shown: Vec<_> = shown.into_iter().filter(|(_, c)| c.times.len() > 1).collect();
    let columns = match shown.len() {
        0 => return None,
        1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let width = if columns == 1 { 110.0 } else { WIDTH };
    let (mut d, frames) = grid(shown.len(), columns, width, [58.0, 44.0, 34.0][columns - 1]);
    for ((words, course), frame) in shown.iter().zip(frames) {
        let curves = Curves {
            title: words.clone(),
            values: course.values.clone(),
            unit: course.unit.clone(),
            label: super::words(&course.quantity),
        };
        draw_curves(&mut d, &course.times, &curves, frame, None);
    }
    let n = shown.iter().map(|(_, c)| c.values.len()).max()?;
    let caption = match n {
        1 if finished > 1 => "Of the one motion that serves every realization.".into(),
        1 => "One realization.".into(),
        n if n < BAND => format!("Thick: mean of {n} realizations; thin: single realizations."),
        n => {
            format!("Thick: mean of {n} realizations; shaded: 5 to 95 % of them; thin: single realizations.")
        }
    };
    Some(Figure { name: name.into(), title, caption, drawing: d, raster: false })
}

/// About as many bins of equal width as the square root of the number of values: low, high, count.
fn bins(values: &[f64]) -> Vec<(f64, f64, u32)> {
    let (low, high) = range(values.iter().copied());
    let count = (values.len() as f64).sqrt().round().clamp(5.0, 30.0);
    let width = (high - low) / count;
    let last = count as usize - 1;
    let mut counts = vec![0; last + 1];
    for value in values {
        counts[(((value - low) / width) as usize).min(last)] += 1;
    }
    let edge = |k: usize| low + k as f64 * width;
    counts.into_iter().enumerate().map(|(k, n)| (edge(k), edge(k + 1), n)).collect()
}

/// Length and direction at the end across realizations.
pub fn distributions(samples: &Samples, name: &str) -> Option<Figure> {
    let all: Vec<(Course, Vec<f64>)> = courses(samples, name)
        .into_iter()
        .filter(|c| matches!(c.quantity.as_str(), "length" | "width" | "direction" | "tip_curvature"))
        .map(|c| {
            let end = c.end();
            (c, end)
        })
        .filter(|(_, end)| end.len() >= ENOUGH && Summary::of(end).variance > 0.0)
        .collect();
    let columns = match all.len() {
        0 => return None,
        4 => 2,
        n => n.min(3),
    };
    let (mut d, frames) = grid(all.len(), columns, WIDTH.min(85.0 * columns as f64), 38.0);
    for ((course, end), [left, top, width, height]) in all.iter().zip(frames) {
        let bins = bins(end);
        let edges = bins.iter().flat_map(|b| [b.0, b.1]);
        let x = Axis::covering(edges, &course.unit, &super::words(&course.quantity));
        let most = bins.iter().map(|b| b.2).max().unwrap_or(1);
        let y = Axis::covering([0.0, 1.05 * f64::from(most)].into_iter(), "", "realizations");
        let p = Panel { left, top, width, height, x, y };
        for (low, high, count) in bins {
            let ([x0, y0], [x1, y1]) = (p.at(low, f64::from(count)), p.at(high, 0.0));
            d.rectangle([x0, y0], [x1 - x0, y1 - y0], PALETTE[0].faint(0.6));
        }
        let middle = if course.quantity == "direction" { round(end).0 } else { mean(end) };
        d.line(&[p.at(middle, p.y.low), p.at(middle, p.y.high)], 0.3, BLACK);
        p.axes(&mut d, &super::words(&course.quantity));
    }
    let caption = format!(
        "Across {} realizations at the end; line: mean, of angles that of their unit vectors. Sample sd of the length over its mean: {}.",
        all.iter().map(|(_, end)| end.len()).max()?,
        all.iter().find(|(c, _)| c.quantity == "length").map_or_else(
            || "–".into(),
            |(_, end)| significant(Summary::of(end).variance.sqrt() / mean(end).abs(), 3)
        )
    );
    Some(Figure {
        name: format!("solid_{}_distributions", slug(name)),
        title: format!("Distributions of {name}"),
        caption,
        drawing: d,
        raster: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_on_both_sides_of_half_a_turn_meet_there() {
        let (middle, agree) = round(&[3.0, -3.0]);
        // By hand: the mean unit vector is (cos 3, 0).
        assert!((middle.abs() - std::f64::consts::PI).abs() < 1e-12 && (agree + 3.0_f64.cos()).abs() < 1e-12);
        assert!(round(&[0.0, 0.5 * std::f64::consts::TAU]).1 < 1e-12);
    }
}
