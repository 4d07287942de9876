//! What a run has seen, written down as it comes: an append-only file that outlives a kill at any moment.
//!
//! Entries go to the file in frames ([`packet`]). A frame that was cut short by a crash is
//! the last one and is cut off when the file is opened again; a damaged one before it is told and refused.

use crate::error::RunError;
use crate::packet::{self, Found};
use crate::simulation::{CourseShare, Piece, Share};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// An entry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Entry {
    Piece(Piece),
    Finished { realization: u32, share: Share },
    Course(CourseShare),
}

/// Bytes of entries from which a frame is written, and the longest that entries wait for one.
const FRAME: usize = 1 << 18;
const WAIT: Duration = Duration::from_millis(200);
/// Frames on their way to the disk for longer than this are driven there.
const SYNC: Duration = Duration::from_secs(5);

/// A journal open for writing.
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Where the next frame goes.
    end: u64,
    pending: Vec<u8>,
    flushed: Instant,
    synced: Instant,
    index: Index,
}

/// What is in a journal, and in which frames.
#[derive(Clone, Debug, Default)]
pub struct Index {
    /// Realization and a frame that holds something of it; sorted once the journal is closed.
    places: Vec<(u32, u64)>,
    pub finished: BTreeSet<u32>,
    pub courses: Vec<CourseShare>,
}

impl Index {
    fn note(&mut self, frame: u64, entry: Entry) {
        let realization = match entry {
            Entry::Piece(piece) => piece.realization,
            Entry::Finished { realization, .. } => {
                self.finished.insert(realization);
                realization
            }
            Entry::Course(course) => return self.courses.push(course),
        };
        if self.places.last() != Some(&(realization, frame)) {
            self.places.push((realization, frame));
        }
    }

    /// Realizations of which there is anything.
    fn realizations(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.places.iter().map(|place| place.0).collect();
        all.dedup();
        all
    }
}

impl Journal {
    /// Opens a journal, new or left by an earlier run, of which an unfinished last frame is cut off; `see` is shown what
    /// is in it.
    ///
    /// # Errors
    /// A file that cannot be used, or is damaged before its last frame.
    pub fn open(path: &Path, see: &mut dyn FnMut(&Entry)) -> Result<Journal, RunError> {
        let fault = |error: std::io::Error| file_fault(path, &error);
        let mut file =
            File::options().read(true).write(true).create(true).truncate(false).open(path).map_err(fault)?;
        let length = file.metadata().map_err(fault)?.len();
        let (mut index, mut end) = (Index::default(), 0);
        while let Some(entries) = read_frame(&mut file, path, end, length)? {
            entries.1.into_iter().for_each(|entry| {
                see(&entry);
                index.note(end, entry);
            });
            end += entries.0;
        }
        file.set_len(end).map_err(fault)?;
        let now = Instant::now();
        let path = path.to_path_buf();
        Ok(Journal { path, file, end, pending: Vec::new(), flushed: now, synced: now, index })
    }

    /// What it holds.
    #[must_use]
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// Appends an entry; it is in the file within a moment.
    ///
    /// # Errors
    /// A full disk and the like.
    pub fn append(&mut self, entry: Entry) -> Result<(), RunError> {
        let bytes = postcard::to_stdvec(&entry).map_err(|error| self.fault(&error.to_string()))?;
        self.pending.extend(bytes);
        self.index.note(self.end, entry);
        if self.pending.len() >= FRAME || self.flushed.elapsed() > WAIT {
            self.flush()?;
        }
        Ok(())
    }

    /// Writes what waits.
    ///
    /// # Errors
    /// As [`Journal::append`].
    pub fn flush(&mut self) -> Result<(), RunError> {
        if !self.pending.is_empty() {
            let end = SeekFrom::Start(self.end);
            let written = self.file.seek(end).and_then(|_| packet::write(&mut self.file, &self.pending));
            self.end += written.map_err(|error| file_fault(&self.path, &error))?;
            self.pending.clear();
        }
        self.flushed = Instant::now();
        if self.synced.elapsed() > SYNC {
            self.sync()?;
        }
        Ok(())
    }

