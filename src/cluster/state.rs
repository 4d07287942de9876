//! Where the blocks of an ensemble stand, and lists of blocks as schedulers write them.

use super::Folder;
use crate::ensemble;
use crate::error::Fault;
use crate::record::RunRecord;
use crate::tables;
use std::path::Path;
use std::time::SystemTime;

/// What a block has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Nothing was written yet.
    Missing,
    /// No end was recorded: it goes on, or was cut off.
    Running,
    /// Stopped by a signal; goes on with what it has.
    Interrupted,
    /// Ended by an error.
    Failed,
    Finished,
    /// What is there is no block of this ensemble.
    Unreadable,
}

impl State {
    /// The state in one word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            State::Missing => "missing",
            State::Running => "running",
            State::Interrupted => "interrupted",
            State::Failed => "failed",
            State::Finished => "finished",
            State::Unreadable => "unreadable",
        }
    }
}

/// Where a block stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    pub state: State,
    /// Realizations whose tables are complete.
    pub finished: u32,
    /// Wall time spent up to what was written last, s.
    pub wall_seconds: f64,
    /// Why it failed or cannot be read; else empty.
    pub error: String,
    /// Of one that runs: seconds since anything was written.
    pub age: Option<f64>,
}

impl Folder {
    /// Where block `k` stands.
    #[must_use]
    pub fn standing(&self, k: u32) -> Standing {
        let dir = self.block(k);
        let none = |state: State, error: String| Standing {
            state,
            finished: 0,
            wall_seconds: 0.0,
            error,
            age: None,
        };
        if !dir.join("run.json").exists() {
            return none(State::Missing, String::new());
        }
        let record = match tables::read_record(&dir) {
            Ok(record) => record,
            Err(error) => return none(State::Unreadable, error.to_string()),
        };
        let range = self.ensemble.range(k);
        if !self.holds(&record) || record.realizations != [range.start, range.end] {
            return none(State::Unreadable, "a block of another ensemble".into());
        }
        let state = match record.status.as_str() {
            "finished" => State::Finished,
            "interrupted" => State::Interrupted,
            "failed" => State::Failed,
            _ => State::Running,
        };
        let mut standing = Standing {
            state,
            finished: record.finished,
            wall_seconds: record.performance.wall_seconds,
            error: record.error.unwrap_or_default(),
            age: None,
        };
        if state == State::Running {
            // The record is that of the start: what came since is in the journal.
            standing.finished = ensemble::finished_so_far(&dir) as u32;
            if let (Some(begun), Some(last)) = (written(&dir.join("run.json")), last_written(&dir)) {
                let now = SystemTime::now();
                // Clocks of other machines may be ahead.
                standing.wall_seconds += last.duration_since(begun).unwrap_or_default().as_secs_f64();
                standing.age = Some(now.duration_since(last).unwrap_or_default().as_secs_f64());
            }
        }
        standing
    }

    /// All blocks that are not finished.
    #[must_use]
    pub fn unfinished(&self) -> Vec<u32> {
        (0..self.ensemble.blocks).filter(|&k| self.standing(k).state != State::Finished).collect()
    }

    /// Whether the joined results are there.
    #[must_use]
    pub fn joined(&self) -> bool {
        tables::read_record(&self.results()).is_ok_and(|record| {
            self.holds(&record)
                && record.status == "finished"
                && record.realizations == [0, self.ensemble.realizations]
        })
    }

    /// Whether a run is part of this ensemble.
    #[must_use]
    pub fn holds(&self, record: &RunRecord) -> bool {
        record.model.hash == self.ensemble.hash && record.seed == self.ensemble.seed
    }
}

fn written(path: &Path) -> Option<SystemTime> {
    path.metadata().ok()?.modified().ok()
}

/// When the record of a run or something it keeps meanwhile was written last.
fn last_written(dir: &Path) -> Option<SystemTime> {
    let kept = dir.join("checkpoint").read_dir().into_iter().flatten().flatten().map(|entry| entry.path());
    kept.chain([dir.join("run.json")]).filter_map(|path| written(&path)).max()
}

/// Numbers in rising order as a list of schedulers: `3,7-9`.
#[must_use]
pub fn compact(numbers: &[u32]) -> String {
    let follows = |pair: &[u32]| pair[0].checked_add(1) == Some(pair[1]);
    let runs = numbers.chunk_by(|a, b| follows(&[*a, *b]));
    let word = |run: &[u32]| match run {
        [only] => only.to_string(),
        run => format!("{}-{}", run[0], run[run.len() - 1]),
    };
    runs.map(word).collect::<Vec<_>>().join(",")
}

/// Reads a list such as `3,7-9`; the empty text is the empty list.
///
/// # Errors
/// What is no such list.
pub fn expand(text: &str) -> Result<Vec<u32>, Fault> {
    let fault = || Fault::general(format!("{text}: expected a list of blocks"), "write e.g. 3,7-9");
    let mut numbers = Vec::new();
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        let (from, to) = part.split_once('-').unwrap_or((part, part));
        let (from, to): (u32, u32) = (from.parse().map_err(|_| fault())?, to.parse().map_err(|_| fault())?);
        if from > to || to - from > 10_000_000 {
            return Err(fault());
        }
        numbers.extend(from..=to);
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_written_and_read() {
        for (numbers, text) in [
            (vec![], ""),
            (vec![3], "3"),
            (vec![0, 1], "0-1"),
            (vec![3, 7, 8, 9, 11], "3,7-9,11"),
            (vec![u32::MAX - 1, u32::MAX], "4294967294-4294967295"),
        ] {
            assert_eq!(compact(&numbers), text);
            assert_eq!(expand(text).unwrap(), numbers);
        }
        for text in ["x", "9-7", "1-", "-1", "1;2"] {
            assert!(expand(text).is_err(), "{text}");
        }
    }
}
