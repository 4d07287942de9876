//! Readers of single values: each says what it expected and what it found.

use super::{Faults, did_you_mean};
use crate::error::Fault;
use crate::model::node::{Node, Value};
use crate::quantity::{Dimension, Quantity, number_length};

impl Node {
    fn expected(&self, what: &str, remedy: &str, faults: &mut Faults) {
        faults.at(&self.place, format!("expected {what}, found {}", self.describe()), remedy);
    }

    /// A text.
    pub fn text(&self, faults: &mut Faults) -> Option<&str> {
        if let Value::Text(text) = &self.value {
            return Some(text);
        }
        self.expected("a text", "put it in quotes if a text is meant", faults);
        None
    }

    /// An identifier: a letter or `_`, then letters, digits or `_`.
    pub fn name(&self, faults: &mut Faults) -> Option<&str> {
        if let Value::Text(text) = &self.value {
            if is_name(text) {
                return Some(text);
            }
            faults.at(&self.place, format!("\"{text}\" is no name"), NAME_REMEDY);
            return None;
        }
        self.expected("a name", NAME_REMEDY, faults);
        None
    }

    /// `true` or `false`.
    pub fn boolean(&self, faults: &mut Faults) -> Option<bool> {
        if let Value::Bool(value) = self.value {
            return Some(value);
        }
        self.expected("true or false", "write true or false without quotes", faults);
        None
    }

    /// A whole number. `1e4` and `10000.0` count as whole.
    pub fn integer(&self, faults: &mut Faults) -> Option<i64> {
        match self.value {
            Value::Integer(value) => return Some(value),
            // 2^53: up to here every whole f64 is exact.
            Value::Real(value) if value.fract() == 0.0 && value.abs() <= 9_007_199_254_740_992.0 => {
                return Some(value as i64);
            }
            _ => {}
        }
        self.expected("a whole number", self.number_remedy(), faults);
        None
    }

    /// A whole number from zero.
    pub fn count(&self, faults: &mut Faults) -> Option<u64> {
        let value = self.integer(faults)?;
        u64::try_from(value).map_or_else(
            |_| {
                faults.at(
                    &self.place,
                    format!("expected a number from zero, found {value}"),
                    "write 0 or more",
                );
                None
            },
            Some,
        )
    }

    /// A whole number from one.
    pub fn positive_count(&self, faults: &mut Faults) -> Option<u64> {
        let value = self.integer(faults)?;
        if value > 0 {
            return Some(value as u64);
        }
        faults.at(&self.place, format!("expected a number from one, found {value}"), "write 1 or more");
        None
    }

    /// A finite number without unit.
    pub fn number(&self, faults: &mut Faults) -> Option<f64> {
        self.quantity(Dimension::NONE, faults)
    }

    /// A number in SI or a text with a unit of this dimension, finite; the value in SI.
    pub fn quantity(&self, dimension: Dimension, faults: &mut Faults) -> Option<f64> {
        let begins = |text: &str| {
            let text: Vec<char> = text.trim_start().chars().collect();
            number_length(&text) > 0
        };
        if let Value::Text(text) = &self.value
            && !begins(text)
        {
            let (what, remedy) = if dimension.is_none() {
                ("a number".to_string(), "write a number without a unit, e.g. 0.5".to_string())
            } else {
                let example = format!("write the number first, then the unit, e.g. 5 {}", dimension.unit());
                ("a number with a unit".to_string(), example)
            };
            faults.at(&self.place, format!("expected {what}, found \"{}\"", text.trim()), remedy);
            return None;
        }
        let quantity = self.any_quantity(faults)?;
        let bare = matches!(self.value, Value::Integer(_) | Value::Real(_));
        // A text may also be a bare number, as in quotes; it is SI like any other.
        if bare || quantity.dimension == dimension || self.is_bare_text() {
            return Some(quantity.value);
        }
        let remedy = if dimension.is_none() {
            "leave the unit out".to_string()
        } else {
            format!("give it in a unit of {}, e.g. \"{} {}\"", dimension, 1, dimension.unit())
        };
        faults.at(
            &self.place,
            format!(
                "expected {}, found {}: \"{}\"",
                article(dimension),
                article(quantity.dimension),
                self.plain()
            ),
            remedy,
        );
        None
    }

    /// A finite number or a text with any unit; a bare number has no dimension.
    pub fn any_quantity(&self, faults: &mut Faults) -> Option<Quantity> {
        match &self.value {
            Value::Integer(value) => Some(Quantity::bare(*value as f64)),
            Value::Real(value) if value.is_finite() => Some(Quantity::bare(*value)),
            Value::Text(text) => match Quantity::parse(text) {
                Ok(quantity) => Some(quantity),
                Err(fault) => {
                    let place = self.place.inside(fault.offset, fault.width);
                    faults.push(Fault::at(&place, fault.reason, fault.remedy));
                    None
                }
            },
            _ => {
                let remedy = "write a number, and its unit behind it where it has one";
                self.expected("a finite number or a quantity such as \"5 um\"", remedy, faults);
                None
            }
        }
    }

