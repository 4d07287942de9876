use super::*;
use crate::error::Source;
use crate::model::node::{Node, parse};
use crate::quantity::Dimension;
use std::sync::Arc;

fn tree(text: &str) -> Node {
    parse(&Arc::new(Source::new("m.yaml", text))).unwrap_or_else(|e| panic!("{e}"))
}

fn field(text: &str) -> Node {
    tree(text).field("a").cloned().unwrap_or_else(|| panic!("no a in {text}"))
}

#[test]
fn good_values_are_read() {
    let mut faults = Faults::new();
    assert_eq!(field("a: 5 µm").quantity(Dimension::LENGTH, &mut faults), Some(5e-6));
    assert_eq!(field("a: 2").quantity(Dimension::LENGTH, &mut faults), Some(2.0));
    assert_eq!(field("a: \"2\"").quantity(Dimension::LENGTH, &mut faults), Some(2.0));
    assert_eq!(field("a: 20 degC").positive(Dimension::TEMPERATURE, &mut faults), Some(293.15));
    assert_eq!(field("a: 0").non_negative(Dimension::DIFFUSIVITY, &mut faults), Some(0.0));
    assert_eq!(field("a: [0, 1 um]").vector(Dimension::LENGTH, 2, &mut faults), Some(vec![0.0, 1e-6]));
    assert_eq!(field("a: 1e4").count(&mut faults), Some(10_000));
    assert_eq!(field("a: -3").integer(&mut faults), Some(-3));
    assert_eq!(field("a: 3").positive_count(&mut faults), Some(3));
    assert_eq!(field("a: 2 %").number(&mut faults), Some(0.02));
    assert_eq!(field("a: true").boolean(&mut faults), Some(true));
    assert_eq!(field("a: x_1").name(&mut faults), Some("x_1"));
    assert_eq!(field("a: two").choice(&[("one", 1), ("two", 2)], &mut faults), Some(2));
    assert_eq!(field("a: one").choices(&[("one", 1), ("two", 2)], &mut faults), Some(vec![1]));
    assert_eq!(field("a: [two, one]").choices(&[("one", 1), ("two", 2)], &mut faults), Some(vec![2, 1]));
    assert!(faults.is_empty(), "{}", faults.into_error());
}

type Read = fn(&Node, &mut Faults) -> bool;

#[test]
fn bad_values_say_what_was_expected() {
    const WORDS: [(&str, i32); 2] = [("one", 1), ("two", 2)];
    let cases: [(&str, Read, u32, u32, &str); 19] = [
        (
            "a: 5 um",
            |n, f| n.quantity(Dimension::DIFFUSIVITY, f).is_none(),
            4,
            4,
            "expected a diffusivity (m^2/s), found a length (m): \"5 um\"",
        ),
        ("a: \"5 umm\"", |n, f| n.quantity(Dimension::LENGTH, f).is_none(), 7, 3, "unknown unit \"umm\""),
        ("a: .inf", |n, f| n.quantity(Dimension::LENGTH, f).is_none(), 4, 4, "an infinite number"),
        ("a: .nan", |n, f| n.number(f).is_none(), 4, 4, "not a number"),
        ("a: 3 m", |n, f| n.number(f).is_none(), 4, 3, "expected a pure number, found a length (m)"),
        ("a: 1_000", |n, f| n.count(f).is_none(), 4, 5, "expected a whole number, found the text \"1_000\""),
        ("a: 1.5", |n, f| n.integer(f).is_none(), 4, 3, "expected a whole number, found the number 1.5"),
        ("a: -1", |n, f| n.count(f).is_none(), 4, 2, "expected a number from zero, found -1"),
        ("a: 0", |n, f| n.positive_count(f).is_none(), 4, 1, "expected a number from one, found 0"),
        (
            "a: 0",
            |n, f| n.positive(Dimension::LENGTH, f).is_none(),
            4,
            1,
            "expected a positive length, found 0",
        ),
        (
            "a: -1 um",
            |n, f| n.non_negative(Dimension::LENGTH, f).is_none(),
            4,
            5,
            "length may not be negative",
        ),
        (
            "a: [1, 2, 3]",
            |n, f| n.vector(Dimension::LENGTH, 2, f).is_none(),
            4,
            1,
            "expected 2 components, found 3",
        ),
        (
            "a: [1, 2 s]",
            |n, f| n.vector(Dimension::LENGTH, 2, f).is_none(),
            8,
            3,
            "expected a length (m), found a time (s)",
        ),
        ("a: 1", |n, f| n.list(f).is_none(), 4, 1, "expected a list, found the number 1"),
        ("a: yes", |n, f| n.boolean(f).is_none(), 4, 3, "expected true or false, found the text \"yes\""),
        ("a: [x]", |n, f| n.text(f).is_none(), 4, 1, "expected a text, found a list of 1"),
        ("a: 2x", |n, f| n.name(f).is_none(), 4, 2, "\"2x\" is no name"),
        ("a: on", |n, f| n.choice(&WORDS, f).is_none(), 4, 2, "\"on\" is not one of one, two"),
        ("a: [one, too]", |n, f| n.choices(&WORDS, f).is_none(), 10, 3, "\"too\" is not one of"),
    ];
    for (text, read, column, width, reason) in cases {
        let mut faults = Faults::new();
        assert!(read(&field(text), &mut faults), "{text} is accepted");
        assert_eq!(faults.list.len(), 1);
        let fault = &faults.list[0];
        let place = fault.place.as_ref().unwrap();
        assert!(fault.reason.contains(reason), "{fault}");
        assert_eq!((place.line, place.column, place.width), (1, column, width), "{fault}");
    }
}

#[test]
fn fields_report_missing_unknown_and_repeated_keys() {
    let root = tree("a: 1\nkindd: x\nempty:\na: 2\n");
    let mut faults = Faults::new();
    let mut fields = Fields::of(&root, "domain", &mut faults).unwrap();
    assert!(fields.required("a", &mut faults).is_some());
    assert!(fields.required("kind", &mut faults).is_none());
    assert!(fields.required("empty", &mut faults).is_none());
    assert!(fields.optional("more").is_none());
    fields.finish(&mut faults);
    let error = faults.into_error();
    let found: Vec<String> = error
        .faults
        .iter()
        .map(|f| format!("{} {} | {}", f.place.as_ref().map_or(0, |p| p.line), f.reason, f.remedy))
        .collect();
    assert_eq!(
        found,
        [
            "1 domain: \"kind\" is missing | add \"kind: …\"",
            "2 domain: unknown key \"kindd\" | did you mean \"kind\"? known here: a, kind, empty, more",
            "3 domain: \"empty\" has no value | add \"empty: …\"",
            "4 \"a\" is given twice | the first is at m.yaml:1:1; remove or rename one",
        ]
    );
}
