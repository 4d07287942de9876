//! `law:` reactions: the rate equations against closed forms, the samplers against the master equation.

#[path = "chemistry_cases/mod.rs"]
mod cases;
mod face;

use cases::{assert_distribution, assert_mean, assert_variance};
use face::{Bench, amounts};
use rstest::rstest;

/// The principal branch of W exp(W) = x for x >= 0, by Newton's method.
fn lambert(x: f64) -> f64 {
    let mut w = x.ln_1p();
    for _ in 0..50 {
        let e = w.exp();
        w -= (w * e - x) / (e * (w + 1.0));
    }
    w
}

/// dS/dt = -v S / (K + S): S = K W(S_0/K exp((S_0 - v t)/K)) (Schnell & Mendoza 1997). Amounts in molecules
/// per fL, v = 60 and K = 50. The integrator errs by 1e-9 in a step relative to the amount and takes some
/// tens of steps, in one volume and in each of two that are linked and equal.
#[rstest]
#[case("{ kind: well_mixed, volume: 1 fL }", "200", 1.0)]
#[case("{ kind: graph, volumes: [1 fL, 2 fL], links: [[0, 1, 1 um]] }", "[200, 400]", 3.0)]
fn michaelis_menten_rate_equations(#[case] domain: &str, #[case] start: &str, #[case] femtolitres: f64) {
    let (v, k, start_each) = (60.0, 50.0, 200.0);
    let molar = 1e-18 * gillesph::chemistry::AVOGADRO; // molecules per fL in 1 mol/m³
    let text = format!(
        "name: michaelis_menten\nreactions:\n  species: {{ S: {{ diffusion: 1 um^2/s }}, P: {{ diffusion: 1 um^2/s }} }}\n  \
         parameters: {{ vmax: {:e} mol/m^3/s, km: {:e} mol/m^3 }}\n  kinetics: concentration\n  \
         reactions: {{ enzyme: {{ equation: S -> P, law: \"vmax * S / (km + S)\" }} }}\n\
         domain: {domain}\ninitial: {{ S: {start} }}\nchemistry: {{ representation: continuous }}\n\
         run: {{ until: 10 s, realizations: 1, seed: 1 }}\noutput: {{ every: 0.5 s }}\n",
        v / molar,
        k / molar
    );
    let series = Bench::new().series(&text, &[]);
    for &t in &series.times {
        let exact = k * lambert(start_each / k * ((start_each - v * t) / k).exp()) * femtolitres;
        let (s, p) = (amounts(&series, "all", "S", t)[0], amounts(&series, "all", "P", t)[0]);
        assert!((s - exact).abs() < 1e-6 * start_each * femtolitres, "{s} against {exact} at {t}");
        assert!((s + p - start_each * femtolitres).abs() < 1e-9 * start_each * femtolitres);
    }
}

/// dX/dt = a / (1 + (X/K)²) - b X is at rest where X (1 + (X/K)²) = a/b: with a/b = 10 K at X = 2 K.
#[test]
fn a_repressor_comes_to_rest() {
    let text = "name: repressor\nreactions:\n  species: [X]\n  parameters: { a: 100 nM/s, b: 1 1/s, K: 10 nM }\n  \
                reactions:\n    make: { equation: 0 -> X, law: \"a / (1 + (X / K)^2)\" }\n    \
                lose: { equation: X -> 0, law: b * X }\ndomain: { kind: well_mixed, volume: 1 pL }\n\
                chemistry: { representation: continuous }\nrun: { until: 40 s, realizations: 1, seed: 1 }\n\
                output: { every: 10 s }\n";
    let series = Bench::new().series(text, &[]);
    let rest = 20e-6 * 1e-15 * gillesph::chemistry::AVOGADRO;
    let x = amounts(&series, "all", "X", 40.0)[0];
    assert!((x / rest - 1.0).abs() < 1e-7, "{x} against {rest}");
}

