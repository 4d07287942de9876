//! Equations of state.

use crate::fluid::setup::EquationOfState;

impl EquationOfState {
    /// Pressure (Pa) at a density (kg/m³), of a fluid with rest density `rest` and sound speed `c` (m/s) at rest.
    #[inline]
    #[must_use]
    pub fn pressure(self, density: f64, rest: f64, c: f64) -> f64 {
        match self {
            EquationOfState::Linear => c * c * (density - rest),
            EquationOfState::Tait7 => {
                let ratio = density / rest;
                let cube = ratio * ratio * ratio;
                c * c * rest / 7.0 * (cube * cube * ratio - 1.0)
            }
        }
    }

    /// The density (kg/m³) at a pressure (Pa): the inverse of [`EquationOfState::pressure`]. Where the Tait equation
    /// knows no such pressure (below -c²rho0/7) half the rest density.
    #[inline]
    #[must_use]
    pub fn density(self, pressure: f64, rest: f64, c: f64) -> f64 {
        match self {
            EquationOfState::Linear => rest + pressure / (c * c),
            EquationOfState::Tait7 => {
                // 2^-7: the ratio at half the density.
                rest * (1.0 + 7.0 * pressure / (c * c * rest)).max(0.007_812_5).powf(1.0 / 7.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_have_the_sound_speed_at_rest_and_invert() {
        for state in [EquationOfState::Linear, EquationOfState::Tait7] {
            let (rest, c, d) = (998.0, 30.0, 1e-3);
            assert_eq!(state.pressure(rest, rest, c), 0.0);
            let slope = (state.pressure(rest + d, rest, c) - state.pressure(rest - d, rest, c)) / (2.0 * d);
            // Central difference: (d/rho)² and rounding 1e-16 rho/d.
            assert!((slope / (c * c) - 1.0).abs() < 1e-8);
            for density in [900.0, 998.0, 1050.0] {
                let back = state.density(state.pressure(density, rest, c), rest, c);
                // Rounding, made larger by the seventh root's slope.
                assert!((back / density - 1.0).abs() < 1e-13);
            }
        }
        // 1 % denser: 0.0721 instead of 0.07 of rho c²/7.
        let stiff = EquationOfState::Tait7.pressure(1.01, 1.0, 1.0);
        assert!((stiff - (1.01_f64.powi(7) - 1.0) / 7.0).abs() < 1e-15);
    }
}
