//! Continuous amounts: the exponential of the same chain, n ← Σ_k Poisson(k; Λτ) P^k n.
//!
//! Every term is positive, so amounts stay positive, and every row of P sums to one, so the total is kept
//! to rounding. The sum stops where the remaining weight is below rounding.

use super::discrete::Moved;
use super::{HopTable, Jumps};

/// Amounts of one species on their way, reused from step to step.
#[derive(Clone, Debug, Default)]
pub struct Flow {
    carried: Vec<f64>,
    next: Vec<f64>,
}

/// Weight P(K ≥ s) below which the rest of the sum is left where it is.
const ROUNDING: f64 = 1e-17;

impl Flow {
    /// Moves the continuous species that stands at `amounts[offset + i * stride]` in voxel i by one step.
    /// `held` lists the held voxels and the amounts they emit by.
    pub fn diffuse(
        &mut self,
        table: &HopTable,
        jumps: &Jumps,
        (amounts, offset, stride): (&mut [f64], usize, usize),
        held: &[(u32, f64)],
    ) -> Moved {
        let voxels = table.voxels();
        let mut moved = Moved::default();
        self.carried.clear();
        self.carried.extend(amounts[offset..].iter().step_by(stride).take(voxels));
        for &(h, _) in held {
            self.carried[h as usize] = 0.0;
        }
        let mut first = true;
        for (&tail, &onward) in jumps.tail.iter().zip(&jumps.onward) {
            if tail < ROUNDING {
                break;
            }
            self.next.clear();
            self.next.resize(voxels, 0.0);
            for (i, &amount) in self.carried.iter().enumerate() {
                if amount == 0.0 {
                    continue;
                }
                let going = amount * onward;
                let slot = &mut amounts[offset + i * stride];
                *slot = if first { amount - going } else { *slot + (amount - going) };
                for (j, p) in table.row(i) {
                    self.next[j] += going * p;
                }
            }
            for &(h, n) in held {
                moved.emitted += n * tail;
                for (j, p) in table.row(h as usize) {
                    self.next[j] += n * tail * p;
                }
            }
            for &(h, _) in held {
                moved.emitted -= std::mem::take(&mut self.next[h as usize]);
            }
            std::mem::swap(&mut self.carried, &mut self.next);
            first = false;
        }
        if !first {
            for (i, &amount) in self.carried.iter().enumerate() {
                amounts[offset + i * stride] += amount;
            }
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::links::Links;

    #[test]
    fn two_voxels_relax_exactly() {
        // n_0(t) = N (p + (1 - p) e^{-g (1/V0 + 1/V1) t}), p = V0 / (V0 + V1); here V = 1, 0.25, g = 0.5.
        let links = Links::from_pairs(2, &[(0, 1, 0.5)]);
        let table = HopTable::build(&links, &[1.0, 0.25], |_| true).unwrap();
        for t in [0.1, 0.5, 5.0, 100.0] {
            let mut amounts = [100.0, 0.0];
            let (jumps, pieces) = Jumps::expected(table.rate * t);
            for _ in 0..pieces {
                Flow::default().diffuse(&table, &jumps, (&mut amounts, 0, 1), &[]);
            }
            // Rounding of some tens of terms.
            assert!((amounts[0] - (80.0 + 20.0 * (-2.5 * t).exp())).abs() < 1e-11, "{t}");
            assert!((amounts[0] + amounts[1] - 100.0).abs() < 1e-11);
        }
    }

    #[test]
    fn held_voxel_feeds_its_neighbour() {
        // Voxel 0 held at 10: dn/dt = g (10 - n), n(t) = 10 (1 - e^{-g t}) for V = 1.
        let links = Links::from_pairs(2, &[(0, 1, 0.7)]);
        let table = HopTable::build(&links, &[1.0, 1.0], |_| true).unwrap();
        let mut amounts = [10.0, 0.0];
        let (jumps, _) = Jumps::expected(table.rate * 1.3);
        let moved = Flow::default().diffuse(&table, &jumps, (&mut amounts, 0, 1), &[(0, 10.0)]);
        assert_eq!(amounts[0], 10.0);
        assert!((amounts[1] - 10.0 * (1.0 - (-0.7_f64 * 1.3).exp())).abs() < 1e-12);
        assert!((moved.emitted - amounts[1]).abs() < 1e-12);
    }
}
