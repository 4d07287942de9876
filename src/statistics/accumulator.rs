//! Mean and variance in one pass.

use serde::{Deserialize, Serialize};

/// Running count, mean and sum of squared deviations: Welford, Technometrics 4 (1962) 419.
///
/// Merging follows Chan, Golub & LeVeque (1983), Eq. (2.1). Merged in the same order the result has the
/// same bits, whichever thread filled the parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accumulator {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Accumulator {
    /// Adds one value.
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
    }

    /// Appends what another accumulator has seen.
    pub fn merge(&mut self, later: &Accumulator) {
        if later.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *later;
            return;
        }
        let (n, m) = (self.count as f64, later.count as f64);
        let apart = later.mean - self.mean;
        self.count += later.count;
        self.mean += apart * m / (n + m);
        self.squares += later.squares + apart * apart * n * m / (n + m);
    }

    /// Values seen.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Mean; NaN before the first value.
    #[must_use]
    pub fn mean(&self) -> f64 {
        if self.count == 0 { f64::NAN } else { self.mean }
    }

    /// Unbiased variance; NaN below two values.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.squares / (self.count - 1) as f64 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> Accumulator {
        let mut a = Accumulator::default();
        values.iter().for_each(|&v| a.push(v));
        a
    }

    #[test]
    fn agrees_with_two_passes() {
        let values: Vec<f64> = (0..1000).map(|i| 1e9 + (f64::from(i) * 0.7).sin()).collect();
        let a = of(&values);
        // Each of 1000 updates of a mean near 1e9 rounds by up to 6e-8: a walk of about 2e-6.
        assert!((a.mean() - super::super::mean(&values)).abs() < 1e-5);
        assert!((a.variance() - super::super::variance(&values)).abs() < 1e-5);
        assert_eq!(a.count(), 1000);
    }

    #[test]
    fn merging_parts_equals_the_whole() {
        let values: Vec<f64> = (0..64).map(f64::from).collect();
        let (mut left, right) = (of(&values[..20]), of(&values[20..]));
        left.merge(&right);
        // 64 additions of numbers below 64²: rounding far below 1e-10.
        assert!(
            (left.mean() - 31.5).abs() < 1e-12 && (left.variance() - of(&values).variance()).abs() < 1e-10
        );
        let mut empty = Accumulator::default();
        assert!(empty.mean().is_nan());
        empty.merge(&left);
        left.merge(&Accumulator::default());
        assert_eq!(empty, left);
    }
}
