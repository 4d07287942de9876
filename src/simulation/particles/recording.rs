//! A flow on file: the particles at t = 0 and after each chemistry step, for other realizations, or another chemistry, on
//! the same flow.

use crate::error::RunError;
use crate::fluid::Snapshot;
use crate::fluid::open::Presence;
use crate::packet::{self, Found};
use crate::plan::ParticlePlan;
use crate::simulation::clock::Interval;
use crate::simulation::keep::CourseShare;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Raised when files of an earlier program cannot be read any more.
const FORMAT: u32 = 1;
const WORDS: &str = "gillesph flow";

/// What a recording is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Title {
    words: String,
    format: u32,
    /// Names the particles as they are placed.
    particles: String,
    /// What of the model makes the flow: values by path.
    pub makings: BTreeMap<String, String>,
    /// t = 0 and the end of each chemistry step, s.
    times: Vec<f64>,
}

/// The particles at an instant.
#[derive(Serialize, Deserialize)]
pub(super) struct Frame<const D: usize> {
    pub snapshot: Snapshot<D>,
    pub presence: Vec<Presence>,
}

impl Title {
    /// Of a plan whose chemistry goes by this clock.
    pub fn new<const D: usize>(
        plan: &ParticlePlan<D>,
        clock: &[Interval],
        makings: BTreeMap<String, String>,
    ) -> Title {
        let mut times = vec![0.0];
        for interval in clock {
            times.extend((1..=interval.ticks).map(|k| interval.time(k)));
        }
        Title { words: WORDS.into(), format: FORMAT, particles: name_of(plan), makings, times }
    }

    /// The clock by which a chemistry on this flow goes through the output `times`, s: the chemistry steps recorded.
    /// An output time that is none of the instants, or steps of different length before it, are told.
    pub fn clock(&self, outputs: &[f64]) -> Result<Vec<Interval>, String> {
        let mut at = 0;
        let mut clock = Vec::new();
        for &end in outputs {
            let near = |t: &f64| (t - end).abs() <= 1e-9 * end.abs();
            let Some(next) = (at..self.times.len()).find(|&k| near(&self.times[k])) else {
                let last = self.times.last().copied().unwrap_or(0.0);
                return Err(format!(
                    "the output time {end} s is no instant of the recorded flow, which ends at {last} s"
                ));
            };
            let (start, ticks) = (self.times[at], (next - at) as u64);
            let even = (end - start) / (ticks.max(1) as f64);
            let uneven = |k: &usize| (self.times[k + 1] - self.times[*k] - even).abs() > 1e-6 * even;
            if (at..next).any(|k| uneven(&k)) {
                return Err(format!(
                    "between {start} s and {end} s the flow was recorded in steps of different length"
                ));
            }
            clock.push(Interval { start, end, ticks, fluid_steps: 0 });
            at = next;
        }
        Ok(clock)
    }
}

