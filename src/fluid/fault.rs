//! What a flow says when its numbers have gone wrong, and what would do.

use crate::error::RunError;
use crate::fluid::flow::Flow;

/// Relative change of density that the sound speed is chosen for.
const CHANGE: f64 = 0.01;
/// For a change of density a sound speed is raised at least and at most so many times: what is seen is the blow-up.
const RAISED: (f64, f64) = (2.0, 10.0);

impl<const D: usize> Flow<D> {
    /// The fault of particle `i` (in the present order) at the present step.
    pub(super) fn blow_up(&self, i: usize, quantity: &str, value: f64) -> RunError {
        let at: Vec<String> = self.positions[i].iter().map(|x| format!("{x:.4e}")).collect();
        let (c, dt) = (self.sound_speed, self.step_length);
        RunError::BlowUp {
            step: self.steps,
            time: self.time,
            particle: self.sides[i].id as usize,
            quantity: quantity.to_owned(),
            value,
            remedy: format!(
                "at ({}) m, with a sound speed of {c:.3e} m/s, a step of {dt:.3e} s and a fluid.speed of {:.3e} m/s: set fluid.sound_speed: {:.1e} m/s, or halve the step by fluid.options.courant: {:.1e}",
                at.join(", "),
                self.setup.reference_speed,
                self.stiffer(i),
                self.courant_of(0.5 * dt),
            ),
        }
    }

    /// A sound speed that would do for what befell particle `i`, m/s: density changes fall with its square.
    fn stiffer(&self, i: usize) -> f64 {
        let change = (self.sides[i].density / self.own[i].rest_density - 1.0).abs();
        let raised = if change.is_finite() { (change / CHANGE).sqrt() } else { RAISED.0 };
        (self.sound_speed * raised.clamp(RAISED.0, RAISED.1)).max(10.0 * self.setup.reference_speed)
    }

    /// The Courant number of a step of `dt` (s).
    fn courant_of(&self, dt: f64) -> f64 {
        dt * (self.sound_speed + self.setup.reference_speed) / self.kernel.cutoff()
    }
}
