//! Means and covariances of several columns in one pass.

use serde::{Deserialize, Serialize};

/// Running count, means and sums of products of deviations of several columns: Welford (1962) for each pair,
/// as in Bennett, Grout, Pébay, Roe & Thompson, IEEE Cluster (2009).
///
/// Merged in the same order the result has the same bits, whichever thread filled the parts. Memory: half a
/// square of columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoMoments {
    count: u64,
    mean: Vec<f64>,
    /// Upper triangle, row by row: Σ (x_a - x̄_a)(x_b - x̄_b) for a <= b.
    products: Vec<f64>,
}

impl CoMoments {
    /// Nothing seen yet of this many columns.
    #[must_use]
    pub fn new(columns: usize) -> CoMoments {
        CoMoments { count: 0, mean: vec![0.0; columns], products: vec![0.0; columns * (columns + 1) / 2] }
    }

    /// Adds one value of each column; `row` has one entry a column, others are left out.
    pub fn push(&mut self, row: &[f64]) {
        self.count += 1;
        let n = self.count as f64;
        // (x - new mean) is (x - old mean)(n - 1)/n: the product of deviations is symmetric in a and b.
        let share = (n - 1.0) / n;
        let mut k = 0;
        for a in 0..self.mean.len() {
            let from = row[a] - self.mean[a];
            for (&x, &mean) in row[a..].iter().zip(&self.mean[a..]) {
                self.products[k] += from * (x - mean) * share;
                k += 1;
            }
        }
        for (mean, x) in self.mean.iter_mut().zip(row) {
            *mean += (x - *mean) / n;
        }
    }

    /// Appends what another one has seen of the same columns.
    pub fn merge(&mut self, later: &CoMoments) {
        if later.count == 0 {
            return;
        }
        if self.count == 0 {
            self.clone_from(later);
            return;
        }
        let (n, m) = (self.count as f64, later.count as f64);
        let apart: Vec<f64> = later.mean.iter().zip(&self.mean).map(|(b, a)| b - a).collect();
        let mut k = 0;
        for a in 0..apart.len() {
            for &other in &apart[a..] {
                self.products[k] += later.products[k] + apart[a] * other * (n * m / (n + m));
                k += 1;
            }
        }
        self.count += later.count;
        for (mean, apart) in self.mean.iter_mut().zip(&apart) {
            *mean += apart * m / (n + m);
        }
    }

    /// Rows seen.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Mean of a column; NaN before the first row.
    #[must_use]
    pub fn mean(&self, column: usize) -> f64 {
        if self.count == 0 { f64::NAN } else { self.mean[column] }
    }

    /// Unbiased covariance of two columns, of one with itself its variance; NaN below two rows.
    #[must_use]
    pub fn covariance(&self, a: usize, b: usize) -> f64 {
        if self.count < 2 {
            return f64::NAN;
        }
        let (row, column) = (a.min(b), a.max(b));
        let start = row * (2 * self.mean.len() - row + 1) / 2;
        self.products[start + column - row] / (self.count - 1) as f64
    }

    /// Pearson's coefficient of correlation; NaN where a column is constant.
    #[must_use]
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        self.covariance(a, b) / (self.covariance(a, a) * self.covariance(b, b)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(i: u32) -> [f64; 3] {
        let x = f64::from(i);
        [1e6 + (0.7 * x).sin(), 3.0 - 2.0 * (0.7 * x).sin(), (1.3 * x).cos()]
    }

    fn of(range: std::ops::Range<u32>) -> CoMoments {
        let mut all = CoMoments::new(3);
        range.for_each(|i| all.push(&row(i)));
        all
    }

    #[test]
    fn agrees_with_two_passes_and_with_merged_parts() {
        let whole = of(0..500);
        let mut joined = CoMoments::new(3);
        for part in [0..0, 0..1, 1..180, 180..500] {
            joined.merge(&of(part));
        }
        let columns: Vec<Vec<f64>> = (0..3).map(|c| (0..500).map(|i| row(i)[c]).collect()).collect();
        for a in 0..3 {
            for b in 0..3 {
                let exact = super::super::covariance(&columns[a], &columns[b]);
                // Sums of 500 numbers whose parts near 1e6 round by 1e-10: far below 1e-9 in the mean.
                assert!((whole.covariance(a, b) - exact).abs() < 1e-9, "{a} {b}");
                assert!((joined.covariance(a, b) - exact).abs() < 1e-9, "{a} {b}");
            }
            assert!((joined.mean(a) - super::super::mean(&columns[a])).abs() < 1e-8);
        }
        assert!((whole.correlation(0, 1) + 1.0).abs() < 1e-9);
        assert_eq!(joined.count(), 500);
    }

    #[test]
    fn a_state_survives_writing_and_reading() {
        let state = of(0..17);
        let text = serde_json::to_string(&state).unwrap();
        assert_eq!(serde_json::from_str::<CoMoments>(&text).unwrap(), state);
        assert!(CoMoments::new(2).covariance(0, 1).is_nan());
    }
}
