//! What the samplers need to know of a domain besides amounts, volumes and links.

use crate::chemistry::network::{Network, Rate};
use crate::chemistry::propensity::Propensities;
use crate::chemistry::words::propensity_words;
use crate::error::RunError;

/// A set of at most 64 groups of voxels, as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GroupSet(pub u64);

impl GroupSet {
    /// Every group.
    pub const ALL: GroupSet = GroupSet(u64::MAX);

    /// Whether the set holds group `group`.
    #[inline]
    #[must_use]
    pub fn holds(self, group: u8) -> bool {
        group < 64 && self.0 >> group & 1 == 1
    }
}

/// More molecules than this in a voxel are no longer exact as `f64`.
pub const MOST_MOLECULES: f64 = 9.0e15;

/// The chemistry of a run, compiled once and shared by all realizations.
///
/// Amounts are `f64`, voxel by voxel: species s of voxel i stands at `amounts[i * species + s]`;
/// discrete species hold whole numbers (exact below 2^53). A voxel has a home group (where it was made,
/// decides which species may live there) and a current group (a zone it is passing, decides with the home
/// group which reactions happen).
#[derive(Clone, Debug)]
pub struct Reactor {
    /// Names of the species, for messages.
    pub species: Vec<String>,
    /// Names of the reactions, for messages.
    pub reactions: Vec<String>,
    /// Propensities of the reactions in words, for messages.
    pub expressions: Vec<String>,
    /// Propensities where every hybrid species is discrete.
    pub propensities: Propensities,
    /// Whether a species is carried as whole molecules, hybrid ones included.
    pub discrete: Vec<bool>,
    /// Diffusivity of each species, m²/s.
    pub diffusivity: Vec<f64>,
    /// Home groups each species may live in.
    pub habitat: Vec<GroupSet>,
    /// Groups (home or current) in which each reaction happens.
    pub active: Vec<GroupSet>,
    /// Home groups in which every species that a reaction changes may live; it happens in no other.
    pub livable: Vec<GroupSet>,
    /// Whether a reaction leads through a surface; it happens in the voxels that face it.
    pub surface: Vec<bool>,
    /// Species that are discrete or continuous voxel by voxel, if there are any.
    pub hybrid: Option<Hybrid>,
}

/// Species that are carried as whole molecules where they are few and as real amounts where they are many.
///
/// A voxel's mode is a set of bits: bit k is set where `species[k]` is continuous.
#[derive(Clone, Debug)]
pub struct Hybrid {
    pub species: Vec<usize>,
    /// Molecules in a voxel from which on a species becomes continuous.
    pub above: f64,
    /// Molecules in a voxel below which it becomes discrete again.
    pub below: f64,
    /// Propensities by mode.
    variants: Vec<Propensities>,
}

impl Hybrid {
    /// Most species that can be hybrid: there is a table of propensities for every mode.
    pub const MOST: usize = 8;

    /// Bit of a species; 0 if it is not hybrid.
    #[must_use]
    pub fn bit(&self, s: usize) -> u8 {
        self.species.iter().position(|&h| h == s).map_or(0, |k| 1 << k)
    }

    /// Propensities in a voxel of mode `mode`.
    #[inline]
    #[must_use]
    pub fn propensities(&self, mode: u8) -> &Propensities {
        &self.variants[usize::from(mode)]
    }

    /// Number of modes.
    #[must_use]
    pub fn modes(&self) -> usize {
        self.variants.len()
    }
}

impl Reactor {
    /// Compiles a network; `discrete` and `habitat` by species, `active` by reaction.
    #[must_use]
    pub fn new(network: &Network, discrete: &[bool], habitat: &[GroupSet], active: &[GroupSet]) -> Reactor {
        Reactor {
            species: network.species.iter().map(|s| s.name.clone()).collect(),
            reactions: network.reactions.iter().map(|r| r.name.clone()).collect(),
            expressions: network.reactions.iter().map(|r| propensity_words(network, r)).collect(),
            propensities: Propensities::compile(network, discrete),
            discrete: discrete.to_vec(),
            diffusivity: network.species.iter().map(|s| s.diffusion).collect(),
            habitat: habitat.to_vec(),
            active: active.to_vec(),
            livable: network
                .reactions
                .iter()
                .map(|r| r.change().iter().fold(GroupSet::ALL, |set, &(s, _)| GroupSet(set.0 & habitat[s].0)))
                .collect(),
            surface: network.reactions.iter().map(|r| matches!(r.rate, Rate::Surface(_))).collect(),
            hybrid: None,
        }
    }

