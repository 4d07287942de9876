//! States of what is under way, two generations each: a damaged newest one leaves the other to go on from.

use super::journal::file_fault;
use crate::error::RunError;
use crate::simulation::keep::Writing;
use sha2::{Digest, Sha256};
use std::fs::{File, rename};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// What a state file begins with, and the version of what follows: raised when states of an earlier program cannot
/// be read any more.
const MAGIC: &[u8; 12] = b"gillesph st\n";
pub const FORMAT: u32 = 5;
/// Bytes of a checksum.
const SUM: usize = 32;

/// States below a folder.
pub struct States {
    folder: PathBuf,
    /// Names the run: a state of another one is not used.
    title: String,
}

/// A state as it was found.
pub enum Found {
    None,
    State(Vec<u8>),
    /// The newest one is damaged; the one before it, if there is one.
    Older {
        state: Option<Vec<u8>>,
        reason: String,
    },
}

/// Writes on and sums up.
struct Summing<W> {
    inner: W,
    sum: Sha256,
}

impl<W: Write> Write for Summing<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}

impl States {
    /// States in a folder, of the run that bears this title.
    #[must_use]
    pub fn new(folder: &Path, title: &str) -> States {
        States { folder: folder.to_path_buf(), title: title.into() }
    }

    /// Writes a state, `journal` bytes of which are in the journal, under a temporary name, drives it to the disk, and puts it in the place of the newest, which
    /// becomes the older one.
    ///
    /// # Errors
    /// [`RunError::File`].
    pub fn save(&self, name: &str, journal: u64, write: &mut Writing) -> Result<(), RunError> {
        let (newest, older) = self.paths(name);
        let fresh = self.folder.join(format!("{name}.writing"));
        let fault = |error: std::io::Error| file_fault(&fresh, &error);
        let file = File::create(&fresh).map_err(fault)?;
        let mut out = Summing { inner: BufWriter::with_capacity(1 << 16, file), sum: Sha256::new() };
        out.write_all(MAGIC)
            .and_then(|()| out.write_all(&FORMAT.to_le_bytes()))
            .and_then(|()| out.write_all(&journal.to_le_bytes()))
            .and_then(|()| out.write_all(&(self.title.len() as u32).to_le_bytes()))
            .and_then(|()| out.write_all(self.title.as_bytes()))
            .map_err(fault)?;
        write(&mut out).map_err(|reason| RunError::File { path: fresh.display().to_string(), reason })?;
        let Summing { mut inner, sum } = out;
        inner.write_all(&sum.finalize()).and_then(|()| inner.flush()).map_err(fault)?;
        let file = inner.into_inner().map_err(|error| fault(error.into_error()))?;
        file.sync_all().map_err(fault)?;
        if newest.exists() {
            rename(&newest, &older).map_err(fault)?;
        }
        rename(&fresh, &newest).map_err(fault)?;
        // The names, too, must outlive a crash of the machine.
        File::open(&self.folder).and_then(|folder| folder.sync_all()).map_err(fault)
    }

