//! YAML as a tree in which every value and key knows its place.
//!
//! Keys keep their order and may repeat; [`parse`] reports each repeated key with both places.

mod assign;
mod span;

pub use assign::{put, set, trail};

use crate::error::{Fault, ModelError, Place, Source};
use crate::quantity::did_you_mean;
use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_yaml::options::{DuplicateKeyPolicy, NonFiniteFloatPolicy};
use serde_yaml::{Options, Spanned};
use std::fmt;
use std::sync::Arc;

/// A value and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub place: Place,
    pub value: Value,
}

/// What a node holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Null,
    Bool(bool),
    Integer(i64),
    Real(f64),
    Text(String),
    List(Vec<Node>),
    Map(Vec<(Key, Node)>),
}

/// A key of a mapping and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub name: String,
    pub place: Place,
}

impl Node {
    /// The value under a key; `None` where there is no such key or this is no mapping.
    #[must_use]
    pub fn field(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Map(entries) => entries.iter().find(|(k, _)| k.name == key).map(|(_, node)| node),
            _ => None,
        }
    }

    /// The key under which the value at a place stands, or the list that holds it.
    #[must_use]
    pub fn key_of(&self, place: &Place) -> Option<&str> {
        fn search<'a>(node: &'a Node, place: &Place, key: Option<&'a str>) -> Option<&'a str> {
            match &node.value {
                Value::Map(entries) => {
                    entries.iter().find_map(|(inner, node)| search(node, place, Some(&inner.name)))
                }
                Value::List(items) => items.iter().find_map(|node| search(node, place, key)),
                _ => key.filter(|_| node.place.is_same(place)),
            }
        }
        search(self, place, None)
    }

    /// What it is, in words, for messages: `the text "x"`, `a list of 3`, `nothing`.
    #[must_use]
    pub fn describe(&self) -> String {
        match &self.value {
            Value::Null => "nothing".to_string(),
            Value::Bool(value) => format!("{value}"),
            Value::Integer(value) => format!("the number {value}"),
            Value::Real(value) if value.is_nan() => "not a number (.nan)".to_string(),
            Value::Real(value) if value.is_infinite() => "an infinite number".to_string(),
            Value::Real(value) => format!("the number {value}"),
            Value::Text(text) if text.chars().count() > 40 => {
                format!("the text \"{}…\"", text.chars().take(40).collect::<String>())
            }
            Value::Text(text) => format!("the text \"{text}\""),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Map(_) => "a mapping".to_string(),
        }
    }
}

/// Levels of lists and mappings that are followed; model files need about ten.
const DEEPEST: usize = 64;

/// Reads a YAML document. Repeated keys stay in the tree and are reported with everything else when the
/// mapping is read ([`crate::model::reader::Fields`]).
///
/// # Errors
/// Text that is no YAML, is empty, nests or repeats itself beyond reason.
pub fn parse(source: &Arc<Source>) -> Result<Node, ModelError> {
    let root = parse_value(source)?;
    if root.value == Value::Null {
        let reason = "the file is empty";
        return Err(Fault::at(&root.place, reason, "write the model as \"key: value\" lines").into());
    }
    Ok(root)
}

/// Reads a YAML document that may be empty ([`Value::Null`]).
fn parse_value(source: &Arc<Source>) -> Result<Node, Fault> {
    let text = &source.text;
    let options = serde_yaml::options! {
        duplicate_keys: DuplicateKeyPolicy::PassThrough,
        non_finite_float_policy: NonFiniteFloatPolicy::PassThrough,
        // `N`, `no`, `y` are names of species here, not booleans.
        strict_booleans: true,
        with_snippet: false,
        budget: serde_yaml::budget! { max_depth: DEEPEST },
    };
    match read(text, options) {
        Ok(Some(raw)) => Ok(span::place(raw, source)),
        Ok(None) => Ok(Node { place: span::start(source), value: Value::Null }),
        Err(error) => Err(tab_fault(source).unwrap_or_else(|| syntax_fault(source, &error))),
    }
}

fn read(text: &str, options: Options) -> Result<Option<Spanned<Raw>>, serde_yaml::Error> {
    let blank = text.trim_start_matches('\u{feff}').lines().all(|line| {
        let line = line.trim();
        line.is_empty() || line.starts_with('#') || line == "---"
    });
    if blank { Ok(None) } else { serde_yaml::from_str_with_options(text, options).map(Some) }
}

