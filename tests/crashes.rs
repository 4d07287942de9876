//! Disks that are full, folders that cannot be written, states that are damaged, runs that are resumed as what they are
//! not: what was finished survives, and the message says what to do.

use gillesph::tables;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const LONG: &str = "\
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
run: { until: 4 ms, realizations: 2, seed: 1, checkpoint_every: 20 ms }
output: { every: 40 us }
";

const MANY: &str = "\
name: t
reactions:
  species: { A: , B: }
  kinetics: molecules
  reactions: { there: { equation: A <-> B, rate: 1 1/s, reverse: 2 1/s } }
domain: { kind: well_mixed, volume: 1 fL }
initial: { A: 3000 }
run: { until: 100 s, realizations: 3000, seed: 5 }
output: { every: 0.1 s }
";

fn gillesph(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gillesph"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn same_tables(one: &Path, other: &Path) {
    let bytes = |dir: &Path| std::fs::read(dir.join("tables/series.parquet")).unwrap();
    assert!(bytes(one) == bytes(other), "{} and {} differ", one.display(), other.display());
}

/// A run of [`LONG`] in `folder/part` that was killed once a state was saved twice.
fn cut(folder: &Path) {
    std::fs::write(folder.join("m.yaml"), LONG).unwrap();
    let whole = gillesph(folder, &["run", "m.yaml", "--out", "whole"]).output().unwrap();
    assert!(whole.status.success(), "{}", words(&whole));
    let mut child = gillesph(folder, &["run", "m.yaml", "--out", "part"]).spawn().unwrap();
    let begun = Instant::now();
    while !folder.join("part/checkpoint/flow-0.older").exists() {
        assert!(begun.elapsed() < Duration::from_secs(120), "no state was saved");
        assert!(child.try_wait().unwrap().is_none(), "the run ended before a state was saved twice");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
#[cfg(unix)]
fn a_damaged_state_falls_back_and_says_so() {
    let folder = TempDir::new().unwrap();
    cut(folder.path());
    let newest = folder.path().join("part/checkpoint/flow-0.state");
    let older = folder.path().join("part/checkpoint/flow-0.older");
    // Killed between two renamings there may be no newest one.
    if !newest.exists() {
        std::fs::copy(&older, &newest).unwrap();
    }
    let mut bytes = std::fs::read(&newest).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x10;
    std::fs::write(&newest, bytes).unwrap();
    let resumed = gillesph(folder.path(), &["run", "m.yaml", "--out", "part", "--resume"]).output().unwrap();
    let message = words(&resumed);
    assert!(resumed.status.success(), "{message}");
    assert!(message.contains("damaged") && message.contains("state before"), "{message}");
    same_tables(&folder.path().join("whole"), &folder.path().join("part"));
}

#[test]
#[cfg(unix)]
fn when_all_states_are_damaged_nothing_starts_silently() {
    let folder = TempDir::new().unwrap();
    cut(folder.path());
    for name in ["flow-0.state", "flow-0.older"] {
        std::fs::write(folder.path().join("part/checkpoint").join(name), "nothing").unwrap();
    }
    let resumed = gillesph(folder.path(), &["run", "m.yaml", "--out", "part", "--resume"]).output().unwrap();
    let message = words(&resumed);
    assert_eq!(resumed.status.code(), Some(1), "{message}");
    assert!(message.contains("damaged") && message.contains("--force"), "{message}");
}

#[test]
#[cfg(unix)]
fn what_has_changed_is_named_and_a_running_folder_is_refused() {
    let folder = TempDir::new().unwrap();
    cut(folder.path());
    let resume = |more: &[&str]| {
        let arguments = [&["run", "m.yaml", "--out", "part", "--resume"], more].concat();
        let output = gillesph(folder.path(), &arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        words(&output)
    };
    let message = resume(&["--set", "run.until=5 ms", "--seed", "7"]);
    for part in ["--set run.until=5 ms has come", "seed has changed from 1 to 7", "--force"] {
        assert!(message.contains(part), "`{part}` is missing: {message}");
    }
    let other = LONG.replace("rate: 1e4 1/s", "rate: 2e4 1/s");
    std::fs::write(folder.path().join("m.yaml"), other).unwrap();
    let message = resume(&[]);
    let expected = "reactions.reactions.decay.rate has changed from `1e4 1/s` to `2e4 1/s`";
    assert!(message.contains(expected), "{message}");
    std::fs::write(folder.path().join("m.yaml"), LONG).unwrap();

    // Another version of the program that keeps the same format may go on, and says that it is another.
    let path = folder.path().join("part/run.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let (now, then) = (format!("\"version\": \"{version}\""), "\"version\": \"0.0.9\"");
    assert!(text.contains(&now));
    std::fs::write(&path, text.replace(&now, then).replace("\"format\": ", "\"format\": 9")).unwrap();
    let message = resume(&[]);
    assert!(message.contains("format") && message.contains("0.0.9"), "{message}");
    std::fs::write(&path, text.replace(&now, then)).unwrap();

    let mut running =
        gillesph(folder.path(), &["run", "m.yaml", "--out", "part", "--resume"]).spawn().unwrap();
    let begun = Instant::now();
    while !tables::read_record(&folder.path().join("part")).is_ok_and(|record| record.version == version) {
        assert!(begun.elapsed() < Duration::from_secs(60), "the run was not taken up");
        std::thread::sleep(Duration::from_millis(1));
    }
    if running.try_wait().unwrap().is_none() {
        let second =
            gillesph(folder.path(), &["run", "m.yaml", "--out", "part", "--force"]).output().unwrap();
        let message = words(&second);
        // It may just have finished in between.
        if second.status.code() == Some(2) {
            assert!(message.contains("another process"), "{message}");
        }
    }
    let output = running.wait_with_output().unwrap();
    let message = words(&output);
    assert!(output.status.success() && message.contains("version 0.0.9"), "{message}");
    same_tables(&folder.path().join("whole"), &folder.path().join("part"));
}

/// A disk that fills up: a file system of a few megabytes in memory. Needs the right to mount one.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_keeps_what_is_finished() {
    let folder = TempDir::new().unwrap();
    let disk = folder.path().join("disk");
    std::fs::create_dir(&disk).unwrap();
    let mount = |size: &str, how: &str| {
        let options = format!("size={size}{how}");
        let mut command = Command::new("mount");
        command.args(["-t", "tmpfs", "-o", &options, "tmpfs"]).arg(&disk).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    if !mount("3m", "") {
        eprintln!("skipped: no right to mount a file system");
        return;
    }
    std::fs::write(folder.path().join("m.yaml"), MANY).unwrap();
    let whole = gillesph(folder.path(), &["run", "m.yaml", "--out", "whole"]).output();
    let full = gillesph(folder.path(), &["run", "m.yaml", "--out", "disk/run"]).output();
    let grown = mount("1g", ",remount");
    let resumed = gillesph(folder.path(), &["run", "m.yaml", "--out", "disk/run", "--resume"]).output();
    let bytes = std::fs::read(disk.join("run/tables/series.parquet"));
    Command::new("umount").arg(&disk).status().unwrap();
    let (whole, full, resumed) = (whole.unwrap(), full.unwrap(), resumed.unwrap());
    assert!(whole.status.success() && grown);
    let message = words(&full);
    assert_eq!(full.status.code(), Some(1), "{message}");
    assert!(message.contains("make room") && message.contains("--resume"), "{message}");
    assert!(resumed.status.success(), "{}", words(&resumed));
    let expected = std::fs::read(folder.path().join("whole/tables/series.parquet")).unwrap();
    assert!(bytes.unwrap() == expected);
}

/// Out of memory: the process is ended by the system; what it has finished is there.
#[test]
#[cfg(target_os = "linux")]
fn a_run_that_is_out_of_memory_can_be_resumed() {
    let folder = TempDir::new().unwrap();
    std::fs::write(
        folder.path().join("m.yaml"),
        LONG.replace("until: 4 ms, realizations: 2", "until: 0.1 ms, realizations: 200"),
    )
    .unwrap();
    let whole = gillesph(folder.path(), &["run", "m.yaml", "--out", "whole"]).output().unwrap();
    assert!(whole.status.success(), "{}", words(&whole));
    // Less and less, until it is too little.
    for megabytes in [400, 200, 120, 80, 60] {
        let limited = format!(
            "ulimit -v {}; exec {} run m.yaml --out part --force --threads 1",
            megabytes * 1024,
            env!("CARGO_BIN_EXE_gillesph")
        );
        let output = Command::new("sh").arg("-c").arg(&limited).current_dir(folder.path()).output().unwrap();
        if !output.status.success() {
            break;
        }
    }
    let more: &[&str] = if folder.path().join("part/run.json").exists()
        && tables::read_record(&folder.path().join("part")).is_ok_and(|record| record.status != "finished")
    {
        &["--resume"]
    } else {
        &["--force"]
    };
    let arguments = [&["run", "m.yaml", "--out", "part"], more].concat();
    let resumed = gillesph(folder.path(), &arguments).output().unwrap();
    assert!(resumed.status.success(), "{}", words(&resumed));
    same_tables(&folder.path().join("whole"), &folder.path().join("part"));
}
