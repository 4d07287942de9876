//! `gillesph compare`: a change of 2 % of a rate is found as often as the output predicts, two seeds of one
//! model do not differ, and what cannot be compared is refused.

mod face;

use face::{Bench, gillesph};
use gillesph::comparison::{Question, Side, compare};
use gillesph::tables::SeriesTable;
use rstest::rstest;
use std::path::Path;
use std::process::{Command, Output};

/// Birth and death from nothing: a Poisson number of mean 95 (1 - 1/e) = 60.05 at 1 s, in proportion to the
/// rate of birth.
const MODEL: &str = "name: birth
reactions:
  species: [X]
  kinetics: molecules
  reactions:
    birth: { equation: 0 -> X, rate: 95 1/s }
    death: { equation: X -> 0, rate: 1 1/s }
domain: { kind: well_mixed, volume: 1 fL }
chemistry: { method: direct }
run: { until: 1 s, realizations: 200, seed: 1 }
output: { times: [1 s] }
";

/// The rate 2 % up.
const FASTER: &str = "reactions.reactions.birth.rate=96.9 1/s";

fn program(arguments: &[&str]) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_gillesph")).args(arguments).output().unwrap();
    (
        status.code(),
        String::from_utf8_lossy(&stdout).into_owned(),
        String::from_utf8_lossy(&stderr).into_owned(),
    )
}

fn compared(a: &Path, b: &Path, options: &[&str]) -> (Option<i32>, String, String) {
    program(&[&["compare", a.to_str().unwrap(), b.to_str().unwrap()], options].concat())
}

/// Realizations `from` to `from + count` of a run as a run of its own.
fn part(whole: &Side, from: usize, count: usize) -> Side {
    let series = &whole.series;
    Side {
        series: SeriesTable {
            times: series.times.clone(),
            columns: series.columns.clone(),
            blocks: series.blocks[from..from + count].to_vec(),
        },
        ..whole.clone()
    }
}

/// Cuts three long runs (nominal, nominal with another seed, 2 % faster) into repeats of 800 realizations.
///
/// 800 + 800 Poisson numbers of mean 60 and 61.3: a standard error of 0.648 %, so that 2 % is 3.09 of them;
/// found at the level 2.5 % (mean and variance share 5 %) with a power of 0.800.
fn found_as_predicted(repeats: usize) {
    const N: usize = 800;
    let bench = Bench::new();
    let model = bench.model("birth.yaml", MODEL);
    let count = (repeats * N).to_string();
    let run = |name: &str, options: &[&str]| {
        let dir = bench.run(&model, name, &[&["--realizations", &count], options].concat());
        Side::read(&dir).unwrap()
    };
    let nominal = run("nominal", &["--seed", "1"]);
    let again = run("again", &["--seed", "2"]);
    let faster = run("faster", &["--seed", "3", "--set", FASTER]);

    let question = Question { difference: Some(0.02), ..Question::default() };
    let (mut hits, mut alarms, mut predicted) = (0.0, 0.0, 0.0);
    for r in 0..repeats {
        let a = part(&nominal, r * N, N);
        let found = compare(&a, &part(&faster, r * N, N), &question).unwrap();
        let mean = found.rows.iter().find(|row| row.moment == "mean").unwrap();
        hits += f64::from(u8::from(mean.differs));
        predicted += mean.power / repeats as f64;
        alarms += f64::from(u8::from(compare(&a, &part(&again, r * N, N), &question).unwrap().differs));
    }
    let n = repeats as f64;
    println!(
        "{repeats} repeats: found {:.3}, predicted {predicted:.3}, false alarms {:.3}",
        hits / n,
        alarms / n
    );
    assert!((predicted - 0.8).abs() < 0.01, "{predicted}");
    // Binomial, four standard deviations: missed with a chance of 6e-5. The variance, rejected by chance in
    // up to 2.5 %, lets the mean pass at 5 %: 0.2 % more are found than the power says.
    let spread = |p: f64| 4.0 * (p * (1.0 - p) / n).sqrt();
    assert!((hits / n - predicted - 0.001).abs() < spread(predicted) + 0.001, "{} {predicted}", hits / n);
    assert!(alarms / n < 0.05 + spread(0.05), "{alarms}");

    // The whole runs: at the level 1e-4 two seeds differ by chance once in ten thousand; 2 % is 40 standard
    // errors.
    let path = |name: &str| bench.path(name);
    let (status, out, err) = compared(&path("nominal"), &path("again"), &["--level", "1e-4"]);
    assert_eq!(status, Some(0), "{out}{err}");
    assert!(out.contains("no difference found: would have seen, with 80 % power, 0."), "{out}");
    let (status, out, err) = compared(&path("nominal"), &path("faster"), &["--level", "1e-4"]);
    assert_eq!(status, Some(1), "{out}{err}");
    assert!(out.contains("differs: X in all at 1 s, mean +"), "{out}");
}

#[test]
fn two_per_cent_are_found_as_often_as_predicted() {
    found_as_predicted(200);
}

#[test]
#[ignore = "a minute or more: ten times the repeats"]
fn two_per_cent_are_found_as_often_as_predicted_in_two_thousand_repeats() {
    found_as_predicted(2000);
}

