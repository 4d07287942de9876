//! The open ends of a model: buffers beyond them, a reserve of particles, and what enters with the fluid.

use super::ParticlePlan;
use super::particles::narrow;
use crate::fluid::{Body, BodyKind, End, Motion, Open, Placed, Setup, Slip};
use crate::geometry::shape::embed;
use crate::model::conditions::{EndModel, What};
use crate::model::{Amount, Boundary, Material, ParticleDomain};
use crate::vector::Vector;
use std::sync::Arc;

/// The reserve, over the particles of the buffers, and over those of the box.
const RESERVE: (f64, f64) = (1.0, 0.05);

/// Open ends as flow and chemistry need them.
pub struct OpeningsPlan<const D: usize> {
    pub open: Open<D>,
    /// Group of the particles that enter.
    pub group: u8,
    /// What they carry by the end they enter at: species and concentration.
    pub carried: [Vec<(usize, Amount)>; 2],
    /// Particles of the buffers at the start.
    buffered: usize,
}

/// Fills the buffers beyond the ends of the open axis, if there is one.
pub(super) fn add<const D: usize>(
    plan: &mut ParticlePlan<D>,
    domain: &ParticleDomain,
    bodies: &mut Vec<Body<D>>,
) -> Option<OpeningsPlan<D>> {
    let axis = (0..D).find(|&k| domain.boundaries[k] == Boundary::Open)?;
    let group = domain.groups.iter().position(|group| group.material == Material::Fluid)?;
    let mut ends = [End::Pressure(0.0), End::Pressure(0.0)];
    let mut carried = [Vec::new(), Vec::new()];
    for condition in &domain.conditions {
        let What::Open { upper, end, species, .. } = &condition.what else { continue };
        let slot = usize::from(*upper);
        carried[slot].clone_from(species);
        ends[slot] = match end {
            EndModel::Pressure(pressure) => End::Pressure(*pressure),
            EndModel::Velocity(field) => {
                let field = field.clone();
                End::Velocity(Arc::new(move |x: &Vector<D>, t: f64| narrow(&field.at(&embed(x), t.max(0.0)))))
            }
        };
    }
    let spacing = domain.spacing;
    // One layer more than the cut-off: what happens between two buildings of the lists.
    let layers = (plan.cutoff / spacing - 1e-9).ceil() as i64 + 1;
    let buffered = fill(plan, domain, axis, layers);
    bodies.push(Body {
        name: "reserve".into(),
        kind: BodyKind::Solid { slip: Slip::NoSlip, motion: Motion::Still, surface: None },
    });
    let open =
        Open { axis, ends, depth: layers as f64 * spacing, fluid: 0, reserve: (bodies.len() - 1) as u8 };
    Some(OpeningsPlan { open, group: group as u8, carried, buffered })
}

/// Fluid in the buffers, and the walls of groups that reach the end carried on beside it; the number of fluid particles.
fn fill<const D: usize>(
    plan: &mut ParticlePlan<D>,
    domain: &ParticleDomain,
    axis: usize,
    layers: i64,
) -> usize {
    let spacing = domain.spacing;
    let cells: [i64; D] =
        std::array::from_fn(|k| ((plan.domain.max[k] - plan.domain.min[k]) / spacing).round() as i64);
    let across: i64 = (0..D).filter(|&k| k != axis).map(|k| cells[k]).product();
    let boundary = domain.groups.len() as u8;
    // Bodies of groups stand in the order of the groups, after the fluid.
    let walls: Vec<(&crate::geometry::Shape, u8)> = domain
        .groups
        .iter()
        .filter(|group| matches!(group.material, Material::Wall { .. } | Material::Solid))
        .zip(1_u8..)
        .filter(|(group, _)| group.material != Material::Solid)
        .map(|(group, body)| (&group.shape, body))
        .filter(|(shape, _)| **shape != crate::geometry::Shape::EverythingElse)
        .collect();
    let mut fluid = 0;
    for upper in [false, true] {
        for layer in 0..2 * layers {
            for index in 0..across {
                let mut rest = index;
                let mut cell = [0; D];
                for k in (0..D).filter(|&k| k != axis) {
                    cell[k] = rest % cells[k];
                    rest /= cells[k];
                }
                let at = |along: i64| {
                    Vector::from_fn(|k, _| {
                        let cell = if k == axis { along } else { cell[k] };
                        plan.domain.min[k] + (cell as f64 + 0.5) * spacing
                    })
                };
                let (position, before) = if upper {
                    (at(cells[axis] + layer), at(cells[axis] - 1))
                } else {
                    (at(-1 - layer), at(0))
                };
                // What stands at the end goes on beyond it.
                let wall = walls.iter().find(|(shape, _)| shape.holds(&embed(&before)));
                let body = match wall {
                    Some(&(_, body)) => body,
                    None if layer < layers => {
                        fluid += 1;
                        0
                    }
                    None => continue,
                };
                plan.particles.push(Placed { position, volume: spacing.powi(D as i32), body });
                plan.home.push(boundary);
            }
        }
    }
    fluid
}

impl<const D: usize> OpeningsPlan<D> {
    /// Adds the particles in reserve, out of reach of the others.
    pub(super) fn with_reserve(self, plan: &mut ParticlePlan<D>, setup: &mut Setup<D>) -> OpeningsPlan<D> {
        let parking = self.open.parking(setup);
        let boundary = plan.home.iter().copied().max().unwrap_or(0);
        let inside = setup.particles.iter().filter(|p| p.body == self.open.fluid).count() - self.buffered;
        let count = (RESERVE.0 * self.buffered as f64 + RESERVE.1 * inside as f64).ceil() as usize;
        let spacing = setup.spacing;
        for k in 0..count {
            // Spread over the width, so that no cell of the search for neighbours is crowded.
            let part = (k as f64 * 0.618_033_988_749_895).fract();
            let position = Vector::from_fn(|axis, _| {
                if axis == self.open.axis {
                    parking
                } else {
                    plan.domain.min[axis] + part * (plan.domain.max[axis] - plan.domain.min[axis])
                }
            });
            let placed = Placed { position, volume: spacing.powi(D as i32), body: self.open.reserve };
            plan.particles.push(placed.clone());
            setup.particles.push(placed);
            plan.home.push(boundary);
        }
        self
    }
}
