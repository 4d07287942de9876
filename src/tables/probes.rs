//! `tables/probes.parquet`: quantities along lines and rings.

use super::frame::{self, Table};
use crate::error::RunError;
use crate::samples::ProbeRows;
use polars::prelude::*;
use std::path::Path;

/// Writes `tables/probes.parquet` below `dir`, sorted by realization; within one the given order stands.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written or the arrays of a row differ in length.
pub fn write_probes(dir: &Path, rows: &[ProbeRows]) -> Result<(), RunError> {
    let path = dir.join("tables/probes.parquet");
    if let Some(r) = rows.iter().find(|r| r.s.len() != r.value.len() || r.s.len() != r.position.len()) {
        let reason = format!("probe {} at {} s: arrays differ in length", r.probe, r.time);
        return Err(RunError::File { path: path.display().to_string(), reason });
    }
    let mut sorted: Vec<&ProbeRows> = rows.iter().collect();
    sorted.sort_by_key(|r| r.realization);
    // Blocks of constant count bound the memory of a row group.
    let chunks: Vec<&[&ProbeRows]> =
        if sorted.is_empty() { vec![&[]] } else { sorted.chunks(4096).collect() };
    frame::write_frames(&path, chunks.into_iter().map(row_group))
}

fn row_group(blocks: &[&ProbeRows]) -> PolarsResult<DataFrame> {
    let rows = || blocks.iter().flat_map(|b| (0..b.s.len()).map(move |k| (*b, k)));
    let probe: Vec<&str> = rows().map(|(b, _)| b.probe.as_str()).collect();
    let quantity: Vec<&str> = rows().map(|(b, _)| b.quantity.as_str()).collect();
    DataFrame::new_infer_height(vec![
        frame::text("probe", &probe),
        frame::whole("realization", rows().map(|(b, _)| b.realization).collect()),
        frame::reals("time", rows().map(|(b, _)| b.time).collect()),
        frame::reals("s", rows().map(|(b, k)| b.s[k]).collect()),
        frame::reals("x", rows().map(|(b, k)| b.position[k][0]).collect()),
        frame::reals("y", rows().map(|(b, k)| b.position[k][1]).collect()),
        frame::reals("z", rows().map(|(b, k)| b.position[k][2]).collect()),
        frame::text("quantity", &quantity),
        frame::reals("value", rows().map(|(b, k)| b.value[k]).collect()),
    ])
}

/// Reads `tables/probes.parquet` below `dir`, one entry per probe, realization, time and quantity.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_probes(dir: &Path) -> Result<Vec<ProbeRows>, RunError> {
    let table = Table::read(&dir.join("tables/probes.parquet"))?;
    let (probe, quantity) = (table.text("probe")?, table.text("quantity")?);
    let (realization, time) = (table.whole("realization")?, table.reals("time")?);
    let (s, value) = (table.reals("s")?, table.reals("value")?);
    let (x, y, z) = (table.reals("x")?, table.reals("y")?, table.reals("z")?);
    let mut out: Vec<ProbeRows> = Vec::new();
    for k in 0..table.rows() {
        let same = out.last().is_some_and(|r| {
            r.probe == probe[k]
                && r.quantity == quantity[k]
                && r.realization == realization[k]
                && r.time == time[k]
        });
        if !same {
            out.push(ProbeRows {
                probe: probe[k].to_string(),
                realization: realization[k],
                time: time[k],
                quantity: quantity[k].to_string(),
                ..ProbeRows::default()
            });
        }
        if let Some(row) = out.last_mut() {
            row.s.push(s[k]);
            row.position.push([x[k], y[k], z[k]]);
            row.value.push(value[k]);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let dir = tempfile::tempdir().unwrap();
        let row = |realization, quantity: &str| ProbeRows {
            probe: "ring".into(),
            realization,
            time: 0.25,
            quantity: quantity.into(),
            s: vec![0.0, 1.0],
            position: vec![[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]],
            value: vec![0.5, f64::from(realization)],
        };
        let rows = [row(0, "L"), row(0, "vx"), row(1, "L")];
        write_probes(dir.path(), &rows).unwrap();
        assert_eq!(read_probes(dir.path()).unwrap(), rows);
        write_probes(dir.path(), &[]).unwrap();
        assert!(read_probes(dir.path()).unwrap().is_empty());
    }
}
