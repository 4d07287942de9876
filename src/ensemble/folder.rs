//! The folder of a run: who may write into it, what an earlier run left there, what has changed since.

use crate::error::{Fault, ModelError, RunError};
use crate::model::changes::differences;
use crate::record::{ModelText, RunRecord, SweepRecord};
use crate::tables;
use std::fs::{DirEntry, File, TryLockError};
use std::path::Path;

/// What an earlier run left.
pub enum Earlier {
    Nothing,
    /// Its record; what it has seen lies in its folder `checkpoint`.
    Interrupted(Box<RunRecord>),
    /// All there is to be, and it was asked to go on.
    Finished(Box<RunRecord>),
    /// All but the report, before which it was stopped.
    Undrawn,
}

/// What is to become of an earlier run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Claim {
    pub resume: bool,
    pub force: bool,
}

/// The right to write into a folder, as long as this is kept.
pub struct Held {
    _lock: File,
}

/// What a folder holds.
pub(super) enum Content {
    Nothing,
    Run(Box<RunRecord>),
    Sweep(Box<SweepRecord>),
}

/// Looks at the folder to write: refuses one that is in use or holds a finished run.
///
/// # Errors
/// Why it cannot be used.
pub fn look(dir: &Path, claim: Claim) -> Result<Earlier, ModelError> {
    match content(dir, claim)? {
        Content::Run(record) if undrawn(dir, claim, &record.status) => Ok(Earlier::Undrawn),
        Content::Run(record) if !claim.force => {
            if record.status == "finished" && claim.resume {
                let drawn = dir.join("report.html").exists();
                return Ok(if drawn { Earlier::Finished(record) } else { Earlier::Undrawn });
            }
            refuse(dir, claim, "run", &record.status, &format!("{} realizations finished", record.finished))?;
            Ok(Earlier::Interrupted(record))
        }
        Content::Sweep(_) if !claim.force => Err(other_kind(dir, "a sweep, and this is a run of one point")),
        _ => Ok(Earlier::Nothing),
    }
}

/// Whether what is to be resumed is finished but for its report.
pub(super) fn undrawn(dir: &Path, claim: Claim, status: &str) -> bool {
    claim.resume && status == "finished" && !dir.join("report.html").exists()
}

/// What is in a folder that may be written.
///
/// # Errors
/// A folder that cannot be used.
pub(super) fn content(dir: &Path, claim: Claim) -> Result<Content, ModelError> {
    let shown = dir.display();
    let fault = |reason: String, remedy: &str| Err(ModelError::from(Fault::general(reason, remedy)));
    if dir.exists() && !dir.is_dir() {
        return fault(format!("{shown} is not a folder"), "name another one with --out");
    }
    // A run that was killed as it began leaves no more than a folder for what it would have kept, and a record half written.
    let unused = |entry: std::io::Result<DirEntry>| {
        entry.is_ok_and(|entry| {
            let name = entry.file_name();
            name == "checkpoint" || name.to_string_lossy().starts_with(".writing-")
        })
    };
    let empty = !dir.exists() || dir.read_dir().is_ok_and(|mut entries| entries.all(unused));
    if empty {
        if claim.resume {
            return fault(format!("{shown} holds no run to resume"), "leave out --resume");
        }
        return Ok(Content::Nothing);
    }
    if let Ok(sweep) = tables::read_sweep_record(dir) {
        return Ok(Content::Sweep(Box::new(sweep)));
    }
    match tables::read_record(dir) {
        Ok(record) => Ok(Content::Run(Box::new(record))),
        Err(error) => {
            let reason = if dir.join("run.json").exists() {
                format!("{shown} holds a run that cannot be read: {error}")
            } else {
                format!("{shown} is not empty and holds no run of this program")
            };
            fault(reason, "name another folder with --out")
        }
    }
}

/// Refuses what is finished, and what is to be resumed but was not asked to be.
pub(super) fn refuse(
    dir: &Path,
    claim: Claim,
    what: &str,
    status: &str,
    done: &str,
) -> Result<(), ModelError> {
    let shown = dir.display();
    if status == "finished" {
        return Err(Fault::general(
            format!("{shown} already holds a finished {what}"),
            "name another folder with --out, or replace it with --force",
        )
        .into());
    }
    if claim.resume {
        return Ok(());
    }
    let state = match status {
        "running" => "is still going on, or was cut off",
        "failed" => "failed",
        _ => "was interrupted",
    };
    let reason = format!("{shown} holds a {what} that {state} ({done})");
    Err(Fault::general(reason, "finish it with --resume, or replace it with --force").into())
}

pub(super) fn other_kind(dir: &Path, what: &str) -> ModelError {
    let reason = format!("{} holds {what}", dir.display());
    Fault::general(reason, "name another folder with --out, or replace it with --force").into()
}

