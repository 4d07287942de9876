//! Bessel functions of the first kind of order 0 and 1, and the zeros of the latter.

use std::f64::consts::PI;

/// J_n(x) = 1/π ∫₀^π cos(nτ - x sin τ) dτ (Bessel 1824), by the trapezoidal rule, which for a periodic integrand is
/// exact to rounding once it has some x + 30 points.
#[must_use]
pub fn j(n: u32, x: f64) -> f64 {
    let points = (x.abs() as usize + 40).next_multiple_of(2);
    let value = |k: usize| {
        let tau = PI * k as f64 / points as f64;
        (f64::from(n) * tau - x * tau.sin()).cos()
    };
    let inner: f64 = (1..points).map(value).sum();
    (inner + 0.5 * (value(0) + value(points))) / points as f64
}

/// The first `count` positive zeros of J_1, by Newton's method from McMahon's (1894) first approximation.
#[must_use]
pub fn zeros_of_j1(count: u32) -> Vec<f64> {
    (1..=count)
        .map(|k| {
            let b = (f64::from(k) + 0.25) * PI;
            let mut x = b - 3.0 / (8.0 * b);
            for _ in 0..4 {
                // J_1' = J_0 - J_1/x.
                let value = j(1, x);
                x -= value / (j(0, x) - value / x);
            }
            x
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabulated_values_are_met() {
        // Abramowitz & Stegun (1964), tables 9.1 and 9.5.
        assert!((j(0, 1.0) - 0.765_197_686_557_967).abs() < 1e-14);
        assert!((j(1, 10.0) - 0.043_472_746_168_861).abs() < 1e-14);
        let zeros = zeros_of_j1(20);
        assert!((zeros[0] - 3.831_705_970_207_512).abs() < 1e-13);
        assert!((zeros[19] - 63.611_356_698_481_23).abs() < 1e-11);
    }
}
