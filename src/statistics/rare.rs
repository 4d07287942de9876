//! Rare events in two samples: the exact test of a two by two table.

use super::gamma::ln_gamma;

/// Two-sided p of `a` events in `n` trials against `b` in `m` where the chance is the same: R. A. Fisher
/// (1935), the sum over all tables with the same totals that are no more likely than this one. 1 where there
/// is no trial.
#[must_use]
pub fn fisher_exact(a: u64, n: u64, b: u64, m: u64) -> f64 {
    if n == 0 || m == 0 || a > n || b > m {
        return 1.0;
    }
    let events = a + b;
    let choose =
        |n: u64, k: u64| ln_gamma(n as f64 + 1.0) - ln_gamma(k as f64 + 1.0) - ln_gamma((n - k) as f64 + 1.0);
    let whole = choose(n + m, events);
    let chance = |k: u64| (choose(n, k) + choose(m, events - k) - whole).exp();
    // Rounding of ln Γ must not part tables that are equally likely.
    let limit = chance(a) * (1.0 + 1e-7);
    let sum: f64 =
        (events.saturating_sub(m)..=events.min(n)).map(chance).filter(|&chance| chance <= limit).sum();
    sum.min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_by_hand() {
        // The lady tasting tea: 3 of 4 against 1 of 4, (1 + 16 + 16 + 1)/70.
        assert!((fisher_exact(3, 4, 1, 4) - 34.0 / 70.0).abs() < 1e-12);
        assert!((fisher_exact(4, 4, 0, 4) - 2.0 / 70.0).abs() < 1e-12);
        // One event among 101 trials, in the one: 1/101.
        assert!((fisher_exact(0, 100, 1, 1) - 1.0 / 101.0).abs() < 1e-12);
        assert_eq!((fisher_exact(0, 5, 0, 7), fisher_exact(1, 0, 0, 7)), (1.0, 1.0));
    }
}
