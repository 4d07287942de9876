//! The amounts at the start, from what the user stated and the volumes there are.

use super::{Arena, ParticlePlan, Plan};
use crate::chemistry::AVOGADRO;
use crate::chemistry::deal::apportion;
use crate::chemistry::reactor::MOST_MOLECULES;
use crate::chemistry::sampling_numbers::poisson;
use crate::error::{Fault, ModelError, Place};
use crate::geometry::shape::embed;
use crate::model::conditions::What;
use crate::model::{Amount, Deal, Domain, Initial, Material};
use crate::quantity::readable::show_vector;
use crate::random::{Purpose, stream};
use crate::solid::Birth;
use crate::vector::Vector;

/// Voxels as they are at an instant, one entry each.
pub struct Voxels<'a> {
    /// m; zero in compartments.
    pub positions: &'a [Vector<3>],
    /// m³.
    pub volumes: &'a [f64],
    pub home: &'a [u8],
    pub current: &'a [u8],
}

/// Amounts at the start, voxel by voxel; the Poisson part is dealt anew in each realization.
#[derive(Clone, Debug, Default)]
pub struct Start {
    /// `amounts[voxel * species + s]`, molecules.
    pub amounts: Vec<f64>,
    /// Index into `amounts` and mean.
    pub poisson: Vec<(u32, f64)>,
    /// Whether an amount is held.
    pub held: Vec<bool>,
    /// Held amounts that are dealt Poisson at every step: species, voxels, means.
    pub held_poisson: Vec<(usize, Vec<u32>, Vec<f64>)>,
    /// Concentrations that are held in particles whose volumes change with the solid they are part of.
    pub held_in_solids: Vec<HeldConcentration>,
}

/// A concentration that is held whatever becomes of the volumes.
#[derive(Clone, Debug)]
pub struct HeldConcentration {
    pub species: usize,
    pub voxels: Vec<u32>,
    /// mol/m³.
    pub concentrations: Vec<f64>,
    /// Whether whole molecules are dealt Poisson anew at every step.
    pub poisson: bool,
}

impl Start {
    /// Amounts of a realization, named by the seed of the run and its number.
    #[must_use]
    pub fn deal(&self, (seed, realization): (u64, u64)) -> Vec<f64> {
        let mut amounts = self.amounts.clone();
        let mut random = stream(seed, realization, Purpose::Deal);
        for &(index, mean) in &self.poisson {
            amounts[index as usize] += poisson(&mut random, mean) as f64;
        }
        amounts
    }

    /// Amounts with means where they are dealt.
    #[must_use]
    pub fn means(&self) -> Vec<f64> {
        let mut amounts = self.amounts.clone();
        for &(index, mean) in &self.poisson {
            amounts[index as usize] += mean;
        }
        amounts
    }
}

impl Start {
    /// Takes in particles that came into being, in order: what is held in the donor to whose group they belong is held in
    /// them too, a concentration at the mean of the donors that hold it, while a number of molecules is shared out.
    pub fn bear(&mut self, births: &[Birth], species: usize) {
        if !self.held.contains(&true) {
            return;
        }
        for birth in births {
            let parent = birth.parent();
            for s in 0..species {
                self.held[birth.particle * species + s] = self.held[parent * species + s];
            }
            // Places of the donors among voxels, if their parent is one of them, and what they give.
            let among = |voxels: &[u32]| -> Vec<(usize, f64)> {
                let place = |donor: usize| voxels.iter().position(|&voxel| voxel as usize == donor);
                if place(parent).is_none() {
                    return Vec::new();
                }
                birth.donors.iter().filter_map(|(donor, part)| Some((place(*donor)?, *part))).collect()
            };
            for held in &mut self.held_in_solids {
                let ends = among(&held.voxels);
                if ends.is_empty() {
                    continue;
                }
                let sum: f64 = ends.iter().map(|(end, _)| held.concentrations[*end]).sum();
                held.voxels.push(birth.particle as u32);
                held.concentrations.push(sum / ends.len() as f64);
            }
            for (_, voxels, means) in &mut self.held_poisson {
                let ends = among(voxels);
                if ends.is_empty() {
                    continue;
                }
                let mut given = 0.0;
                for (end, part) in ends {
                    given += part * means[end];
                    means[end] *= 1.0 - part;
                }
                voxels.push(birth.particle as u32);
                means.push(given);
            }
        }
    }
}

