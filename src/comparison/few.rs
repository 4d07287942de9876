//! Few events: exact tests of how many there are, where t is far from Student's.

use crate::statistics::{binomial_cdf, fisher_exact};

/// Below this many events they are counted.
const FEW: u64 = 10;

/// The p of the signs of pairs, where few of them differ.
pub fn signs(a: &[f64], b: &[f64]) -> Option<f64> {
    let up = a.iter().zip(b).filter(|(a, b)| b > a).count() as u64;
    let down = a.iter().zip(b).filter(|(a, b)| b < a).count() as u64;
    (up + down < FEW).then(|| (2.0 * binomial_cdf(up.min(down), up + down, 0.5)).min(1.0))
}

/// The exact p of how many realizations leave the value that most have, up and down, where those are few.
pub fn counted(a: &[f64], b: &[f64]) -> Option<f64> {
    let (n, m) = (a.len() as u64, b.len() as u64);
    // The median is the common value, if there is one.
    let mut all = [a, b].concat();
    let (_, &mut common, _) = all.select_nth_unstable_by((a.len() + b.len()) / 2, f64::total_cmp);
    let above = |values: &[f64]| values.iter().filter(|v| **v > common).count() as u64;
    let below = |values: &[f64]| values.iter().filter(|v| **v < common).count() as u64;
    let (up, down) = ([above(a), above(b)], [below(a), below(b)]);
    let events = up[0] + up[1] + down[0] + down[1];
    // Small samples that vary are no rare events: three quarters of all must have the common value.
    let rare = events * n.min(m) < FEW * (n + m) && 4 * events < n + m;
    let p = |[a, b]: [u64; 2]| if a + b == 0 { 1.0 } else { fisher_exact(a, n, b, m) };
    // Two tests where events go both ways.
    let ways = if up == [0, 0] || down == [0, 0] { 1.0 } else { 2.0 };
    rare.then(|| (ways * p(up).min(p(down))).min(1.0))
}
