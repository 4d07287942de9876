//! How kernel weights become conductances: ours, and the two forms in print.

/// The weight of a pair in the diffusion operator, by name.
///
/// All three give the same conductance to both sides and none below zero. Weights corrected by the gradient of
/// the kernel (a tensor per particle) do neither, so they are not among them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weights {
    /// F_ij divided by the mean lattice bias of the pair: D_eff = D on any lattice.
    #[default]
    Normalised,
    /// F_ij as it is: D_eff/D is the lattice bias alpha.
    Plain,
    /// F_ij r²/(r² + 0.01 h²), not divided: SDPD in print (dissertation on the sSSA-SDPD hybrid, chapter 2).
    Softened,
}

/// Softening in units of h²; keeps x·∇W/r² finite at r = 0, where F needs no help.
const SOFTENING: f64 = 0.01;

impl Weights {
    /// Factor on F of a pair at squared distance `r2` (m²) for a cut-off `h` (m).
    #[inline]
    #[must_use]
    pub fn factor(self, r2: f64, h: f64) -> f64 {
        match self {
            Weights::Normalised | Weights::Plain => 1.0,
            Weights::Softened => r2 / (r2 + SOFTENING * h * h),
        }
    }

    /// Factor on the conductance of a pair from the lattice biases of its two sides.
    #[inline]
    #[must_use]
    pub fn over_bias(self, alpha_i: f64, alpha_j: f64) -> f64 {
        match self {
            Weights::Normalised => 2.0 / (alpha_i + alpha_j),
            Weights::Plain | Weights::Softened => 1.0,
        }
    }

    /// What is approximate about them, in words, where they are not ours.
    #[must_use]
    pub fn caveat(self) -> Option<&'static str> {
        match self {
            Weights::Normalised => None,
            Weights::Plain => Some(
                "printed operator (unnormalised): the diffusivity is off by the lattice bias of the kernel, some per cent",
            ),
            Weights::Softened => Some(
                "printed operator (softened, unnormalised): the diffusivity is off by the lattice bias of the kernel and by the softening, some per cent",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_as_printed() {
        // Nearest neighbours at h = 1.8: 1/(1 + 0.01 * 3.24).
        assert!((Weights::Softened.factor(1.0, 1.8) - 1.0 / 1.0324).abs() < 1e-15);
        assert_eq!(Weights::Plain.factor(1.0, 1.8), 1.0);
        assert_eq!(Weights::Normalised.over_bias(0.9, 1.1), 1.0);
        assert_eq!(Weights::Plain.over_bias(0.9, 0.9), 1.0);
        assert!(Weights::Normalised.caveat().is_none());
    }
}
