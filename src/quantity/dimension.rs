//! Physical dimensions as powers of base units.

use std::fmt;
use std::ops::{Div, Mul};

/// Powers of (metre, kilogram, second, kelvin, mole).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub struct Dimension(pub [i8; 5]);

#[allow(missing_docs)] // Each constant is named after the quantity it is the dimension of.
impl Dimension {
    pub const NONE: Dimension = Dimension([0, 0, 0, 0, 0]);
    pub const LENGTH: Dimension = Dimension([1, 0, 0, 0, 0]);
    pub const AREA: Dimension = Dimension([2, 0, 0, 0, 0]);
    pub const VOLUME: Dimension = Dimension([3, 0, 0, 0, 0]);
    pub const MASS: Dimension = Dimension([0, 1, 0, 0, 0]);
    pub const TIME: Dimension = Dimension([0, 0, 1, 0, 0]);
    pub const TEMPERATURE: Dimension = Dimension([0, 0, 0, 1, 0]);
    pub const AMOUNT: Dimension = Dimension([0, 0, 0, 0, 1]);
    pub const VELOCITY: Dimension = Dimension([1, 0, -1, 0, 0]);
    pub const ACCELERATION: Dimension = Dimension([1, 0, -2, 0, 0]);
    /// Also kinematic viscosity and thermal diffusivity.
    pub const DIFFUSIVITY: Dimension = Dimension([2, 0, -1, 0, 0]);
    pub const CONCENTRATION: Dimension = Dimension([-3, 0, 0, 0, 1]);
    pub const CONCENTRATION_RATE: Dimension = Dimension([-3, 0, -1, 0, 1]);
    /// 1/s; also strain rates.
    pub const RATE: Dimension = Dimension([0, 0, -1, 0, 0]);
    pub const FREQUENCY: Dimension = Dimension::RATE;
    pub const DENSITY: Dimension = Dimension([-3, 1, 0, 0, 0]);
    pub const DYNAMIC_VISCOSITY: Dimension = Dimension([-1, 1, -1, 0, 0]);
    /// Also elastic moduli and stresses.
    pub const PRESSURE: Dimension = Dimension([-1, 1, -2, 0, 0]);
    pub const FORCE: Dimension = Dimension([1, 1, -2, 0, 0]);
    pub const ENERGY: Dimension = Dimension([2, 1, -2, 0, 0]);
    pub const POWER: Dimension = Dimension([2, 1, -3, 0, 0]);
    /// Also stiffness of a spring.
    pub const SURFACE_TENSION: Dimension = Dimension([0, 1, -2, 0, 0]);
    /// Drag coefficient of a particle.
    pub const FRICTION: Dimension = Dimension([0, 1, -1, 0, 0]);
    pub const PRESSURE_GRADIENT: Dimension = Dimension([-2, 1, -2, 0, 0]);
    pub const FLOW_RATE: Dimension = Dimension([3, 0, -1, 0, 0]);
    pub const AREAL_CONCENTRATION: Dimension = Dimension([-2, 0, 0, 0, 1]);
    pub const THERMAL_EXPANSION: Dimension = Dimension([0, 0, 0, -1, 0]);
    /// Relative density change per concentration.
    pub const SOLUTAL_EXPANSION: Dimension = Dimension([3, 0, 0, 0, -1]);

    /// The dimension to a whole power.
    #[must_use]
    pub const fn pow(self, power: i8) -> Dimension {
        let mut out = self.0;
        let mut k = 0;
        while k < out.len() {
            out[k] = out[k].saturating_mul(power);
            k += 1;
        }
        Dimension(out)
    }

    /// Dimension of a mass-action constant of this order: (m³/mol)^(order - 1)/s.
    #[must_use]
    pub fn rate_constant(order: u32) -> Dimension {
        Dimension::CONCENTRATION.pow(1 - order.min(100) as i8) * Dimension::RATE
    }

    /// Whether it is a pure number.
    #[must_use]
    pub fn is_none(self) -> bool {
        self == Dimension::NONE
    }

