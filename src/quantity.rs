//! Numbers with units as people write them -> SI, with their physical dimension.

pub mod dimension;
pub mod nearest;
pub mod readable;
mod table;
mod units;

pub use dimension::Dimension;
pub use nearest::{did_you_mean, nearest};
pub(crate) use table::{find as find_unit, is_unit_letter, suggestion as unit_suggestion};

use crate::quantity::table::Unit;

/// A value in SI units (mol for amounts) and its dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    pub value: f64,
    pub dimension: Dimension,
}

/// What is wrong with a stretch of a text; offset and width in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextFault {
    pub offset: usize,
    pub width: usize,
    pub reason: String,
    pub remedy: String,
}

impl TextFault {
    pub(crate) fn new(
        offset: usize,
        width: usize,
        reason: impl Into<String>,
        remedy: impl Into<String>,
    ) -> TextFault {
        TextFault { offset, width: width.max(1), reason: reason.into(), remedy: remedy.into() }
    }
}

impl Quantity {
    /// A number without dimension.
    #[must_use]
    pub fn bare(value: f64) -> Quantity {
        Quantity { value, dimension: Dimension::NONE }
    }

    /// Reads a number followed by a unit: `347 um^2/s`, `1e-3 Pa s`, `2e6 /M/s`, `0.5 1/min`, `20 degC`.
    ///
    /// The value is the correctly rounded decimal wherever the unit is a power of ten of SI units:
    /// `5 um` is exactly `5e-6`.
    ///
    /// # Errors
    /// Text that is not a finite number and a known unit; the fault says where in the text.
    pub fn parse(text: &str) -> Result<Quantity, TextFault> {
        let characters: Vec<char> = text.chars().collect();
        let start = characters.iter().take_while(|c| c.is_whitespace()).count();
        let length = number_length(&characters[start..]);
        if length == 0 {
            // A text of blanks alone is pointed at as a whole.
            let start = if start == characters.len() { 0 } else { start };
            let width = (characters.len() - start).max(1);
            return Err(TextFault::new(
                start,
                width,
                format!("expected a number with a unit, found \"{}\"", text.trim()),
                "write the number first, then the unit, e.g. 5 um",
            ));
        }
        let end = start + length;
        let digits: String = characters[start..end].iter().collect();
        let value = parse_number(&digits).map_err(|mut fault| {
            fault.offset += start;
            fault
        })?;
        if let Some(fault) = after_number(&characters, start, end) {
            return Err(fault);
        }
        let mut unit_start = end;
        while characters.get(unit_start).is_some_and(|c| c.is_whitespace()) {
            unit_start += 1;
        }
        let unit_text: String = characters[unit_start..].iter().collect();
        let unit_text = unit_text.trim_end();
        if unit_text.is_empty() {
            return Ok(Quantity::bare(value));
        }
        let unit = Unit::parse(unit_text).map_err(|mut fault| {
            fault.offset += unit_start;
            fault
        })?;
        let quantity = unit.apply(&digits, value);
        if !quantity.value.is_finite() {
            return Err(TextFault::new(
                start,
                characters.len() - start,
                "this quantity is too large for a number of double precision",
                "",
            ));
        }
        Ok(quantity)
    }
}

/// What may not follow a number directly: a second number's digits, a digit separator.
fn after_number(characters: &[char], start: usize, end: usize) -> Option<TextFault> {
    let next = *characters.get(end)?;
    let rest = characters[end..].iter().take_while(|c| !c.is_whitespace()).count();
    let word: String = characters[start..end + rest].iter().collect();
    if next == '_' || next == ',' || next == '\'' {
        let plain: String = word.chars().filter(|c| !matches!(c, '_' | ',' | '\'')).collect();
        return Some(TextFault::new(
            start,
            end + rest - start,
            format!("\"{word}\" is not a number"),
            format!("digits are written without separators and decimals with a point, e.g. {plain}"),
        ));
    }
    if next == '.' {
        return Some(TextFault::new(
            start,
            end + rest - start,
            format!("\"{word}\" is not a number"),
            "write e.g. 5e-3",
        ));
    }
    None
}

