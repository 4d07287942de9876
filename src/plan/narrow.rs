//! Walls too thin, gaps too narrow and corners too deep for the particles: told before a run, with the place.

use super::ParticlePlan;
use crate::error::{Fault, Place};
use crate::fluid::{BodyKind, Grid, Setup};
use crate::geometry::Shape;
use crate::geometry::shape::embed;
use crate::model::groups::Group;
use crate::model::names::axis_name;
use crate::model::{Boundary, Material, Model, ParticleDomain};
use crate::quantity::readable::{length, show_vector};
use crate::vector::Vector;

/// Fewest particles across a gap that show a flow with a profile.
const ACROSS: f64 = 4.0;

/// How far above the surface value a particle may begin: in the corner of a plain box it is 0.494 for a support of 3.
const TOLERANCE: f64 = 0.01;

/// A solid as an obstacle: its name in words, where it is described, and its signed distance (m, negative inside).
struct Solid<'a, const D: usize> {
    words: String,
    place: &'a Place,
    distance: Box<dyn Fn(&Vector<D>) -> f64 + 'a>,
}

/// What can be seen of a spot: where it is, and how bad.
struct Spot<const D: usize> {
    at: Vector<D>,
    size: f64,
}

impl<const D: usize> Spot<D> {
    /// Keeps the spot of the smaller size.
    fn keep_smaller(slot: &mut Option<Spot<D>>, at: Vector<D>, size: f64) {
        if slot.as_ref().is_none_or(|spot| size < spot.size) {
            *slot = Some(Spot { at, size });
        }
    }
}

/// Warnings of a plan whose particles flow, one for each wall, pair of walls, or corner at most.
#[must_use]
pub fn warnings<const D: usize>(
    model: &Model,
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
) -> Vec<Fault> {
    let Some(setup) = &plan.flow else { return Vec::new() };
    let solids = solids(model, domain, plan);
    let mut found = Vec::new();
    thin_walls(domain, plan, setup, &solids, &mut found);
    narrow_gaps(domain, plan, &solids, &mut found);
    deep_corners(model, plan, setup, &solids, &mut found);
    found
}

fn solids<'a, const D: usize>(
    model: &'a Model,
    domain: &'a ParticleDomain,
    plan: &'a ParticlePlan<D>,
) -> Vec<Solid<'a, D>> {
    let wall = |group: &&'a Group| {
        matches!(group.material, Material::Wall { .. }) && group.shape != Shape::EverythingElse
    };
    let mut solids: Vec<Solid<D>> = domain
        .groups
        .iter()
        .filter(wall)
        .map(|group| Solid {
            words: format!("`{}`", group.name),
            place: &group.place,
            distance: Box::new(|x: &Vector<D>| group.shape.signed_distance(&embed(&plan.domain.wrap(x)))),
        })
        .collect();
    let walled = |k: &usize| !matches!(domain.boundaries[*k], Boundary::Periodic | Boundary::Open);
    for k in (0..D).filter(walled) {
        for upper in [false, true] {
            solids.push(Solid {
                words: format!("the side {}_{}", axis_name(k), if upper { "max" } else { "min" }),
                place: &model.places.domain,
                distance: Box::new(
                    move |x: &Vector<D>| {
                        if upper { plan.domain.max[k] - x[k] } else { x[k] - plan.domain.min[k] }
                    },
                ),
            });
        }
    }
    solids
}

/// Places of the particles that flow.
fn flowing<const D: usize>(plan: &ParticlePlan<D>) -> Vec<Vector<D>> {
    let all = plan.particles.iter().zip(&plan.home);
    all.filter(|pair| plan.flows(*pair.1)).map(|pair| pair.0.position).collect()
}

/// The direction out of a solid, by difference quotients.
fn outward<const D: usize>(solid: &Solid<D>, x: &Vector<D>, step: f64) -> Vector<D> {
    let slope = |k: usize| {
        let (mut up, mut down) = (*x, *x);
        up[k] += step;
        down[k] -= step;
        (solid.distance)(&up) - (solid.distance)(&down)
    };
    let gradient: Vector<D> = Vector::from_fn(|k, _| slope(k));
    let length = gradient.norm();
    if length > 0.0 { gradient * length.recip() } else { gradient }
}