    /// A quantity greater than zero.
    pub fn positive(&self, dimension: Dimension, faults: &mut Faults) -> Option<f64> {
        let value = self.quantity(dimension, faults)?;
        if value > 0.0 {
            return Some(value);
        }
        faults.at(
            &self.place,
            format!("expected a positive {}, found {}", bare_name(dimension), self.plain()),
            "give a value greater than zero",
        );
        None
    }

    /// A quantity of at least zero.
    pub fn non_negative(&self, dimension: Dimension, faults: &mut Faults) -> Option<f64> {
        let value = self.quantity(dimension, faults)?;
        if value >= 0.0 {
            return Some(value);
        }
        faults.at(
            &self.place,
            format!("{} may not be negative, found {}", bare_name(dimension), self.plain()),
            "give a value of zero or more",
        );
        None
    }

    /// A list of `length` quantities.
    pub fn vector(&self, dimension: Dimension, length: usize, faults: &mut Faults) -> Option<Vec<f64>> {
        let items = self.list(faults)?;
        if items.len() != length {
            let found = items.len();
            faults.at(
                &self.place,
                format!("expected {length} components, found {found}"),
                "one for each dimension, e.g. [0, 5 um]",
            );
            return None;
        }
        let values: Vec<Option<f64>> = items.iter().map(|item| item.quantity(dimension, faults)).collect();
        values.into_iter().collect()
    }

    /// A list.
    pub fn list(&self, faults: &mut Faults) -> Option<&[Node]> {
        if let Value::List(items) = &self.value {
            return Some(items);
        }
        self.expected("a list", "write [ …, … ]", faults);
        None
    }

    /// One of the given words.
    pub fn choice<T: Clone>(&self, choices: &[(&str, T)], faults: &mut Faults) -> Option<T> {
        let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
        let found = match &self.value {
            Value::Text(text) => text.clone(),
            Value::Bool(value) => value.to_string(),
            _ => {
                self.expected(&format!("one of {}", words.join(", ")), "write one of these words", faults);
                return None;
            }
        };
        if let Some((_, value)) = choices.iter().find(|(word, _)| *word == found) {
            return Some(value.clone());
        }
        let near = did_you_mean(&found, words.iter().copied());
        faults.at(
            &self.place,
            format!("\"{found}\" is not one of {}", words.join(", ")),
            if near.is_empty() { format!("write {}", words.join(" or ")) } else { near },
        );
        None
    }

    /// A list of the given words, or one of them alone.
    pub fn choices<T: Clone>(&self, choices: &[(&str, T)], faults: &mut Faults) -> Option<Vec<T>> {
        match &self.value {
            Value::List(items) => {
                let all: Vec<Option<T>> = items.iter().map(|item| item.choice(choices, faults)).collect();
                all.into_iter().collect()
            }
            _ => self.choice(choices, faults).map(|one| vec![one]),
        }
    }

    /// The scalar as it would be written.
    #[must_use]
    pub fn plain(&self) -> String {
        match &self.value {
            Value::Text(text) => text.clone(),
            Value::Integer(value) => value.to_string(),
            Value::Real(value) => format!("{value:?}"),
            _ => self.describe(),
        }
    }

    fn is_bare_text(&self) -> bool {
        matches!(&self.value, Value::Text(text) if text.trim().parse::<f64>().is_ok_and(f64::is_finite))
    }

    fn number_remedy(&self) -> &'static str {
        match &self.value {
            Value::Text(text) if text.contains(['_', ',']) => "digits are written without separators",
            Value::Text(_) => "without quotes and without a unit",
            _ => "write digits only, e.g. 100",
        }
    }
}

const NAME_REMEDY: &str = "a name starts with a letter or \"_\" and goes on with letters, digits or \"_\"";

/// Whether a text is an identifier.
#[must_use]
pub(crate) fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}

fn article(dimension: Dimension) -> String {
    match dimension.name() {
        Some(name) if name.starts_with(['a', 'e', 'i', 'o', 'u']) => format!("an {dimension}"),
        Some(_) => format!("a {dimension}"),
        None => dimension.to_string(),
    }
}

fn bare_name(dimension: Dimension) -> String {
    dimension.name().map_or_else(
        || if dimension.is_none() { "number".to_string() } else { dimension.unit() },
        str::to_string,
    )
}
