//! The sweeps over pairs: densities first, forces after.
//!
//! Two sweeps a step because the pressure needs the new density (taken from the half step it feeds sound
//! waves). The first keeps the pairs it found for the second. A pair of one block is evaluated once and given to
//! both sides; one that crosses blocks is evaluated by both, each for itself, so that no thread writes where
//! another does and the order of every sum is that of the lists.

use crate::fluid::blocks::{Block, Contact};
use crate::fluid::particles::{Side, Slopes};
use crate::fluid::physics::{Makeup, Terms};
use crate::fluid::symmetric::Symmetric;
use crate::fluid::terms::Shift;
use crate::fluid::terms::continuity::Spread;
use crate::fluid::terms::density_diffusion::slope;
use crate::space::domain::Shortest;
use crate::space::kernel::Kernel;
use crate::vector::Vector;

/// The geometry of a pair: x = x_i - x_j (m) and F (m^-(D+2)); the gradient of W is -F x.
#[derive(Clone, Copy, Debug)]
pub struct Pair<const D: usize> {
    pub x: Vector<D>,
    pub f: f64,
    /// F of the shift's own kernel.
    pub f_shift: f64,
    /// 1/|x|², m^-2.
    pub inverse_square: f64,
}

impl<const D: usize> Pair<D> {
    /// The pair of a contact in the row of a fluid particle.
    #[inline(always)]
    #[must_use]
    pub fn new(c: &Contact<D>) -> Pair<D> {
        Pair { x: c.x, f: c.weight, f_shift: c.f_shift, inverse_square: c.inverse_square }
    }
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
    /// (w_i + w_j)·x with the drift w; m²/s.
    pub drifting: f64,
    /// rho_j - rho_i, kg/m³.
    pub denser: f64,
    /// What a density of constant slope would have of it, -½ (∇rho_i + ∇rho_j)·x where gradients are known, kg/m³.
    pub sloping: f64,
}

impl<const D: usize> Approach<D> {
    /// The approach of i and j at `x` = x_i - x_j (m) with a weight F.
    #[inline(always)]
    #[must_use]
    pub fn new(x: &Vector<D>, f: f64, i: &Side<D>, j: &Side<D>) -> Approach<D> {
        let apart = i.velocity - j.velocity;
        Approach {
            x: *x,
            f,
            apart,
            opening: apart.dot(x),
            drifting: (i.drift + j.drift).dot(x),
            denser: j.density - i.density,
            sloping: 0.0,
        }
    }

    /// The same pair seen from j.
    #[inline(always)]
    #[must_use]
    pub fn back(&self) -> Approach<D> {
        Approach {
            x: -self.x,
            apart: -self.apart,
            drifting: -self.drifting,
            denser: -self.denser,
            sloping: -self.sloping,
            ..*self
        }
    }

    /// F x⊗x, the same from both sides.
    #[inline(always)]
    fn moment(&self) -> Symmetric<D> {
        Symmetric::square(&self.x, self.f)
    }

    /// F (rho_j - rho_i) x, the same from both sides.
    #[inline(always)]
    fn rise(&self) -> Vector<D> {
        self.x * (self.f * self.denser)
    }

    /// F (v_i - v_j)⊗x, the same from both sides.
    #[inline(always)]
    fn spread(&self) -> Spread<D> {
        let x = self.x * self.f;
        Spread::from_fn(|a, b| self.apart[a] * x[b])
    }
}

/// What the sweeps find for one particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<const D: usize> {
    /// kg/m³/s; of a solid Σ V W over the fluid before it.
    pub density: f64,
    /// Σ V_j F x⊗x.
    pub moment: Symmetric<D>,
    /// Σ V_j F (v_i - v_j)⊗x, then the gradient of the velocity; 1/s.
    pub spread: Spread<D>,
    /// Σ V_j F (rho_j - rho_i) x over the same fluid, then its gradient of density; kg/m⁴.
    pub slope: Vector<D>,
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
            slope: none,
            force: none,
            crowding: none,
            fraction: 0.0,
            correction: none,
        }
    }
}

/// The part V_i W/Σ V W of fluid i in what solid j mirrors.
#[inline]
#[must_use]
pub fn share<const D: usize>(kernel: &Kernel<D>, x: &Vector<D>, i: &Side<D>, j: &Side<D>) -> f64 {
    if j.reach > 0.0 { i.volume * kernel.value(x.norm()) / j.reach } else { 0.0 }
}

