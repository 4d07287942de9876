//! Places in an SBML file, and what is found to say about them.

use crate::error::{Fault, Place, Source};
use crate::model::reader::Faults;
use std::sync::Arc;

/// A stretch of the file's text, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spot {
    start: usize,
    width: usize,
}

impl Spot {
    /// The start tag's name of an element.
    pub fn of(node: roxmltree::Node) -> Spot {
        // Names with a prefix are as wide as they are written, `<math:apply`.
        let text = node.document().input_text();
        let start = node.range().start;
        let name = text[start..].find(|c: char| c.is_whitespace() || matches!(c, '>' | '/'));
        Spot { start, width: name.unwrap_or(1) }
    }
}

/// Faults and notes of an import.
pub(super) struct Log {
    source: Arc<Source>,
    /// Byte at which each line starts.
    lines: Vec<usize>,
    pub faults: Faults,
    /// What was assumed or left out, for the user to read.
    pub notes: Vec<String>,
}

impl Log {
    pub fn new(source: Arc<Source>) -> Log {
        let lines = std::iter::once(0).chain(source.text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Log { source, lines, faults: Faults::new(), notes: Vec::new() }
    }

    pub fn fault(&mut self, spot: Spot, reason: impl Into<String>, remedy: impl Into<String>) {
        let place = self.place(spot);
        self.faults.at(&place, reason, remedy);
    }

    /// Adds a note unless the same one is known.
    pub fn note(&mut self, words: impl Into<String>) {
        let words = words.into();
        if !self.notes.contains(&words) {
            self.notes.push(words);
        }
    }

    pub fn place(&self, spot: Spot) -> Place {
        let line = self.lines.partition_point(|&start| start <= spot.start).max(1);
        let text = &self.source.text;
        let column = text[self.lines[line - 1]..spot.start].chars().count();
        let width = text[spot.start..].chars().take(spot.width).count();
        Place {
            source: self.source.clone(),
            line: line as u32,
            column: column as u32 + 1,
            width: width.max(1) as u32,
        }
    }

    /// The fault of a text that is no XML.
    pub fn malformed(&self, error: &roxmltree::Error) -> Fault {
        let at = error.pos();
        let place = Place { source: self.source.clone(), line: at.row, column: at.col, width: 1 };
        // The library appends the position, which the place says already.
        let words = error.to_string();
        let reason = words.split(" at ").next().unwrap_or(&words).to_string();
        let remedy = match error {
            roxmltree::Error::DtdDetected => "remove the <!DOCTYPE …> declaration; SBML has none",
            roxmltree::Error::UnexpectedCloseTag(..) => {
                "close elements in the order in which they were opened"
            }
            roxmltree::Error::UnclosedRootNode => "the file seems to be cut off: copy or load it down again",
            _ => "the file must be well-formed XML in UTF-8",
        };
        Fault::at(&place, format!("this is no XML: {reason}"), remedy)
    }
}
