//! Numbers with their units as they are written.

use crate::error::{Fault, Place};
use crate::quantity::{Dimension, Quantity, number_length};

/// A number with a unit as written.
#[derive(Clone, Debug)]
pub(super) struct Written {
    pub number: f64,
    pub unit: String,
    pub quantity: Quantity,
    /// Digits alone.
    pub whole: bool,
}

/// A number as text, with a power of ten where it is far from one.
pub(super) fn digits(number: f64) -> String {
    let usual = number == 0.0 || (1e-3..1e6).contains(&number.abs());
    if usual { format!("{number}") } else { format!("{number:e}") }
}

/// A number with its unit, at `offset` in a text at a place.
pub(super) fn written(text: &str, offset: usize, place: &Place) -> Result<Written, Fault> {
    let quantity = Quantity::parse(text).map_err(|fault| {
        Fault::at(&place.inside(offset + fault.offset, fault.width), fault.reason, fault.remedy)
    })?;
    let characters: Vec<char> = text.trim().chars().collect();
    let length = number_length(&characters);
    let number: String = characters[..length].iter().collect();
    let unit: String = characters[length..].iter().collect();
    Ok(Written {
        number: number.replace('\u{2212}', "-").parse().unwrap_or(quantity.value),
        unit: unit.trim().to_string(),
        quantity,
        whole: number.chars().all(|c| c.is_ascii_digit()) && unit.is_empty(),
    })
}

impl Written {
    pub(super) fn bare(number: f64) -> Written {
        Written { number, unit: String::new(), quantity: Quantity::bare(number), whole: false }
    }

    /// A zero that is zero in any unit.
    pub(super) fn is_zero(&self) -> bool {
        self.number == 0.0 && self.unit.is_empty()
    }

    /// SI over the number in front of the unit; none where the unit has another zero.
    pub(super) fn factor(&self) -> Option<f64> {
        if self.unit.is_empty() {
            return Some(1.0);
        }
        let value = |number: &str| Some(Quantity::parse(&format!("{number} {}", self.unit)).ok()?.value);
        (value("0")? == 0.0).then(|| value("1"))?
    }

    /// Unit to show values in, and its number for one in SI.
    pub(super) fn shown(&self) -> (String, f64) {
        match self.factor() {
            Some(factor) => (self.unit.clone(), 1.0 / factor),
            None if self.quantity.dimension == Dimension::NONE => (String::new(), 1.0),
            None => (self.quantity.dimension.unit(), 1.0),
        }
    }
}