/// First sweep over a block: finds the contacts, sums density rates, second moments, slopes and volume fractions of solid.
#[inline(always)]
pub(super) fn densities<const D: usize>(
    block: &mut Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    shortest: &Shortest<D>,
    positions: &[Vector<D>],
    (sides, slopes): (&[Side<D>], &[Slopes<D>]),
) {
    block.find(kernel, terms.shift_kernel(), shortest, (positions, sides));
    for rates in rates.iter_mut() {
        (rates.density, rates.fraction) = (0.0, 0.0);
        (rates.moment, rates.spread) = (Symmetric::identity(0.0), Spread::zeros());
        rates.slope = Vector::zeros();
    }
    // A copy of the sums for each usual set of terms.
    match terms.makeup() {
        Makeup::FLOW => sum_densities(Makeup::FLOW, block, rates, terms, (sides, slopes)),
        Makeup::THERMAL_FLOW => sum_densities(Makeup::THERMAL_FLOW, block, rates, terms, (sides, slopes)),
        Makeup::BATH => sum_densities(Makeup::BATH, block, rates, terms, (sides, slopes)),
        Makeup::THERMAL_BATH => sum_densities(Makeup::THERMAL_BATH, block, rates, terms, (sides, slopes)),
        any => sum_densities(any, block, rates, terms, (sides, slopes)),
    }
    if terms.density_diffusion.is_some() {
        // Before solids add to the moments: they have no density of their own.
        for rates in rates.iter_mut() {
            rates.slope = slope(&rates.moment, &rates.slope);
        }
    }
    if block.walls.contacts() > 0 {
        densities_at_walls(block, rates, terms, kernel, sides);
    }
}

/// What fluid gets from fluid in the first sweep.
#[inline(always)]
fn sum_densities<const D: usize>(
    makeup: Makeup,
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    (sides, slopes): (&[Side<D>], &[Slopes<D>]),
) {
    let first = block.first;
    for row in 0..rates.len() {
        let i = &sides[first + row];
        let mut sum = Gain::default();
        for c in block.inner.row(row) {
            let j = &sides[c.j as usize];
            let approach = approaching(makeup, &c, (i, j), slopes, (first + row, c.j as usize));
            let other = &mut rates[c.j as usize - first];
            sum.density += j.volume * terms.density(makeup, &approach, i, j);
            other.density += i.volume * terms.density(makeup, &approach.back(), j, i);
            if makeup.density_diffusion && i.body == j.body {
                let between = approach.rise();
                sum.slope += between * j.volume;
                other.slope += between * i.volume;
            }
            if makeup.moment {
                let between = approach.moment();
                sum.moment.add_scaled(&between, j.volume);
                other.moment.add_scaled(&between, i.volume);
            }
            if makeup.spreads() {
                let between = approach.spread();
                sum.spread += between * j.volume;
                other.spread += between * i.volume;
            }
        }
        for c in block.outer.row(row) {
            let j = &sides[c.j as usize];
            let approach = approaching(makeup, &c, (i, j), slopes, (first + row, c.j as usize));
            sum.see(makeup, terms, &approach, i, j);
        }
        sum.give(&mut rates[row]);
    }
}

/// The approach of two fluid particles, whose numbers come last.
#[inline(always)]
fn approaching<const D: usize>(
    makeup: Makeup,
    c: &Contact<D>,
    (i, j): (&Side<D>, &Side<D>),
    slopes: &[Slopes<D>],
    (mine, yours): (usize, usize),
) -> Approach<D> {
    let mut approach = Approach::new(&c.x, c.weight, i, j);
    if makeup.density_diffusion {
        approach.sloping = -0.5 * (slopes[mine].density + slopes[yours].density).dot(&c.x);
    }
    approach
}

/// What fluid and solid get from each other in the first sweep.
fn densities_at_walls<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    sides: &[Side<D>],
) {
    let makeup = terms.makeup();
    for (row, rates) in rates.iter_mut().enumerate() {
        let i = &sides[block.first + row];
        if i.is_solid() {
            rates.density += block.walls.row(row).map(|c| sides[c.j as usize].volume * c.weight).sum::<f64>();
            rates.fraction = 1.0;
        } else if block.near_solid[row] {
            rates.fraction = fraction(block, row, i, kernel, sides);
            let mut sum = Gain::default();
            for c in block.walls.row(row) {
                let j = &sides[c.j as usize];
                sum.see(makeup, terms, &Approach::new(&c.x, c.weight, i, j), i, j);
            }
            sum.give(rates);
        }
    }
}

/// What a particle gains in the first sweep.
struct Gain<const D: usize> {
    density: f64,
    moment: Symmetric<D>,
    spread: Spread<D>,
    slope: Vector<D>,
}

impl<const D: usize> Default for Gain<D> {
    #[inline(always)]
    fn default() -> Gain<D> {
        let moment = Symmetric::identity(0.0);
        Gain { density: 0.0, moment, spread: Spread::zeros(), slope: Vector::zeros() }
    }
}

impl<const D: usize> Gain<D> {
    /// Adds what i gains from j.
    #[inline(always)]
    fn see(&mut self, makeup: Makeup, terms: &Terms<D>, approach: &Approach<D>, i: &Side<D>, j: &Side<D>) {
        self.density += j.volume * terms.density(makeup, approach, i, j);
        if makeup.density_diffusion && i.body == j.body {
            self.slope += approach.rise() * j.volume;
        }
        if makeup.moment {
            self.moment.add_scaled(&approach.moment(), j.volume);
        }
        if makeup.spreads() {
            self.spread += approach.spread() * j.volume;
        }
    }

