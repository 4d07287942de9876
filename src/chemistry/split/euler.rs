//! Forward Euler on diffusion and reactions together, as the published tables of the sSSA-SDPD hybrid were made.

use super::SplitState;
use super::frozen::Frozen;
use crate::chemistry::reactor::Reactor;
use crate::error::RunError;

impl SplitState {
    /// One step n ← n + dt (Q n + Σ_r change_r v_r(n)) of all species, which must be continuous. Held amounts
    /// stay as they are, and `supplied` books what the step would have changed of them. First order in `dt`.
    ///
    /// # Errors
    /// A rate that is negative or not finite, and an amount that falls below zero: the step is too long.
    pub fn euler(&mut self, reactor: &Reactor, frozen: &Frozen, time: f64, dt: f64) -> Result<(), RunError> {
        let species = reactor.species_count();
        let mut change = std::mem::take(&mut self.propensities);
        change.clear();
        change.resize(self.amounts.len(), 0.0);
        for s in 0..species {
            let Some(table) = frozen.ways(s) else { continue };
            let rate = reactor.diffusivity[s] * table.rate * dt;
            for i in 0..table.voxels() {
                let slot = i * species + s;
                let amount = if frozen.is_held(slot) { self.emission(slot) } else { self.amounts[slot] };
                if amount == 0.0 {
                    continue;
                }
                for (j, p) in table.row(i).filter(|&(j, _)| j != i) {
                    let moved = amount * rate * p;
                    change[slot] -= moved;
                    if j < table.voxels() {
                        change[j * species + s] += moved;
                    }
                }
            }
            for door in frozen.baths(s, |_| 0.0).iter().filter(|door| door.mean > 0.0) {
                for (j, p) in table.row(door.node as usize) {
                    change[j * species + s] += door.mean * rate * p;
                }
            }
        }
        for i in 0..frozen.voxels() {
            // Without hybrid species there is one mode.
            let lists = &frozen.kinds[frozen.kind[i] as usize].lists[0];
            let row = &self.amounts[i * species..(i + 1) * species];
            for r in lists.integrated.iter().map(|&r| r as usize) {
                let flux = reactor.propensities.flux_at(r, row, frozen.scales[i]) * frozen.weight(r, i);
                if !(0.0..f64::INFINITY).contains(&flux) {
                    return Err(reactor.bad_propensity(r, flux, time, i, row));
                }
                for &(s, by) in reactor.propensities.changes(r) {
                    change[i * species + s as usize] += dt * by * flux;
                }
            }
        }
        for (slot, &by) in change.iter().enumerate() {
            if frozen.is_held(slot) {
                self.supplied[slot % species] -= by;
                continue;
            }
            let count = self.amounts[slot] + by;
            if !(0.0..f64::INFINITY).contains(&count) {
                let (voxel, species) = (slot / species, reactor.species[slot % species].clone());
                let event = format!("a step of forward Euler of {dt:.3e} s; make chemistry.step shorter");
                return Err(RunError::NegativeCount { time, voxel, species, count, event });
            }
            self.amounts[slot] = count;
        }
        self.propensities = change;
        Ok(())
    }
}

/// Step of forward Euler beyond which diffusion certainly grows without bound, s: two over the largest rate at
/// which a molecule leaves its voxel, as the largest eigenvalue is no smaller than that rate. Up to half of it no
/// amount can fall below zero; between the two, one that does stops the run.
#[must_use]
pub fn longest_euler_step(reactor: &Reactor, frozen: &Frozen) -> f64 {
    (0..reactor.species_count())
        .filter_map(|s| Some(2.0 / (reactor.diffusivity[s] * frozen.ways(s)?.rate)))
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::links::Links;
    use crate::chemistry::network::Kinetics;
    use crate::chemistry::reactor::example::network;

    /// A voxel held at 8 of S0 feeds another; there S0 + S1 -> 0 at 0.25.
    fn pair() -> (Reactor, Frozen, SplitState) {
        let mut network = network(Kinetics::Molecules, 2, &[(&[(0, 1), (1, 1)], &[], 0.25)]);
        network.species[0].diffusion = 1.0;
        let reactor = Reactor::everywhere(&network, &[false, false]);
        let links = Links::from_pairs(2, &[(0, 1, 0.5)]);
        let held = [true, false, false, false];
        let frozen = Frozen::build(&reactor, &links, &[1.0, 1.0], &[0; 2], &[0; 2], &held).unwrap();
        let state = SplitState::new(&reactor, vec![8.0, 0.0, 2.0, 1.0], 1, 0);
        (reactor, frozen, state)
    }

    #[test]
    fn one_step_by_hand() {
        let (reactor, frozen, mut state) = pair();
        assert_eq!(longest_euler_step(&reactor, &frozen), 4.0);
        state.euler(&reactor, &frozen, 0.0, 0.5).unwrap();
        // In: 0.5 (0.5 * 8 - 0.5 * 2) = 1.5; used up: 0.5 * 0.25 * 2 * 1 = 0.25.
        assert_eq!(state.amounts, [8.0, 0.0, 3.25, 0.75]);
        assert_eq!(state.supplied, [1.5, 0.0]);
    }

    #[test]
    fn a_step_that_is_too_long_is_an_error() {
        let (reactor, frozen, mut state) = pair();
        state.amounts = vec![0.0, 0.0, 20.0, 1.0];
        let error = state.euler(&reactor, &frozen, 0.0, 0.5).unwrap_err();
        assert!(error.to_string().contains("make chemistry.step shorter"), "{error}");
    }
}
