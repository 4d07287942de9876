//! The table of units and SI prefixes.

use crate::quantity::dimension::Dimension;
use crate::quantity::nearest::did_you_mean;

/// How units are written, for messages.
pub(super) const WRITTEN: &str = "units are written like um^2/s, mol/m^3, nM, 1/s, mPa s, fL, degC";

/// Factor to SI as 10^exponent · numerator / denominator, and the dimension. Powers of ten are kept apart
/// so that decimal units round once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    pub dimension: Dimension,
    pub exponent: i32,
    pub numerator: f64,
    pub denominator: f64,
    /// Kelvin to add (degrees Celsius).
    pub offset: f64,
}

const fn unit(dimension: Dimension, exponent: i32, numerator: f64, denominator: f64) -> Unit {
    Unit { dimension, exponent, numerator, denominator, offset: 0.0 }
}

pub(super) const fn decimal(dimension: Dimension, exponent: i32) -> Unit {
    unit(dimension, exponent, 1.0, 1.0)
}

/// Ice point, K (SI brochure 2.3.1).
const ICE_POINT: f64 = 273.15;

/// Units by symbol; `true` where SI prefixes apply.
const TABLE: &[(&str, Unit, bool)] = &[
    ("m", decimal(Dimension::LENGTH, 0), true),
    ("g", decimal(Dimension::MASS, -3), true),
    ("s", decimal(Dimension::TIME, 0), true),
    ("K", decimal(Dimension::TEMPERATURE, 0), true),
    ("mol", decimal(Dimension::AMOUNT, 0), true),
    ("M", decimal(Dimension::CONCENTRATION, 3), true),
    ("L", decimal(Dimension::VOLUME, -3), true),
    ("l", decimal(Dimension::VOLUME, -3), true),
    ("N", decimal(Dimension::FORCE, 0), true),
    ("Pa", decimal(Dimension::PRESSURE, 0), true),
    ("J", decimal(Dimension::ENERGY, 0), true),
    ("W", decimal(Dimension::POWER, 0), true),
    ("Hz", decimal(Dimension::FREQUENCY, 0), true),
    ("bar", decimal(Dimension::PRESSURE, 5), true),
    ("P", decimal(Dimension::DYNAMIC_VISCOSITY, -1), true),
    ("dyn", decimal(Dimension::FORCE, -5), false),
    ("atm", decimal(Dimension::PRESSURE, 0), false), // 101325 Pa, set in `find`
    ("angstrom", decimal(Dimension::LENGTH, -10), false),
    ("Å", decimal(Dimension::LENGTH, -10), false),
    ("min", unit(Dimension::TIME, 0, 60.0, 1.0), false),
    ("h", unit(Dimension::TIME, 2, 36.0, 1.0), false),
    ("hour", unit(Dimension::TIME, 2, 36.0, 1.0), false),
    ("hours", unit(Dimension::TIME, 2, 36.0, 1.0), false),
    ("d", unit(Dimension::TIME, 2, 864.0, 1.0), false),
    ("day", unit(Dimension::TIME, 2, 864.0, 1.0), false),
    ("days", unit(Dimension::TIME, 2, 864.0, 1.0), false),
    ("sec", decimal(Dimension::TIME, 0), false),
    ("rad", decimal(Dimension::NONE, 0), true),
    ("deg", unit(Dimension::NONE, 0, std::f64::consts::PI, 180.0), false),
    ("°", unit(Dimension::NONE, 0, std::f64::consts::PI, 180.0), false),
    ("%", decimal(Dimension::NONE, -2), false),
    ("molecule", unit(Dimension::AMOUNT, 0, 1.0, crate::chemistry::AVOGADRO), false),
    ("molecules", unit(Dimension::AMOUNT, 0, 1.0, crate::chemistry::AVOGADRO), false),
    ("degC", Unit { offset: ICE_POINT, ..decimal(Dimension::TEMPERATURE, 0) }, false),
    ("°C", Unit { offset: ICE_POINT, ..decimal(Dimension::TEMPERATURE, 0) }, false),
];

const STANDARD_ATMOSPHERE: f64 = 101_325.0; // Pa, 10th CGPM (1954)

/// SI prefixes and their powers of ten.
const PREFIXES: &[(&str, i32)] = &[
    ("y", -24),
    ("z", -21),
    ("a", -18),
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("m", -3),
    ("c", -2),
    ("da", 1),
    ("d", -1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
    ("P", 15),
    ("E", 18),
    ("Z", 21),
    ("Y", 24),
];

/// The unit of one word, with its prefix if it has one.
pub(crate) fn find(word: &str) -> Option<Unit> {
    // U+00B5 micro sign and U+03BC Greek mu look alike and mean the same.
    let word: String =
        word.chars().map(|c| if matches!(c, '\u{b5}' | '\u{3bc}') { 'u' } else { c }).collect();
    if word == "atm" {
        return Some(unit(Dimension::PRESSURE, 0, STANDARD_ATMOSPHERE, 1.0));
    }
    let whole = TABLE.iter().find(|(symbol, _, _)| *symbol == word).map(|&(_, unit, _)| unit);
    whole.or_else(|| {
        PREFIXES.iter().find_map(|&(prefix, exponent)| {
            let rest = word.strip_prefix(prefix)?;
            let &(_, unit, _) = TABLE.iter().find(|(symbol, _, prefixed)| *prefixed && *symbol == rest)?;
            Some(Unit { exponent: unit.exponent + exponent, ..unit })
        })
    })
}

/// A known unit near this word, as a remedy.
pub(crate) fn suggestion(word: &str) -> String {
    // Nearer by letters are cm and others.
    if ["c", "°c", "celsius", "centigrade"].contains(&word.to_lowercase().as_str()) {
        return "did you mean \"degC\"?".into();
    }
    let plain: Vec<String> = TABLE.iter().map(|(symbol, _, _)| (*symbol).to_string()).collect();
    let usual = ["f", "p", "n", "u", "m", "c", "k", "M"];
    let prefixed = TABLE
        .iter()
        .filter(|(_, _, prefixed)| *prefixed)
        .flat_map(|(symbol, _, _)| usual.iter().map(move |prefix| format!("{prefix}{symbol}")));
    let all: Vec<String> = plain.into_iter().chain(prefixed).collect();
    let near = did_you_mean(word, all.iter().map(String::as_str));
    if near.is_empty() { WRITTEN.to_string() } else { near }
}

/// Characters of which unit words are made.
pub(crate) fn is_unit_letter(c: char) -> bool {
    (c.is_alphabetic() && !"⁰¹²³⁴⁵⁶⁷⁸⁹".contains(c)) || matches!(c, '%' | '°' | '\u{b5}' | '_')
}
