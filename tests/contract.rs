//! What a run leaves and what the verbs print, for every shipped model: names and types of the columns,
//! fields of `run.json`, names of groups, whole numbers of molecules. The models are shortened by `--set`.

mod face;

use face::{Bench, gillesph, record, shipped};
use polars::prelude::{ChunkAgg, DataFrame, DataType, ParquetReader, SerReader};
use rstest::rstest;
use std::collections::BTreeSet;
use std::fs::File;
use std::path::Path;

/// A shipped model, made short.
struct Short {
    name: &'static str,
    set: &'static [&'static str],
    groups: &'static [&'static str],
    species: &'static [&'static str],
    probes: &'static [&'static str],
}

const CHANNEL_SET: &[&str] = &[
    "run.until=0.1 ms",
    "fluid.settle=0.05 ms",
    "output.every=0.05 ms",
    "output.particles={ times: [0, 0.1 ms] }",
    "output.histogram=[ { species: RL, in: membrane, times: [0.1 ms] } ]",
];
const CHANNEL_GROUPS: &[&str] = &["all", "inlet", "medium", "membrane"];
const CHANNEL_PROBES: &[&str] = &["centreline_x", "cross_0", "cross_minus", "cross_plus", "ring"];

const fn channel(name: &'static str) -> Short {
    Short {
        name,
        set: CHANNEL_SET,
        groups: CHANNEL_GROUPS,
        species: &["L", "R", "RL"],
        probes: CHANNEL_PROBES,
    }
}

const MODELS: [Short; 9] = [
    channel("pheromone_channel"),
    channel("pheromone_channel_no_slip"),
    channel("pheromone_channel_continuous"),
    channel("pheromone_nanomolar"),
    Short {
        name: "birth_death",
        set: &["run.until=5 s", "output.histogram=[ { species: X } ]"],
        groups: &["all"],
        species: &["X"],
        probes: &[],
    },
    Short {
        name: "dimerisation",
        set: &["run.until=2 s", "output.histogram=[ { species: A2 } ]"],
        groups: &["all"],
        species: &["A", "A2"],
        probes: &[],
    },
    Short {
        name: "two_compartments",
        set: &["run.until=1 s"],
        groups: &["all", "soma", "spine"],
        species: &["X"],
        probes: &[],
    },
    Short {
        name: "annihilation_front",
        set: &["run.until=0.1 s", "output.particles={ times: [0.1 s] }"],
        groups: &["all", "inner", "left", "right"],
        species: &["A", "B"],
        probes: &["profile"],
    },
    Short {
        name: "phosphorylation_gradient",
        set: &[
            "run.until=20 ms",
            "output.particles={ times: [0, 20 ms] }",
            "output.histogram=[ { species: P, in: cytosol } ]",
        ],
        groups: &["all", "cytosol", "membrane"],
        species: &["P", "S"],
        probes: &["radius"],
    },
];

fn table(path: &Path) -> DataFrame {
    let file = File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    ParquetReader::new(file).finish().unwrap()
}

/// The frame begins with these columns, of these types; it may have more.
fn assert_columns(frame: &DataFrame, expected: &[(&str, DataType)], what: &str) {
    for (name, kind) in expected {
        let column = frame.column(name).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_eq!(column.dtype(), kind, "{what}: {name}");
        assert_eq!(column.null_count(), 0, "{what}: {name}");
    }
    assert!(frame.height() > 0, "{what}");
}

fn words(frame: &DataFrame, column: &str) -> BTreeSet<String> {
    frame.column(column).unwrap().str().unwrap().iter().flatten().map(String::from).collect()
}

fn reals(frame: &DataFrame, column: &str) -> Vec<f64> {
    frame.column(column).unwrap().f64().unwrap().iter().flatten().collect()
}

fn same(found: &BTreeSet<String>, expected: &[&str]) -> bool {
    found.iter().map(String::as_str).eq(expected.iter().copied())
}

