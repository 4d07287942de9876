//! Whether two samples differ: Student's t for independent samples and for pairs.

use super::student::{student_critical, student_p_value};
use super::{mean, variance};
use serde::{Deserialize, Serialize};

/// A difference, how well it is known, and how likely one as large would be by chance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// Mean of the second sample less that of the first.
    pub difference: f64,
    /// Standard error of the difference.
    pub standard_error: f64,
    /// difference / standard error.
    pub t: f64,
    /// Degrees of freedom of t; not always whole.
    pub freedom: f64,
    /// Two-sided chance of a |t| at least this large where the true difference is zero.
    pub p: f64,
}

impl Test {
    /// A test of a difference with a standard error of so many degrees of freedom; NaN where the error is
    /// zero.
    #[must_use]
    pub fn new(difference: f64, standard_error: f64, freedom: f64) -> Test {
        let t = difference / standard_error;
        Test { difference, standard_error, t, freedom, p: student_p_value(t, freedom) }
    }

    /// The interval of the difference at this confidence.
    #[must_use]
    pub fn interval(&self, confidence: f64) -> (f64, f64) {
        let half = self.standard_error * student_critical(1.0 - confidence, self.freedom);
        (self.difference - half, self.difference + half)
    }
}

/// Independent samples of any variances: B. L. Welch, Biometrika 34 (1947) 28, with the degrees of freedom of
/// F. E. Satterthwaite (1946). NaN below two values on a side.
#[must_use]
pub fn welch(a: &[f64], b: &[f64]) -> Test {
    let (va, vb) = (variance(a) / a.len() as f64, variance(b) / b.len() as f64);
    let whole = va + vb;
    let freedom = whole * whole / (va * va / (a.len() as f64 - 1.0) + vb * vb / (b.len() as f64 - 1.0));
    Test::new(mean(b) - mean(a), whole.sqrt(), freedom)
}

/// Independent samples of one variance: Student (1908). NaN below three values in all.
#[must_use]
pub fn pooled(a: &[f64], b: &[f64]) -> Test {
    let (n, m) = (a.len() as f64, b.len() as f64);
    let squares = |v: &[f64]| if v.len() < 2 { 0.0 } else { variance(v) * (v.len() as f64 - 1.0) };
    let freedom = n + m - 2.0;
    let common = (squares(a) + squares(b)) / freedom;
    Test::new(mean(b) - mean(a), (common * (1.0 / n + 1.0 / m)).sqrt(), freedom)
}

/// Welch's test with a standard error no smaller than the pooled one.
///
/// The two agree for samples of one size. A small sample of rare events may show none and so no variance; its
/// own variance would then call the larger sample's few events a difference. The pooled one does not, and
/// where the small sample has the larger variance Welch's error is the larger.
#[must_use]
pub fn cautious(a: &[f64], b: &[f64]) -> Test {
    let (own, common) = (welch(a, b), pooled(a, b));
    if own.standard_error >= common.standard_error * (1.0 - 1e-12) { own } else { common }
}

/// Pairs: Student's t of the differences b - a. NaN below two pairs or where the lengths differ.
#[must_use]
pub fn paired(a: &[f64], b: &[f64]) -> Test {
    if a.len() != b.len() {
        return Test::new(f64::NAN, f64::NAN, f64::NAN);
    }
    let apart: Vec<f64> = a.iter().zip(b).map(|(a, b)| b - a).collect();
    Test::new(mean(&apart), super::sem(&apart), apart.len() as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_samples_by_hand() {
        let (a, b) = ([1.0, 2.0, 3.0], [2.0, 4.0, 6.0, 8.0]);
        let test = welch(&a, &b);
        // Variances 1 and 20/3: 1/3 + 5/3 = 2; degrees of freedom 4 / ((1/9)/2 + (25/9)/3) = 4 / (53/54).
        assert!((test.difference - 3.0).abs() < 1e-15);
        assert!((test.standard_error - 2f64.sqrt()).abs() < 1e-15);
        assert!((test.freedom - 216.0 / 53.0).abs() < 1e-13);
        assert!((test.t - 3.0 / 2f64.sqrt()).abs() < 1e-14);
        // Pooled: (2 + 20)/5 (1/3 + 1/4).
        let test = pooled(&a, &b);
        assert!((test.standard_error - (22.0 / 5.0 * 7.0 / 12.0f64).sqrt()).abs() < 1e-14);
        assert_eq!(test.freedom, 5.0);
        assert_eq!(cautious(&a, &b), pooled(&a, &b));
        // Differences 1, 2, 3: mean 2, standard error 1/√3; |t| > 2√3 with two degrees of freedom.
        let test = paired(&a, &b[..3]);
        assert!((test.t - 12f64.sqrt()).abs() < 1e-14 && test.freedom == 2.0);
        assert!((test.p - (1.0 - (12.0 / 14.0f64).sqrt())).abs() < 1e-14);
        let (low, high) = test.interval(1.0 - test.p);
        assert!(low.abs() < 1e-13 && (high - 4.0).abs() < 1e-13);
        assert!(paired(&a, &b).p.is_nan() && welch(&a, &[1.0]).p.is_nan());
    }

    #[test]
    fn samples_of_one_size_have_one_standard_error() {
        let (a, b) = ([1.0, 5.0, 2.0, 2.0], [3.0, 3.5, 9.0, -4.0]);
        assert!((welch(&a, &b).standard_error / pooled(&a, &b).standard_error - 1.0).abs() < 1e-14);
        assert_eq!(cautious(&a, &b), welch(&a, &b));
        // A sample without an event says little: Welch's own error would be that of the other.
        let (few, none) = ([vec![0.0; 990], vec![1.0; 10]].concat(), vec![0.0; 50]);
        assert!(welch(&few, &none).p < 0.01 && cautious(&few, &none).p > 0.4);
    }
}
