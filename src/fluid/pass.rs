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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::kernel::KernelKind;
    use crate::fluid::particles::Material;
    use rand::{Rng, SeedableRng};

    type V = Vector<3>;

    /// Two fluid particles of any state and the pair seen from both.
    fn pairs() -> Vec<(Side<3>, Side<3>, Pair<3>)> {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(29);
        let kernel = Kernel::<3>::new(KernelKind::Lucy, 1.0);
        (0..50)
            .map(|_| {
                let mut any = || random.random::<f64>();
                let mut vector = || V::from_fn(|_, _| 0.8 * any() - 0.4);
                let (x, a, b, c, d) = (vector(), vector(), vector(), vector(), vector());
                let mut side = |velocity, drift| Side {
                    velocity,
                    drift,
                    density: 0.5 + any(),
                    pressure: any() - 0.5,
                    volume: 0.1 + any(),
                    viscosity: 0.1 + any(),
                    material: Material::Fluid,
                    body: 0,
                };
                let f = kernel.f(x.norm());
                (side(a, b), side(c, d), Pair { x, f, f_shift: f })
            })
            .collect()
    }

    /// Force of one term on i (times V_i) plus that on j (times V_j), relative to their size.
    fn residue(term: impl Fn(&Pair<3>, &Side<3>, &Side<3>, &mut Rates<3>)) -> f64 {
        let mut worst = 0.0_f64;
        for (i, j, pair) in pairs() {
            let back = Pair { x: -pair.x, ..pair };
            let (mut on_i, mut on_j) = (Rates::default(), Rates::default());
            term(&pair, &i, &j, &mut on_i);
            term(&back, &j, &i, &mut on_j);
            let (a, b) = (on_i.force * i.volume, on_j.force * j.volume);
            if a.norm() > 0.0 {
                worst = worst.max((a + b).norm() / a.norm());
            }
        }
        worst
    }

    #[test]
    fn every_force_is_antisymmetric() {
        // Rounding of a dozen operations.
        assert!(residue(|p, i, j, out| Pressure.pair(p, i, j, out)) < 1e-14);
        assert!(residue(|p, i, j, out| Viscosity.pair(p, i, j, out)) < 1e-14);
        assert!(residue(|p, i, j, out| TransportStress.pair(p, i, j, out)) < 1e-13);
    }

    #[test]
    fn density_diffusion_keeps_the_mass_sum_and_stays_in_its_material() {
        let diffusion = DensityDiffusion { strength: 0.3 };
        for (i, mut j, pair) in pairs() {
            let back = Pair { x: -pair.x, ..pair };
            let (mut to_i, mut to_j) = (0.0, 0.0);
            diffusion.pair(&pair, &i, &j, &mut to_i);
            diffusion.pair(&back, &j, &i, &mut to_j);
            // Rounding of four products.
            assert!((to_i * i.volume + to_j * j.volume).abs() <= 1e-15 * to_i.abs());
            j.body = 1;
            let before = to_i;
            diffusion.pair(&pair, &i, &j, &mut to_i);
            assert_eq!(to_i, before);
        }
    }

    #[test]
    fn a_free_slip_solid_has_no_friction_and_a_no_slip_one_that_of_the_fluid() {
        for (i, mut j, pair) in pairs() {
            let (mut free, mut stuck) = (Rates::default(), Rates::default());
            j.material = Material::FreeSlip;
            Viscosity.pair(&pair, &i, &j, &mut free);
            assert_eq!(free.force, V::zeros());
            j.material = Material::NoSlip;
            Viscosity.pair(&pair, &i, &j, &mut stuck);
            let expected = (j.velocity - i.velocity) * (2.0 * j.volume * i.viscosity * pair.f);
            // The same products in another order.
            assert!((stuck.force - expected).norm() <= 1e-15 * expected.norm());
        }
    }

    #[test]
    fn expansion_lowers_the_density_at_the_rate_of_its_divergence() {
        // v = x on a cubic lattice: d rho/dt = -rho div v = -3 rho, up to the lattice sum of Lucy at h = 3.
        let kernel = Kernel::<3>::new(KernelKind::Lucy, 3.0);
        let side = |velocity| Side {
            velocity,
            drift: V::zeros(),
            density: 2.0,
            pressure: 0.0,
            volume: 1.0,
            viscosity: 1.0,
            material: Material::Fluid,
            body: 0,
        };
        let centre = side(V::zeros());
        let mut rate = 0.0;
        for index in 0..343 {
            let place = V::new(f64::from(index % 7), f64::from(index / 7 % 7), f64::from(index / 49))
                - V::from_element(3.0);
            if place != V::zeros() {
                let f = kernel.f(place.norm());
                Continuity.pair(&Pair { x: -place, f, f_shift: f }, &centre, &side(place), &mut rate);
            }
        }
        assert!((rate / -6.0 - 1.0).abs() < 0.01, "{rate}");
    }
}
