//! Round positions along an axis, with labels.

use crate::quantity::readable::significant;

/// Round tick positions within low..=high, about `count` of them, with their labels.
#[must_use]
pub fn ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return vec![(low, significant(low, 4))];
    }
    let rough = span / count.max(1) as f64;
    let power = 10f64.powf(rough.log10().floor());
    // The round step nearest on a logarithmic scale.
    let step = match rough / power {
        m if m < 1.5 => 1.0,
        m if m < 3.2 => 2.0,
        m if m < 7.1 => 5.0,
        _ => 10.0,
    } * power;
    let found = ticks_every(low, high, step);
    // One tick is no scale.
    if found.len() < 2 && count < 8 { ticks(low, high, 2 * count.max(1)) } else { found }
}

/// Ticks at the multiples of a step.
#[must_use]
pub fn ticks_every(low: f64, high: f64, step: f64) -> Vec<(f64, String)> {
    let decimals = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
    let first = (low / step - 1e-6).ceil() as i64;
    let last = (high / step + 1e-6).floor() as i64;
    let far = low.abs().max(high.abs()) >= 1e6 || decimals > 5;
    (first..=last.min(first + 1000))
        .map(|k| {
            let value = k as f64 * step;
            let label =
                if far { significant(value, 3) } else { format!("{value:.decimals$}").replace('-', "−") };
            (value, label)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels: Vec<String> = ticks(0.0, 52.0, 6).into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["0", "10", "20", "30", "40", "50"]);
        let labels: Vec<String> = ticks(-0.1, 0.25, 4).into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["−0.1", "0.0", "0.1", "0.2"]);
        assert_eq!(ticks(1.0, 1.0, 5).len(), 1);
        assert!(ticks(0.0, 0.9, 1).len() > 1 && ticks(0.0, 7.0, 1).len() > 1);
    }
}
