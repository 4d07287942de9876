//! One frozen geometry, built once per chemistry step and shared by all realizations of a flow.

use crate::chemistry::diffusion::HopTable;
use crate::chemistry::links::Links;
use crate::chemistry::propensity::Scale;
use crate::chemistry::reactor::{GroupSet, Reactor};
use crate::error::RunError;
use std::borrow::Cow;

/// Reactions that happen in voxels of one pair of home and current group.
#[derive(Clone, Debug)]
pub(super) struct Kind {
    groups: (u8, u8),
    pub sampled: Vec<u32>,
    pub integrated: Vec<u32>,
}

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
    /// Table of each species; `None` for those that do not diffuse.
    pub(super) table: Vec<Option<u32>>,
    pub(super) tables: Vec<HopTable>,
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
        let (kinds, kind) = sort_into_kinds(reactor, home, current);
        Ok(Frozen {
            scales: volumes.iter().map(|&v| Scale::of(v)).collect(),
            held: held.to_vec(),
            home: home.to_vec(),
            held_voxels,
            kinds,
            kind,
            table,
            tables,
        })
    }

    /// Number of voxels.
    #[must_use]
    pub fn voxels(&self) -> usize {
        self.scales.len()
    }

    /// How strongly reaction `r` acts in `voxel`, a factor of its propensity: 1 where it happens, 0 elsewhere.
    #[must_use]
    pub fn weight(&self, voxel: usize, r: usize) -> f64 {
        let kind = &self.kinds[self.kind[voxel] as usize];
        let happens = kind.sampled.iter().chain(&kind.integrated).any(|&q| q as usize == r);
        if happens { 1.0 } else { 0.0 }
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

fn wrong_length(quantity: &str, is: usize, should: usize, voxels: usize) -> RunError {
    let remedy = format!("expected {should}, one for each of {voxels} voxels");
    let (quantity, value) = (format!("number of {quantity}"), is as f64);
    RunError::BlowUp { step: 0, time: 0.0, particle: 0, quantity, value, remedy }
}

/// The distinct pairs of groups with their reactions, and the pair of each voxel.
fn sort_into_kinds(reactor: &Reactor, home: &[u8], current: &[u8]) -> (Vec<Kind>, Vec<u32>) {
    let mut kinds: Vec<Kind> = Vec::new();
    let mut last = 0;
    let mut kind = Vec::with_capacity(home.len());
    for groups in home.iter().copied().zip(current.iter().copied()) {
        if kinds.get(last).is_none_or(|k| k.groups != groups) {
            last = kinds.iter().position(|k| k.groups == groups).unwrap_or_else(|| {
                let here =
                    (0..reactor.propensities.len()).filter(|&r| reactor.happens(r, groups.0, groups.1));
                let (sampled, integrated): (Vec<u32>, Vec<u32>) =
                    here.map(|r| r as u32).partition(|&r| reactor.propensities.stochastic(r as usize));
                kinds.push(Kind { groups, sampled, integrated });
                kinds.len() - 1
            });
        }
        kind.push(last as u32);
    }
    (kinds, kind)
}
