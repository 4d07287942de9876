//! Same model, seed and program: the same bytes in `tables/` for any number of threads and for blocks of an
//! ensemble joined by `merge`; another seed or another value gives other tables.

mod face;

use face::{Bench, channel};
use rstest::rstest;
use std::collections::BTreeMap;
use std::path::Path;

const WELL_MIXED: &str = "name: mixed
reactions:
  species: [A, B]
  reactions: { pair: { equation: 2 A <-> B, rate: 0.01 /nM/s, reverse: 1 1/s } }
domain: { kind: well_mixed, volume: 1 fL }
initial: { A: 100 }
run: { until: 1 s, realizations: 8, seed: 5 }
output: { every: 0.1 s, covariance: true, histogram: [ { species: B } ] }
";

const GRAPH: &str = "name: graph
reactions:
  species: { A: { diffusion: 1 um^2/s }, B: { diffusion: 2 um^2/s } }
  reactions: { turn: { equation: A <-> B, rate: 3 1/s, reverse: 1 1/s } }
domain: { kind: graph, volumes: [1 fL, 0.25 fL, 2 fL], links: [[0, 1, 0.5 um], [1, 2, 1 um]] }
initial: { A: [100, 0, 30] }
run: { until: 1 s, realizations: 8, seed: 5 }
output: { every: 0.1 s, covariance: true }
";

const SPACE: &str = "name: space
reactions:
  species: { A: { diffusion: 10 um^2/s }, B: { diffusion: 5 um^2/s } }
  parameters: { vmax: 1 uM/s, km: 100 nM }
  reactions: { enzyme: { equation: A -> B, law: \"vmax * A / (km + A)\" } }
domain: { kind: particles, dimensions: 3, min: [0, 0, 0], max: [3 um, 3 um, 3 um] }
particles: { spacing: 0.5 um, support: 1.8 }
fluid: { method: none }
initial: { A: { concentration: 100 nM, deal: poisson } }
run: { until: 20 ms, realizations: 8, seed: 5 }
output:
  every: 10 ms
  particles: { times: [0, 20 ms], realizations: 3 }
  probes: { diagonal: { line: { from: [0, 0, 0], to: [3 um, 3 um, 3 um], points: 11 } } }
";

/// One motion for all realizations.
const SOLID: &str = "name: solid
reactions:
  species: { A: { diffusion: 100 um^2/s } }
  reactions: { make: { equation: 0 <-> A, rate: 20 uM/s, reverse: 10 1/s } }
domain: { kind: particles, dimensions: 2, min: [-4 um, -10 um], max: [30 um, 14 um] }
particles: { spacing: 0.5 um, support: 2 }
groups:
  bar: { material: solid, shape: { box: { min: [-2 um, 0], max: [20 um, 4 um] } } }
solids:
  bar:
    density: 1000 kg/m^3
    bulk_modulus: 2 kPa
    shear_modulus: 500 Pa
    velocity: [0, \"1000 s^-1 * x\"]
    clamped: { box: { min: [-2 um, 0], max: [0, 4 um] } }
initial: { bar: { A: { concentration: 2 uM, deal: poisson } } }
run: { until: 0.1 ms, realizations: 8, seed: 5 }
output:
  every: 10 us
  particles: { times: [0, 0.1 ms], realizations: 2 }
  points: { tip: { solid: bar, at: [20 um, 2 um] } }
";

fn model(name: &str) -> String {
    match name {
        "well_mixed" => WELL_MIXED.into(),
        "graph" => GRAPH.into(),
        "space" => SPACE.into(),
        "solid" => SOLID.into(),
        "softened" => SOLID.replace("    velocity", "    softening: { by: A, factor: 0.2, at: 2 uM }\n    velocity"),
        "events" => SPACE.replace("fluid:", "chemistry: { method: composition_rejection }\nfluid:"),
        "leaps" => GRAPH.replace("domain:", "chemistry: { method: tau_leaping }\ndomain:"),
        "hybrid" => GRAPH
            .replace("domain:", "chemistry: { representation: hybrid, hybrid: { above: 40, below: 20 } }\ndomain:"),
        "surfaces" => SPACE.replace("fluid:", "conditions: { in: { flux: { in: x_min, species: { A: 1e3 /um^2/s } } }, out: { absorbing: { in: x_max, species: { A: perfect, B: 10 um/s } } } }\nfluid:"),
        "hybrid_channel" => channel(
            "{ representation: hybrid, hybrid: { above: 450, below: 250 } }",
            "{ until: 0.4 ms, realizations: 8, seed: 5 }",
        ),
        _ => channel("{ representation: discrete }", "{ until: 0.4 ms, realizations: 8, seed: 5 }"),
    }
}

/// Every file below `tables/` by its path.
fn tables(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    fn collect(folder: &Path, root: &Path, found: &mut BTreeMap<String, Vec<u8>>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, root, found);
            } else {
                let name = path.strip_prefix(root).unwrap().display().to_string();
                found.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    let mut found = BTreeMap::new();
    collect(&dir.join("tables"), dir, &mut found);
    found
}

/// Says which file differs, not its bytes.
fn assert_same(a: &Path, b: &Path, what: &str) {
    let (a, b) = (tables(a), tables(b));
    assert!(a.len() >= 2 && a.keys().eq(b.keys()), "{what}: {:?} against {:?}", a.keys(), b.keys());
    for (name, bytes) in &a {
        assert!(*bytes == b[name], "{what}: {name} differs");
    }
}

#[rstest]
fn any_number_of_threads(
    #[values(
        "well_mixed",
        "graph",
        "space",
        "channel",
        "events",
        "leaps",
        "hybrid",
        "surfaces",
        "hybrid_channel",
        "solid",
        "softened"
    )]
    name: &str,
) {
    let bench = Bench::new();
    let model = bench.model("model.yaml", &model(name));
    let one = bench.run(&model, "1", &["--threads", "1"]);
    for threads in ["2", "3"] {
        let more = bench.run(&model, threads, &["--threads", threads]);
        assert_same(&one, &more, &format!("{name}, {threads} threads"));
    }
}

#[rstest]
fn blocks_joined(
    #[values(
        "well_mixed",
        "graph",
        "space",
        "channel",
        "events",
        "leaps",
        "hybrid",
        "surfaces",
        "hybrid_channel",
        "solid",
        "softened"
    )]
    name: &str,
) {
    let bench = Bench::new();
    let model = bench.model("model.yaml", &model(name));
    let whole = bench.run(&model, "whole", &[]);
    let first = bench.run(&model, "first", &["--realizations", "0..3"]);
    let second = bench.run(&model, "second", &["--realizations", "3..8"]);
    let [first, second] = [&first, &second].map(|p| p.to_str().unwrap());
    for (out, parts) in [("a", [first, second]), ("b", [second, first])] {
        let dir = bench.path(out);
        face::gillesph(&["merge", dir.to_str().unwrap(), parts[0], parts[1]]);
        assert_same(&whole, &dir, &format!("{name}, merged as {out}"));
        let record = face::record(&dir);
        assert_eq!(record["realizations"], serde_json::json!([0, 8]), "{name}");
        let events = &record["performance"]["reaction_events"];
        assert_eq!(*events, face::record(&whole)["performance"]["reaction_events"], "{name}");
        assert!(dir.join("report.html").exists());
    }
}