    /// Drives what was written to the disk.
    ///
    /// # Errors
    /// As [`Journal::append`].
    pub fn sync(&mut self) -> Result<(), RunError> {
        self.file.sync_data().map_err(|error| file_fault(&self.path, &error))?;
        self.synced = Instant::now();
        Ok(())
    }

    /// Ends the writing: what was seen can be read in order.
    ///
    /// # Errors
    /// As [`Journal::append`].
    pub fn close(mut self) -> Result<Reader, RunError> {
        self.flush()?;
        let Journal { path, file, mut index, end, .. } = self;
        index.places.sort_unstable();
        index.places.dedup();
        Ok(Reader { path, file, index, end, cached: Vec::new() })
    }

    fn fault(&self, reason: &str) -> RunError {
        RunError::File { path: self.path.display().to_string(), reason: reason.into() }
    }
}

/// Frames kept unpacked: realizations side by side are spread over neighbouring ones.
const CACHED: usize = 16;

/// A journal to be read.
pub struct Reader {
    path: PathBuf,
    file: File,
    index: Index,
    end: u64,
    /// Frames read last, newest last.
    cached: Vec<(u64, Vec<Entry>)>,
}

impl Reader {
    /// What it holds.
    #[must_use]
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// Realizations of which there is anything, in order.
    #[must_use]
    pub fn realizations(&self) -> Vec<u32> {
        self.index.realizations()
    }

    /// Calls `see` with the pieces of a realization in order of time; its share of the books if it was finished. What
    /// came twice, since a run was taken up from a state before it, comes once.
    ///
    /// # Errors
    /// Those of `see`, and a file that cannot be read.
    pub fn realization(
        &mut self,
        realization: u32,
        see: &mut dyn FnMut(&Piece) -> Result<(), RunError>,
    ) -> Result<Option<Share>, RunError> {
        let from = self.index.places.partition_point(|place| place.0 < realization);
        let to = self.index.places.partition_point(|place| place.0 <= realization);
        let frames: Vec<u64> = self.index.places[from..to].iter().map(|place| place.1).collect();
        let (mut next, mut found) = (0, None);
        for frame in frames {
            let at = self.frame(frame)?;
            for entry in &self.cached[at].1 {
                match entry {
                    Entry::Piece(piece) if piece.realization == realization => {
                        let end = piece.first + piece.outputs;
                        if end <= next {
                            continue;
                        }
                        if piece.first >= next {
                            see(piece)?;
                        } else {
                            see(&piece.from(next))?;
                        }
                        next = end;
                    }
                    Entry::Finished { realization: r, share } if *r == realization => {
                        found = Some(share.clone());
                    }
                    _ => {}
                }
            }
        }
        Ok(found)
    }

    /// Place of a frame among those unpacked.
    fn frame(&mut self, frame: u64) -> Result<usize, RunError> {
        if let Some(at) = self.cached.iter().position(|(start, _)| *start == frame) {
            return Ok(at);
        }
        let entries = read_frame(&mut self.file, &self.path, frame, self.end)?.map(|(_, entries)| entries);
        if self.cached.len() == CACHED {
            self.cached.remove(0);
        }
        self.cached.push((frame, entries.unwrap_or_default()));
        Ok(self.cached.len() - 1)
    }
}

/// Length of the frame at `start` and its entries; `None` at the end of the file and for a last frame cut short.
fn read_frame(
    file: &mut File,
    path: &Path,
    start: u64,
    length: u64,
) -> Result<Option<(u64, Vec<Entry>)>, RunError> {
    let broken = || RunError::File {
        path: path.display().to_string(),
        reason: "damaged; start anew with --force".into(),
    };
    let found = file.seek(SeekFrom::Start(start)).and_then(|_| packet::read(file, length - start));
    let (size, content) = match found.map_err(|error| file_fault(path, &error))? {
        Found::Packet(size, content) => (size, content),
        Found::End => return Ok(None),
        Found::Damaged => return Err(broken()),
    };
    let (mut entries, mut rest) = (Vec::new(), content.as_slice());
    while !rest.is_empty() {
        let (entry, left) = postcard::take_from_bytes(rest).map_err(|_| broken())?;
        entries.push(entry);
        rest = left;
    }
    Ok(Some((size, entries)))
}

