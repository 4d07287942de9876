//! Published cases, each run with ours beside the published and the reference values.

use crate::error::RunError;
use std::fmt;

/// A case by name.
pub struct Case {
    pub name: &'static str,
    /// One line on it.
    pub what: &'static str,
    /// Runs it; `full` asks for all resolutions.
    pub run: fn(full: bool) -> Result<Verdict, RunError>,
}

/// All cases, in the order they run.
pub const CASES: &[Case] = &[];

/// What a case came to.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    pub case: String,
    pub rows: Vec<Row>,
}

/// One number of a case beside what it should be.
#[derive(Clone, Debug)]
pub struct Row {
    pub quantity: String,
    pub ours: f64,
    pub published: Option<f64>,
    pub reference: Option<f64>,
    /// Largest value allowed for `error`.
    pub limit: f64,
    /// The error that is judged, e.g. relative to the reference.
    pub error: f64,
}

impl Verdict {
    /// Whether every row is within its limit.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.rows.iter().all(|row| row.error <= row.limit)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.case)?;
        writeln!(
            f,
            "  {:<48} {:>12} {:>12} {:>12} {:>10} {:>10}",
            "quantity", "ours", "published", "reference", "error", "limit"
        )?;
        for row in &self.rows {
            let number = |value: Option<f64>| value.map_or_else(|| "-".into(), |v| format!("{v:.5e}"));
            let verdict = if row.error <= row.limit { "ok" } else { "FAILED" };
            writeln!(
                f,
                "  {:<48} {:>12.5e} {:>12} {:>12} {:>10.3e} {:>10.1e}  {verdict}",
                row.quantity,
                row.ours,
                number(row.published),
                number(row.reference),
                row.error,
                row.limit
            )?;
        }
        Ok(())
    }
}
