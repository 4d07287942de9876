//! Continuous amounts: the exponential of the same chain, n ← Σ_k Poisson(k; Λτ) P^k n.
//!
//! Every term is positive, so amounts stay positive, and every row of P sums to one, so the total is kept
//! to rounding. The sum stops where the remaining weight is below rounding.

use super::{Bath, HopTable, Jumps, Open};

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
    /// `baths` are its held voxels and the doors of the table, which book what passes; doors send into `open` voxels.
    pub fn diffuse(
        &mut self,
        table: &HopTable,
        jumps: &Jumps,
        (amounts, offset, stride): (&mut [f64], usize, usize),
        (baths, open): (&mut [Bath], Open),
    ) {
        let (voxels, nodes) = (table.voxels(), table.nodes());
        self.carried.clear();
        self.carried.extend(amounts[offset..].iter().step_by(stride).take(voxels));
        self.carried.resize(nodes, 0.0);
        for bath in &*baths {
            self.carried[bath.node as usize] = 0.0;
        }
        let mut first = true;
        for (&tail, &onward) in jumps.tail.iter().zip(&jumps.onward) {
            // The first jump brings what enters by doors, however short the step.
            if tail < ROUNDING && !first {
                break;
            }
            self.next.clear();
            self.next.resize(nodes, 0.0);
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
            for bath in baths.iter_mut().filter(|bath| bath.mean > 0.0) {
                let (node, going) = (bath.node as usize, bath.mean * tail);
                for (j, p) in table.row(node).filter(|&(j, _)| node < voxels || open(j)) {
                    self.next[j] += going * p;
                    bath.sent += going * p;
                }
            }
            for bath in &mut *baths {
                bath.taken += std::mem::take(&mut self.next[bath.node as usize]);
            }
            std::mem::swap(&mut self.carried, &mut self.next);
            first = false;
        }
        if !first {
            for (i, &amount) in self.carried[..voxels].iter().enumerate() {
                amounts[offset + i * stride] += amount;
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::chemistry::diffusion::{ALL, Door};
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
                Flow::default().diffuse(&table, &jumps, (&mut amounts, 0, 1), (&mut [], ALL));
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
        let mut held = [Bath::new(0, 10.0)];
        Flow::default().diffuse(&table, &jumps, (&mut amounts, 0, 1), (&mut held, ALL));
        assert_eq!(amounts[0], 10.0);
        assert!((amounts[1] - 10.0 * (1.0 - (-0.7_f64 * 1.3).exp())).abs() < 1e-12);
        assert!((held[0].emitted() - amounts[1]).abs() < 1e-12);
    }

    /// Five unit cells in a row, half a cell from surfaces: 4 is held at the left one, the right one absorbs all.
    pub fn between_surfaces() -> (HopTable, Vec<f64>) {
        let links = Links::from_pairs(5, &[(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0), (3, 4, 1.0)]);
        let doors = [
            Door { out: vec![(0, 2.0)], into: Vec::new() },
            Door { out: Vec::new(), into: vec![(0, 8.0)] },
            Door { out: vec![(4, 2.0)], into: Vec::new() },
        ];
        HopTable::build(&links, &[1.0; 5], |_| true).unwrap().with_doors(&doors)
    }

    #[test]
    fn surfaces_are_exact_over_any_step() {
        let (table, means) = between_surfaces();
        let run = |time: f64, steps: u32| {
            let mut amounts = [0.0; 5];
            let mut doors: Vec<Bath> = (5..).zip(&means).map(|(node, &mean)| Bath::new(node, mean)).collect();
            let (jumps, pieces) = Jumps::expected(table.rate * time / f64::from(steps));
            for _ in 0..steps * pieces as u32 {
                Flow::default().diffuse(&table, &jumps, (&mut amounts, 0, 1), (&mut doors, ALL));
            }
            let passed = doors[1].sent - doors[0].taken - doors[2].taken;
            assert!((passed / amounts.iter().sum::<f64>() - 1.0).abs() < 1e-10, "{passed}");
            amounts
        };
        // One step and 64: rounding of hundreds of terms.
        for (a, b) in run(3.0, 1).iter().zip(run(3.0, 64)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        // 4 at x = 0 and nothing at x = 5, in one long step.
        for (i, n) in run(500.0, 1).into_iter().enumerate() {
            assert!((n - (4.0 - 0.8 * (i as f64 + 0.5))).abs() < 1e-11, "{i} {n}");
        }
    }

    #[test]
    fn what_enters_a_lone_voxel_stays_there() {
        // Nothing leaves it, and the step is of no length for the chain: 5 molecules per 1/m² of rate.
        let alone = HopTable::build(&Links::from_pairs(1, &[]), &[1.0], |_| true).unwrap();
        let (table, means) = alone.with_doors(&[Door { out: Vec::new(), into: vec![(0, 5.0)] }]);
        for step in [1e-18, 1e-6, 2.0] {
            let (mut amounts, mut door) = ([0.0], [Bath::new(1, means[0])]);
            let (jumps, _) = Jumps::expected(table.rate * step);
            Flow::default().diffuse(&table, &jumps, (&mut amounts, 0, 1), (&mut door, ALL));
            assert!((amounts[0] / (5.0 * step) - 1.0).abs() < 1e-12, "{step}: {}", amounts[0]);
        }
    }
}
