//! Diffusion of a hybrid species: molecules walk, amounts flow, and each may end where the other is at home.
//!
//! What flows into a voxel of whole molecules arrives as a Poisson number of that mean, and the continuous voxels
//! beside it give exactly as many: the total is kept to the molecule, and the mean follows the linear operator.

use super::{Frozen, SplitState};
use crate::chemistry::diffusion::{Bath, HopTable, Jumps};
use crate::chemistry::reactor::Hybrid;
use crate::chemistry::sampling_numbers::poisson;

/// Work space of a diffusion step.
#[derive(Clone, Debug, Default)]
pub(super) struct Mixture {
    /// Molecules of discrete voxels, where they are now.
    walking: Vec<f64>,
    /// Amounts of continuous voxels, where they are now.
    flowing: Vec<f64>,
}

impl SplitState {
    /// One piece of a diffusion step of hybrid species number `k`; `baths` are its held voxels, then its doors.
    pub(super) fn diffuse_mixed(
        &mut self,
        (hybrid, frozen, table): (&Hybrid, &Frozen, &HopTable),
        k: usize,
        jumps: &Jumps,
        baths: &[Bath],
    ) {
        let (s, species) = (hybrid.species[k], self.supplied.len());
        let voxels = frozen.voxels();
        let flows = |modes: &super::Modes, i: usize| modes.of(i) >> k & 1 == 1;
        let mut mixture = std::mem::take(&mut self.mixture);
        mixture.walking.clear();
        mixture.flowing.clear();
        for i in 0..voxels {
            let n = self.amounts[i * species + s];
            let (walking, flowing) = if flows(&self.modes, i) { (0.0, n) } else { (n, 0.0) };
            mixture.walking.push(walking);
            mixture.flowing.push(flowing);
        }
        // A held voxel takes in what reaches it in either form and sends out in its own; doors send in that of the voxel.
        let (mut walkers, mut pipes) = (baths.to_vec(), baths.to_vec());
        for (walker, pipe) in
            walkers.iter_mut().zip(&mut pipes).filter(|(walker, _)| walker.node < voxels as u32)
        {
            let silent = if flows(&self.modes, walker.node as usize) { walker } else { pipe };
            silent.mean = 0.0;
        }
        let modes = &self.modes;
        let (whole, real) = (|i: usize| !flows(modes, i), |i: usize| flows(modes, i));
        self.counters.hops += self.walkers.diffuse(
            table,
            jumps,
            (&mut mixture.walking, 0, 1),
            (&mut walkers, &whole),
            &mut self.hops,
        );
        self.flow.diffuse(table, jumps, (&mut mixture.flowing, 0, 1), (&mut pipes, &real));
        self.book(frozen, s, &walkers, true);
        self.book(frozen, s, &pipes, false);
        let mut owed = 0.0;
        for i in 0..voxels {
            let slot = i * species + s;
            if frozen.is_held(slot) {
                continue;
            }
            if flows(&self.modes, i) {
                self.amounts[slot] = mixture.walking[i] + mixture.flowing[i];
            } else {
                let arrived = poisson(&mut self.hops, mixture.flowing[i]) as f64;
                self.amounts[slot] = mixture.walking[i] + arrived;
                mixture.flowing[i] -= arrived;
            }
        }
        // What arrived more or less than flowed is settled with the neighbours it came from.
        for j in (0..voxels).filter(|&j| !flows(&self.modes, j) && !frozen.is_held(j * species + s)) {
            let debt = std::mem::take(&mut mixture.flowing[j]);
            if debt == 0.0 {
                continue;
            }
            let share = |state: &SplitState, i: usize, p: f64| {
                if flows(&state.modes, i) {
                    p * state.amounts[i * species + s] * frozen.scales[i].inverse
                } else {
                    0.0
                }
            };
            let sum: f64 = table.row(j).filter(|&(i, _)| i < voxels).map(|(i, p)| share(self, i, p)).sum();
            if sum <= 0.0 {
                owed += debt;
                continue;
            }
            for (i, p) in table.row(j).filter(|&(i, _)| i < voxels) {
                let part = debt * share(self, i, p) / sum;
                let slot = i * species + s;
                if frozen.is_held(slot) {
                    self.supplied[s] -= part;
                } else if part != 0.0 {
                    let part_taken = part.max(-self.amounts[slot]);
                    self.amounts[slot] += part_taken;
                    owed += part - part_taken;
                }
            }
        }
        self.settle(k, s, frozen, owed);
        self.mixture = mixture;
    }

    /// Gives what no neighbour could settle to the continuous voxel that holds most.
    fn settle(&mut self, k: usize, s: usize, frozen: &Frozen, owed: f64) {
        if owed == 0.0 {
            return;
        }
        let species = self.supplied.len();
        let most = (0..frozen.voxels())
            .filter(|&i| self.modes.of(i) >> k & 1 == 1 && !frozen.is_held(i * species + s))
            .max_by(|&a, &b| self.amounts[a * species + s].total_cmp(&self.amounts[b * species + s]));
        match most {
            Some(i) if self.amounts[i * species + s] + owed >= 0.0 => self.amounts[i * species + s] += owed,
            _ => self.modes.owe(s, owed),
        }
    }
}
