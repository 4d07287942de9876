//! From the checked network to the reactor: representations, habitats, sources, the choice of method.

use super::Column;
use crate::chemistry::analysis::Analysis;
use crate::chemistry::network::{Named, Surface, SurfaceKind};
use crate::chemistry::reactor::Hybrid;
use crate::chemistry::{GroupSet, Network, Rate, Reaction, Reactor, Representation};
use crate::error::Fault;
use crate::model::conditions::What;
use crate::model::{Domain, Integrator, Material, Model};

/// The network with the conditions that act like reactions: one zero-order reaction for each source, one for each
/// species that enters or leaves through a surface.
#[must_use]
pub fn with_conditions(model: &Model) -> Network {
    let mut network = model.network.clone();
    let Domain::Particles(domain) = &model.domain else { return network };
    let mut surfaces = 0;
    for condition in &domain.conditions {
        let mut add = |s: usize, enters: bool, rate: Rate, only_in: Option<Vec<Named>>| {
            let name = network.species[s].name.clone();
            let (reactants, products) = if enters { (vec![], vec![(s, 1)]) } else { (vec![(s, 1)], vec![]) };
            network.reactions.push(Reaction {
                equation: if enters { format!("0 -> {name}") } else { format!("{name} -> 0") },
                name: format!("{} {name}", condition.name),
                reactants,
                products,
                rate,
                only_in,
                place: condition.place.clone(),
            });
        };
        match &condition.what {
            What::Source { group, species } => {
                let place = condition.place.clone();
                let group = Named { name: domain.groups[*group].name.clone(), place };
                for &(s, rate) in species {
                    add(s, true, Rate::MassAction(rate), Some(vec![group.clone()]));
                }
            }
            What::HeldSurface { species, .. } => {
                for &(s, concentration) in species {
                    let surface = |kind| Rate::Surface(Surface { number: surfaces, kind });
                    if concentration > 0.0 {
                        add(s, true, surface(SurfaceKind::Held(concentration)), None);
                    }
                    add(s, false, surface(SurfaceKind::Absorption(f64::INFINITY)), None);
                }
                surfaces += 1;
            }
            What::Flux { species, .. } => {
                for &(s, flux) in species {
                    let kind = SurfaceKind::Flux(flux);
                    add(s, true, Rate::Surface(Surface { number: surfaces, kind }), None);
                }
                surfaces += 1;
            }
            What::Absorbing { species, .. } => {
                for &(s, kappa) in species {
                    let kind = SurfaceKind::Absorption(kappa);
                    add(s, false, Rate::Surface(Surface { number: surfaces, kind }), None);
                }
                surfaces += 1;
            }
            _ => {}
        }
    }
    network
}

/// How each species is carried.
fn representation(model: &Model, network: &Network, s: usize) -> Representation {
    network.species[s].representation.unwrap_or(model.chemistry.representation)
}

/// Hybrid species.
#[must_use]
pub fn hybrid(model: &Model, network: &Network) -> Vec<usize> {
    let count = network.species.len();
    (0..count).filter(|&s| representation(model, network, s) == Representation::Hybrid).collect()
}

/// Whether each species is carried as whole molecules, hybrid ones included.
#[must_use]
pub fn discrete(model: &Model, network: &Network) -> Vec<bool> {
    let count = network.species.len();
    (0..count).map(|s| representation(model, network, s) != Representation::Continuous).collect()
}

/// Faults where forward Euler is asked for and cannot be had.
pub fn check_integrator(model: &Model, network: &Network, discrete: &[bool], faults: &mut Vec<Fault>) {
    if model.chemistry.integrator != Integrator::Euler {
        return;
    }
    let mut refuse =
        |reason: String, remedy: &str| faults.push(Fault::at(&model.places.chemistry, reason, remedy));
    if let Some(s) = discrete.iter().position(|&d| d) {
        refuse(
            format!(
                "integrator: euler is for continuous species, which `{}` is not",
                network.species[s].name
            ),
            "set representation: continuous, or remove `integrator`: whole molecules are sampled exactly",
        );
    }
    if model.chemistry.step.is_none() {
        refuse(
            "forward Euler takes the step it is given, and none is".into(),
            "add one, e.g. chemistry: { integrator: euler, step: 0.1 ms }",
        );
    }
    if matches!(&model.domain, Domain::Particles(domain) if domain.moves()) {
        refuse(
            "integrator: euler is for particles at rest, and these move".into(),
            "remove `integrator`, or set fluid: { method: none }",
        );
    }
}

/// Classes of volumes for `only_in`: the class of each volume, and for each named group its classes.
#[must_use]
pub fn classes(network: &Network, domain: &Domain) -> (Vec<u8>, Vec<Vec<u8>>) {
    let names = domain.group_names();
    let lists = network
        .species
        .iter()
        .filter_map(|s| s.only_in.as_ref())
        .chain(network.reactions.iter().filter_map(|r| r.only_in.as_ref()));
    let mut home = vec![0_u8; names.len()];
    let mut next = 1_u8;
    for named in lists.flatten() {
        if let Some(i) = names.iter().position(|name| *name == named.name)
            && home[i] == 0
            && next < 255
        {
            home[i] = next;
            next += 1;
        }
    }
    let groups = home.iter().map(|&class| vec![class]).collect();
    (home, groups)
}

fn set_of(only_in: Option<&Vec<Named>>, names: &[String], groups: &[Vec<u8>]) -> GroupSet {
    let Some(list) = only_in else { return GroupSet::ALL };
    let mut bits = 0;
    for named in list {
        if let Some(i) = names.iter().position(|name| *name == named.name) {
            bits |= groups[i]
                .iter()
                .fold(0, |bits, &class| bits | 1_u64.checked_shl(u32::from(class)).unwrap_or(0));
        }
    }
    GroupSet(bits)
}

