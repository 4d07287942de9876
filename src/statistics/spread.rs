//! Variances as means, so that what compares means compares variances.

use super::{mean, variance};

/// One number a value whose mean over the sample is the unbiased variance: R. G. O'Brien, Psychological
/// Bulletin 89 (1981) 570, with w = 1/2,
///
/// r = ((n - 1.5) n (x - x̄)² - 0.5 s² (n - 1)) / ((n - 1)(n - 2)).
///
/// Their own spread tells how well the variance is known, whatever the distribution; a t test between the r
/// of two samples (independent or paired) tests for a difference of variances and shows its size. Empty below
/// three values.
#[must_use]
pub fn obrien(values: &[f64]) -> Vec<f64> {
    if values.len() < 3 {
        return Vec::new();
    }
    let n = values.len() as f64;
    let (centre, s2) = (mean(values), variance(values));
    let (scale, shift) = ((n - 1.5) * n, 0.5 * s2 * (n - 1.0));
    values.iter().map(|x| (scale * (x - centre) * (x - centre) - shift) / ((n - 1.0) * (n - 2.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn their_mean_is_the_variance() {
        let values = [1.0, 4.0, -2.0, 7.0, 0.5];
        assert!((mean(&obrien(&values)) - variance(&values)).abs() < 1e-12);
        assert!(obrien(&[1.0, 2.0]).is_empty());
    }
}
