//! Many tests at once: p values adjusted for their number.

/// Adjusted p values of S. Holm, Scand. J. Statist. 6 (1979) 65: rejecting those at or below α makes any
/// false rejection at most α likely, however the tests depend on each other. NaN stays and is not counted.
#[must_use]
pub fn holm(p: &[f64]) -> Vec<f64> {
    let order = ascending(p);
    let mut out = vec![f64::NAN; p.len()];
    let mut largest = 0.0f64;
    for (k, &i) in order.iter().enumerate() {
        largest = largest.max(p[i] * (order.len() - k) as f64).min(1.0);
        out[i] = largest;
    }
    out
}

/// Adjusted p values of Y. Benjamini & Y. Hochberg, J. R. Statist. Soc. B 57 (1995) 289: of those at or below
/// α a share of at most α is false, on average, for tests that are independent or depend positively. NaN
/// stays and is not counted.
#[must_use]
pub fn benjamini_hochberg(p: &[f64]) -> Vec<f64> {
    let order = ascending(p);
    let mut out = vec![f64::NAN; p.len()];
    let mut smallest = 1.0f64;
    for (k, &i) in order.iter().enumerate().rev() {
        smallest = smallest.min(p[i] * order.len() as f64 / (k + 1) as f64);
        out[i] = smallest;
    }
    out
}

/// Indices of the numbers in ascending order, equal ones as they stand.
fn ascending(p: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..p.len()).filter(|&i| !p[i].is_nan()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_tests_by_hand() {
        let p = [0.01, f64::NAN, 0.04, 0.03, 0.005];
        let near = |found: &[f64], exact: [f64; 5]| {
            found.iter().zip(exact).all(|(f, e)| (f - e).abs() < 1e-15 || (f.is_nan() && e.is_nan()))
        };
        // Sorted 0.005, 0.01, 0.03, 0.04: times 4, 3, 2, 1, never falling.
        assert!(near(&holm(&p), [0.03, f64::NAN, 0.06, 0.06, 0.02]));
        // Times 4/1, 4/2, 4/3, 4/4, never above the next.
        assert!(near(&benjamini_hochberg(&p), [0.02, f64::NAN, 0.04, 0.04, 0.02]));
        assert_eq!(holm(&[0.6, 0.9]), [1.0, 1.0]);
        assert!(holm(&[]).is_empty());
    }
}