#[test]
fn runs_of_one_seed_are_paired_and_files_are_written() {
    let bench = Bench::new();
    let model = bench.model("birth.yaml", MODEL);
    let (a, b) = (bench.run(&model, "a", &[]), bench.run(&model, "b", &["--set", FASTER]));
    let same = bench.run(&model, "same", &["--threads", "1"]);
    let (status, out, err) = compared(&a, &same, &[]);
    assert_eq!((status, err.as_str()), (Some(0), ""), "{out}");
    assert!(out.contains("no difference: the one quantity is equal, value by value"), "{out}");

    let (status, out, _) = compared(&a, &b, &["--level", "0.1 %", "--difference", "2%"]);
    assert!(out.contains("compared realization by realization") && out.contains("power"), "{out}");
    assert!(matches!(status, Some(0 | 1)));

    let (csv, parquet) = (bench.path("rows.csv"), bench.path("rows.parquet"));
    for file in [&csv, &parquet] {
        let options = ["--json", "--out", file.to_str().unwrap()];
        let (_, out, err) = compared(&a, &b, &options);
        let json: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out}{err}"));
        assert_eq!((&json["pairing"], json["rows"].as_array().unwrap().len()), (&"paired".into(), 2));
        assert!(json["rows"][0]["power"].is_null());
        assert_eq!(compared(&a, &b, &options).0, Some(2), "the file is there");
    }
    assert_eq!(std::fs::read_to_string(&csv).unwrap().lines().count(), 3);
    assert_eq!(&std::fs::read(&parquet).unwrap()[..4], b"PAR1");
    assert!(gillesph(&["compare", "--help"]).stdout.len() > 500);
}

/// Noise alone: births in pairs at half the rate have the same mean and a larger variance.
#[test]
fn a_change_of_noise_alone_is_seen() {
    let bench = Bench::new();
    let model = bench.model("birth.yaml", MODEL);
    let bursts = bench.model("bursts.yaml", &MODEL.replace("0 -> X, rate: 95", "0 -> 5 X, rate: 19"));
    let options = ["--realizations", "2000", "--seed"];
    let a = bench.run(&model, "a", &[&options[..], &["7"]].concat());
    let b = bench.run(&bursts, "b", &[&options[..], &["8"]].concat());
    // Births of five give a Fano factor above 2; 2000 realizations know a variance to 3 %.
    let (status, out, _) = compared(&a, &b, &["--level", "1e-4"]);
    assert_eq!(status, Some(1), "{out}");
    assert!(out.contains("differs: X in all at 1 s, variance +"), "{out}");
    assert!(!out.contains("mean +") && !out.contains("mean −"), "{out}");
}

#[rstest]
#[case(&[], "again", "holds no run")]
#[case(&[], "single", "1 realization")]
#[case(&[], "stopped", "was interrupted (200 of 200 realizations finished)")]
#[case(&[], "broken", "cannot be read")]
#[case(&[], "later", "the output times differ: 2 s only in")]
#[case(&[], "other", "no quantity in common: X in all against Y in all")]
#[case(&["--level", "2"], "same", "no share between 0 and 1")]
#[case(&["--level", "5 m"], "same", "no share between 0 and 1")]
#[case(&["--difference", "much"], "same", "expected a number")]
#[case(&["--only", "x in all"], "same", "did you mean \"X\"?")]
#[case(&["--only", "X at 3 s"], "same", "the nearest time is 1 s")]
#[case(&["--out", "rows.txt"], "same", "the name says no format")]
fn refused(#[case] options: &[&str], #[case] second: &str, #[case] words: &str) {
    let bench = Bench::new();
    let model = bench.model("birth.yaml", MODEL);
    let a = bench.run(&model, "a", &[]);
    let b = match second {
        "again" => bench.path("nowhere"),
        "single" => bench.run(&model, "b", &["--realizations", "1"]),
        "later" => bench.run(&model, "b", &["--set", "run.until=2 s", "--set", "output.times=[1 s, 2 s]"]),
        "other" => {
            let renamed = MODEL.replace("[X]", "[Y]").replace("-> X", "-> Y").replace("X ->", "Y ->");
            bench.run(&bench.model("other.yaml", &renamed), "b", &[])
        }
        _ => bench.run(&model, "b", &["--seed", "2"]),
    };
    let record = b.join("run.json");
    if second == "stopped" {
        let text = std::fs::read_to_string(&record).unwrap();
        std::fs::write(&record, text.replace("\"finished\",", "\"interrupted\",")).unwrap();
    }
    if second == "broken" {
        std::fs::write(b.join("tables/series.parquet"), "no table").unwrap();
    }
    let (status, out, err) = compared(&a, &b, options);
    assert_eq!((status, out.as_str()), (Some(2), ""), "{err}");
    assert!(err.contains(words), "{err}");
}

/// Both folders are looked at: all faults come at once.
#[test]
fn every_fault_is_told() {
    let (status, _, err) = program(&["compare", "nowhere", "neither", "--level", "0", "--out", "x"]);
    assert_eq!(status, Some(2));
    for words in ["nowhere holds no run", "neither holds no run", "no share", "no format", "4 faults"] {
        assert!(err.contains(words), "{words}: {err}");
    }
}
