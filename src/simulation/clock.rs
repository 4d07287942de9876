//! When what happens: chemistry steps and fluid steps that meet every output time exactly.

/// The time between two looks, divided into equal chemistry steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// s.
    pub start: f64,
    pub end: f64,
    /// Chemistry steps; 0 only if the interval is empty.
    pub ticks: u64,
    /// Fluid steps in each chemistry step.
    pub fluid_steps: u64,
}

impl Interval {
    /// Chemistry step, s.
    #[must_use]
    pub fn tick(&self) -> f64 {
        if self.ticks == 0 { 0.0 } else { (self.end - self.start) / self.ticks as f64 }
    }

    /// Time after `k` chemistry steps, s.
    #[must_use]
    pub fn time(&self, k: u64) -> f64 {
        if k == self.ticks { self.end } else { self.start + k as f64 * self.tick() }
    }
}

/// Intervals that end at each output time in turn, with steps of at most `chemistry` and `fluid` seconds.
#[must_use]
pub fn intervals(times: &[f64], chemistry: f64, fluid: Option<f64>) -> Vec<Interval> {
    let mut start = 0.0;
    times
        .iter()
        .map(|&end| {
            // A step that fits up to rounding is not halved for it.
            let parts = |length: f64, step: f64| ((length / step) * (1.0 - 1e-9)).ceil().max(1.0) as u64;
            let ticks = if end > start { parts(end - start, chemistry) } else { 0 };
            let fluid_steps = fluid
                .map_or(0, |step| if ticks == 0 { 0 } else { parts((end - start) / ticks as f64, step) });
            let interval = Interval { start, end, ticks, fluid_steps };
            start = end;
            interval
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_meet_every_output_time() {
        let found = intervals(&[0.0, 0.25, 1.0], 0.1, Some(0.03));
        assert_eq!(found.iter().map(|i| i.ticks).collect::<Vec<_>>(), [0, 3, 8]);
        assert_eq!(found[2].end, 1.0);
        for interval in &found[1..] {
            assert!(interval.tick() <= 0.1 && interval.tick() / interval.fluid_steps as f64 <= 0.03);
            assert_eq!(interval.time(interval.ticks), interval.end);
        }
        // 0.3 / 0.1 is a little more than 3 in binary; three steps will do.
        assert_eq!(intervals(&[0.3], 0.1, None)[0].ticks, 3);
    }
}
