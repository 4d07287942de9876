//! One quantity in two runs: do its mean and its variance differ?

use super::few::{counted, signs};
use crate::statistics::{self, Test, cautious, obrien, paired};
use serde::Serialize;

/// Two values are the same number, or a spread none at all, where only rounding parts them.
const ROUNDING: f64 = 1e-12;

/// How a difference was judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judged {
    /// Student's t of the differences, realization by realization.
    Paired,
    /// Welch's t, its standard error no smaller than the pooled one.
    Independent,
    /// Few realizations leave the common value: Fisher's exact test of how many do.
    Counted,
    /// Few pairs differ: the sign test.
    Signs,
    /// Both are constant and differ.
    Certain,
}

impl Judged {
    /// The word for it in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Judged::Paired => "paired",
            Judged::Independent => "independent",
            Judged::Counted => "counted",
            Judged::Signs => "signs",
            Judged::Certain => "certain",
        }
    }
}

/// What was found of a mean or a variance: its values in both samples, and their difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    pub a: f64,
    pub b: f64,
    pub test: Test,
    pub judged: Judged,
}

/// What two samples of one quantity have to say; nothing where there is nothing to test.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Findings {
    pub mean: Option<Finding>,
    pub variance: Option<Finding>,
    /// Both constant and equal, or equal pair by pair.
    pub equal: bool,
}

impl Findings {
    /// Judges two samples, at least two values each; `pairs` says that value k of both came from the same
    /// random numbers.
    #[must_use]
    pub fn of(a: &[f64], b: &[f64], pairs: bool) -> Findings {
        let (mean_a, mean_b) = (statistics::mean(a), statistics::mean(b));
        let same = |x: f64, y: f64| (x - y).abs() <= ROUNDING * x.abs().max(y.abs());
        if constant(a) && constant(b) {
            if same(mean_a, mean_b) {
                return Findings { equal: true, ..Findings::default() };
            }
            let mean = Some(certain(mean_a, mean_b));
            return Findings { mean, ..Findings::default() };
        }
        if pairs {
            let apart: Vec<f64> = a.iter().zip(b).map(|(a, b)| b - a).collect();
            let size = mean_a.abs().max(mean_b.abs());
            if apart.iter().all(|d| d.abs() <= ROUNDING * size) {
                return Findings { equal: true, ..Findings::default() };
            }
            if apart.iter().all(|d| (d - apart[0]).abs() <= ROUNDING * size) {
                // Shifted as a whole: the variances are the same.
                let mean = Some(certain(mean_a, mean_b));
                return Findings { mean, ..Findings::default() };
            }
            let (mean, few) = pair_means(a, b);
            let variance = if few { None } else { variances(a, b, true) };
            return Findings { mean: Some(mean), variance, equal: false };
        }
        let test = cautious(a, b);
        if let Some(p) = counted(a, b) {
            let mean = Finding { a: mean_a, b: mean_b, test: Test { p, ..test }, judged: Judged::Counted };
            return Findings { mean: Some(mean), ..Findings::default() };
        }
        let mean = Finding { a: mean_a, b: mean_b, test, judged: Judged::Independent };
        Findings { mean: Some(mean), variance: variances(a, b, false), equal: false }
    }
}

fn constant(values: &[f64]) -> bool {
    let size = values[0].abs();
    values.iter().all(|v| (v - values[0]).abs() <= ROUNDING * size)
}

fn certain(a: f64, b: f64) -> Finding {
    let test = Test {
        difference: b - a,
        standard_error: 0.0,
        t: f64::INFINITY.copysign(b - a),
        freedom: f64::INFINITY,
        p: 0.0,
    };
    Finding { a, b, test, judged: Judged::Certain }
}

/// Means of pairs, and whether so few pairs differ that only their signs were counted.
fn pair_means(a: &[f64], b: &[f64]) -> (Finding, bool) {
    let test = paired(a, b);
    let (test, judged) = match signs(a, b) {
        Some(p) => (Test { p, ..test }, Judged::Signs),
        None => (test, Judged::Paired),
    };
    let few = judged == Judged::Signs;
    (Finding { a: statistics::mean(a), b: statistics::mean(b), test, judged }, few)
}

