//! What a run has seen, written down as it comes: an append-only file that outlives a kill at any moment.
//!
//! Entries go to the file in frames ([`packet`]). A frame that was cut short by a crash is
//! the last one and is cut off when the file is opened again; so is what follows a damaged one, which is told.

use crate::error::RunError;
use crate::packet::{self, Found};
use crate::simulation::{CourseShare, Piece, Share};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// An entry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Entry {
    /// First of all: of which run it is.
    Title(String),
    Piece(Piece),
    Finished {
        realization: u32,
        share: Share,
    },
    /// What a flow came to; of one that was run again the last one counts.
    Course {
        name: String,
        share: CourseShare,
    },
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
    /// When the last frame with the end of a realization was written.
    settled: Instant,
    synced: Instant,
    index: Index,
    /// Whether something in the file could not be read and was cut off with what came after it.
    pub cut: bool,
}

/// What is in a journal, and in which frames.
#[derive(Clone, Debug, Default)]
pub struct Index {
    /// Realization and a frame that holds something of it; sorted once the journal is closed.
    places: Vec<(u32, u64)>,
    pub finished: BTreeSet<u32>,
    pub courses: BTreeMap<String, CourseShare>,
}

impl Index {
    fn note(&mut self, frame: u64, entry: Entry) {
        let realization = match entry {
            Entry::Piece(piece) => piece.realization,
            Entry::Finished { realization, .. } => {
                self.finished.insert(realization);
                realization
            }
            Entry::Course { name, share } => {
                self.courses.insert(name, share);
                return;
            }
            Entry::Title(_) => return,
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
    /// Opens the journal of the run that bears `title`, new or left by an earlier process, of which an unfinished last
    /// frame is cut off, and what comes from a damaged frame on; `see` is shown what is in it.
    ///
    /// # Errors
    /// A file that cannot be used, or of another run.
    pub fn open(path: &Path, title: &str, see: &mut dyn FnMut(&Entry)) -> Result<Journal, RunError> {
        let fault = |error: std::io::Error| file_fault(path, &error);
        let mut file =
            File::options().read(true).write(true).create(true).truncate(false).open(path).map_err(fault)?;
        let length = file.metadata().map_err(fault)?.len();
        let (mut index, mut end) = (Index::default(), 0);
        let mut cut = false;
        loop {
            let (size, entries) = match read_frame(&mut file, path, end, length)? {
                Frame::Entries(size, entries) => (size, entries),
                Frame::End => break,
                Frame::Damaged => {
                    cut = true;
                    break;
                }
            };
            if end == 0 && entries.first() != Some(&Entry::Title(title.into())) {
                let reason = "belongs to another run; start anew with --force".into();
                return Err(RunError::File { path: path.display().to_string(), reason });
            }
            entries.into_iter().for_each(|entry| {
                see(&entry);
                index.note(end, entry);
            });
            end += size;
        }
        file.set_len(end).map_err(fault)?;
        let (now, path) = (Instant::now(), path.to_path_buf());
        let mut journal = Journal {
            path,
            file,
            end,
            pending: Vec::new(),
            flushed: now,
            settled: now,
            synced: now,
            index,
            cut,
        };
        if end == 0 {
            journal.append(Entry::Title(title.into()))?;
            journal.flush()?;
        }
        Ok(journal)
    }

    /// What it holds.
    #[must_use]
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// Bytes in the file.
    #[must_use]
    pub fn length(&self) -> u64 {
        self.end
    }

    /// Appends an entry; it is in the file within a moment.
    ///
    /// # Errors
    /// A full disk and the like.
    pub fn append(&mut self, entry: Entry) -> Result<(), RunError> {
        let bytes = postcard::to_stdvec(&entry).map_err(|error| self.fault(&error.to_string()))?;
        self.pending.extend(bytes);
        // The end of a realization may be the last entry for long.
        let ends = matches!(entry, Entry::Finished { .. }) && self.settled.elapsed() > WAIT;
        self.index.note(self.end, entry);
        if ends || self.pending.len() >= FRAME || self.flushed.elapsed() > WAIT {
            self.flush()?;
        }
        if ends {
            self.settled = Instant::now();
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

    /// Its file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
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
                        if piece.first > next {
                            return Err(missing(&self.path, realization, next));
                        }
                        if piece.first == next {
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
        let Frame::Entries(_, entries) = read_frame(&mut self.file, &self.path, frame, self.end)? else {
            let reason = "has been damaged since it was written".into();
            return Err(RunError::File { path: self.path.display().to_string(), reason });
        };
        if self.cached.len() == CACHED {
            self.cached.remove(0);
        }
        self.cached.push((frame, entries));
        Ok(self.cached.len() - 1)
    }
}

/// What there is at a place where a frame may begin.
enum Frame {
    /// Its length and its entries.
    Entries(u64, Vec<Entry>),
    /// The end of the file, or a last frame cut short.
    End,
    Damaged,
}

fn read_frame(file: &mut File, path: &Path, start: u64, length: u64) -> Result<Frame, RunError> {
    let found = file.seek(SeekFrom::Start(start)).and_then(|_| packet::read(file, length - start));
    let (size, content) = match found.map_err(|error| file_fault(path, &error))? {
        Found::Packet(size, content) => (size, content),
        Found::End => return Ok(Frame::End),
        Found::Damaged => return Ok(Frame::Damaged),
    };
    let (mut entries, mut rest) = (Vec::new(), content.as_slice());
    while !rest.is_empty() {
        let Ok((entry, left)) = postcard::take_from_bytes(rest) else { return Ok(Frame::Damaged) };
        entries.push(entry);
        rest = left;
    }
    Ok(Frame::Entries(size, entries))
}

/// Something that should be there is not: never told as if it were.
pub fn missing(path: &Path, realization: u32, output: u32) -> RunError {
    let reason = format!("output {output} of realization {realization} is missing; start anew with --force");
    RunError::File { path: path.display().to_string(), reason }
}

/// Realizations that are finished by a journal another process may be writing; none where there is no journal.
#[must_use]
pub fn finished(path: &Path) -> usize {
    let Ok(mut file) = File::open(path) else { return 0 };
    let length = file.metadata().map_or(0, |metadata| metadata.len());
    let (mut index, mut end) = (Index::default(), 0);
    while let Ok(Frame::Entries(size, entries)) = read_frame(&mut file, path, end, length) {
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
            ..Piece::default()
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
        let mut journal = Journal::open(&path, "t", &mut |_| {}).unwrap();
        let mut ends = vec![0, journal.length()];
        for r in 0..5 {
            journal.append(Entry::Piece(piece(r, 0, 3))).unwrap();
            journal.append(finished(r)).unwrap();
            journal.flush().unwrap();
            ends.push(journal.end);
        }
        let whole = std::fs::read(&path).unwrap();
        for cut in 0..=whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let expected = ends.iter().skip(2).filter(|&&end| end <= cut as u64).count();
            let mut journal = Journal::open(&path, "t", &mut |_| {}).unwrap();
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
    fn what_follows_damage_is_cut_off_and_told() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal");
        let mut journal = Journal::open(&path, "t", &mut |_| {}).unwrap();
        let mut ends = Vec::new();
        for r in 0..3 {
            journal.append(finished(r)).unwrap();
            journal.flush().unwrap();
            ends.push(journal.length());
        }
        drop(journal);
        let mut bytes = std::fs::read(&path).unwrap();
        bytes[(ends[0] + packet::HEAD) as usize + 1] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let other = Journal::open(&path, "u", &mut |_| {}).err().unwrap().to_string();
        assert!(other.contains("another run"), "{other}");
        let journal = Journal::open(&path, "t", &mut |_| {}).unwrap();
        assert!(journal.cut && journal.index().finished.len() == 1);
    }

    #[test]
    fn what_comes_again_comes_once() {
        let dir = tempfile::tempdir().unwrap();
        let mut journal = Journal::open(&dir.path().join("journal"), "t", &mut |_| {}).unwrap();
        for (first, outputs) in [(0, 4), (2, 4), (2, 2), (6, 1)] {
            journal.append(Entry::Piece(piece(1, first, outputs))).unwrap();
            journal.flush().unwrap();
        }
        let mut reader = journal.close().unwrap();
        assert_eq!(amounts(&mut reader, 1), (0..7).map(|k| f64::from(1000 + k)).collect::<Vec<_>>());
    }
}
