//! Student's t distribution; the number of degrees of freedom need not be whole, and infinity gives the
//! normal.

use super::beta::beta_below;
use super::normal::{normal_tail, normal_upper};

/// The chance of a |t| at least this large: I_x(ν/2, 1/2) at x = ν/(ν + t²), Abramowitz & Stegun 26.7.1.
#[must_use]
pub fn student_p_value(t: f64, freedom: f64) -> f64 {
    if t.is_nan() || freedom.is_nan() || freedom <= 0.0 {
        return f64::NAN;
    }
    if freedom.is_infinite() {
        return 2.0 * normal_tail(t.abs());
    }
    let square = t * t;
    if square.is_infinite() {
        return 0.0;
    }
    let whole = freedom + square;
    beta_below(0.5 * freedom, 0.5, freedom / whole, square / whole)
}

/// The t below which the variable lies with chance p.
#[must_use]
pub fn student_quantile(p: f64, freedom: f64) -> f64 {
    if p > 0.5 { student_critical(2.0 * (1.0 - p), freedom) } else { -student_critical(2.0 * p, freedom) }
}

/// The t > 0 that |t| exceeds with chance p: 1.96 for p = 0.05 and many degrees of freedom.
#[must_use]
pub fn student_critical(p: f64, freedom: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) || freedom.is_nan() || freedom <= 0.0 {
        return f64::NAN;
    }
    if p == 0.0 || p == 1.0 {
        return if p == 0.0 { f64::INFINITY } else { 0.0 };
    }
    let start = normal_upper(0.5 * p);
    if freedom.is_infinite() {
        return start;
    }
    // Newton for ln p against ln t, nearly a line in the tail, kept between bounds that are halved else.
    let (mut low, mut high) = (start.max(1e-300).ln(), f64::INFINITY);
    let mut x = low;
    for _ in 0..200 {
        let t = x.exp();
        let now = student_p_value(t, freedom);
        if now > p {
            low = low.max(x);
        } else {
            high = high.min(x);
        }
        let slope = -2.0 * density(t, freedom) * t / now;
        let newton = x - (now / p).ln() / slope;
        let next = if newton >= low && newton <= high {
            newton
        } else if high.is_finite() {
            0.5 * (low + high)
        } else {
            low + 1.0
        };
        if (next - x).abs() < 1e-15 * (1.0 + x.abs()) {
            return next.exp();
        }
        x = next;
    }
    x.exp()
}

/// Γ((ν+1)/2) / (√(πν) Γ(ν/2)) (1 + t²/ν)^(-(ν+1)/2). For the steps of Newton only: ten digits do.
fn density(t: f64, freedom: f64) -> f64 {
    let ratio = super::ln_gamma(0.5 * (freedom + 1.0)) - super::ln_gamma(0.5 * freedom);
    (ratio - 0.5 * (freedom + 1.0) * (t * t / freedom).ln_1p()).exp()
        / (std::f64::consts::PI * freedom).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_for_one_two_and_four_degrees() {
        for t in [1e-6f64, 0.3, 1.0, 4.0, 1e3] {
            let one = 2.0 / std::f64::consts::PI * (1.0 / t).atan();
            assert!((student_p_value(t, 1.0) / one - 1.0).abs() < 1e-12);
            // 1 - t/√(2 + t²), written without cancellation.
            let root = (2.0 + t * t).sqrt();
            let two = 2.0 / (root * (root + t));
            assert!((student_p_value(t, 2.0) / two - 1.0).abs() < 1e-12);
            assert!((student_p_value(-t, 2.0) / two - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn quantiles_to_ten_digits() {
        // Bisection of the incomplete beta function with 40 digits.
        for (p, freedom, t) in [
            (0.05, 1.0, 12.706_204_736_174_7),
            (0.05, 2.5, 3.574_654_842_003_683),
            (0.05, 10.0, 2.228_138_851_986_275),
            (0.05, 30.0, 2.042_272_456_301_238),
            (0.01, 100.0, 2.625_890_521_438_018),
            (1e-6, 9.0, 11.636_782_027_328_89),
            (1e-6, 999.0, 4.922_320_372_366_549),
            (0.05, 1000.0, 1.962_339_080_826_408),
            (1e-10, 19_998.0, 6.470_414_573_550_465),
            (0.05, 1e6, 1.959_966_356_814_107),
            (0.9, 7.0, 0.130_292_796_591_777_4),
            (2e-20, f64::INFINITY, 9.262_340_089_798_408),
        ] {
            let found = student_critical(p, freedom);
            assert!((found / t - 1.0).abs() < 1e-10, "{p} {freedom}: {found}");
            assert!((student_p_value(t, freedom) / p - 1.0).abs() < 1e-9, "{p} {freedom}");
            assert!((student_quantile(0.5 * p, freedom) / -t - 1.0).abs() < 1e-10);
        }
        assert_eq!(student_critical(1.0, 5.0), 0.0);
        assert!(student_critical(0.05, 0.0).is_nan() && student_p_value(1.0, f64::NAN).is_nan());
    }
}
