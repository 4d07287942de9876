//! Dealing out the molecules of an initial state.

use crate::chemistry::sampling_numbers::poisson;
use rand::Rng;

/// Whole numbers that add up to `total`, in proportion to `weights`, by largest remainder; ties go to the
/// lower index. All zero if no weight is positive.
#[must_use]
pub fn apportion(total: u64, weights: &[f64]) -> Vec<u64> {
    let sum: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return vec![0; weights.len()];
    }
    let quotas: Vec<f64> = weights.iter().map(|w| total as f64 * (w.max(0.0) / sum)).collect();
    let mut shares: Vec<u64> = quotas.iter().map(|q| q.floor() as u64).collect();
    let remainder = |i: usize| quotas[i] - quotas[i].floor();
    let mut order: Vec<usize> = (0..weights.len()).filter(|&i| weights[i] > 0.0).collect();
    order.sort_by(|&i, &j| remainder(j).total_cmp(&remainder(i)).then(i.cmp(&j)));
    let dealt: u64 = shares.iter().sum();
    // Rounding can bring the floors one above the total where a single quota is the whole.
    let (missing, spare) = (total.saturating_sub(dealt), dealt.saturating_sub(total));
    for &i in order.iter().cycle().take(missing as usize) {
        shares[i] += 1;
    }
    for _ in 0..spare {
        if let Some(largest) = (0..shares.len()).max_by_key(|&i| shares[i]) {
            shares[largest] -= 1;
        }
    }
    shares
}

/// Independent Poisson numbers with the given means.
pub fn deal_poisson<R: Rng>(random: &mut R, means: &[f64]) -> Vec<u64> {
    means.iter().map(|&mean| poisson(random, mean)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_remainders() {
        assert_eq!(apportion(10, &[1.0, 1.0, 1.0]), [4, 3, 3]);
        assert_eq!(apportion(7, &[0.0, 2.0, 5.0]), [0, 2, 5]);
        assert_eq!(apportion(1, &[0.2, 0.5, 0.3]), [0, 1, 0]);
        assert_eq!(apportion(5, &[0.0, 0.0]), [0, 0]);
        let weights: Vec<f64> = (1..1000).map(|k| 1.0 / f64::from(k)).collect();
        assert_eq!(apportion(123_456_789, &weights).iter().sum::<u64>(), 123_456_789);
    }
}
