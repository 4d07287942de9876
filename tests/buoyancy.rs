//! Buoyancy: second order in the chemistry step, momentum booked, realizations on flows of their own.

mod face;

use face::{Bench, record};
use gillesph::tables::read_probes;
use std::path::Path;

/// A periodic box filled with a decaying solute of 1 mM; it falls freely by g = 10 m/s² along y, less buoyancy.
fn falling(species: &str, chemistry: &str, run: &str, initial: &str) -> String {
    format!(
        "name: falling
reactions: {{ species: {{ A: {species} }}, reactions: {{ decay: {{ equation: A -> 0, rate: 100 1/s }} }} }}
domain: {{ kind: particles, dimensions: 2, min: [0, 0], max: [1 mm, 1 mm], boundaries: {{ x: periodic, y: periodic }} }}
particles: {{ spacing: 0.1 mm, support: 2.6 }}
fluid: {{ density: 1000 kg/m^3, viscosity: 10 mPa s, speed: 0.2 m/s }}
conditions:
  weight: {{ force: {{ acceleration: [0, -10 m/s^2] }} }}
  lift: {{ buoyancy: {{ species: {{ A: {{ expansion: 0.5 m^3/mol, reference: 0.2 mol/m^3 }} }}, gravity: [0, -10 m/s^2] }} }}
initial: {{ A: {initial} }}
chemistry: {{ {chemistry} }}
run: {{ until: 10 ms, {run} }}
output: {{ times: [10 ms], probes: {{ line: {{ line: {{ from: [0, 0.5 mm], to: [1 mm, 0.5 mm], points: 5 }} }} }} }}
"
    )
}

fn speeds(dir: &Path) -> Vec<(u32, Vec<f64>)> {
    let rows = read_probes(dir).unwrap();
    rows.into_iter().filter(|r| r.quantity == "vy").map(|r| (r.realization, r.value)).collect()
}

/// C = C0 e^{-kt}, so v = -g t + β g (C0 (1 - e^{-kt})/k - C_ref t), everywhere. The lift is that of the middle of each
/// step: error (k τ)²/24 of what the decay contributes.
#[test]
fn a_decaying_solute_lifts_to_second_order() {
    let bench = Bench::new();
    let (k, t) = (100.0_f64, 0.01);
    let exact = -10.0 * t + 0.5 * 10.0 * ((1.0 - (-k * t).exp()) / k - 0.2 * t);
    let mut errors = Vec::new();
    for step in ["2 ms", "1 ms", "0.5 ms"] {
        let text = falling(
            "{ diffusion: 1e-9 m^2/s }",
            &format!("representation: continuous, step: {step}"),
            "realizations: 2",
            "1 mM",
        );
        let dir = bench.run(&bench.model("falling.yaml", &text), "falling", &["--force"]);
        let found = speeds(&dir);
        let record = record(&dir);
        // Nothing is random: one flow serves both realizations.
        assert_eq!(record["steps"]["shared_flow"], true);
        let drift = record["health"]["momentum_drift"].as_f64().unwrap();
        assert!(drift < 1e-11, "momentum drifts by {drift:e}");
        for v in &found[0].1 {
            assert!((v - found[0].1[0]).abs() < 1e-9, "the box falls as a whole: {:?}", found[0].1);
        }
        errors.push((found[0].1[0] - exact).abs());
    }
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        println!("errors {errors:?}, order {order:.2}");
        assert!((order - 2.0).abs() < 0.1, "{errors:?}, order {order}");
    }
}

/// Counted molecules differ between realizations and so do their flows; each is the same on any number of threads and
/// in any block.
#[test]
fn each_realization_of_counted_molecules_has_its_own_flow() {
    let bench = Bench::new();
    let text = falling(
        "{ diffusion: 1e-9 m^2/s }",
        "step: 1 ms",
        "realizations: 5, seed: 4",
        "{ concentration: 1.66e-12 mol/m^3, deal: poisson }",
    )
    .replace("0.5 m^3/mol", "6e10 m^3/mol")
    .replace("0.2 mol/m^3", "0 mol/m^3")
    .replace("kind: particles,", "kind: particles, thickness: 1 mm,");
    let model = bench.model("own.yaml", &text);
    let one = bench.run(&model, "one", &["--threads", "1"]);
    let three = bench.run(&model, "three", &["--threads", "3"]);
    let last = bench.run(&model, "last", &["--realizations", "4..5"]);
    assert_eq!(record(&one)["steps"]["shared_flow"], false);
    let (a, b, c) = (speeds(&one), speeds(&three), speeds(&last));
    assert_eq!(a.len(), 5);
    assert_eq!(a, b);
    assert_eq!(a[4], c[0]);
    assert!((1..5).all(|r| a[r].1 != a[0].1), "{a:?}");
    for table in ["series", "probes", "statistics"] {
        let bytes = |dir: &Path| std::fs::read(dir.join(format!("tables/{table}.parquet"))).unwrap();
        assert!(bytes(&one) == bytes(&three), "{table}");
    }
    let steps = |dir: &Path| record(dir)["performance"]["particle_steps"].as_u64().unwrap();
    assert_eq!(steps(&one), 5 * steps(&last));
}
