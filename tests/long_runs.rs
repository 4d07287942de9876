//! Runs that stop when they know enough, and flows that serve many runs.

use gillesph::tables;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const CHANNEL: &str = "\
name: channel
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
chemistry: { step: 0.5 us }
initial: { medium: { A: 10000 } }
run: { until: 20 us, realizations: 3, seed: 5 }
output: { every: 2 us, probes: { across: { line: { from: [8 um, 0.5 um], to: [8 um, 7.5 um], points: 8 } } } }
";

const VOLUME: &str = "\
name: volume
reactions:
  species: { X: , Y: }
  kinetics: molecules
  reactions: { birth: { equation: 0 -> X, rate: 20 1/s }, death: { equation: X -> 0, rate: 1 1/s } }
domain: { kind: graph, volumes: [1 fL, 1 fL], names: [left, right], links: [[0, 1, 1 um]] }
initial: {}
run:
  until: 8 s
  seed: 3
  until_precision: { quantity: X in left at 6 s, relative_error: 2 %, confidence: 95 %, at_most: 20000 }
output: { every: 1 s }
";

fn run(folder: &Path, model: &str, arguments: &[&str]) -> Output {
    std::fs::write(folder.join("m.yaml"), model).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_gillesph"));
    command.current_dir(folder).args(["run", "m.yaml"]).args(arguments);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).output().unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn bytes(folder: &Path, out: &str, table: &str) -> Vec<u8> {
    std::fs::read(folder.join(out).join("tables").join(table)).unwrap()
}

#[test]
fn a_recorded_flow_serves_as_the_flow_itself_and_no_other() {
    let folder = TempDir::new().unwrap();
    let dir = folder.path();
    let with = |what: &str| format!("{CHANNEL}flow: {{ {what}: c.flow }}\n");
    assert!(run(dir, CHANNEL, &["--out", "direct"]).status.success());
    let recorded = run(dir, &with("record"), &["--out", "recorded", "--realizations", "1"]);
    assert!(recorded.status.success(), "{}", words(&recorded));
    let replayed = run(dir, &with("replay"), &["--out", "replayed"]);
    assert!(replayed.status.success(), "{}", words(&replayed));
    for table in ["series.parquet", "statistics.parquet", "probes.parquet"] {
        assert!(bytes(dir, "direct", table) == bytes(dir, "replayed", table), "{table} differs");
    }
    assert_eq!(tables::read_record(&dir.join("replayed")).unwrap().performance.particle_steps, 0);

    // A flow of other making, instants that were not recorded, a chemistry that needs shorter steps.
    for (change, said) in [
        ("fluid.viscosity=2 mPa s", "fluid.viscosity: recorded with `1 mPa s`, here `2 mPa s`"),
        ("output.every=0.3 us", "no instant of the recorded flow"),
        ("chemistry.step=0.1 us", "recorded with chemistry steps of"),
    ] {
        let refused = run(dir, &with("replay"), &["--out", "other", "--set", change]);
        let message = words(&refused);
        assert_eq!(refused.status.code(), Some(2), "{message}");
        assert!(message.contains(said) && message.contains("again"), "{message}");
    }
    std::fs::write(dir.join("c.flow"), "precious").unwrap();
    let refused = run(dir, &with("record"), &["--out", "third"]);
    assert_eq!(refused.status.code(), Some(1), "{}", words(&refused));
    assert!(words(&refused).contains("choose another name"));
    assert_eq!(std::fs::read_to_string(dir.join("c.flow")).unwrap(), "precious");
    let missing = run(dir, &with("replay").replace("c.flow", "d.flow"), &["--out", "fourth"]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(words(&missing).contains("record it first"), "{}", words(&missing));
}

#[test]
fn a_run_stops_when_it_knows_enough_and_is_the_same_however_it_came_there() {
    let folder = TempDir::new().unwrap();
    let dir = folder.path();
    let first = run(dir, VOLUME, &["--out", "one", "--threads", "1"]);
    assert!(first.status.success(), "{}", words(&first));
    let record = tables::read_record(&dir.join("one")).unwrap();
    let known = record.precision.clone().unwrap();
    assert!(known.reached && known.half_width <= 0.02 * known.mean, "{known:?}");
    assert_eq!(record.realizations, [0, *known.looks.last().unwrap()]);
    // Poisson, mean (20 + 20)/2 (1 - exp(-6)) = 19.95 in each volume: about 96² / 19.95 = 482 realizations. Six
    // half widths of the interval at 95 % are twelve deviations.
    assert!((known.mean - 19.95).abs() < 6.0 * known.half_width, "{known:?}");
    assert!((300..1000).contains(&record.realizations[1]), "{known:?}");
    assert!(words(&first).contains("X in left at 6 s: "), "{}", words(&first));
    assert!(run(dir, VOLUME, &["--out", "two", "--threads", "2"]).status.success());
    assert!(bytes(dir, "one", "series.parquet") == bytes(dir, "two", "series.parquet"));

    let little = VOLUME.replace("at_most: 20000", "at_most: 150");
    let stopped = run(dir, &little, &["--out", "three"]);
    assert!(stopped.status.success());
    assert!(
        words(&stopped).contains("not known as well as asked after 150 realizations"),
        "{}",
        words(&stopped)
    );
    let nothing = VOLUME.replace("quantity: X in left at 6 s", "quantity: Y").replace("20000", "200");
    let zeros = run(dir, &nothing, &["--out", "four"]);
    assert!(zeros.status.success() && words(&zeros).contains("nothing but zeros"), "{}", words(&zeros));

    for (from, to, said) in [
        ("X in left at 6 s", "Z in left at 6 s", "unknown species `Z`"),
        ("X in left at 6 s", "X in middle at 6 s", "unknown group `middle`"),
        ("X in left at 6 s", "X in left at 9 s", "lies outside the run"),
        ("X in left at 6 s", "X in left at 6 um", "expected a time"),
        ("relative_error: 2 %", "relative_error: 0", "between 0 and 100 %"),
        ("at_most: 20000", "at_most: 10", "at least 100 realizations"),
    ] {
        let refused = run(dir, &VOLUME.replace(from, to), &["--out", "five"]);
        let message = words(&refused);
        assert!(refused.status.code() == Some(2) && message.contains(said), "{to}: {message}");
        assert!(message.contains('^') && !dir.join("five").exists(), "{message}");
    }
}

#[test]
fn what_is_finished_is_not_resumed_and_not_replaced() {
    let folder = TempDir::new().unwrap();
    let dir = folder.path();
    assert!(run(dir, CHANNEL, &["--out", "done"]).status.success());
    let again = run(dir, CHANNEL, &["--out", "done", "--resume"]);
    assert!(again.status.success() && words(&again).contains("nothing to resume"), "{}", words(&again));
    let other = run(dir, CHANNEL, &["--out", "done", "--resume", "--seed", "6"]);
    assert_eq!(other.status.code(), Some(2), "{}", words(&other));
    std::fs::remove_file(dir.join("done/report.html")).unwrap();
    let drawn = run(dir, CHANNEL, &["--out", "done", "--resume"]);
    assert!(drawn.status.success() && dir.join("done/report.html").exists(), "{}", words(&drawn));
}
