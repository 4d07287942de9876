//! How much of the momentum that the drift carries counts next to solids.
//!
//! The drift w carries momentum by pairs, and so without loss: ∇·(ρ v⊗w), Adami, Hu & Adams 2013
//! ([`TransportStress`](crate::fluid::terms::TransportStress)). Particles keep their mass, so of this only ρ w·∇v belongs to the
//! equation of motion; ρ v ∇·w vanishes on average. But where walls disturb the particles, velocities grow by it while particles
//! part, and only friction holds them: a cavity of 100² at Re = 10 000 blew up after 1.4 L/U. Next to solids of which nobody
//! asks what momentum they take, ∇·w counts no more than friction can hold. At Re = 1000 that concerns one particle in a
//! thousand there.

use crate::fluid::blocks::Block;
use crate::fluid::particles::{Material, Side, Slopes};
use crate::fluid::pass::Rates;

/// Largest |∇·w|, in units of the rate at which friction would stop a particle among others at rest. While it starts, a cavity
/// of 100² at Re = 10 000 comes to 1.2 times the speed of its lid with ½.
const HELD: f64 = 0.5;

/// Takes ρ v (∇·w less what friction holds) (N/m³) from the force on the particles of a block next to solids. ∇·w is the sum
/// by which the transport stress of a uniform v would differ from zero.
pub(super) fn bound<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    (sides, slopes): (&[Side<D>], &[Slopes<D>]),
) {
    for (row, rates) in rates.iter_mut().enumerate() {
        let i = &sides[block.first + row];
        if i.is_solid() || slopes[block.first + row].clear {
            continue;
        }
        let (mut parting, mut around) = (0.0, 0.0);
        // A particle next to solids has all its fluid neighbours in the outer list.
        for c in block.outer.row(row) {
            let j = &sides[c.j as usize];
            let strength = j.volume * c.weight;
            parting -= strength * (i.drift + j.drift).dot(&c.x);
            around += strength;
        }
        for c in block.walls.row(row) {
            let j = &sides[c.j as usize];
            if j.material != Material::FreeSlip {
                around += j.volume * c.weight;
            }
        }
        // Σ 2 V_j F ν.
        let most = HELD * 2.0 * around * i.viscosity * i.inverse_density;
        rates.force -= i.velocity * (i.density * (parting - parting.clamp(-most, most)));
    }
}