fn variances(a: &[f64], b: &[f64], pairs: bool) -> Option<Finding> {
    let (ra, rb) = (obrien(a), obrien(b));
    if ra.is_empty() || rb.is_empty() {
        return None;
    }
    let (va, vb) = (statistics::variance(a), statistics::variance(b));
    let (test, judged) =
        if pairs { (paired(&ra, &rb), Judged::Paired) } else { (cautious(&ra, &rb), Judged::Independent) };
    // Where all values lie equally far from the mean nothing tells how well the variance is known.
    let known = test.standard_error > 1e-9 * va.max(vb);
    known.then_some(Finding { a: va, b: vb, test, judged })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use crate::random::{Purpose, stream};
    use rand_distr::{Distribution, Exp1, Poisson};

    type Draw = fn(&mut Stream) -> f64;
    const CASES: [Draw; 4] = [
        |s| Poisson::new(0.01).unwrap().sample(s),
        |s| Poisson::new(0.3).unwrap().sample(s),
        |s| Poisson::new(50.0).unwrap().sample(s),
        |s| Exp1.sample(s),
    ];

    fn samples(draw: Draw, sizes: (usize, usize), r: u64) -> (Vec<f64>, Vec<f64>) {
        let mut s = stream(5, r, Purpose::Reactions);
        let a = (0..sizes.0).map(|_| draw(&mut s)).collect();
        (a, (0..sizes.1).map(|_| draw(&mut s)).collect())
    }

    #[test]
    fn equal_distributions_rarely_differ() {
        // 4000 repeats of each: at most 5 % of p below 5 % (standard deviation 0.35 %, four allowed: 6.4 %)
        // and at most 0.1 % below 0.1 % (4 of them, twelve allowed, a chance of 3e-4 a case where the test is
        // exact).
        for (k, draw) in CASES.into_iter().enumerate() {
            for sizes in [(10, 10), (200, 200), (400, 40), (40, 400)] {
                let (mut mean, mut variance) = ([0; 2], [0; 2]);
                for r in 0..4000 {
                    let (a, b) = samples(draw, sizes, r);
                    let found = Findings::of(&a, &b, false);
                    for (count, finding) in [(&mut mean, found.mean), (&mut variance, found.variance)] {
                        let p = finding.map_or(1.0, |f| f.test.p);
                        count[0] += i32::from(p <= 0.05);
                        count[1] += i32::from(p <= 0.001);
                    }
                }
                for count in [mean, variance] {
                    assert!(count[0] <= 256 && count[1] <= 12, "case {k} {sizes:?}: {count:?}");
                }
            }
        }
    }

    #[test]
    fn equal_pairs_rarely_differ() {
        // As above, with a correlation of 0.7 between the two of a pair.
        for mean in [0.3, 5.0, 100.0] {
            let (common, own) = (Poisson::new(0.7 * mean).unwrap(), Poisson::new(0.3 * mean).unwrap());
            for n in [10, 200] {
                let mut count = [0; 4];
                for r in 0..4000 {
                    let mut s = stream(8, r, Purpose::Reactions);
                    let (a, b): (Vec<f64>, Vec<f64>) = (0..n)
                        .map(|_| {
                            let both = common.sample(&mut s);
                            (both + own.sample(&mut s), both + own.sample(&mut s))
                        })
                        .unzip();
                    let found = Findings::of(&a, &b, true);
                    for (k, finding) in [found.mean, found.variance].into_iter().enumerate() {
                        let p = finding.map_or(1.0, |f| f.test.p);
                        count[2 * k] += i32::from(p <= 0.05);
                        count[2 * k + 1] += i32::from(p <= 0.001);
                    }
                }
                assert!(
                    count[0].max(count[2]) <= 256 && count[1].max(count[3]) <= 12,
                    "{mean} {n}: {count:?}"
                );
            }
        }
    }

    #[test]
    fn noise_alone_is_seen_and_a_mean_alone_is() {
        // Exponential against its sum of four halves: mean 2 and 2, variance 4 and 2.
        let mut s = stream(6, 0, Purpose::Reactions);
        let draw = |s: &mut Stream| -> f64 { Exp1.sample(s) };
        let a: Vec<f64> = (0..1000).map(|_| 2.0 * draw(&mut s)).collect();
        let b: Vec<f64> = (0..1000).map(|_| draw(&mut s) + draw(&mut s)).collect();
        let found = Findings::of(&a, &b, false);
        // The variances lie √(8·16 + 5·4)/√1000 = 0.38 apart from the truth, so five errors from each other.
        assert!(found.variance.unwrap().test.p < 1e-3 && found.mean.unwrap().test.p > 1e-4, "{found:?}");
        let shifted: Vec<f64> = b.iter().map(|v| v + 1.0).collect();
        let found = Findings::of(&b, &shifted, false);
        assert!(found.mean.unwrap().test.p < 1e-6 && found.variance.unwrap().test.p > 0.999, "{found:?}");
    }

    #[test]
    fn constants_pairs_and_few_events() {
        let of = Findings::of;
        assert!(of(&[3.0; 5], &[3.0; 7], false).equal && of(&[1.0, 2.0], &[1.0, 2.0], true).equal);
        let found = of(&[0.1; 5], &[0.3; 7], false);
        let mean = found.mean.unwrap();
        assert!(mean.judged == Judged::Certain && mean.test.p == 0.0 && found.variance.is_none());
        // Pairs shifted as a whole are certain too; one sample alone would not tell.
        let (a, b) = ([1.0, 5.0, 2.0, 8.0], [2.0, 6.0, 3.0, 9.0]);
        assert_eq!(of(&a, &b, true).mean.unwrap().judged, Judged::Certain);
        assert!(of(&a, &b, false).mean.unwrap().test.p > 0.5);
        // Three pairs of fifty differ, all upwards: 2/2³.
        let (low, mut high) = (vec![1.0; 50], vec![1.0; 50]);
        high[..3].fill(2.0);
        let mean = of(&low, &high, true).mean.unwrap();
        assert!(mean.judged == Judged::Signs && (mean.test.p - 0.25).abs() < 1e-12);
        // Unpaired: three events of fifty against none, 2 C(50, 3)/C(100, 3).
        let mean = of(&low, &high, false).mean.unwrap();
        assert!(mean.judged == Judged::Counted && (mean.test.p - 2.0 * 19_600.0 / 161_700.0).abs() < 1e-9);
        // As many up as down, against none: two tests.
        high[..3].copy_from_slice(&[2.0, 0.0, 2.0]);
        let mean = of(&low, &high, false).mean.unwrap();
        assert!((mean.test.p - 2.0 * 2.0 * 1225.0 / 4950.0).abs() < 1e-9, "{mean:?}");
        // Half of few values at either side of the mean: no variance of the variance.
        assert!(of(&[0.0, 1.0, 0.0, 1.0], &[1.0, 0.0, 0.0, 1.0], false).variance.is_none());
    }
}
