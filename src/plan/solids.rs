//! Elastic solids: where their particles are, what they are made of, and what of it cannot be.

use super::particles::narrow;
use super::vessels::{self, VesselPlan};
use super::{Plan, thickness::thinnest};
use crate::error::{Fault, RunError};
use crate::fluid::Domain;
use crate::geometry::shape::embed;
use crate::geometry::{Fill, Lattice, fill};
use crate::model::fluid::Velocity;
use crate::model::solids::{Form, Softening};
use crate::model::{Boundary, ParticleDomain, SolidModel};
use crate::quantity::readable::length;
use crate::solid::{self, Elastic, Hold, Jaumann, Options, Setup};
use crate::vector::Vector;
use rand::Rng;
use std::sync::Arc;

/// A solid that is thinner than this many particles bends too easily.
const FEWEST: f64 = 3.0;

/// An elastic solid of a plan; in the order in which the model describes them.
#[derive(Clone)]
pub struct SolidPlan<const D: usize> {
    pub group: u8,
    /// Groups of those particles that are a surface of it.
    pub surfaces: Vec<u8>,
    pub name: String,
    /// Number of its first particle; the others follow.
    pub first: usize,
    /// Its number among the bodies of the flow, if there is one.
    pub body: u8,
    pub setup: Setup<D>,
    pub form: Form,
    /// At t = 0.
    pub velocity: Velocity,
    pub softening: Option<Softening>,
    /// What it encloses, where it is in balance with it.
    pub vessel: Option<VesselPlan<D>>,
    /// Of its particles at rest, m.
    pub spacing: f64,
    /// Where it is thinnest, m.
    pub thickness: f64,
}

impl<const D: usize> SolidPlan<D> {
    /// Whether the particles of a home group are of this solid.
    #[must_use]
    pub fn owns(&self, home: u8) -> bool {
        self.group == home || self.surfaces.contains(&home)
    }

    /// The total-Lagrangian solid at t = 0.
    ///
    /// # Errors
    /// A solid that cannot be built.
    pub fn elastic(&self) -> Result<Elastic<D>, RunError> {
        let mut elastic = Elastic::new(self.setup.clone())?;
        if !self.velocity.is_zero() {
            elastic.set_velocity(|x| narrow(&self.velocity.at(&embed(x))));
        }
        Ok(elastic)
    }

    /// The updated-Lagrangian solid at t = 0.
    ///
    /// # Errors
    /// A solid that cannot be built.
    pub fn jaumann(&self, form: solid::Form) -> Result<Jaumann<D>, RunError> {
        let mut jaumann = Jaumann::new(self.setup.clone(), form)?;
        if !self.velocity.is_zero() {
            jaumann.set_velocity(|x| narrow(&self.velocity.at(&embed(x))));
        }
        Ok(jaumann)
    }
}

/// Places and volumes of the particles of a solid.
pub(super) fn places<const D: usize>(
    domain: &ParticleDomain,
    solid: &SolidModel,
    (min, max): (&Vector<D>, &Vector<D>),
    random: &mut impl Rng,
) -> Vec<(Vector<D>, f64)> {
    let group = &domain.groups[solid.group];
    // It may reach into the walls round the box, as deep as they are.
    let depth = Vector::from_fn(|k, _| match domain.boundaries[k] {
        Boundary::Periodic | Boundary::Open => 0.0,
        _ => (domain.support - 1e-9).ceil() * domain.spacing,
    });
    let (min, max) = (min - depth, max + depth);
    let region = Fill {
        shape: &group.shape,
        without: Vec::new(),
        lattice: Lattice::Fitted,
        spacing: solid.spacing,
        jitter: 0.0,
    };
    match vessels::columns(solid, group) {
        Some((_, columns)) => columns,
        None => fill::<D>(&region, &min, &max, random),
    }
}

/// A solid whose particles are `found`, the first of them number `first` of the plan.
pub(super) fn solid<const D: usize>(
    domain: &ParticleDomain,
    solid: &SolidModel,
    (space, first, body): (&Domain<D>, usize, usize),
    found: &[(Vector<D>, f64)],
    faults: &mut Vec<Fault>,
) -> SolidPlan<D> {
    let group = &domain.groups[solid.group];
    let places: Vec<Vector<D>> = found.iter().map(|(x, _)| *x).collect();
    let (thickness, at) = thinnest(&group.shape, &places, solid.spacing);
    check_thickness(domain, solid, (thickness, at), faults);
    SolidPlan {
        group: solid.group as u8,
        surfaces: (0..domain.groups.len())
            .filter(|&g| domain.groups[g].of == Some(solid.group))
            .map(|g| g as u8)
            .collect(),
        name: group.name.clone(),
        first,
        body: body as u8,
        setup: Setup {
            domain: space.clone(),
            kernel: solid.kernel,
            cutoff: solid.support * solid.spacing,
            volumes: found.iter().map(|(_, volume)| *volume).collect(),
            holds: holds(solid, (space, &places), faults),
            places,
            material: solid.material,
            options: Options {
                hourglass: solid.hourglass,
                drag: solid.drag,
                viscosity: solid.viscosity,
                ..Options::default()
            },
        },
        form: solid.form,
        velocity: solid.velocity.clone(),
        softening: solid.softening,
        vessel: vessels::vessel(domain, solid, found.len(), faults),
        spacing: solid.spacing,
        thickness,
    }
}

