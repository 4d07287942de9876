//! What the fluid does to solids.

use crate::fluid::flow::Flow;
use crate::vector::Vector;

/// The force of the fluid on one particle of a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction<const D: usize> {
    /// Index of the particle in [`Setup::particles`](crate::fluid::Setup).
    pub id: u32,
    pub body: u8,
    /// Where it is, m, inside the box.
    pub position: Vector<D>,
    /// Force per unit thickness, N/m^(3-D).
    pub force: Vector<D>,
}

impl<const D: usize> Flow<D> {
    /// Asks for the reaction of the fluid on the solid `body` from the next step on; a body that does not exist
    /// changes nothing. A body that nobody asks for costs nothing. What is taken from the momentum that the shift carries next to
    /// bodies that move as told ([`Setup::bounds_drift`](crate::fluid::Setup::bounds_drift)) is no part of it.
    pub fn ask_for_reaction(&mut self, body: u8) {
        if let Some(asks) = self.asks.get_mut(body as usize) {
            *asks = true;
        }
    }

    /// The forces of the last step on the particles of the solids that were asked for, pair by pair the opposite of what
    /// the fluid got; the body force on the fluid is not among them.
    pub fn reactions(&self) -> impl Iterator<Item = Reaction<D>> + '_ {
        let asked = |i: &&u32| self.asks[self.sides[**i as usize].body as usize];
        self.solids.iter().filter(asked).map(|&i| {
            let (side, rates) = (&self.sides[i as usize], &self.rates[i as usize]);
            let position = self.domain.wrap(&self.positions[i as usize]);
            Reaction { id: side.id, body: side.body, position, force: rates.force * side.volume }
        })
    }
}
