//! One mapping, read key by key; what was not asked for is unknown.

use super::Faults;
use crate::error::{Fault, Place};
use crate::model::node::{Key, Node, Value, known_keys, repeated_keys};

/// Reads one mapping and remembers which keys were asked for.
#[derive(Debug)]
pub struct Fields<'a> {
    node: &'a Node,
    what: String,
    entries: &'a [(Key, Node)],
    asked: Vec<&'static str>,
}

impl<'a> Fields<'a> {
    /// The fields of a mapping; `what` names it in messages, e.g. `species "L"`. Reports repeated keys.
    pub fn of(node: &'a Node, what: &str, faults: &mut Faults) -> Option<Fields<'a>> {
        match &node.value {
            Value::Map(entries) => {
                repeated_keys(entries).into_iter().for_each(|fault| faults.push(fault));
                Some(Fields { node, what: what.to_string(), entries, asked: Vec::new() })
            }
            _ => {
                faults.at(
                    &node.place,
                    format!("{what}: expected a mapping, found {}", node.describe()),
                    "write { key: value, … } or indented \"key: value\" lines",
                );
                None
            }
        }
    }

    /// Where the mapping stands.
    #[must_use]
    pub fn place(&self) -> &'a Place {
        &self.node.place
    }

    /// The value of a key that must be there.
    pub fn required(&mut self, key: &'static str, faults: &mut Faults) -> Option<&'a Node> {
        let found = self.optional(key);
        if found.is_none() {
            let empty = self.entries.iter().find(|(k, _)| k.name == key);
            let (place, reason) = match empty {
                Some((k, _)) => (&k.place, format!("{}: \"{key}\" has no value", self.what)),
                None => (&self.node.place, format!("{}: \"{key}\" is missing", self.what)),
            };
            faults.push(Fault::at(place, reason, format!("add \"{key}: …\"")));
        }
        found
    }

    /// The value of a key that may be left out; null counts as left out.
    pub fn optional(&mut self, key: &'static str) -> Option<&'a Node> {
        if !self.asked.contains(&key) {
            self.asked.push(key);
        }
        let (_, node) = self.entries.iter().find(|(k, _)| k.name == key)?;
        (node.value != Value::Null).then_some(node)
    }

    /// The place of a key, if it is written.
    #[must_use]
    pub fn key_place(&self, key: &str) -> Option<&'a Place> {
        self.entries.iter().find(|(k, _)| k.name == key).map(|(k, _)| &k.place)
    }

    /// All entries, for mappings with free names; do not call [`Fields::finish`] on these.
    #[must_use]
    pub fn entries(&self) -> &'a [(Key, Node)] {
        self.entries
    }

    /// Reports every key that was not asked for.
    pub fn finish(self, faults: &mut Faults) {
        for (key, _) in self.entries {
            if !self.asked.iter().any(|asked| *asked == key.name) {
                faults.at(
                    &key.place,
                    format!("{}: unknown key \"{}\"", self.what, key.name),
                    known_keys(&key.name, self.asked.iter().copied()),
                );
            }
        }
    }
}
