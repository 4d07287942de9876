//! What surfaces let through, as part of diffusion: the hop table of a species with the doors it has.

use super::frozen::Frozen;
use crate::chemistry::diffusion::{Bath, Door, HopTable};
use crate::chemistry::reactor::Reactor;

/// The doors of one species.
#[derive(Clone, Debug)]
pub(super) struct Passages {
    /// The hops of the species and what its doors take and give.
    table: HopTable,
    /// Of each door the surface reaction it stands for and the mean it sends by, molecules.
    doors: Vec<(u32, f64)>,
}

impl Passages {
    /// Of species `s`, with the surface reactions and the factors of their propensities in the voxels that face the
    /// surface; `None` if none is of this species, or if it does not diffuse.
    pub fn new(
        reactor: &Reactor,
        frozen: &Frozen,
        s: usize,
        surfaces: &[(usize, Vec<(u32, f64)>)],
    ) -> Option<Passages> {
        let base = frozen.table(s)?;
        let mut doors: Vec<(u32, Door)> = Vec::new();
        for (r, facing) in surfaces {
            let Some(&(changed, change)) = reactor.propensities.changes(*r).first() else { continue };
            if changed as usize != s {
                continue;
            }
            let rates = facing
                .iter()
                .filter(|&&(_, weight)| weight > 0.0)
                .map(|&(i, weight)| (i, weight / reactor.diffusivity[s]));
            let mut door = Door::default();
            if change > 0.0 { &mut door.into } else { &mut door.out }.extend(rates);
            doors.push((*r as u32, door));
        }
        if doors.is_empty() {
            return None;
        }
        let (reactions, doors): (Vec<u32>, Vec<Door>) = doors.into_iter().unzip();
        let (table, means) = base.with_doors(&doors);
        Some(Passages { table, doors: reactions.into_iter().zip(means).collect() })
    }
}

impl Frozen {
    /// Where species `s` goes, held voxels and doors apart; `None` if it does not diffuse.
    pub(super) fn ways(&self, s: usize) -> Option<&HopTable> {
        match self.passages.get(s) {
            Some(Some(passages)) => Some(&passages.table),
            _ => self.table(s),
        }
    }

    /// The doors of species `s`: reaction and mean, in the order of the rows of [`Frozen::ways`].
    fn doors(&self, s: usize) -> &[(u32, f64)] {
        match self.passages.get(s) {
            Some(Some(passages)) => &passages.doors,
            _ => &[],
        }
    }

    /// What species `s` meets: its held voxels, which emit by the amount that `emission` tells of a voxel, then its
    /// doors.
    pub(super) fn baths(&self, s: usize, emission: impl Fn(usize) -> f64) -> Vec<Bath> {
        let held = self.held_voxels[s].iter().map(|&h| Bath::new(h as usize, emission(h as usize)));
        let doors = (self.voxels()..).zip(self.doors(s)).map(|(node, &(_, mean))| Bath::new(node, mean));
        held.chain(doors).collect()
    }

