//! Species that lift the fluid.

use super::particles::narrow;
use crate::fluid::Placed;
use crate::geometry::shape::embed;
use crate::model::conditions::{Expansion, What};
use crate::model::{Amount, Model, ParticleDomain};
use crate::vector::Vector;

/// Buoyancy by one species (Boussinesq): acceleration -expansion (C - reference) gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lift<const D: usize> {
    pub species: usize,
    /// Relative fall of the density per concentration, m³/mol.
    pub expansion: f64,
    /// Concentration at which there is none, mol/m³.
    pub reference: f64,
    /// m/s².
    pub gravity: Vector<D>,
}

/// All of a domain.
pub(super) fn lifts<const D: usize>(domain: &ParticleDomain) -> Vec<Lift<D>> {
    let mut found = Vec::new();
    for condition in &domain.conditions {
        if let What::Buoyancy { gravity, species } = &condition.what {
            found.extend(species.iter().map(|&Expansion { species, expansion, reference }| Lift {
                species,
                expansion,
                reference,
                gravity: narrow(gravity),
            }));
        }
    }
    found
}

/// The largest size of the acceleration along each axis that the concentrations stated give, m/s²: at the start, held,
/// entering or drawn towards. Numbers of molecules are not looked at.
pub(super) fn strongest<const D: usize>(
    model: &Model,
    domain: &ParticleDomain,
    particles: &[Placed<D>],
) -> Vector<D> {
    let mut all = Vector::<D>::zeros();
    for lift in lifts::<D>(domain) {
        let mut most = 0.0_f64;
        let mut see = |c: f64| most = most.max((c - lift.reference).abs());
        let mut look = |amount: &Amount| match amount {
            Amount::Concentration(c) => see(*c),
            Amount::Field(program) => {
                particles.iter().for_each(|p| see(program.eval(embed(&p.position).as_slice())));
            }
            _ => {}
        };
        let mut begins = false;
        for entry in model.initial.iter().filter(|entry| entry.species == lift.species) {
            begins = true;
            look(&entry.amount);
        }
        if !begins {
            look(&Amount::Concentration(0.0));
        }
        for condition in &domain.conditions {
            match &condition.what {
                What::Held { species, .. } | What::Open { species, .. } | What::Sponge { species, .. } => {
                    species.iter().filter(|(s, _)| *s == lift.species).for_each(|(_, amount)| look(amount));
                }
                What::HeldSurface { species, .. } => {
                    let held = species.iter().filter(|(s, _)| *s == lift.species);
                    held.for_each(|(_, c)| look(&Amount::Concentration(*c)));
                }
                _ => {}
            }
        }
        if most.is_finite() {
            all += lift.gravity.abs() * (lift.expansion.abs() * most);
        }
    }
    all
}
