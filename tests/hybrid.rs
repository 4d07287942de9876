//! Species that are discrete and continuous side by side, and hybrid ones, through the whole program.

mod face;

use face::{Bench, amounts, record};
use gillesph::tables::{list_particles, read_particles};

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

fn variance(x: &[f64]) -> f64 {
    let m = mean(x);
    x.iter().map(|v| (v - m) * (v - m)).sum::<f64>() / (x.len() - 1) as f64
}

/// C decays at 1/s from 40 molecules, a real amount; each makes D at 2/s, whole molecules. The hazard of D is
/// 80 e^{-t}, so D is Poisson of mean 80 (1 - e^{-3}), whatever the step: here one step of 3 s, in which C falls
/// by a factor of 20. 4000 realizations; mean and variance within 4 standard errors (chance 1.3e-4).
#[test]
fn events_follow_a_continuous_amount_within_a_step() {
    let bench = Bench::new();
    let text = "name: follow
reactions:
  kinetics: molecules
  species: { C: { representation: continuous }, D: { representation: discrete } }
  reactions:
    decay: { equation: C -> 0, rate: 1 1/s }
    make:  { equation: C -> C + D, rate: 2 1/s }
domain: { kind: well_mixed, volume: 1 fL }
initial: { C: 40 }
chemistry: { step: 3 s }
run: { until: 3 s, realizations: 4000, seed: 17 }
output: { times: [3 s] }
";
    let series = bench.series(text, &[]);
    let seen = amounts(&series, "all", "D", 3.0);
    let mu = 80.0 * (1.0 - (-3.0_f64).exp());
    let n = seen.len() as f64;
    assert!((mean(&seen) - mu).abs() < 4.0 * (mu / n).sqrt(), "{} against {mu}", mean(&seen));
    // Fourth central moment of a Poisson number: mu + 3 mu².
    let spread = ((mu + 2.0 * mu * mu) / n).sqrt();
    assert!((variance(&seen) - mu).abs() < 4.0 * spread, "{} against {mu}", variance(&seen));
}

/// Whole molecules taken out of a real amount: C + D -> E from 100.5 and 40. C + E and D + E keep their values to
/// rounding, and C ends at 60.5.
#[test]
fn events_take_whole_molecules_out_of_a_continuous_amount() {
    let bench = Bench::new();
    let text = "name: take
reactions:
  kinetics: molecules
  species: { C: { representation: continuous }, D: {}, E: {} }
  reactions:
    bind: { equation: C + D -> E, rate: 0.1 1/s }
domain: { kind: well_mixed, volume: 1 fL }
initial: { C: 100, D: 40 }
run: { until: 20 s, realizations: 50, seed: 3 }
output: { times: [0.05 s, 20 s] }
";
    let series = bench.series(text, &[]);
    for t in [0.05, 20.0] {
        let of = |species| amounts(&series, "all", species, t);
        for ((c, d), e) in of("C").iter().zip(of("D")).zip(of("E")) {
            assert!((c + e - 100.0).abs() < 1e-12 && d + e == 40.0, "{c} {d} {e}");
        }
    }
    assert!(amounts(&series, "all", "E", 20.0).iter().all(|&e| e == 40.0));
}

/// 1000 molecules that start in one of ten voxels and spread; continuous from 300, discrete below 150.
fn spreading(representation: &str, runs: u32) -> String {
    format!(
        "name: spreading
reactions: {{ species: {{ A: {{ diffusion: 10 um^2/s }} }}, reactions: {{}} }}
domain: {{ kind: particles, dimensions: 1, min: [0], max: [10 um] }}
particles: {{ spacing: 1 um, support: 2.4 }}
initial: {{ A: {{ molecules: 1000, at: [0.5 um] }} }}
chemistry: {{ representation: {representation}, step: 20 ms, hybrid: {{ above: 300, below: 150 }} }}
run: {{ until: 20 s, realizations: {runs}, seed: 29 }}
output: {{ times: [0.1 s, 0.3 s, 20 s], particles: {{ times: [0.1 s, 0.3 s, 20 s], realizations: {runs} }} }}
"
    )
}

