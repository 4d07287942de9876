//! What the record of a run says before it runs: model, domain, species, reactions, conditions, probes.

use super::states::FORMAT;
use crate::chemistry::words;
use crate::model::{Boundary, Domain, Material, Model, ProbeShape};
use crate::plan::chemistry::receptor_pairs;
use crate::plan::{Arena, Plan};
use crate::record::{
    DomainRecord, GroupRecord, Health, HistogramRecord, Performance, ProbeRecord, ReactionRecord, RunRecord,
    SpeciesRecord,
};
use crate::sampling::{self, probe::occupancy_name};
use crate::simulation::Ready;
use std::collections::BTreeMap;
use std::ops::Range;

/// The record of a block before it runs.
#[must_use]
pub fn record(plan: &Plan, block: &Range<u32>, ready: &Ready, threads: usize) -> RunRecord {
    let model = &plan.model;
    let names = model.domain.group_names();
    RunRecord {
        program: "gillesph".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        format: FORMAT,
        status: "running".into(),
        error: None,
        name: model.name.clone(),
        description: model.description.clone(),
        model: model.text.clone(),
        seed: model.run.seed,
        realizations: [block.start, block.end],
        finished: 0,
        times: model.output.times.clone(),
        domain: domain(plan),
        species: plan
            .network
            .species
            .iter()
            .enumerate()
            .map(|(s, species)| SpeciesRecord {
                name: species.name.clone(),
                diffusion: species.diffusion,
                representation: plan.representation(s).into(),
                only_in: species.only_in.iter().flatten().map(|named| named.name.clone()).collect(),
            })
            .collect(),
        reactions: (0..plan.network.reactions.len())
            .map(|r| ReactionRecord {
                name: plan.network.reactions[r].name.clone(),
                equation: plan.network.reactions[r].equation.clone(),
                propensity: words::propensity_words(&plan.network, &plan.network.reactions[r]),
            })
            .collect(),
        conservation_laws: plan.conservation_laws().into_iter().map(|(words, _)| words).collect(),
        conditions: conditions(model),
        probes: probes(plan).into_iter().chain(sampling::solids::records(&plan.model)).collect(),
        histograms: model
            .output
            .histograms
            .iter()
            .map(|h| HistogramRecord {
                group: h.group.map_or_else(|| "all".into(), |g| names[g].clone()),
                species: plan.reactor.species[h.species].clone(),
                times: h.times.clone(),
            })
            .collect(),
        fluid: ready.fluid(),
        solids: ready.solids(),
        steps: ready.steps(),
        precision: None,
        hybrid: Vec::new(),
        health: Health::default(),
        performance: Performance { threads, ..Performance::default() },
    }
}