/// Claims a folder for a run of this record: clears what is replaced, checks that what is resumed is the same run.
///
/// # Errors
/// Why it cannot be used: another process writes there, what has changed since the run was interrupted, a folder that
/// cannot be written.
pub fn claim(dir: &Path, record: &RunRecord, earlier: &Earlier) -> Result<Held, ModelError> {
    let held = lock(dir)?;
    match earlier {
        Earlier::Nothing | Earlier::Undrawn | Earlier::Finished(_) => {
            clear_points(dir).map_err(unusable)?;
            // What an earlier run kept goes first: nobody must go on from it under the new record.
            clear_kept(dir).map_err(unusable)?;
            tables::write_record(dir, record).and_then(|()| clear(dir)).map_err(unusable)?;
        }
        Earlier::Interrupted(then) => {
            same(dir, &Identity::of_run(record), &Identity::of_run(then))?;
            remove_drafts(dir);
        }
    }
    Ok(held)
}

/// A folder that cannot be used.
pub(super) fn unusable(error: impl std::fmt::Display) -> ModelError {
    Fault::general(error.to_string(), "name another folder with --out").into()
}

/// The right to write into a folder, which is made.
///
/// # Errors
/// Another process writes there; a folder that cannot be written.
pub(super) fn lock(dir: &Path) -> Result<Held, ModelError> {
    let folder = dir.join("checkpoint");
    std::fs::create_dir_all(&folder).map_err(|e| unusable(format!("{}: {e}", folder.display())))?;
    let path = folder.join("lock");
    let lock = File::create(&path).map_err(|e| unusable(format!("{}: {e}", path.display())))?;
    match lock.try_lock() {
        // A file system without locks: one has to trust the user.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(Held { _lock: lock }),
        Err(TryLockError::WouldBlock) => Err(Fault::general(
            format!("{}: another process is writing into this folder", dir.display()),
            "wait for it, or name another folder with --out",
        )
        .into()),
    }
}

/// What makes a run or a sweep the same as one that was interrupted.
pub(super) struct Identity<'a> {
    pub model: &'a ModelText,
    pub seed: u64,
    pub realizations: [u32; 2],
    pub format: u32,
    pub version: &'a str,
}

impl Identity<'_> {
    fn of_run(record: &RunRecord) -> Identity<'_> {
        let RunRecord { model, seed, realizations, format, version, .. } = record;
        Identity { model, seed: *seed, realizations: *realizations, format: *format, version }
    }
}

/// Whether what was interrupted is the same, key by key.
pub(super) fn same(dir: &Path, now: &Identity, then: &Identity) -> Result<(), ModelError> {
    let mut faults = Vec::new();
    let remedy = "resume with what the run was started with, or start anew with --force";
    let shown = dir.display();
    let mut changed = |what: String| {
        faults.push(Fault::general(format!("{shown}: {what} since the run was interrupted"), remedy));
    };
    if now.model.hash != then.model.hash {
        let found = differences(then.model, now.model);
        if found.is_empty() {
            changed("the text of the model (not its values) has changed".into());
        }
        found.into_iter().for_each(&mut changed);
    }
    if now.seed != then.seed {
        changed(format!("the seed has changed from {} to {}", then.seed, now.seed));
    }
    if now.realizations != then.realizations {
        let ([a, b], [c, d]) = (then.realizations, now.realizations);
        changed(format!("the block of realizations has changed from {a}..{b} to {c}..{d}"));
    }
    if then.format != now.format {
        let ((a, b), (c, d)) = ((then.format, then.version), (now.format, now.version));
        changed(format!(
            "the format of what is kept has changed from {a} (program {b}) to {c} (program {d})"
        ));
    }
    if faults.is_empty() { Ok(()) } else { Err(ModelError { faults }) }
}

/// Removes the points of a sweep that is to be replaced.
pub(super) fn clear_points(dir: &Path) -> Result<(), RunError> {
    // A folder of this name is ours only in a sweep.
    if tables::is_sweep(dir) { remove(&dir.join("points")) } else { Ok(()) }
}

/// Removes what an earlier run kept to go on from; the lock stays.
pub(super) fn clear_kept(dir: &Path) -> Result<(), RunError> {
    let folder = dir.join("checkpoint");
    for entry in folder.read_dir().into_iter().flatten().flatten().filter(|e| e.file_name() != "lock") {
        remove(&entry.path())?;
    }
    Ok(())
}

/// Removes what an earlier run left in a folder, and nothing else; record and lock stay.
pub(super) fn clear(dir: &Path) -> Result<(), RunError> {
    for name in ["report.html", "tables", "figures", "vtk"] {
        remove(&dir.join(name))?;
    }
    std::fs::create_dir_all(dir.join("tables"))
        .map_err(|error| RunError::File { path: dir.display().to_string(), reason: error.to_string() })
}

fn remove(path: &Path) -> Result<(), RunError> {
    let removed = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    match removed {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(RunError::File { path: path.display().to_string(), reason: error.to_string() })
        }
        _ => Ok(()),
    }
}

/// Removes files that a killed run did not finish.
pub(super) fn remove_drafts(dir: &Path) {
    for entry in dir.read_dir().into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            remove_drafts(&path);
        } else if entry.file_name().to_string_lossy().starts_with(".writing-") {
            // One that stays is only in the way of the eye.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Removes the folder `checkpoint` of a finished run.
pub fn release(dir: &Path) {
    // The names of what is finished must be on the disk before what it was made from goes.
    for folder in [dir.join("tables"), dir.to_path_buf()] {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    // What cannot be removed harms nobody.
    let _ = std::fs::remove_dir_all(dir.join("checkpoint"));
}
