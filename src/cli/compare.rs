//! The verb `compare`.

use super::{Stop, print};
use crate::comparison::{Comparison, Question, Side, Wanted, compare as judge};
use crate::error::{Fault, ModelError};
use crate::quantity::{Dimension, Quantity};
use crate::tables;
use clap::Args;
use std::path::{Path, PathBuf};

/// Rows shown without `--all`.
const SHOWN: usize = 10;

/// Options of `compare`.
#[derive(Args)]
pub(crate) struct Options {
    /// Folder of the first run, the reference
    a: PathBuf,
    /// Folder of the second run
    b: PathBuf,
    /// Chance of any false alarm
    #[arg(long, value_name = "SHARE", default_value = "5%")]
    level: String,
    /// Also print the power to find this relative difference, e.g. 2%
    #[arg(long, value_name = "SHARE")]
    difference: Option<String>,
    /// Compare only this, e.g. "RL in membrane at 0.8 s", or a part of it (repeatable); fewer tests see more
    #[arg(long, value_name = "QUANTITY")]
    only: Vec<String>,
    /// Compare the output times that both runs have, where they differ
    #[arg(long)]
    common_times: bool,
    /// Show all rows, not only the least likely
    #[arg(long)]
    all: bool,
    /// Print everything as JSON
    #[arg(long, conflicts_with = "all")]
    json: bool,
    /// Write all rows as a table
    #[arg(long, value_name = "FILE.parquet|FILE.csv")]
    out: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long, requires = "out")]
    force: bool,
}

/// Compares two runs; exit status 1 where they differ.
pub(crate) fn compare(options: &Options) -> Result<(), Stop> {
    let mut faults = Vec::new();
    let question = question(options).map_err(|error| faults.extend(error.faults)).ok();
    if let Some(path) = &options.out {
        faults.extend(unwritable(path, options.force));
    }
    let mut side = |dir: &Path| Side::read(dir).map_err(|fault| faults.push(fault)).ok();
    let (a, b) = (side(&options.a), side(&options.b));
    let (Some(question), Some(a), Some(b), true) = (question, a, b, faults.is_empty()) else {
        return Err(ModelError { faults }.into());
    };
    let comparison = judge(&a, &b, &question)?;
    if let Some(path) = &options.out {
        // Status 1 says that the runs differ; what cannot be written is a fault like any other.
        tables::write_comparison(path, &comparison.rows)
            .map_err(|error| Fault::general(error.to_string(), "name another file with --out"))?;
    }
    print(&shown(&comparison, options));
    if comparison.differs { Err(Stop::Status(1)) } else { Ok(()) }
}

fn shown(comparison: &Comparison, options: &Options) -> String {
    if options.json {
        return serde_json::to_string_pretty(comparison).unwrap_or_default() + "\n";
    }
    let rows = comparison.rows.len();
    // All that differ are shown, and a few more.
    let differ = comparison.rows.iter().filter(|row| row.differs).count();
    comparison.text(if options.all { rows } else { rows.min(SHOWN.max(differ.min(3 * SHOWN))) })
}

fn question(options: &Options) -> Result<Question, ModelError> {
    let mut faults = Vec::new();
    let mut share = |option: &str, text: &str| {
        share(option, text).unwrap_or_else(|fault| {
            faults.push(fault);
            f64::NAN
        })
    };
    let level = share("--level", &options.level);
    let difference = options.difference.as_deref().map(|text| share("--difference", text));
    let mut only = Vec::new();
    for text in &options.only {
        match Wanted::parse(text) {
            Ok(wanted) => only.push(wanted),
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() {
        Ok(Question { level, difference, only, common_times: options.common_times })
    } else {
        Err(ModelError { faults })
    }
}

/// A share between 0 and 1: `5%`, `0.05`.
fn share(option: &str, text: &str) -> Result<f64, Fault> {
    let remedy = format!("write a share between 0 and 1, e.g. {option} 2% or {option} 0.02");
    match Quantity::parse(text) {
        Err(fault) => Err(Fault::general(format!("{option} {text}: {}", fault.reason), remedy)),
        Ok(q) if q.dimension == Dimension::NONE && q.value > 0.0 && q.value < 1.0 => Ok(q.value),
        Ok(_) => Err(Fault::general(format!("{option} {text}: this is no share between 0 and 1"), remedy)),
    }
}

fn unwritable(path: &Path, force: bool) -> Option<Fault> {
    let shown = path.display();
    if !path.extension().is_some_and(|e| e == "parquet" || e == "csv") {
        let reason = format!("--out {shown}: the name says no format");
        return Some(Fault::general(reason, "end it in .parquet or .csv"));
    }
    if path.exists() && !force {
        let reason = format!("--out {shown}: the file is there already");
        return Some(Fault::general(reason, "name another file, or replace it with --force"));
    }
    None
}
