//! Tau-leaping: close to the exact distribution, closer the smaller the tolerance, never below zero.
//!
//! It is biased by design, so limits are a share of what is compared plus the sampling error; seeds fixed beforehand.

mod chemistry_cases;
use chemistry_cases::*;
use gillesph::chemistry::split::Frozen;
use gillesph::chemistry::ssa::{EventMethod, System, TauLeaping};
use gillesph::chemistry::{Links, Reactor};

fn frozen(reactor: &Reactor, volumes: &[f64], links: &Links) -> Frozen {
    let groups = vec![0; volumes.len()];
    Frozen::build(reactor, links, volumes, &groups, &groups, &[]).unwrap()
}

/// Birth at 1000 and death at 1: Poisson of mean 1000 (1 - e^-t) from nothing. 4000 runs: standard error of the
/// mean 0.5, of the variance 22; five of them, and a bias of 1 % of the mean and ε of the variance, are allowed.
#[test]
fn birth_and_death() {
    let reactor = discrete(&[("X", 0.0)], &[(&[], &[(0, 1)], 1000.0), (&[(0, 1)], &[], 1.0)]);
    let still = frozen(&reactor, &[UNIT], &Links::none(1));
    let system = System::new(&reactor, &still);
    let mut seen = [Vec::new(), Vec::new()];
    for run in 0..4000 {
        let mut method = TauLeaping::new(&system, vec![0.0], 0.03, (1, run)).unwrap();
        for (x, time) in seen.iter_mut().zip([1.0, 8.0]) {
            method.advance(time).unwrap();
            assert_eq!(method.time(), time);
            x.push(method.amounts()[0]);
        }
    }
    for (x, time) in seen.iter().zip([1.0_f64, 8.0]) {
        let mu = 1000.0 * (1.0 - (-time).exp());
        let (m, v) = (mean(x), variance(x));
        assert!((m - mu).abs() < 0.01 * mu + 5.0 * 0.5, "mean {m} for {mu} at {time}");
        assert!((v - mu).abs() < 0.06 * mu + 5.0 * 22.4, "variance {v} for {mu} at {time}");
    }
}

/// Relaxation of 2 A <-> B from 10 000 A, whose mean lags by the leap: the error falls with the tolerance. The rate
/// equation dA/dt = -2 k A (A-1)/V + 2 k' B is the reference; the spread of A (about 60) over 400 runs gives a
/// standard error of 3.
#[test]
fn smaller_tolerance_is_closer() {
    let reactor =
        discrete(&[("A", 0.0), ("B", 0.0)], &[(&[(0, 2)], &[(1, 1)], 1e-4), (&[(1, 1)], &[(0, 2)], 1.0)]);
    let still = frozen(&reactor, &[UNIT], &Links::none(1));
    let system = System::new(&reactor, &still);
    let (mut a, steps) = (10_000.0_f64, 100_000);
    let rate = |a: f64| -2.0 * 1e-4 * a * (a - 1.0) + 2.0 * (10_000.0 - a) / 2.0;
    for _ in 0..steps {
        let h = 0.2 / f64::from(steps);
        let middle = a + 0.5 * h * rate(a);
        a += h * rate(middle);
    }
    let errors: Vec<f64> = [0.3, 0.1, 0.01]
        .into_iter()
        .map(|tolerance| {
            let x: Vec<f64> = (0..400)
                .map(|run| {
                    let mut method =
                        TauLeaping::new(&system, vec![10_000.0, 0.0], tolerance, (2, run)).unwrap();
                    method.advance(0.2).unwrap();
                    assert_eq!(method.amounts()[0] + 2.0 * method.amounts()[1], 10_000.0);
                    method.amounts()[0]
                })
                .collect();
            (mean(&x) - a).abs()
        })
        .collect();
    // Euler steps of a decay overshoot by a share of the tolerance; 15 is five standard errors.
    assert!(errors[0] > 2.0 * errors[1] - 15.0 && errors[2] < 0.002 * a + 15.0, "{errors:?}");
    assert!(errors[0] > 100.0, "a coarse leap should show: {errors:?}");
}

