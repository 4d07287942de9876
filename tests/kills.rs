//! Runs that are killed at random moments, as by a power cut or the kernel: each is taken up again, and again, until it
//! ends, and its tables are those of a run that was left alone, to the byte.
//!
//! `GILLESPH_KILLS` says how many kills there are to be (14 if it is not set); 200 are one command:
//! `GILLESPH_KILLS=200 cargo test --release --test kills -- --nocapture`.

use rand::Rng;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Instant;
use tempfile::TempDir;

/// Many short realizations.
const VOLUME: &str = "\
name: volume
reactions:
  species: { A: , B: }
  kinetics: molecules
  reactions: { there: { equation: A <-> B, rate: 1 1/s, reverse: 2 1/s } }
domain: { kind: well_mixed, volume: 1 fL }
initial: { A: 3000 }
run: { until: 100 s, realizations: 1500, seed: 5, checkpoint_every: 50 ms }
output: { every: 1 s, covariance: true, histogram: [ { species: B } ] }
";

/// A few realizations in steps, so that states are saved on the way.
const GRAPH: &str = "\
name: graph
reactions:
  species: { A: { diffusion: 10 um^2/s }, B: { diffusion: 10 um^2/s, representation: continuous } }
  kinetics: molecules
  reactions: { decay: { equation: A -> B, rate: 0.01 1/s }, back: { equation: B -> A, rate: 0.01 1/s } }
domain:
  kind: graph
  volumes: [1 fL, 1 fL, 1 fL, 1 fL]
  links: [[0, 1, 0.5 um], [1, 2, 0.5 um], [2, 3, 0.5 um]]
chemistry: { step: 1 ms }
initial: { A: [1000, 0, 0, 0] }
run: { until: 100 s, realizations: 6, seed: 5, checkpoint_every: 50 ms }
output: { every: 0.5 s }
";

/// One flow with realizations on it.
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
chemistry: { step: 0.25 us }
initial: { medium: { A: 10000 } }
run: { until: 600 us, realizations: 4, seed: 5, checkpoint_every: 50 ms }
output:
  every: 2 us
  particles: { every: 20 us, realizations: 2 }
  probes: { across: { line: { from: [8 um, 0.5 um], to: [8 um, 7.5 um], points: 8 } } }
";

/// The same with thermal noise: each realization on a flow of its own.
const NOISE: (&str, &str) = ("speed: 1 mm/s }", "speed: 1 mm/s, temperature: 300 K }");