#[rstest]
fn another_seed_or_value_gives_other_tables(#[values("well_mixed", "graph", "space", "channel")] name: &str) {
    let bench = Bench::new();
    let model = bench.model("model.yaml", &model(name));
    let base = bench.run(&model, "base", &["--seed", "5"]);
    assert_same(&base, &bench.run(&model, "again", &["--seed", "5"]), name);
    let series = "tables/series.parquet";
    let species = if name == "channel" { "initial.membrane.R=2 uM" } else { "initial.A=7" };
    for (out, options) in [
        ("seed", vec!["--seed", "6"]),
        ("set_seed", vec!["--set", "run.seed=6"]),
        ("set", vec!["--set", if name == "graph" { "initial.A=[1, 2, 3]" } else { species }]),
    ] {
        let other = bench.run(&model, out, &options);
        assert!(tables(&base)[series] != tables(&other)[series], "{name}: {options:?} changed nothing");
    }
    assert_same(&bench.path("seed"), &bench.path("set_seed"), &format!("{name}: both ways to a seed"));
}

/// A realization is the same alone as within its ensemble.
#[test]
fn a_realization_stands_for_itself() {
    let bench = Bench::new();
    let model = bench.model("model.yaml", &model("space"));
    let whole = tables(&bench.run(&model, "whole", &[]));
    let third = tables(&bench.run(&model, "third", &["--realizations", "2..3"]));
    let file = "tables/particles/realization=0002/part-00000.parquet";
    assert!(whole[file] == third[file]);
}
