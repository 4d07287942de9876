//! The text of an SBML file.

use crate::error::{Fault, Source};
use std::path::Path;
use std::sync::Arc;

/// Reads a file in UTF-8, or in Latin 1 if it says so.
pub(super) fn read(path: &Path) -> Result<Arc<Source>, Fault> {
    let shown = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| {
        let reason = match error.kind() {
            std::io::ErrorKind::NotFound => format!("the file {shown} does not exist"),
            _ if path.is_dir() => format!("{shown} is a folder, not a file"),
            _ => format!("the file {shown} cannot be read: {error}"),
        };
        Fault::general(reason, "give the path of an SBML file, usually NAME.xml")
    })?;
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) if latin(error.as_bytes()) => error.as_bytes().iter().map(|&b| char::from(b)).collect(),
        Err(_) => {
            let reason = format!("the file {shown} is not text in UTF-8");
            let remedy =
                "an archive (.omex, .zip, .gz) has to be unpacked; other encodings converted to UTF-8";
            return Err(Fault::general(reason, remedy));
        }
    };
    Ok(Arc::new(Source::new(shown, text.trim_start_matches('\u{feff}'))))
}

/// Whether the first line declares Latin 1, whose bytes are the first characters of Unicode.
fn latin(bytes: &[u8]) -> bool {
    let head: String = bytes.iter().take(200).map(|&b| char::from(b).to_ascii_lowercase()).collect();
    head.starts_with("<?xml") && (head.contains("iso-8859-1") || head.contains("latin1"))
}
