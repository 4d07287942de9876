//! The table that `compare` writes: one row a tested mean or variance.

use super::frame;
use super::write_bytes;
use crate::error::RunError;
use polars::prelude::*;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// A mean or a variance of one quantity in two runs; numbers that do not exist are NaN.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonRow {
    /// s.
    pub time: f64,
    pub group: String,
    pub species: String,
    /// `mean` or `variance`, of the amount in molecules.
    pub moment: &'static str,
    /// In the first run; molecules, or their square.
    pub a: f64,
    /// In the second run.
    pub b: f64,
    /// b - a.
    pub difference: f64,
    /// Of the difference.
    pub standard_error: f64,
    /// (b - a)/|a|.
    pub relative: f64,
    /// Difference in standard errors; infinite where both are constant and differ.
    pub t: f64,
    pub freedom: f64,
    /// Chance of so large a difference, either way, where there is none.
    pub p: f64,
    /// Adjusted for the number of rows (Holm).
    pub p_adjusted: f64,
    /// Smallest true relative difference that is found with 80 % power.
    pub detectable: f64,
    /// Chance to find the relative difference asked for; NaN where none was.
    pub power: f64,
    /// How it was judged: `paired`, `independent`, `counted`, `signs`, `certain`.
    pub judged: &'static str,
    pub differs: bool,
}

const NAMES: [&str; 12] = [
    "time",
    "a",
    "b",
    "difference",
    "standard_error",
    "relative",
    "t",
    "freedom",
    "p",
    "p_adjusted",
    "detectable",
    "power",
];

impl ComparisonRow {
    /// The numbers in the order of [`NAMES`].
    fn numbers(&self) -> [f64; 12] {
        [
            self.time,
            self.a,
            self.b,
            self.difference,
            self.standard_error,
            self.relative,
            self.t,
            self.freedom,
            self.p,
            self.p_adjusted,
            self.detectable,
            self.power,
        ]
    }
}

/// Writes the rows as Parquet, or as CSV where the name ends in `.csv`.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written.
pub fn write_comparison(path: &Path, rows: &[ComparisonRow]) -> Result<(), RunError> {
    if path.extension().is_some_and(|e| e == "csv") {
        return write_bytes(path, csv(rows).as_bytes());
    }
    let text = |name: &str, of: fn(&ComparisonRow) -> &str| {
        frame::text(name, &rows.iter().map(of).collect::<Vec<_>>())
    };
    let mut columns =
        vec![text("group", |r| &r.group), text("species", |r| &r.species), text("moment", |r| r.moment)];
    for (k, name) in NAMES.iter().enumerate() {
        columns.push(frame::reals(name, rows.iter().map(|r| r.numbers()[k]).collect()));
    }
    // As in every other table the time stands first.
    columns[..4].rotate_right(1);
    columns.push(text("judged", |r| r.judged));
    columns.push(Column::new("differs".into(), rows.iter().map(|r| r.differs).collect::<Vec<bool>>()));
    frame::write_frames(path, std::iter::once(DataFrame::new_infer_height(columns)))
}

/// The rows as text, one header line; a number that does not exist is an empty field.
fn csv(rows: &[ComparisonRow]) -> String {
    let mut out = format!("{},group,species,moment,{},judged,differs\n", NAMES[0], NAMES[1..].join(","));
    // A name with a comma or a quote in it is quoted.
    let quoted = |word: &str| {
        if word.contains([',', '"', '\n']) {
            format!("\"{}\"", word.replace('"', "\"\""))
        } else {
            word.to_string()
        }
    };
    for row in rows {
        let numbers = row.numbers().map(|n| if n.is_nan() { String::new() } else { n.to_string() });
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{}",
            numbers[0],
            quoted(&row.group),
            quoted(&row.species),
            row.moment,
            numbers[1..].join(","),
            row.judged,
            row.differs
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::frame::Table;
    use super::*;

    #[test]
    fn parquet_and_csv_hold_the_same_rows() {
        let row = ComparisonRow {
            time: 0.5,
            group: "north, upper".into(),
            species: "A".into(),
            moment: "mean",
            a: 10.0,
            b: 11.0,
            difference: 1.0,
            standard_error: 0.25,
            relative: 0.1,
            t: 4.0,
            freedom: 98.0,
            p: 1e-4,
            p_adjusted: 2e-4,
            detectable: 0.07,
            power: f64::NAN,
            judged: "paired",
            differs: true,
        };
        let folder = tempfile::tempdir().unwrap();
        let (parquet, text) = (folder.path().join("c.parquet"), folder.path().join("c.csv"));
        for path in [&parquet, &text] {
            write_comparison(path, std::slice::from_ref(&row)).unwrap();
        }
        let table = Table::read(&parquet).unwrap();
        assert_eq!(table.names()[..5], ["time", "group", "species", "moment", "a"]);
        assert_eq!(table.reals("p_adjusted").unwrap(), [2e-4]);
        assert_eq!(
            std::fs::read_to_string(&text).unwrap().lines().nth(1).unwrap(),
            "0.5,\"north, upper\",A,mean,10,11,1,0.25,0.1,4,98,0.0001,0.0002,0.07,,paired,true"
        );
        write_comparison(&parquet, &[]).unwrap();
        assert_eq!(Table::read(&parquet).unwrap().rows(), 0);
    }
}
