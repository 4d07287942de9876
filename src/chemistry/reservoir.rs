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
    /// each molecule goes with probability p. Hybrid: where a donor holds a real amount the new voxel does, until it
    /// changes over. A donor that is `held` stays as it is, and what comes from it is booked, unless the new voxel is
    /// held too. A species that cannot live in the home group of the new voxel stays where it is, and so does what is not
    /// held where the new voxel is.
    pub fn divide(
        &mut self,
        reactor: &Reactor,
        held: &[bool],
        (voxel, home): (usize, u8),
        donors: &[(usize, f64)],
    ) {
        let count = self.supplied.len();
        let held = |slot: usize| held.get(slot).copied().unwrap_or(false);
        for species in (0..count).filter(|&s| reactor.habitat[s].holds(home)) {
            let new = voxel * count + species;
            for &(donor, part) in donors {
                let slot = donor * count + species;
                if held(new) && !held(slot) {
                    continue;
                }
                let there = self.amounts[slot];
                let taken = if self.whole(reactor, donor, species) {
                    binomial(&mut self.reservoirs, there as u64, part) as f64
                } else {
                    let bit = reactor.hybrid.as_ref().map_or(0, |hybrid| hybrid.bit(species));
                    self.modes.flow_in(voxel, bit);
                    there * part
                };
                self.amounts[new] += taken;
                if held(slot) && !held(new) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::links::Links;
    use crate::chemistry::network::Kinetics;
    use crate::chemistry::reactor::example::network;

    /// Two donors and a voxel that comes into being; one hybrid species, continuous from 100 molecules, discrete below 40.
    fn three(amounts: [f64; 3]) -> (Reactor, Frozen, SplitState) {
        let network = network(Kinetics::Molecules, 1, &[]);
        let reactor = Reactor::everywhere(&network, &[true]).with_hybrid(&network, vec![0], 100.0, 40.0);
        let frozen = Frozen::build(&reactor, &Links::none(3), &[1e-18; 3], &[0; 3], &[0; 3], &[]).unwrap();
        let mut state = SplitState::new(&reactor, amounts.to_vec(), 5, 0);
        state.change_over(&reactor, &frozen);
        (reactor, frozen, state)
    }

    #[test]
    fn a_voxel_born_of_real_amounts_holds_one_until_it_changes_over() {
        for (parts, stays) in [([0.25, 0.25], true), ([0.03, 0.25], false)] {
            let (reactor, frozen, mut state) = three([301.0, 7.0, 0.0]);
            assert!(!state.whole(&reactor, 0, 0) && state.whole(&reactor, 1, 0));
            state.divide(&reactor, &[], (2, 0), &[(0, parts[0]), (1, parts[1])]);
            assert!(!state.whole(&reactor, 2, 0) && state.amounts[2] >= 301.0 * parts[0]);
            // Nothing is lost by division, nor by rounding; what is discrete is whole.
            assert!((state.total(0) - 308.0).abs() < 1e-12 && state.amounts[1].fract() == 0.0);
            state.change_over(&reactor, &frozen);
            assert_eq!(!state.whole(&reactor, 2, 0), stays);
            assert!(stays || state.amounts[2].fract() == 0.0, "{:?}", state.amounts);
            assert!((state.total(0) - 308.0).abs() < 1e-12, "{:?}", state.amounts);
        }
        // Born of whole molecules it holds whole ones.
        let (reactor, _, mut state) = three([9.0, 7.0, 0.0]);
        state.divide(&reactor, &[], (2, 0), &[(0, 0.5), (1, 0.5)]);
        assert!(state.whole(&reactor, 2, 0) && state.amounts.iter().all(|n| n.fract() == 0.0));
        assert_eq!(state.total(0), 16.0);
    }

    #[test]
    fn held_amounts_are_shared_out_with_a_voxel_that_is_held_too() {
        let (reactor, _, mut state) = three([301.0, 300.0, 0.0]);
        state.divide(&reactor, &[true, true, true], (2, 0), &[(0, 0.25), (1, 0.25)]);
        assert_eq!((state.amounts.as_slice(), state.supplied[0]), (&[225.75, 225.0, 150.25][..], 0.0));
        let (reactor, _, mut state) = three([301.0, 300.0, 0.0]);
        state.divide(&reactor, &[true, false, false], (2, 0), &[(0, 0.25), (1, 0.25)]);
        assert_eq!((state.amounts.as_slice(), state.supplied[0]), (&[301.0, 225.0, 150.25][..], 75.25));
        // Into what is held comes nothing that is not.
        let (reactor, _, mut state) = three([301.0, 300.0, 0.0]);
        state.divide(&reactor, &[true, false, true], (2, 0), &[(0, 0.25), (1, 0.25)]);
        assert_eq!((state.amounts.as_slice(), state.supplied[0]), (&[225.75, 300.0, 75.25][..], 0.0));
    }
}
