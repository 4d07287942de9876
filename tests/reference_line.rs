//! A line between two reservoirs (Table 2.1 of the dissertation on the sSSA-SDPD hybrid) against the exact
//! solution of its master equation, through the whole program and `domain: particles`, in the three forms of
//! the weights: softened, plain and normalised.
//!
//! Means and variances of 15 particles, in three forms and by five methods, within 4.9 standard errors: a false
//! alarm has the chance 2e-4.

#[path = "chemistry_cases/mod.rs"]
mod cases;
mod face;

use cases::*;
use face::Bench;
use gillesph::tables::{ParticleFrame, list_particles, read_particles};
use rstest::rstest;
use std::f64::consts::PI;

const LIMIT: f64 = 4.9;

/// Forms by name, with the value of Σ_j V_j F_ij r_ij² for neighbours at a spacing of 1 and a cut-off of 1.8:
/// 30 (1 - 1/1.8)² / 1.8³, softened by 1/(1 + 0.01 · 1.8²), or divided by itself.
fn forms() -> [(&'static str, f64, [f64; 17]); 3] {
    let plain = 30.0 * (1.0_f64 - 1.0 / 1.8).powi(2) / 1.8_f64.powi(3);
    [("softened", plain / 1.0324, SOFTENED), ("plain", plain, PLAIN), ("normalised", 1.0, NORMALISED)]
}

/// Diffusion from a held end of 1000 molecules to an empty one over `n` particles (lengths in 10 µm),
/// diffusivity 0.1, t = 1, Lucy kernel with a cut-off of 1.8 spacings. Each end is held over two particles: then
/// the outermost particle that counts has a neighbour on both sides, as the references have it.
fn dirichlet_line(n: usize, weights: &str, chemistry: &str, realizations: u32) -> Vec<ParticleFrame> {
    let spacing = 10.0 / (n - 1) as f64;
    let (low, high) = (-1.5 * spacing, 10.0 + 1.5 * spacing);
    let (inner, outer) = (0.5 * spacing, 10.0 - 0.5 * spacing);
    let text = format!(
        "name: line\nreactions: {{ species: {{ A: {{ diffusion: 10 um^2/s }} }}, reactions: {{}} }}\n\
         domain: {{ kind: particles, dimensions: 1, min: [{low} um], max: [{high} um] }}\n\
         particles: {{ spacing: {spacing} um, kernel: lucy, support: 1.8, weights: {weights} }}\n\
         groups:\n  left: {{ material: wall, shape: {{ box: {{ min: [-1 um], max: [{inner} um] }} }} }}\n  \
         right: {{ material: wall, shape: {{ box: {{ min: [{outer} um], max: [11 um] }} }} }}\n  \
         inner: {{ shape: everything_else }}\nfluid: {{ method: none }}\n\
         conditions:\n  \
         full: {{ held: {{ in: left, species: {{ A: {{ per_particle: 1000 }} }}, deal: poisson }} }}\n  \
         empty: {{ held: {{ in: right, species: {{ A: 0 }} }} }}\n\
         chemistry: {{ {chemistry} }}\n\
         run: {{ until: 1 s, realizations: {realizations}, seed: 71 }}\n\
         output: {{ times: [1 s], particles: {{ times: [1 s], realizations: {realizations} }} }}\n"
    );
    let bench = Bench::new();
    let dir = bench.run(&bench.model("line.yaml", &text), "out", &[]);
    let parts = list_particles(&dir);
    assert_eq!(parts.len(), realizations as usize);
    parts.iter().map(|(_, _, path)| read_particles(path).unwrap().1.remove(0)).collect()
}

/// Amounts of the nodes from left to right, without the outer held particle at either end.
fn nodes(frame: &ParticleFrame) -> Vec<f64> {
    let mut order: Vec<usize> =
        (0..frame.len()).filter(|&i| (-0.1e-6..10.1e-6).contains(&frame.position[i][0])).collect();
    order.sort_by(|&a, &b| frame.position[a][0].total_cmp(&frame.position[b][0]));
    order.into_iter().map(|i| frame.amounts[0][i]).collect()
}

/// Concentrations at the `n` nodes where neighbours exchange at 0.1 `form`/spacing²: the modes of the second
/// difference, each decaying at its own rate.
fn semi_discrete(n: usize, form: f64) -> Vec<f64> {
    let m = (n - 1) as f64;
    let mode = |k: f64, i: f64| {
        let s = (0.5 * PI * k / m).sin();
        (0.5 * PI * k / m).tan().recip() / m * (PI * k * i / m).sin() * (-0.4 * form * (m * s).powi(2)).exp()
    };
    (0..n).map(|i| 1.0 - i as f64 / m - (1..n - 1).map(|k| mode(k as f64, i as f64)).sum::<f64>()).collect()
}

/// The modes against the exact answers at hand.
#[test]
fn modes_give_the_references() {
    for (name, form, reference) in forms() {
        for (c, r) in semi_discrete(17, form).iter().zip(&reference) {
            assert!((c - r).abs() < 1e-13, "{name}: {c} against {r}");
        }
    }
}

/// The semi-discrete solution to rounding: diffusion alone is not split.
#[test]
fn dirichlet_line_continuous() {
    for (name, form, _) in forms() {
        for n in [17, 33, 65] {
            let frames = dirichlet_line(n, name, "representation: continuous", 1);
            let seen = nodes(&frames[0]);
            assert_eq!(seen.len(), n);
            for (i, (n, c)) in seen.iter().zip(semi_discrete(n, form)).enumerate() {
                assert!((n / 1000.0 - c).abs() < 1e-12, "{name}, node {i}: {n} against {}", 1000.0 * c);
            }
        }
    }
}

/// Independent Poisson numbers of the same means. 1000 realizations of the split method, 300 of the event-driven
/// ones; the fourth central moment is Poisson's.
#[rstest]
#[case("split", "softened", SOFTENED, 1000)]
#[case("split", "plain", PLAIN, 1000)]
#[case("split", "normalised", NORMALISED, 1000)]
#[case("next_subvolume", "normalised", NORMALISED, 300)]
#[case("composition_rejection", "normalised", NORMALISED, 300)]
#[case("direct", "normalised", NORMALISED, 300)]
#[case("next_reaction", "normalised", NORMALISED, 300)]
fn dirichlet_line_discrete(
    #[case] method: &str,
    #[case] weights: &str,
    #[case] reference: [f64; 17],
    #[case] runs: u32,
) {
    whole_molecules(method, weights, reference, runs);
}

fn whole_molecules(method: &str, weights: &str, reference: [f64; 17], runs: u32) {
    let chemistry = format!("method: {method}");
    let seen: Vec<Vec<f64>> = dirichlet_line(17, weights, &chemistry, runs).iter().map(nodes).collect();
    for i in 1..reference.len() - 1 {
        let mu = 1000.0 * reference[i];
        let x: Vec<f64> = seen.iter().map(|n| n[i]).collect();
        assert_mean(&x, mu, mu, LIMIT, &format!("{method}, {weights}, node {i}"));
        assert_variance(&x, mu, poisson_m4(mu), LIMIT, &format!("{method}, {weights}, node {i}"));
    }
    assert!(seen.iter().all(|n| n[16] == 0.0));
}

/// The same with ten thousand realizations of every method.
#[rstest]
#[ignore = "ten minutes"]
fn dirichlet_line_ten_thousand(
    #[values("split", "next_subvolume", "composition_rejection", "direct", "next_reaction")] method: &str,
) {
    whole_molecules(method, "normalised", NORMALISED, 10_000);
}

/// Concentration over that of the reservoir at the 17 nodes at t = 1, semi-discrete scheme
/// with normalised weights.
const NORMALISED: [f64; 17] = [
    1.0,
    0.8887519004290038,
    0.7796610360272388,
    0.6747573855787941,
    0.575828443639542,
    0.48432636973678295,
    0.401304797836714,
    0.32738866651985754,
    0.2627763024064995,
    0.20726930531975077,
    0.16032307083208033,
    0.12110936679240018,
    0.08858233867659458,
    0.061540513692240735,
    0.03867949436636421,
    0.01863267028672595,
    0.0,
];

/// The same with softened weights.
const SOFTENED: [f64; 17] = [
    1.0,
    0.8878697393546222,
    0.7779491329929065,
    0.6723155781827689,
    0.5727946902929225,
    0.4808644377865758,
    0.39759057719634106,
    0.3235968310013786,
    0.2590688512901428,
    0.20378710800426655,
    0.15718099457491713,
    0.11839499233906002,
    0.08635775467497855,
    0.059846298791720216,
    0.03753978521079071,
    0.01806018241397772,
    0.0,
];

/// The same with plain weights.
const PLAIN: [f64; 17] = [
    1.0,
    0.8896306399702683,
    0.7813670510274672,
    0.6771925677575477,
    0.5788570119661501,
    0.4877867732645493,
    0.4050229865674219,
    0.3311910821939047,
    0.2665011141695704,
    0.21077479879275407,
    0.1634926127784815,
    0.12385291683135881,
    0.09083497515954851,
    0.0632588142618484,
    0.03983682281412321,
    0.019214459506609098,
    0.0,
];
