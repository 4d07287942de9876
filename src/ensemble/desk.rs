//! Where the realizations of a run on disk leave what they have seen: journal, particle tables, states.

use super::journal::{Entry, Journal, Reader};
use super::precision::Look;
use super::states::{Found, States};
use crate::error::RunError;
use crate::plan::Plan;
use crate::quantity::readable::{show, significant};
use crate::samples::ParticleFrame;
use crate::sampling;
use crate::simulation::keep::Writing;
use crate::simulation::{CourseShare, Keep, Piece, Share, Watch};
use crate::statistics::Accumulator;
use crate::tables;
use crate::vtk;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Wall time between two states of what is under way, if the model says nothing.
const USUAL: Duration = Duration::from_secs(60);

/// The run spends this many times as long as it took to save the last state before it saves the next: under 2 %.
const SHARE: u32 = 60;

/// Wall time between two lines about how well a mean is known.
const TELL: Duration = Duration::from_millis(500);

/// A desk that writes below a folder.
pub struct Desk<'w> {
    watch: &'w Watch,
    dir: PathBuf,
    journal: Mutex<Journal>,
    states: States,
    /// Bytes of the journal when it was opened.
    opened: u64,
    /// Time between states that was asked for, and the longest time that saving one took.
    every: Duration,
    longest: Mutex<Duration>,
    /// Names of the species, for the particle tables.
    species: Vec<String>,
    /// Times of the frames, s, if they are also written for ParaView.
    vtk: Option<Vec<f64>>,
    notes: Mutex<Vec<String>>,
    watched: Option<Watched>,
}

/// Whether there is an amount to be watched.
pub fn is_watchable(plan: &Plan) -> bool {
    Watched::new(plan).is_some()
}

/// The amount that is watched while the run goes on.
struct Watched {
    /// Number of the output time, column, and both in words.
    time: u32,
    column: usize,
    words: String,
    confidence: f64,
    /// Whether the run goes on until it is known: then each realization's amount is kept.
    asked: bool,
    seen: Mutex<Values>,
}

/// Amounts by realization.
struct Values {
    all: BTreeMap<u32, f64>,
    /// In the order in which they came.
    moments: Accumulator,
    told: Instant,
}

impl Watched {
    /// What the run is to know well, or else the last species at the end.
    fn new(plan: &Plan) -> Option<Watched> {
        let (columns, times) = (sampling::columns(plan), &plan.model.output.times);
        let asked = plan.model.run.until_precision.as_ref();
        let (species, group, at, confidence) = match asked {
            Some(asked) => (asked.species, asked.group, asked.time, asked.confidence),
            None => (plan.reactor.species.len().checked_sub(1)?, None, *times.last()?, 0.95),
        };
        let names = plan.model.domain.group_names();
        let group = group.map_or("all", |g| names[g].as_str());
        let name = plan.reactor.species[species].as_str();
        let place = if group == "all" { String::new() } else { format!(" in {group}") };
        Some(Watched {
            time: times.iter().position(|time| *time == at)? as u32,
            column: columns.find(group, name)?,
            words: format!("{name}{place} at {}", show(at, "s")),
            confidence,
            asked: asked.is_some(),
            seen: Mutex::new(Values {
                all: BTreeMap::new(),
                moments: Accumulator::default(),
                told: Instant::now(),
            }),
        })
    }

    /// Takes note of a piece; now and then what is known by now, in words.
    fn see(&self, piece: &Piece) -> Option<String> {
        let row = self.time.checked_sub(piece.first).filter(|row| *row < piece.outputs)? as usize;
        let width = piece.amount.len() / piece.outputs as usize;
        let value = *piece.amount.get(row * width + self.column)?;
        let mut seen = lock(&self.seen);
        // Once more after a run was taken up from a state: the same value.
        if !self.asked || seen.all.insert(piece.realization, value).is_none() {
            seen.moments.push(value);
        }
        if seen.told.elapsed() < TELL || seen.moments.count() < 2 {
            return None;
        }
        seen.told = Instant::now();
        let look = Look::of(&seen.moments, self.confidence);
        let (mean, width) = (significant(look.mean, 4), significant(look.half_width, 2));
        Some(format!("{} {mean} ± {width}", self.words))
    }
}

