//! What differs between two texts of a model, key by key.

use crate::record::ModelText;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// In words, e.g. ``run.until has changed from `1 s` to `2 s` ``; empty if only comments, order or layout differ.
#[must_use]
pub fn differences(then: &ModelText, now: &ModelText) -> Vec<String> {
    let mut found = Vec::new();
    let names =
        |text: &ModelText| -> Vec<String> { text.files.iter().map(|(path, _)| path.clone()).collect() };
    let pairs = then.files.len().max(now.files.len());
    for k in 0..pairs {
        let (Some((path, before)), Some((_, after))) = (then.files.get(k), now.files.get(k)) else {
            found.push(format!(
                "the files of the model have changed from {} to {}",
                names(then).join(", "),
                names(now).join(", ")
            ));
            break;
        };
        let (before, after) = (flat(before), flat(after));
        let keys: BTreeSet<&String> = before.keys().chain(after.keys()).collect();
        // The first file is the model itself; keys of others are told with their file.
        let file = if k == 0 { String::new() } else { format!("{path}: ") };
        for key in keys {
            match (before.get(key), after.get(key)) {
                (Some(a), Some(b)) if a != b => {
                    found.push(format!("{file}{key} has changed from `{a}` to `{b}`"))
                }
                (Some(a), None) => found.push(format!("{file}{key} (`{a}`) is gone")),
                (None, Some(b)) => found.push(format!("{file}{key} (`{b}`) has come")),
                _ => {}
            }
        }
    }
    for one in then.overrides.iter().filter(|one| !now.overrides.contains(one)) {
        found.push(format!("--set {one} is gone"));
    }
    for one in now.overrides.iter().filter(|one| !then.overrides.contains(one)) {
        found.push(format!("--set {one} has come"));
    }
    found
}

/// What of a model makes its flow: geometry, particles, fluid and the conditions on it, values by path, with those
/// given by `--set`; without what is said of species there.
#[must_use]
pub fn flow_makings(text: &ModelText) -> BTreeMap<String, String> {
    let mut values = text.files.first().map(|(_, model)| flat(model)).unwrap_or_default();
    for (path, value) in text.overrides.iter().filter_map(|one| one.split_once('=')) {
        let path = path.trim();
        values.retain(|key, _| key != path && !key.starts_with(&format!("{path}.")));
        values.insert(path.into(), value.trim().into());
    }
    let makes = |key: &String| {
        let mut parts = key.split('.');
        let section = parts.next().unwrap_or_default();
        match section {
            "domain" | "particles" | "groups" | "fluid" => !parts.any(|part| part == "holds"),
            "conditions" => !parts
                .any(|part| matches!(part, "species" | "held" | "source" | "barrier" | "flux" | "absorbing")),
            _ => false,
        }
    };
    values.retain(|key, _| makes(key));
    values
}

/// What differs between the makings of two flows, in words: as recorded, and as this model says.
#[must_use]
pub fn other_makings(then: &BTreeMap<String, String>, now: &BTreeMap<String, String>) -> Vec<String> {
    let keys: BTreeSet<&String> = then.keys().chain(now.keys()).collect();
    let words = |value: Option<&String>| value.map_or("nothing".into(), |value| format!("`{value}`"));
    keys.into_iter()
        .filter(|key| then.get(*key) != now.get(*key))
        .map(|key| format!("{key}: recorded with {}, here {}", words(then.get(key)), words(now.get(key))))
        .collect()
}

/// Scalars of a YAML text by their path.
fn flat(text: &str) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    match serde_yaml::from_str::<Value>(text) {
        Ok(value) => walk(&value, "", &mut out),
        Err(_) => {
            out.insert("the text".into(), String::new());
        }
    }
    out
}

fn walk(value: &Value, path: &str, out: &mut BTreeMap<String, String>) {
    let below = |key: &str| if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| walk(value, &below(key), out)),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(k, value)| walk(value, &below(&k.to_string()), out));
        }
        Value::String(text) => {
            out.insert(path.into(), text.clone());
        }
        other => {
            out.insert(path.into(), other.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(model: &str, overrides: &[&str]) -> ModelText {
        ModelText {
            hash: String::new(),
            files: vec![("m.yaml".into(), model.into())],
            overrides: overrides.iter().map(|s| s.to_string()).collect(),
        }
    }

    #[test]
    fn changes_are_named_and_layout_is_not_one() {
        let then = text("a: { b: 1 s, c: [1, 2] }\nd: x\n", &["a.b=3"]);
        let now = text("d: x # why\na:\n  b: 2 s\n  c: [1, 2, 3]\n", &[]);
        assert_eq!(
            differences(&then, &now),
            ["a.b has changed from `1 s` to `2 s`", "a.c.2 (`3`) has come", "--set a.b=3 is gone"]
        );
        assert!(differences(&then, &text("d: x\na: { c: [1, 2], b: 1 s }", &["a.b=3"])).is_empty());
    }
}
