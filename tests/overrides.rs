//! Values changed with `--set`: below a reactions file, and a run cut short.

mod face;

use face::{Bench, record, shipped};
use gillesph::tables::read_series;

/// A parameter of the reactions file a model names; the mean follows it. 400 realizations of a Poisson number of
/// mean 11.5 after 1 s at twice the rate: standard error 0.17, five of them allowed (chance 6e-7).
#[test]
fn a_rate_in_a_file_of_its_own() {
    let bench = Bench::new();
    let set =
        ["--set", "reactions.parameters.k_make=2 nM/s", "--set", "run.until=1 s", "--realizations", "400"];
    let dir = bench.run(&shipped("models/birth_death.yaml"), "out", &set);
    let last = read_series(&dir).unwrap();
    let found = last.across(last.times.len() - 1, 0);
    let mean = found.iter().sum::<f64>() / found.len() as f64;
    // 2 nM/s in 10 fL is 12.04 1/s; decay 0.1 1/s.
    let exact = 12.044 / 0.1 * (1.0 - (-0.1_f64).exp());
    assert!((mean - exact).abs() < 5.0 * (exact / 400.0).sqrt(), "{mean} for {exact}");
}

/// Output times beyond an end that was moved on the command line are left out.
#[test]
fn a_run_cut_short() {
    let bench = Bench::new();
    let set = ["--set", "run.until=10 s", "--realizations", "10"];
    let dir = bench.run(&shipped("models/birth_death.yaml"), "out", &set);
    assert_eq!(record(&dir)["times"].as_array().unwrap().len(), 11);
    assert_eq!(record(&dir)["histograms"][0]["times"], serde_json::json!([5.0]));
}
