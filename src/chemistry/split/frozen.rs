//! One frozen geometry, built once per chemistry step and shared by all realizations of a flow.

use super::kinds::{Kind, Lists, sort_into_kinds};
use super::passages::Passages;
use crate::chemistry::diffusion::HopTable;
use crate::chemistry::links::Links;
use crate::chemistry::propensity::Scale;
use crate::chemistry::reactor::{GroupSet, Reactor};
use crate::error::RunError;
use std::borrow::Cow;

/// Volumes, groups, held amounts and hop tables of a geometry that stands still for one step.
#[derive(Clone, Debug)]
pub struct Frozen {
    /// N_A V of each voxel.
    pub scales: Vec<Scale>,
    /// Whether the amount of species s in voxel i is a reservoir, at `i * species + s`; empty if none is.
    pub held: Vec<bool>,
    /// Home group of each voxel.
    pub home: Vec<u8>,
    /// Voxels in which a species is held.
    pub(super) held_voxels: Vec<Vec<u32>>,
    pub(super) kinds: Vec<Kind>,
    /// Kind of each voxel.
    pub(super) kind: Vec<u32>,
    /// Of each surface reaction, the factor of its propensity by voxel; empty for the others. Empty if there is
    /// no surface.
    pub(super) weights: Vec<Vec<f64>>,
    /// Table of each species; `None` for those that do not diffuse.
    pub(super) table: Vec<Option<u32>>,
    pub(super) tables: Vec<HopTable>,
    /// By species, where surfaces let it through while it diffuses; empty if there is no surface.
    pub(super) passages: Vec<Option<Passages>>,
}

impl Frozen {
    /// Freezes a geometry: `volumes` m³, `home` and `current` group of each voxel, `held` one flag per
    /// amount (voxel by voxel; empty if nothing is held). Species of equal habitat share one hop table.
    /// The result belongs to this `reactor`, whose reactions it sorts into sampled and integrated ones.
    ///
    /// # Errors
    /// Conductances that are negative or not finite, volumes that are not positive, lengths that differ.
    pub fn build(
        reactor: &Reactor,
        links: &Links,
        volumes: &[f64],
        home: &[u8],
        current: &[u8],
        held: &[bool],
    ) -> Result<Frozen, RunError> {
        Frozen::build_per_habitat(reactor, |_| Cow::Borrowed(links), volumes, home, current, held)
    }

