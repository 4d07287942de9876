//! What a probe recorded, across realizations, at the times that tell most.

use super::{Samples, moments};
use crate::statistics::{mean, quantile};
use crate::tables::ProbeRows;

/// Mean and 5 to 95 % band of one quantity along a probe at one time; not a number where points are missing.
pub(super) struct Section {
    pub time: f64,
    pub s: Vec<f64>,
    pub mean: Vec<f64>,
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    pub realizations: usize,
    /// Values of the first realization.
    pub single: Vec<f64>,
}

/// The sections of a quantity, in order of time.
pub(super) fn sections(samples: &Samples, name: &str, quantity: &str) -> Vec<Section> {
    let rows: Vec<&ProbeRows> =
        samples.probes.iter().filter(|r| r.probe == name && r.quantity == quantity).collect();
    let mut times: Vec<f64> = rows.iter().map(|r| r.time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let at = |time: f64| rows.iter().copied().filter(|r| r.time == time).collect::<Vec<_>>();
    moments(samples, &times).into_iter().map(|k| section(times[k], &at(times[k]))).collect()
}

fn section(time: f64, rows: &[&ProbeRows]) -> Section {
    // Particles move: a point may lie in the fluid of one realization and have no value in another.
    let mut s: Vec<f64> = rows.iter().flat_map(|r| r.s.iter().copied()).collect();
    s.sort_by(f64::total_cmp);
    s.dedup();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); s.len()];
    let mut single = vec![f64::NAN; s.len()];
    for (n, row) in rows.iter().enumerate() {
        for (at, value) in row.s.iter().zip(&row.value).filter(|(_, v)| v.is_finite()) {
            if let Ok(k) = s.binary_search_by(|other| other.total_cmp(at)) {
                values[k].push(*value);
                if n == 0 {
                    single[k] = *value;
                }
            }
        }
    }
    let over = |f: &dyn Fn(&[f64]) -> f64| -> Vec<f64> { values.iter().map(|v| f(v)).collect() };
    let mut section = Section {
        time,
        mean: over(&mean),
        low: over(&|v| quantile(v, 0.05)),
        high: over(&|v| quantile(v, 0.95)),
        realizations: rows.len(),
        single,
        s,
    };
    for k in gaps(&section.s).into_iter().rev() {
        section.s.insert(k, 0.5 * (section.s[k - 1] + section.s[k]));
        for list in [&mut section.mean, &mut section.low, &mut section.high, &mut section.single] {
            list.insert(k, f64::NAN);
        }
    }
    section
}

/// Indices of points farther than one and a half of the usual spacing behind the one before.
fn gaps(s: &[f64]) -> Vec<usize> {
    let steps: Vec<f64> = s.windows(2).map(|w| w[1] - w[0]).collect();
    let usual = quantile(&steps, 0.5);
    (1..s.len()).filter(|&k| s[k] - s[k - 1] > 1.5 * usual).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_breaks_where_points_are_missing() {
        let s = vec![0.0, 1.0, 2.0, 5.0, 6.0];
        let position = vec![[0.0; 3]; 5];
        let rows = |realization, value: Vec<f64>| ProbeRows {
            probe: "line".into(),
            realization,
            time: 1.0,
            quantity: "L".into(),
            s: s.clone(),
            position: position.clone(),
            value,
        };
        let (a, b) = (rows(0, vec![1.0, 1.0, 1.0, 1.0, 1.0]), rows(1, vec![3.0, 3.0, f64::NAN, 3.0, 3.0]));
        let section = section(1.0, &[&a, &b]);
        assert_eq!(section.s, [0.0, 1.0, 2.0, 3.5, 5.0, 6.0]);
        assert!(section.mean[3].is_nan() && section.high[3].is_nan());
        assert_eq!((section.mean[1], section.mean[2], section.realizations), (2.0, 1.0, 2));
    }
}