/// Fast annihilation of scarce and plentiful species with a slow feed, and hops between two volumes: counts stay
/// whole and never below zero, and the difference A - B changes by the feed alone.
#[test]
fn never_below_zero() {
    let reactor = discrete(
        &[("A", 5.0), ("B", 1.0)],
        &[
            (&[(0, 1), (1, 1)], &[], 50.0),
            (&[], &[(0, 1)], 400.0),
            (&[], &[(1, 1)], 390.0),
            (&[(0, 2)], &[(1, 2)], 3.0),
        ],
    );
    let still = frozen(&reactor, &[UNIT, 0.3 * UNIT], &Links::from_pairs(2, &[(0, 1, UNIT)]));
    let system = System::new(&reactor, &still);
    for run in 0..200 {
        let mut method = TauLeaping::new(&system, vec![900.0, 30.0, 2.0, 700.0], 0.1, (3, run)).unwrap();
        for k in 1..=20 {
            method.advance(0.1 * f64::from(k)).unwrap();
            assert!(method.amounts().iter().all(|n| *n >= 0.0 && n.fract() == 0.0), "{:?}", method.amounts());
        }
        let fired = &method.ledger().fired;
        let total: f64 = [0, 2].iter().map(|&slot| method.amounts()[slot]).sum();
        assert_eq!(total, 902.0 - fired[0] as f64 + fired[1] as f64 - 2.0 * fired[3] as f64);
    }
}

/// A monostable Schlögl system (one stable state near 565): mean and variance of 400 runs against the exact
/// stationary distribution, p(x+1)/p(x) = birth(x)/death(x+1).
#[test]
fn monostable_schloegl() {
    // a1 = 0.03/2 x(x-1), a2 = 1e-4/6 x(x-1)(x-2), a3 = 800, a4 = 3.5 x in a unit volume.
    let reactor = discrete(
        &[("X", 0.0)],
        &[
            (&[(0, 2)], &[(0, 3)], 0.015),
            (&[(0, 3)], &[(0, 2)], 1e-4 / 6.0),
            (&[], &[(0, 1)], 800.0),
            (&[(0, 1)], &[], 3.5),
        ],
    );
    let still = frozen(&reactor, &[UNIT], &Links::none(1));
    let system = System::new(&reactor, &still);
    let up = |x: f64| 0.015 * x * (x - 1.0) + 800.0;
    let down = |x: f64| 1e-4 / 6.0 * x * (x - 1.0) * (x - 2.0) + 3.5 * x;
    let mut log = vec![0.0_f64];
    for x in 0..3000 {
        let x = f64::from(x);
        log.push(log[log.len() - 1] + (up(x) / down(x + 1.0)).ln());
    }
    let top = log.iter().copied().fold(f64::MIN, f64::max);
    let weight: Vec<f64> = log.iter().map(|l| (l - top).exp()).collect();
    let norm: f64 = weight.iter().sum();
    let moment =
        |f: &dyn Fn(f64) -> f64| weight.iter().enumerate().map(|(x, w)| w * f(x as f64)).sum::<f64>() / norm;
    let mu = moment(&|x| x);
    let var = moment(&|x| (x - mu) * (x - mu));
    let x: Vec<f64> = (0..400)
        .map(|run| {
            let mut method = TauLeaping::new(&system, vec![mu.round()], 0.03, (4, run)).unwrap();
            method.advance(5.0).unwrap();
            method.amounts()[0]
        })
        .collect();
    // Standard errors: of the mean sd/20, of the variance a share sqrt(2/400) = 0.07; five of each.
    assert!((mean(&x) - mu).abs() < 0.01 * mu + 5.0 * var.sqrt() / 20.0, "{} for {mu}", mean(&x));
    assert!((variance(&x) / var - 1.0).abs() < 0.05 + 5.0 * 0.0707, "{} for {var}", variance(&x));
}
