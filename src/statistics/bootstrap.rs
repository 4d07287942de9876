//! Confidence intervals of a variance and a Fano factor, which no formula gives for any distribution.

use super::interval::Interval;
use super::normal::normal_quantile;
use super::{mean, quantile_sorted};
use crate::random::Stream;
use rand::RngCore;

/// Samples drawn again.
const DRAWS: usize = 1999;

/// Beyond this many values the estimate is normal on the logarithmic scale and nothing is drawn.
const MANY: usize = 20_000;

/// Of the variance; see [`fano_interval`].
#[must_use]
pub fn variance_interval(values: &[f64], confidence: f64, stream: &mut Stream) -> Interval {
    bootstrap(values, confidence, stream, |m, _| Estimate {
        value: m.variance,
        // The influence of one value is (x - x̄)² - s².
        square: m.fourth - m.variance * m.variance,
    })
}

/// Of the Fano factor variance/mean, for values of positive mean.
///
/// The bootstrap of the t statistic on the logarithmic scale: B. Efron, The Jackknife, the Bootstrap and
/// Other Resampling Plans (1982); P. Hall, Ann. Statist. 16 (1988) 927. The sample is drawn again with
/// replacement 1999 times; the quantiles of (ln θ* - ln θ)/e*, e the standard error by the influence
/// function, stand for those of Student's t. The stream is the caller's: one key, one interval. Beyond 20 000
/// values those of the normal distribution are taken. NaN below three values or where all are equal.
///
/// Measured cover of 95 % intervals: 94 % to 96 % for normal and Poisson values, 30 of them or more; of the
/// variance of an exponential distribution, whose tail a small sample has not seen, 91 % with 100 values and
/// 94 % with 300.
#[must_use]
pub fn fano_interval(values: &[f64], confidence: f64, stream: &mut Stream) -> Interval {
    bootstrap(values, confidence, stream, |m, centre| {
        let mean = centre + m.first;
        let fano = m.variance / mean;
        Estimate {
            value: fano,
            // The influence of one value is ((x - x̄)² - s² - F (x - x̄))/x̄.
            square: (m.fourth - m.variance * m.variance - 2.0 * fano * m.third + fano * fano * m.variance)
                / (mean * mean),
        }
    })
}

/// An estimate and the mean square of the influence of a value.
struct Estimate {
    value: f64,
    square: f64,
}

/// Moments of a sample: the mean less a given centre, and the central ones.
struct Moments {
    first: f64,
    variance: f64,
    third: f64,
    fourth: f64,
}

impl Moments {
    /// From the mean powers of the deviations from the centre.
    fn of(powers: [f64; 4], n: f64) -> Moments {
        let [a, b, c, d] = powers;
        Moments {
            first: a,
            variance: (b - a * a) * n / (n - 1.0),
            third: c - 3.0 * a * b + 2.0 * a * a * a,
            fourth: d - 4.0 * a * c + 6.0 * a * a * b - 3.0 * a * a * a * a,
        }
    }
}