fn domain(plan: &Plan) -> DomainRecord {
    let counts = |home: &[u8], volumes: &mut dyn Iterator<Item = f64>, g: usize| -> (usize, f64) {
        let mut found = (0, 0.0);
        for (&h, v) in home.iter().zip(volumes) {
            if usize::from(h) == g {
                found = (found.0 + 1, found.1 + v);
            }
        }
        found
    };
    match &plan.model.domain {
        Domain::WellMixed { volume } => DomainRecord {
            kind: "well_mixed".into(),
            groups: vec![GroupRecord {
                name: "all".into(),
                material: "volume".into(),
                particles: 1,
                volume: *volume,
                ..GroupRecord::default()
            }],
            ..DomainRecord::default()
        },
        Domain::Graph { volumes, names, .. } => DomainRecord {
            kind: "graph".into(),
            groups: names
                .iter()
                .zip(volumes)
                .map(|(name, &volume)| GroupRecord {
                    name: name.clone(),
                    material: "volume".into(),
                    particles: 1,
                    volume,
                    ..GroupRecord::default()
                })
                .collect(),
            ..DomainRecord::default()
        },
        Domain::Particles(domain) => {
            let d = domain.dimensions;
            let (min, max) = (&domain.min, &domain.max);
            let groups = domain
                .groups
                .iter()
                .enumerate()
                .map(|(g, group)| {
                    let (particles, volume) = match &plan.arena {
                        Arena::Compartments(_) => (0, 0.0),
                        Arena::Line(p) => {
                            counts(&p.home, &mut p.particles.iter().map(|q| q.volume * p.thickness), g)
                        }
                        Arena::Plane(p) => {
                            counts(&p.home, &mut p.particles.iter().map(|q| q.volume * p.thickness), g)
                        }
                        Arena::Space(p) => {
                            counts(&p.home, &mut p.particles.iter().map(|q| q.volume * p.thickness), g)
                        }
                    };
                    GroupRecord {
                        name: group.name.clone(),
                        material: match (group.material, domain.fluid.is_some()) {
                            (Material::Zone, _) => "zone",
                            (Material::Wall { .. }, _) => "wall",
                            (Material::Solid, _) => "solid",
                            (Material::Surface, _) => "surface",
                            (Material::Fluid, true) => "fluid",
                            (Material::Fluid, false) => "static",
                        }
                        .into(),
                        particles,
                        volume,
                        shape: group.shape.words(d),
                        outlines: if d == 2 { group.shape.outlines(min, max) } else { Vec::new() },
                    }
                })
                .collect();
            DomainRecord {
                kind: "particles".into(),
                dimensions: d,
                min: min.as_slice()[..d].to_vec(),
                max: max.as_slice()[..d].to_vec(),
                thickness: domain.thickness,
                boundaries: domain
                    .boundaries
                    .iter()
                    .map(|boundary| {
                        match boundary {
                            Boundary::Periodic => "periodic",
                            Boundary::NoSlip => "no_slip",
                            Boundary::FreeSlip => "free_slip",
                            Boundary::Open => "open",
                        }
                        .into()
                    })
                    .collect(),
                groups,
            }
        }
    }
}

