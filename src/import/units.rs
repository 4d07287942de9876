//! Units of an SBML file: what one unit of substance, volume and time is in molecules, m³ and s.

use super::document::{child, list};
use super::log::{Log, Spot};
use crate::chemistry::AVOGADRO;
use std::collections::BTreeMap;

/// What a unit measures, as far as it matters here: powers of (metre, second, molecule); everything else
/// counts as `other`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Kind {
    metre: f64,
    second: f64,
    molecule: f64,
    other: f64,
}

const PURE: Kind = Kind { metre: 0.0, second: 0.0, molecule: 0.0, other: 0.0 };

/// Factor to m, s, molecules, and what it measures.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unit {
    factor: f64,
    kind: Kind,
    /// Counted in moles: amounts are meant as concentrations in bulk.
    moles: bool,
}

/// The three quantities that an import needs units of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Substance,
    Volume,
    Time,
}

impl Quantity {
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Quantity::Substance => ("amount", "molecules"),
            Quantity::Volume => ("volume", "litres"),
            Quantity::Time => ("time", "seconds"),
        }
    }

    fn kind(self) -> Kind {
        match self {
            Quantity::Substance => Kind { molecule: 1.0, ..PURE },
            Quantity::Volume => Kind { metre: 3.0, ..PURE },
            Quantity::Time => Kind { second: 1.0, ..PURE },
        }
    }
}

/// A resolved unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measure {
    /// Molecules, m³ or s in one unit.
    pub size: f64,
    pub moles: bool,
}

/// m³.
const LITRE: f64 = 1e-3;

/// The unit definitions of a model.
#[derive(Debug, Default)]
pub(super) struct Units {
    defined: BTreeMap<String, Unit>,
    level: u32,
}

impl Units {
    pub fn read(model: roxmltree::Node, level: u32, log: &mut Log) -> Units {
        let mut units = Units { defined: BTreeMap::new(), level };
        for definition in list(model, "listOfUnitDefinitions", "unitDefinition") {
            let Some(id) = definition.attribute("id") else { continue };
            let mut unit = Unit { factor: 1.0, kind: PURE, moles: false };
            if let Some(parts) = child(definition, "listOfUnits") {
                for part in parts.children().filter(|n| n.is_element()) {
                    match factor(part, log) {
                        Some(factor) => unit = unit.times(factor),
                        None => unit.kind.other = f64::NAN,
                    }
                }
            }
            units.defined.insert(id.to_string(), unit);
        }
        units
    }

    /// What a unit named in the file (or the default where none is) comes to.
    pub fn measure(&self, name: Option<&str>, quantity: Quantity, spot: Spot, log: &mut Log) -> Measure {
        let (what, plain) = quantity.words();
        let assumed = Measure { size: if quantity == Quantity::Volume { LITRE } else { 1.0 }, moles: false };
        let fallback = match (self.level, quantity) {
            (2, Quantity::Substance) => Some("substance"),
            (2, Quantity::Volume) => Some("volume"),
            (2, Quantity::Time) => Some("time"),
            _ => None,
        };
        let Some(name) = name.or(fallback) else {
            log.note(format!("the file gives no unit of {what}: taken for {plain}"));
            return assumed;
        };
        let Some(unit) = self.find(name) else {
            let reason = format!("unknown unit \"{name}\" of {what}");
            log.fault(
                spot,
                reason,
                "add a unitDefinition for it, or use a unit of SBML such as mole or litre",
            );
            return assumed;
        };
        if unit.kind == quantity.kind() {
            return Measure { size: unit.factor, moles: unit.moles };
        }
        if unit.kind == PURE {
            log.note(format!("the unit \"{name}\" of {what} is a pure number: taken for {plain}"));
            return Measure { size: unit.factor * assumed.size, moles: false };
        }
        let remedy = match quantity {
            Quantity::Substance => {
                "give amounts in moles or items; --molecules or --substance UNIT overrides the unit of the file"
            }
            Quantity::Volume => "give the compartment's size in litres or cubic metres",
            Quantity::Time => "give times in seconds",
        };
        log.fault(spot, format!("the unit \"{name}\" is no unit of {what}"), remedy);
        assumed
    }

