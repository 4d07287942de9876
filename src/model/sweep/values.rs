//! Values of a swept parameter: a list, `linspace` and `logspace`, or the ranges `uniform` and `loguniform`.

use super::written::{Written, digits, written};
use crate::error::Place;
use crate::model::node::{Node, Value};
use crate::model::reader::{Faults, did_you_mean};
use crate::quantity::{Dimension, Quantity};

/// Most values of a parameter, and most points of a sweep.
pub(super) const MOST: usize = 10_000;

const FUNCTIONS: [&str; 4] = ["linspace", "logspace", "uniform", "loguniform"];

/// A value as it is put into the model, and in SI.
#[derive(Clone, Debug)]
pub(super) struct Valued {
    pub node: Node,
    pub si: f64,
}

/// What a parameter takes.
pub(super) enum Taken {
    /// One value after the other.
    Each(Vec<Valued>),
    /// Anything in a range.
    Range(Range),
}

/// What was read of a parameter.
pub(super) struct Values {
    pub taken: Taken,
    /// Unit of the first value as written, and what a value in SI times this reads in it.
    pub unit: String,
    pub per_si: f64,
    pub logarithmic: bool,
}

/// What the values are of.
pub(super) struct Kind {
    /// Bare whole numbers at both ends give whole numbers between them.
    pub molecules: bool,
    /// Dimension of the parameter as the reactions give it.
    pub dimension: Option<Dimension>,
}

impl Kind {
    /// Whether a value is of the same dimension as the parameter; a bare number is.
    fn fits(&self, found: Dimension, place: &Place, faults: &mut Faults) -> bool {
        let Some(expected) = self.dimension.filter(|d| !found.is_none() && *d != found) else { return true };
        let reason = format!("expected {expected} as in the reactions, found {found}");
        faults.at(place, reason, format!("give it in a unit like {}", expected.unit()));
        false
    }
}

/// Two ends in one unit.
pub(super) struct Range {
    low: f64,
    high: f64,
    unit: String,
    logarithmic: bool,
    /// Whole numbers are wanted: molecules.
    whole: bool,
    place: Place,
}

/// Reads the values of a parameter.
pub(super) fn read(node: &Node, kind: &Kind, faults: &mut Faults) -> Option<Values> {
    if let Value::Text(text) = &node.value
        && text.contains('(')
        && text.trim_start().starts_with(char::is_alphabetic)
    {
        return called(text, node, kind, faults);
    }
    let items = match &node.value {
        Value::List(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    if items.is_empty() {
        faults.at(&node.place, "an empty list of values", "give at least one value");
        return None;
    }
    if items.len() > MOST {
        too_many(&node.place, items.len() as f64, faults);
        return None;
    }
    let mut values = Vec::new();
    for item in items {
        let Some(quantity) = item.any_quantity(faults) else { continue };
        if kind.fits(quantity.dimension, &item.place, faults) {
            values.push(Valued { node: item.clone(), si: quantity.value });
        }
    }
    if values.len() < items.len() {
        return None;
    }
    let first = match &items[0].value {
        Value::Text(text) => written(text, 0, &items[0].place).ok()?,
        _ => Written::bare(values[0].si),
    };
    let (unit, per_si) = first.shown();
    let (low, high) =
        values.iter().fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), v| (a.min(v.si), b.max(v.si)));
    // Values over decades are looked at decade by decade.
    let logarithmic = low > 0.0 && high >= 50.0 * low;
    Some(Values { taken: Taken::Each(values), unit, per_si, logarithmic })
}

pub(super) fn too_many(place: &Place, found: f64, faults: &mut Faults) {
    faults.at(place, format!("{found} points are too many"), format!("a sweep has at most {MOST}"));
}