/// Works out the start.
#[must_use]
pub fn start(plan: &Plan, voxels: &Voxels) -> Start {
    let count = plan.reactor.species.len();
    let mut start = Start {
        amounts: vec![0.0; voxels.volumes.len() * count],
        held: vec![false; voxels.volumes.len() * count],
        ..Start::default()
    };
    // What is said of a zone takes the place of what is said of the groups it overlaps.
    let (zones, groups): (Vec<&Initial>, Vec<&Initial>) =
        plan.model.initial.iter().partition(|entry| is_zone(plan, entry.group));
    for entry in groups.into_iter().chain(zones) {
        let members = members(plan, voxels, entry.group, entry.species);
        if is_zone(plan, entry.group) {
            let mut replaced = vec![false; start.amounts.len()];
            for &i in &members {
                replaced[i * count + entry.species] = true;
                start.amounts[i * count + entry.species] = 0.0;
            }
            start.poisson.retain(|(slot, _)| !replaced[*slot as usize]);
        }
        for (i, mean) in means(plan, voxels, &members, entry.species, &entry.amount, entry.deal) {
            let index = i * count + entry.species;
            if entry.deal == Deal::Poisson && plan.reactor.discrete[entry.species] {
                start.poisson.push((index as u32, mean));
            } else {
                start.amounts[index] += mean;
            }
        }
    }
    if let Some(held) = held_plans(plan) {
        for held in held {
            for (s, amount) in &held.species {
                let members = members(plan, voxels, Some(usize::from(held.group)), *s);
                let means = means(plan, voxels, &members, *s, amount, held.deal);
                for &(i, mean) in &means {
                    start.held[i * count + s] = true;
                    start.amounts[i * count + s] = mean;
                }
                let poisson = held.deal == Deal::Poisson && plan.reactor.discrete[*s];
                if matches!(amount, Amount::Concentration(_) | Amount::Field(_)) {
                    let own = means.iter().filter(|(i, _)| in_solid(plan, voxels.home[*i]));
                    let own: Vec<(usize, f64)> = own.copied().collect();
                    start.held_in_solids.push(HeldConcentration {
                        species: *s,
                        voxels: own.iter().map(|(i, _)| *i as u32).collect(),
                        concentrations: own
                            .iter()
                            .map(|(i, mean)| mean / (AVOGADRO * voxels.volumes[*i]))
                            .collect(),
                        poisson,
                    });
                }
                if poisson {
                    let (voxels, means) = means.into_iter().map(|(i, mean)| (i as u32, mean)).unzip();
                    start.held_poisson.push((*s, voxels, means));
                }
            }
        }
    }
    // A reservoir is what it is held at, whatever was stated for the start.
    let held = &start.held;
    start.poisson.retain(|(slot, _)| !held[*slot as usize]);
    start
}

/// Whether the particles of a home group are part of an elastic solid.
fn in_solid(plan: &Plan, home: u8) -> bool {
    let Domain::Particles(domain) = &plan.model.domain else { return false };
    let elastic = |material| matches!(material, Material::Solid | Material::Surface);
    domain.groups.get(usize::from(home)).is_some_and(|group| elastic(group.material))
}

