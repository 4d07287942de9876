//! Neighbours of particles that move: lists that hold a little more than the cut-off, made anew when it is used up.

use crate::space::{Domain, Grid};
use crate::vector::Vector;

/// What the lists hold beyond the cut-off, in cut-offs.
const SKIN: f64 = 0.2;

/// Lists of neighbours, particle by particle.
#[derive(Clone, Debug, Default)]
pub(super) struct Nearby<const D: usize> {
    cutoff: f64,
    offsets: Vec<u32>,
    list: Vec<u32>,
    /// Where the particles were when the lists were made, m.
    before: Vec<Vector<D>>,
}

impl<const D: usize> Nearby<D> {
    /// Of particles at `positions` (m) with a cut-off (m).
    pub(super) fn new(positions: &[Vector<D>], domain: &Domain<D>, cutoff: f64) -> Nearby<D> {
        let mut near = Nearby { cutoff, offsets: Vec::new(), list: Vec::new(), before: Vec::new() };
        near.make(positions, domain);
        near
    }

    /// Makes the lists anew if two particles could have come within the cut-off unseen.
    pub(super) fn renew(&mut self, positions: &[Vector<D>], domain: &Domain<D>) {
        let far = 0.5 * SKIN * self.cutoff;
        if positions.iter().zip(&self.before).any(|(x, before)| (x - before).norm_squared() > far * far) {
            self.make(positions, domain);
        }
    }

    pub(super) fn make(&mut self, positions: &[Vector<D>], domain: &Domain<D>) {
        let grid = Grid::build(positions, domain, (1.0 + SKIN) * self.cutoff);
        self.offsets.clear();
        self.list.clear();
        self.offsets.push(0);
        for (i, place) in positions.iter().enumerate() {
            let start = self.list.len();
            grid.for_each_near(place, positions, |j, _, _| {
                if j != i {
                    self.list.push(j as u32);
                }
            });
            self.list[start..].sort_unstable();
            self.offsets.push(self.list.len() as u32);
        }
        self.before = positions.to_vec();
    }

    /// Whoever may be near particle `i`, in rising order.
    #[inline(always)]
    pub(super) fn of(&self, i: usize) -> &[u32] {
        &self.list[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }
}