/// The total stays 1000 while voxels change over, amounts are whole again where all are discrete, and the mean is
/// that of the linear operator: 300 realizations, 10 voxels and two times within 4.7 standard errors (chance 5e-5).
#[test]
fn a_hybrid_species_keeps_its_total_and_its_mean() {
    let bench = Bench::new();
    let profiles = |text: &str, out: &str| -> Vec<Vec<Vec<f64>>> {
        let dir = bench.run(&bench.model(&format!("{out}.yaml"), text), out, &[]);
        list_particles(&dir)
            .into_iter()
            .map(|(_, _, path)| {
                let frames = read_particles(&path).unwrap().1;
                frames
                    .into_iter()
                    .map(|frame| {
                        let mut by_place = vec![0.0; 10];
                        for i in 0..frame.len() {
                            by_place[(frame.position[i][0] * 1e6) as usize] = frame.amounts[0][i];
                        }
                        by_place
                    })
                    .collect()
            })
            .collect()
    };
    let exact = &profiles(&spreading("continuous", 1), "continuous")[0];
    let hybrid = profiles(&spreading("hybrid", 300), "hybrid");
    for run in &hybrid {
        for frame in run {
            assert!((frame.iter().sum::<f64>() - 1000.0).abs() < 1e-6, "{frame:?}");
            assert!(frame.iter().all(|&n| n >= 0.0), "{frame:?}");
        }
        // 100 in each voxel at the end: all discrete.
        assert!(run[2].iter().all(|&n| n.fract() == 0.0), "{:?}", run[2]);
    }
    for (time, expected) in exact.iter().enumerate().take(2) {
        for (voxel, mu) in expected.iter().enumerate() {
            let seen: Vec<f64> = hybrid.iter().map(|run| run[time][voxel]).collect();
            // Rare molecules are Poisson; a voxel that stays continuous has almost no spread.
            let spread = variance(&seen).max(mu.min(1.0));
            let error = (spread / seen.len() as f64).sqrt();
            assert!((mean(&seen) - mu).abs() < 4.7 * error, "{time} {voxel}: {} against {mu}", mean(&seen));
        }
    }
    let run = record(&bench.path("hybrid"));
    assert_eq!(run["health"]["molecules_created_or_lost"], 0.0);
    let told = &run["hybrid"][0];
    assert_eq!(told["species"], "A");
    // The first voxel changes up once in each realization, and every one that did comes down again.
    assert!(told["to_continuous"].as_u64().unwrap() >= 300);
    assert_eq!(told["to_continuous"], told["to_discrete"]);
}

/// Where no voxel ever holds enough, a hybrid species is a discrete one to the bit.
#[test]
fn a_hybrid_species_that_stays_few_is_discrete() {
    let bench = Bench::new();
    let text = spreading("hybrid", 20).replace("above: 300, below: 150", "above: 2000");
    let hybrid = bench.series(&text, &[]);
    let discrete = bench.series(&spreading("discrete", 20), &[]);
    assert_eq!(hybrid.blocks, discrete.blocks);
}

/// A <-> B and 2 B <-> C with all of them hybrid, starting from A alone: while species change over one after the
/// other, A + B + 2 C keeps its value to rounding in every realization, and the mean follows the rate equations
/// (first order in A and B; C few). 200 realizations; 4 standard errors and 1 % for the missing correlations.
#[test]
fn conserved_sums_survive_the_change() {
    let bench = Bench::new();
    let text = |representation: &str, runs: u32| {
        format!(
            "name: change
reactions:
  kinetics: molecules
  species: [A, B, C]
  reactions:
    turn: {{ equation: A <-> B, rate: 1 1/s, reverse: 0.5 1/s }}
    pair: {{ equation: 2 B <-> C, rate: 1e-3 1/s, reverse: 2 1/s }}
domain: {{ kind: well_mixed, volume: 1 fL }}
initial: {{ A: 900 }}
chemistry: {{ representation: {representation}, step: 50 ms, hybrid: {{ above: 400, below: 200 }} }}
run: {{ until: 6 s, realizations: {runs}, seed: 8 }}
output: {{ every: 0.5 s }}
"
        )
    };
    let hybrid = bench.series(&text("hybrid", 200), &[]);
    let (a, b, c) = (0.5_f64..=6.0, "B", "C");
    let mut t = *a.start();
    while t <= *a.end() {
        let of = |species| amounts(&hybrid, "all", species, t);
        for ((a, b), c) in of("A").iter().zip(of(b)).zip(of(c)) {
            assert!((a + b + 2.0 * c - 900.0).abs() < 1e-6, "{t}: {a} {b} {c}");
        }
        t += 0.5;
    }
    let exact = bench.series(&text("discrete", 200), &[]);
    for species in ["A", "B", "C"] {
        let (seen, expected) = (amounts(&hybrid, "all", species, 6.0), amounts(&exact, "all", species, 6.0));
        let error = ((variance(&seen) + variance(&expected)) / 200.0).sqrt();
        let off = (mean(&seen) - mean(&expected)).abs();
        assert!(off < 4.0 * error + 0.01 * mean(&expected), "{species}: {} {}", mean(&seen), mean(&expected));
    }
}

