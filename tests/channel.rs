//! Physics of a small, coarse channel: water pumped past a disc that carries receptors.
//!
//! All realizations share one flow, so hundreds of them cost little. Means are compared within 4 standard
//! errors, variances within 4.5; about 40 quantities in all, a false alarm has a chance below 4e-3; seeds
//! fixed beforehand.

#[path = "chemistry_cases/mod.rs"]
mod cases;
mod face;

use cases::{mean, variance};
use face::{Bench, amounts, channel, channel_with, record};
use gillesph::tables::{SeriesTable, read_probes, read_series};
use rstest::rstest;

const RUNS: u32 = 400;
const MEAN_LIMIT: f64 = 4.0;
const VARIANCE_LIMIT: f64 = 4.5;
/// One step for both: the splitting errs alike in both then. (Continuous at its own choice of 200 µs has 0.1 %
/// less ligand, which a sponge renewed every 200 µs lets in; seven standard errors.)
const DISCRETE: &str = "{ representation: discrete, step: 25 us }";
const CONTINUOUS: &str = "{ representation: continuous, step: 25 us }";
const TIMES: [f64; 3] = [4e-4, 6e-4, 1e-3];

fn run(realizations: u32, seed: u32) -> String {
    format!("{{ until: 1 ms, realizations: {realizations}, seed: {seed} }}")
}

/// Mean within its limit of an exact one; the standard error from the sample.
fn assert_near(x: &[f64], mu: f64, what: &str) {
    let z = (mean(x) - mu) / (variance(x) / x.len() as f64).sqrt();
    assert!(z.abs() <= MEAN_LIMIT, "{what}: {} against {mu}, {z:.2} standard errors", mean(x));
}

/// Two samples of one distribution: means, and variances with the standard error of near-normal numbers,
/// sqrt(2 / (n - 1)) of each.
fn assert_alike(x: &[f64], y: &[f64], what: &str) {
    let n = x.len() as f64;
    let (vx, vy) = (variance(x), variance(y));
    let z = (mean(x) - mean(y)) / ((vx + vy) / n).sqrt();
    assert!(z.abs() <= MEAN_LIMIT, "{what}: means {} and {}, {z:.2} standard errors", mean(x), mean(y));
    let z = (vx / vy).ln() / (4.0 / (n - 1.0)).sqrt();
    assert!(z.abs() <= VARIANCE_LIMIT, "{what}: variances {vx} and {vy}, {z:.2} standard errors");
}

/// Fano factor 1: for Poisson numbers of mean mu the variance has the standard error
/// mu sqrt(2/(n-1) + 1/(n mu)).
fn assert_poisson(x: &[f64], what: &str) {
    let (n, mu) = (x.len() as f64, mean(x));
    let fano = variance(x) / mu;
    let z = (fano - 1.0) / (2.0 / (n - 1.0) + 1.0 / (n * mu)).sqrt();
    assert!(z.abs() <= VARIANCE_LIMIT, "{what}: Fano factor {fano}, {z:.2} standard errors");
}

/// Nothing is lost, nothing passes a wall, every receptor is free or bound, the mean is the continuous model's.
#[test]
fn binding_in_a_flow() {
    let bench = Bench::new();
    let text = channel(DISCRETE, &run(RUNS, 1));
    let dir = bench.run(&bench.model("discrete.yaml", &text), "discrete", &[]);
    let health = &record(&dir)["health"];
    assert_eq!(health["penetrations"], 0, "{health}");
    assert_eq!(health["molecules_created_or_lost"], 0.0, "{health}");
    let law = health["conservation"].as_array().unwrap().iter().find(|law| law["exempt"] == "").unwrap();
    assert_eq!((&law["sum"], &law["largest_deviation"]), (&"R + RL".into(), &0.0.into()), "{health}");

    let series = read_series(&dir).unwrap();
    let receptors = amounts(&series, "membrane", "R", 0.0);
    for &time in &series.times {
        let [free, bound] = ["R", "RL"].map(|s| amounts(&series, "all", s, time));
        let ligand = amounts(&series, "all", "L", time);
        for r in 0..RUNS as usize {
            assert!(free[r] + bound[r] == receptors[r] && receptors[r] == receptors[0]);
            assert!(ligand[r].fract() == 0.0 && bound[r].fract() == 0.0 && bound[r] >= 0.0);
        }
    }

    let text = channel(CONTINUOUS, &run(1, 1));
    let exact = bench.series(&text, &[]);
    for time in TIMES {
        for (group, species) in [("membrane", "RL"), ("medium", "L"), ("membrane", "L")] {
            let mu = amounts(&exact, group, species, time)[0];
            let x = amounts(&series, group, species, time);
            assert_near(&x, mu, &format!("{species} in {group} at {time}"));
        }
    }
    let bound = amounts(&series, "membrane", "RL", 1e-3);
    assert!(mean(&bound) > 0.02 * receptors[0], "nothing binds: {}", mean(&bound));
    // Molecules that bind and part with a ligand that is plenty: no more spread than Poisson.
    assert!(variance(&bound) < mean(&bound) * (1.0 + VARIANCE_LIMIT * (2.0 / 399.0_f64).sqrt()));

    // The mean occupancy round the disc is that of its receptors.
    let rows = read_probes(&dir).unwrap();
    let occupancy =
        rows.iter().find(|r| r.probe == "ring" && r.quantity.contains("occupancy") && r.time == 1e-3);
    let occupancy = occupancy.unwrap();
    let round = mean(&occupancy.value);
    assert!((round - bound[0] / receptors[0]).abs() < 0.03, "{round}");
}

