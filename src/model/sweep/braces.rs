//! Functions of values inside braces, put together again.

use crate::model::node::{Key, Node, Value};

/// In braces YAML ends a text at a comma, so that `{ k: logspace(1 1/s, 9 1/s, 5) }` comes as three entries, the last two
/// without a value: makes them one again in a document.
pub(in crate::model) fn rejoin(document: &mut Node) {
    let Value::Map(sections) = &mut document.value else { return };
    let sweep = sections.iter_mut().find(|(key, _)| key.name == "sweep");
    let Some(Value::Map(entries)) = sweep.map(|(_, node)| &mut node.value) else { return };
    let mut out: Vec<(Key, Node)> = Vec::new();
    for (key, value) in entries.drain(..) {
        if let Some((_, before)) = out.last_mut()
            && let Value::Text(text) = &mut before.value
            && text.contains('(')
            && !text.contains(')')
            && value.value == Value::Null
        {
            text.push(',');
            // Blanks as in the file, so that columns in the text are columns of the line.
            let (at, end) = (key.place.column as usize, before.place.column as usize + text.chars().count());
            let same = key.place.line == before.place.line;
            text.push_str(&" ".repeat(if same { at.saturating_sub(end) } else { 1 }));
            text.push_str(&key.name);
            before.place.width = text.chars().count() as u32;
            continue;
        }
        out.push((key, value));
    }
    *entries = out;
}
