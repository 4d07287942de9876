//! The sweeps over pairs: densities first, forces after.
//!
//! Two sweeps a step because the pressure needs the new density (taken from the half step it feeds sound
//! waves). The first keeps the pairs it found for the second. A pair of one block is evaluated once and given to
//! both sides; one that crosses blocks is evaluated by both, each for itself, so that no thread writes where
//! another does and the order of every sum is that of the lists.

use crate::fluid::blocks::{Block, Contact};
use crate::fluid::domain::Shortest;
use crate::fluid::kernel::Kernel;
use crate::fluid::noise::ThermalNoise;
use crate::fluid::particles::Side;
use crate::fluid::symmetric::Symmetric;
use crate::fluid::terms::continuity::Spread;
use crate::fluid::terms::{
    Continuity, DensityDiffusion, Moment, Pressure, Shift, TransportStress, Viscosity, viscosity,
};
use crate::vector::Vector;

/// The geometry of a pair: x = x_i - x_j (m) and F (m^-(D+2)); the gradient of W is -F x.
#[derive(Clone, Copy, Debug)]
pub struct Pair<const D: usize> {
    pub x: Vector<D>,
    pub f: f64,
    /// F of the shift's own kernel.
    pub f_shift: f64,
}

/// A pair for the rates of density.
#[derive(Clone, Copy, Debug)]
pub struct Approach<const D: usize> {
    /// x_i - x_j, m.
    pub x: Vector<D>,
    /// m^-(D+2).
    pub f: f64,
    /// v_i - v_j, m/s.
    pub apart: Vector<D>,
    /// (v_i - v_j)·x, the same from both sides; m²/s.
    pub opening: f64,
}

impl<const D: usize> Approach<D> {
    /// The same pair seen from j.
    #[inline(always)]
    #[must_use]
    pub fn back(&self) -> Approach<D> {
        Approach { x: -self.x, apart: -self.apart, ..*self }
    }

    /// F (v_i - v_j)⊗x, the same from both sides.
    #[inline(always)]
    fn spread(&self) -> Spread<D> {
        self.apart * (self.x * self.f).transpose()
    }
}

/// What the sweeps find for one particle.
#[derive(Clone, Copy, Debug)]
pub struct Rates<const D: usize> {
    /// kg/m³/s; of a solid Σ V W over the fluid before it.
    pub density: f64,
    /// Σ V_j F x⊗x.
    pub moment: Symmetric<D>,
    /// Σ V_j F (v_i - v_j)⊗x, 1/s.
    pub spread: Spread<D>,
    /// Force per volume, N/m³.
    pub force: Vector<D>,
    /// Σ 2 V_j F x_ij, 1/m.
    pub crowding: Vector<D>,
    /// Volume fraction of solid, itself included among the fluid.
    pub fraction: f64,
    /// Where a wall sends the particle, less where it is, m.
    pub correction: Vector<D>,
}

impl<const D: usize> Default for Rates<D> {
    fn default() -> Rates<D> {
        let none = Vector::zeros();
        let moment = Symmetric::identity(0.0);
        Rates {
            density: 0.0,
            moment,
            spread: Spread::zeros(),
            force: none,
            crowding: none,
            fraction: 0.0,
            correction: none,
        }
    }
}

/// The physics of a flow. Optional physics is an `Option`.
pub struct Terms<const D: usize> {
    pub continuity: Continuity,
    pub density_diffusion: Option<DensityDiffusion>,
    pub moment: Option<Moment>,
    pub pressure: Pressure,
    pub viscosity: Viscosity,
    pub transport_stress: Option<TransportStress>,
    pub shift: Option<Shift<D>>,
    pub noise: Option<ThermalNoise<D>>,
}

impl<const D: usize> Terms<D> {
    /// Whether j feels the opposite of what i feels, so that a pair need be evaluated only once.
    #[must_use]
    pub fn are_mutual(&self) -> bool {
        self.pressure != Pressure::Switched
    }

    /// What the density of i gains from j, per volume of j; kg/m³/s times m^-D.
    #[inline(always)]
    fn density(&self, a: &Approach<D>, i: &Side<D>, j: &Side<D>) -> f64 {
        let mut out = 0.0;
        self.continuity.pair(a, i, j, &mut out);
        if let Some(diffusion) = &self.density_diffusion {
            diffusion.pair(a, i, j, &mut out);
        }
        out
    }

