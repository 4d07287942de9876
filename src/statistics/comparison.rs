//! Comparing numbers with a reference.

/// Relative L² norm √(Σ(a - b)² / Σb²) of `values` against `reference`; NaN where the lengths differ.
#[must_use]
pub fn relative_l2(values: &[f64], reference: &[f64]) -> f64 {
    if values.len() != reference.len() {
        return f64::NAN;
    }
    let difference: f64 = values.iter().zip(reference).map(|(a, b)| (a - b) * (a - b)).sum();
    let size: f64 = reference.iter().map(|b| b * b).sum();
    (difference / size).sqrt()
}

/// Order p of an error that falls as h^p: the slope of ln(error) over ln(h) by least squares. NaN below two
/// points or where one is not positive.
#[must_use]
pub fn convergence_order(spacing: &[f64], error: &[f64]) -> f64 {
    let x: Vec<f64> = spacing.iter().map(|h| h.ln()).collect();
    let y: Vec<f64> = error.iter().map(|e| e.ln()).collect();
    super::covariance(&x, &y) / super::variance(&x)
}

/// How many standard errors the mean of a sample lies from the expected mean.
#[must_use]
pub fn standard_score(values: &[f64], expected: f64) -> f64 {
    (super::mean(values) - expected) / super::sem(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_order_is_recognised() {
        let h = [0.1, 0.05, 0.025];
        let error = h.map(|h| 3.0 * h * h);
        // An exact power law: rounding only.
        assert!((convergence_order(&h, &error) - 2.0).abs() < 1e-12);
        assert!(convergence_order(&h, &[1.0]).is_nan());
    }

    #[test]
    fn norms_and_scores_by_hand() {
        assert!((relative_l2(&[3.0, 5.0], &[3.0, 4.0]) - 0.2).abs() < 1e-15);
        // Mean 2, variance 2, n = 2: standard error 1.
        assert!((standard_score(&[1.0, 3.0], 1.0) - 1.0).abs() < 1e-15);
    }
}
