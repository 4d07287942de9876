//! SI values as people read them: prefixes, significant digits.

/// A unit to show values in: value in SI times `factor` reads in `unit`.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    pub factor: f64,
    pub unit: String,
}

/// SI prefixes used, with their powers of ten.
const PREFIXES: [(&str, i32); 13] = [
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("µ", -6),
    ("m", -3),
    ("", 0),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
    ("P", 15),
    ("E", 18),
    ("a", -18),
];

impl Scale {
    /// The values as they are.
    #[must_use]
    pub fn plain(unit: &str) -> Scale {
        Scale { factor: 1.0, unit: unit.to_string() }
    }

    /// The unit that brings a value of this size to 1 … 1000. Understands SI names (`m`, `s`, `m/s`, `Pa`,
    /// `m^2/s`, `m^3`); `mol/m^3` is shown as M with a prefix (1 mol/m³ = 1 mM); a pure number keeps none.
    #[must_use]
    pub fn choose(largest: f64, unit: &str) -> Scale {
        let (base, size, power, rest) = match unit {
            "molecules" => {
                // Counts carry no prefix; powers of a thousand keep tick labels short.
                let powers = [(1e10, 1e-9, "10⁹ "), (1e7, 1e-6, "10⁶ "), (1e4, 1e-3, "10³ ")];
                let fit = powers.into_iter().find(|p| largest.abs() >= p.0);
                let (_, factor, power) = fit.unwrap_or((0.0, 1.0, ""));
                return Scale { factor, unit: format!("{power}molecules") };
            }
            "" | "1" | "rad" | "kg/m^3" => {
                let shown = match unit {
                    "1" => "",
                    "kg/m^3" => "kg/m³",
                    other => other,
                };
                return Scale::plain(shown);
            }
            "1/m" => {
                // 1/mm where a millimetre is to be told: never a prefix before the one.
                let size = largest.abs();
                let known = size.is_finite() && size > 0.0;
                let step = if known { -(((size * 1.000_001).log10() / 3.0).floor() as i32 * 3) } else { 0 };
                let step = step.clamp(-18, 9);
                let prefix = PREFIXES.iter().find(|(_, p)| *p == step).map_or("", |(name, _)| name);
                return Scale { factor: 10f64.powi(step), unit: format!("1/{prefix}m") };
            }
            "kg" => ("g", 1e3, 1, ""),
            "mol/m^3" | "mol/m³" => ("M", 1e-3, 1, ""),
            "m/s" => ("m", 1.0, 1, "/s"),
            "m^2/s" | "m²/s" => ("m", 1.0, 2, "²/s"),
            "m^3" | "m³" => ("L", 1e3, 1, ""),
            other => (other, 1.0, 1, ""),
        };
        let largest = largest.abs() * size;
        if !largest.is_finite() || largest == 0.0 {
            return Scale { factor: size, unit: format!("{base}{rest}") };
        }
        // A shade above 999 still reads as 1000 of the smaller unit.
        let step = ((largest * 1.000_001).log10() / f64::from(3 * power)).floor() as i32 * 3;
        let step = step.clamp(-18, if base == "s" { 0 } else { 9 });
        let prefix = PREFIXES.iter().find(|(_, p)| *p == step).map_or("", |(name, _)| name);
        Scale { factor: size * 10f64.powi(-step * power), unit: format!("{prefix}{base}{rest}") }
    }

    /// `label (unit)`, or the label alone for a pure number.
    #[must_use]
    pub fn label(&self, label: &str) -> String {
        if self.unit.is_empty() { label.to_string() } else { format!("{label} ({})", self.unit) }
    }

    /// A value with its unit, three significant digits.
    #[must_use]
    pub fn show(&self, value: f64) -> String {
        let number = significant(value * self.factor, 3);
        if self.unit.is_empty() { number } else { format!("{number} {}", self.unit) }
    }
}