/// `linspace(a, b, n)` and the like.
fn called(text: &str, node: &Node, kind: &Kind, faults: &mut Faults) -> Option<Values> {
    let usage =
        "write linspace(a, b, n) or logspace(a, b, n); for a hypercube uniform(a, b) or loguniform(a, b)";
    let (name, rest) = text.split_once('(')?;
    let name = name.trim();
    let start = text.len() - text.trim_start().len();
    if !FUNCTIONS.contains(&name) {
        let near = did_you_mean(name, FUNCTIONS);
        let place = node.place.inside(start, name.chars().count());
        faults.at(&place, format!("\"{name}\" makes no values"), if near.is_empty() { usage } else { &near });
        return None;
    }
    let Some(inside) = rest.trim_end().strip_suffix(')') else {
        faults.at(&node.place, format!("\"{}\" is not closed", text.trim()), "close it with \")\"");
        return None;
    };
    let spaced = name.ends_with("space");
    let parts: Vec<&str> = inside.split(',').collect();
    if parts.len() != if spaced { 3 } else { 2 } {
        let found = parts.len();
        let expected = if spaced { "both ends and a number of values" } else { "both ends" };
        faults.at(&node.place, format!("{name} takes {expected}, found {found} parts"), usage);
        return None;
    }
    let mut at = text.chars().count() - rest.chars().count();
    let mut ends = Vec::new();
    for part in &parts[..2] {
        match written(part, at, &node.place) {
            Ok(end) => {
                let start = at + blanks(part);
                let place = node.place.inside(start, part.trim().chars().count());
                if kind.fits(end.quantity.dimension, &place, faults) {
                    ends.push(end);
                }
            }
            Err(fault) => faults.push(fault),
        }
        at += part.chars().count() + 1;
    }
    let count = if spaced { Some(count(parts[2], at, node, faults)?) } else { None };
    let [low, high] = <[Written; 2]>::try_from(ends).ok()?;
    let logarithmic = name.starts_with("log");
    let (unit, per_si) = if low.is_zero() { high.shown() } else { low.shown() };
    let range = range(low, high, kind.molecules, name, node, faults)?;
    let taken = match count {
        None => Taken::Range(range),
        Some(n) => Taken::Each((0..n).map(|k| range.at(k as f64 / (n - 1) as f64)).collect::<Option<_>>()?),
    };
    Some(Values { taken, unit, per_si, logarithmic })
}

/// The number of values of `linspace` and `logspace`.
fn count(part: &str, at: usize, node: &Node, faults: &mut Faults) -> Option<usize> {
    let place = node.place.inside(at + blanks(part), part.trim().chars().count());
    match part.trim().parse::<usize>() {
        Ok(n) if (2..=MOST).contains(&n) => Some(n),
        Ok(n) if n > MOST => {
            too_many(&place, n as f64, faults);
            None
        }
        _ => {
            let reason = format!("expected a number of values from two, found \"{}\"", part.trim());
            faults.at(&place, reason, "e.g. linspace(1 um, 5 um, 9): nine values, both ends among them");
            None
        }
    }
}

fn range(
    low: Written,
    high: Written,
    molecules: bool,
    name: &str,
    node: &Node,
    faults: &mut Faults,
) -> Option<Range> {
    let logarithmic = name.starts_with("log");
    let mut wrong = |reason: String, remedy: &str| {
        faults.at(&node.place, reason, remedy);
        None
    };
    let (a, b) = (low.quantity.dimension, high.quantity.dimension);
    let whole = molecules && low.whole && high.whole;
    // The ends in one unit, as numbers in front of it: round numbers stay round.
    let (unit, low, high) = if low.unit == high.unit {
        (low.unit, low.number, high.number)
    } else if low.is_zero() {
        (high.unit, 0.0, high.number)
    } else if high.is_zero() {
        (low.unit, low.number, 0.0)
    } else if a != b {
        return wrong(format!("{name} from {a} to {b}"), "both ends have the same dimension");
    } else if low.factor().is_some() && high.factor().is_some() {
        let factor = low.factor().unwrap_or(1.0);
        (low.unit, low.number, high.quantity.value / factor)
    } else {
        return wrong(format!("{name} between units with different zeros"), "give both ends in kelvin");
    };
    if logarithmic && !(low > 0.0 && high > 0.0) {
        return wrong(
            format!("{name} has ends of {low} and {high}"),
            "on a logarithmic scale both are positive",
        );
    }
    if low == high || (low > high && !name.ends_with("space")) {
        return wrong(format!("{name} from {low} to {high} is no range"), "write the lower end first");
    }
    Some(Range { low, high, unit, logarithmic, whole, place: node.place.clone() })
}

impl Range {
    /// The value a part of the way from one end to the other.
    pub(super) fn at(&self, part: f64) -> Option<Valued> {
        let number = match part {
            0.0 => self.low,
            1.0 => self.high,
            _ if self.logarithmic => (self.low.ln() + part * (self.high.ln() - self.low.ln())).exp(),
            _ => self.low + part * (self.high - self.low),
        };
        // Fifteen digits: what is round stays so, 0.3 and not 0.30000000000000004.
        let number: f64 = format!("{number:.14e}").parse().ok()?;
        let number = if self.whole { number.round() } else { number };
        let value = match (self.unit.is_empty(), self.whole) {
            (true, true) => Value::Integer(number as i64),
            (true, false) => Value::Real(number),
            (false, _) => Value::Text(format!("{} {}", digits(number), self.unit)),
        };
        let si = match &value {
            Value::Text(text) => Quantity::parse(text).ok()?.value,
            _ => number,
        };
        Some(Valued { node: Node { place: self.place.clone(), value }, si })
    }
}

fn blanks(text: &str) -> usize {
    text.chars().take_while(|c| c.is_whitespace()).count()
}
