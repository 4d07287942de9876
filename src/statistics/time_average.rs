//! The average of one realization over time, and how well it is known.

use super::correlation::Memory;
use super::interval::{Interval, mean_interval};
use super::normal::{normal_quantile, normal_tail};
use super::student::student_p_value;
use super::{mean, sem, variance};
use serde::{Deserialize, Serialize};

/// A time average of evenly spaced values that remember each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeAverage {
    pub mean: f64,
    /// √(s² τ/n), τ the integrated autocorrelation time in steps; zero for a constant series.
    pub standard_error: f64,
    /// Integral of the autocorrelation from zero on, in the unit of the spacing: T for a memory exp(-t/T).
    /// Half a spacing if the values know nothing of each other, NaN for a constant series.
    pub autocorrelation_time: f64,
    /// Independent values that would know the mean as well; NaN for a constant series.
    pub effective_samples: f64,
    /// Degrees of freedom of the standard error, for [`TimeAverage::interval`].
    pub freedom: f64,
    /// J. Geweke, Bayesian Statistics 4 (1992) 169: the mean of the first tenth less that of the second half
    /// in standard errors; beyond 2 to 3 in size the start is not typical of the rest. Both errors are from
    /// the second half, so that a drift at the start does not hide itself; normal where the series is
    /// stationary. NaN for a constant second half that the start agrees with, infinite where it does not.
    pub stationarity: f64,
}

impl TimeAverage {
    /// Of a series of evenly spaced values; `spacing` in s. None below 20 values, too few to tell anything.
    #[must_use]
    pub fn of(values: &[f64], spacing: f64) -> Option<TimeAverage> {
        let n = values.len();
        if n < 20 {
            return None;
        }
        let stationarity = geweke(&values[..n / 10], &values[n / 2..]);
        let Some(memory) = Memory::of(values) else {
            return Some(TimeAverage {
                mean: mean(values),
                standard_error: 0.0,
                autocorrelation_time: f64::NAN,
                effective_samples: f64::NAN,
                freedom: f64::INFINITY,
                stationarity,
            });
        };
        let effective = n as f64 / memory.steps;
        Some(TimeAverage {
            mean: mean(values),
            standard_error: (variance(values) / effective).sqrt(),
            autocorrelation_time: 0.5 * memory.steps * spacing,
            effective_samples: effective,
            freedom: memory.freedom,
            stationarity,
        })
    }

    /// Averages of independent realizations taken together: the standard error from their spread, which holds
    /// also where realizations remember different starts; for a single one its own. The time is the mean of
    /// those known, the values of z are joined as Σz/√R (Stouffer et al. 1949). None of none.
    #[must_use]
    pub fn joined(parts: &[TimeAverage]) -> Option<TimeAverage> {
        let (&first, rest) = parts.split_first()?;
        if rest.is_empty() {
            return Some(first);
        }
        let all = |of: fn(&TimeAverage) -> f64| parts.iter().map(of).collect::<Vec<f64>>();
        let known =
            |of: fn(&TimeAverage) -> f64| parts.iter().map(of).filter(|v| !v.is_nan()).collect::<Vec<f64>>();
        let (times, samples, z) =
            (known(|p| p.autocorrelation_time), known(|p| p.effective_samples), known(|p| p.stationarity));
        let means = all(|p| p.mean);
        Some(TimeAverage {
            mean: mean(&means),
            standard_error: sem(&means),
            autocorrelation_time: mean(&times),
            effective_samples: if samples.is_empty() { f64::NAN } else { samples.iter().sum() },
            freedom: parts.len() as f64 - 1.0,
            stationarity: z.iter().sum::<f64>() / (z.len() as f64).sqrt(),
        })
    }

    /// The interval of the true mean at this confidence.
    #[must_use]
    pub fn interval(&self, confidence: f64) -> Interval {
        mean_interval(self.mean, self.standard_error, self.freedom, confidence)
    }
}

