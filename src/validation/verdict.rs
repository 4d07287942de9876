//! What a case came to: rows of ours, published and reference values, and whether they pass.

use super::Curves;
use crate::figures::Figure;
use std::fmt;

/// What a case came to.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    pub case: String,
    pub rows: Vec<Row>,
    /// What the figures show, as numbers.
    pub curves: Vec<Curves>,
    pub figures: Vec<Figure>,
    /// Wall time, s.
    pub seconds: f64,
}

/// One number of a case beside what it should be.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub quantity: String,
    pub ours: f64,
    pub published: Option<f64>,
    pub reference: Option<f64>,
    /// The error that is judged; `quantity` says which.
    pub error: f64,
    /// Largest `error` that passes; infinite for a number that is stated, not judged.
    pub limit: f64,
}

impl Row {
    /// `ok`, `FAILED`, or `stated` where there is no limit.
    #[must_use]
    pub fn verdict(&self) -> &'static str {
        match () {
            () if self.limit == f64::INFINITY => "stated",
            () if self.error <= self.limit => "ok",
            () => "FAILED",
        }
    }
}

impl Verdict {
    /// Whether every row is within its limit.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.rows.iter().all(|row| row.verdict() != "FAILED")
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} ({:.1} s)", self.case, self.seconds)?;
        writeln!(
            f,
            "  {:<62} {:>11} {:>11} {:>11} {:>10} {:>9}",
            "quantity", "ours", "published", "reference", "error", "limit"
        )?;
        for row in &self.rows {
            let number = |value: Option<f64>| value.map_or_else(|| "-".into(), |v| format!("{v:.4e}"));
            let judged = row.limit < f64::INFINITY;
            let or_none = |text: String| if judged { text } else { "-".into() };
            writeln!(
                f,
                "  {:<62} {:>11.4e} {:>11} {:>11} {:>10} {:>9}  {}",
                row.quantity,
                row.ours,
                number(row.published),
                number(row.reference),
                or_none(format!("{:.2e}", row.error)),
                or_none(format!("{:.1e}", row.limit)),
                row.verdict()
            )?;
        }
        Ok(())
    }
}
