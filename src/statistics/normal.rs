//! The normal distribution.

use super::gamma::regularised_gamma_q;

/// The chance that a standard normal variable exceeds x; accurate far into the tail.
#[must_use]
pub fn normal_tail(x: f64) -> f64 {
    // DLMF 7.11.2: erfc(x) = Q(1/2, x²).
    let half = 0.5 * regularised_gamma_q(0.5, 0.5 * x * x);
    if x > 0.0 { half } else { 1.0 - half }
}

/// The chance that a standard normal variable lies below x.
#[must_use]
pub fn normal_cdf(x: f64) -> f64 {
    normal_tail(-x)
}

/// The x below which a standard normal variable lies with chance p; infinite at 0 and 1.
#[must_use]
pub fn normal_quantile(p: f64) -> f64 {
    if p > 0.5 { normal_upper(1.0 - p) } else { -normal_upper(p) }
}

/// The x that a standard normal variable exceeds with chance p <= 1/2.
pub(super) fn normal_upper(p: f64) -> f64 {
    if p <= 0.0 {
        return if p == 0.0 { f64::INFINITY } else { f64::NAN };
    }
    // Start: Abramowitz & Stegun 26.2.23, good to 4.5e-4.
    let t = (-2.0 * p.ln()).sqrt();
    let mut x = t
        - (2.515_517 + t * (0.802_853 + t * 0.010_328))
            / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)));
    for _ in 0..3 {
        // Halley's step for the tail, whose derivative is -φ and whose second derivative is x φ.
        let density = (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
        let step = (normal_tail(x) - p) / density;
        x += step / (1.0 - 0.5 * x * step);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::excessive_precision)] // computed with 30 digits
    fn tails_and_quantiles_to_ten_digits() {
        for (x, tail) in [
            (0.0, 0.5),
            (1.0, 0.158_655_253_931_457_051_415),
            (1.959_963_984_540_054_235_52, 0.025),
            (5.0, 2.866_515_718_791_939_117e-7),
            (10.0, 7.619_853_024_160_526_066e-24),
        ] {
            assert!((normal_tail(x) / tail - 1.0).abs() < 1e-12, "{x}");
            assert!((normal_upper(tail) - x).abs() < 1e-11, "{x}");
            assert!((normal_cdf(-x) / tail - 1.0).abs() < 1e-12);
        }
        assert!((normal_quantile(0.95) - 1.644_853_626_951_472_714_86).abs() < 1e-11);
        assert!((normal_quantile(0.05) + 1.644_853_626_951_472_714_86).abs() < 1e-11);
        assert!((normal_quantile(1e-20) + 9.262_340_089_798_408).abs() < 1e-11);
        assert!(normal_quantile(0.0) == f64::NEG_INFINITY && normal_quantile(1.0) == f64::INFINITY);
    }
}
