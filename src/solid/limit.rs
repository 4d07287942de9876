//! The fastest mode of a solid, and the longest stable step.

use crate::error::RunError;
use crate::random::mix;
use crate::solid::elastic::{Elastic, Hold};
use crate::vector::Vector;

/// Rounds of power iteration; the frequency comes from below, by a few per cent.
const ROUNDS: usize = 40;
/// Step of the difference quotients of forces, in mean distances of particles: rounding and curvature count alike.
const SMALL: f64 = 1e-5;

/// The longest step of a solid and what limits it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepLimit {
    /// s.
    pub seconds: f64,
    pub limited_by: String,
}

impl<const D: usize> Elastic<D> {
    /// Angular frequency of the fastest mode about the present state, 1/s: power iteration on the linearised forces.
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn fastest(&mut self) -> Result<f64, RunError> {
        let any = |i: usize, k: usize| (mix((i * D + k) as u64) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let mut mode: Vec<Vector<D>> = (0..self.len()).map(|i| Vector::from_fn(|k, _| any(i, k))).collect();
        let mut square = 0.0;
        for _ in 0..ROUNDS {
            let size = mode.iter().map(|u| u.norm_squared()).sum::<f64>().sqrt();
            if size == 0.0 {
                return Ok(0.0);
            }
            mode.iter_mut().for_each(|u| *u /= size);
            let pull = self.linear_acceleration(&mode)?;
            square = -mode.iter().zip(&pull).map(|(u, a)| u.dot(a)).sum::<f64>();
            mode = pull;
        }
        Ok(square.max(0.0).sqrt())
    }

    /// The longest step that is used, s.
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn step_limit(&mut self) -> Result<f64, RunError> {
        Ok(self.limit()?.seconds)
    }

    /// The longest step that is used, a part ([`Options::courant`](super::Options)) of the stable one, and what limits
    /// it. Of a mode ω that friction damps at the rate 2ξω it is 2/ω (√(1 + ξ²) - ξ), if friction is taken from the
    /// velocities of half a step before.
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn limit(&mut self) -> Result<StepLimit, RunError> {
        let (fastest, friction) = (self.fastest()?, self.friction());
        if fastest == 0.0 && friction == 0.0 {
            return Ok(StepLimit { seconds: f64::INFINITY, limited_by: "nothing".into() });
        }
        // 2/ω (√(1 + ξ²) - ξ) with ξ = friction/(2ω), also where ω is zero.
        let stable = 4.0 / (friction + (friction * friction + 4.0 * fastest * fastest).sqrt());
        let limited_by =
            if friction > fastest { "the viscosity of the solid" } else { "the fastest mode of the solid" };
        Ok(StepLimit { seconds: self.options.courant * stable, limited_by: limited_by.into() })
    }

    /// No mode loses its velocity to viscosity faster than this, 1/s: twice the largest sum over the bonds of a
    /// particle.
    fn friction(&self) -> f64 {
        if self.options.viscosity == 0.0 {
            return 0.0;
        }
        let sum = |i: usize| self.bonds.of(i).iter().map(|bond| bond.w).sum::<f64>();
        let most = (0..self.len()).map(sum).fold(0.0, f64::max);
        2.0 * self.options.viscosity * most / self.material.density
    }

    /// Acceleration (1/s² times the unit of `mode`) by internal forces per displacement along `mode`, about the present
    /// state; held particles do not move. By central differences.
    pub(super) fn linear_acceleration(&mut self, mode: &[Vector<D>]) -> Result<Vec<Vector<D>>, RunError> {
        let largest = mode.iter().map(|u| u.norm()).fold(0.0, f64::max);
        let volume = self.volumes.iter().sum::<f64>() / self.len().max(1) as f64;
        let scale = SMALL * volume.powf(1.0 / D as f64) / largest.max(f64::MIN_POSITIVE);
        let here = self.displacements.clone();
        let mut out = vec![Vector::zeros(); self.len()];
        for sign in [1.0, -1.0] {
            for (i, u) in self.displacements.iter_mut().enumerate() {
                if matches!(self.holds[i], Hold::Free) {
                    *u = here[i] + mode[i] * (sign * scale);
                }
            }
            self.strain()?;
            self.pull();
            for (i, out) in out.iter_mut().enumerate() {
                if matches!(self.holds[i], Hold::Free) {
                    *out += self.forces[i] * (sign / (2.0 * scale * self.material.density * self.volumes[i]));
                }
            }
        }
        self.displacements = here;
        self.strain()?;
        self.pull();
        Ok(out)
    }
}