fn geweke(early: &[f64], late: &[f64]) -> f64 {
    let apart = mean(early) - mean(late);
    let Some(memory) = Memory::of(late) else {
        return if apart == 0.0 { f64::NAN } else { apart * f64::INFINITY };
    };
    let square = variance(late) * memory.steps;
    let t = apart / (square * (1.0 / early.len() as f64 + 1.0 / late.len() as f64)).sqrt();
    // The error is itself estimated: the normal number that is as unlikely as this t.
    let half = 0.5 * student_p_value(t, memory.freedom);
    let z = if half < normal_tail(37.0) { t.abs().min(37.0) } else { -normal_quantile(half) };
    z.copysign(t)
}

#[cfg(test)]
mod tests {
    use super::super::correlation::tests::autoregressive;
    use super::*;
    use crate::random::{Purpose, stream};

    /// a for a memory of ten steps: τ = (1 + a)/(1 - a) = 20.
    const A: f64 = 19.0 / 21.0;

    #[test]
    fn intervals_of_time_averages_cover() {
        // 1000 series of 4000 values, worth 200: the share covered by 95 % intervals has a standard deviation
        // of 0.7 %, so 93 % to 97 % is missed with a chance of 0.4 % where the true cover is 95 %.
        let (mut held, mut far, mut time) = (0, 0, 0.0);
        for r in 0..1000 {
            let values = autoregressive(4000, A, &mut stream(11, r, Purpose::Reactions));
            let found = TimeAverage::of(&values, 0.1).unwrap();
            held += usize::from(found.interval(0.95).holds(0.0));
            far += usize::from(found.stationarity.abs() > 1.96);
            time += found.autocorrelation_time / 1000.0;
        }
        eprintln!("{held} {far} {time}");
        assert!((930..=970).contains(&held), "{held}");
        // 5 % of stationary series lie beyond 1.96, within 0.7 %; the first tenth is worth only 20 values.
        assert!((30..=75).contains(&far), "{far}");
        // Half of 20 steps of 0.1 s, known to 30 % each, 1 % in the mean of all; what bias is left is a few
        // %.
        assert!((time - 1.0).abs() < 0.1, "{time}");
    }

    #[test]
    fn a_transient_is_seen() {
        // Starts ten standard deviations off and decays over 200 steps: the first tenth lies four off.
        let mut values = autoregressive(4000, A, &mut stream(12, 0, Purpose::Reactions));
        values.iter_mut().enumerate().for_each(|(k, v)| *v += 10.0 * (-(k as f64) / 200.0).exp());
        let found = TimeAverage::of(&values, 1.0).unwrap();
        assert!(found.stationarity > 5.0, "{found:?}");
        values.iter_mut().for_each(|v| *v = -*v);
        assert!(TimeAverage::of(&values, 1.0).unwrap().stationarity < -5.0);
    }

    #[test]
    fn constant_series_and_short_ones() {
        let found = TimeAverage::of(&[0.1; 50], 1.0).unwrap();
        assert!((found.mean, found.standard_error) == (0.1, 0.0) && found.stationarity.is_nan());
        assert_eq!(found.interval(0.95), Interval { low: 0.1, high: 0.1 });
        let mut late = vec![1.0; 50];
        late[0] = 0.0;
        assert_eq!(TimeAverage::of(&late, 1.0).unwrap().stationarity, f64::NEG_INFINITY);
        assert!(TimeAverage::of(&[1.0; 19], 1.0).is_none() && TimeAverage::joined(&[]).is_none());
    }

    #[test]
    fn realizations_taken_together() {
        let part = |r| {
            TimeAverage::of(&autoregressive(2000, A, &mut stream(13, r, Purpose::Reactions)), 1.0).unwrap()
        };
        let parts: Vec<TimeAverage> = (0..50).map(part).collect();
        let all = TimeAverage::joined(&parts).unwrap();
        // 50 series of 100 samples each: the error √(1/5000) to a tenth (its own error), four of them.
        assert!((all.standard_error * 5000f64.sqrt() - 1.0).abs() < 0.4, "{all:?}");
        assert!((all.effective_samples / 5000.0 - 1.0).abs() < 0.25 && all.freedom == 49.0);
        assert!(all.interval(0.9999).holds(0.0) && all.stationarity.abs() < 4.0);
        assert_eq!(TimeAverage::joined(&parts[..1]), Some(parts[0]));
    }
}
