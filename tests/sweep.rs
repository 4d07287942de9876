//! Sweeps: what comes out at each point against exact answers, common random numbers, resumed sweeps, what a user can get
//! wrong.

mod face;

use face::{Bench, gillesph, record};
use gillesph::tables::{SweepRow, read_series, read_sweep_ends, read_sweep_record};
use rstest::rstest;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// A -> B at rate k from 1000 molecules; each is left after a time t with probability exp(-k t).
const DECAY: &str = "\
name: decay
reactions:
  species: [A, B]
  kinetics: molecules
  parameters: { k: 1 1/s, back: 0 1/s }
  reactions: { decay: { equation: A <-> B, rate: k, reverse: back } }
domain: { kind: well_mixed, volume: 1 fL }
initial: { A: 1000 }
run: { until: 1 s, realizations: 200, seed: 1 }
output: { every: 0.5 s }
";

fn with(sweep: &str) -> String {
    format!("{DECAY}sweep: {sweep}\n")
}

fn ends(dir: &Path, species: &str) -> Vec<SweepRow> {
    let record = read_sweep_record(dir).unwrap();
    let rows = read_sweep_ends(dir, &record.parameters).unwrap();
    rows.into_iter().filter(|row| row.statistics.species == species).collect()
}

fn attempt(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gillesph")).current_dir(folder).args(arguments).output().unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Mean and variance at each of seven rates and two times. The mean of 200 binomial numbers of variance 1000 p (1 - p) has
/// the standard error √(5 p (1 - p)), at most 1.12; five of them are allowed (chance 6e-7 each, 14 of them 8e-6). The
/// variance of 200 such numbers, nearly normal, has the relative error √(2/199) = 0.10; five of these (chance 1e-6 each).
#[test]
fn a_grid_of_rates_follows_the_exact_decay() {
    let bench = Bench::new();
    let model = bench.model("m.yaml", &with("{ k: logspace(0.1 1/s, 10 1/s, 4), run.until: [0.5 s, 1 s] }"));
    let dir = bench.run(&model, "out", &[]);
    let rows = ends(&dir, "A");
    assert_eq!(rows.len(), 8);
    for (number, row) in rows.iter().enumerate() {
        assert_eq!((row.point, row.statistics.summary.count), (number as u32, 200));
        let (k, until) = (0.1 * 100_f64.powf((number / 2) as f64 / 3.0), [0.5, 1.0][number % 2]);
        assert!((row.values[0] - k).abs() < 1e-12 * k && row.values[1] == until, "{:?}", row.values);
        assert_eq!(row.statistics.time, until);
        let p = (-k * until).exp();
        let (mean, variance) = (1000.0 * p, 1000.0 * p * (1.0 - p));
        let found = &row.statistics.summary;
        assert!((found.mean - mean).abs() < 5.0 * (variance / 200.0).sqrt(), "{} for {mean}", found.mean);
        // Few molecules left are Poisson numbers: their fourth moment widens the error by √(1 + 1/(2 v)).
        let wider = (1.0 + 0.5 / variance).sqrt();
        assert!((found.variance / variance - 1.0).abs() < 0.5 * wider, "{} for {variance}", found.variance);
    }
    assert!(["png", "svg"].iter().all(|ending| dir.join(format!("figures/outcome.{ending}")).exists()));
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(page.contains("points/0007/report.html") && page.contains("Every check passed"), "{page}");
    assert!(dir.join("points/0007/report.html").exists());
    let record = record(&dir);
    assert_eq!((&record["status"], &record["design"]), (&"finished".into(), &"grid".into()));
    let point = self::record(&dir.join("points/0003"));
    assert_eq!(point["model"]["overrides"].as_array().unwrap().len(), 2);
    std::fs::remove_file(dir.join("report.html")).unwrap();
    gillesph(&["report", dir.to_str().unwrap()]);
    assert!(dir.join("report.html").exists());
    // A point by itself: the values of its record, given by hand.
    let set: Vec<String> = read_sweep_record(&dir).unwrap().points[3].set.clone();
    let alone = bench.run(&model, "alone", &["--set", "sweep=null", "--set", &set[0], "--set", &set[1]]);
    assert_eq!(read_series(&alone).unwrap(), read_series(&dir.join("points/0003")).unwrap());
}

/// Births at a rate b from zero to time t: the direct method needs one number for each waiting time and one for each
/// choice, so with the same random numbers the births at rate 1.1 b up to t are those at rate b up to 1.1 t. The
/// difference of the two points is then a Poisson number of mean 0.1 b t = 20 in each realization, variance 20; with
/// seeds of their own it has the variance 2.1 b t = 420. A sample variance of 400 has a relative error of
/// √(2/399 + 1/(400·20)) = 0.07: below 28 and above 270 are 5 of them (chance 6e-7 each).
#[test]
fn common_random_numbers_tell_points_apart() {
    let bench = Bench::new();
    let births = DECAY
        .replace("A <-> B, rate: k, reverse: back", "0 -> A, rate: k")
        .replace("k: 1 1/s", "k: 200 1/s")
        .replace("initial: { A: 1000 }", "initial: {}")
        .replace("realizations: 200", "realizations: 400");
    let variance = |common: bool, out: &str| {
        let sweep = format!("sweep: {{ k: [200 1/s, 220 1/s], common_random_numbers: {common} }}\n");
        let model = bench.model("m.yaml", &(births.clone() + &sweep));
        let dir = bench.run(&model, out, &[]);
        let last = |point: &str| {
            let series = read_series(&dir.join(point)).unwrap();
            series.across(series.times.len() - 1, series.columns.find("all", "A").unwrap())
        };
        let (one, other) = (last("points/0000"), last("points/0001"));
        let difference: Vec<f64> = one.iter().zip(&other).map(|(a, b)| b - a).collect();
        let seeds: Vec<u64> = read_sweep_record(&dir).unwrap().points.iter().map(|p| p.seed).collect();
        assert_eq!(seeds[0] == seeds[1], common);
        gillesph::statistics::variance(&difference)
    };
    let (common, own) = (variance(true, "common"), variance(false, "own"));
    assert!(common < 28.0 && own > 270.0, "{common} and {own}");
}

/// Each of 40 equal intervals of both ranges holds one point, on a logarithmic and on a linear scale.
#[test]
fn a_hypercube_covers_its_ranges() {
    let bench = Bench::new();
    let sweep = "{ design: latin_hypercube, points: 40, k: loguniform(0.1 1/s, 10 1/s), initial.A: uniform(10 nM, 20 nM) }";
    let model = bench.model("m.yaml", &with(sweep));
    let dir = bench.run(&model, "out", &["--realizations", "3"]);
    let rows = ends(&dir, "A");
    let covered = |part: &dyn Fn(&SweepRow) -> f64| {
        let mut intervals: Vec<usize> = rows.iter().map(|row| (40.0 * part(row)) as usize).collect();
        intervals.sort_unstable();
        intervals == (0..40).collect::<Vec<_>>()
    };
    // 1 nM is 1e-6 mol/m³.
    assert!(
        covered(&|row| (row.values[0] / 0.1).log10() / 2.0) && covered(&|row| row.values[1] / 1e-5 - 1.0)
    );
    assert!(dir.join("figures/tornado.png").exists() && dir.join("figures/outcome_A.svg").exists());
    assert!(std::fs::read_to_string(dir.join("report.html")).unwrap().contains("Rank correlations"));
}

/// The k-th value of each; `check` lists the points; `--set` reaches into a sweep in braces.
#[test]
fn a_list_takes_values_together() {
    let bench = Bench::new();
    let sweep = "{ k: linspace(1 1/s, 3 1/s, 3), back: [1 1/min, 2 1/min, 3 1/min], design: list }";
    let model = bench.model("m.yaml", &with(sweep));
    let shown = gillesph(&["check", model.to_str().unwrap()]);
    let shown = String::from_utf8(shown.stdout).unwrap();
    for line in ["3 points (list), 200 realizations at each: 600", "0002  k = 3 1/s, back = 3 1/min"] {
        assert!(shown.contains(line), "{shown}");
    }
    let dir = bench.run(&model, "out", &["--set", "sweep.k=[4 1/s, 5 1/s, 6 1/s]", "--realizations", "2"]);
    let values: Vec<Vec<f64>> = ends(&dir, "B").into_iter().map(|row| row.values).collect();
    assert_eq!(values, [[4.0, 1.0 / 60.0], [5.0, 2.0 / 60.0], [6.0, 3.0 / 60.0]]);
}

/// Interrupted by Ctrl-C, and by a kill: resumed to the same bytes. A folder that holds a sweep is not written over.
#[rstest]
#[case::asked("-INT")]
#[case::killed("-KILL")]
#[cfg(unix)]
fn what_was_interrupted_is_resumed_to_the_same_bytes(#[case] signal: &str) {
    let bench = Bench::new();
    let long = DECAY.replace("reverse: back", "reverse: k").replace("until: 1 s", "until: 40 s");
    let model = bench.model("m.yaml", &(long + "sweep: { k: linspace(1 1/s, 2 1/s, 6) }\n"));
    let name = model.to_str().unwrap();
    let begun = Instant::now();
    let whole = bench.run(&model, "whole", &["--threads", "1"]);
    let needed = begun.elapsed();
    let dir = bench.path("parts");
    let out = dir.to_str().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_gillesph"))
        .args(["run", name, "--quiet", "--threads", "1", "--out", out])
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !dir.join("points/0000/run.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the sweep never began");
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(needed / 4);
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
    let status = child.wait().unwrap();
    if signal == "-INT" {
        assert_eq!(status.code(), Some(130));
        assert_eq!(read_sweep_record(&dir).unwrap().status, "interrupted");
    }
    let done = |point: &str| record(&dir.join(point))["status"] == "finished";
    assert!(!dir.join("points/0005/run.json").exists() || !done("points/0005"), "it was not interrupted");
    let refused = attempt(&bench.path("."), &["run", name, "--out", out]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(words(&refused).contains("holds a sweep") && words(&refused).contains("--resume"));
    let changed = attempt(&bench.path("."), &["run", name, "--out", out, "--resume", "--seed", "2"]);
    assert_eq!(changed.status.code(), Some(2));
    assert!(words(&changed).contains("the seed has changed from 1 to 2"), "{}", words(&changed));
    bench.run(&model, "parts", &["--resume", "--threads", "2"]);
    let bytes = |dir: &Path, table: &str| std::fs::read(dir.join(table)).unwrap();
    let mut tables = vec!["tables/sweep.parquet".to_string()];
    tables.extend((0..6).map(|k| format!("points/{k:04}/tables/series.parquet")));
    for table in tables {
        assert!(bytes(&whole, &table) == bytes(&dir, &table), "{table}");
    }
    assert!(!dir.join("checkpoint").exists());
    let again = attempt(&bench.path("."), &["run", name, "--out", out]);
    assert!(words(&again).contains("already holds a finished sweep"));
    let single = ["run", name, "--quiet", "--out", out, "--set", "sweep=null", "--set", "run.until=1 s"];
    let other = attempt(&bench.path("."), &single);
    assert_eq!(other.status.code(), Some(2));
    assert!(words(&other).contains("holds a sweep"), "{}", words(&other));
    gillesph(&[&single[..], &["--force"]].concat());
    assert!(!dir.join("points").exists() && dir.join("tables/series.parquet").exists());
}

/// 1000 molecules fall one by one, so that the law divides by zero for certain where c is 500: that point fails, the
/// others are there, and a resumed sweep tries it again.
#[test]
fn a_point_that_fails_does_not_stop_the_others() {
    let bench = Bench::new();
    let law = DECAY
        .replace("equation: A <-> B, rate: k, reverse: back", "equation: A -> B, law: \"k * A / (A - back)\"")
        .replace("back: 0 1/s", "back: 0")
        .replace("until: 1 s", "until: 1000 s")
        .replace("realizations: 200", "realizations: 2")
        .replace("every: 0.5 s", "times: [1000 s]");
    let model = bench.model("m.yaml", &(law + "sweep: { back: [-1, 500, 0.5] }\n"));
    let dir = bench.path("out");
    for options in [&[][..], &["--resume"]] {
        let arguments = [&["run", model.to_str().unwrap(), "--out", dir.to_str().unwrap()], options].concat();
        let output = attempt(&bench.path("."), &arguments);
        assert_eq!(output.status.code(), Some(1), "{}", words(&output));
        for word in ["point 0001 (back = 500) failed", "voxel 0", "2 of 3 points are finished"] {
            assert!(words(&output).contains(word), "{}", words(&output));
        }
    }
    let record = read_sweep_record(&dir).unwrap();
    assert_eq!(record.status, "failed");
    assert!(record.points[1].error.as_ref().is_some_and(|error| error.contains("propensity")));
    let there: Vec<u32> = ends(&dir, "B").iter().map(|row| row.point).collect();
    assert_eq!(there, [0, 2]);
}

#[rstest]
#[case::unknown("{ kk: [1 1/s], fluid.viscosty: [1 Pa s] }", &["11:10  sweep: unknown parameter `kk`", "did you mean \"k\"?", "11:23"])]
#[case::path("{ domain.volme: [1 fL] }", &["11:10  domain: unknown key \"volme\"", "did you mean \"volume\"?"])]
#[case::species("{ A: [1, 2] }", &["11:10", "initial.A"])]
#[case::lengths("{ k: [1 1/s], back: [1 1/s, 2 1/s], design: list }", &["11:22  `back` has 2 values, `k` has 1"])]
#[case::no_range("{ k: [1 1/s], design: latin_hypercube }", &["11:13", "no range for a hypercube", "uniform(a, b)"])]
#[case::range_in_a_grid("{ k: uniform(1 1/s, 2 1/s) }", &["11:13", "linspace(a, b, n)"])]
#[case::dimension("{ k: [1 1/s, 2 um] }", &["11:21  expected rate (1/s) as in the reactions, found length (m)"])]
#[case::dimension_of_an_end("{ k: logspace(1 1/s, 2 um, 3) }", &["11:29  expected rate (1/s)"])]
#[case::dimension_elsewhere("{ domain.volume: [1 fL, 2 um] }", &["11:32  expected a volume"])]
#[case::value("{ domain.volume: linspace(-1 fL, 1 fL, 2) }", &["11:25  \"volume\": expected a positive volume"])]
#[case::both_at_once("{ k: [], domain.volume: [2 um] }", &["11:13  an empty list", "11:33  expected a volume"])]
#[case::empty("{ k: [] }", &["11:13  an empty list of values"])]
#[case::nothing("{}", &["11:8  a sweep over nothing"])]
#[case::too_many("{ k: linspace(1 1/s, 2 1/s, 101), back: linspace(1 1/s, 2 1/s, 101) }", &["11:8  10201 points are too many", "at most 10000"])]
#[case::function("{ k: lospace(1 1/s, 2 1/s, 3) }", &["11:13  \"lospace\" makes no values", "did you mean \"logspace\"?"])]
#[case::logarithm_of_zero("{ initial.A: logspace(0, 10, 3) }", &["11:21", "both are positive"])]
#[case::twice("{ k: [1 1/s], reactions.parameters.k: [2 1/s] }", &["11:22", "swept already, as `k`"])]
#[case::seed("{ run.seed: [1, 2] }", &["11:10  `run.seed` cannot be swept"])]
#[case::points_of_a_grid("{ k: [1 1/s], points: 3 }", &["11:30", "latin_hypercube"])]
fn a_bad_sweep_is_refused(#[case] sweep: &str, #[case] expected: &[&str]) {
    let bench = Bench::new();
    let model = bench.model("m.yaml", &with(sweep));
    for verb in ["check", "run"] {
        let output = attempt(&bench.path("."), &[verb, "m.yaml"]);
        let message = words(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for word in expected {
            assert!(message.contains(word), "`{word}` is missing: {message}");
        }
        assert!(message.contains("11 | sweep:") && message.contains('^'), "{message}");
    }
    assert_eq!(model.parent().unwrap().read_dir().unwrap().count(), 1, "something was written");
}

/// What is swept cannot be set as well.
#[test]
fn a_swept_parameter_is_not_set() {
    let bench = Bench::new();
    bench.model("m.yaml", &with("{ k: [1 1/s, 2 1/s] }"));
    let set = ["run", "m.yaml", "--set", "reactions.parameters.k=3 1/s"];
    let output = attempt(&bench.path("."), &set);
    assert_eq!(output.status.code(), Some(2));
    assert!(words(&output).contains("`k` is swept and given by --set"), "{}", words(&output));
}