/// Length in characters of the number at the start: sign, digits, point, exponent; 0 if there is none.
pub(crate) fn number_length(characters: &[char]) -> usize {
    let digits = |from: usize| characters[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let mut at = 0;
    if matches!(characters.first(), Some('+' | '-' | '\u{2212}')) {
        at += 1;
    }
    let whole = digits(at);
    at += whole;
    let mut fraction = 0;
    if characters.get(at) == Some(&'.') {
        fraction = digits(at + 1);
        if whole + fraction > 0 {
            at += 1 + fraction;
        }
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(characters.get(at), Some('e' | 'E')) {
        let sign = usize::from(matches!(characters.get(at + 1), Some('+' | '-')));
        let exponent = if at + 1 + sign <= characters.len() { digits(at + 1 + sign) } else { 0 };
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    at
}

/// A finite number from its digits.
pub(crate) fn parse_number(digits: &str) -> Result<f64, TextFault> {
    let plain = digits.replace('\u{2212}', "-");
    match plain.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(TextFault::new(
            0,
            digits.chars().count(),
            format!("\"{digits}\" is not a number of double precision"),
            "",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rstest::rstest;

    #[rstest]
    #[case("347 um^2/s", 347e-12, Dimension::DIFFUSIVITY)]
    #[case("347 µm²/s", 347e-12, Dimension::DIFFUSIVITY)]
    #[case("5 \u{b5}m", 5e-6, Dimension::LENGTH)]
    #[case("5 \u{3bc}m", 5e-6, Dimension::LENGTH)]
    #[case("5um", 5e-6, Dimension::LENGTH)]
    #[case("0.3 um", 0.3e-6, Dimension::LENGTH)]
    #[case("1e-3 Pa s", 1e-3, Dimension::DYNAMIC_VISCOSITY)]
    #[case("1 mPa s", 1e-3, Dimension::DYNAMIC_VISCOSITY)]
    #[case("1 mPa·s", 1e-3, Dimension::DYNAMIC_VISCOSITY)]
    #[case("1 mPa*s", 1e-3, Dimension::DYNAMIC_VISCOSITY)]
    #[case("1 mol/m^3", 1.0, Dimension::CONCENTRATION)]
    #[case("1000 kg/m3", 1000.0, Dimension::DENSITY)]
    #[case("1 g/cm^3", 1000.0, Dimension::DENSITY)]
    #[case("100 nM", 1e-4, Dimension::CONCENTRATION)]
    #[case("0.5 1/min", 0.5 / 60.0, Dimension::RATE)]
    #[case("2 fL", 2e-18, Dimension::VOLUME)]
    #[case("2 fl", 2e-18, Dimension::VOLUME)]
    #[case("300 K", 300.0, Dimension::TEMPERATURE)]
    #[case("20 degC", 293.15, Dimension::TEMPERATURE)]
    #[case("1 m^3/mol/s", 1.0, Dimension([3, 0, -1, 0, -1]))]
    #[case("1 /s", 1.0, Dimension::RATE)]
    #[case("25.0 1/s", 25.0, Dimension::RATE)]
    #[case("25.0 s^-1", 25.0, Dimension::RATE)]
    #[case("25.0 s⁻¹", 25.0, Dimension::RATE)]
    #[case("2e6 /M/s", 2e3, Dimension([3, 0, -1, 0, -1]))]
    #[case("2e6 1/(M s)", 2e3, Dimension([3, 0, -1, 0, -1]))]
    #[case("1600 molecules", 1600.0 / 6.022_140_76e23, Dimension::AMOUNT)]
    #[case("1 %", 0.01, Dimension::NONE)]
    #[case("3", 3.0, Dimension::NONE)]
    #[case("2 h", 7200.0, Dimension::TIME)]
    #[case("1 min", 60.0, Dimension::TIME)]
    #[case("1 m/s^2", 1.0, Dimension::ACCELERATION)]
    #[case("-9.81 m/s2", -9.81, Dimension::ACCELERATION)]
    #[case("3 kPa", 3000.0, Dimension::PRESSURE)]
    #[case("3 pN", 3e-12, Dimension::FORCE)]
    #[case("10 kHz", 1e4, Dimension::FREQUENCY)]
    #[case("1 m^-2", 1.0, Dimension([-2, 0, 0, 0, 0]))]
    fn quantities_are_read_exactly(#[case] text: &str, #[case] value: f64, #[case] dimension: Dimension) {
        let quantity = Quantity::parse(text).unwrap();
        assert_eq!(quantity.dimension, dimension, "{text}");
        // Decimal prefixes round once, as the literal does; the others also multiply or divide once.
        let limit = if text.contains("min") || text.contains("molecules") { 2.3e-16 } else { 0.0 };
        assert!((quantity.value - value).abs() <= limit * value.abs(), "{text}: {}", quantity.value);
    }

    #[rstest]
    #[case("1_000 um", 0, 5, "not a number")]
    #[case("1,5 um", 0, 3, "not a number")]
    #[case("5 uum", 2, 3, "unknown unit \"uum\"")]
    #[case("5 um/sec2x", 9, 1, "missing between")]
    #[case("5 um/secx", 5, 4, "unknown unit")]
    #[case("5 m/degC", 4, 4, "offset")]
    #[case("fast", 0, 4, "expected a number")]
    #[case("", 0, 1, "expected a number")]
    #[case("5 m/", 3, 1, "unit")]
    #[case("5 m^", 3, 1, "exponent")]
    #[case("5 m^0.5", 4, 3, "exponent")]
    #[case("5 m^99", 4, 2, "exponent")]
    #[case("5 um**2/s", 4, 2, "operator")]
    #[case("5 J/mol K", 8, 1, "unclear")]
    #[case("5 (m", 2, 1, "parenthesis")]
    #[case("1e999 m", 0, 5, "not a number")]
    fn bad_quantities_say_where(
        #[case] text: &str,
        #[case] offset: usize,
        #[case] width: usize,
        #[case] reason: &str,
    ) {
        let fault = Quantity::parse(text).unwrap_err();
        assert!(fault.reason.contains(reason), "{text}: {}", fault.reason);
        assert_eq!((fault.offset, fault.width), (offset, width), "{text}: {}", fault.reason);
    }

    #[test]
    fn unknown_units_suggest_a_near_one() {
        assert!(Quantity::parse("5 Mol").unwrap_err().remedy.contains("\"mol\""));
        assert!(Quantity::parse("5 sec").unwrap().dimension == Dimension::TIME);
        assert!(Quantity::parse("5 umm").unwrap_err().remedy.contains("\"um\""));
        assert!(Quantity::parse("27 C").unwrap_err().remedy.contains("\"degC\""));
    }

    proptest::proptest! {
        #[test]
        fn no_text_panics(text in "[-+0-9.eE_, a-zA-Zµ%²⁻/*^()·°]{0,24}") {
            let length = text.chars().count().max(1);
            if let Err(fault) = Quantity::parse(&text) {
                proptest::prop_assert!(fault.offset + fault.width <= length, "{fault:?} in {text:?}");
            }
        }
    }
}