/// Realizations that are finished by a journal another process may be writing; none where there is no journal.
#[must_use]
pub fn finished(path: &Path) -> usize {
    let Ok(mut file) = File::open(path) else { return 0 };
    let length = file.metadata().map_or(0, |metadata| metadata.len());
    let (mut index, mut end) = (Index::default(), 0);
    while let Ok(Some((size, entries))) = read_frame(&mut file, path, end, length) {
        entries.into_iter().for_each(|entry| index.note(end, entry));
        end += size;
    }
    index.finished.len()
}

/// What went wrong with a file, with a word on what to do.
pub fn file_fault(path: &Path, error: &std::io::Error) -> RunError {
    use std::io::ErrorKind;
    let remedy = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "; make room and go on with --resume"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "; make the folder writable and go on with --resume"
        }
        _ => "",
    };
    RunError::File { path: path.display().to_string(), reason: format!("{error}{remedy}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(realization: u32, first: u32, outputs: u32) -> Piece {
        let row = |k: u32| f64::from(realization * 1000 + k);
        let values: Vec<f64> = (first..first + outputs).map(row).collect();
        Piece {
            realization,
            first,
            outputs,
            amount: values.clone(),
            concentration: values,
            probes: Vec::new(),
        }
    }

    fn finished(realization: u32) -> Entry {
        Entry::Finished { realization, share: Share::default() }
    }

    fn amounts(reader: &mut Reader, realization: u32) -> Vec<f64> {
        let mut found = Vec::new();
        let mut take = |piece: &Piece| -> Result<(), RunError> {
            found.extend(&piece.amount);
            Ok(())
        };
        reader.realization(realization, &mut take).unwrap();
        found
    }

    /// Cut at any byte: what stands before the last whole frame is there, and the journal goes on.
    #[test]
    fn a_journal_cut_anywhere_keeps_its_whole_frames() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal");
        let mut journal = Journal::open(&path, &mut |_| {}).unwrap();
        let mut ends = vec![0];
        for r in 0..5 {
            journal.append(Entry::Piece(piece(r, 0, 3))).unwrap();
            journal.append(finished(r)).unwrap();
            journal.flush().unwrap();
            ends.push(journal.end);
        }
        let whole = std::fs::read(&path).unwrap();
        for cut in 0..=whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let expected = ends.iter().filter(|&&end| end > 0 && end <= cut as u64).count();
            let mut journal = Journal::open(&path, &mut |_| {}).unwrap();
            assert_eq!(journal.index().finished.len(), expected, "cut at {cut}");
            journal.append(Entry::Piece(piece(9, 0, 2))).unwrap();
            journal.append(finished(9)).unwrap();
            let mut reader = journal.close().unwrap();
            assert_eq!(amounts(&mut reader, 9), [9000.0, 9001.0]);
            if expected > 0 {
                assert_eq!(amounts(&mut reader, 0), [0.0, 1.0, 2.0]);
            }
        }
    }

    #[test]
    fn damage_in_the_middle_is_told() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal");
        let mut journal = Journal::open(&path, &mut |_| {}).unwrap();
        for r in 0..3 {
            journal.append(finished(r)).unwrap();
            journal.flush().unwrap();
        }
        drop(journal);
        let mut bytes = std::fs::read(&path).unwrap();
        bytes[packet::HEAD as usize + 1] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let message = Journal::open(&path, &mut |_| {}).err().unwrap().to_string();
        assert!(message.contains("damaged") && message.contains("--force"), "{message}");
    }

    #[test]
    fn what_comes_again_comes_once() {
        let dir = tempfile::tempdir().unwrap();
        let mut journal = Journal::open(&dir.path().join("journal"), &mut |_| {}).unwrap();
        for (first, outputs) in [(0, 4), (2, 4), (2, 2), (6, 1)] {
            journal.append(Entry::Piece(piece(1, first, outputs))).unwrap();
            journal.flush().unwrap();
        }
        let mut reader = journal.close().unwrap();
        assert_eq!(amounts(&mut reader, 1), (0..7).map(|k| f64::from(1000 + k)).collect::<Vec<_>>());
    }
}