/// Chances of 0 to N molecules of S after time t where S -> P fires at rate a(n): the pure death process
/// dp_n/dt = a(n+1) p_(n+1) - a(n) p_n by the classical Runge–Kutta method in 20 000 steps (error 1e-12).
fn death_process(start: usize, time: f64, rate: impl Fn(f64) -> f64) -> Vec<f64> {
    let slope = |p: &[f64]| -> Vec<f64> {
        let a = |n: usize| if n == 0 { 0.0 } else { rate(n as f64) };
        let above = |n: usize| if n < start { a(n + 1) * p[n + 1] } else { 0.0 };
        (0..=start).map(|n| above(n) - a(n) * p[n]).collect()
    };
    let shifted =
        |p: &[f64], k: &[f64], h: f64| -> Vec<f64> { p.iter().zip(k).map(|(p, k)| p + h * k).collect() };
    let mut p = vec![0.0; start + 1];
    p[start] = 1.0;
    let h = time / 20_000.0;
    for _ in 0..20_000 {
        let k1 = slope(&p);
        let k2 = slope(&shifted(&p, &k1, h / 2.0));
        let k3 = slope(&shifted(&p, &k2, h / 2.0));
        let k4 = slope(&shifted(&p, &k3, h));
        for n in 0..=start {
            p[n] += h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]);
        }
    }
    p
}

/// 20 molecules under v n / (K + n), v = 12 per s and K = 6, said in counts and in concentrations, by every
/// method. 10 000 realizations; means and variances within 4.7 standard errors (48 quantities, chance 1e-4 of
/// any false alarm), distributions at 1e-4.
#[rstest]
fn michaelis_menten_sampled(
    #[values("direct", "next_reaction", "next_subvolume", "split")] method: &str,
    #[values("molecules", "concentration")] kinetics: &str,
) {
    let molar = 1e-18 * gillesph::chemistry::AVOGADRO;
    let parameters = if kinetics == "molecules" {
        String::from("vmax: 12 1/s, km: 6")
    } else {
        format!("vmax: {:e} mol/m^3/s, km: {:e} mol/m^3", 12.0 / molar, 6.0 / molar)
    };
    let text = format!(
        "name: michaelis_menten\nreactions:\n  species: [S, P]\n  parameters: {{ {parameters} }}\n  \
         kinetics: {kinetics}\n  \
         reactions: {{ enzyme: {{ equation: S -> P, law: \"vmax * S / (km + S)\" }} }}\n\
         domain: {{ kind: well_mixed, volume: 1 fL }}\ninitial: {{ S: 20 }}\n\
         chemistry: {{ method: {method} }}\n\
         run: {{ until: 3 s, realizations: 10000, seed: 81 }}\noutput: {{ times: [0.5 s, 1 s, 3 s] }}\n"
    );
    let series = Bench::new().series(&text, &[]);
    for t in [0.5, 1.0, 3.0] {
        let masses = death_process(20, t, |n| 12.0 * n / (6.0 + n));
        let moment = |about: f64, power: i32| -> f64 {
            masses.iter().enumerate().map(|(n, p)| p * (n as f64 - about).powi(power)).sum()
        };
        let mu = moment(0.0, 1);
        let what = format!("{method}, {kinetics}: S at {t}");
        let x = amounts(&series, "all", "S", t);
        assert_mean(&x, mu, moment(mu, 2), 4.7, &what);
        assert_variance(&x, moment(mu, 2), moment(mu, 4), 4.7, &what);
        assert_distribution(&x, &masses, &what);
    }
}

/// A law that falls below zero stops every method with what it saw; the rate equations do not run it backwards.
#[rstest]
#[case("{ representation: continuous }")]
#[case("{ representation: continuous, integrator: euler, step: 10 ms }")]
#[case("{ method: direct }")]
#[case("{ method: composition_rejection }")]
#[case("{ method: split }")]
fn a_law_below_zero_is_an_error(#[case] chemistry: &str) {
    let bench = Bench::new();
    let text = format!(
        "name: below\nreactions:\n  kinetics: molecules\n  species: [A, B]\n  parameters: {{ k: 1 1/s }}\n  \
         reactions:\n    turn: {{ equation: A -> B, law: k * (A - 50) }}\n    gone: {{ equation: A -> 0, rate: 0.5 1/s }}\n\
         domain: {{ kind: well_mixed, volume: 1 fL }}\ninitial: {{ A: 200 }}\nchemistry: {chemistry}\n\
         run: {{ until: 60 s, seed: 1 }}\n"
    );
    let model = bench.model("below.yaml", &text);
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_gillesph"))
        .args(["run", model.to_str().unwrap(), "--quiet", "--out", bench.path("out").to_str().unwrap()])
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for word in ["turn", "k * (A - 50)", "A = 49", "voxel 0"] {
        // A real amount is below 50 by any part of a molecule.
        let word = if word == "A = 49" && chemistry.contains("continuous") { "A = 4" } else { word };
        assert!(message.contains(word), "`{word}` is missing: {message}");
    }
}