/// A value in SI with a fitting unit: `show(2.5e-6, "m")` is `2.5 µm`.
#[must_use]
pub fn show(value: f64, unit: &str) -> String {
    Scale::choose(value, unit).show(value)
}

/// A length in m with a fitting unit and six significant digits, for lengths that a user may copy.
#[must_use]
pub fn length(value: f64) -> String {
    let scale = Scale::choose(value, "m");
    format!("{} {}", significant(value * scale.factor, 6), scale.unit)
}

/// Components in one unit: `show_vector(&[1.25e-3, 0.0], "m/s")` is `(1.25, 0) mm/s`; one component needs no brackets.
/// Four significant digits.
#[must_use]
pub fn show_vector(components: &[f64], unit: &str) -> String {
    let scale = Scale::choose(components.iter().fold(0.0, |m, c| c.abs().max(m)), unit);
    let numbers: Vec<String> = components.iter().map(|c| significant(c * scale.factor, 4)).collect();
    match &numbers[..] {
        [one] => format!("{one} {}", scale.unit),
        _ => format!("({}) {}", numbers.join(", "), scale.unit),
    }
}

/// A number with this many significant digits, without needless zeros; powers of ten where it is far from one.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return "–".into();
    }
    let rounded = format!("{value:.*e}", digits.max(1) - 1);
    let Some((mantissa, exponent)) = rounded.split_once('e') else { return rounded };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trim = |text: &str| {
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text };
        text.replace('-', "−")
    };
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        trim(&format!("{value:.decimals$}"))
    } else {
        let superscript: String = exponent.to_string().chars().map(superscript).collect();
        match trim(mantissa).as_str() {
            "1" => format!("10{superscript}"),
            mantissa => format!("{mantissa}·10{superscript}"),
        }
    }
}

fn superscript(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0'..='9' => char::from_u32(0x2070 + c as u32 - '0' as u32).unwrap_or(c),
        other => other,
    }
}

/// Whole numbers with thin gaps between groups of three: `12 345 678`.
#[must_use]
pub fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut out = String::new();
    for (k, c) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && digits.len() > 4 {
            out.push('\u{a0}');
        }
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_bring_values_to_a_readable_size() {
        assert_eq!(show(2.5e-6, "m"), "2.5 µm");
        assert_eq!(show(1e-3, "s"), "1 ms");
        assert_eq!(show(250.0, "s"), "250 s");
        assert_eq!(show(3e-6, "mol/m^3"), "3 nM");
        assert_eq!(show(1.0, "mol/m^3"), "1 mM");
        assert_eq!(show(347e-12, "m^2/s"), "347 µm²/s");
        assert_eq!(show(1e-18, "m^3"), "1 fL");
        assert_eq!(show(0.0021, "m/s"), "2.1 mm/s");
        assert_eq!(show(0.5, "1"), "0.5");
    }

    #[test]
    fn reciprocal_lengths_and_masses_have_prefixes_where_people_put_them() {
        assert_eq!(show(3e5, "1/m"), "300 1/mm");
        assert_eq!(show(4.2e6, "1/m"), "4.2 1/µm");
        assert_eq!(show(0.05, "1/m"), "50 1/km");
        assert_eq!(show(0.0, "1/m"), "0 1/m");
        assert_eq!(show(1.18e-13, "kg"), "118 pg");
    }

    #[test]
    fn vectors_share_one_unit() {
        assert_eq!(show_vector(&[1.25e-3, 0.0], "m/s"), "(1.25, 0) mm/s");
        assert_eq!(show_vector(&[-0.1e-6], "m"), "−100 nm");
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!(significant(123_456.0, 3), "123456");
        assert_eq!(significant(1.5e-9, 3), "1.5·10⁻⁹");
        assert_eq!(significant(1e9, 3), "10⁹");
        assert_eq!(significant(-0.25, 3), "−0.25");
        assert_eq!(grouped(1_234_567), "1\u{a0}234\u{a0}567");
    }
}
