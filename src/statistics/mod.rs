//! Statistics of samples: pure functions, slices in, numbers out.
//!
//! Nothing here knows of a realization or a species; what cannot be estimated (the variance of one value)
//! is NaN, and the tables say so as NaN.

mod accumulator;
mod adjust;
mod beta;
mod bootstrap;
mod comoments;
mod comparison;
mod correlation;
mod gamma;
mod interval;
mod normal;
mod power;
mod quantiles;
mod ranks;
mod rare;
mod spread;
mod student;
mod testing;
mod time_average;

pub use accumulator::Accumulator;
pub use adjust::{benjamini_hochberg, holm};
pub use beta::{binomial_cdf, regularised_beta};
pub use bootstrap::{fano_interval, variance_interval};
pub use comoments::CoMoments;
pub use comparison::{convergence_order, relative_l2, standard_score};
pub use correlation::{Memory, autocorrelation};
pub use gamma::{chi_square_p_value, ln_gamma, regularised_gamma_p, regularised_gamma_q};
pub use interval::{Interval, correlation_interval, mean_interval, proportion_interval, quantile_interval};
pub use normal::{normal_cdf, normal_quantile, normal_tail};
pub use power::{detectable, power};
pub use quantiles::Quantiles;
pub use ranks::{ranks, spearman};
pub use rare::fisher_exact;
pub use spread::obrien;
pub use student::{student_critical, student_p_value, student_quantile};
pub use testing::{Test, cautious, paired, pooled, welch};
pub use time_average::TimeAverage;

/// Location, spread and quantiles of a sample; the columns of `tables/statistics.parquet`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    pub count: usize,
    pub mean: f64,
    /// Unbiased: divided by n - 1.
    pub variance: f64,
    /// Square root of the unbiased variance.
    pub sd: f64,
    /// Standard error of the mean, sd/√n.
    pub sem: f64,
    pub min: f64,
    pub q05: f64,
    pub q25: f64,
    pub median: f64,
    pub q75: f64,
    pub q95: f64,
    pub max: f64,
    /// variance / mean; 1 for a Poisson distribution.
    pub fano: f64,
}

impl Summary {
    /// The summary of a sample; every number NaN if it is empty.
    #[must_use]
    pub fn of(values: &[f64]) -> Summary {
        let (mut moments, mut quantiles) = (Accumulator::default(), Quantiles::new(values.len()));
        for &value in values {
            moments.push(value);
            quantiles.push(value);
        }
        Summary::from(&moments, &quantiles)
    }

    /// The summary of a stream, from its moments and its quantiles.
    #[must_use]
    pub fn from(moments: &Accumulator, quantiles: &Quantiles) -> Summary {
        let (mean, variance) = (moments.mean(), moments.variance());
        let (sd, count) = (variance.sqrt(), moments.count());
        let q = quantiles.all(&[0.05, 0.25, 0.5, 0.75, 0.95]);
        Summary {
            count: count as usize,
            mean,
            variance,
            sd,
            sem: sd / (count as f64).sqrt(),
            min: quantiles.min(),
            q05: q[0],
            q25: q[1],
            median: q[2],
            q75: q[3],
            q95: q[4],
            max: quantiles.max(),
            fano: variance / mean,
        }
    }
}

/// Arithmetic mean; NaN of an empty sample.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let first = values.iter().sum::<f64>() / n;
    // The second pass removes the rounding of the first sum, so that a constant sample has its own mean.
    first + values.iter().map(|x| x - first).sum::<f64>() / n
}

/// Unbiased variance Σ(x - x̄)²/(n - 1), in two passes with the correction of Chan, Golub & LeVeque,
/// The American Statistician 37 (1983) 242, Eq. (1.7). NaN below two values.
#[must_use]
pub fn variance(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return f64::NAN;
    }
    let n = values.len() as f64;
    let centre = mean(values);
    let (mut squares, mut rest) = (0.0, 0.0);
    for x in values {
        squares += (x - centre) * (x - centre);
        rest += x - centre;
    }
    // Rounding may leave a trace below zero where all values agree.
    ((squares - rest * rest / n) / (n - 1.0)).max(0.0)
}

/// Unbiased covariance Σ(x - x̄)(y - ȳ)/(n - 1) of two samples taken together; NaN below two pairs or
/// where the lengths differ.
#[must_use]
pub fn covariance(x: &[f64], y: &[f64]) -> f64 {
    if x.len() < 2 || x.len() != y.len() {
        return f64::NAN;
    }
    let (mx, my) = (mean(x), mean(y));
    x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my)).sum::<f64>() / (x.len() as f64 - 1.0)
}

/// Quantile by linear interpolation between order statistics at (n - 1) p, type 7 of Hyndman & Fan, The
/// American Statistician 50 (1996) 361. NaN of an empty sample.
#[must_use]
pub fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile_sorted(&sorted, p)
}