/// Refuses fields that are negative or undefined somewhere, and more whole molecules than can be counted.
///
/// # Errors
/// All faults, each at the amount in the model.
pub fn check_amounts(plan: &Plan, voxels: &Voxels) -> Result<(), ModelError> {
    let mut faults = Vec::new();
    for entry in &plan.model.initial {
        let members = members(plan, voxels, entry.group, entry.species);
        if let Some(fault) = bad_amount(plan, voxels, &members, entry.species, &entry.amount, &entry.place) {
            faults.push(fault);
        }
    }
    if let Domain::Particles(domain) = &plan.model.domain {
        for condition in &domain.conditions {
            if let What::Open { species, .. } = &condition.what {
                faults.extend(
                    species.iter().filter_map(|(s, amount)| entering(plan, *s, amount, &condition.place)),
                );
            }
            let (What::Sponge { group, species, .. } | What::Held { group, species, .. }) = &condition.what
            else {
                continue;
            };
            for (s, amount) in species {
                let members = members(plan, voxels, Some(*group), *s);
                faults.extend(bad_amount(plan, voxels, &members, *s, amount, &condition.place));
            }
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(ModelError { faults }) }
}

fn bad_amount(
    plan: &Plan,
    voxels: &Voxels,
    members: &[usize],
    species: usize,
    amount: &Amount,
    place: &Place,
) -> Option<Fault> {
    if let Some(fault) = bad_field(plan, members.iter().map(|&i| voxels.positions[i]), species, amount, place)
    {
        return Some(fault);
    }
    let name = &plan.reactor.species[species];
    let total: f64 =
        means(plan, voxels, members, species, amount, Deal::Poisson).iter().map(|(_, n)| n).sum();
    if plan.reactor.discrete[species] && total > MOST_MOLECULES {
        return Some(Fault::at(
            place,
            format!("{total:.3e} molecules of `{name}` are more than can be counted one by one (9e15)"),
            "make the volume smaller, or give the species representation: continuous",
        ));
    }
    None
}

/// A field that is negative or undefined at one of the places (m).
fn bad_field(
    plan: &Plan,
    places: impl Iterator<Item = Vector<3>>,
    species: usize,
    amount: &Amount,
    place: &Place,
) -> Option<Fault> {
    let Amount::Field(program) = amount else { return None };
    let values: Vec<(f64, Vector<3>)> = places.map(|x| (program.eval(x.as_slice()), x)).collect();
    let largest = values.iter().fold(0.0_f64, |largest, (v, _)| largest.max(v.abs()));
    // A sum that should vanish may fall short of zero by rounding.
    let (value, x) = values.iter().find(|(v, _)| !(*v >= -1e-12 * largest && v.is_finite()))?;
    Some(Fault::at(
        place,
        format!(
            "the concentration of `{}` is {value:.4e} mol/m^3 at {}",
            plan.reactor.species[species],
            show_vector(x.as_slice(), "m")
        ),
        "a concentration is a finite number, zero or more; max(0, ...) cuts off what lies below",
    ))
}

/// A field that would enter with the fluid and is no concentration somewhere in the buffers beyond the ends.
fn entering(plan: &Plan, species: usize, amount: &Amount, place: &Place) -> Option<Fault> {
    fn buffers<const D: usize>(plan: &ParticlePlan<D>) -> Vec<Vector<3>> {
        let Some(openings) = &plan.openings else { return Vec::new() };
        let (k, fluid) = (openings.open.axis, openings.open.fluid);
        let beyond = |x: &Vector<D>| x[k] < plan.domain.min[k] || x[k] > plan.domain.max[k];
        let all = plan.particles.iter().filter(|p| p.body == fluid && beyond(&p.position));
        all.map(|p| embed(&p.position)).collect()
    }
    let places = match &plan.arena {
        Arena::Compartments(_) => Vec::new(),
        Arena::Line(p) => buffers(p),
        Arena::Plane(p) => buffers(p),
        Arena::Space(p) => buffers(p),
    };
    bad_field(plan, places.into_iter(), species, amount, place)
}

fn is_zone(plan: &Plan, group: Option<usize>) -> bool {
    match (&plan.model.domain, group) {
        (Domain::Particles(domain), Some(g)) => domain.groups[g].material == Material::Zone,
        _ => false,
    }
}

fn held_plans(plan: &Plan) -> Option<&[super::particles::HeldPlan]> {
    match &plan.arena {
        Arena::Compartments(_) => None,
        Arena::Line(p) => Some(&p.held),
        Arena::Plane(p) => Some(&p.held),
        Arena::Space(p) => Some(&p.held),
    }
}

/// Voxels of a group (or everywhere) in which the species may live.
fn members(plan: &Plan, voxels: &Voxels, group: Option<usize>, species: usize) -> Vec<usize> {
    let compartments = matches!(plan.arena, Arena::Compartments(_));
    (0..voxels.volumes.len())
        .filter(|&i| plan.reactor.habitat[species].holds(voxels.home[i]))
        .filter(|&i| match group {
            None => true,
            Some(g) if compartments => i == g,
            Some(g) => usize::from(voxels.home[i]) == g || usize::from(voxels.current[i]) == g,
        })
        .collect()
}

/// Mean molecules of a species in each member; whole numbers where they are dealt evenly to a discrete species.
fn means(
    plan: &Plan,
    voxels: &Voxels,
    members: &[usize],
    species: usize,
    amount: &Amount,
    deal: Deal,
) -> Vec<(usize, f64)> {
    let volume = |i: usize| voxels.volumes[i];
    let weights: Vec<f64> = match amount {
        Amount::Molecules(_) => members.iter().map(|&i| volume(i)).collect(),
        Amount::PerParticle(n) => vec![*n; members.len()],
        Amount::Concentration(c) => members.iter().map(|&i| c * volume(i) * AVOGADRO).collect(),
        Amount::Field(program) => members
            .iter()
            .map(|&i| program.eval(voxels.positions[i].as_slice()).max(0.0) * volume(i) * AVOGADRO)
            .collect(),
        Amount::At(place, n) => {
            let nearest = members.iter().copied().min_by(|&a, &b| {
                let far = |i: usize| (voxels.positions[i] - place).norm_squared();
                far(a).total_cmp(&far(b))
            });
            return nearest.map(|i| (i, *n)).into_iter().collect();
        }
    };
    let sum: f64 = weights.iter().sum();
    let total = if let Amount::Molecules(n) = amount { *n } else { sum };
    let even = plan.reactor.discrete[species] && deal == Deal::Even;
    let shares: Vec<f64> = if even {
        apportion(total.round() as u64, &weights).into_iter().map(|n| n as f64).collect()
    } else {
        weights.iter().map(|w| if sum > 0.0 { total * w / sum } else { 0.0 }).collect()
    };
    members.iter().copied().zip(shares).collect()
}

/// Target of a sponge in each of its voxels, molecules.
#[must_use]
pub fn sponge_targets(voxels: &Voxels, members: &[u32], amount: &Amount) -> Vec<f64> {
    members
        .iter()
        .map(|&i| {
            let i = i as usize;
            let concentration = match amount {
                Amount::Concentration(c) => *c,
                Amount::Field(program) => program.eval(voxels.positions[i].as_slice()).max(0.0),
                _ => 0.0, // refused when the model is read
            };
            concentration * voxels.volumes[i] * AVOGADRO
        })
        .collect()
}

/// Amounts stated where their species cannot live.
pub fn check(plan: &Plan, faults: &mut Vec<Fault>) {
    let names = plan.model.domain.group_names();
    for Initial { group, species, place, amount, .. } in &plan.model.initial {
        if matches!(amount, Amount::Molecules(n) if *n == 0.0) {
            continue; // none where none can live
        }
        let name = &plan.reactor.species[*species];
        let Some(g) = *group else { continue };
        let fits = plan.columns.iter().any(|column| column.group == Some(g) && column.species == *species);
        if !fits {
            faults.push(Fault::at(
                place,
                format!("`{name}` cannot live in `{}`", names[g]),
                "its `only_in`, or the group's `holds`, excludes it; change one of them or remove this amount",
            ));
        }
    }
    if let Domain::Particles(domain) = &plan.model.domain {
        for (s, species) in plan.network.species.iter().enumerate() {
            let anywhere = (0..domain.groups.len()).any(|g| {
                plan.reactor.habitat[s].holds(g as u8) && domain.groups[g].material != Material::Zone
            });
            if !anywhere {
                faults.push(Fault::at(
                    &species.place,
                    format!("`{}` can live nowhere", species.name),
                    "no group both is named in its `only_in` and holds it",
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_born_of_held_particles_is_held() {
        // Species 1 is held in particles 0, 1 and 2, in 0 and 1 as a Poisson number.
        let mut start = Start {
            held: vec![false, true, false, true, false, true, false, false, false, false],
            held_poisson: vec![(1, vec![0, 1], vec![8.0, 4.0])],
            held_in_solids: vec![HeldConcentration {
                species: 1,
                voxels: vec![1, 2],
                concentrations: vec![1.0, 3.0],
                poisson: false,
            }],
            ..Start::default()
        };
        let birth = |particle, a, b| Birth { particle, donors: [(a, 0.25), (b, 0.5)] };
        start.bear(&[birth(3, 0, 1), birth(4, 2, 3)], 2);
        assert_eq!(start.held[6..], [false, true, false, true]);
        // The second belongs to one that is dealt Poisson; the other donor is not and gives nothing.
        assert_eq!(start.held_poisson, [(1, vec![0, 1, 3, 4], vec![6.0, 2.0, 2.0, 2.0])]);
        // A concentration is that of the donors that hold one.
        let held = &start.held_in_solids[0];
        assert_eq!(
            (held.voxels.as_slice(), held.concentrations.as_slice()),
            (&[1, 2, 3, 4][..], &[1.0, 3.0, 1.0, 2.0][..])
        );
        // What belongs to a donor that is not held is not held either, whoever the other one is.
        start.held.extend([false; 4]);
        start.bear(&[birth(6, 2, 5)], 2);
        assert_eq!(start.held[10..], [false; 4]);
    }
}
