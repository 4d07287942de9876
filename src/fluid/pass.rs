//! The sweeps over pairs: densities first, forces after, each particle summing its own row in a fixed order.
//!
//! Two sweeps a step because the pressure needs the new density (taken from the half step it feeds sound
//! waves). The first keeps the pairs it found for the second.

use crate::fluid::domain::Shortest;
use crate::fluid::kernel::Kernel;
use crate::fluid::neighbours::Block;
use crate::fluid::particles::Side;
use crate::fluid::terms::{Continuity, DensityDiffusion, Pressure, Shift, TransportStress, Viscosity};
use crate::vector::Vector;

/// The geometry of a pair: x = x_i - x_j (m) and F (m^-(D+2)); the gradient of W is -F x.
#[derive(Clone, Copy, Debug)]
pub struct Pair<const D: usize> {
    pub x: Vector<D>,
    pub f: f64,
    /// F of the shift's own kernel.
    pub f_shift: f64,
}

/// A pair within the cut-off as the density sweep leaves it for what follows.
#[derive(Clone, Copy, Debug)]
pub struct Contact<const D: usize> {
    /// x_i - x_j, m.
    pub x: Vector<D>,
    /// F in the row of a fluid particle, W in that of a solid one.
    pub weight: f64,
    /// F of the shift's own kernel, in the row of a fluid particle.
    pub f_shift: f64,
    pub j: u32,
}

/// What the sweeps find for one particle.
#[derive(Clone, Copy, Debug)]
pub struct Rates<const D: usize> {
    /// kg/m³/s.
    pub density: f64,
    /// Volume fraction of solid, itself included among the fluid.
    pub fraction: f64,
    /// Force per volume, N/m³.
    pub force: Vector<D>,
    /// Σ 2 V_j F x_ij, 1/m.
    pub crowding: Vector<D>,
    /// Where a wall sends the particle, less where it is, m.
    pub correction: Vector<D>,
}

impl<const D: usize> Default for Rates<D> {
    fn default() -> Rates<D> {
        let none = Vector::zeros();
        Rates { density: 0.0, fraction: 0.0, force: none, crowding: none, correction: none }
    }
}

/// The physics of a flow. Optional physics is an `Option`: pair noise of a fluctuating fluid, for one, is a
/// field `thermal_noise: Option<ThermalNoise>` here and one line in [`Terms::forces`].
pub struct Terms<const D: usize> {
    pub continuity: Continuity,
    pub density_diffusion: Option<DensityDiffusion>,
    pub pressure: Pressure,
    pub viscosity: Viscosity,
    pub transport_stress: Option<TransportStress>,
    pub shift: Option<Shift<D>>,
}

impl<const D: usize> Terms<D> {
    /// The density rate of i from j, kg/m³/s.
    #[inline(always)]
    pub fn density(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, out: &mut f64) {
        self.continuity.pair(p, i, j, out);
        if let Some(diffusion) = &self.density_diffusion {
            diffusion.pair(p, i, j, out);
        }
    }

    /// The force per volume on i from j, N/m³, and its crowding.
    #[inline(always)]
    pub fn forces(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, out: &mut Rates<D>) {
        self.pressure.pair(p, i, j, out);
        self.viscosity.pair(p, i, j, out);
        if let Some(stress) = &self.transport_stress {
            stress.pair(p, i, j, out);
        }
        if let Some(shift) = &self.shift {
            shift.pair(p, j, out);
        }
    }
}

/// First sweep over a block: finds the contacts, sums density rates and volume fractions of solid,
/// phi_i = Σ_solid V_j W / Σ_all V_j W, i itself included; SPH-BVF Eq. (45). Leaving i out would put every
/// particle of an inner corner inside the wall.
pub fn sweep_densities<const D: usize>(
    block: &mut Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    shortest: &Shortest<D>,
    positions: &[Vector<D>],
    sides: &[Side<D>],
) {
    let limit = kernel.cutoff() * kernel.cutoff();
    // Taken out so that the candidates can be read while contacts are written.
    let mut contacts = std::mem::take(&mut block.contacts);
    let mut ends = std::mem::take(&mut block.contact_ends);
    contacts.clear();
    ends.clear();
    for (row, rates) in rates.iter_mut().enumerate() {
        let i = block.first + row;
        let (here, side) = (positions[i], sides[i]);
        let start = contacts.len();
        for &j in block.candidates(row) {
            let x = shortest.separation(&here, &positions[j as usize]);
            let r2 = x.norm_squared();
            if r2 < limit {
                contacts.push(Contact { x, weight: r2, f_shift: 0.0, j });
            }
        }
        let mine = &mut contacts[start..];
        rates.density = 0.0;
        rates.fraction = 0.0;
        if side.is_solid() {
            for c in mine.iter_mut() {
                c.weight = kernel.value(c.weight.sqrt());
            }
            rates.fraction = 1.0;
        } else {
            if block.near_solid[row] {
                let mut all = side.volume * kernel.value(0.0);
                let mut solid = 0.0;
                for c in mine.iter() {
                    let other = &sides[c.j as usize];
                    let share = other.volume * kernel.value(c.weight.sqrt());
                    all += share;
                    if other.is_solid() {
                        solid += share;
                    }
                }
                rates.fraction = solid / all;
            }
            for c in mine.iter_mut() {
                let r = c.weight.sqrt();
                c.weight = kernel.f(r);
                if let Some(shift) = &terms.shift {
                    c.f_shift = shift.f(r);
                }
                let pair = Pair { x: c.x, f: c.weight, f_shift: c.f_shift };
                terms.density(&pair, &side, &sides[c.j as usize], &mut rates.density);
            }
        }
        ends.push(contacts.len() as u32);
    }
    block.contacts = contacts;
    block.contact_ends = ends;
}

/// Second sweep over a block: forces and crowding of the fluid particles, from the contacts of the first.
pub fn sweep_forces<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    sides: &[Side<D>],
) {
    for (row, rates) in rates.iter_mut().enumerate() {
        let side = sides[block.first + row];
        let mut sum = Rates { density: rates.density, fraction: rates.fraction, ..Rates::default() };
        if !side.is_solid() {
            for c in block.row(row) {
                let pair = Pair { x: c.x, f: c.weight, f_shift: c.f_shift };
                terms.forces(&pair, &side, &sides[c.j as usize], &mut sum);
            }
        }
        *rates = sum;
    }
}