    /// The SI unit, e.g. `m^2/s`, `1/s`; `1` for a pure number.
    #[must_use]
    pub fn unit(self) -> String {
        let named = [(Dimension::PRESSURE, "Pa"), (Dimension::DYNAMIC_VISCOSITY, "Pa s")];
        if let Some((_, unit)) = named.iter().find(|(dimension, _)| *dimension == self) {
            return (*unit).to_string();
        }
        let power = |symbol: &str, exponent: i8| match exponent {
            1 => symbol.to_string(),
            n => format!("{symbol}^{n}"),
        };
        // Kilogram and mole before metre and second, as units are usually read: kg/m^3, mol/m^3/s.
        let order = [(1, "kg"), (4, "mol"), (0, "m"), (3, "K"), (2, "s")];
        let above: Vec<String> =
            order.iter().filter(|(k, _)| self.0[*k] > 0).map(|&(k, s)| power(s, self.0[k])).collect();
        let below: Vec<String> =
            order.iter().filter(|(k, _)| self.0[*k] < 0).map(|&(k, s)| power(s, -self.0[k])).collect();
        let mut text = if above.is_empty() { "1".to_string() } else { above.join(" ") };
        for part in below {
            text.push('/');
            text.push_str(&part);
        }
        text
    }

    /// The name of the quantity, where it has a common one.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        NAMES.iter().find(|(dimension, _)| *dimension == self).map(|&(_, name)| name)
    }
}

const NAMES: &[(Dimension, &str)] = &[
    (Dimension::LENGTH, "length"),
    (Dimension::AREA, "area"),
    (Dimension::VOLUME, "volume"),
    (Dimension::MASS, "mass"),
    (Dimension::TIME, "time"),
    (Dimension::TEMPERATURE, "temperature"),
    (Dimension::AMOUNT, "amount"),
    (Dimension::VELOCITY, "velocity"),
    (Dimension::ACCELERATION, "acceleration"),
    (Dimension::DIFFUSIVITY, "diffusivity"),
    (Dimension::CONCENTRATION, "concentration"),
    (Dimension::CONCENTRATION_RATE, "concentration per time"),
    (Dimension::RATE, "rate"),
    (Dimension([-2, 0, -1, 0, 0]), "flux of molecules"),
    (Dimension([-2, 0, -1, 0, 1]), "molar flux"),
    (Dimension::DENSITY, "density"),
    (Dimension::DYNAMIC_VISCOSITY, "dynamic viscosity"),
    (Dimension::PRESSURE, "pressure"),
    (Dimension::FORCE, "force"),
    (Dimension::ENERGY, "energy"),
    (Dimension::POWER, "power"),
    (Dimension::SURFACE_TENSION, "surface tension"),
    (Dimension::FRICTION, "friction coefficient"),
    (Dimension::PRESSURE_GRADIENT, "pressure gradient"),
    (Dimension::FLOW_RATE, "volume flow rate"),
    (Dimension::AREAL_CONCENTRATION, "amount per area"),
];

impl Mul for Dimension {
    type Output = Dimension;
    fn mul(self, other: Dimension) -> Dimension {
        Dimension(std::array::from_fn(|k| self.0[k].saturating_add(other.0[k])))
    }
}

impl Div for Dimension {
    type Output = Dimension;
    fn div(self, other: Dimension) -> Dimension {
        Dimension(std::array::from_fn(|k| self.0[k].saturating_sub(other.0[k])))
    }
}

impl fmt::Display for Dimension {
    /// Name and SI unit: `diffusivity (m^2/s)`; only the unit where there is no name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_none() {
            return write!(f, "a pure number");
        }
        match self.name() {
            Some(name) => write!(f, "{name} ({})", self.unit()),
            None => write!(f, "{}", self.unit()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_are_named() {
        assert_eq!(Dimension::DIFFUSIVITY.to_string(), "diffusivity (m^2/s)");
        assert_eq!(Dimension::DENSITY.to_string(), "density (kg/m^3)");
        assert_eq!(Dimension::RATE.to_string(), "rate (1/s)");
        assert_eq!(Dimension::DYNAMIC_VISCOSITY.to_string(), "dynamic viscosity (Pa s)");
        assert_eq!(Dimension::NONE.to_string(), "a pure number");
        assert_eq!(Dimension::rate_constant(2).to_string(), "m^3/mol/s");
        assert_eq!(Dimension::rate_constant(0), Dimension::CONCENTRATION_RATE);
        assert_eq!(Dimension::rate_constant(1), Dimension::RATE);
    }

    #[test]
    fn dimensions_multiply() {
        assert_eq!(Dimension::VELOCITY * Dimension::LENGTH, Dimension::DIFFUSIVITY);
        assert_eq!(Dimension::FORCE / Dimension::AREA, Dimension::PRESSURE);
        assert_eq!(Dimension::LENGTH.pow(3), Dimension::VOLUME);
    }
}
