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
        read_series(&self.run(&model, "out", options)).unwrap()
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
