//! A checked reaction network in SI units.

use crate::chemistry::AVOGADRO;
use crate::chemistry::law::Program;
use crate::error::Place;
use crate::quantity::Quantity;

/// How rate constants are to be read; the contract's `kinetics`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinetics {
    /// k in mol/m³ and s: v = k Π [S]^ν (mol/m³/s); propensity a = k (N_A V)^(1-n) Π X … (X-ν+1).
    Concentration,
    /// k is Gillespie's c (1/s per distinct combination of molecules): a = c Π binomial(X, ν).
    Molecules,
}

/// How a species is carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Representation {
    /// Whole molecules, sampled.
    Discrete,
    /// A real amount, by rate equations.
    Continuous,
    /// Whole molecules where they are few, a real amount where they are many, voxel by voxel.
    Hybrid,
}

impl Representation {
    /// The name in models and records.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Representation::Discrete => "discrete",
            Representation::Continuous => "continuous",
            Representation::Hybrid => "hybrid",
        }
    }

    /// All of them by name, as a user writes them.
    pub const NAMED: [(&'static str, Representation); 3] = [
        ("discrete", Representation::Discrete),
        ("continuous", Representation::Continuous),
        ("hybrid", Representation::Hybrid),
    ];
}

/// A declared species.
#[derive(Clone, Debug, PartialEq)]
pub struct Species {
    pub name: String,
    /// Diffusivity, m²/s.
    pub diffusion: f64,
    /// Names of the groups it may live in; everywhere if `None`.
    pub only_in: Option<Vec<Named>>,
    /// The species' own choice, if it made one.
    pub representation: Option<Representation>,
    pub place: Place,
}

/// A name and where it was written, to be resolved later.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    pub name: String,
    pub place: Place,
}

/// The rate of a reaction.
#[derive(Clone, Debug, PartialEq)]
pub enum Rate {
    /// Constant k (SI: mol, m, s) or Gillespie's c (1/s), by the network's kinetics.
    MassAction(f64),
    /// An expression of species (its variables are numbered like the species), parameters folded in:
    /// mol/m³/s of concentrations in mol/m³, or events/s of counts, by the network's kinetics.
    Law(Program),
    /// Through a surface of the domain, in the voxels that face it.
    Surface(Surface),
}

/// What a surface does to a species; the number of the surface is the domain's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    pub number: usize,
    pub kind: SurfaceKind,
}

/// How molecules pass a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfaceKind {
    /// Enter at so many molecules/(m² s).
    Flux(f64),
    /// Leave at κ times the concentration at the wall, κ in m/s; infinite for a wall that absorbs all.
    Absorption(f64),
    /// Enter as they do from a concentration (mol/m³) held at the surface; with [`SurfaceKind::Absorption`] of
    /// infinite κ beside it the surface is a reservoir of this concentration.
    Held(f64),
}

impl SurfaceKind {
    /// Events per second in a voxel of volume `volume` m³ with `area` m² of the surface at `distance` m from it,
    /// per molecule for absorption, of a species of diffusivity `diffusivity` m²/s:
    /// J A, and κ A / V (1 + κ s / D), the loss from a linear profile with D dC/ds = κ C at the wall; and
    /// N_A C D A / s, what balances the loss to a wall that absorbs all where the voxel is at C.
    #[must_use]
    pub fn weight(self, volume: f64, area: f64, distance: f64, diffusivity: f64) -> f64 {
        match self {
            SurfaceKind::Flux(flux) => flux * area,
            SurfaceKind::Held(concentration) => AVOGADRO * concentration * diffusivity * area / distance,
            SurfaceKind::Absorption(kappa) => area / volume / (kappa.recip() + distance / diffusivity),
        }
    }
}

/// One direction of a declared reaction; species by index into [`Network::species`].
#[derive(Clone, Debug, PartialEq)]
pub struct Reaction {
    /// Declared name; the backward one of a pair gets ` (reverse)` appended.
    pub name: String,
    /// Equation of this direction, normalised: `R + L -> RL`.
    pub equation: String,
    /// Species and multiplicity consumed.
    pub reactants: Vec<(usize, u32)>,
    /// Species and multiplicity produced.
    pub products: Vec<(usize, u32)>,
    pub rate: Rate,
    /// Names of the groups in which it happens; everywhere if `None`.
    pub only_in: Option<Vec<Named>>,
    pub place: Place,
}

impl Reaction {
    /// Molecules consumed per event.
    #[must_use]
    pub fn order(&self) -> u32 {
        self.reactants.iter().map(|&(_, nu)| nu).sum()
    }

    /// Net change of each species that changes, in order of species.
    #[must_use]
    pub fn change(&self) -> Vec<(usize, i32)> {
        let mut net = std::collections::BTreeMap::new();
        for &(s, nu) in &self.products {
            *net.entry(s).or_insert(0) += nu as i32;
        }
        for &(s, nu) in &self.reactants {
            *net.entry(s).or_insert(0) -= nu as i32;
        }
        net.into_iter().filter(|&(_, change)| change != 0).collect()
    }
}

/// A checked reaction network.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    pub name: String,
    pub kinetics: Kinetics,
    pub species: Vec<Species>,
    /// Name and value, in order of declaration.
    pub parameters: Vec<(String, Quantity)>,
    pub reactions: Vec<Reaction>,
}
