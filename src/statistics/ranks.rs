//! Ranks and the correlation of ranks.

use super::{covariance, variance};

/// Ranks from one; equal values share the mean of theirs.
#[must_use]
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut out = vec![0.0; values.len()];
    for equal in order.chunk_by(|&a, &b| values[a] == values[b]) {
        // The place of the first one of them, from zero: ranks first + 1 … first + n.
        let first = order.partition_point(|&k| values[k] < values[equal[0]]) as f64;
        let mean = first + 0.5 * (equal.len() as f64 + 1.0);
        equal.iter().for_each(|&k| out[k] = mean);
    }
    out
}

/// Correlation of the ranks of pairs (C. Spearman, Am. J. Psychol. 15 (1904) 72): 1 where y always rises with x, -1 where
/// it always falls. NaN where one never changes, below two pairs, or where the lengths differ.
#[must_use]
pub fn spearman(x: &[f64], y: &[f64]) -> f64 {
    let (x, y) = (ranks(x), ranks(y));
    covariance(&x, &y) / (variance(&x) * variance(&y)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_share_a_rank() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0]), [3.5, 1.0, 3.5, 2.0]);
        assert!(ranks(&[]).is_empty());
    }

    #[test]
    fn only_the_order_counts() {
        let x = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert!((spearman(&x, &x.map(|v| v.exp())) - 1.0).abs() < 1e-15);
        assert!((spearman(&x, &x.map(|v| -v.powi(3))) + 1.0).abs() < 1e-15);
        // d² = 0, 1, 1, 0, 0: 1 - 6 Σd²/(n (n² - 1)) = 0.9.
        assert!((spearman(&x, &[10.0, 30.0, 20.0, 40.0, 50.0]) - 0.9).abs() < 1e-15);
        assert!(spearman(&x, &[1.0; 5]).is_nan());
    }
}
