//! Hybrid species: which voxels carry them as whole molecules and which as real amounts, and how they change over.
//!
//! A species becomes continuous in a voxel that holds `above` molecules or more, and discrete again below `below`.
//! Nothing is made or lost by that. What is not whole in an amount came about in two ways, and goes back the same
//! way: by a reaction that was integrated to a broken number of events (it is rounded to a whole event, which keeps
//! every conserved sum), and by diffusion (it is rounded against the other voxels of the species). Both roundings
//! leave the mean as it is.

use super::{Frozen, SplitState};
use crate::chemistry::reactor::{Hybrid, Reactor};
use rand::Rng;
use serde::{Deserialize, Serialize};

/// Modes of the voxels of one realization; all empty if no species is hybrid.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Modes {
    /// Mode of each voxel: bits as in [`Hybrid`].
    mode: Vec<u8>,
    /// Broken part of the extent of each integrated reaction, voxel by voxel.
    broken: Vec<f64>,
    /// Events of each reaction by rate equations so far, roundings included.
    extents: Vec<f64>,
    /// Molecules of each species that rounding left over; less than one each.
    left_over: Vec<f64>,
    /// Changes in each voxel, hybrid species by hybrid species: to continuous, to discrete.
    changes: Vec<[u32; 2]>,
    /// Looks at which a voxel was continuous, likewise, and looks in all.
    continuous: Vec<u32>,
    looks: u32,
    /// Extents of the voxel under way.
    #[serde(skip)]
    current: Vec<f64>,
}

/// Less than this of a molecule is rounding.
const ROUNDING: f64 = 1e-7;

impl Modes {
    pub(super) fn new(reactor: &Reactor, voxels: usize) -> Modes {
        let Some(hybrid) = &reactor.hybrid else { return Modes::default() };
        let (count, reactions) = (hybrid.species.len(), reactor.propensities.len());
        Modes {
            mode: vec![0; voxels],
            broken: vec![0.0; voxels * reactions],
            extents: vec![0.0; reactions],
            left_over: vec![0.0; reactor.species_count()],
            changes: vec![[0; 2]; voxels * count],
            continuous: vec![0; voxels * count],
            looks: 0,
            current: Vec::new(),
        }
    }

    /// Mode of a voxel.
    #[inline]
    #[must_use]
    pub fn of(&self, voxel: usize) -> u8 {
        self.mode.get(voxel).copied().unwrap_or(0)
    }

    /// A voxel that comes into being carries the species of `bit` as real amounts.
    pub(in crate::chemistry) fn flow_in(&mut self, voxel: usize, bit: u8) {
        if let Some(mode) = self.mode.get_mut(voxel) {
            *mode |= bit;
        }
    }

    /// Molecules of species `s` that rounding left over.
    #[must_use]
    pub fn left_over(&self, s: usize) -> f64 {
        self.left_over.get(s).copied().unwrap_or(0.0)
    }

    /// Events of each reaction by rate equations so far; empty if no species is hybrid.
    #[must_use]
    pub fn extents(&self) -> &[f64] {
        &self.extents
    }

    /// Of hybrid species number `k` in a voxel: changes to continuous and to discrete, and the share of looks at
    /// which it was continuous.
    #[must_use]
    pub fn history(&self, k: usize, voxel: usize) -> ([u32; 2], f64) {
        let slot = k * self.mode.len() + voxel;
        (self.changes[slot], f64::from(self.continuous[slot]) / f64::from(self.looks.max(1)))
    }

    /// Whether these are modes of the same voxels and species as `other`.
    pub(super) fn fits(&self, other: &Modes) -> bool {
        self.mode.len() == other.mode.len() && self.broken.len() == other.broken.len()
    }

    /// Keeps part of a molecule of species `s` for the next change.
    pub(super) fn owe(&mut self, s: usize, part: f64) {
        self.left_over[s] += part;
    }

    /// Takes `extent` events of reaction `r` outside any voxel into the books.
    pub(super) fn add(&mut self, r: usize, extent: f64) {
        if let Some(sum) = self.extents.get_mut(r) {
            *sum += extent;
        }
    }

    /// Room for the extents of `count` integrated reactions of the voxel under way.
    pub(super) fn room(&mut self, count: usize) -> &mut [f64] {
        self.current.clear();
        if !self.mode.is_empty() {
            self.current.resize(count, 0.0);
        }
        &mut self.current
    }

    /// Takes the extents of the voxel under way into the books.
    pub(super) fn book(&mut self, voxel: usize, integrated: &[u32]) {
        let reactions = self.extents.len();
        for (&r, &extent) in integrated.iter().zip(&self.current) {
            self.extents[r as usize] += extent;
            let broken = &mut self.broken[voxel * reactions + r as usize];
            *broken = (*broken + extent).fract();
        }
    }
}

