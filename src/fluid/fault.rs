//! What a flow says when its numbers have gone wrong, and what would do.
//!
//! The numbers of one particle are those of the blow-up; what led to it is read off the others.

use crate::error::RunError;
use crate::fluid::flow::Flow;

/// Relative change of density that the sound speed is chosen for.
const CHANGE: f64 = 0.01;
/// For a change of density a sound speed is raised at least and at most so many times: what is seen is the blow-up.
const RAISED: (f64, f64) = (2.0, 10.0);
/// A flow so many times faster than stated is the cause of what befalls it, if its sound speed goes with what is stated.
const FASTER: f64 = 2.0;

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
                "at ({}) m, with a sound speed of {c:.3e} m/s, a step of {dt:.3e} s and a fluid.speed of {:.3e} m/s: {}",
                at.join(", "),
                self.setup.reference_speed,
                self.advice(i),
            ),
        }
    }

    /// What would do for what befell particle `i`.
    fn advice(&self, i: usize) -> String {
        let (speed, stated) = (self.swift(), self.setup.reference_speed);
        let chosen = self.sound_speed >= self.setup.expected_sound_speed;
        if chosen && speed > FASTER * stated {
            return format!(
                "a tenth of the fluid is faster than {speed:.1e} m/s, {:.0} times the fluid.speed that sound speed and step are chosen for: set fluid.speed to the largest speed there is to be, or look for what drives it (a force, a lid, an inlet, a sponge)",
                speed / stated
            );
        }
        format!(
            "set fluid.sound_speed: {:.1e} m/s, or halve the step by fluid.options.courant: {:.1e}",
            self.stiffer(i),
            self.courant_of(0.5 * self.step_length)
        )
    }

    /// The speed that a tenth of the fluid exceeds, m/s.
    fn swift(&self) -> f64 {
        let fluid = self.sides.iter().filter(|side| !side.is_solid());
        let mut speeds: Vec<f64> = fluid.map(|s| s.velocity.norm()).filter(|v| v.is_finite()).collect();
        if speeds.is_empty() {
            return 0.0;
        }
        let rank = speeds.len() * 9 / 10;
        *speeds.select_nth_unstable_by(rank, f64::total_cmp).1
    }

    /// A sound speed that would do for what befell particle `i`, m/s: density changes fall with its square.
    fn stiffer(&self, i: usize) -> f64 {
        let change = (self.sides[i].density / self.own[i].rest_density - 1.0).abs();
        let raised = if change.is_finite() { (change / CHANGE).sqrt() } else { RAISED.0 };
        (self.sound_speed * raised.clamp(RAISED.0, RAISED.1)).max(self.setup.expected_sound_speed)
    }

    /// The Courant number of a step of `dt` (s).
    fn courant_of(&self, dt: f64) -> f64 {
        dt * (self.sound_speed + self.setup.reference_speed) / self.kernel.cutoff()
    }
}
