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
            let lives = |i: u32| reactor.habitat[s].holds(frozen.home[i as usize]);
            let rates = facing
                .iter()
                .filter(|&&(i, weight)| weight > 0.0 && lives(i))
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