/// Fluid that sees fluid, or nothing, through a wall.
fn thin_walls<const D: usize>(
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
    setup: &Setup<D>,
    solids: &[Solid<D>],
    found: &mut Vec<Fault>,
) {
    let (places, h) = (flowing(plan), setup.cutoff);
    let step = 1e-4 * setup.spacing;
    let groups = solids.iter().filter(|solid| solid.words.starts_with('`'));
    for solid in groups {
        let near: Vec<Vector<D>> = places.iter().copied().filter(|x| (solid.distance)(x) < h).collect();
        let reach = h + 2.0 * setup.spacing;
        let grid = Grid::build(&near, &plan.domain, reach);
        let normals: Vec<Vector<D>> = near.iter().map(|x| outward(solid, x, step)).collect();
        let mut through: Option<Spot<D>> = None;
        for (i, x) in near.iter().enumerate() {
            grid.for_each_near(x, &near, |j, apart, r2| {
                // Opposite faces of a wall; past a corner or round a cylinder the normals are not opposed.
                let inside = |part: f64| (solid.distance)(&(x - apart * part)) < -1e-9 * h;
                if j > i && normals[i].dot(&normals[j]) < -0.3 && [0.25, 0.5, 0.75].iter().any(|&p| inside(p))
                {
                    let gap = r2.sqrt() - (solid.distance)(x).max(0.0) - (solid.distance)(&near[j]).max(0.0);
                    if gap < 0.999 * h {
                        Spot::keep_smaller(&mut through, x - apart * 0.5, gap);
                    }
                }
            });
        }
        let remedy = format!("make the wall at least {} thick, or the spacing or support smaller", length(h));
        if let Some(spot) = through {
            found.push(Fault::at(
                solid.place,
                format!(
                    "{} is {} thick at {}, less than the kernel's cut-off of {}: the fluid on its two sides acts through it",
                    solid.words,
                    show_vector(&[spot.size], "m"),
                    words(&spot.at),
                    length(h)
                ),
                remedy,
            ));
        } else if let Some(spot) = hollow(domain, plan, solid, (&near, &normals), h) {
            found.push(Fault::at(
                solid.place,
                format!(
                    "{} is {} thick at {} with nothing behind it, less than the kernel's cut-off of {}: the fluid misses a part of the wall",
                    solid.words,
                    show_vector(&[spot.size], "m"),
                    words(&spot.at),
                    length(h)
                ),
                remedy,
            ));
        }
    }
}

/// Where empty space begins less than a cut-off behind the fluid before a wall.
fn hollow<const D: usize>(
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
    solid: &Solid<D>,
    (near, normals): (&[Vector<D>], &[Vector<D>]),
    h: f64,
) -> Option<Spot<D>> {
    let filled = |x: &Vector<D>| {
        plan.domain.is_beyond(x)
            || domain.groups.iter().any(|group| {
                group.material.is_filled() && group.shape.signed_distance(&embed(&plan.domain.wrap(x))) <= 0.0
            })
    };
    let mut found = None;
    for (x, e) in near.iter().zip(normals) {
        let before = (solid.distance)(x).max(0.0);
        let parts = 32;
        let empty = (1..=parts).map(|k| h * f64::from(k) / f64::from(parts)).find(|t| !filled(&(x - e * *t)));
        if let Some(mut t) = empty.filter(|t| *t > before && *t < 0.95 * h) {
            let mut full = t - h / f64::from(parts);
            for _ in 0..12 {
                let middle = 0.5 * (full + t);
                if filled(&(x - e * middle)) { full = middle } else { t = middle }
            }
            Spot::keep_smaller(&mut found, x - e * before, t - before);
        }
    }
    found
}