/// Conditions in words.
#[must_use]
pub fn conditions(model: &Model) -> Vec<String> {
    use crate::model::conditions::{EndModel, WallMotion, WallName, What};
    use crate::model::names::axis_name;
    use crate::quantity::readable::{show, show_vector, significant};
    let Domain::Particles(domain) = &model.domain else { return Vec::new() };
    let group = |g: usize| domain.groups[g].name.as_str();
    let d = domain.dimensions;
    let vector = |v: &crate::vector::Vector<3>, unit: &str| {
        show_vector(&(0..d).map(|k| v[k]).collect::<Vec<f64>>(), unit)
    };
    let species = |list: &[(usize, crate::model::Amount)]| -> String {
        list.iter().map(|(s, _)| model.network.species[*s].name.as_str()).collect::<Vec<_>>().join(", ")
    };
    let name = |s: usize| model.network.species[s].name.as_str();
    let wall_name = |wall: &WallName| match wall {
        WallName::Group(g) => group(*g).to_string(),
        WallName::Side { axis, upper } => {
            format!("{}_{}", axis_name(*axis), if *upper { "max" } else { "min" })
        }
    };
    domain
        .conditions
        .iter()
        .map(|condition| {
            let words = match &condition.what {
                What::Sponge { group: g, rate, velocity, species: list } => {
                    let mut words = format!("sponge in {}, rate {} 1/s", group(*g), significant(*rate, 4));
                    if let Some(v) = velocity {
                        words.push_str(&format!(", velocity {}", vector(v, "m/s")));
                    }
                    if !list.is_empty() {
                        words.push_str(&format!(", concentration of {}", species(list)));
                    }
                    words
                }
                What::Held { group: g, species: list, deal } => {
                    let how = if *deal == crate::model::Deal::Poisson {
                        "with a Poisson number"
                    } else {
                        "at a fixed number"
                    };
                    format!("{} held in {} {how}", species(list), group(*g))
                }
                What::Source { group: g, species: list } => {
                    let names: Vec<&str> =
                        list.iter().map(|(s, _)| model.network.species[*s].name.as_str()).collect();
                    format!("source of {} in {}", names.join(", "), group(*g))
                }
                What::Barrier { axis, at } => {
                    let at = if *at == 0.0 { "0".into() } else { show_vector(&[*at], "m") };
                    format!("no diffusion across {} = {at}", axis_name(*axis))
                }
                What::MovingWall { wall, motion: WallMotion::Deform(_) } => {
                    format!("deforming wall {}", wall_name(wall))
                }
                What::MovingWall { wall, .. } => format!("moving wall {}", wall_name(wall)),
                What::FreeBody { group: g, body } => {
                    format!("free body {} of {} kg/m³", group(*g), significant(body.density, 4))
                }
                What::Open { axis, upper, end, species: list } => {
                    let at = format!("{}_{}", axis_name(*axis), if *upper { "max" } else { "min" });
                    let what = match end {
                        EndModel::Velocity(_) => "at a given velocity".to_string(),
                        EndModel::Pressure(pressure) => format!("at {} Pa", significant(*pressure, 4)),
                    };
                    match list.is_empty() {
                        true => format!("open end {at} {what}"),
                        false => format!("open end {at} {what}, with {}", species(list)),
                    }
                }
                What::Flux { wall, species } => {
                    let each = species
                        .iter()
                        .map(|&(s, flux)| format!("{} {} 1/m²/s", name(s), significant(flux, 4)));
                    format!("flux through {}: {}", wall_name(wall), each.collect::<Vec<_>>().join(", "))
                }
                What::Absorbing { wall, species } => {
                    let each = species.iter().map(|&(s, kappa)| match kappa.is_finite() {
                        true => format!("{} at {} m/s", name(s), significant(kappa, 4)),
                        false => format!("{} perfectly", name(s)),
                    });
                    format!("{} absorbs {}", wall_name(wall), each.collect::<Vec<_>>().join(", "))
                }
                What::HeldSurface { wall, species } => {
                    let values: Vec<String> = species
                        .iter()
                        .map(|&(s, c)| format!("{} at {}", name(s), show(c, "mol/m^3")))
                        .collect();
                    format!("surface of {} holds {}", wall_name(wall), values.join(", "))
                }
                What::Buoyancy { gravity, species } => {
                    let parts: Vec<String> = species
                        .iter()
                        .map(|e| {
                            format!(
                                "{} ({} per concentration, none at {})",
                                name(e.species),
                                show(e.expansion, "m^3/mol"),
                                show(e.reference, "mol/m^3")
                            )
                        })
                        .collect();
                    format!("buoyancy by {} in gravity {}", parts.join(", "), vector(gravity, "m/s²"))
                }
                What::Force { acceleration } => format!("body force {}", vector(acceleration, "m/s²")),
            };
            format!("{}: {words}", condition.name)
        })
        .collect()
}

fn probes(plan: &Plan) -> Vec<ProbeRecord> {
    let moving = matches!(&plan.model.domain, Domain::Particles(domain) if domain.fluid.is_some());
    let d = match &plan.model.domain {
        Domain::Particles(domain) => domain.dimensions,
        _ => 0,
    };
    plan.model
        .output
        .probes
        .iter()
        .map(|probe| {
            let mut quantities: BTreeMap<String, String> =
                probe.species.iter().map(|&s| (plan.reactor.species[s].clone(), "mol/m^3".into())).collect();
            let kind = match probe.shape {
                ProbeShape::Line { .. } => "line",
                ProbeShape::Ring { .. } => "ring",
                ProbeShape::Surface { .. } => "surface",
            };
            if kind == "surface" {
                quantities = sampling::probe::supplied(plan, probe)
                    .into_iter()
                    .map(|s| (sampling::probe::supply_name(plan, s), "mol/s".into()))
                    .collect();
            }
            if kind == "line" && probe.velocity && moving {
                for axis in 0..d {
                    quantities.insert(format!("v{}", crate::model::names::axis_name(axis)), "m/s".into());
                }
            }
            if kind == "ring" {
                for (free, bound) in receptor_pairs(&plan.network, &plan.analysis) {
                    if probe.species.contains(&free) && probe.species.contains(&bound) {
                        quantities.insert(occupancy_name(plan, bound), "1".into());
                    }
                }
            }
            ProbeRecord { name: probe.name.clone(), kind: kind.into(), quantities }
        })
        .collect()
}