    #[inline(always)]
    fn give(&self, rates: &mut Rates<D>) {
        rates.density += self.density;
        rates.moment.add_scaled(&self.moment, 1.0);
        rates.spread += self.spread;
        rates.slope += self.slope;
    }
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
    let share = |c: Contact<D>| sides[c.j as usize].volume * kernel.value(c.x.norm());
    let solid: f64 = block.walls.row(row).map(share).sum();
    // A particle near solids has all its fluid neighbours in the outer list.
    let fluid: f64 = block.outer.row(row).map(share).sum();
    solid / (i.volume * kernel.value(0.0) + fluid + solid)
}

/// Second sweep over a block: forces and crowding of the fluid particles, from the contacts of the first.
#[inline(always)]
pub(super) fn forces<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    (sides, slopes): (&[Side<D>], &[Slopes<D>]),
) {
    let none = Vector::zeros();
    for rates in rates.iter_mut() {
        (rates.force, rates.crowding, rates.correction) = (none, none, none);
    }
    match terms.makeup() {
        Makeup::FLOW => sum_forces(Makeup::FLOW, block, rates, terms, (sides, slopes)),
        Makeup::THERMAL_FLOW => sum_forces(Makeup::THERMAL_FLOW, block, rates, terms, (sides, slopes)),
        Makeup::BATH => sum_forces(Makeup::BATH, block, rates, terms, (sides, slopes)),
        Makeup::THERMAL_BATH => sum_forces(Makeup::THERMAL_BATH, block, rates, terms, (sides, slopes)),
        any => sum_forces(any, block, rates, terms, (sides, slopes)),
    }
    if block.walls.contacts() > 0 {
        forces_at_walls(block, rates, terms, kernel, sides);
    }
}

/// What fluid gets from fluid in the second sweep.
#[inline(always)]
fn sum_forces<const D: usize>(
    makeup: Makeup,
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    (sides, slopes): (&[Side<D>], &[Slopes<D>]),
) {
    let first = block.first;
    for row in 0..rates.len() {
        let i = &sides[first + row];
        let (mut force, mut crowding) = (Vector::zeros(), Vector::zeros());
        for c in block.inner.row(row) {
            let j = &sides[c.j as usize];
            let pair = Pair::new(&c);
            let theirs = makeup.fourth_order.then(|| [&slopes[first + row], &slopes[c.j as usize]]);
            let between = terms.force(makeup, &pair, i, j, theirs);
            let other = &mut rates[c.j as usize - first];
            force += between * j.volume;
            other.force -= between * i.volume;
            if makeup.shift {
                let between = Shift::pair(&pair);
                crowding += between * j.volume;
                other.crowding -= between * i.volume;
            }
        }
        for c in block.outer.row(row) {
            let j = &sides[c.j as usize];
            let pair = Pair::new(&c);
            let theirs = makeup.fourth_order.then(|| [&slopes[first + row], &slopes[c.j as usize]]);
            force += terms.force(makeup, &pair, i, j, theirs) * j.volume;
            if makeup.shift {
                crowding += Shift::pair(&pair) * j.volume;
            }
        }
        rates[row].force += force;
        rates[row].crowding += crowding;
    }
}

/// What fluid gets from solids in the second sweep.
fn forces_at_walls<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    sides: &[Side<D>],
) {
    let makeup = terms.makeup();
    for (row, rates) in rates.iter_mut().enumerate().filter(|(row, _)| block.near_solid[*row]) {
        let i = &sides[block.first + row];
        for c in block.walls.row(row) {
            let j = &sides[c.j as usize];
            let pair = Pair::new(&c);
            let share = if makeup.noise { share(kernel, &c.x, i, j) } else { 0.0 };
            rates.force += terms.force_of_solid(makeup, &pair, i, j, share) * j.volume;
            if makeup.shift {
                rates.crowding += Shift::pair(&pair) * j.volume;
            }
        }
    }
}

/// What the fluid does to the solids of a block that ask for it: exactly the opposite of what [`forces`] gives the
/// fluid, pair by pair, as a force per volume of the solid particle (N/m³) into `rates`.
pub fn sweep_reactions<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    sides: &[Side<D>],
    asks: impl Fn(u8) -> bool,
) {
    let makeup = terms.makeup();
    for (row, rates) in rates.iter_mut().enumerate() {
        let solid = &sides[block.first + row];
        if !solid.is_solid() || !asks(solid.body) {
            continue;
        }
        for c in block.walls.row(row) {
            let fluid = &sides[c.j as usize];
            // Seen from the fluid, as the fluid saw it.
            let pair = Pair { x: -c.x, f: kernel.f(c.x.norm_squared().sqrt()), ..Pair::new(&c) };
            let share = if makeup.noise { share(kernel, &pair.x, fluid, solid) } else { 0.0 };
            rates.force -= terms.force_of_solid(makeup, &pair, fluid, solid, share) * fluid.volume;
        }
    }
}
