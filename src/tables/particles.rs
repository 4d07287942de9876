//! `tables/particles/`: particles at output times, one folder a realization.

use super::frame::{self, Table};
use crate::error::RunError;
use crate::record::{PARTICLE_COLUMNS, SOLID_COLUMNS};
use crate::samples::ParticleFrame;
use polars::prelude::*;
use std::path::{Path, PathBuf};

/// Writes `tables/particles/realization=NNNN/part-NNNNN.parquet` below `dir`, a row group a frame.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written, arrays differ in length, or a species has the name of
/// another column.
pub fn write_particles(
    dir: &Path,
    realization: u32,
    part: u32,
    species: &[String],
    frames: &[ParticleFrame],
) -> Result<(), RunError> {
    let path = dir.join(format!("tables/particles/realization={realization:04}/part-{part:05}.parquet"));
    if let Some(name) = species.iter().find(|s| is_taken(s)) {
        let reason = format!("species {name} has the name of another column; rename it");
        return Err(RunError::File { path: path.display().to_string(), reason });
    }
    frame::write_frames(&path, frames.iter().map(|f| row_group(species, f)))
}

/// Whether a column is none of a species.
fn is_taken(name: &str) -> bool {
    PARTICLE_COLUMNS.contains(&name) || SOLID_COLUMNS.contains(&name)
}

fn row_group(species: &[String], f: &ParticleFrame) -> PolarsResult<DataFrame> {
    let group: Vec<&str> = (0..f.group.len()).map(|i| f.group_name(i)).collect();
    let part = |of: &[[f64; 3]], axis: usize| of.iter().map(|v| v[axis]).collect();
    let mut columns = vec![
        frame::reals("time", vec![f.time; f.len()]),
        frame::whole("particle", (0..f.len() as u32).collect()),
        frame::text("group", &group),
        frame::reals("x", part(&f.position, 0)),
        frame::reals("y", part(&f.position, 1)),
        frame::reals("z", part(&f.position, 2)),
        frame::reals("vx", part(&f.velocity, 0)),
        frame::reals("vy", part(&f.velocity, 1)),
        frame::reals("vz", part(&f.velocity, 2)),
        frame::reals("density", f.density.clone()),
        frame::reals("pressure", f.pressure.clone()),
        frame::reals("volume_fraction", f.volume_fraction.clone()),
        frame::reals("volume", f.volume.clone()),
    ];
    for (name, values) in SOLID_COLUMNS.iter().zip([&f.stress, &f.stretch]) {
        if !values.is_empty() {
            columns.push(frame::reals(name, values.clone()));
        }
    }
    for (name, amount) in species.iter().zip(&f.amounts) {
        columns.push(frame::reals(name, amount.clone()));
    }
    DataFrame::new_infer_height(columns)
}

/// The parts there are below `dir`, in order: realization, part number, path.
#[must_use]
pub fn list_particles(dir: &Path) -> Vec<(u32, u32, PathBuf)> {
    let entries = |folder: &Path| -> Vec<PathBuf> {
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect()
    };
    let number = |path: &Path, before: &str, after: &str| -> Option<u32> {
        path.file_name()?.to_str()?.strip_prefix(before)?.strip_suffix(after)?.parse().ok()
    };
    let mut parts = Vec::new();
    for folder in entries(&dir.join("tables/particles")) {
        let Some(realization) = number(&folder, "realization=", "") else { continue };
        for path in entries(&folder) {
            if let Some(part) = number(&path, "part-", ".parquet") {
                parts.push((realization, part, path));
            }
        }
    }
    parts.sort();
    parts
}

/// Reads one part: names of the species and the frames in order.
///
/// # Errors
/// [`RunError::File`] if the file or a column is missing.
pub fn read_particles(path: &Path) -> Result<(Vec<String>, Vec<ParticleFrame>), RunError> {
    let table = Table::read(path)?;
    let species: Vec<String> = table.names().into_iter().filter(|n| !is_taken(n)).collect();
    let has = |name: &&str| table.names().iter().any(|known| known == name);
    let solid = SOLID_COLUMNS
        .iter()
        .filter(|name| has(name))
        .map(|name| table.reals(name))
        .collect::<Result<Vec<_>, _>>()?;
    let of_solid = |k: usize, range: std::ops::Range<usize>| {
        solid.get(k).map_or(Vec::new(), |values| values[range].to_vec())
    };
    let time = table.reals("time")?;
    let (groups, group) = frame::index_of_names(&table.text("group")?);
    let n = PARTICLE_COLUMNS[3..].iter().map(|name| table.reals(name)).collect::<Result<Vec<_>, _>>()?;
    let amounts = species.iter().map(|name| table.reals(name)).collect::<Result<Vec<_>, _>>()?;
    let mut frames = Vec::new();
    let mut start = 0;
    while start < time.len() {
        let end = start + time[start..].iter().take_while(|&&t| t == time[start]).count().max(1);
        let vectors = |a: usize| (start..end).map(|k| [n[a][k], n[a + 1][k], n[a + 2][k]]).collect();
        frames.push(ParticleFrame {
            time: time[start],
            groups: groups.clone(),
            group: group[start..end].iter().map(|&g| g as u16).collect(),
            position: vectors(0),
            velocity: vectors(3),
            density: n[6][start..end].to_vec(),
            pressure: n[7][start..end].to_vec(),
            volume_fraction: n[8][start..end].to_vec(),
            volume: n[9][start..end].to_vec(),
            stress: of_solid(0, start..end),
            stretch: of_solid(1, start..end),
            amounts: amounts.iter().map(|a| a[start..end].to_vec()).collect(),
        });
        start = end;
    }
    Ok((species, frames))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let dir = tempfile::tempdir().unwrap();
        let at = |time| ParticleFrame {
            time,
            groups: vec!["water".into(), "cell".into()],
            group: vec![0, 1],
            position: vec![[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]],
            velocity: vec![[0.0, time, 0.0]; 2],
            density: vec![1000.0; 2],
            pressure: vec![0.5, -0.5],
            volume_fraction: vec![0.0, 1.0],
            volume: vec![1e-18; 2],
            stress: vec![0.0, 2e5],
            stretch: vec![1.0, 1.25],
            amounts: vec![vec![7.0, 8.0]],
        };
        let frames = vec![at(0.0), at(1.0)];
        write_particles(dir.path(), 3, 0, &["L".into()], &frames).unwrap();
        let parts = list_particles(dir.path());
        assert_eq!((parts.len(), parts[0].0, parts[0].1), (1, 3, 0));
        assert!(parts[0].2.ends_with("realization=0003/part-00000.parquet"));
        assert_eq!(read_particles(&parts[0].2).unwrap(), (vec!["L".to_string()], frames.clone()));
        assert!(write_particles(dir.path(), 0, 0, &["density".into()], &frames).is_err());
    }
}
