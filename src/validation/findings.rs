//! What a case found: rows, the curves behind its figures, the figures; and how they are written.

use super::{Row, Verdict};
use crate::error::RunError;
use crate::figures::{self, Figure};
use crate::tables::write_bytes;
use std::fmt::Write;
use std::path::Path;

/// Named columns of equal length, written as comma-separated numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// File name without ending.
    pub name: String,
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Curves {
    /// Columns by name; what is shorter than the others ends in empty cells.
    pub fn new<'a>(name: &str, columns: impl IntoIterator<Item = (&'a str, Vec<f64>)>) -> Curves {
        let columns = columns.into_iter().map(|(name, values)| (name.to_string(), values)).collect();
        Curves { name: name.into(), columns }
    }

    fn text(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|c| c.0.as_str()).collect();
        let mut out = names.join(",") + "\n";
        for k in 0..self.columns.iter().map(|c| c.1.len()).max().unwrap_or(0) {
            let cells: Vec<String> = self
                .columns
                .iter()
                .map(|c| c.1.get(k).map_or_else(String::new, |v| format!("{v:.9e}")))
                .collect();
            out.push_str(&cells.join(","));
            out.push('\n');
        }
        out
    }
}

/// Rows, curves and figures of a case.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    pub rows: Vec<Row>,
    pub curves: Vec<Curves>,
    pub figures: Vec<Figure>,
}

impl From<Vec<Row>> for Findings {
    fn from(rows: Vec<Row>) -> Findings {
        Findings { rows, ..Findings::default() }
    }
}

/// Writes a verdict into a folder: `verdict.csv`, one file of numbers and one figure (PNG and SVG) each, and
/// `captions.md`.
///
/// # Errors
/// [`RunError::File`] if a file cannot be written.
pub fn write(verdict: &Verdict, dir: &Path) -> Result<(), RunError> {
    write_bytes(&dir.join("verdict.csv"), table(&verdict.rows).as_bytes())?;
    for curves in &verdict.curves {
        write_bytes(&dir.join(format!("{}.csv", curves.name)), curves.text().as_bytes())?;
    }
    let mut captions = format!("# {}\n", verdict.case);
    for figure in &verdict.figures {
        figures::save(figure, dir)?;
        // Writing to a String cannot fail.
        let _ = write!(captions, "\n`{}.png`: {}. {}\n", figure.name, figure.title, figure.caption);
    }
    if verdict.figures.is_empty() {
        Ok(())
    } else {
        write_bytes(&dir.join("captions.md"), captions.as_bytes())
    }
}

/// Rows as comma-separated text; an empty cell where a number is missing.
fn table(rows: &[Row]) -> String {
    let mut out = String::from("quantity,ours,published,reference,error,limit,verdict\n");
    for row in rows {
        let cell = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.6e}"));
        let judged = (row.limit < f64::INFINITY).then_some(());
        let cells = [
            format!("\"{}\"", row.quantity.replace('"', "\"\"")),
            cell(Some(row.ours)),
            cell(row.published),
            cell(row.reference),
            cell(judged.map(|()| row.error)),
            cell(judged.map(|()| row.limit)),
            row.verdict().into(),
        ];
        out.push_str(&cells.join(","));
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_curves_become_tables() {
        let stated =
            Row { quantity: "wall \"time\"".into(), ours: 2.0, limit: f64::INFINITY, ..Row::default() };
        let failed = Row {
            quantity: "e, rms".into(),
            ours: 1.0,
            published: Some(0.5),
            error: 1.0,
            limit: 0.1,
            ..Row::default()
        };
        let text = table(&[stated, failed]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1], "\"wall \"\"time\"\"\",2.000000e0,,,,,stated");
        assert_eq!(lines[2], "\"e, rms\",1.000000e0,5.000000e-1,,1.000000e0,1.000000e-1,FAILED");
        let curves = Curves::new("c", [("t", vec![0.0, 1.0]), ("u", vec![0.5])]);
        assert_eq!(curves.text(), "t,u\n0.000000000e0,5.000000000e-1\n1.000000000e0,\n");
    }
}
