//! Products, quotients and powers of units as people write them.

use crate::quantity::dimension::Dimension;
use crate::quantity::table::{Unit, WRITTEN, decimal, find, is_unit_letter, suggestion};
use crate::quantity::{Quantity, TextFault};

impl Unit {
    const ONE: Unit = decimal(Dimension::NONE, 0);

    /// Reads a unit such as `um^2/s`, `1/(M s)`, `/M/s`, `Pa s`, `kg/m3`.
    pub(crate) fn parse(text: &str) -> Result<Unit, TextFault> {
        let mut reader = UnitReader { characters: text.chars().collect(), at: 0, depth: 0 };
        let unit = reader.product()?;
        match reader.characters.get(reader.at) {
            None => Ok(unit),
            Some(')') => Err(TextFault::new(reader.at, 1, "this parenthesis was never opened", "remove it")),
            Some(c) => Err(TextFault::new(reader.at, 1, format!("unexpected \"{c}\" in a unit"), WRITTEN)),
        }
    }

    /// The quantity `digits` of this unit; `value` is what the digits stand for.
    pub(crate) fn apply(&self, digits: &str, value: f64) -> Quantity {
        // Shifting the decimal exponent in the text rounds once: 5 um is 5e-6 to the last bit.
        let plain = digits.replace('\u{2212}', "-").to_lowercase();
        let (mantissa, exponent) = plain.split_once('e').unwrap_or((&plain, "0"));
        let shifted = exponent
            .parse::<i32>()
            .ok()
            .and_then(|e| format!("{mantissa}e{}", e.saturating_add(self.exponent)).parse::<f64>().ok())
            .unwrap_or(value * 10_f64.powi(self.exponent));
        let scaled = shifted * self.numerator / self.denominator + self.offset;
        Quantity { value: scaled, dimension: self.dimension }
    }

    fn times(self, other: Unit, sign: i8) -> Unit {
        let power = other.power(sign);
        Unit {
            dimension: self.dimension * power.dimension,
            exponent: self.exponent + power.exponent,
            numerator: self.numerator * power.numerator,
            denominator: self.denominator * power.denominator,
            offset: self.offset + other.offset,
        }
    }

    fn power(self, power: i8) -> Unit {
        let n = i32::from(power.unsigned_abs());
        let (above, below) = (self.numerator.powi(n), self.denominator.powi(n));
        let (numerator, denominator) = if power < 0 { (below, above) } else { (above, below) };
        Unit {
            dimension: self.dimension.pow(power),
            exponent: self.exponent * i32::from(power),
            numerator,
            denominator,
            offset: self.offset,
        }
    }
}

/// Reads units left to right.
struct UnitReader {
    characters: Vec<char>,
    at: usize,
    depth: usize,
}

/// Deeper parentheses are refused rather than followed.
const DEEPEST: usize = 16;

impl UnitReader {
    fn peek(&self) -> Option<char> {
        self.characters.get(self.at).copied()
    }

    fn blanks(&mut self) -> usize {
        let start = self.at;
        while self.peek().is_some_and(char::is_whitespace) {
            self.at += 1;
        }
        self.at - start
    }

    fn product(&mut self) -> Result<Unit, TextFault> {
        self.blanks();
        let mut divided = false;
        let mut factors = 0;
        let mut out = Unit::ONE;
        loop {
            let blanks = self.blanks();
            let operator_at = self.at;
            let sign = match self.peek() {
                None | Some(')') => break,
                Some('/') => {
                    self.at += 1;
                    divided = true;
                    -1
                }
                Some('*' | '·' | '\u{22c5}' | '×') if factors > 0 => {
                    self.at += 1;
                    1
                }
                Some(_) if blanks > 0 && divided && factors > 0 => {
                    return Err(TextFault::new(
                        operator_at,
                        self.characters.len() - operator_at,
                        "it is unclear whether this unit multiplies or divides",
                        "use parentheses or a second slash: J/(mol K), mol/m^3/s",
                    ));
                }
                Some(_) if blanks == 0 && factors > 0 => {
                    let reason = "a space, \"*\" or \"/\" is missing between two units";
                    return Err(TextFault::new(operator_at, 1, reason, "e.g. Pa s, kg/m^3"));
                }
                Some(_) => 1,
            };
            self.blanks();
            let start = self.at;
            let factor = self.factor()?;
            if factor.offset != 0.0 && (factors > 0 || sign < 0) || out.offset != 0.0 {
                return Err(TextFault::new(
                    if out.offset == 0.0 { start } else { 0 },
                    if out.offset == 0.0 { self.at - start } else { self.at },
                    "degC has an offset and stands only alone",
                    "write K for a temperature difference",
                ));
            }
            out = out.times(factor, sign);
            factors += 1;
        }
        if factors == 0 {
            return Err(TextFault::new(self.at, 1, "expected a unit", WRITTEN));
        }
        Ok(out)
    }

