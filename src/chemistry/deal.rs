//! Dealing out the molecules of an initial state.

/// Whole numbers that add up to `total`, in proportion to `weights`: each is its quota rounded down or up, and
/// any run of neighbouring entries together holds its quota to within one. All zero if no weight is positive.
///
/// The running sum of the quotas is rounded, so that what rounding leaves over is spread evenly along the entries.
/// (By largest remainder it would all go to the first ones of a lattice of equal voxels.)
#[must_use]
pub fn apportion(total: u64, weights: &[f64]) -> Vec<u64> {
    let sum: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return vec![0; weights.len()];
    }
    let last = weights.iter().rposition(|w| *w > 0.0);
    let (mut running, mut dealt) = (0.0, 0);
    weights
        .iter()
        .enumerate()
        .map(|(i, w)| {
            running += w.max(0.0);
            // The last one takes up what rounding of the sums left.
            let rounded = (total as f64 * (running / sum) + 0.5).floor() as u64;
            let until = if Some(i) == last { total } else { rounded.clamp(dealt, total) };
            let share = if *w > 0.0 { until - dealt } else { 0 };
            dealt += share;
            share
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_and_are_spread_evenly() {
        assert_eq!(apportion(10, &[1.0, 1.0, 1.0]), [3, 4, 3]);
        assert_eq!(apportion(7, &[0.0, 2.0, 5.0]), [0, 2, 5]);
        assert_eq!(apportion(1, &[0.2, 0.5, 0.3]), [0, 1, 0]);
        assert_eq!(apportion(5, &[0.0, 0.0]), [0, 0]);
        assert_eq!(apportion(3, &[0.0, 1.0, 0.0]), [0, 3, 0]);
        let weights: Vec<f64> = (1..1000).map(|k| 1.0 / f64::from(k)).collect();
        assert_eq!(apportion(123_456_789, &weights).iter().sum::<u64>(), 123_456_789);
        // 60 molecules on 400 equal voxels: every quarter holds 15.
        let even = apportion(60, &[1.0; 400]);
        assert!(even.chunks(100).all(|part| part.iter().sum::<u64>() == 15), "{even:?}");
    }

    #[test]
    fn each_share_is_its_quota_rounded_down_or_up() {
        let weights: Vec<f64> = (0..500).map(|k| 1.0 + f64::from(k * 37 % 101)).collect();
        let sum: f64 = weights.iter().sum();
        for total in [1, 17, 5_000, 1_000_003] {
            for (share, weight) in apportion(total, &weights).into_iter().zip(&weights) {
                let quota = total as f64 * weight / sum;
                assert!((share as f64 - quota).abs() < 1.0 + 1e-9, "{share} for {quota}");
            }
        }
    }
}
