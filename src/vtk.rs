//! ParaView files: one `.vtu` a frame and a `.pvd` that strings them together in time.

use crate::chemistry::AVOGADRO;
use crate::error::RunError;
use crate::tables::{ParticleFrame, write_bytes};
use std::fmt::Write;
use std::path::Path;

/// Writes the particles of a frame as an unstructured grid of vertices, in SI units: arrays `particle`, `group`
/// (index; the names stand in a comment), `velocity`, `density`, `pressure`, `volume_fraction`, `volume`, for each species its
/// amount (molecules) and, where volumes are known, `<species> concentration` (mol/m³). ASCII XML, VTK file format 0.1.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written.
pub fn write_vtu(path: &Path, frame: &ParticleFrame, species: &[String]) -> Result<(), RunError> {
    let n = frame.len();
    let mut out = String::with_capacity(n * 160);
    out.push_str("<?xml version=\"1.0\"?>\n");
    let names: Vec<String> =
        frame.groups.iter().enumerate().map(|(k, g)| format!("{k} {}", escape(g))).collect();
    // Two hyphens would end an XML comment.
    let _ = writeln!(out, "<!-- groups: {} -->", names.join(", ").replace("--", "- -"));
    out.push_str("<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n");
    let _ = writeln!(out, "<FieldData>");
    array(&mut out, "Float64", "TimeValue", 1, std::iter::once(frame.time));
    out = out.replacen("Name=\"TimeValue\"", "Name=\"TimeValue\" NumberOfTuples=\"1\"", 1);
    let _ = writeln!(out, "</FieldData>\n<Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{n}\">\n<Points>");
    array(&mut out, "Float64", "position", 3, frame.position.iter().flatten().copied());
    out.push_str("</Points>\n<PointData>\n");
    array(&mut out, "UInt32", "particle", 1, 0..n);
    array(&mut out, "UInt16", "group", 1, frame.group.iter());
    array(&mut out, "Float64", "velocity", 3, frame.velocity.iter().flatten().copied());
    for (name, values) in [
        ("density", &frame.density),
        ("pressure", &frame.pressure),
        ("volume_fraction", &frame.volume_fraction),
        ("volume", &frame.volume),
        ("stress", &frame.stress),
        ("stretch", &frame.stretch),
    ] {
        if values.len() == n {
            array(&mut out, "Float64", name, 1, values.iter());
        }
    }
    for (name, amount) in species.iter().zip(&frame.amounts) {
        array(&mut out, "Float64", name, 1, amount.iter());
        if frame.volume.len() == n {
            let concentration = amount.iter().zip(&frame.volume).map(|(a, v)| a / (AVOGADRO * v));
            array(&mut out, "Float64", &format!("{name} concentration"), 1, concentration);
        }
    }
    out.push_str("</PointData>\n<Cells>\n");
    array(&mut out, "Int64", "connectivity", 1, 0..n);
    array(&mut out, "Int64", "offsets", 1, 1..=n);
    // Cell type 1 is VTK_VERTEX.
    array(&mut out, "UInt8", "types", 1, std::iter::repeat_n(1, n));
    out.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    write_bytes(path, out.as_bytes())
}

/// Writes a collection: pairs of time (s) and file, the file relative to the folder of `path`.
///
/// # Errors
/// [`RunError::File`] if the file cannot be written.
pub fn write_pvd(path: &Path, files: &[(f64, String)]) -> Result<(), RunError> {
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, file) in files {
        let _ = writeln!(out, "<DataSet timestep=\"{time:e}\" part=\"0\" file=\"{}\"/>", escape(file));
    }
    out.push_str("</Collection>\n</VTKFile>\n");
    write_bytes(path, out.as_bytes())
}

fn array(
    out: &mut String,
    kind: &str,
    name: &str,
    components: usize,
    values: impl Iterator<Item = impl std::fmt::Display>,
) {
    let name = escape(name);
    let _ = writeln!(
        out,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">"
    );
    for value in values {
        // The shortest decimal that reads back as the same number.
        let _ = write!(out, "{value} ");
    }
    out.push_str("\n</DataArray>\n");
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_cells_and_arrays_have_their_numbers() {
        let dir = tempfile::tempdir().unwrap();
        let frame = ParticleFrame {
            time: 0.5,
            groups: vec!["water & co".into()],
            group: vec![0, 0],
            position: vec![[1e-6, 2e-6, 0.0], [3e-6, 0.1, 0.0]],
            velocity: vec![[0.0; 3]; 2],
            density: vec![1000.0; 2],
            pressure: vec![0.0; 2],
            volume_fraction: vec![0.0; 2],
            volume: vec![1.0; 2],
            amounts: vec![vec![5.0 * AVOGADRO, 0.0]],
            ..ParticleFrame::default()
        };
        let path = dir.path().join("vtk/frame.vtu");
        write_vtu(&path, &frame, &["L".into()]).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("NumberOfPoints=\"2\"") && text.contains("water &amp; co"));
        assert_eq!(text.matches("<DataArray").count(), text.matches("</DataArray>").count());
        assert!(text.contains("\"L concentration\" NumberOfComponents=\"1\" format=\"ascii\">\n5 0 \n"));
        write_pvd(&dir.path().join("vtk/run.pvd"), &[(0.5, "frame.vtu".into())]).unwrap();
        assert!(
            std::fs::read_to_string(dir.path().join("vtk/run.pvd")).unwrap().contains("timestep=\"5e-1\"")
        );
    }
}