    /// The state kept under a name, of a run whose journal held `journal` bytes when it was opened: a state that builds
    /// on more than that is not used. A damaged newest one is removed, so that the older one stays until there is
    /// another.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn saved(&self, name: &str, journal: u64) -> Result<Found, RunError> {
        let (newest, older) = self.paths(name);
        let mut reason = None;
        for path in [&newest, &older] {
            match self.read(path, journal)? {
                None => {}
                Some(Ok(state)) => {
                    return Ok(match reason {
                        None => Found::State(state),
                        Some(reason) => Found::Older { state: Some(state), reason },
                    });
                }
                Some(Err(found)) => {
                    // What cannot be removed is found again.
                    let _ = std::fs::remove_file(path);
                    reason.get_or_insert(found);
                }
            }
        }
        Ok(reason.map_or(Found::None, |reason| Found::Older { state: None, reason }))
    }

    /// Whether there is anything under a name.
    #[must_use]
    pub fn any(&self, name: &str) -> bool {
        let (newest, older) = self.paths(name);
        newest.exists() || older.exists()
    }

    /// Removes the states of a name.
    pub fn forget(&self, name: &str) {
        let (newest, older) = self.paths(name);
        for path in [newest, older, self.folder.join(format!("{name}.writing"))] {
            // What stays is removed with the folder.
            let _ = std::fs::remove_file(path);
        }
    }

    fn paths(&self, name: &str) -> (PathBuf, PathBuf) {
        (self.folder.join(format!("{name}.state")), self.folder.join(format!("{name}.older")))
    }

    /// What a file holds, or why it cannot be used; `None` if it is not there.
    fn read(&self, path: &Path, journal: u64) -> Result<Option<Result<Vec<u8>, String>>, RunError> {
        let mut bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(file_fault(path, &error)),
        };
        let shown = path.display();
        let head = MAGIC.len() + 16 + self.title.len();
        let damaged = Ok(Some(Err(format!("{shown} is damaged"))));
        if bytes.len() < head + SUM || !bytes.starts_with(MAGIC) {
            return damaged;
        }
        let body = bytes.len() - SUM;
        if Sha256::digest(&bytes[..body]).as_slice() != &bytes[body..] {
            return damaged;
        }
        if bytes[MAGIC.len()..MAGIC.len() + 4] != FORMAT.to_le_bytes() {
            return Ok(Some(Err(format!("{shown} is of another version of the format"))));
        }
        if &bytes[head - self.title.len()..head] != self.title.as_bytes() {
            return Ok(Some(Err(format!("{shown} belongs to another run"))));
        }
        let mut word = [0; 8];
        word.copy_from_slice(&bytes[MAGIC.len() + 4..MAGIC.len() + 12]);
        if u64::from_le_bytes(word) > journal {
            return Ok(Some(Err(format!("{shown} builds on what is missing in the journal"))));
        }
        bytes.truncate(body);
        bytes.drain(..head);
        Ok(Some(Ok(bytes)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn save(states: &States, text: &str) {
        states.save("one", 7, &mut |out| out.write_all(text.as_bytes()).map_err(|e| e.to_string())).unwrap();
    }

    fn text(found: &Found) -> &str {
        match found {
            Found::None => "none",
            Found::State(state) => std::str::from_utf8(state).unwrap(),
            Found::Older { state: Some(state), .. } => std::str::from_utf8(state).unwrap(),
            Found::Older { .. } => "lost",
        }
    }

    #[test]
    fn a_damaged_state_leaves_the_older_one() {
        let dir = tempfile::tempdir().unwrap();
        let states = States::new(dir.path(), "abc");
        assert_eq!(text(&states.saved("one", 7).unwrap()), "none");
        save(&states, "first");
        save(&states, "second");
        assert_eq!(text(&states.saved("one", 7).unwrap()), "second");
        let newest = dir.path().join("one.state");
        let whole = std::fs::read(&newest).unwrap();
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 4;
            std::fs::write(&newest, &bytes).unwrap();
            let found = states.saved("one", 7).unwrap();
            assert!(matches!(found, Found::Older { .. }) && text(&found) == "first", "byte {at}");
            assert!(!newest.exists(), "the damaged one is gone");
            std::fs::write(&newest, &whole[..at]).unwrap();
            assert_eq!(text(&states.saved("one", 7).unwrap()), "first");
        }
        std::fs::write(&newest, &whole).unwrap();
        assert_eq!(text(&states.saved("one", 6).unwrap()), "lost", "both are ahead of the journal");
        save(&states, "first");
        save(&states, "second");
        std::fs::remove_file(&newest).unwrap();
        assert_eq!(text(&states.saved("one", 7).unwrap()), "first");
        std::fs::write(dir.path().join("one.older"), "x").unwrap();
        assert_eq!(text(&states.saved("one", 7).unwrap()), "lost");
        save(&states, "third");
        let other = States::new(dir.path(), "abd");
        assert_eq!(text(&other.saved("one", 7).unwrap()), "lost");
        states.forget("one");
        assert_eq!(text(&states.saved("one", 7).unwrap()), "none");
    }
}