/// The reactor; faults where a species is confined to a zone.
pub fn reactor(
    model: &Model,
    network: &Network,
    discrete: Vec<bool>,
    groups: &[Vec<u8>],
    faults: &mut Vec<Fault>,
) -> Reactor {
    let names = model.domain.group_names();
    let mut habitat: Vec<GroupSet> =
        network.species.iter().map(|species| set_of(species.only_in.as_ref(), &names, groups)).collect();
    if let Domain::Particles(domain) = &model.domain {
        let boundary = domain.groups.len();
        for (s, set) in habitat.iter_mut().enumerate() {
            for (g, group) in domain.groups.iter().enumerate() {
                if group.holds.as_ref().is_some_and(|held| !held.contains(&s))
                    || group.material == Material::Zone
                {
                    set.0 &= !(1 << g);
                }
            }
            set.0 &= !(1 << boundary); // walls round the box hold nothing
        }
        for species in &network.species {
            for named in species.only_in.iter().flatten() {
                if domain.group(&named.name).is_some_and(|g| domain.groups[g].material == Material::Zone) {
                    faults.push(Fault::at(
                        &named.place,
                        format!(
                            "`{}` is a zone that particles pass through; a species cannot be confined to it",
                            named.name
                        ),
                        "name the groups whose particles may carry the species; reactions may name zones",
                    ));
                }
            }
        }
    }
    let active: Vec<GroupSet> =
        network.reactions.iter().map(|r| set_of(r.only_in.as_ref(), &names, groups)).collect();
    let hybrid = hybrid(model, network);
    if hybrid.len() > Hybrid::MOST {
        faults.push(Fault::at(
            &model.places.chemistry,
            format!("{} species are hybrid; at most {} can be", hybrid.len(), Hybrid::MOST),
            "give those whose numbers stay small representation: discrete, and the abundant ones continuous",
        ));
    }
    let reactor = Reactor::new(network, &discrete, &habitat, &active);
    let reactor = if hybrid.len() > Hybrid::MOST {
        reactor
    } else {
        reactor.with_hybrid(network, hybrid, model.chemistry.above, model.chemistry.below)
    };
    let homes = match &model.domain {
        Domain::Particles(domain) => (1_u64 << domain.groups.len()) - 1,
        _ => u64::MAX,
    };
    for (reaction, livable) in network.reactions.iter().zip(&reactor.livable) {
        if livable.0 & homes == 0 {
            faults.push(Fault::at(
                &reaction.place,
                format!("reaction `{}` can happen nowhere", reaction.name),
                "no group holds all the species it changes; see their `only_in` and the groups' `holds`",
            ));
        }
    }
    reactor
}

/// What the series record: every group with every species that can be there, then the sum `all`.
#[must_use]
pub fn columns(model: &Model, reactor: &Reactor, groups: &[Vec<u8>]) -> Vec<Column> {
    let count = reactor.species.len();
    let mut found = Vec::new();
    if !matches!(model.domain, Domain::WellMixed { .. }) {
        for (g, classes) in groups.iter().enumerate() {
            for s in 0..count {
                if may_hold(model, reactor, g, classes, s) {
                    found.push(Column { group: Some(g), species: s });
                }
            }
        }
    }
    found.extend((0..count).map(|species| Column { group: None, species }));
    found
}

/// Whether group `g` may ever hold species `s`; a zone holds what some group of fluid holds.
fn may_hold(model: &Model, reactor: &Reactor, g: usize, classes: &[u8], s: usize) -> bool {
    if let Domain::Particles(domain) = &model.domain
        && domain.groups[g].material == Material::Zone
    {
        return domain.groups.iter().enumerate().any(|(other, group)| {
            matches!(group.material, Material::Fluid | Material::Solid | Material::Surface)
                && reactor.habitat[s].holds(other as u8)
        });
    }
    classes.iter().any(|&class| reactor.habitat[s].holds(class))
}

/// Conserved sums in words and their coefficients by species.
#[must_use]
pub fn conservation_laws(network: &Network, analysis: &Analysis) -> Vec<(String, Vec<f64>)> {
    analysis
        .conservation
        .iter()
        .map(|law| {
            let coefficients: Vec<f64> = law.iter().map(|&c| c as f64).collect();
            let mut words = String::new();
            for (species, &c) in network.species.iter().zip(law) {
                if c == 0 {
                    continue;
                }
                let sign = match (words.is_empty(), c < 0) {
                    (true, false) => "",
                    (true, true) => "-",
                    (false, false) => " + ",
                    (false, true) => " - ",
                };
                words.push_str(sign);
                if c.abs() != 1 {
                    words.push_str(&format!("{} ", c.abs()));
                }
                words.push_str(&species.name);
            }
            (words, coefficients)
        })
        .collect()
}

/// Two immobile species X and Y conserved as X + Y, where X and another species bind to Y: (X, Y).
/// Their fraction Y/(X + Y) is the occupancy.
#[must_use]
pub fn receptor_pairs(network: &Network, analysis: &Analysis) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for law in &analysis.conservation {
        let members: Vec<usize> = (0..law.len()).filter(|&s| law[s] != 0).collect();
        let [a, b] = members[..] else { continue };
        if law[a] != law[b] || network.species[a].diffusion > 0.0 || network.species[b].diffusion > 0.0 {
            continue;
        }
        let binds = |from: usize, to: usize| {
            network.reactions.iter().any(|r| {
                r.reactants.iter().any(|&(s, _)| s == from)
                    && r.products.iter().any(|&(s, _)| s == to)
                    && r.order() == 2
            })
        };
        if binds(a, b) {
            pairs.push((a, b));
        } else if binds(b, a) {
            pairs.push((b, a));
        }
    }
    pairs
}
