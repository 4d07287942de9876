//! What a t test can see: its power, and the difference it finds with a given power.

use super::normal::{normal_cdf, normal_quantile, normal_tail};
use super::student::student_critical;

/// From here on t is normal to four digits of its power.
const MANY: f64 = 1e5;

/// The chance that a two-sided t test at this level finds a true difference of so many standard errors: the
/// tails of the noncentral t distribution, 1 - F(t_c; ν, δ) + F(-t_c; ν, δ), in either direction.
#[must_use]
pub fn power(errors: f64, freedom: f64, level: f64) -> f64 {
    tails(errors, student_critical(level, freedom), freedom)
}

/// The true difference, in standard errors, that a two-sided t test at this level finds with this power.
#[must_use]
pub fn detectable(freedom: f64, level: f64, wanted: f64) -> f64 {
    let critical = student_critical(level, freedom);
    if !critical.is_finite() || !(level..1.0).contains(&wanted) {
        return f64::NAN;
    }
    // Power grows with the difference: close in by secants between a bound below and one above.
    let (mut low, mut high) = (0.0, critical + normal_quantile(wanted).max(0.0));
    while tails(high, critical, freedom) < wanted {
        low = high;
        high = 1.5 * high + 1.0;
    }
    // In the normal scale power is nearly a line, of slope one where degrees of freedom are many.
    let (target, mut slope) = (normal_quantile(wanted), 1.0);
    let mut x = (critical + target).clamp(low, high);
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..100 {
        let now = tails(x, critical, freedom);
        if now < wanted {
            low = x;
        } else {
            high = x;
        }
        let now = normal_quantile(now);
        if let Some((x0, y0)) = before
            && x != x0
            && now != y0
        {
            slope = (now - y0) / (x - x0);
        }
        before = Some((x, now));
        let next = x + (target - now) / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - x).abs() < 1e-10 * (1.0 + x) {
            return next;
        }
        x = next;
    }
    x
}

/// The chance that (Z + δ)/s lies beyond ± the critical value, Z standard normal and ν s² a χ² of ν degrees
/// of freedom: the mean over s, with u = ln s spaced evenly. The density of u, exp(ν (u - e^2u / 2)), is
/// smooth and falls off fast on both sides, where such a sum converges faster than any power of the spacing.
fn tails(errors: f64, critical: f64, freedom: f64) -> f64 {
    let beyond = |s: f64| normal_tail(critical * s - errors) + normal_cdf(-critical * s - errors);
    if freedom.is_nan() || freedom <= 0.0 || errors.is_nan() || critical.is_nan() {
        return f64::NAN;
    }
    if freedom > MANY {
        return beyond(1.0);
    }
    let weight = |u: f64| (freedom * (u + 0.5 - 0.5 * (2.0 * u).exp())).exp();
    let width = 1.0 / (2.0 * freedom).sqrt();
    let spacing = (0.25 * width).min(0.25);
    let (mut sum, mut norm) = (0.0, 0.0);
    for direction in [-1.0, 1.0] {
        let first = if direction < 0.0 { 1 } else { 0 };
        for k in first..100_000 {
            let u = direction * spacing * f64::from(k);
            let w = weight(u);
            sum += w * beyond(u.exp());
            norm += w;
            if w < 1e-17 {
                break;
            }
        }
    }
    sum / norm
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::student_p_value;

    #[test]
    fn without_a_difference_the_power_is_the_level() {
        for freedom in [1.0, 3.5, 20.0, 999.0, 1e5, 1e7] {
            for level in [0.05, 1e-4] {
                let found = power(0.0, freedom, level);
                let limit = if freedom > MANY { 1e-5 } else { 1e-9 };
                assert!((found / level - 1.0).abs() < limit, "{freedom} {level}: {found}");
            }
            // The central distribution at any argument, not only at its own quantiles.
            let exact = student_p_value(1.7, freedom);
            let limit = if freedom > MANY { 1e-5 } else { 1e-9 };
            assert!((tails(0.0, 1.7, freedom) / exact - 1.0).abs() < limit, "{freedom}");
        }
    }

    #[test]
    fn detectable_is_the_inverse_of_power() {
        for freedom in [2.0, 10.0, 300.0, 1e6] {
            for (level, wanted) in [(0.05, 0.8), (1e-5, 0.8), (0.05, 0.5), (0.01, 0.99)] {
                let errors = detectable(freedom, level, wanted);
                assert!((power(errors, freedom, level) - wanted).abs() < 1e-7, "{freedom} {level} {wanted}");
            }
        }
        // Many degrees of freedom: z(0.975) + z(0.8) = 2.8016 (the far tail adds 1e-6).
        assert!((detectable(1e6, 0.05, 0.8) - 2.801_585).abs() < 1e-5);
        assert!(detectable(f64::NAN, 0.05, 0.8).is_nan() && detectable(5.0, 0.05, 1.0).is_nan());
    }

    #[test]
    fn a_tabulated_power() {
        // J. Cohen, Statistical Power Analysis (1988): two groups of 64, difference half a standard
        // deviation, two-sided 5 %: 0.80. δ = 0.5 √(64/2), 126 degrees of freedom; computed 0.801460 by the
        // noncentral t.
        let found = power(0.5 * 32f64.sqrt(), 126.0, 0.05);
        assert!((found - 0.801_460).abs() < 2e-6, "{found}");
    }
}