fn with_reactions(bench: &Bench, reactions: &str, seed: u32) -> SeriesTable {
    bench.series(&channel_with(DISCRETE, &run(RUNS, seed), reactions, "membrane: { R: 1 uM }"), &[])
}

/// Mass action and the same rates written as laws, in concentrations and in counts, each against the other.
#[rstest]
#[case(
    "kinetics: concentration
  reactions:
    binding: { equation: R + L <-> RL, rate: 500 /uM/s, reverse: 500 1/s }",
    "kinetics: concentration
  parameters: { k_on: 500 /uM/s, k_off: 500 1/s }
  reactions:
    bind: { equation: R + L -> RL, law: \"k_on * R * L\" }
    part: { equation: RL -> R + L, law: \"k_off * RL\" }"
)]
#[case(
    "kinetics: molecules
  reactions:
    binding: { equation: R + L <-> RL, rate: 2 1/s, reverse: 500 1/s }",
    "kinetics: molecules
  parameters: { c_on: 2 1/s, c_off: 500 1/s }
  reactions:
    bind: { equation: R + L -> RL, law: \"c_on * R * L\" }
    part: { equation: RL -> R + L, law: \"c_off * RL\" }"
)]
fn laws_and_mass_action(#[case] mass_action: &str, #[case] law: &str) {
    let bench = Bench::new();
    let (a, b) = (with_reactions(&bench, mass_action, 2), with_reactions(&bench, law, 3));
    for time in TIMES {
        for (group, species) in [("membrane", "RL"), ("medium", "L")] {
            let (x, y) = (amounts(&a, group, species, time), amounts(&b, group, species, time));
            assert!(mean(&x) > 10.0);
            assert_alike(&x, &y, &format!("{species} in {group} at {time}"));
        }
    }
}

/// Ligand that flows, diffuses and is taken up by receptors that stay: a linear network from a Poisson start
/// between Poisson reservoirs, so the numbers are Poisson everywhere at all times.
#[rstest]
#[case("reactions: {}", "", 4)]
#[case("reactions: { uptake: { equation: R + L -> R, rate: 2000 /uM/s } }", "membrane: { R: 1 uM }", 5)]
fn a_linear_network_stays_poisson(#[case] reactions: &str, #[case] initial: &str, #[case] seed: u32) {
    let bench = Bench::new();
    let text = channel_with(DISCRETE, &run(RUNS, seed), reactions, initial);
    let dir = bench.run(&bench.model("linear.yaml", &text), "linear", &[]);
    assert_eq!(record(&dir)["health"]["molecules_created_or_lost"], 0.0);
    let series = read_series(&dir).unwrap();
    for time in TIMES {
        for group in ["inlet", "medium", "membrane", "all"] {
            let x = amounts(&series, group, "L", time);
            assert_poisson(&x, &format!("{reactions}: L in {group} at {time}"));
        }
    }
    // What the inlet holds is what the sponge draws towards: 1 µM in 3 x 10 x 1 µm³, give or take the
    // particles that the flow has in the zone at the moment (a column of them).
    let inlet = mean(&amounts(&series, "inlet", "L", 1e-3)) / 602.2;
    assert!((20.0..=40.0).contains(&inlet), "{inlet} particles of 1 fL");
}
