//! The incomplete beta function and the binomial distribution.

use super::gamma::ln_gamma;

/// From here on Stirling's series is good to 1e-16 with the terms below.
const LARGE: f64 = 10.0;

/// I_x(a, b) for a, b > 0: the chance that a beta variable of shape (a, b) lies below x, DLMF 8.17.2.
/// Relative error below 1e-9 for a, b up to 1e6, 1e-12 for small ones.
#[must_use]
pub fn regularised_beta(a: f64, b: f64, x: f64) -> f64 {
    beta_below(a, b, x, 1.0 - x)
}

/// I_x(a, b) where both x and y = 1 - x are known to full precision.
pub(super) fn beta_below(a: f64, b: f64, x: f64, y: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if y <= 0.0 {
        1.0
    } else if x < (a + 1.0) / (a + b + 2.0) {
        front(a, b, x, y) * fraction(a, b, x)
    } else {
        // DLMF 8.17.4.
        1.0 - front(b, a, y, x) * fraction(b, a, y)
    }
}

/// The chance of at most `k` successes in `n` trials of chance `p`, DLMF 8.17.5.
#[must_use]
pub fn binomial_cdf(k: u64, n: u64, p: f64) -> f64 {
    if k >= n {
        return 1.0;
    }
    beta_below((n - k) as f64, k as f64 + 1.0, 1.0 - p, p)
}

/// x^a y^b / (a B(a, b)); large arguments by Stirling's series, where differences of ln Γ would lose digits.
fn front(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let (ln_x, ln_y) = if x > 0.5 { ((-y).ln_1p(), y.ln()) } else { (x.ln(), (-x).ln_1p()) };
    let s = stirling_rest;
    let ln = if a >= LARGE && b >= LARGE {
        let whole = a + b;
        a * (ln_x + (whole / a).ln())
            + b * (ln_y + (whole / b).ln())
            + 0.5 * (a * b / whole / std::f64::consts::TAU).ln()
            + s(whole)
            - s(a)
            - s(b)
    } else if a.max(b) >= LARGE {
        let (large, small) = (a.max(b), a.min(b));
        // ln Γ(large + small) - ln Γ(large).
        let ratio = (large + small - 0.5) * (small / large).ln_1p() + small * large.ln() - small
            + s(large + small)
            - s(large);
        a * ln_x + b * ln_y + ratio - ln_gamma(small)
    } else {
        a * ln_x + b * ln_y + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b)
    };
    ln.exp() / a
}

/// ln Γ(z) - ((z - ½) ln z - z + ½ ln 2π), DLMF 5.11.1.
fn stirling_rest(z: f64) -> f64 {
    let q = 1.0 / (z * z);
    let terms = [-691.0 / 360_360.0, 1.0 / 1188.0, -1.0 / 1680.0, 1.0 / 1260.0, -1.0 / 360.0, 1.0 / 12.0];
    terms.iter().fold(0.0, |sum, term| sum * q + term) / z
}

/// The continued fraction DLMF 8.17.22 by Lentz's method; fast for x < (a + 1)/(a + b + 2).
fn fraction(a: f64, b: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let guard = |v: f64| if v.abs() < TINY { TINY } else { v };
    let (mut c, mut d) = (1.0, 1.0 / guard(1.0 - (a + b) * x / (a + 1.0)));
    let mut h = d;
    for m in 1..100_000u32 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = h;
        for term in [even, odd] {
            d = 1.0 / guard(1.0 + term * d);
            c = guard(1.0 + term / c);
            h *= c * d;
        }
        if (h / before - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms() {
        for x in [1e-8f64, 0.1, 0.5, 0.9, 0.999] {
            // I_x(1, b) = 1 - (1 - x)^b, I_x(a, 1) = x^a, I_x(1/2, 1/2) = 2/π asin √x.
            for k in [0.3f64, 1.0, 7.0, 40.0] {
                let exact = -(k * (-x).ln_1p()).exp_m1();
                assert!((regularised_beta(1.0, k, x) / exact - 1.0).abs() < 1e-12);
                assert!((regularised_beta(k, 1.0, x) / x.powf(k) - 1.0).abs() < 1e-12);
            }
            let arc = 2.0 / std::f64::consts::PI * x.sqrt().asin();
            assert!((regularised_beta(0.5, 0.5, x) / arc - 1.0).abs() < 1e-12);
        }
        assert_eq!((regularised_beta(2.0, 3.0, 0.0), regularised_beta(2.0, 3.0, 1.0)), (0.0, 1.0));
    }

    #[test]
    #[allow(clippy::excessive_precision)] // summed as a series with 40 digits
    fn large_shapes() {
        for (a, b, x, exact) in [
            (30.0, 2.5, 0.8, 0.017_532_380_662_432_919),
            (100.0, 200.0, 0.25, 6.588_924_984_657_823_4e-4),
            (5000.0, 7000.0, 0.41, 0.069_092_543_820_119_798),
            (1e6, 1e6, 0.499, 0.002_338_849_406_931_523_1),
        ] {
            let found = regularised_beta(a, b, x);
            assert!((found / exact - 1.0).abs() < 1e-9, "{a} {b}: {found}");
            assert!((1.0 - regularised_beta(b, a, 1.0 - x) - exact).abs() < 1e-11);
        }
    }

    #[test]
    fn binomial_sums() {
        // Sums of the terms themselves: 10 trials of chance 0.3.
        let term = |k: i32| {
            let choose = (0..k).fold(1.0, |c, i| c * f64::from(10 - i) / f64::from(i + 1));
            choose * 0.3f64.powi(k) * 0.7f64.powi(10 - k)
        };
        let mut sum = 0.0;
        for k in 0..10 {
            sum += term(k);
            assert!((binomial_cdf(k as u64, 10, 0.3) - sum).abs() < 1e-14);
        }
        assert_eq!(binomial_cdf(10, 10, 0.3), 1.0);
        // By symmetry of an odd number of fair trials.
        assert!((binomial_cdf(500_000, 1_000_001, 0.5) - 0.5).abs() < 1e-12);
    }
}
