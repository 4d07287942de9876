//! A line between two reservoirs (Table 2.1 of the dissertation on the sSSA-SDPD hybrid) against the exact
//! solution of its master equation, through the whole program and `domain: particles`.
//!
//! Means and variances of 15 particles within 4.7 standard errors, five methods: a false alarm has the chance 4e-4.

#[path = "chemistry_cases/mod.rs"]
mod cases;
mod face;

use cases::*;
use face::Bench;
use gillesph::tables::{ParticleFrame, list_particles, read_particles};
use rstest::rstest;

const LIMIT: f64 = 4.7;

/// Diffusion from a held end of 1000 molecules to an empty one over 17 particles a distance 1/16 apart
/// (lengths in 10 µm), diffusivity 0.1, t = 1, Lucy kernel with a cut-off of 1.8 spacings, normalised so that
/// Σ_j V_j F_ij r_ij² = 1. Each end is held over two particles: then the outermost particle that counts has a
/// neighbour on both sides, as the normalisation of the reference has it.
fn dirichlet_line(chemistry: &str, realizations: u32) -> Vec<ParticleFrame> {
    let text = format!(
        "name: line\nreactions: {{ species: {{ A: {{ diffusion: 10 um^2/s }} }}, reactions: {{}} }}\n\
         domain: {{ kind: particles, dimensions: 1, min: [-0.9375 um], max: [10.9375 um] }}\n\
         particles: {{ spacing: 0.625 um, kernel: lucy, support: 1.8 }}\n\
         groups:\n  left: {{ material: wall, shape: {{ box: {{ min: [-1 um], max: [0.3 um] }} }} }}\n  \
         right: {{ material: wall, shape: {{ box: {{ min: [9.7 um], max: [11 um] }} }} }}\n  \
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

/// Amounts of the 17 nodes from left to right, without the outer held particle at either end.
fn nodes(frame: &ParticleFrame) -> Vec<f64> {
    let mut order: Vec<usize> =
        (0..frame.len()).filter(|&i| (-0.1e-6..10.1e-6).contains(&frame.position[i][0])).collect();
    order.sort_by(|&a, &b| frame.position[a][0].total_cmp(&frame.position[b][0]));
    order.into_iter().map(|i| frame.amounts[0][i]).collect()
}

/// The semi-discrete solution to rounding: diffusion alone is not split.
#[test]
fn dirichlet_line_continuous() {
    let frames = dirichlet_line("representation: continuous", 1);
    let seen = nodes(&frames[0]);
    assert_eq!(seen.len(), LINE.len());
    for (i, (n, c)) in seen.iter().zip(&LINE).enumerate() {
        assert!((n / 1000.0 - c).abs() < 1e-12, "node {i}: {n} against {}", 1000.0 * c);
    }
}

/// Independent Poisson numbers of the same means. 1000 realizations of the
/// split method, 300 of the event-driven ones; the fourth central moment is Poisson's.
#[rstest]
#[case("method: split", 1000)]
#[case("method: next_subvolume", 300)]
#[case("method: composition_rejection", 300)]
#[case("method: direct", 300)]
#[case("method: next_reaction", 300)]
fn dirichlet_line_discrete(#[case] method: &str, #[case] runs: u32) {
    let seen: Vec<Vec<f64>> = dirichlet_line(method, runs).iter().map(nodes).collect();
    for i in 1..LINE.len() - 1 {
        let mu = 1000.0 * LINE[i];
        let x: Vec<f64> = seen.iter().map(|n| n[i]).collect();
        assert_mean(&x, mu, mu, LIMIT, &format!("node {i}"));
        assert_variance(&x, mu, poisson_m4(mu), LIMIT, &format!("node {i}"));
    }
    assert!(seen.iter().all(|n| n[16] == 0.0));
}

/// Concentration over that of the reservoir at the 17 nodes at t = 1, semi-discrete scheme.
const LINE: [f64; 17] = [
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