/// The first tab in the indentation of a text that is no YAML: the likely reason, and hard to see.
fn tab_fault(source: &Arc<Source>) -> Option<Fault> {
    for (number, line) in source.text.lines().enumerate() {
        let indent: usize = line.chars().take_while(|c| c.is_whitespace()).count();
        if let Some(column) = line.chars().take(indent).position(|c| c == '\t')
            && line.chars().nth(indent).is_some_and(|c| c != '#')
        {
            let place = Place {
                source: source.clone(),
                line: number as u32 + 1,
                column: column as u32 + 1,
                width: 1,
            };
            return Some(Fault::at(&place, "a tab in the indentation", "YAML is indented by spaces only"));
        }
    }
    None
}

/// The parser's complaint as a fault in plain words.
fn syntax_fault(source: &Arc<Source>, error: &serde_yaml::Error) -> Fault {
    let place = error
        .location()
        .map_or_else(|| span::start(source), |at| span::point(source, at.line() as u32, at.column() as u32));
    let message = error.without_snippet().to_string();
    let message = message.lines().next().unwrap_or("this is not YAML");
    // The parser repeats the place, which the fault shows already.
    let message = message.split(" at line ").next().unwrap_or(message).trim();
    let lower = message.to_lowercase();
    let has = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    if has(&["multiple yaml documents"]) {
        let reason = "a second YAML document starts here";
        return Fault::at(
            &place,
            reason,
            "one file holds one model: remove the line \"---\" and what follows",
        );
    }
    let remedy = if has(&["unknown anchor"]) {
        "\"*\" starts an alias in YAML: put the text in quotes"
    } else if has(&["budget", "depth", "alias", "recursion"]) {
        "the file nests or repeats itself too much; write it flatter"
    } else if has(&["mapping values", "simple key"]) {
        "a text with \": \" in it needs quotes, and every key of a mapping the same indentation"
    } else if has(&["bracket", "flow", "placement of ':'", "expected ','"]) {
        "look for a missing comma, brace or bracket here or on the line before"
    } else if has(&["quote"]) {
        "look for a quote that is not closed"
    } else if has(&["document start", "directive", "%"]) {
        "a text that starts with \"%\" needs quotes"
    } else {
        "look at the indentation, quotes and brackets here and on the line before"
    };
    Fault::at(&place, format!("this is not valid YAML: {message}"), remedy)
}

/// One fault for each key of a mapping that repeats an earlier one, with both places.
pub(crate) fn repeated_keys(entries: &[(Key, Node)]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (k, (key, _)) in entries.iter().enumerate() {
        if let Some((first, _)) = entries[..k].iter().find(|(other, _)| other.name == key.name) {
            let at = &first.place;
            faults.push(Fault::at(
                &key.place,
                format!("\"{}\" is given twice", key.name),
                format!("the first is at {}:{}:{}; remove or rename one", at.source.path, at.line, at.column),
            ));
        }
    }
    faults
}

/// The tree as the deserializer gives it, places not yet resolved.
enum Raw {
    Null,
    Bool(bool),
    Integer(i64),
    Real(f64),
    Text(String),
    List(Vec<Spanned<Raw>>),
    Map(Vec<(Spanned<Raw>, Spanned<Raw>)>),
}

impl<'de> Deserialize<'de> for Raw {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Raw, D::Error> {
        deserializer.deserialize_any(RawVisitor)
    }
}

struct RawVisitor;

impl<'de> Visitor<'de> for RawVisitor {
    type Value = Raw;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E>(self) -> Result<Raw, E> {
        Ok(Raw::Null)
    }

