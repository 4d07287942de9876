//! What must be kept of a flow to go on with it later, to the bit.
//!
//! Neighbour lists are part of it: they were built from places that are past, and their order is that of the sums.

use crate::fluid::blocks::Block;
use crate::fluid::elastic::Kept;
use crate::fluid::flow::{Flow, Tally};
use crate::fluid::motion::Motion;
use crate::fluid::open::Zone;
use crate::fluid::particles::{Own, Side, Slopes};
use crate::fluid::rigid::Rigid;
use crate::fluid::setup::BodyKind;
use crate::vector::Vector;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Of an open flow, by number of the particle: where it is, how often it came in and by which end.
type Ends = (Vec<Zone>, Vec<(u32, u8)>);

/// The state of a flow between two steps; what follows from its setup is left out.
#[derive(Serialize, Deserialize)]
pub struct Image<'a, const D: usize> {
    positions: Cow<'a, [Vector<D>]>,
    /// Where the particles were when the lists were built, m.
    listed: Cow<'a, [Vector<D>]>,
    sides: Cow<'a, [Side<D>]>,
    own: Cow<'a, [Own<D>]>,
    slopes: Cow<'a, [Slopes<D>]>,
    blocks: Cow<'a, [Block<D>]>,
    tally: Tally,
    /// Body by body, those that the fluid moves.
    free: Vec<Option<Rigid<D>>>,
    /// Body by body, those that it bends too.
    elastic: Vec<Option<Kept<'a, D>>>,
    open: Option<Ends>,
    travel: f64,
    time: f64,
    steps: u64,
    noise_step: f64,
}

impl<const D: usize> Flow<D> {
    /// The state as it is now.
    #[must_use]
    pub fn image(&self) -> Image<'_, D> {
        let free = |kind: &BodyKind<D>| match kind {
            BodyKind::Solid { motion: Motion::Free(rigid), .. } => Some((**rigid).clone()),
            _ => None,
        };
        let elastic = self.bodies.iter().map(|body| match &body.kind {
            BodyKind::Solid { motion: Motion::Elastic(coupled), .. } => Some(coupled.image()),
            _ => None,
        });
        Image {
            positions: Cow::Borrowed(&self.positions),
            listed: Cow::Borrowed(&self.listed),
            sides: Cow::Borrowed(&self.sides),
            own: Cow::Borrowed(&self.own),
            slopes: Cow::Borrowed(&self.slopes),
            blocks: Cow::Borrowed(&self.blocks),
            tally: self.tally.clone(),
            free: self.bodies.iter().map(|body| free(&body.kind)).collect(),
            elastic: elastic.collect(),
            open: self.openings.as_ref().map(|open| (open.zones.clone(), open.entries.clone())),
            travel: self.travel,
            time: self.time,
            steps: self.steps,
            noise_step: self.noise_step,
        }
    }

    /// Puts a flow of the same setup into the state of an image; `None` if the image belongs to another setup.
    #[must_use]
    pub fn restore(&mut self, image: Image<D>) -> Option<()> {
        let n = self.positions.len();
        let fits = image.positions.len() == n
            && image.listed.len() == n
            && image.sides.len() == n
            && image.own.len() == n
            && image.slopes.len() == self.slopes.len()
            && image.blocks.len() == self.blocks.len()
            && image.free.len() == self.bodies.len()
            && image.elastic.len() == self.bodies.len()
            && image.open.is_some() == self.openings.is_some()
            && image
                .sides
                .iter()
                .all(|side| (side.id as usize) < n && usize::from(side.body) < self.bodies.len());
        if !fits {
            return None;
        }
        self.positions = image.positions.into_owned();
        self.listed = image.listed.into_owned();
        self.sides = image.sides.into_owned();
        self.own = image.own.into_owned();
        self.slopes = image.slopes.into_owned();
        self.blocks = image.blocks.into_owned();
        self.tally = image.tally;
        for (body, saved) in self.bodies.iter_mut().zip(image.free) {
            match (&mut body.kind, saved) {
                (BodyKind::Solid { motion: Motion::Free(rigid), .. }, Some(saved)) => rigid.restore(saved),
                (_, None) => {}
                _ => return None,
            }
        }
        for (body, kept) in self.bodies.iter_mut().zip(image.elastic) {
            match (&mut body.kind, kept) {
                (BodyKind::Solid { motion: Motion::Elastic(coupled), .. }, Some(kept)) => {
                    coupled.restore(kept)?;
                }
                (_, None) => {}
                _ => return None,
            }
        }
        if let (Some(openings), Some((zones, entries))) = (&mut self.openings, image.open) {
            (openings.zones, openings.entries) = (zones, entries);
        }
        (self.travel, self.time, self.steps) = (image.travel, image.time, image.steps);
        self.noise_step = image.noise_step;
        self.solids = (0..n as u32).filter(|&i| self.sides[i as usize].is_solid()).collect();
        self.note_ends();
        Some(())
    }

    /// Finds and weighs the contacts at the places of now, as the sweep of densities does.
    pub(super) fn find_contacts(&mut self) {
        let (kernel, shortest) = (&self.kernel, &self.shortest);
        let shift = self.terms.shift_kernel();
        let (positions, sides) = (&self.positions, &self.sides);
        self.blocks.par_iter_mut().for_each(|block| block.find(kernel, shift, shortest, (positions, sides)));
    }
}
