//! Particles at rest on the nodes of a grid: their refinement, their amounts, and the norm of chapter 2.

use super::Row;
use crate::samples::ParticleFrame;
use crate::statistics::convergence_order;

/// Grids of the published tables: particles along an axis.
pub const GRIDS: [usize; 3] = [17, 33, 65];

/// Molecules in a particle of a reservoir, in all tables of chapter 2.
pub const FULL: f64 = 1000.0;

/// The values to set for `n` nodes along each of `dimensions` axes of 10 µm.
pub fn grid(n: usize, dimensions: usize) -> Vec<String> {
    let spacing = 10.0 / (n - 1) as f64;
    let corner = |x: f64| vec![format!("{x} um"); dimensions].join(", ");
    vec![
        format!("particles.spacing={spacing} um"),
        format!("domain.min=[{}]", corner(-0.5 * spacing)),
        format!("domain.max=[{}]", corner(10.0 + 0.5 * spacing)),
    ]
}

/// The values to set for our operator in place of the printed one.
pub fn ours() -> [String; 2] {
    ["particles.weights=normalised".into(), "chemistry.integrator=exponential".into()]
}

/// The values to set for `count` realizations of whole molecules.
pub fn molecules(count: u32) -> [String; 4] {
    [
        "chemistry.representation=discrete".into(),
        "chemistry.integrator=exponential".into(),
        format!("run.realizations={count}"),
        format!("output.particles.realizations={count}"),
    ]
}

/// Mean amount of a species (by index) in each particle at a time over that of a `full` particle, sorted by x and
/// then y.
pub fn mean(frames: &[ParticleFrame], species: usize, time: f64, full: f64) -> Vec<f64> {
    let here = || frames.iter().filter(|frame| (frame.time - time).abs() <= 1e-9 * time);
    let Some(first) = here().next() else { return Vec::new() };
    let mut sums = vec![0.0; first.len()];
    for frame in here() {
        sums.iter_mut().zip(&frame.amounts[species]).for_each(|(sum, n)| *sum += n);
    }
    let count = here().count() as f64;
    // Places in pm, so that rounding does not part what is in line.
    let key = |i: usize| first.position[i].map(|x| (x * 1e12).round() as i64);
    let mut order: Vec<usize> = (0..first.len()).collect();
    order.sort_by_key(|&i| key(i));
    order.into_iter().map(|i| sums[i] / (count * full)).collect()
}

/// The norm of chapter 2 as its numbers have it (Eq. 2.31 in print lacks the minus one): |ours - reference|
/// over the number of intervals. Not a number if the lengths differ.
pub fn norm(ours: &[f64], reference: &[f64], intervals: usize) -> f64 {
    if ours.len() != reference.len() {
        return f64::NAN;
    }
    ours.iter().zip(reference).map(|(n, c)| (n - c).powi(2)).sum::<f64>().sqrt() / intervals as f64
}

/// Order of convergence of errors on the grids; second within 0.2.
pub fn order(quantity: String, errors: &[f64; 3]) -> Row {
    let order = convergence_order(&GRIDS.map(|n| 1.0 / (n - 1) as f64), errors);
    Row {
        quantity,
        ours: order,
        reference: Some(2.0),
        error: (order - 2.0).abs(),
        limit: 0.2,
        ..Row::default()
    }
}

/// A number beside a printed one: the relative deviation, which may be 5e-4, or what leaves the first three
/// digits the same.
pub fn printed(quantity: String, ours: f64, published: f64) -> Row {
    let digits = |x: f64| format!("{x:.2e}");
    let error = (ours / published - 1.0).abs();
    // Numbers of the same three digits differ by less than a unit of the third.
    let unit = 10.0_f64.powf(published.log10().floor() - 2.0);
    let limit = if error > 5e-4 && digits(ours) == digits(published) { unit / published } else { 5e-4 };
    Row { quantity, ours, published: Some(published), error, limit, ..Row::default() }
}

/// How many numbers a mean is taken over, and how large they are.
#[derive(Clone, Copy)]
pub struct Sample {
    pub realizations: u32,
    /// Molecules in a full particle.
    pub full: f64,
    /// Intervals of the norm.
    pub intervals: usize,
}

/// The error of the mean of a sample beside what sampling lets expect, in standard deviations; nodes that are
/// not held only.
///
/// The error squared times the intervals squared is S = Σ (b_i + η_i)² with the bias b of the deterministic
/// scheme and the sampling error η of the mean, taken as independent from node to node and of variance
/// v_i = C_i/(R N0): so it is in a linear network, whose numbers are independent and Poisson. Mean
/// Σ (b_i² + v_i), variance Σ (2 v_i² + 4 b_i² v_i) for normal η; √S has that deviation over 2 √mean. Beyond
/// three of them once in 400 draws.
pub fn sampled(
    quantity: String,
    (ours, published): (f64, Option<f64>),
    (scheme, reference): (&[f64], &[f64]),
    sample: Sample,
) -> Row {
    let (mut mean, mut variance) = (0.0, 0.0);
    for (n, c) in scheme.iter().zip(reference) {
        let b2 = (n - c).powi(2);
        let v = n / (f64::from(sample.realizations) * sample.full);
        mean += b2 + v;
        variance += 2.0 * v * v + 4.0 * b2 * v;
    }
    let expected = mean.sqrt() / sample.intervals as f64;
    let deviation = 0.5 * (variance / mean).sqrt() / sample.intervals as f64;
    Row {
        quantity,
        ours,
        published,
        reference: Some(expected),
        error: (ours - expected).abs() / deviation,
        limit: 3.0,
    }
}

/// Nodes of a line without the two that are held.
pub fn free(line: &[f64]) -> &[f64] {
    line.get(1..line.len().saturating_sub(1)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_or_half_a_thousandth() {
        let passes = |ours, published| {
            let row = printed(String::new(), ours, published);
            row.error <= row.limit
        };
        assert!(passes(2.3386e-4, 2.337e-4) && passes(1.9949e-4, 1.9951e-4));
        assert!(!passes(3.301e-4, 3.764e-4) && !passes(1.4527e-5, 1.438e-5));
    }

    #[test]
    fn sampling_error_of_one_node() {
        // Half full, no bias, R N0 = 1e5: v = 5e-6, √S expected √v with deviation √(2 v²)/(2 √v) = √(v/2).
        let row = sampled(
            String::new(),
            (0.0, None),
            (&[0.5], &[0.5]),
            Sample { realizations: 100, full: 1000.0, intervals: 1 },
        );
        let v = 5e-6_f64;
        assert!((row.reference.unwrap_or(0.0) - v.sqrt()).abs() < 1e-15);
        assert!((row.error - 2.0_f64.sqrt()).abs() < 1e-12);
    }
}