    /// Makes `species` (at most [`Hybrid::MOST`], discrete so far) hybrid between the two thresholds, molecules
    /// in a voxel. The network is the one the reactor was compiled from.
    #[must_use]
    pub fn with_hybrid(mut self, network: &Network, species: Vec<usize>, above: f64, below: f64) -> Reactor {
        if species.is_empty() {
            return self;
        }
        let variants = (0..1_usize << species.len().min(Hybrid::MOST))
            .map(|mode| {
                let mut discrete = self.discrete.clone();
                for (k, &s) in species.iter().enumerate() {
                    discrete[s] &= mode >> k & 1 == 0;
                }
                Propensities::compile(network, &discrete)
            })
            .collect();
        self.hybrid = Some(Hybrid { species, above, below, variants });
        self
    }

    /// Propensities in a voxel of mode `mode`.
    #[inline]
    #[must_use]
    pub fn propensities_in(&self, mode: u8) -> &Propensities {
        match &self.hybrid {
            Some(hybrid) => hybrid.propensities(mode),
            None => &self.propensities,
        }
    }

    /// A network whose species live and react in every group.
    #[must_use]
    pub fn everywhere(network: &Network, discrete: &[bool]) -> Reactor {
        let habitat = vec![GroupSet::ALL; network.species.len()];
        let active = vec![GroupSet::ALL; network.reactions.len()];
        Reactor::new(network, discrete, &habitat, &active)
    }

    /// Net molecules of species `s` made by `fired[r]` events of each reaction r.
    #[must_use]
    pub fn made(&self, fired: &[u64], s: usize) -> f64 {
        (0..self.propensities.len())
            .flat_map(|r| self.propensities.changes(r).iter().map(move |change| (r, change)))
            .filter(|(_, change)| change.0 as usize == s)
            .map(|(r, change)| fired[r] as f64 * change.1)
            .sum()
    }

    /// Number of species.
    #[inline]
    #[must_use]
    pub fn species_count(&self) -> usize {
        self.species.len()
    }

    /// Whether reaction `r` happens in a voxel of these groups.
    #[inline]
    #[must_use]
    pub fn happens(&self, r: usize, home: u8, current: u8) -> bool {
        self.livable[r].holds(home) && (self.active[r].holds(home) || self.active[r].holds(current))
    }

    /// The propensity `value` of reaction `r` is no propensity.
    #[cold]
    #[must_use]
    pub fn bad_propensity(&self, r: usize, value: f64, time: f64, voxel: usize, amounts: &[f64]) -> RunError {
        let amounts: Vec<String> =
            self.species.iter().zip(amounts).map(|(s, n)| format!("{s} = {n}")).collect();
        let (reaction, expression) = (self.reactions[r].clone(), self.expressions[r].clone());
        RunError::Propensity { time, voxel, reaction, value, amounts: amounts.join(", "), expression }
    }

    /// Species `s` has come to more molecules than can be counted one by one.
    #[cold]
    #[must_use]
    pub fn too_many(&self, s: usize, value: f64, time: f64, voxel: usize) -> RunError {
        let quantity = format!("molecules of {}", self.species[s]);
        let remedy = String::from(
            "more than 9e15 cannot be counted one by one; make the species continuous or the volume smaller",
        );
        RunError::BlowUp { step: 0, time, particle: voxel, quantity, value, remedy }
    }

    /// Species `s` fell to `count` after reaction `r`.
    #[cold]
    #[must_use]
    pub fn negative_count(&self, s: usize, count: f64, r: usize, time: f64, voxel: usize) -> RunError {
        let event = self.reactions[r].clone();
        RunError::NegativeCount { time, voxel, species: self.species[s].clone(), count, event }
    }
}

/// Small networks for the tests of this and the neighbouring files.
#[cfg(test)]
pub(crate) mod example {
    use crate::chemistry::network::{Kinetics, Network, Rate, Reaction, Species};
    use crate::error::{Place, Source};
    use std::sync::Arc;

    type Side<'a> = &'a [(usize, u32)];
    /// Reactants, products, constant.
    pub type Equation<'a> = (Side<'a>, Side<'a>, f64);

    /// A mass-action network of `species` immobile species S0, S1, … from (reactants, products, constant).
    pub fn network(kinetics: Kinetics, species: usize, reactions: &[Equation]) -> Network {
        let source = Arc::new(Source::new("test", ""));
        let place = Place { source, line: 1, column: 1, width: 1 };
        let species = (0..species).map(|s| Species {
            name: format!("S{s}"),
            diffusion: 0.0,
            only_in: None,
            representation: None,
            place: place.clone(),
        });
        let reactions = reactions.iter().enumerate().map(|(r, &(reactants, products, k))| Reaction {
            name: format!("r{r}"),
            equation: String::new(),
            reactants: reactants.to_vec(),
            products: products.to_vec(),
            rate: Rate::MassAction(k),
            only_in: None,
            place: place.clone(),
        });
        Network {
            name: String::from("test"),
            kinetics,
            species: species.collect(),
            parameters: Vec::new(),
            reactions: reactions.collect(),
        }
    }
}