    /// As [`Frozen::build`], with links that may differ from habitat to habitat: `links` makes those of the
    /// species that live in a set of home groups.
    ///
    /// # Errors
    /// As [`Frozen::build`].
    pub fn build_per_habitat<'l>(
        reactor: &Reactor,
        links: impl Fn(GroupSet) -> Cow<'l, Links>,
        volumes: &[f64],
        home: &[u8],
        current: &[u8],
        held: &[bool],
    ) -> Result<Frozen, RunError> {
        let (voxels, species) = (volumes.len(), reactor.species_count());
        let lengths = [
            ("home groups", home.len(), voxels),
            ("current groups", current.len(), voxels),
            ("held flags", held.len(), if held.is_empty() { 0 } else { voxels * species }),
        ];
        for (quantity, is, should) in lengths {
            if is != should {
                return Err(wrong_length(quantity, is, should, voxels));
            }
        }
        let mut tables = Vec::new();
        let mut habitats: Vec<GroupSet> = Vec::new();
        let mut table = Vec::with_capacity(species);
        for (&habitat, &diffusivity) in reactor.habitat.iter().zip(&reactor.diffusivity) {
            if diffusivity <= 0.0 {
                table.push(None);
                continue;
            }
            let index = match habitats.iter().position(|&h| h == habitat) {
                Some(index) => index,
                None => {
                    let links = links(habitat);
                    if links.voxels() != voxels {
                        return Err(wrong_length("rows of links", links.voxels(), voxels, voxels));
                    }
                    tables.push(HopTable::build(&links, volumes, |i| habitat.holds(home[i]))?);
                    habitats.push(habitat);
                    habitats.len() - 1
                }
            };
            table.push(Some(index as u32));
        }
        let is_held = |i: usize, s: usize| held.get(i * species + s).copied().unwrap_or(false);
        let held_voxels = (0..species)
            .map(|s| (0..voxels).filter(|&i| is_held(i, s)).map(|i| i as u32).collect())
            .collect();
        let (kinds, kind) = sort_into_kinds(reactor, home, current, |_| 0);
        Ok(Frozen {
            scales: volumes.iter().map(|&v| Scale::of(v)).collect(),
            held: held.to_vec(),
            home: home.to_vec(),
            held_voxels,
            kinds,
            kind,
            weights: Vec::new(),
            table,
            tables,
            passages: Vec::new(),
        })
    }

    /// Lets the surface reactions happen: of each, its number and the factor of its propensity in the voxels
    /// that face the surface. At most 64.
    #[must_use]
    pub fn with_surfaces(
        mut self,
        reactor: &Reactor,
        current: &[u8],
        surfaces: &[(usize, Vec<(u32, f64)>)],
    ) -> Frozen {
        if surfaces.is_empty() {
            return self;
        }
        self.weights = vec![Vec::new(); reactor.propensities.len()];
        let mut met = vec![0_u64; self.voxels()];
        let order = (0..reactor.surface.len()).filter(|&r| reactor.surface[r]);
        for (bit, r) in order.enumerate() {
            let row = &mut self.weights[r];
            row.resize(met.len(), 0.0);
            for &(i, weight) in surfaces.iter().filter(|(q, _)| *q == r).flat_map(|(_, list)| list) {
                row[i as usize] += weight;
                met[i as usize] |= u64::from(!passes_by_diffusion(reactor, r)) << bit;
            }
        }
        (self.kinds, self.kind) = sort_into_kinds(reactor, &self.home, current, |i| met[i]);
        self.passages =
            (0..reactor.species_count()).map(|s| Passages::new(reactor, &self, s, surfaces)).collect();
        self
    }

    /// Reactions that happen in a voxel where every hybrid species is discrete, rising: sampled, integrated. Molecules
    /// that diffuse pass surfaces while they do, so those reactions are not among them.
    #[must_use]
    pub fn reactions(&self, voxel: usize) -> (&[u32], &[u32]) {
        let lists = &self.kinds[self.kind[voxel] as usize].lists[0];
        (&lists.sampled, &lists.integrated)
    }

    /// Whether a reaction happens in some voxel, what diffusion carries through surfaces apart.
    #[must_use]
    pub fn reacts(&self) -> bool {
        let some = |lists: &Lists| !lists.sampled.is_empty() || !lists.integrated.is_empty();
        self.kinds.iter().any(|kind| kind.lists.iter().any(some))
    }

    /// Factor of the propensity of reaction `r` in a voxel: 1 but for surface reactions.
    #[inline]
    #[must_use]
    pub fn weight(&self, r: usize, voxel: usize) -> f64 {
        match self.weights.get(r) {
            Some(row) if !row.is_empty() => row[voxel],
            _ => 1.0,
        }
    }

    /// Number of voxels.
    #[must_use]
    pub fn voxels(&self) -> usize {
        self.scales.len()
    }

    /// How strongly reaction `r` acts in a voxel, a factor of its propensity: zero where it does not happen,
    /// [`Frozen::weight`] elsewhere.
    #[must_use]
    pub fn strength(&self, reactor: &Reactor, r: usize, voxel: usize) -> f64 {
        if reactor.surface[r] {
            return self.weights.get(r).and_then(|row| row.get(voxel)).copied().unwrap_or(0.0);
        }
        let (sampled, integrated) = self.reactions(voxel);
        let happens = sampled.iter().chain(integrated).any(|&q| q as usize == r);
        if happens { self.weight(r, voxel) } else { 0.0 }
    }

    /// Hop table of species `s`; `None` if it does not diffuse.
    #[must_use]
    pub fn table(&self, s: usize) -> Option<&HopTable> {
        self.table[s].map(|t| &self.tables[t as usize])
    }

    /// Whether the amount at `slot` (= voxel * species + species) is held.
    #[inline]
    #[must_use]
    pub fn is_held(&self, slot: usize) -> bool {
        !self.held.is_empty() && self.held[slot]
    }
}

/// Whether what a surface reaction changes diffuses, and passes the surface while it does.
fn passes_by_diffusion(reactor: &Reactor, r: usize) -> bool {
    reactor.propensities.changes(r).iter().any(|&(s, _)| reactor.diffusivity[s as usize] > 0.0)
}

fn wrong_length(quantity: &str, is: usize, should: usize, voxels: usize) -> RunError {
    let remedy = format!("expected {should}, one for each of {voxels} voxels");
    let (quantity, value) = (format!("number of {quantity}"), is as f64);
    RunError::BlowUp { step: 0, time: 0.0, particle: 0, quantity, value, remedy }
}
