//! Reservoirs: amounts that are held, sponges that pull an amount towards a target at a given rate, and what crosses
//! an open end.

use crate::chemistry::reactor::Reactor;
use crate::chemistry::sampling_numbers::{binomial, poisson};
use crate::chemistry::split::{Frozen, SplitState};

impl SplitState {
    /// Sets held amounts of `species` in `voxels` to `amounts` (molecules), by which they emit from now on;
    /// the change is booked.
    pub fn hold(&mut self, voxels: &[u32], species: usize, amounts: &[f64]) {
        for (&voxel, &amount) in voxels.iter().zip(amounts) {
            self.put(voxel, species, amount);
            self.emit_by(voxel as usize * self.supplied.len() + species, f64::NAN);
        }
    }

    /// Redraws held amounts of `species` in `voxels` as Poisson numbers of the given `means`, and lets them
    /// emit by those means, so that hops out of the reservoir are a Poisson process of constant rate and a
    /// linear network stays exactly Poisson. Continuous amounts become the mean itself.
    pub fn deal_held(&mut self, reactor: &Reactor, voxels: &[u32], species: usize, means: &[f64]) {
        for (&voxel, &mean) in voxels.iter().zip(means) {
            let whole = self.whole(reactor, voxel as usize, species);
            let amount = if whole { poisson(&mut self.reservoirs, mean) as f64 } else { mean };
            self.put(voxel, species, amount);
            self.emit_by(voxel as usize * self.supplied.len() + species, mean);
        }
    }

    /// Relaxes `species` in `voxels` towards `targets` (molecules) at `rate` (1/s) over `dt` seconds.
    ///
    /// Discrete: the exact transition of immigration and death, n -> Binomial(n, e^{-rate dt}) +
    /// Poisson(target (1 - e^{-rate dt})), which keeps a Poisson number Poisson. Continuous: the exponential.
    /// Held amounts stay; the change is booked in `supplied`.
    pub fn sponge(
        &mut self,
        (reactor, frozen): (&Reactor, &Frozen),
        voxels: &[u32],
        species: usize,
        (rate, targets): (f64, &[f64]),
        dt: f64,
    ) {
        let gone = -(-rate * dt).exp_m1();
        for (&voxel, &target) in voxels.iter().zip(targets) {
            let slot = voxel as usize * self.supplied.len() + species;
            if frozen.is_held(slot) {
                continue;
            }
            let before = self.amounts[slot];
            let after = if self.whole(reactor, voxel as usize, species) {
                let random = &mut self.reservoirs;
                before - binomial(random, before as u64, gone) as f64 + poisson(random, target * gone) as f64
            } else {
                before + (target - before) * gone
            };
            self.put(voxel, species, after);
        }
    }

    /// Takes all molecules out of `voxels`, which leave the domain; booked in `supplied`.
    pub fn empty(&mut self, voxels: &[u32]) {
        for &voxel in voxels {
            for species in 0..self.supplied.len() {
                self.put(voxel, species, 0.0);
            }
        }
    }

    /// Puts Poisson numbers of the given `means` of `species` into `voxels`, which enter the domain; continuous amounts
    /// become the mean itself. Booked in `supplied`.
    pub fn enter(&mut self, reactor: &Reactor, voxels: &[u32], species: usize, means: &[f64]) {
        for (&voxel, &mean) in voxels.iter().zip(means) {
            let whole = self.whole(reactor, voxel as usize, species);
            let amount = if whole { poisson(&mut self.reservoirs, mean) as f64 } else { mean };
            self.put(voxel, species, amount);
        }
    }

    /// Molecules that a voxel takes from others as it comes into being: of donor d the part p of all it holds. Discrete:
    /// each molecule goes with probability p. What is `held` stays, and what comes from it is booked.
    pub fn divide(&mut self, reactor: &Reactor, held: &[bool], voxel: usize, donors: &[(usize, f64)]) {
        let count = self.supplied.len();
        for species in 0..count {
            for &(donor, part) in donors {
                let slot = donor * count + species;
                let there = self.amounts[slot];
                let taken = if self.whole(reactor, donor, species) {
                    binomial(&mut self.reservoirs, there as u64, part) as f64
                } else {
                    there * part
                };
                self.amounts[voxel * count + species] += taken;
                if held.get(slot).copied().unwrap_or(false) {
                    self.supplied[species] += taken;
                } else {
                    self.amounts[slot] -= taken;
                }
            }
        }
    }

    fn put(&mut self, voxel: u32, species: usize, amount: f64) {
        let slot = voxel as usize * self.supplied.len() + species;
        self.supplied[species] += amount - self.amounts[slot];
        self.amounts[slot] = amount;
    }
}
