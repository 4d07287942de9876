//! How long a time series remembers: autocorrelation and its integral.

use super::mean;

/// The window grows until it is so many times the integral found within it.
const WINDOW: f64 = 5.0;

/// Coefficients of correlation of a series with itself at lags 0, 1, … below `lags`, about its own mean and
/// divided by n, not n - lag (Priestley, Spectral Analysis and Time Series (1981)). NaN for a constant
/// series.
#[must_use]
pub fn autocorrelation(values: &[f64], lags: usize) -> Vec<f64> {
    let apart = deviations(values);
    let whole = product(&apart, 0);
    (0..lags.min(values.len())).map(|lag| product(&apart, lag) / whole).collect()
}

/// What the memory of a series is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory {
    /// Integrated autocorrelation time τ = 1 + 2 Σ ρ(k), in steps: n values are worth n/τ independent ones.
    pub steps: f64,
    /// Lags summed.
    pub window: usize,
    /// Degrees of freedom of a variance made from τ: 2/ν is its relative variance, n/(2 window + 1).
    pub freedom: f64,
}

impl Memory {
    /// The integrated autocorrelation time by a window that closes at five times the time found within it: N.
    /// Madras & A. D. Sokal, J. Stat. Phys. 50 (1988) 109, appendix C; the bias of a mean from the same
    /// series is taken off as in U. Wolff, Comput. Phys. Commun. 156 (2004) 143, Eq. (49). Trust it where the
    /// series is 50 times as long.
    ///
    /// None for a constant series or one of fewer than four values.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Memory> {
        let n = values.len();
        if n < 4 {
            return None;
        }
        let apart = deviations(values);
        let whole = product(&apart, 0);
        let size = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        // Rounding alone is no variance.
        if whole.is_nan() || whole <= (size * 1e-14).powi(2) * n as f64 {
            return None;
        }
        let (mut steps, mut window) = (1.0, 0);
        // A window wider than a quarter of the series is noise.
        while window < (n / 4).max(1) {
            window += 1;
            steps += 2.0 * product(&apart, window) / whole;
            // A series that swings has a time below one step; the window is at least five steps for its sake.
            if window as f64 >= WINDOW * steps.max(1.0) {
                break;
            }
        }
        let width = 2.0 * window as f64 + 1.0;
        let n = n as f64;
        // What swings hard enough to be worth more than a hundred values a value is not believed.
        let steps = (steps * (1.0 + width / n)).max(0.01);
        Some(Memory { steps, window, freedom: (n / width).max(1.0) })
    }
}

fn deviations(values: &[f64]) -> Vec<f64> {
    let centre = mean(values);
    values.iter().map(|v| v - centre).collect()
}

fn product(apart: &[f64], lag: usize) -> f64 {
    apart.iter().zip(&apart[lag..]).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::random::{Purpose, Stream, stream};
    use rand_distr::{Distribution, StandardNormal};

    /// x' = a x + √(1 - a²) z: mean zero, variance one, ρ(k) = a^k, τ = (1 + a)/(1 - a).
    pub fn autoregressive(n: usize, a: f64, s: &mut Stream) -> Vec<f64> {
        let mut x: f64 = StandardNormal.sample(s);
        (0..n)
            .map(|_| {
                let now = x;
                let z: f64 = StandardNormal.sample(s);
                x = a * x + (1.0 - a * a).sqrt() * z;
                now
            })
            .collect()
    }

    #[test]
    fn coefficients_by_hand() {
        // Deviations -1, 0, 1, 0: squares 2, lag one 0, lag two -1, lag three 0.
        assert_eq!(autocorrelation(&[1.0, 2.0, 3.0, 2.0], 9), [1.0, 0.0, -0.5, 0.0]);
        assert!(autocorrelation(&[1.0; 3], 1)[0].is_nan());
        assert!(Memory::of(&[0.1; 100]).is_none() && Memory::of(&[1.0, 2.0]).is_none());
    }

    #[test]
    fn an_autoregressive_process_has_its_time() {
        let n = 100_000;
        for (key, a) in [(0, 0.0), (1, 0.5), (2, 0.9), (3, 0.98), (4, -0.5)] {
            let values = autoregressive(n, a, &mut stream(1, key, Purpose::Reactions));
            let found = Memory::of(&values).unwrap();
            let exact = (1.0 + a) / (1.0 - a);
            // Relative standard deviation √(2/ν) of τ (Madras & Sokal), five of them; where τ is below one it
            // is that of the sum, of size one. The window leaves out exp(-5·2) of it.
            let error = (2.0 / found.freedom).sqrt() * exact.max(1.0);
            assert!((found.steps - exact).abs() < 5.0 * error, "{a}: {found:?}");
            let rho = autocorrelation(&values, 4);
            // Bartlett: a coefficient has a variance below τ/n.
            assert!((rho[3] - a.powi(3)).abs() < 5.0 * (exact.max(2.0) / n as f64).sqrt(), "{a}: {rho:?}");
        }
    }
}
