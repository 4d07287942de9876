//! The program as a user meets it: a model in YAML, the binary, the folder it leaves.
#![allow(dead_code)] // each test file uses a part

use gillesph::tables::{SeriesTable, read_series};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own, gone at the end of the test.
pub struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    pub fn new() -> Bench {
        Bench { folder: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a model and returns its path.
    pub fn model(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Runs a model into the folder `out` with further options, expecting success.
    pub fn run(&self, model: &Path, out: &str, options: &[&str]) -> PathBuf {
        let dir = self.path(out);
        let mut arguments = vec!["run", model.to_str().unwrap(), "--quiet", "--out", dir.to_str().unwrap()];
        arguments.extend(options);
        gillesph(&arguments);
        dir
    }

    /// Runs a model given as text and reads its series back.
    pub fn series(&self, text: &str, options: &[&str]) -> SeriesTable {
        let model = self.model("model.yaml", text);
        let options = [options, &["--force"]].concat();
        read_series(&self.run(&model, "out", &options)).unwrap()
    }
}

/// A file of the repository.
pub fn shipped(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Runs the program; it must exit 0.
pub fn gillesph(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_gillesph")).args(arguments).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "gillesph {arguments:?}: {}\n{message}", output.status);
    output
}

/// Amounts of a species in a group at a time across realizations.
pub fn amounts(series: &SeriesTable, group: &str, species: &str, time: f64) -> Vec<f64> {
    let column = series.columns.find(group, species).unwrap();
    let near = |t: &f64| (t - time).abs() <= 1e-9 * time.max(1e-9);
    series.across(series.times.iter().position(near).unwrap(), column)
}

/// `run.json` of a folder.
pub fn record(dir: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(dir.join("run.json")).unwrap()).unwrap()
}

/// A small, coarse channel: 200 particles of water at 1 µm (1 fL, 602 molecules at 1 µM) pumped past a
/// disc of radius 2 µm whose rim carries receptors; 500 nM of ligand at the start, 1 µM at the inlet.
pub fn channel(chemistry: &str, run: &str) -> String {
    channel_with(
        chemistry,
        run,
        "kinetics: concentration
  reactions:
    binding: { equation: R + L <-> RL, rate: 500 /uM/s, reverse: 500 1/s }",
        "membrane: { R: 1 uM }",
    )
}

/// The same with other reactions between `L`, `R` and `RL`, and other amounts at the start besides
/// the ligand.
pub fn channel_with(chemistry: &str, run: &str, reactions: &str, initial: &str) -> String {
    format!(
        "name: small_channel
reactions:
  species:
    L:  {{ diffusion: 347 um^2/s }}
    R:  {{ only_in: [membrane] }}
    RL: {{ only_in: [membrane] }}
  {reactions}
domain:
  kind: particles
  dimensions: 2
  thickness: 1 um
  min: [0, 0]
  max: [20 um, 10 um]
  boundaries: {{ x: periodic, y: free_slip }}
particles: {{ spacing: 1 um, kernel: lucy, support: 3 }}
groups:
  inlet:    {{ material: zone, shape: {{ box: {{ min: [0, 0], max: [3 um, 10 um] }} }} }}
  membrane: {{ material: wall, spacing: 0.5 um, lattice: rings, shape: {{ ring: {{ centre: [10 um, 5 um], inner: 1 um, outer: 2 um }} }} }}
  interior: {{ material: wall, spacing: 0.5 um, lattice: rings, shape: {{ disc: {{ centre: [10 um, 5 um], radius: 1 um }} }}, holds: none }}
  medium:   {{ material: fluid, shape: everything_else }}
fluid:
  method: sph_bvf
  density: 1000 kg/m^3
  viscosity: 1 mPa s
  speed: 1.25 mm/s
  settle: 0.1 ms
conditions:
  inflow:
    sponge: {{ in: inlet, rate: 1e9 1/s, velocity: [1.25 mm/s, 0], species: {{ L: 1 uM }} }}
  outlet: {{ barrier: {{ axis: x, at: 0 }} }}
initial:
  medium: {{ L: {{ concentration: 500 nM, deal: poisson }} }}
  {initial}
chemistry: {chemistry}
run: {run}
output:
  every: 0.2 ms
  particles: {{ times: [0, 0.2 ms], realizations: 1 }}
  probes:
    ring: {{ ring: {{ centre: [10 um, 5 um], inner: 1 um, outer: 2 um, sectors: 12, in: membrane }} }}
    line: {{ line: {{ from: [3 um, 5 um], to: [19 um, 5 um], points: 17 }}, species: [L] }}
"
    )
}
