//! The velocity and pressure solids show to the fluid.
//!
//! Adami, Hu & Adams (2012) show 2 v_w less the mean velocity of the fluid in reach. That mean belongs to a place
//! nearer to the surface than the mirror image of a deep wall particle, and it knows no curvature: plane Poiseuille
//! flow is then too fast by ½ u'' Δ²/2, 5e-3 of its largest velocity at 20 particles across and 1.6 % in a square duct.
//! Here the velocity at a height s over the surface (negative behind it) is continued as v_w + g (s - ½ κ s²) + ½ k s²:
//!
//! - k is what the friction of the fluid near the wall says of ∇²v: in a steady flow friction is right even where its sum
//!   is not, for it balances the other forces. At a wall the derivatives along it vanish, less those of the wall's own
//!   velocity v_w, so ∇²v is ∂²v/∂s² + κ ∂v/∂s, κ the divergence of the normal (1/R of a cylinder in the fluid);
//! - g, the slope, fits v_f - v_w - ½ k s_f² of the fluid in reach. Over a bent surface what lies beside is higher,
//!   by ½ κ/(D - 1) times the square of how far beside.
//!
//! The error at 20 across falls to 2e-4.

use crate::fluid::blocks::Block;
use crate::fluid::flow::Flow;
use crate::fluid::particles::{Own, Side};
use crate::fluid::pass::Pair;
use crate::fluid::physics::Terms;
use crate::vector::Vector;

/// What a solid particle shows to the fluid in the force sweep.
#[derive(Clone, Copy, Debug)]
pub struct Mirror<const D: usize> {
    /// m/s.
    pub velocity: Vector<D>,
    /// Pa.
    pub pressure: f64,
}

/// How a solid moves, as its particle needs it to be told.
pub struct Moving<const D: usize, F: Fn(&Vector<D>) -> Vector<D>> {
    /// Velocity of the wall at a distance (m) from the particle, m/s.
    pub velocity: F,
    /// Whether that grows along it as that of a rigid body which turns.
    pub turns: bool,
    /// Acceleration of the particle, m/s².
    pub acceleration: Vector<D>,
    /// Acceleration of all fluid, to which each fluid particle adds its own, m/s².
    pub gravity: Vector<D>,
    /// How the velocity is continued.
    pub continuation: Continuation,
}

/// How the velocity of the fluid is continued into a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Continuation {
    /// By the mean of what is in reach: Adami, Hu & Adams 2012. The noise of a fluctuating fluid is made for it.
    Mean,
    /// By a parabola, from a particle at this depth (m) behind the surface.
    /// Behind a surface whose normal has the divergence `curvature`, 1/m.
    Parabola { depth: f64, curvature: f64 },
}

