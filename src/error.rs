//! What can be wrong: faults in what the user wrote, and faults of a run.

use std::fmt;
use std::sync::Arc;

/// The text of a file a user wrote, kept for messages.
#[derive(Debug, PartialEq, Eq)]
pub struct Source {
    /// The path as the user would type it.
    pub path: String,
    pub text: String,
}

/// A stretch of characters in a [`Source`]; line and column count from one, in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    pub source: Arc<Source>,
    pub line: u32,
    pub column: u32,
    /// Length of the stretch in characters, at least one.
    pub width: u32,
}

impl Place {
    /// The same place moved right by `offset` characters, `width` wide; for faults inside a scalar.
    #[must_use]
    pub fn inside(&self, offset: usize, width: usize) -> Place {
        Place { column: self.column + offset as u32, width: width.max(1) as u32, ..self.clone() }
    }
}

/// One fault of the input: where, what is wrong, what to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    pub place: Option<Place>,
    /// What is wrong and what was expected, one line.
    pub reason: String,
    /// What to do about it; empty where the reason says it all.
    pub remedy: String,
}

impl Fault {
    /// A fault at a place.
    pub fn at(place: &Place, reason: impl Into<String>, remedy: impl Into<String>) -> Fault {
        Fault { place: Some(place.clone()), reason: reason.into(), remedy: remedy.into() }
    }

    /// A fault that belongs to no place in a file (a command-line option, a missing file).
    pub fn general(reason: impl Into<String>, remedy: impl Into<String>) -> Fault {
        Fault { place: None, reason: reason.into(), remedy: remedy.into() }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            writeln!(f, "{}:{}:{}  {}", place.source.path, place.line, place.column, self.reason)?;
            if let Some(line) = place.source.text.lines().nth(place.line as usize - 1) {
                let number = place.line.to_string();
                let blank = " ".repeat(number.len());
                let before: String = line
                    .chars()
                    .take(place.column as usize - 1)
                    .map(|c| if c == '\t' { '\t' } else { ' ' })
                    .collect();
                writeln!(f, "  {number} | {line}")?;
                writeln!(f, "  {blank} | {before}{}", "^".repeat(place.width.max(1) as usize))?;
            }
        } else {
            writeln!(f, "{}", self.reason)?;
        }
        if !self.remedy.is_empty() {
            writeln!(f, "    {}", self.remedy)?;
        }
        Ok(())
    }
}

/// Everything that is wrong with what the user wrote, reported together. Exit status 2.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct ModelError {
    pub faults: Vec<Fault>,
}

impl From<Fault> for ModelError {
    fn from(fault: Fault) -> ModelError {
        ModelError { faults: vec![fault] }
    }
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for fault in &self.faults {
            write!(f, "{fault}")?;
        }
        Ok(())
    }
}

/// What the numbers of a run did wrong. Exit status 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RunError {
    /// A quantity of a particle left its bounds or stopped being a number.
    #[error("step {step}, t = {time:.6e} s, particle {particle}: {quantity} = {value:.6e}; {remedy}")]
    BlowUp { step: u64, time: f64, particle: usize, quantity: String, value: f64, remedy: String },
    /// A count would have gone below zero.
    #[error("t = {time:.6e} s, voxel {voxel}: {species} = {count} below zero after {event}")]
    NegativeCount { time: f64, voxel: usize, species: String, count: f64, event: String },
    /// A propensity that is negative, infinite or not a number.
    #[error("t = {time:.6e} s, voxel {voxel}: the propensity of {reaction} is {value}, with {amounts}")]
    Propensity { time: f64, voxel: usize, reaction: String, value: f64, amounts: String },
    /// A file of the run could not be written or read.
    #[error("{path}: {reason}")]
    File { path: String, reason: String },
}
