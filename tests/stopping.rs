//! Runs that end early: what the numbers did wrong, or Ctrl-C; what is finished is kept and can be resumed.

use gillesph::tables;
use rstest::rstest;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const VOLUME: &str = "\
name: t
reactions:
  species: { A: , B: }
  kinetics: molecules
  parameters: { k: 1 1/s }
  reactions: { decay: { equation: A -> B, rate: k } }
domain: { kind: well_mixed, volume: 1 fL }
initial: { A: 100 }
run: { until: 100 s, realizations: 2, seed: 1 }
output: { every: 1 s }
";

const CHANNEL: &str = "\
name: t
reactions:
  species: { A: { diffusion: 100 um^2/s }, B: { diffusion: 0 } }
  reactions: { decay: { equation: A -> B, rate: 1e4 1/s } }
domain:
  kind: particles
  dimensions: 2
  min: [0, 0]
  max: [16 um, 8 um]
  boundaries: { x: periodic, y: no_slip }
particles: { spacing: 1 um, support: 2 }
groups:
  medium: { material: fluid, shape: everything_else }
fluid: { method: sph_bvf, density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s }
conditions: { push: { force: { acceleration: [100 m/s^2, 0] } } }
chemistry: { step: 0.25 us }
initial: { medium: { A: 10000 } }
run: { until: 100 us, realizations: 4, seed: 1 }
output: { every: 1 us }
";

