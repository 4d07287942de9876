//! One value of the tree replaced before it is read: `--set path.to.key=value`, a point of a sweep.

use super::{Key, Node, Value, known_keys, parse_value};
use crate::error::{Fault, Place, Replaced, Source};
use crate::quantity::nearest;
use std::sync::Arc;

/// Puts the value of `path.to.key=value` into the tree; the value is YAML, a number in the path is the index
/// of a list (from zero). Missing keys are added, unless a known one is spelled nearly alike; readers refuse
/// those that mean nothing.
///
/// # Errors
/// Text without `=`, a value that is no YAML, a path that does not lead anywhere (naming the known keys).
pub fn set(root: &mut Node, assignment: &str) -> Result<(), Fault> {
    let shown = format!("--set {assignment}");
    let Some((path, value)) = assignment.split_once('=') else {
        return Err(Fault::general(
            format!("\"{shown}\" has no \"=\""),
            "write --set path.to.key=value, e.g. --set run.seed=7",
        ));
    };
    // The source is named after the option; its text is the value, so that columns count inside the value.
    let source = Arc::new(Source::new(shown, value));
    let mut node = parse_value(&source)?;
    if node.value == Value::Null {
        node.place = Place { source: source.clone(), line: 1, column: 1, width: 1 };
    }
    let path = path.trim();
    let steps: Vec<&str> = path.split('.').collect();
    if steps.iter().any(|step| step.is_empty()) {
        return Err(Fault::general(
            format!("\"{}\": the path \"{path}\" has an empty part", source.path),
            "write the keys separated by single points, e.g. run.seed",
        ));
    }
    let key_place = Place { source: source.clone(), line: 1, column: 1, width: 1 };
    place_at(root, &steps, 0, node, &key_place)
        .map_err(|(reason, remedy)| Fault::general(format!("\"{}\": {reason}", source.path), remedy))
}

/// Puts a node at `path.to.key`, as [`set`] does; keys that are added stand at `place`, and so does a fault.
///
/// # Errors
/// A path that does not lead anywhere (naming the known keys).
pub fn put(root: &mut Node, path: &str, node: Node, place: &Place) -> Result<(), Fault> {
    let steps: Vec<&str> = path.split('.').collect();
    place_at(root, &steps, 0, node, place).map_err(|(reason, remedy)| Fault::at(place, reason, remedy))
}

/// What the value that `path.to.key=value` replaces leaves behind in the text: its line, and where all that it is part of
/// begins; as far as the path leads in the text of `root`.
#[must_use]
pub fn trail(root: &Node, assignment: &str) -> Vec<Replaced> {
    let path = assignment.split_once('=').map_or(assignment, |(path, _)| path).trim();
    let by = format!("--set {assignment}");
    let (mut at, mut found) = (root, Vec::new());
    let own = |place: &Place| Arc::ptr_eq(&place.source, &root.place.source);
    let steps: Vec<&str> = path.split('.').collect();
    for (depth, step) in steps.iter().enumerate() {
        let (key, inner) = match &at.value {
            Value::Map(entries) => match entries.iter().find(|(key, _)| key.name == *step) {
                Some((key, inner)) => (Some(&key.place), inner),
                None => break,
            },
            Value::List(items) => match step.parse::<usize>().ok().and_then(|index| items.get(index)) {
                Some(inner) => (None, inner),
                None => break,
            },
            _ => break,
        };
        let last = depth + 1 == steps.len();
        for place in key.into_iter().chain([&inner.place]).filter(|place| own(place)) {
            let column = (!last).then_some(place.column);
            found.push(Replaced { line: place.line, column, by: by.clone() });
        }
        at = inner;
    }
    found
}

/// Reason and remedy of a path that leads nowhere.
type Nowhere = (String, String);

