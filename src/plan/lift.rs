//! Species that lift the fluid.

use super::particles::narrow;
use crate::model::ParticleDomain;
use crate::model::conditions::{Expansion, What};
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