/// The velocity v_w - g (d + ½ κ d²) + ½ k d² (or 2 v_w less the mean of the fluid's) and the pressure
/// Σ_f [p_f + rho_f (g - a_w)·x_wf] V_f W/Σ_f V_f W of solid particle `row` of a block, the sums over its fluid
/// contacts. Without fluid in reach: the wall's own velocity and no pressure.
///
/// v_w is the velocity at the surface, or the rigid one at each place: taken at the solid particle for all, the fluid in a
/// rotating drum ends 1.6 % faster than the drum.
#[must_use]
pub fn mirror<const D: usize, F: Fn(&Vector<D>) -> Vector<D>>(
    block: &Block<D>,
    row: usize,
    (sides, own): (&[Side<D>], &[Own<D>]),
    wall: &Moving<D, F>,
) -> Mirror<D> {
    let (mut all, mut velocity, mut pressure) = (0.0, Vector::zeros(), 0.0);
    let (mut towards, mut bend): (Vector<D>, Vector<D>) = (Vector::zeros(), Vector::zeros());
    let falling = wall.gravity - wall.acceleration;
    for c in block.row(row) {
        let (f, its) = (&sides[c.j as usize], &own[c.j as usize]);
        let share = f.volume * c.weight;
        all += share;
        velocity += f.velocity * share;
        towards -= c.x * share;
        bend += its.bend * share;
        pressure += (f.pressure + f.density * (falling + its.lift).dot(&c.x)) * share;
    }
    if all <= 0.0 {
        return Mirror { velocity: (wall.velocity)(&Vector::zeros()), pressure: 0.0 };
    }
    let (pressure, bend, reach) = (pressure / all, bend / all, towards.norm() / all);
    let Continuation::Parabola { depth, curvature } = wall.continuation else {
        // Half way to the fluid is about the surface.
        let surface = (wall.velocity)(&(towards * (0.5 / all)));
        return Mirror { velocity: surface * 2.0 - velocity / all, pressure };
    };
    if reach <= depth {
        // Fluid on both sides, as before a thin wall: no direction leads out of it.
        let surface = (wall.velocity)(&Vector::zeros());
        return Mirror { velocity: surface * 2.0 - velocity / all, pressure };
    }
    let out = towards / (reach * all);
    let surface = (wall.velocity)(&(out * depth));
    let carried = |x: &Vector<D>| if wall.turns { (wall.velocity)(x) } else { surface };
    let beside = 0.5 * curvature / (D as f64 - 1.0).max(1.0);
    let rise = |s: f64| s - 0.5 * curvature * s * s;
    let (mut squares, mut slope) = (0.0, Vector::zeros());
    for c in block.row(row) {
        let f = &sides[c.j as usize];
        let along = -out.dot(&c.x);
        let height = (along - depth + beside * (c.x.norm_squared() - along * along)).max(0.0);
        let rise = rise(height);
        let share = f.volume * c.weight * rise;
        squares += share * rise;
        slope += (f.velocity - carried(&-c.x) - bend * (0.5 * height * height)) * share;
    }
    let slope = if squares > 0.0 { slope / squares } else { Vector::zeros() };
    let velocity = carried(&Vector::zeros()) + slope * rise(-depth) + bend * (0.5 * depth * depth);
    Mirror { velocity, pressure }
}

/// Σ m_f W over the fluid in reach of solid particle `row` of a block, kg/m³.
///
/// With noise walls at rest answer by the pressure of their own density, rho0 and what this sum has grown by since the
/// start: its work on the fluid is then a change of energy, as between fluid particles (Español & Revenga 2003), and the bath
/// keeps its temperature. The mean pressure of the fluid in reach is no such density: it heats the bath.
#[must_use]
pub fn filling<const D: usize>(block: &Block<D>, row: usize, sides: &[Side<D>]) -> f64 {
    let mass = |j: u32| sides[j as usize].volume * sides[j as usize].density;
    block.row(row).map(|c| mass(c.j) * c.weight).sum()
}

impl<const D: usize> Flow<D> {
    /// ∇²v (1/(m s)) of the fluid particles of a block near solids, as their friction sums it, into `own`.
    pub(super) fn bend(block: &Block<D>, own: &mut [Own<D>], terms: &Terms<D>, sides: &[Side<D>]) {
        let makeup = terms.makeup();
        for (row, own) in own.iter_mut().enumerate() {
            if !block.near_solid[row] {
                continue;
            }
            let i = &sides[block.first + row];
            let mut friction = Vector::zeros();
            for c in block.outer.row(row) {
                let (j, p) = (&sides[c.j as usize], Pair::new(&c));
                friction +=
                    terms.friction::<false>(makeup, &p, (i, j), &(i.velocity - j.velocity)) * j.volume;
            }
            for c in block.row(row) {
                let (j, p) = (&sides[c.j as usize], Pair::new(&c));
                friction += terms.friction::<true>(makeup, &p, (i, j), &(i.velocity - j.velocity)) * j.volume;
            }
            own.bend = if i.viscosity > 0.0 { friction / i.viscosity } else { Vector::zeros() };
        }
    }
}