    /// eta_ij F c_ij: the strength of friction between i and j, with a solid if `SOLID`. The solid takes the factor c of the fluid.
    #[inline(always)]
    pub fn rub<const SOLID: bool>(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>) -> f64 {
        let rub = viscosity::between(i, j) * p.f;
        match &self.moment {
            Some(moment) => rub * moment.pair(&p.x, &i.moment, if SOLID { &i.moment } else { &j.moment }),
            None => rub,
        }
    }

    /// The force between fluid i and j, N/m³ times m^-D: V_j of it is the force per volume of i.
    #[inline(always)]
    fn force(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>) -> Vector<D> {
        let mut out = Vector::zeros();
        self.pressure.pair(p, i, j, &mut out);
        let rub = self.rub::<false>(p, i, j);
        self.viscosity.pair(rub, &p.x, &(i.velocity - j.velocity), &mut out);
        if let Some(stress) = &self.transport_stress {
            stress.pair(p, i, j, &mut out);
        }
        if let Some(noise) = &self.noise {
            noise.pair(rub, p, i, j, &mut out);
        }
        out
    }

    /// The force between fluid i and solid j, N/m³ times m^-D; `share` is the part of i in what j mirrors.
    #[inline(always)]
    pub fn force_of_solid(&self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, share: f64) -> Vector<D> {
        let mut out = Vector::zeros();
        self.pressure.pair(p, i, j, &mut out);
        let rub = self.rub::<true>(p, i, j);
        self.viscosity.pair(rub, &p.x, &(i.velocity - j.velocity), &mut out);
        if let Some(noise) = &self.noise {
            noise.solid(rub, share, p, i, j, &mut out);
        }
        out
    }

    /// The weights of a pair at distance `r` (m).
    #[inline(always)]
    fn weights(&self, kernel: &Kernel<D>, r: f64) -> (f64, f64) {
        (kernel.f(r), self.shift.as_ref().map_or(0.0, |shift| shift.f(r)))
    }
}

/// The part V_i W/Σ V W of fluid i in what solid j mirrors.
#[inline]
#[must_use]
pub fn share<const D: usize>(kernel: &Kernel<D>, x: &Vector<D>, i: &Side<D>, j: &Side<D>) -> f64 {
    if j.reach > 0.0 { i.volume * kernel.value(x.norm()) / j.reach } else { 0.0 }
}

/// First sweep over a block: finds the contacts, sums density rates, second moments and volume fractions of solid.
pub fn sweep_densities<const D: usize>(
    block: &mut Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    shortest: &Shortest<D>,
    positions: &[Vector<D>],
    sides: &[Side<D>],
) {
    block.find(kernel.cutoff(), shortest, positions);
    let first = block.first;
    for rates in rates.iter_mut() {
        (rates.density, rates.fraction) = (0.0, 0.0);
        (rates.moment, rates.spread) = (Symmetric::identity(0.0), Spread::zeros());
    }
    let corrected = terms.continuity == Continuity::Corrected;
    for row in 0..rates.len() {
        let i = &sides[first + row];
        let (mut density, mut moment, mut spread) = (0.0, Symmetric::identity(0.0), Spread::zeros());
        for c in block.inner.row_mut(row) {
            let j = &sides[c.j as usize];
            let approach = weigh(c, terms, kernel, i, j);
            let back = approach.back();
            let other = &mut rates[c.j as usize - first];
            density += j.volume * terms.density(&approach, i, j);
            other.density += i.volume * terms.density(&back, j, i);
            if terms.moment.is_some() {
                moment.add_square(&c.x, j.volume * approach.f);
                other.moment.add_square(&c.x, i.volume * approach.f);
            }
            if corrected {
                let between = approach.spread();
                spread += between * j.volume;
                other.spread += between * i.volume;
            }
        }
        for c in block.outer.row_mut(row) {
            let j = &sides[c.j as usize];
            let approach = weigh(c, terms, kernel, i, j);
            density += j.volume * terms.density(&approach, i, j);
            if terms.moment.is_some() {
                moment.add_square(&c.x, j.volume * approach.f);
            }
            if corrected {
                spread += approach.spread() * j.volume;
            }
        }
        if i.is_solid() {
            for c in block.walls.row_mut(row) {
                c.weight = kernel.value(c.weight.sqrt());
                density += sides[c.j as usize].volume * c.weight;
            }
            rates[row].fraction = 1.0;
        } else if block.near_solid[row] {
            rates[row].fraction = fraction(block, row, i, kernel, sides);
            for c in block.walls.row_mut(row) {
                let j = &sides[c.j as usize];
                let approach = weigh(c, terms, kernel, i, j);
                density += j.volume * terms.density(&approach, i, j);
                moment.add_square(&c.x, j.volume * approach.f);
                if corrected {
                    spread += approach.spread() * j.volume;
                }
            }
        }
        rates[row].density += density;
        rates[row].moment.add(&moment);
        rates[row].spread += spread;
    }
}