/// A name for the particles of a plan: where they are placed, how large, in which group.
fn name_of<const D: usize>(plan: &ParticlePlan<D>) -> String {
    let mut sum = Sha256::new();
    for particle in &plan.particles {
        particle.position.iter().for_each(|x| sum.update(x.to_le_bytes()));
        sum.update(particle.volume.to_le_bytes());
    }
    sum.update(&plan.home);
    sum.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

fn fault(path: &Path, reason: impl std::fmt::Display) -> RunError {
    RunError::File { path: path.display().to_string(), reason: reason.to_string() }
}

/// Whether a file is a recorded flow.
fn is_recording(path: &Path) -> bool {
    let Ok(mut file) = File::open(path) else { return false };
    let left = file.metadata().map_or(0, |data| data.len());
    match packet::read(&mut file, left) {
        Ok(Found::Packet(_, content)) => {
            postcard::from_bytes::<Title>(&content).is_ok_and(|title| title.words == WORDS)
        }
        _ => false,
    }
}

/// A recording that is being made, under a temporary name.
pub(super) struct Recorder {
    path: PathBuf,
    draft: PathBuf,
    out: BufWriter<File>,
    /// Bytes written.
    pub length: u64,
}

impl Recorder {
    /// Begins a recording, or goes on with one of which `length` bytes were written.
    pub fn new(path: &Path, title: &Title, length: Option<u64>) -> Result<Recorder, RunError> {
        let mut draft = path.as_os_str().to_owned();
        draft.push(".writing");
        let draft = PathBuf::from(draft);
        let failed = |error: std::io::Error| fault(&draft, error);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        if path.exists() && !is_recording(path) {
            return Err(fault(
                path,
                "there is another file in the place of the flow to be recorded; choose another name",
            ));
        }
        if length.is_some() && !draft.exists() && path.exists() {
            // Stopped between the end of the recording and that of the realizations on it.
            std::fs::rename(path, &draft).map_err(failed)?;
        }
        let begun = length.filter(|&length| draft.metadata().is_ok_and(|data| data.len() >= length));
        if length.is_some() && begun.is_none() {
            return Err(fault(&draft, "the part recorded before is missing; start anew with --force"));
        }
        let mut options = File::options();
        let mut file =
            options.write(true).create(true).truncate(begun.is_none()).open(&draft).map_err(failed)?;
        if let Some(length) = begun {
            file.set_len(length).and_then(|()| file.seek(SeekFrom::End(0))).map_err(failed)?;
        }
        let mut recorder = Recorder {
            path: path.to_path_buf(),
            out: BufWriter::new(file),
            length: begun.unwrap_or(0),
            draft: draft.clone(),
        };
        if begun.is_none() {
            recorder.push(title)?;
        }
        Ok(recorder)
    }

    /// Appends something.
    pub fn push<T: Serialize>(&mut self, what: &T) -> Result<(), RunError> {
        let content = postcard::to_stdvec(what).map_err(|error| fault(&self.draft, error))?;
        self.length += packet::write(&mut self.out, &content).map_err(|error| fault(&self.draft, error))?;
        Ok(())
    }

    /// Drives what was written to the file, so that a state may count on it.
    pub fn flush(&mut self) -> Result<(), RunError> {
        let written = self.out.flush().and_then(|()| self.out.get_ref().sync_data());
        written.map_err(|error| fault(&self.draft, error))
    }

    /// Completes the recording and gives it its name.
    pub fn finish(mut self, course: &CourseShare) -> Result<(), RunError> {
        self.push(course)?;
        self.flush()?;
        let synced = self.out.get_ref().sync_all().and_then(|()| std::fs::rename(&self.draft, &self.path));
        synced.map_err(|error| fault(&self.path, error))
    }
}

/// A recording that is played.
pub(super) struct Player<const D: usize> {
    path: PathBuf,
    file: BufReader<File>,
    left: u64,
    pub title: Title,
}

impl<const D: usize> Player<D> {
    /// Opens a recording of the particles of a plan.
    pub fn open(path: &Path, plan: &ParticlePlan<D>) -> Result<Player<D>, RunError> {
        let failed = |error: std::io::Error| fault(path, error);
        let file = File::open(path).map_err(failed)?;
        let left = file.metadata().map_err(failed)?.len();
        let nothing = Title {
            words: String::new(),
            format: 0,
            particles: String::new(),
            makings: BTreeMap::new(),
            times: Vec::new(),
        };
        let mut player =
            Player { path: path.to_path_buf(), file: BufReader::new(file), left, title: nothing };
        player.title = player.read().map_err(|_| fault(path, "this is no recorded flow"))?;
        if player.title.words != WORDS || player.title.format != FORMAT {
            return Err(fault(path, "recorded by another version of the program; record it again"));
        }
        if player.title.particles != name_of(plan) {
            return Err(fault(path, "a flow of other particles; record it again with this geometry"));
        }
        Ok(player)
    }

    /// The particles at the next instant.
    pub fn next(&mut self) -> Result<Frame<D>, RunError> {
        self.read()
    }

    fn read<T: for<'de> Deserialize<'de>>(&mut self) -> Result<T, RunError> {
        match packet::read(&mut self.file, self.left).map_err(|error| fault(&self.path, error))? {
            Found::Packet(length, content) => {
                self.left -= length;
                postcard::from_bytes(&content).map_err(|error| fault(&self.path, error))
            }
            Found::End => Err(fault(&self.path, "the recorded flow ends here; record it again")),
            Found::Damaged => Err(fault(&self.path, "the recorded flow is damaged; record it again")),
        }
    }
}