fn bootstrap(
    values: &[f64],
    confidence: f64,
    stream: &mut Stream,
    estimate: impl Fn(&Moments, f64) -> Estimate,
) -> Interval {
    let n = values.len();
    if n < 3 {
        return Interval::UNKNOWN;
    }
    let centre = mean(values);
    let powers: Vec<[f64; 4]> = values
        .iter()
        .map(|x| {
            let d = x - centre;
            [d, d * d, d * d * d, d * d * d * d]
        })
        .collect();
    let count = n as f64;
    let mean_of = |sum: [f64; 4]| sum.map(|s| s / count);
    let add = |sum: [f64; 4], p: &[f64; 4]| std::array::from_fn(|k| sum[k] + p[k]);
    // ln θ and its standard error.
    let log = |powers: [f64; 4]| {
        let e = estimate(&Moments::of(powers, count), centre);
        (e.value.ln(), (e.square.max(0.0) / count).sqrt() / e.value)
    };
    let (own, error) = log(mean_of(powers.iter().fold([0.0; 4], add)));
    if !own.is_finite() || !error.is_finite() {
        return Interval::UNKNOWN;
    }
    let outside = 0.5 * (1.0 - confidence);
    let (t_low, t_high) = if n > MANY {
        let z = normal_quantile(1.0 - outside);
        (-z, z)
    } else {
        let mut t = Vec::with_capacity(DRAWS);
        for _ in 0..DRAWS {
            let mut sum = [0.0; 4];
            for _ in 0..n {
                // The upper half of a 128 bit product: an index below n, even to 2⁻⁶⁴ n.
                let index = ((u128::from(stream.next_u64()) * n as u128) >> 64) as usize;
                sum = add(sum, &powers[index]);
            }
            let (drawn, e) = log(mean_of(sum));
            // A draw of equal values only has no scale.
            if drawn.is_finite() && e > 0.0 {
                t.push((drawn - own) / e);
            }
        }
        t.sort_unstable_by(f64::total_cmp);
        (quantile_sorted(&t, outside), quantile_sorted(&t, 1.0 - outside))
    };
    Interval { low: (own - t_high * error).exp(), high: (own - t_low * error).exp() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};
    use rand_distr::{Distribution, Exp1, Poisson, StandardNormal};

    // 1000 repeats of a 95 % interval of 100 values: the share that holds has a standard deviation of 0.7 %,
    // so 93 % to 97 % is missed with a chance of 0.4 % a case where the true cover is 95 %.
    fn covered(
        seed: u64,
        truth: f64,
        draw: impl Fn(&mut Stream) -> f64,
        of: fn(&[f64], f64, &mut Stream) -> Interval,
    ) -> f64 {
        let case = |r| {
            let mut s = stream(seed, r, Purpose::Reactions);
            let values: Vec<f64> = (0..100).map(|_| draw(&mut s)).collect();
            of(&values, 0.95, &mut stream(seed, r, Purpose::Bootstrap)).holds(truth)
        };
        (0..1000).filter(|&r| case(r)).count() as f64 / 1000.0
    }

    #[test]
    fn variance_and_fano_factor_are_covered() {
        let normal = covered(1, 1.0, |s| StandardNormal.sample(s), variance_interval);
        let few = covered(3, 1.0, |s| Poisson::new(5.0).unwrap().sample(s), fano_interval);
        let many = covered(4, 1.0, |s| Poisson::new(60.0).unwrap().sample(s), fano_interval);
        for share in [normal, few, many] {
            assert!((0.93..=0.97).contains(&share), "{normal} {few} {many}");
        }
    }

    #[test]
    fn a_long_tail_is_covered_less() {
        // The documented 91 % for 100 exponential values, four standard deviations of 0.9 % to either side.
        let share = covered(2, 1.0, |s| Exp1.sample(s), variance_interval);
        assert!((0.87..=0.95).contains(&share), "{share}");
    }

    #[test]
    fn the_same_key_gives_the_same_interval() {
        let values: Vec<f64> = (0..50).map(|i| f64::from(i * i % 23)).collect();
        let of = |key| fano_interval(&values, 0.9, &mut stream(7, key, Purpose::Bootstrap));
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
        let own = super::super::fano(&values);
        assert!(of(1).holds(own));
        assert!(variance_interval(&[1.0; 9], 0.95, &mut stream(0, 0, Purpose::Bootstrap)).low.is_nan());
        assert!(variance_interval(&[1.0, 2.0], 0.95, &mut stream(0, 0, Purpose::Bootstrap)).low.is_nan());
    }

    #[test]
    fn many_values_need_no_drawing() {
        let values: Vec<f64> = (0..20_001).map(|i| f64::from(i % 3)).collect();
        let found = variance_interval(&values, 0.95, &mut stream(0, 0, Purpose::Bootstrap));
        // s² = 2/3, m4 = 2/3: influence m4 - s⁴ = 2/9; ln s² has the error √(2/9/n)/(2/3) = 1/√(2n).
        let half = 1.959_964 / (2.0 * 20_001f64).sqrt();
        assert!((found.high.ln() - (2.0 / 3.0 * 20_001.0 / 20_000.0f64).ln() - half).abs() < 1e-5);
    }
}