impl<'w> Desk<'w> {
    /// A desk below `dir`, whose folder `checkpoint` is there.
    ///
    /// # Errors
    /// A journal that cannot be used.
    pub fn new(
        dir: &Path,
        plan: &Plan,
        title: &str,
        species: Vec<String>,
        vtk: Option<Vec<f64>>,
        watch: &'w Watch,
    ) -> Result<Desk<'w>, RunError> {
        let folder = dir.join("checkpoint");
        let watched = Watched::new(plan);
        let journal = Journal::open(&folder.join("journal"), title, &mut |entry| {
            if let (Entry::Piece(piece), Some(watched)) = (entry, &watched) {
                watched.see(piece);
            }
        })?;
        let mut notes = Vec::new();
        if journal.cut {
            notes.push("the journal was damaged: what came after the damage was run again".to_string());
        }
        Ok(Desk {
            watch,
            dir: dir.to_path_buf(),
            opened: journal.length(),
            journal: Mutex::new(journal),
            states: States::new(&folder, title),
            every: plan.model.run.checkpoint_every.map_or(USUAL, Duration::from_secs_f64),
            longest: Mutex::default(),
            species,
            vtk,
            notes: Mutex::new(notes),
            watched,
        })
    }

    /// Who watches the run.
    #[must_use]
    pub fn watch(&self) -> &'w Watch {
        self.watch
    }

    /// What the first realizations say of the amount that is watched.
    #[must_use]
    pub fn look(&self, realizations: u32, confidence: f64) -> Look {
        let Some(watched) = &self.watched else { return Look::at(std::iter::empty(), confidence) };
        Look::at(lock(&watched.seen).all.range(..realizations).map(|(_, value)| *value), confidence)
    }

    /// The amount that is watched, in words.
    #[must_use]
    pub fn watched_words(&self) -> String {
        self.watched.as_ref().map(|watched| watched.words.clone()).unwrap_or_default()
    }

    /// Notes something the user should know.
    pub fn note(&self, words: String) {
        lock(&self.notes).push(words);
    }

    /// Realizations of a block that are not finished yet.
    #[must_use]
    pub fn unfinished(&self, block: std::ops::Range<u32>) -> Vec<u32> {
        let journal = lock(&self.journal);
        block.filter(|number| !journal.index().finished.contains(number)).collect()
    }

    /// Ends the writing; what was noted, and what was seen.
    ///
    /// # Errors
    /// A journal that cannot be written.
    pub fn close(self) -> Result<(Vec<String>, Reader), RunError> {
        let notes = self.notes.into_inner().unwrap_or_else(PoisonError::into_inner);
        let journal = self.journal.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok((notes, journal.close()?))
    }

    /// ParaView files of some frames of a realization below `vtk/`, of which `before` were written earlier: one `.vtu`
    /// per output time and a `.pvd` that lists them all.
    fn write_vtk(
        &self,
        times: &[f64],
        realization: u32,
        before: usize,
        frames: &[ParticleFrame],
    ) -> Result<(), RunError> {
        let folder = self.dir.join("vtk");
        let name = |k: usize| format!("realization-{realization:04}-{k:05}.vtu");
        for (k, frame) in frames.iter().enumerate() {
            vtk::write_vtu(&folder.join(name(before + k)), frame, &self.species)?;
        }
        let listed: Vec<(f64, String)> =
            times.iter().take(before + frames.len()).enumerate().map(|(k, &time)| (time, name(k))).collect();
        vtk::write_pvd(&folder.join(format!("realization-{realization:04}.pvd")), &listed)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Keep for Desk<'_> {
    fn piece(&self, piece: Piece) -> Result<(), RunError> {
        if let Some(words) = self.watched.as_ref().and_then(|watched| watched.see(&piece)) {
            self.watch.tell(words);
        }
        lock(&self.journal).append(Entry::Piece(piece))
    }

    fn frames(
        &self,
        realization: u32,
        (part, before): (u32, u32),
        frames: Vec<ParticleFrame>,
    ) -> Result<(), RunError> {
        tables::write_particles(&self.dir, realization, part, &self.species, &frames)?;
        match &self.vtk {
            Some(times) => self.write_vtk(times, realization, before as usize, &frames),
            None => Ok(()),
        }
    }

    fn finished(&self, realization: u32, share: Share) -> Result<(), RunError> {
        lock(&self.journal).append(Entry::Finished { realization, share })
    }

    fn course(&self, name: &str, share: CourseShare) -> Result<(), RunError> {
        lock(&self.journal).append(Entry::Course { name: name.into(), share })
    }

    fn patience(&self) -> Option<Duration> {
        Some(self.every.max(*lock(&self.longest) * SHARE))
    }

    fn save(&self, name: &str, write: &mut Writing) -> Result<(), RunError> {
        // A state must not be newer than what was seen before it.
        let begun = Instant::now();
        let mut journal = lock(&self.journal);
        journal.flush()?;
        journal.sync()?;
        let length = journal.length();
        drop(journal);
        self.states.save(name, length, write)?;
        let mut longest = lock(&self.longest);
        *longest = begun.elapsed().max(*longest);
        Ok(())
    }

    fn saved(&self, name: &str) -> Result<Option<Vec<u8>>, RunError> {
        match self.states.saved(name, self.opened)? {
            Found::None => Ok(None),
            Found::State(state) => Ok(Some(state)),
            Found::Older { state: Some(state), reason } => {
                self.note(format!("{reason}; the run went on from the state before it"));
                Ok(Some(state))
            }
            Found::Older { state: None, reason } => Err(RunError::File {
                path: self.dir.join("checkpoint").display().to_string(),
                reason: format!(
                    "{reason}, and there is no other state to go on from; --resume again starts what was under way from its beginning and keeps what is finished, --force starts all anew"
                ),
            }),
        }
    }

    fn forget(&self, name: &str) {
        // Only once what comes after the state is in the file, too; a state too many does no harm.
        if !self.states.any(name) {
            return;
        }
        let mut journal = lock(&self.journal);
        if journal.flush().and_then(|()| journal.sync()).is_ok() {
            self.states.forget(name);
        }
    }
}
