//! A checked reaction network in SI units.

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
