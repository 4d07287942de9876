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
#[case("next_subvolume", "next subvolume method")]
#[case("split", "Strang")]
fn named_and_recorded(#[case] name: &str, #[case] words: &str) {
    let bench = Bench::new();
    let model = bench.model("model.yaml", MODEL);
    let method = format!("chemistry.method={name}");
    let one = bench.run(&model, "one", &["--set", ONE_VOLUME, "--set", "chemistry={}", "--set", &method]);
    assert!(record(&one)["steps"]["method"].as_str().unwrap().contains(words));
}

#[rstest]
#[case(&["chemistry={ method: direct }"], "the direct method is for one volume")]
#[case(&["chemistry={ method: next_reaction }"], "the next reaction method is for one volume")]
#[case(
    &[ONE_VOLUME, "chemistry={ method: next_reaction, representation: continuous }"],
    "needs discrete species"
)]
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
