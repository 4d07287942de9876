//! What a test can see, remembered for many tests of nearly the same degrees of freedom.

use crate::statistics;
use std::collections::HashMap;

/// A level and a power, and the differences found for them so far.
pub struct Sight {
    level: f64,
    power: f64,
    known: HashMap<u64, f64>,
}

impl Sight {
    pub fn new(level: f64, power: f64) -> Sight {
        Sight { level, power, known: HashMap::new() }
    }

    /// The true difference, in standard errors, that is found with the power.
    pub fn detectable(&mut self, freedom: f64) -> f64 {
        let freedom = three_digits(freedom);
        let (level, power) = (self.level, self.power);
        *self.known.entry(freedom.to_bits()).or_insert_with(|| statistics::detectable(freedom, level, power))
    }

    /// The chance that a true difference of so many standard errors is found.
    pub fn power(&self, errors: f64, freedom: f64) -> f64 {
        statistics::power(errors, freedom, self.level)
    }
}

/// Rounded down: what is seen depends on the degrees of freedom so little that its first four digits stay.
fn three_digits(freedom: f64) -> f64 {
    if freedom < 100.0 || !freedom.is_finite() {
        return freedom;
    }
    let unit = 10f64.powf(freedom.log10().floor() - 2.0);
    (freedom / unit).floor() * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_the_degrees_of_freedom_changes_little() {
        let mut sight = Sight::new(1e-4, 0.8);
        for freedom in [3.7, 99.9, 123.456, 1999.0, 54_321.0] {
            let exact = statistics::detectable(freedom, 1e-4, 0.8);
            let found = sight.detectable(freedom);
            assert!(found >= exact * (1.0 - 1e-9) && found < exact * 1.001, "{freedom}: {found} {exact}");
            assert!((sight.power(found, freedom) - 0.8).abs() < 1e-3);
        }
    }
}
