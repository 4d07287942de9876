//! From the parser's locations to places in the source text.

use super::{Key, Node, Raw, Value};
use crate::error::{Place, Source};
use serde_yaml::{Location, Spanned};
use std::sync::Arc;

/// The first character of the source.
pub(super) fn start(source: &Arc<Source>) -> Place {
    Place { source: source.clone(), line: 1, column: 1, width: 1 }
}

/// One character of the source; moved to the last line's end where it lies behind it.
pub(super) fn point(source: &Arc<Source>, line: u32, column: u32) -> Place {
    let lines = source.text.lines().count().max(1) as u32;
    if line == 0 {
        return start(source);
    }
    if line > lines {
        let last = source.text.lines().last().unwrap_or("").chars().count() as u32;
        return Place { source: source.clone(), line: lines, column: last.max(1), width: 1 };
    }
    Place { source: source.clone(), line, column: column.max(1), width: 1 }
}

/// The tree with places.
pub(super) fn place(raw: Spanned<Raw>, source: &Arc<Source>) -> Node {
    // An alias `*a` is reported where the value is written, so that offsets inside the text are right.
    let at = if raw.defined.line() == 0 { raw.referenced } else { raw.defined };
    let text = written(at, source);
    let value = match raw.value {
        Raw::Null => Value::Null,
        Raw::Bool(value) => Value::Bool(value),
        Raw::Integer(value) => match text.filter(|t| underscored(t)) {
            Some(text) => Value::Text(text.to_string()),
            None => Value::Integer(value),
        },
        Raw::Real(value) => match text.filter(|t| underscored(t)) {
            Some(text) => Value::Text(text.to_string()),
            None => Value::Real(value),
        },
        Raw::Text(text) => Value::Text(text),
        Raw::List(items) => Value::List(items.into_iter().map(|item| place(item, source)).collect()),
        Raw::Map(entries) => Value::Map(
            entries.into_iter().map(|(key, value)| (key_of(key, source), place(value, source))).collect(),
        ),
    };
    Node { place: extent(at, source, &value), value }
}

/// YAML 1.1 allows `1_000`; here it stays a text, and no number.
fn underscored(text: &str) -> bool {
    text.contains('_')
}

fn key_of(raw: Spanned<Raw>, source: &Arc<Source>) -> Key {
    let written_text = written(raw.defined, source).map(str::to_string);
    let node = place(raw, source);
    let name = match node.value {
        Value::Text(text) => text,
        // A number, a boolean or null as a key is the name as it is written: `1: …`, `true: …`.
        other => written_text.unwrap_or_else(|| match other {
            Value::Integer(value) => value.to_string(),
            Value::Bool(value) => value.to_string(),
            Value::Real(value) => value.to_string(),
            _ => String::new(),
        }),
    };
    Key { name, place: node.place }
}

/// The characters a location covers.
fn written(at: Location, source: &Source) -> Option<&str> {
    let start = usize::try_from(at.span().byte_offset()?).ok()?;
    let length = usize::try_from(at.span().byte_len()?).ok()?;
    source.text.get(start..start.checked_add(length)?).map(str::trim_end)
}

/// The place of a value: of a quoted text the characters inside the quotes, so that offsets into the text
/// point right; of a list or mapping its first character.
fn extent(at: Location, source: &Arc<Source>, value: &Value) -> Place {
    let mut place = point(source, at.line() as u32, at.column() as u32);
    let Some(text) = written(at, source) else { return place };
    let first_line = text.lines().next().unwrap_or("");
    match value {
        Value::List(_) | Value::Map(_) => {}
        Value::Text(value) if first_line.starts_with(['"', '\'']) => {
            place.column += 1;
            place.width = (value.chars().count().min(first_line.chars().count().max(3) - 2)).max(1) as u32;
        }
        // A block text starts on the line after its mark.
        Value::Text(value) if first_line.starts_with(['|', '>']) => {
            let line = source.text.lines().nth(place.line as usize).unwrap_or("");
            let indent = line.chars().take_while(|c| *c == ' ').count();
            if !line.trim().is_empty() && value.trim_start().starts_with(line.trim()) {
                place.line += 1;
                place.column = indent as u32 + 1;
                place.width = (line.trim().chars().count()).max(1) as u32;
            }
        }
        _ => place.width = first_line.trim_end().chars().count().max(1) as u32,
    }
    place
}