fn place_at(
    at: &mut Node,
    steps: &[&str],
    depth: usize,
    node: Node,
    key_place: &Place,
) -> Result<(), Nowhere> {
    let Some(step) = steps.get(depth) else {
        *at = node;
        return Ok(());
    };
    let before =
        if depth == 0 { "the top level".to_string() } else { format!("\"{}\"", steps[..depth].join(".")) };
    match &mut at.value {
        Value::Map(entries) => {
            if let Some((_, inner)) = entries.iter_mut().find(|(key, _)| key.name == *step) {
                return place_at(inner, steps, depth + 1, node, key_place);
            }
            if depth + 1 == steps.len() {
                entries.push((Key { name: (*step).to_string(), place: key_place.clone() }, node));
                return Ok(());
            }
            let known = || entries.iter().map(|(key, _)| key.name.as_str());
            if nearest(step, known()).is_some() {
                // More likely a slip than a section the document left out.
                return Err((format!("there is no \"{step}\" in {before}"), known_keys(step, known())));
            }
            let mut section = Node { place: key_place.clone(), value: Value::Map(Vec::new()) };
            place_at(&mut section, steps, depth + 1, node, key_place)?;
            entries.push((Key { name: (*step).to_string(), place: key_place.clone() }, section));
            Ok(())
        }
        Value::List(items) => {
            let length = items.len();
            match step.parse::<usize>().ok().and_then(|index| items.get_mut(index)) {
                Some(inner) => place_at(inner, steps, depth + 1, node, key_place),
                None => Err((
                    format!("{before} is a list of {length} without an entry {step}"),
                    "entries are numbered from 0".to_string(),
                )),
            }
        }
        // A key that is written but left empty takes a mapping.
        Value::Null if depth + 1 == steps.len() => {
            at.value = Value::Map(vec![(Key { name: (*step).to_string(), place: key_place.clone() }, node)]);
            Ok(())
        }
        _ => {
            let found = at.describe();
            Err((format!("{before} is {found} and has no \"{step}\""), String::new()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    fn tree(text: &str) -> Node {
        parse(&Arc::new(Source::new("m.yaml", text))).unwrap()
    }

    #[test]
    fn values_are_replaced_and_added() {
        let mut root = tree("run: { seed: 1, until: 2 s }\nlist: [1, 2]\n");
        set(&mut root, "run.seed=7").unwrap();
        set(&mut root, "run.threads=2").unwrap();
        set(&mut root, "list.1=5 um").unwrap();
        set(&mut root, "run.until={ a: [1] }").unwrap();
        let run = root.field("run").unwrap();
        assert_eq!(run.field("seed").unwrap().value, Value::Integer(7));
        assert_eq!(run.field("seed").unwrap().place.source.path, "--set run.seed=7");
        assert_eq!(run.field("threads").unwrap().value, Value::Integer(2));
        assert!(run.field("until").unwrap().field("a").is_some());
        let Value::List(items) = &root.field("list").unwrap().value else { panic!("a list") };
        assert_eq!(items[1].value, Value::Text("5 um".into()));
    }

    #[test]
    fn faults_tell_what_was_set_where_they_show_the_text() {
        let mut root = tree("a: 1\nrun: { seed: 1, until: 2 s }\nb: 2\n");
        root.place.source.replace(trail(&root, "run.until=5 s"));
        set(&mut root, "run.until=5 s").unwrap();
        let told = |place: &Place| Fault::at(place, "wrong", "").to_string();
        let run = root.field("run").unwrap();
        for place in [&run.place, &run.field("seed").unwrap().place] {
            assert!(told(place).contains("= with --set run.until=5 s"), "{}", told(place));
        }
        assert!(!told(&root.field("b").unwrap().place).contains("with"));
        let until = told(&run.field("until").unwrap().place);
        assert!(until.contains("--set run.until=5 s:1:1  wrong") && !until.contains("with"), "{until}");
        assert_eq!(root.key_of(&run.field("until").unwrap().place), Some("until"));
    }

    #[test]
    fn bad_paths_name_the_known_keys() {
        let mut root = tree("run: { seed: 1 }\nlist: [1, 2]\n");
        let fault = set(&mut root, "rum.seed=7").unwrap_err();
        assert!(fault.reason.contains("no \"rum\" in the top level"), "{}", fault.reason);
        assert!(fault.remedy.contains("did you mean \"run\"? known here: run, list"), "{}", fault.remedy);
        assert!(set(&mut root, "list.2=1").unwrap_err().reason.contains("list of 2"));
        assert!(set(&mut root, "run.seed.x=1").unwrap_err().reason.contains("has no \"x\""));
        assert!(set(&mut root, "run.seed").unwrap_err().reason.contains("no \"=\""));
        assert!(set(&mut root, "run..seed=1").unwrap_err().reason.contains("empty part"));
        assert!(set(&mut root, "run.seed=[1").is_err());
    }
}