/// [`quantile`] of a sample that is already in ascending order.
#[must_use]
pub fn quantile_sorted(sorted: &[f64], p: f64) -> f64 {
    if sorted.is_empty() {
        return f64::NAN;
    }
    let at = (sorted.len() - 1) as f64 * p.clamp(0.0, 1.0);
    let below = at.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    let part = at - below as f64;
    if part == 0.0 { sorted[below] } else { sorted[below] + part * (sorted[above] - sorted[below]) }
}

/// Fano factor variance/mean; 1 for a Poisson distribution, NaN where the mean is zero.
#[must_use]
pub fn fano(values: &[f64]) -> f64 {
    variance(values) / mean(values)
}

/// Standard error of the mean.
#[must_use]
pub fn sem(values: &[f64]) -> f64 {
    (variance(values) / values.len() as f64).sqrt()
}

/// The bins [`Histogram`] chooses for a sample: (low, high, count).
#[must_use]
pub fn histogram(values: &[f64]) -> Vec<(f64, f64, u32)> {
    let mut histogram = Histogram::new(&Summary::of(values));
    values.iter().for_each(|&value| histogram.push(value));
    histogram.bins().collect()
}

/// Counts of values in bins low <= value < high with edges at whole numbers, without gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    start: f64,
    width: f64,
    count: Vec<u32>,
}

impl Histogram {
    /// Empty bins for a sample of this summary. The width follows Freedman & Diaconis, Z. Wahrscheinlichkeitstheorie
    /// 57 (1981) 453, 2 IQR n^(-1/3), but is at least one and leaves no fewer than 2 n^(1/3) bins (Rice).
    #[must_use]
    pub fn new(s: &Summary) -> Histogram {
        if !(s.min.is_finite() && s.max.is_finite()) {
            return Histogram { start: 0.0, width: 1.0, count: Vec::new() };
        }
        let root = (s.count as f64).cbrt();
        // Two peaks put the quartiles far apart: no wider than Rice's rule of 2 n^(1/3) bins over the range.
        let width = (2.0 * (s.q75 - s.q25) / root).min((s.max - s.min) / (2.0 * root)).round().max(1.0);
        let start = (s.min / width).floor() * width;
        // A heavy tail must not ask for a million bins.
        let bins = ((s.max - start) / width).floor().min(9_999.0) as usize + 1;
        Histogram { start, width, count: vec![0; bins] }
    }

    /// Counts a value.
    pub fn push(&mut self, value: f64) {
        let last = self.count.len().saturating_sub(1);
        let bin = (((value - self.start) / self.width).floor() as usize).min(last);
        if let Some(count) = self.count.get_mut(bin) {
            *count += 1;
        }
    }

    /// Bins (low, high, count).
    pub fn bins(&self) -> impl Iterator<Item = (f64, f64, u32)> + '_ {
        let edge = |k: usize| self.start + k as f64 * self.width;
        self.count.iter().enumerate().map(move |(k, &n)| (edge(k), edge(k + 1), n))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_sample_by_hand() {
        let s = Summary::of(&[4.0, 1.0, 3.0, 2.0]);
        assert_eq!((s.mean, s.min, s.median, s.max), (2.5, 1.0, 2.5, 4.0));
        // Σ(x - 2.5)² = 5; type 7 at p = 0.25 lies at order statistic 0.75.
        assert!((s.variance - 5.0 / 3.0).abs() < 1e-15);
        assert!((s.q25 - 1.75).abs() < 1e-15 && (s.q05 - 1.15).abs() < 1e-15);
        assert!((s.fano - 2.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn variance_survives_a_large_mean() {
        // Exact: values representable, deviations -1, 0, 1.
        let values: Vec<f64> = (0..999).map(|i| 1e12 + f64::from(i % 3) - 1.0).collect();
        assert_eq!(mean(&values), 1e12);
        assert!((variance(&values) - 666.0 / 998.0).abs() < 1e-12);
        assert_eq!(variance(&[0.1; 7]), 0.0);
    }

    #[test]
    fn too_little_gives_nan() {
        assert!(mean(&[]).is_nan() && quantile(&[], 0.5).is_nan());
        assert!(variance(&[1.0]).is_nan() && covariance(&[1.0, 2.0], &[1.0]).is_nan());
        assert_eq!(quantile(&[3.0], 0.95), 3.0);
    }

    #[test]
    fn covariance_of_a_line_is_slope_times_variance() {
        let x = [1.0, 2.0, 4.0, 8.0];
        let y = x.map(|v| 3.0 - 2.0 * v);
        assert!((covariance(&x, &y) + 2.0 * variance(&x)).abs() < 1e-12);
    }
}
