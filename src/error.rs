//! What can be wrong: faults in what the user wrote, and faults of a run.

use std::fmt;
use std::sync::{Arc, OnceLock};

/// The text of a file a user wrote, kept for messages.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// The path as the user would type it.
    pub path: String,
    pub text: String,
    replaced: OnceLock<Vec<Replaced>>,
}

/// Something in a [`Source`] that does not count any more, because it was set on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replaced {
    pub line: u32,
    /// Where something round it begins; none for what was replaced itself, by which its whole line is out of date.
    pub column: Option<u32>,
    /// As typed, e.g. `--set run.until=1 s`.
    pub by: String,
}

impl Source {
    /// A text, and the path it is known by.
    pub fn new(path: impl Into<String>, text: impl Into<String>) -> Source {
        Source { path: path.into(), text: text.into(), replaced: OnceLock::new() }
    }

    /// Notes what was set on the command line; once.
    pub fn replace(&self, replaced: Vec<Replaced>) {
        let _ = self.replaced.set(replaced);
    }

    /// What was set of what a place shows.
    fn set_at(&self, place: &Place) -> Vec<&str> {
        let here = |one: &&Replaced| {
            one.line == place.line && one.column.is_none_or(|column| column == place.column)
        };
        let mut found: Vec<&str> =
            self.replaced.get().into_iter().flatten().filter(here).map(|one| one.by.as_str()).collect();
        found.dedup();
        found
    }
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
    /// Whether it is the same stretch of the same text.
    #[must_use]
    pub fn is_same(&self, other: &Place) -> bool {
        (self.line, self.column, self.width) == (other.line, other.column, other.width)
            && Arc::ptr_eq(&self.source, &other.source)
    }

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

    /// The fault on one line, for lists of warnings.
    #[must_use]
    pub fn line(&self) -> String {
        let place = self.place.as_ref();
        let place =
            place.map_or_else(String::new, |p| format!("{}:{}:{}  ", p.source.path, p.line, p.column));
        let remedy = if self.remedy.is_empty() { String::new() } else { format!("; {}", self.remedy) };
        format!("{place}{}{remedy}", self.reason)
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
            if let Some(line) = place.source.text.lines().nth((place.line as usize).saturating_sub(1)) {
                let number = place.line.to_string();
                let blank = " ".repeat(number.len());
                let (shown, carets) = excerpt(line, place.column as usize, place.width as usize);
                writeln!(f, "  {number} | {shown}")?;
                writeln!(f, "  {blank} | {carets}")?;
                for by in place.source.set_at(place) {
                    writeln!(f, "  {blank} = with {by}")?;
                }
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

/// Characters of a source line shown at most.
const SHOWN: usize = 100;

/// The part of a line round a fault, and the line of carets below it. What is cut off is marked by `…`.
fn excerpt(line: &str, column: usize, width: usize) -> (String, String) {
    let characters: Vec<char> = line.chars().collect();
    let at = column.saturating_sub(1).min(characters.len());
    // A third of what is shown stands before the fault.
    let start = if characters.len() <= SHOWN {
        0
    } else {
        at.saturating_sub(SHOWN / 3).min(characters.len() - SHOWN)
    };
    let end = (start + SHOWN).min(characters.len());
    let mut shown = String::new();
    let mut carets = String::new();
    if start > 0 {
        shown.push_str("… ");
        carets.push_str("  ");
    }
    shown.extend(
        characters[start..end].iter().map(|&c| if c != '\t' && c.is_control() { '\u{fffd}' } else { c }),
    );
    carets.extend(characters[start..at].iter().map(|&c| if c == '\t' { '\t' } else { ' ' }));
    carets.push_str(&"^".repeat(width.clamp(1, (end - at).max(1))));
    if end < characters.len() {
        shown.push_str(" …");
    }
    (shown, carets)
}

/// Everything that is wrong with what the user wrote, reported together. Exit status 2.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct ModelError {
    pub faults: Vec<Fault>,
}

impl ModelError {
    /// Faults in order of file, line and column; files in the order in which their first fault was found,
    /// what belongs to no file first.
    #[must_use]
    pub fn sorted(mut faults: Vec<Fault>) -> ModelError {
        let mut files: Vec<String> = Vec::new();
        for place in faults.iter().filter_map(|fault| fault.place.as_ref()) {
            if !files.contains(&place.source.path) {
                files.push(place.source.path.clone());
            }
        }
        faults.sort_by_key(|fault| {
            fault.place.as_ref().map(|place| {
                let file = files.iter().position(|path| *path == place.source.path);
                (file, place.line, place.column)
            })
        });
        ModelError { faults }
    }
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
    #[error(
        "t = {time:.6e} s, voxel {voxel}: the propensity of {reaction} is {value}, with {amounts} molecules; {expression}. A rate law must give a finite number, zero or more, for every amount; guard it, e.g. by max(0, ...)"
    )]
    Propensity {
        time: f64,
        voxel: usize,
        reaction: String,
        value: f64,
        amounts: String,
        /// The propensity in words, with its numbers.
        expression: String,
    },
    /// A file of the run could not be written or read.
    #[error("{path}: {reason}")]
    File { path: String, reason: String },
    /// Any of these, in one realization of several.
    #[error("realization {realization}: {error}")]
    Of { realization: u32, error: Box<RunError> },
}

impl RunError {
    /// Says in which realization it was, if that is not said yet.
    #[must_use]
    pub fn of(self, realization: u32) -> RunError {
        match self {
            RunError::Of { .. } => self,
            error => RunError::Of { realization, error: Box::new(error) },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_is_cropped_round_the_fault() {
        let line = format!("{}Q{}", "é".repeat(400), "z".repeat(400));
        for column in [1, 50, 401, 801] {
            let (shown, carets) = excerpt(&line, column, 300);
            assert!(shown.chars().count() <= SHOWN + 4 && carets.chars().count() <= SHOWN + 2);
        }
        let (shown, carets) = excerpt(&line, 401, 1);
        let under = carets.chars().position(|c| c == '^').unwrap();
        assert_eq!(shown.chars().nth(under), Some('Q'));
        assert!(shown.starts_with('…') && shown.ends_with('…'));
    }

    #[test]
    fn a_short_line_is_shown_whole() {
        assert_eq!(excerpt("a: b", 4, 1), ("a: b".to_string(), "   ^".to_string()));
        // A place behind the end, as of something that is missing there.
        assert_eq!(excerpt("ab", 9, 5), ("ab".to_string(), "  ^".to_string()));
    }
}
