//! Where the realizations of a run on disk leave what they have seen: journal, particle tables, states.

use super::journal::{Entry, Journal, Reader};
use super::states::{Found, States};
use crate::error::RunError;
use crate::samples::ParticleFrame;
use crate::simulation::keep::Writing;
use crate::simulation::{CourseShare, Keep, Piece, Share};
use crate::tables;
use crate::vtk;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Wall time between two states of what is under way, if the model says nothing.
const USUAL: Duration = Duration::from_secs(60);

/// The run spends this many times as long as it took to save the last state before it saves the next: under 2 %.
const SHARE: u32 = 60;

/// A desk that writes below a folder.
pub struct Desk {
    dir: PathBuf,
    journal: Mutex<Journal>,
    states: States,
    /// Time between states that was asked for, and the longest time that saving one took.
    every: Duration,
    longest: Mutex<Duration>,
    /// Names of the species, for the particle tables.
    species: Vec<String>,
    /// Times of the frames, s, if they are also written for ParaView.
    vtk: Option<Vec<f64>>,
    notes: Mutex<Vec<String>>,
}

impl Desk {
    /// A desk below `dir`, whose folder `checkpoint` is there.
    ///
    /// # Errors
    /// A journal that cannot be used.
    pub fn new(
        dir: &Path,
        hash: &str,
        every: Option<f64>,
        species: Vec<String>,
        vtk: Option<Vec<f64>>,
    ) -> Result<Desk, RunError> {
        let folder = dir.join("checkpoint");
        Ok(Desk {
            dir: dir.to_path_buf(),
            journal: Mutex::new(Journal::open(&folder.join("journal"))?),
            states: States::new(&folder, hash),
            every: every.map_or(USUAL, Duration::from_secs_f64),
            longest: Mutex::default(),
            species,
            vtk,
            notes: Mutex::default(),
        })
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

impl Keep for Desk {
    fn piece(&self, piece: Piece) -> Result<(), RunError> {
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

    fn course(&self, share: CourseShare) -> Result<(), RunError> {
        lock(&self.journal).append(Entry::Course(share))
    }

    fn patience(&self) -> Option<Duration> {
        Some(self.every.max(*lock(&self.longest) * SHARE))
    }

    fn save(&self, name: &str, write: &mut Writing) -> Result<(), RunError> {
        // A state must not be newer than what was seen before it.
        let mut journal = lock(&self.journal);
        journal.flush()?;
        journal.sync()?;
        drop(journal);
        let begun = Instant::now();
        self.states.save(name, write)?;
        let mut longest = lock(&self.longest);
        *longest = begun.elapsed().max(*longest);
        Ok(())
    }

    fn saved(&self, name: &str) -> Result<Option<Vec<u8>>, RunError> {
        match self.states.saved(name)? {
            Found::None => Ok(None),
            Found::State(state) => Ok(Some(state)),
            Found::Older { state: Some(state), reason } => {
                lock(&self.notes).push(format!("{reason}; the run went on from the state before it"));
                Ok(Some(state))
            }
            Found::Older { state: None, reason } => Err(RunError::File {
                path: self.dir.join("checkpoint").display().to_string(),
                reason: format!("{reason}, and there is no older state; start anew with --force"),
            }),
        }
    }

    fn forget(&self, name: &str) {
        // Only once what comes after the state is in the file, too; a state too many does no harm.
        if self.states.any(name) && lock(&self.journal).flush().is_ok() {
            self.states.forget(name);
        }
    }
}