    /// The reactions that the doors among the `baths` of species `s` stand for, with what passed.
    pub(super) fn passed<'a>(
        &'a self,
        s: usize,
        baths: &'a [Bath],
    ) -> impl Iterator<Item = (usize, &'a Bath)> {
        let doors = self.doors(s).iter().map(|&(r, _)| r as usize);
        doors.zip(&baths[self.held_voxels[s].len()..])
    }

    /// Net molecules that the held voxels among the `baths` of species `s` emitted.
    pub(super) fn emitted(&self, s: usize, baths: &[Bath]) -> f64 {
        baths[..self.held_voxels[s].len()].iter().map(Bath::emitted).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::Links;
    use crate::chemistry::network::{Kinetics, Rate, Surface, SurfaceKind};
    use crate::chemistry::reactor::example::network;
    use crate::chemistry::split::{SplitState, longest_euler_step};

    /// Three unit cells in a row, the last held at 40 of S0; the surface before the first feeds 12 a second and takes
    /// at 3 a second and molecule, that beside the held one takes at 0.5.
    fn row(discrete: bool) -> (Reactor, Frozen, SplitState) {
        fed(discrete, 12.0)
    }

    /// The same, fed with another number a second.
    fn fed(discrete: bool, feed: f64) -> (Reactor, Frozen, SplitState) {
        let mut network = network(
            Kinetics::Molecules,
            1,
            &[(&[], &[(0, 1)], 1.0), (&[(0, 1)], &[], 1.0), (&[(0, 1)], &[], 1.0)],
        );
        network.species[0].diffusion = 2.0;
        for (number, reaction) in network.reactions.iter_mut().enumerate() {
            let kind = if number == 0 { SurfaceKind::Flux(1.0) } else { SurfaceKind::Absorption(1.0) };
            reaction.rate = Rate::Surface(Surface { number, kind });
        }
        let reactor = Reactor::everywhere(&network, &[discrete]);
        let links = Links::from_pairs(3, &[(0, 1, 1.0), (1, 2, 1.0)]);
        let frozen = Frozen::build(&reactor, &links, &[1.0; 3], &[0; 3], &[0; 3], &[false, false, true])
            .unwrap()
            .with_surfaces(
                &reactor,
                &[0; 3],
                &[(0, vec![(0, feed)]), (1, vec![(0, 3.0)]), (2, vec![(2, 0.5)])],
            );
        let state = SplitState::new(&reactor, vec![0.0, 0.0, 40.0], 1, 0);
        (reactor, frozen, state)
    }

    #[test]
    fn a_step_is_the_limit_of_short_ones_of_euler() {
        let (reactor, frozen, start) = row(false);
        assert!(!frozen.reacts());
        // What leaves the first voxel: 2 by the link, 3 by the surface; the last: 2 and 0.5.
        assert_eq!(longest_euler_step(&reactor, &frozen), 0.4);
        for time in [0.3, 20.0] {
            let (mut whole, mut short) = (start.clone(), start.clone());
            whole.step(&reactor, &frozen, 0.0, time).unwrap();
            let mut error = [0.0; 2];
            for (k, steps) in [4000, 8000].into_iter().enumerate() {
                short.clone_from(&start);
                for i in 0..steps {
                    short.euler(&reactor, &frozen, f64::from(i), time / f64::from(steps)).unwrap();
                }
                let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>();
                error[k] = off(&whole.amounts, &short.amounts) + off(&whole.supplied, &short.supplied);
            }
            // First order, in amounts that are of order 10 and a supply of up to 700.
            assert!(error[1] < 0.1 && error[1] < 0.6 * error[0] || error[0] < 1e-9, "{time}: {error:?}");
        }
    }

    #[test]
    fn more_than_can_be_counted_is_an_error() {
        let (reactor, frozen, mut state) = fed(true, 1e18);
        let error = state.diffuse(&reactor, &frozen, 0.0, 1.0).unwrap_err().to_string();
        assert!(error.contains("particle 0") && error.contains("cannot be counted one by one"), "{error}");
        // As real amounts they are no matter.
        let (reactor, frozen, mut state) = fed(false, 1e18);
        state.diffuse(&reactor, &frozen, 0.0, 1.0).unwrap();
    }

    #[test]
    fn whole_molecules_are_booked_to_the_last() {
        let (reactor, frozen, mut state) = row(true);
        // 100 jumps expected: in four pieces.
        for k in 0..50 {
            state.step(&reactor, &frozen, f64::from(k), 20.0).unwrap();
            let free: f64 = state.amounts[..2].iter().sum();
            assert_eq!(free, state.made(&reactor, 0) + state.supplied[0], "{k}");
            assert_eq!(state.amounts[2], 40.0);
        }
        // 1000 s of 12 in by the surface, and out of the held voxel 20 a second: five standard errors, chance 1e-6.
        for (r, rate) in [(0, 12.0), (2, 20.0)] {
            let seen = state.fired[r] as f64;
            assert!((seen - 1000.0 * rate).abs() < 5.0 * (1000.0 * rate).sqrt(), "{r}: {seen}");
        }
        assert_eq!(state.counters.events, state.fired.iter().sum::<u64>());
    }
}