/// Ligand carried as a hybrid species past receptors in a moving fluid: R + RL is constant to the molecule, and the
/// books of the ligand, with a sponge, close.
#[test]
fn hybrid_ligand_on_a_flow() {
    let bench = Bench::new();
    let chemistry = "{ hybrid: { above: 450, below: 250 } }";
    let text = face::channel(chemistry, "{ until: 0.6 ms, realizations: 3, seed: 4 }")
        .replace("L:  { diffusion: 347 um^2/s }", "L:  { diffusion: 347 um^2/s, representation: hybrid }");
    let dir = bench.run(&bench.model("channel.yaml", &text), "channel", &[]);
    let run = record(&dir);
    assert_eq!(run["health"]["molecules_created_or_lost"], 0.0);
    let sums = run["health"]["conservation"].as_array().unwrap();
    let receptors = sums.iter().find(|sum| sum["sum"] == "R + RL").unwrap();
    assert_eq!(receptors["largest_deviation"], 0.0);
    assert!(run["hybrid"].as_array().unwrap().iter().any(|h| h["to_continuous"].as_u64() > Some(0)));
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(page.contains("Hybrid species") && page.contains("hybrid"));
}

/// A held real amount of a third of a molecule still binds: an event takes nothing from a reservoir. R binds at
/// 0.3 per receptor and s, so that 50 (1 - e^{-0.6}) of 50 are bound after 2 s; 400 realizations, binomial,
/// 4 standard errors (chance 6e-5).
#[test]
fn a_held_amount_below_one_molecule_acts() {
    let bench = Bench::new();
    let text = "name: held
reactions:
  kinetics: molecules
  species: { L: { representation: continuous }, R: {}, RL: {} }
  reactions:
    bind: { equation: R + L -> RL, rate: 1 1/s }
domain: { kind: particles, dimensions: 1, min: [0], max: [1 um] }
particles: { spacing: 1 um, support: 1.2 }
conditions: { bath: { held: { in: medium, species: { L: 0.498161618 nM } } } }
initial: { R: 50 }
run: { until: 2 s, realizations: 400, seed: 12 }
output: { times: [2 s] }
";
    let series = bench.series(text, &[]);
    let level = amounts(&series, "all", "L", 2.0)[0];
    assert!((level - 0.3).abs() < 1e-6, "{level}");
    let bound = amounts(&series, "all", "RL", 2.0);
    let p = 1.0 - (-0.6_f64).exp();
    let error = (50.0 * p * (1.0 - p) / 400.0).sqrt();
    assert!((mean(&bound) - 50.0 * p).abs() < 4.0 * error, "{} against {}", mean(&bound), 50.0 * p);
}

/// Laws of a held Poisson number act by their mean over its numbers, by every method: A -> B at 4 A per s with
/// mean 0.48 (B = 3.85 after 2 s), and at 4 A/(A + 1) with mean 3 (E = 0.68337, B = 5.467). 2000 realizations,
/// 4.5 standard errors of a Poisson number (ten cases: a false alarm has the chance 7e-5); the split method deals
/// anew with each of its steps, so its numbers are a little more spread.
#[rstest::rstest]
fn laws_of_a_held_number(
    #[values("split", "direct", "next_reaction", "next_subvolume", "composition_rejection")] method: &str,
    #[values(("4 s^-1 * A", 0.8, 3.854), ("4 s^-1 * A / (A + 1)", 4.9816161, 5.467))] case: (&str, f64, f64),
) {
    let (law, nanomolar, expected) = case;
    let bench = Bench::new();
    let text = format!(
        "name: dealt
reactions:
  kinetics: molecules
  species: [A, B]
  reactions: {{ make: {{ equation: A -> B, law: \"{law}\" }} }}
domain: {{ kind: particles, dimensions: 1, min: [0], max: [1 um] }}
particles: {{ spacing: 1 um, support: 1.2 }}
conditions: {{ bath: {{ held: {{ in: medium, species: {{ A: {nanomolar} nM }}, deal: poisson }} }} }}
chemistry: {{ method: {method}{} }}
run: {{ until: 2 s, realizations: 2000, seed: 33 }}
output: {{ times: [2 s] }}
",
        if method == "split" { ", step: 10 ms" } else { "" }
    );
    let made = amounts(&bench.series(&text, &[]), "all", "B", 2.0);
    let error = (expected * 1.05 / 2000.0_f64).sqrt();
    assert!((mean(&made) - expected).abs() < 4.5 * error, "{} against {expected}", mean(&made));
}
