//! Sampling methods are chosen by name; a name that does not fit the model is refused with a remedy.

mod face;

use face::{Bench, record};
use rstest::rstest;
use std::process::Command;

const MODEL: &str = "name: exchange
reactions: { species: { X: { diffusion: 1 um^2/s } }, reactions: { loss: { equation: X -> 0, rate: 1 1/s } } }
domain: { kind: graph, volumes: [1 fL, 1 fL], links: [[0, 1, 1 um]] }
initial: { X: 5 }
run: { until: 1 s, realizations: 2, seed: 1 }
output: { every: 1 s }
";
const ONE_VOLUME: &str = "domain={ kind: well_mixed, volume: 1 fL }";

#[rstest]
#[case("direct", "direct method")]
#[case("next_reaction", "next reaction method")]
#[case("composition_rejection", "composition-rejection method")]
#[case("next_subvolume", "next subvolume method")]
#[case("tau_leaping", "approximate")]
#[case("split", "Strang")]
fn named_and_recorded(#[case] name: &str, #[case] words: &str) {
    let bench = Bench::new();
    let model = bench.model("model.yaml", MODEL);
    let method = format!("chemistry.method={name}");
    let one = bench.run(&model, "one", &["--set", ONE_VOLUME, "--set", "chemistry={}", "--set", &method]);
    assert!(record(&one)["steps"]["method"].as_str().unwrap().contains(words));
}

#[rstest]
#[case(
    &[ONE_VOLUME, "chemistry={ method: next_reaction, representation: continuous }"],
    "needs discrete species"
)]
#[case(&["chemistry={ method: direct, tolerance: 0.1 }"], "a tolerance belongs to tau-leaping")]
#[case(&["chemistry={ method: tau_leaping, tolerance: 2 }"], "between 0 and 1")]
#[case(&["chemistry={ method: next_reactoin }"], "next_reaction")]
fn refused_where_it_does_not_fit(#[case] set: &[&str], #[case] words: &str) {
    let bench = Bench::new();
    let model = bench.model("model.yaml", MODEL);
    let mut program = Command::new(env!("CARGO_BIN_EXE_gillesph"));
    program.arg("run").arg(&model).arg("--out").arg(bench.path("out"));
    set.iter().for_each(|set| {
        program.args(["--set", set]);
    });
    let output = program.output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains(words), "{message}");
    assert!(output.stdout.is_empty() && !bench.path("out").exists());
}

/// Without a name the size decides: direct for a few reactions in one volume, next subvolume on a small graph,
/// composition-rejection where there are many reactions.
#[test]
fn chosen_by_size() {
    let bench = Bench::new();
    let model = bench.model("model.yaml", MODEL);
    let chosen = |name: &str, set: &[&str]| {
        let dir = bench.run(&model, name, set);
        record(&dir)["steps"]["method"].as_str().unwrap().to_string()
    };
    assert!(chosen("one", &["--set", ONE_VOLUME]).contains("direct method"));
    assert!(chosen("graph", &[]).contains("next subvolume method"));
    let many: Vec<String> =
        (0..60).map(|k| format!("r{k}: {{ equation: X -> 0, rate: {} 1/s }}", k + 1)).collect();
    let reactions = format!("reactions={{ species: [X], reactions: {{ {} }} }}", many.join(", "));
    let large = chosen("large", &["--set", ONE_VOLUME, "--set", &reactions]);
    assert!(large.contains("composition-rejection method"), "{large}");
}

/// What is approximate says so, in the record and in the report.
#[test]
fn tau_leaping_says_that_it_is_approximate() {
    let bench = Bench::new();
    let model = bench.model("model.yaml", MODEL);
    let dir = bench.run(&model, "tau", &["--set", "chemistry={ method: tau_leaping, tolerance: 0.05 }"]);
    let said = record(&dir)["steps"]["approximations"][0].as_str().unwrap().to_string();
    assert!(said.contains("tau-leaping") && said.contains("0.05"), "{said}");
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(page.contains("tau-leaping"));
}