/// Puts F in the place of the r² a contact was found with.
#[inline(always)]
fn weigh<const D: usize>(
    c: &mut Contact<D>,
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    i: &Side<D>,
    j: &Side<D>,
) -> Approach<D> {
    (c.weight, c.f_shift) = terms.weights(kernel, c.weight.sqrt());
    let apart = i.velocity - j.velocity;
    Approach { x: c.x, f: c.weight, apart, opening: apart.dot(&c.x) }
}

/// Volume fraction of solid, phi_i = Σ_solid V_j W / Σ_all V_j W, i itself included; SPH-BVF Eq. (45). Leaving i out
/// would put every particle of an inner corner inside the wall.
fn fraction<const D: usize>(
    block: &Block<D>,
    row: usize,
    i: &Side<D>,
    kernel: &Kernel<D>,
    sides: &[Side<D>],
) -> f64 {
    let share = |c: &Contact<D>| sides[c.j as usize].volume * kernel.value(c.x.norm());
    let solid: f64 = block.walls.row(row).iter().map(share).sum();
    // A particle near solids has all its fluid neighbours in the outer list.
    let fluid: f64 = block.outer.row(row).iter().map(share).sum();
    solid / (i.volume * kernel.value(0.0) + fluid + solid)
}

/// Second sweep over a block: forces and crowding of the fluid particles, from the contacts of the first.
pub fn sweep_forces<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    sides: &[Side<D>],
) {
    let first = block.first;
    let none = Vector::zeros();
    for rates in rates.iter_mut() {
        (rates.force, rates.crowding, rates.correction) = (none, none, none);
    }
    for row in 0..rates.len() {
        let i = &sides[first + row];
        if i.is_solid() {
            continue;
        }
        let (mut force, mut crowding) = (none, none);
        for c in block.inner.row(row) {
            let j = &sides[c.j as usize];
            let pair = Pair { x: c.x, f: c.weight, f_shift: c.f_shift };
            let between = terms.force(&pair, i, j);
            let other = &mut rates[c.j as usize - first];
            force += between * j.volume;
            other.force -= between * i.volume;
            if let Some(shift) = &terms.shift {
                let mut between = none;
                shift.pair(&pair, &mut between);
                crowding += between * j.volume;
                other.crowding -= between * i.volume;
            }
        }
        for c in block.outer.row(row) {
            let j = &sides[c.j as usize];
            let pair = Pair { x: c.x, f: c.weight, f_shift: c.f_shift };
            force += terms.force(&pair, i, j) * j.volume;
            if let Some(shift) = &terms.shift {
                let mut between = none;
                shift.pair(&pair, &mut between);
                crowding += between * j.volume;
            }
        }
        for c in block.walls.row(row) {
            let j = &sides[c.j as usize];
            let pair = Pair { x: c.x, f: c.weight, f_shift: c.f_shift };
            let share = if terms.noise.is_some() { share(kernel, &c.x, i, j) } else { 0.0 };
            force += terms.force_of_solid(&pair, i, j, share) * j.volume;
            if let Some(shift) = &terms.shift {
                let mut between = none;
                shift.pair(&pair, &mut between);
                crowding += between * j.volume;
            }
        }
        rates[row].force += force;
        rates[row].crowding += crowding;
    }
}

/// What the fluid does to the solids of a block that ask for it: exactly the opposite of what [`sweep_forces`] gives the
/// fluid, pair by pair, as a force per volume of the solid particle (N/m³) into `rates`.
pub fn sweep_reactions<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    sides: &[Side<D>],
    asks: impl Fn(u8) -> bool,
) {
    for (row, rates) in rates.iter_mut().enumerate() {
        let solid = &sides[block.first + row];
        if !solid.is_solid() || !asks(solid.body) {
            continue;
        }
        for c in block.walls.row(row) {
            let fluid = &sides[c.j as usize];
            // Seen from the fluid, as the fluid saw it.
            let (f, f_shift) = terms.weights(kernel, c.x.norm_squared().sqrt());
            let pair = Pair { x: -c.x, f, f_shift };
            let share = if terms.noise.is_some() { share(kernel, &pair.x, fluid, solid) } else { 0.0 };
            rates.force -= terms.force_of_solid(&pair, fluid, solid, share) * fluid.volume;
        }
    }
}