    fn find(&self, name: &str) -> Option<Unit> {
        if let Some(unit) = self.defined.get(name) {
            return Some(*unit);
        }
        match (self.level, name) {
            (2, "substance") => base("mole"),
            (2, "volume") => base("litre"),
            (2, "time") => base("second"),
            (2, "length") => base("metre"),
            (2, "area") => base("metre").map(|unit| unit.power(2.0)),
            _ => base(name),
        }
    }
}

impl Unit {
    fn times(self, other: Unit) -> Unit {
        Unit {
            factor: self.factor * other.factor,
            kind: Kind {
                metre: self.kind.metre + other.kind.metre,
                second: self.kind.second + other.kind.second,
                molecule: self.kind.molecule + other.kind.molecule,
                other: self.kind.other + other.kind.other,
            },
            moles: self.moles || other.moles,
        }
    }

    fn power(self, power: f64) -> Unit {
        let factor = if power.fract() == 0.0 && power.abs() < 100.0 {
            self.factor.powi(power as i32)
        } else {
            self.factor.powf(power)
        };
        let kind = Kind {
            metre: self.kind.metre * power,
            second: self.kind.second * power,
            molecule: self.kind.molecule * power,
            other: self.kind.other * power,
        };
        Unit { factor, kind, ..self }
    }
}

/// (multiplier · 10^scale · kind)^exponent.
fn factor(part: roxmltree::Node, log: &mut Log) -> Option<Unit> {
    let name = part.attribute("kind").unwrap_or("");
    let number = |key: &str, usual: f64| part.attribute(key).map_or(Some(usual), |t| t.trim().parse().ok());
    let (Some(multiplier), Some(scale), Some(exponent)) =
        (number("multiplier", 1.0), number("scale", 0.0), number("exponent", 1.0))
    else {
        log.fault(Spot::of(part), "multiplier, scale and exponent are numbers", "correct the unit");
        return None;
    };
    let Some(base) = base(name) else {
        log.fault(Spot::of(part), format!("unknown kind of unit \"{name}\""), "use a unit of SBML");
        return None;
    };
    let ten = if scale.fract() == 0.0 && scale.abs() < 300.0 {
        // The double nearest to the power of ten; 10^-9 by multiplication is off in the last bit.
        format!("1e{}", scale as i32).parse().unwrap_or(1.0)
    } else {
        10_f64.powf(scale)
    };
    Some(Unit { factor: multiplier * ten * base.factor, ..base }.power(exponent))
}

/// A unit that SBML knows by name.
fn base(name: &str) -> Option<Unit> {
    let plain = |factor, kind| Some(Unit { factor, kind, moles: false });
    match name {
        "mole" => Some(Unit { factor: AVOGADRO, kind: Kind { molecule: 1.0, ..PURE }, moles: true }),
        "item" => plain(1.0, Kind { molecule: 1.0, ..PURE }),
        "avogadro" => plain(AVOGADRO, PURE),
        "dimensionless" | "radian" | "steradian" => plain(1.0, PURE),
        "litre" | "liter" => plain(LITRE, Kind { metre: 3.0, ..PURE }),
        "metre" | "meter" => plain(1.0, Kind { metre: 1.0, ..PURE }),
        "second" => plain(1.0, Kind { second: 1.0, ..PURE }),
        "hertz" | "becquerel" => plain(1.0, Kind { second: -1.0, ..PURE }),
        "katal" => {
            Some(Unit { factor: AVOGADRO, kind: Kind { molecule: 1.0, second: -1.0, ..PURE }, moles: true })
        }
        "ampere" | "candela" | "celsius" | "Celsius" | "coulomb" | "farad" | "gram" | "gray" | "henry"
        | "joule" | "kelvin" | "kilogram" | "lumen" | "lux" | "newton" | "ohm" | "pascal" | "siemens"
        | "sievert" | "tesla" | "volt" | "watt" | "weber" => plain(1.0, Kind { other: 1.0, ..PURE }),
        _ => None,
    }
}