    /// One unit with its exponent.
    fn factor(&mut self) -> Result<Unit, TextFault> {
        let start = self.at;
        let base = match self.peek() {
            Some('(') => {
                self.depth += 1;
                if self.depth > DEEPEST {
                    return Err(TextFault::new(start, 1, "too many parentheses in a unit", WRITTEN));
                }
                self.at += 1;
                let inner = self.product()?;
                if self.peek() != Some(')') {
                    return Err(TextFault::new(start, 1, "this parenthesis is not closed", "add \")\""));
                }
                self.at += 1;
                self.depth -= 1;
                inner
            }
            // The one of `1/s`.
            Some('1') if !self.characters.get(self.at + 1).is_some_and(char::is_ascii_digit) => {
                self.at += 1;
                return Ok(Unit::ONE);
            }
            _ => {
                let length = self.characters[start..].iter().take_while(|&&c| is_unit_letter(c)).count();
                let word: String = self.characters[start..start + length].iter().collect();
                if length == 0 {
                    // The end of the text is pointed at by its last character.
                    let (at, found) = match self.peek() {
                        Some(c) => (self.at, format!(", found \"{c}\"")),
                        None => (self.at.saturating_sub(1), String::new()),
                    };
                    return Err(TextFault::new(at, 1, format!("expected a unit{found}"), WRITTEN));
                }
                self.at += length;
                find(&word).ok_or_else(|| {
                    let tail = self.characters[self.at..].iter().take_while(|c| c.is_alphanumeric()).count();
                    let digits = self.characters[self.at..self.at + tail].iter().all(char::is_ascii_digit);
                    let width = if digits { length } else { length + tail };
                    let shown: String = self.characters[start..start + width].iter().collect();
                    TextFault::new(start, width, format!("unknown unit \"{shown}\""), suggestion(&word))
                })?
            }
        };
        let exponent_at = self.at;
        let power = self.exponent()?;
        if power != 1 && base.offset != 0.0 {
            return Err(TextFault::new(
                start,
                self.at - start,
                "degC has an offset and stands only alone",
                "write K for a temperature difference",
            ));
        }
        let powered = base.power(power);
        if powered.dimension.0.iter().any(|k| k.unsigned_abs() > 60) || powered.exponent.abs() > 300 {
            return Err(TextFault::new(
                exponent_at,
                self.at - exponent_at,
                "this exponent is too large",
                "exponents go up to 12",
            ));
        }
        Ok(powered)
    }

    /// `^2`, `^-1`, `2`, `-1`, `²`, `⁻¹`; 1 if there is none.
    fn exponent(&mut self) -> Result<i8, TextFault> {
        let start = self.at;
        let caret = self.peek() == Some('^');
        if caret {
            self.at += 1;
        } else if self.peek() == Some('*') && self.characters.get(self.at + 1) == Some(&'*') {
            return Err(TextFault::new(
                start,
                2,
                "\"**\" is no operator of units",
                "write powers as um^2 or um2",
            ));
        }
        let from = self.at;
        let mut digits = String::new();
        while let Some(c) = self.peek() {
            let superscript = "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|s| s == c);
            match c {
                '-' | '⁻' | '\u{2212}' if digits.is_empty() => digits.push('-'),
                '+' if digits.is_empty() && caret => {}
                '0'..='9' => digits.push(c),
                _ => match superscript {
                    Some(d) => digits.push_str(&d.to_string()),
                    None => break,
                },
            }
            self.at += 1;
        }
        if digits.is_empty() {
            return if caret {
                Err(TextFault::new(start, 1, "expected a whole exponent after \"^\"", "e.g. m^2"))
            } else {
                Ok(1)
            };
        }
        let rest = self.characters[self.at..].iter().take_while(|c| **c == '.' || c.is_ascii_digit()).count();
        if rest > 0 {
            return Err(TextFault::new(
                from,
                self.at + rest - from,
                "exponents of units are whole numbers",
                "",
            ));
        }
        match digits.parse::<i8>() {
            Ok(power) if power.unsigned_abs() <= 12 => Ok(power),
            _ => Err(TextFault::new(
                from,
                self.at - from,
                "this is no exponent between -12 and 12",
                "e.g. m^2 or s^-1",
            )),
        }
    }
}