    fn visit_none<E>(self) -> Result<Raw, E> {
        Ok(Raw::Null)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Raw, D::Error> {
        Raw::deserialize(deserializer)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Raw, E> {
        Ok(Raw::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Raw, E> {
        Ok(Raw::Integer(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Raw, E> {
        Ok(i64::try_from(value).map_or(Raw::Real(value as f64), Raw::Integer))
    }

    fn visit_i128<E>(self, value: i128) -> Result<Raw, E> {
        Ok(Raw::Real(value as f64))
    }

    fn visit_u128<E>(self, value: u128) -> Result<Raw, E> {
        Ok(Raw::Real(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Raw, E> {
        Ok(Raw::Real(value))
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<Raw, E> {
        Ok(Raw::Text(value.to_string()))
    }

    fn visit_string<E>(self, value: String) -> Result<Raw, E> {
        Ok(Raw::Text(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Raw, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element()? {
            list.push(item);
        }
        Ok(Raw::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Raw, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Raw::Map(entries))
    }
}

/// A remedy naming the known keys, nearest first.
pub(crate) fn known_keys<'a>(word: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    let near = did_you_mean(word, known.clone());
    let mut all: Vec<&str> = known.collect();
    all.dedup();
    let list = if all.is_empty() { String::new() } else { format!("known here: {}", all.join(", ")) };
    [near, list].iter().filter(|s| !s.is_empty()).cloned().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Arc<Source> {
        Arc::new(Source::new("m.yaml", text))
    }

    fn at(node: &Node) -> (u32, u32, u32) {
        (node.place.line, node.place.column, node.place.width)
    }

    #[test]
    fn scalars_keep_their_kind_text_and_place() {
        let text = "a: 5 um\nb: \"x y\"\nc: 'z'\nd: 3\ne: 1.5e-3\nf: true\ng:\nh: [1, 2 µm]\n1: N\ni: .nan\nj: -.inf\nk: no\nl: 1_000\nm: 0\nn: ~\no: 007x\n";
        let root = parse(&source(text)).unwrap();
        let get = |key: &str| root.field(key).unwrap();
        assert_eq!((&get("a").value, at(get("a"))), (&Value::Text("5 um".into()), (1, 4, 4)));
        assert_eq!((&get("b").value, at(get("b"))), (&Value::Text("x y".into()), (2, 5, 3)));
        assert_eq!((&get("c").value, at(get("c"))), (&Value::Text("z".into()), (3, 5, 1)));
        assert_eq!((&get("d").value, at(get("d"))), (&Value::Integer(3), (4, 4, 1)));
        assert_eq!((&get("e").value, at(get("e"))), (&Value::Real(1.5e-3), (5, 4, 6)));
        assert_eq!(get("f").value, Value::Bool(true));
        assert_eq!(get("g").value, Value::Null);
        let Value::List(items) = &get("h").value else { panic!("a list") };
        assert_eq!((&items[1].value, at(&items[1])), (&Value::Text("2 µm".into()), (8, 8, 4)));
        assert_eq!(get("1").value, Value::Text("N".into()));
        assert!(matches!(get("i").value, Value::Real(v) if v.is_nan()));
        assert_eq!(get("j").value, Value::Real(f64::NEG_INFINITY));
        assert_eq!(get("k").value, Value::Text("no".into()));
        assert_eq!(get("l").value, Value::Text("1_000".into()));
        assert_eq!(get("m").value, Value::Integer(0));
        assert_eq!(get("n").value, Value::Null);
        assert_eq!(get("o").value, Value::Text("007x".into()));
    }

    #[test]
    fn broken_yaml_says_where() {
        for (text, line) in [
            ("a: [1, 2\nb: 3\n", 2),
            ("a: \"open\nb: 1\n", 1),
            ("a: b: c\n", 1),
            ("a:\n  b: 1\n c: 2\n", 3),
            ("a:\n\tb: 1\n", 2),
            ("a: {b: 1\n", 1),
            ("a: *nowhere\n", 1),
            ("%%%\n", 1),
            ("a: 1\n---\nb: 2\n", 2),
        ] {
            let error = parse(&source(text)).unwrap_err();
            let fault = &error.faults[0];
            let place = fault.place.as_ref().unwrap();
            assert!((i64::from(place.line) - line).abs() <= 1, "{text:?}: {fault}");
            assert!(!fault.remedy.is_empty(), "{fault}");
        }
        assert!(parse(&source("a:\n\tb: 1\n")).unwrap_err().faults[0].reason.contains("tab"));
        assert!(parse(&source("a: |\n  x\n  \ty\n")).is_ok(), "a tab inside a block text is no fault");
    }

    #[test]
    fn empty_and_excessive_files_are_faults() {
        for text in ["", "\n\n", "# only a comment\n", "---\n", "~\n"] {
            assert!(parse(&source(text)).unwrap_err().faults[0].reason.contains("empty"), "{text:?}");
        }
        let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
        assert!(parse(&source(&deep)).unwrap_err().faults[0].remedy.contains("flatter"));
        let mut bomb = String::from("a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n");
        for k in 1..12 {
            let list = vec![format!("*a{}", k - 1); 10].join(", ");
            bomb.push_str(&format!("a{k}: &a{k} [{list}]\n"));
        }
        assert!(parse(&source(&bomb)).is_err());
    }
}