/// Too few particles across, or so thin that the fluid on one side feels that on the other.
fn check_thickness(
    domain: &ParticleDomain,
    solid: &SolidModel,
    (thickness, at): (f64, Vector<3>),
    faults: &mut Vec<Fault>,
) {
    let name = &domain.groups[solid.group].name;
    // Zero up to rounding is zero.
    let at = |k: usize| if at[k].abs() < 1e-6 * solid.spacing { 0.0 } else { at[k] };
    let at: Vec<f64> = (0..domain.dimensions).map(at).collect();
    let at = crate::quantity::readable::show_vector(&at, "m");
    let across = (thickness / solid.spacing).round();
    if across < FEWEST {
        faults.push(Fault::at(
            &solid.places.spacing,
            format!(
                "the elastic solid `{name}` is {} thin at {at}, which is room for {across} of the {FEWEST} particles across that bending needs",
                length(thickness)
            ),
            format!("set solids.{name}.spacing: {} or less, or make it thicker", length(thickness / FEWEST)),
        ));
    }
    let cutoff = domain.support * domain.spacing;
    if domain.fluid.is_some() && cutoff > thickness * (1.0 + 1e-6) {
        faults.push(Fault::at(
            &solid.places.entry,
            format!(
                "the fluid on the two sides of `{name}` would feel itself through it: it is {} thin at {at}, and the fluid's kernel reaches {}",
                length(thickness),
                length(cutoff)
            ),
            format!(
                "set particles.spacing: {} or less (support {}), or make the solid thicker",
                length(thickness / domain.support),
                domain.support
            ),
        ));
    }
}

/// What holds each particle.
fn holds<const D: usize>(
    solid: &SolidModel,
    (space, places): (&Domain<D>, &[Vector<D>]),
    faults: &mut Vec<Fault>,
) -> Vec<Hold<D>> {
    let entry = &solid.places.entry;
    let mut refuse = |place: Option<&crate::error::Place>, reason: String, remedy: &str| {
        faults.push(Fault::at(place.unwrap_or(entry), reason, remedy));
    };
    let (mut clamped, mut driven, mut both) = (0, 0, None);
    let mut holds = Vec::with_capacity(places.len());
    for place in places {
        let x = embed(place);
        let is_clamped = solid.clamped.as_ref().is_some_and(|shape| shape.holds(&x));
        let drive = solid.driven.as_ref().filter(|(shape, _)| shape.holds(&x));
        clamped += usize::from(is_clamped);
        driven += usize::from(drive.is_some());
        holds.push(match (is_clamped, drive) {
            (true, Some(_)) => {
                both.get_or_insert(x);
                Hold::Clamped
            }
            (true, None) => Hold::Clamped,
            (false, Some((_, field))) => {
                let field = field.clone();
                Hold::Driven(Arc::new(move |x: &Vector<D>, t| narrow(&field.at(&embed(x), t))))
            }
            (false, None) => Hold::Free,
        });
    }
    let loose = places.iter().zip(&holds).find(|(x, hold)| matches!(hold, Hold::Free) && space.is_beyond(x));
    if let Some((x, _)) = loose {
        let x = crate::quantity::readable::show_vector(x.as_slice(), "m");
        let words = "clamp or drive what of it lies beyond the box, or make the box larger";
        refuse(None, format!("the solid reaches out of the box at {x} and is not held there"), words);
    }
    let words = "make the shape larger: it must hold particles of the solid, which lie half a spacing inside its surface";
    if solid.clamped.is_some() && clamped == 0 {
        refuse(solid.places.clamped.as_ref(), "no particle of the solid is in what is clamped".into(), words);
    }
    let Some((shape, field)) = &solid.driven else { return holds };
    let at = solid.places.driven.as_ref();
    if driven == 0 {
        refuse(at, "no particle of the solid is in what is driven".into(), words);
    }
    if let Some(x) = both {
        let x = crate::quantity::readable::show_vector(&x.as_slice()[..D], "m");
        refuse(at, format!("the particle at {x} is clamped and driven"), "let the two shapes not overlap");
    }
    let astray = places.iter().map(embed).filter(|x| shape.holds(x)).find(|x| field.at(x, 0.0).norm() != 0.0);
    if let Some(x) = astray {
        let u = field.at(&x, 0.0).norm();
        let x = crate::quantity::readable::show_vector(&x.as_slice()[..D], "m");
        refuse(
            at,
            format!("the displacement is {u:.3e} m at t = 0 at {x}, or no number"),
            "let it begin at zero, e.g. times (1 - exp(-t / (1 ms)))",
        );
    }
    holds
}

/// Species that soften a solid or let it grow in which they cannot be.
pub(super) fn check_species(plan: &Plan, domain: &ParticleDomain, faults: &mut Vec<Fault>) {
    for solid in &domain.solids {
        let places = &solid.places;
        let by = [
            (solid.softening.map(|softening| softening.species), &places.softening),
            (solid.growth.and_then(|growth| growth.by).map(|(species, _)| species), &places.growth),
        ];
        for (species, place) in by.into_iter().filter_map(|(species, place)| Some((species?, place))) {
            let mut parts = (0..domain.groups.len())
                .filter(|&g| g == solid.group || domain.groups[g].of == Some(solid.group));
            if parts.any(|g| plan.reactor.habitat[species].holds(g as u8)) {
                continue;
            }
            let name = &domain.groups[solid.group].name;
            faults.push(Fault::at(
                place.as_ref().unwrap_or(&places.entry),
                format!("`{}` cannot be in `{name}`, which it is to change", plan.reactor.species[species]),
                "let the group hold it, and name the group in the species' `only_in` if it has one",
            ));
        }
    }
}