#[rstest]
fn what_a_run_leaves(#[values(0, 1, 2, 3, 4, 5, 6, 7, 8)] index: usize) {
    use DataType::{Float64, String as Text, UInt32};
    let short = &MODELS[index];
    let bench = Bench::new();
    let model = shipped(&format!("models/{}.yaml", short.name));
    let mut options = vec!["--realizations", "2", "--set", "output.covariance=true"];
    short.set.iter().for_each(|set| options.extend(["--set", set]));
    let dir = bench.run(&model, "out", &options);
    let name = short.name;
    let discrete = name != "pheromone_channel_continuous";

    let series = table(&dir.join("tables/series.parquet"));
    let expected = [
        ("realization", UInt32),
        ("time", Float64),
        ("group", Text),
        ("species", Text),
        ("amount", Float64),
        ("concentration", Float64),
    ];
    assert_columns(&series, &expected, name);
    assert_eq!(series.width(), expected.len(), "{name}");
    assert!(same(&words(&series, "group"), short.groups), "{name}: {:?}", words(&series, "group"));
    assert!(same(&words(&series, "species"), short.species), "{name}: {:?}", words(&series, "species"));
    let amounts = reals(&series, "amount");
    assert!(amounts.iter().all(|n| n.is_finite() && *n >= 0.0), "{name}");
    assert_eq!(amounts.iter().all(|n| n.fract() == 0.0), discrete, "{name}: whole numbers of molecules");
    let realizations = series.column("realization").unwrap().u32().unwrap();
    assert_eq!((realizations.min(), realizations.max()), (Some(0), Some(1)), "{name}");

    let statistics = table(&dir.join("tables/statistics.parquet"));
    assert_columns(&statistics, &[("time", Float64), ("group", Text), ("species", Text)], name);
    assert_columns(&statistics, &[("realizations", UInt32)], name);
    for column in
        ["mean", "variance", "sd", "sem", "min", "q05", "q25", "median", "q75", "q95", "max", "fano"]
    {
        assert_eq!(statistics.column(column).unwrap().dtype(), &Float64, "{name}: {column}");
    }
    let covariance = table(&dir.join("tables/covariance.parquet"));
    assert_columns(
        &covariance,
        &[("time", Float64), ("group_a", Text), ("species_a", Text), ("group_b", Text), ("species_b", Text)],
        name,
    );
    assert_columns(&covariance, &[("covariance", Float64)], name);

    if short.probes.is_empty() {
        assert!(!dir.join("tables/probes.parquet").exists(), "{name}");
    } else {
        let probes = table(&dir.join("tables/probes.parquet"));
        assert_columns(&probes, &[("probe", Text), ("realization", UInt32), ("quantity", Text)], name);
        for column in ["time", "s", "x", "y", "z", "value"] {
            assert_columns(&probes, &[(column, Float64)], name);
        }
        assert!(same(&words(&probes, "probe"), short.probes), "{name}: {:?}", words(&probes, "probe"));
        particles(&dir, short, discrete);
    }
    run_json(&dir, short);
    for file in ["report.html", "tables/histogram.parquet"] {
        let optional = file.contains("histogram") && !short.set.iter().any(|s| s.contains("histogram"));
        assert!(optional || dir.join(file).exists(), "{name}: {file}");
    }
    let html = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(!html.contains("src=\"http") && !html.contains("src=\"figures"), "{name}: one page by itself");
    assert!(std::fs::read_dir(dir.join("figures")).unwrap().count() >= 2, "{name}");
    assert!(!dir.join("checkpoint").exists(), "{name}");
}

/// Particle tables of the first realization.
fn particles(dir: &Path, short: &Short, discrete: bool) {
    use DataType::{Float64, String as Text, UInt32};
    let name = short.name;
    let frame = table(&dir.join("tables/particles/realization=0000/part-00000.parquet"));
    assert_columns(&frame, &[("time", Float64), ("particle", UInt32), ("group", Text)], name);
    for column in ["x", "y", "z", "vx", "vy", "vz", "density", "pressure", "volume_fraction"] {
        assert_columns(&frame, &[(column, Float64)], name);
    }
    for species in short.species {
        assert_columns(&frame, &[(species, Float64)], name);
        let whole = reals(&frame, species).iter().all(|n| n.fract() == 0.0);
        assert!(whole || !discrete, "{name}: {species} in whole molecules");
    }
    let (x, volume) = (reals(&frame, "x"), reals(&frame, "volume"));
    assert!(x.iter().all(|x| x.abs() < 1e-4) && volume.iter().all(|v| *v > 0.0), "{name}: SI units");
}