impl SplitState {
    /// Whether species `s` is carried as whole molecules in a voxel.
    #[inline]
    #[must_use]
    pub fn whole(&self, reactor: &Reactor, voxel: usize, s: usize) -> bool {
        match &reactor.hybrid {
            Some(hybrid) => reactor.discrete[s] && self.modes.of(voxel) & hybrid.bit(s) == 0,
            None => reactor.discrete[s],
        }
    }

    /// Lets every hybrid species change over where its number asks for it.
    pub fn change_over(&mut self, reactor: &Reactor, frozen: &Frozen) {
        let Some(hybrid) = &reactor.hybrid else { return };
        let (count, voxels) = (reactor.species_count(), frozen.voxels());
        let mut leaving: Vec<Vec<u32>> = vec![Vec::new(); hybrid.species.len()];
        self.modes.looks += 1;
        for i in 0..voxels {
            let before = self.modes.mode[i];
            let mut after = before;
            for (k, &s) in hybrid.species.iter().enumerate() {
                let (n, bit) = (self.amounts[i * count + s], 1 << k);
                if before & bit == 0 && n >= hybrid.above {
                    after |= bit;
                    self.modes.changes[k * voxels + i][0] += 1;
                } else if before & bit != 0 && n < hybrid.below {
                    after &= !bit;
                    leaving[k].push(i as u32);
                    self.modes.changes[k * voxels + i][1] += 1;
                }
                self.modes.continuous[k * voxels + i] += u32::from(after & bit != 0);
            }
            if after != before {
                self.round_events(reactor, frozen, i, (before, after));
                self.modes.mode[i] = after;
            }
        }
        for (k, leaving) in leaving.iter().enumerate() {
            self.round_amounts(hybrid, frozen, k, leaving);
        }
    }

    /// Rounds the extents of the reactions of voxel `i` that are sampled from now on.
    fn round_events(&mut self, reactor: &Reactor, frozen: &Frozen, i: usize, (before, after): (u8, u8)) {
        let count = reactor.species_count();
        let lists = &frozen.kinds[frozen.kind[i] as usize].lists;
        let (old, new) = (&lists[usize::from(before)], &lists[usize::from(after)]);
        for &r in old.integrated.iter().filter(|r| new.sampled.contains(r)) {
            let r = r as usize;
            let broken = std::mem::take(&mut self.modes.broken[i * reactor.propensities.len() + r]);
            let up = self.changing.random::<f64>() < broken;
            let changes = reactor.propensities.changes(r);
            // An amount that is all but used up decides the other way.
            let fits =
                |by: f64| changes.iter().all(|&(s, c)| self.amounts[i * count + s as usize] + c * by >= 0.0);
            let ways = if up { [1.0 - broken, -broken] } else { [-broken, 1.0 - broken] };
            let Some(by) = ways.into_iter().find(|&by| fits(by)) else { continue };
            for &(s, c) in changes {
                let slot = i * count + s as usize;
                if frozen.is_held(slot) {
                    self.supplied[s as usize] -= c * by;
                } else {
                    self.amounts[slot] += c * by;
                }
            }
            self.modes.extents[r] += by;
        }
    }

    /// Makes the amounts of hybrid species number `k` whole in the voxels `leaving` (systematic sampling of the
    /// broken parts: each is rounded up with a chance equal to it, and their sum is kept to within one, which
    /// another voxel takes up).
    fn round_amounts(&mut self, hybrid: &Hybrid, frozen: &Frozen, k: usize, leaving: &[u32]) {
        let s = hybrid.species[k];
        let count = self.supplied.len();
        if leaving.is_empty() && self.modes.left_over[s] == 0.0 {
            return;
        }
        let (mut sum, offset) = (0.0_f64, self.changing.random::<f64>());
        for slot in leaving.iter().map(|&i| i as usize * count + s).filter(|&slot| !frozen.is_held(slot)) {
            let n = self.amounts[slot];
            let whole = (n + ROUNDING).floor();
            let broken = (n - whole).max(0.0);
            let up = (sum + broken + offset).floor() - (sum + offset).floor();
            sum += broken;
            self.amounts[slot] = whole + up;
            self.modes.left_over[s] += n - (whole + up);
        }
        let taker = (0..frozen.voxels())
            .filter(|&i| self.modes.mode[i] >> k & 1 == 1 && !frozen.is_held(i * count + s))
            .max_by(|&a, &b| self.amounts[a * count + s].total_cmp(&self.amounts[b * count + s]));
        if let Some(i) = taker {
            self.amounts[i * count + s] += std::mem::take(&mut self.modes.left_over[s]);
            return;
        }
        // Nobody is left to take a part of a molecule up; whole ones find their place among the voxels that left.
        for slot in leaving.iter().map(|&i| i as usize * count + s).filter(|&slot| !frozen.is_held(slot)) {
            let whole = (self.modes.left_over[s] + ROUNDING.copysign(self.modes.left_over[s])).trunc();
            let whole = whole.max(-self.amounts[slot]);
            self.amounts[slot] += whole;
            self.modes.left_over[s] -= whole;
        }
    }
}