/// Fluid between two solids with too few particles across.
fn narrow_gaps<const D: usize>(
    domain: &ParticleDomain,
    plan: &ParticlePlan<D>,
    solids: &[Solid<D>],
    found: &mut Vec<Fault>,
) {
    let spacing = domain.spacing;
    let mut narrowest: Vec<Option<Spot<D>>> = Vec::new();
    narrowest.resize_with(solids.len() * solids.len(), || None);
    for x in flowing(plan) {
        for (a, solid) in solids.iter().enumerate() {
            let near = (solid.distance)(&x);
            if !(0.0..1.5 * spacing).contains(&near) {
                continue;
            }
            let e = outward(solid, &x, 1e-4 * spacing);
            for (b, other) in solids.iter().enumerate() {
                let ahead = |t: f64| (other.distance)(&(x + e * t));
                let steps = 1..=(4.0 * ACROSS) as u32;
                let hit = steps.map(|k| 0.25 * spacing * f64::from(k)).find(|&t| ahead(t) < 0.0);
                // The far side is that of another solid, or of this one where it bends round.
                let Some(hit) = hit.filter(|_| ahead(0.0) >= 0.0) else { continue };
                let (mut low, mut high) = (hit - 0.25 * spacing, hit);
                for _ in 0..20 {
                    let middle = 0.5 * (low + high);
                    if ahead(middle) < 0.0 { high = middle } else { low = middle }
                }
                let slot = &mut narrowest[a.min(b) * solids.len() + a.max(b)];
                Spot::keep_smaller(slot, x + e * (0.5 * (high - near)), near + high);
            }
        }
    }
    for (index, spot) in narrowest.into_iter().enumerate() {
        let (a, b) = (index / solids.len(), index % solids.len());
        let Some(spot) = spot.filter(|spot| spot.size < (ACROSS - 0.05) * spacing) else { continue };
        let between = if a == b {
            format!("{} closes to", solids[a].words)
        } else {
            format!("{} and {} stand", solids[a].words, solids[b].words)
        };
        found.push(Fault::at(
            solids[a].place,
            format!(
                "{between} {} apart at {}: {:.1} particles across the gap, at least {ACROSS:.0} are needed for a flow",
                show_vector(&[spot.size], "m"),
                words(&spot.at),
                spot.size / spacing
            ),
            format!("a spacing of {} would do, or close the gap", show_vector(&[spot.size / ACROSS], "m")),
        ));
    }
}

/// Fluid that sees more solid at the start than at a flat surface: it would be sent back in every step.
fn deep_corners<const D: usize>(
    model: &Model,
    plan: &ParticlePlan<D>,
    setup: &Setup<D>,
    solids: &[Solid<D>],
    found: &mut Vec<Fault>,
) {
    let kernel = plan.kernel();
    let places: Vec<Vector<D>> = setup.particles.iter().map(|p| p.position).collect();
    let grid = Grid::build(&places, &plan.domain, setup.cutoff);
    let mut deepest: Option<Spot<D>> = None;
    let mut count = 0;
    for (i, x) in places.iter().enumerate() {
        let body = &setup.bodies[usize::from(setup.particles[i].body)];
        if matches!(body.kind, BodyKind::Solid { .. }) {
            continue;
        }
        let (mut solid, mut all) = (0.0, 0.0);
        grid.for_each_near(x, &places, |j, _, r2| {
            let share = setup.particles[j].volume * kernel.value(r2.sqrt());
            all += share;
            let body = &setup.bodies[usize::from(setup.particles[j].body)];
            solid += if matches!(body.kind, BodyKind::Solid { .. }) { share } else { 0.0 };
        });
        let fraction = solid / all;
        if fraction > setup.options.surface_fraction + TOLERANCE {
            count += 1;
            Spot::keep_smaller(&mut deepest, *x, -fraction);
        }
    }
    let Some(spot) = deepest else { return };
    let mut near: Vec<(f64, &Solid<D>)> =
        solids.iter().map(|solid| ((solid.distance)(&spot.at), solid)).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let names: Vec<&str> = near
        .iter()
        .take_while(|(distance, _)| *distance < setup.spacing)
        .map(|(_, solid)| solid.words.as_str())
        .collect();
    let place = near.iter().map(|(_, solid)| solid.place).next().unwrap_or(&model.places.domain);
    found.push(Fault::at(
        place,
        format!(
            "{count} fluid {} with a volume fraction of solid above {} at the start, the largest {:.3} at {}{}",
            if count == 1 { "particle begins" } else { "particles begin" },
            setup.options.surface_fraction,
            -spot.size,
            words(&spot.at),
            if names.is_empty() { String::new() } else { format!(", next to {}", names.join(" and ")) }
        ),
        "they would be sent back in every step: round the corner off, move the surface between two rows of particles, or make support smaller (2.6)",
    ));
}

/// A place in a fitting unit.
fn words<const D: usize>(x: &Vector<D>) -> String {
    show_vector(x.as_slice(), "m")
}