fn run_json(dir: &Path, short: &Short) {
    let (record, name) = (record(dir), short.name);
    assert_eq!(record["status"], "finished", "{name}");
    assert_eq!(record["name"], name);
    assert_eq!(record["version"], env!("CARGO_PKG_VERSION"));
    assert!(record["seed"].is_u64() && record["model"]["hash"].as_str().unwrap().len() == 64, "{name}");
    let text = record["model"]["files"][0][1].as_str().unwrap();
    assert!(text.contains(&format!("name: {name}")), "{name}: the text of the model");
    assert_eq!(record["model"]["overrides"].as_array().unwrap().len(), short.set.len() + 1);
    let health = &record["health"];
    assert_eq!(health["molecules_created_or_lost"], 0.0, "{name}");
    let moving = name.starts_with("pheromone");
    assert_eq!(health["penetrations"], if moving { 0.into() } else { serde_json::Value::Null }, "{name}");
    assert_eq!(health["largest_mach"].is_number(), moving, "{name}");
    assert!(health["warnings"].is_array() && health.get("momentum_drift").is_some(), "{name}");
    let performance = &record["performance"];
    for count in
        ["particle_steps", "pair_evaluations", "reaction_events", "hops", "peak_rss_bytes", "threads"]
    {
        assert!(performance[count].is_u64(), "{name}: {count}");
    }
    for time in ["fluid_seconds", "chemistry_seconds", "wall_seconds", "cpu_seconds"] {
        assert!(performance[time].as_f64().unwrap() >= 0.0, "{name}: {time}");
    }
    assert_eq!(performance["pair_evaluations"].as_u64().unwrap() > 0, moving, "{name}");
    assert_eq!(record["steps"]["fluid"].is_object(), moving, "{name}");
    if !["birth_death", "dimerisation", "two_compartments"].contains(&name) {
        assert!(record["steps"]["chemistry"]["limited_by"].as_str().unwrap().len() > 3, "{name}");
    }
}

/// Output of a verb as text.
fn said(arguments: &[&str]) -> String {
    String::from_utf8(gillesph(arguments).stdout).unwrap()
}

#[rstest]
fn check_says_what_will_run(#[values(0, 1, 2, 3, 4, 5, 6, 7, 8)] index: usize) {
    let short = &MODELS[index];
    let text = said(&["check", shipped(&format!("models/{}.yaml", short.name)).to_str().unwrap()]);
    for word in short.species.iter().chain(short.groups.iter().filter(|g| **g != "all")) {
        assert!(text.contains(word), "{}: {word} in\n{text}", short.name);
    }
    for word in ["conservation laws", "method", "reactions", "memory"] {
        assert!(text.contains(word), "{}: {word} in\n{text}", short.name);
    }
    if short.name.starts_with("pheromone") {
        for word in ["R + RL", "fluid step", "chemistry step", "limited by"] {
            assert!(text.contains(word), "{}: {word} in\n{text}", short.name);
        }
    }
}

#[test]
fn the_factor_of_two_is_shown() {
    let text = said(&["check", shipped("models/dimerisation.yaml").to_str().unwrap()]);
    assert!(text.contains("X_A (X_A - 1), A changes by -2"), "{text}");
}

#[test]
fn network_as_text_and_pictures() {
    let mut files = 0;
    for entry in std::fs::read_dir(shipped("reactions")).unwrap() {
        let path = entry.unwrap().path();
        let path = path.to_str().unwrap();
        files += 1;
        let text = said(&["network", path]);
        for word in ["conservation", "linkage", "deficiency", "order"] {
            assert!(text.to_lowercase().contains(word), "{path}: {word} in\n{text}");
        }
        let svg = said(&["network", path, "--svg"]);
        assert!(svg.trim_start().starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{path}");
        let dot = said(&["network", path, "--dot"]);
        assert!(dot.starts_with("digraph") && dot.contains("->") && dot.trim_end().ends_with('}'), "{path}");
        assert!(said(&["check", path]).len() > 50, "{path}");
    }
    assert!(files >= 4);
}

#[rstest]
fn completions(#[values("bash", "zsh", "fish", "powershell", "elvish")] shell: &str) {
    let text = said(&["completions", shell]);
    for verb in ["check", "run", "report", "merge", "network", "validate", "realizations"] {
        assert!(text.contains(verb), "{shell}: {verb}");
    }
}

/// `--json` prints the record and nothing else.
#[test]
fn json_on_standard_output() {
    let bench = Bench::new();
    let model = shipped("models/birth_death.yaml");
    let out = bench.path("out");
    let text = said(&[
        "run",
        model.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--realizations",
        "3",
        "--json",
    ]);
    let printed: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(printed["realizations"], serde_json::json!([0, 3]));
    assert_eq!(printed["health"], record(&out)["health"]);
}