/// A solid that swings, softened by a species whose molecules differ between the realizations.
const SOLID: &str = "\
name: solid
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
    drag: 100 1/s
    viscosity: 1e-5 Pa s
    law: neo_hookean
    velocity: [0, \"1000 s^-1 * x\"]
    clamped: { box: { min: [-2 um, 0], max: [0, 4 um] } }
    softening: { by: A, factor: 0.2, at: 2 uM }
initial: { bar: { A: { concentration: 2 uM, deal: poisson } } }
run: { until: 2 ms, realizations: 4, seed: 5, checkpoint_every: 50 ms }
output:
  every: 10 us
  particles: { every: 0.2 ms, realizations: 2 }
  points: { tip: { solid: bar, at: [20 um, 2 um] } }
";

/// A wall in balance that grows where its molecules are, and gets new columns.
const VESSEL: &str = "\
name: vessel
reactions:
  species: { A: { diffusion: 1 um^2/s } }
  reactions: { make: { equation: 0 <-> A, rate: 20 uM/s, reverse: 1 1/s } }
chemistry: { step: 0.5 s }
domain: { kind: particles, dimensions: 2, min: [-20 um, -20 um], max: [20 um, 20 um], thickness: 1 um }
particles: { spacing: 0.8 um, support: 2 }
groups:
  wall: { material: solid, shape: { ring: { centre: [0, 0], inner: 4 um, outer: 6.4 um } } }
solids:
  wall:
    density: 1000 kg/m^3
    youngs_modulus: 20 MPa
    poisson_ratio: 0.3
    law: neo_hookean
    placement: layers
    softening: { by: A, factor: 0.1, at: 20 uM }
    turgor: { pressure: 0.5 MPa }
    growth: { rate: 3e-8 1/Pa/s, yield: 0.4 MPa, by: A, at: 20 uM, insert_at: 1.2, reserve: 600 }
mechanics: { mode: quasi_static, tolerance: 1e-3 }
fluid: { method: none }
initial: { wall: { A: { concentration: 20 uM, deal: poisson } } }
run: { until: 20 s, realizations: 4, seed: 5, checkpoint_every: 50 ms }
output: { every: 0.5 s, particles: { every: 5 s, realizations: 2 } }
";

struct Case {
    folder: TempDir,
    name: &'static str,
    threads: &'static str,
}

impl Case {
    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gillesph"));
        command.current_dir(self.folder.path()).args(["run", "m.yaml", "--quiet", "--out", out]);
        command.args(["--threads", self.threads]).args(more);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn dir(&self, out: &str) -> PathBuf {
        self.folder.path().join(out)
    }
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// All files below a folder with their bytes, by path.
fn files(dir: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut open = vec![dir.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.push((path.strip_prefix(dir).unwrap().to_path_buf(), std::fs::read(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

/// Kills runs of a model `kills` times in all; each run as often as it takes.
fn killed(case: &Case, model: &str, kills: u32, random: &mut Xoshiro256PlusPlus) {
    std::fs::write(case.folder.path().join("m.yaml"), model).unwrap();
    let begun = Instant::now();
    let whole = case.command("whole", &[]).output().unwrap();
    let needed = begun.elapsed();
    assert!(whole.status.success(), "{}: {}", case.name, words(&whole));
    let expected = files(&case.dir("whole").join("tables"));
    assert!(!expected.is_empty());
    let (mut killed, mut runs) = (0, 0);
    while killed < kills {
        let out = format!("run{runs}");
        let dir = case.dir(&out);
        runs += 1;
        loop {
            // A run cut off before it wrote a record left nothing to go on from.
            let more: &[&str] = if dir.join("run.json").exists() { &["--resume"] } else { &[] };
            let mut child = case.command(&out, more).spawn().unwrap();
            if killed < kills {
                std::thread::sleep(needed.mul_f64(random.random_range(0.02..0.7)));
                child.kill().unwrap();
            }
            let output = child.wait_with_output().unwrap();
            if output.status.success() {
                break;
            }
            assert!(output.status.code().is_none(), "{} {out}: {}", case.name, words(&output));
            killed += 1;
            // What bears its final name is complete.
            for (path, bytes) in files(&dir.join("tables")) {
                if path.to_string_lossy().contains(".writing-") {
                    continue;
                }
                let same = expected.iter().find(|(name, _)| *name == path);
                assert!(same.is_some_and(|(_, all)| *all == bytes), "{} {out}: {path:?}", case.name);
            }
        }
        let found = files(&dir.join("tables"));
        let names = |of: &[(PathBuf, Vec<u8>)]| of.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&found), names(&expected), "{} {out}", case.name);
        for ((name, bytes), (_, all)) in found.iter().zip(&expected) {
            assert!(bytes == all, "{} {out}: {name:?} differs", case.name);
        }
        assert!(!dir.join("checkpoint").exists(), "{} {out}: the checkpoint stays", case.name);
        std::fs::remove_dir_all(&dir).unwrap();
    }
    eprintln!("{}: {killed} kills in {runs} runs of {:.1} s", case.name, needed.as_secs_f64());
}

/// A kill at any moment, of runs on one and on two threads.
#[test]
#[cfg(unix)]
fn what_was_killed_is_resumed_to_the_same_bytes() {
    let kills: u32 = std::env::var("GILLESPH_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(14);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(20);
    let noisy = CHANNEL.replacen(NOISE.0, NOISE.1, 1).replacen("until: 600 us", "until: 100 us", 1);
    // The same bar, its stress integrated in time.
    let jaumann = [
        "    viscosity: 1e-5 Pa s\n    law: neo_hookean\n",
        "    softening: { by: A, factor: 0.2, at: 2 uM }\n",
    ]
    .iter()
    .fold(SOLID.to_string(), |text, gone| text.replacen(gone, "", 1))
    .replacen("    drag:", "    method: jaumann\n    drag:", 1)
    .replacen("1000 s^-1 * x", "100 s^-1 * x", 1);
    let cases = [
        ("volume", VOLUME, "2"),
        ("graph", GRAPH, "1"),
        ("channel", CHANNEL, "2"),
        ("noise", noisy.as_str(), "2"),
        ("solid", SOLID, "2"),
        ("jaumann", jaumann.as_str(), "2"),
        ("vessel", VESSEL, "2"),
    ];
    let count = cases.len() as u32;
    for (k, (name, model, threads)) in cases.into_iter().enumerate() {
        let case = Case { folder: TempDir::new().unwrap(), name, threads };
        let share = kills / count + u32::from((k as u32) < kills % count);
        killed(&case, model, share, &mut random);
    }
}