fn start(folder: &Path, model: &str, arguments: &[&str]) -> Command {
    std::fs::write(folder.join("m.yaml"), model).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_gillesph"));
    command.current_dir(folder).args(["run", "m.yaml", "--threads", "1"]).args(arguments);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn message(output: &Output) -> String {
    assert!(output.stdout.is_empty(), "nothing belongs on standard output");
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn changed(model: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(model.to_string(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    })
}

#[rstest]
// 100 molecules fall one by one, so that 50 is passed for certain.
#[case::division_by_zero("law: \"k * A / (A - 50)\"", "inf")]
#[case::negative_law("law: \"k * (A - 50.5)\"", "-0.5")]
fn a_law_that_leaves_its_range_ends_the_run(#[case] law: &str, #[case] value: &str) {
    let folder = TempDir::new().unwrap();
    let model = changed(VOLUME, &[("rate: k", law), ("until: 100 s", "until: 10000 s")]);
    let output = start(folder.path(), &model, &["--out", "out"]).output().unwrap();
    let message = message(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for word in ["voxel 0", "the propensity of decay", value, "A = 50", "B = 50", "rate law"] {
        assert!(message.contains(word), "`{word}` is missing: {message}");
    }
    let record = tables::read_record(&folder.path().join("out")).unwrap();
    assert_eq!(record.status, "failed");
}

#[test]
fn a_blow_up_keeps_what_was_finished() {
    let folder = TempDir::new().unwrap();
    // At a thousandth of the speed of the flow the fluid is far too soft for the force on it.
    let changes =
        [("speed: 1 mm/s", "speed: 1 mm/s, sound_speed: 1 um/s"), ("[100 m/s^2, 0]", "[0, -1e6 m/s^2]")];
    let output = start(folder.path(), &changed(CHANNEL, &changes), &["--out", "out"]).output().unwrap();
    let message = message(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for word in [
        "step ",
        "t = ",
        "particle ",
        "density (kg/m^3) = ",
        "a sound speed of 1.000e-6 m/s, a step of ",
        "set fluid.sound_speed: 2.8e1 m/s",
        "fluid.options.courant: ",
        "4 realizations",
        "output times are kept",
    ] {
        assert!(message.contains(word), "`{word}` is missing: {message}");
    }
    let dir = folder.path().join("out");
    let record = tables::read_record(&dir).unwrap();
    assert_eq!((record.status.as_str(), record.finished), ("failed", 0));
    assert!(record.error.is_some_and(|error| error.contains("density")));
    let series = tables::read_series(&dir).unwrap();
    assert!(!series.times.is_empty() && series.times.len() < 101, "{} times", series.times.len());
    assert!(dir.join("report.html").exists());
}

#[rstest]
// One thread takes one or two seconds for each of these.
#[case::volume(changed(VOLUME, &[("A: 100", "A: 10000"), ("realizations: 2", "realizations: 3000")]))]
#[case::channel(changed(CHANNEL, &[("until: 100 us", "until: 600 us")]))]
#[case::at_rest(changed(CHANNEL, &[
    ("fluid: { method: sph_bvf, density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s }", "fluid: { method: none }"),
    ("conditions: { push: { force: { acceleration: [100 m/s^2, 0] } } }", "conditions: {}"),
    ("realizations: 4", "realizations: 200"),
]))]
#[cfg(unix)]
fn what_was_interrupted_is_resumed_to_the_same_bytes(#[case] model: String) {
    let folder = TempDir::new().unwrap();
    let begun = Instant::now();
    let whole = start(folder.path(), &model, &["--out", "whole"]).output().unwrap();
    let needed = begun.elapsed();
    assert!(whole.status.success(), "{}", message(&whole));

    let child = start(folder.path(), &model, &["--out", "parts"]).spawn().unwrap();
    let begun = Instant::now();
    while !folder.path().join("parts/run.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the run never began");
        std::thread::sleep(Duration::from_millis(5));
    }
    // A tenth of the way on a machine of any speed.
    std::thread::sleep(needed / 10);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let stopped = child.wait_with_output().unwrap();
    let words = message(&stopped);
    assert_eq!(stopped.status.code(), Some(130), "{words}");
    assert!(words.contains("interrupted: ") && words.contains("--resume"), "{words}");
    let dir = folder.path().join("parts");
    let record = tables::read_record(&dir).unwrap();
    assert_eq!(record.status, "interrupted");
    if dir.join("tables/series.parquet").exists() {
        tables::read_series(&dir).unwrap();
    }

    let refused = start(folder.path(), &model, &["--out", "parts"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(message(&refused).contains("--resume"));
    let resumed = start(folder.path(), &model, &["--out", "parts", "--resume"]).output().unwrap();
    assert!(resumed.status.success(), "{}", message(&resumed));
    same_files(&folder.path().join("whole/tables"), &dir.join("tables"));
    let (one, other) =
        (tables::read_record(&folder.path().join("whole")).unwrap(), tables::read_record(&dir).unwrap());
    assert_eq!(one.health, other.health);
    assert_eq!(other.status, "finished");
}

/// One chemistry step of a hundred million steps of the fluid.
#[test]
#[cfg(unix)]
fn a_long_way_between_two_chemistry_steps_is_interrupted_at_once() {
    let folder = TempDir::new().unwrap();
    let changes = [
        ("chemistry: { step: 0.25 us }", "chemistry: { step: 10 s }"),
        ("until: 100 us", "until: 10 s"),
        ("every: 1 us", "every: 10 s"),
    ];
    let mut child = start(folder.path(), &changed(CHANNEL, &changes), &["--out", "out"]).spawn().unwrap();
    let begun = Instant::now();
    while !folder.path().join("out/run.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the run never began");
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(200));
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let asked = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if asked.elapsed() > Duration::from_secs(30) {
            child.kill().unwrap();
            panic!("still running half a minute after the wish to stop");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    assert_eq!(status.code(), Some(130));
    assert_eq!(tables::read_record(&folder.path().join("out")).unwrap().status, "interrupted");
}

/// Both folders hold the same names and bytes.
fn same_files(one: &Path, other: &Path) {
    let names = |dir: &Path| {
        let mut names: Vec<_> = dir.read_dir().unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(names(one), names(other));
    for name in names(one) {
        let (a, b) = (one.join(&name), other.join(&name));
        if a.is_dir() {
            same_files(&a, &b);
        } else {
            assert!(std::fs::read(&a).unwrap() == std::fs::read(&b).unwrap(), "{} differs", a.display());
        }
    }
}
