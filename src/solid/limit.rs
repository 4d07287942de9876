//! The fastest mode of a solid, and the longest stable step.

use crate::error::RunError;
use crate::random::mix;
use crate::solid::elastic::{Elastic, Hold};
use crate::vector::Vector;

/// Rounds of power iteration; the frequency comes from below, by a few per cent.
const ROUNDS: usize = 40;
/// Step of the difference quotients of forces, in mean distances of particles: rounding and curvature count alike.
const SMALL: f64 = 1e-5;

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

    /// The longest step that is used, s: a part ([`Options::courant`](super::Options)) of 2/ω of the fastest mode.
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn step_limit(&mut self) -> Result<f64, RunError> {
        let fastest = self.fastest()?;
        Ok(if fastest > 0.0 { self.options.courant * 2.0 / fastest } else { f64::INFINITY })
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
