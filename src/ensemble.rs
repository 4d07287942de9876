//! A block of realizations from plan to results: who runs, what is kept, what the record says.

use crate::chemistry::words;
use crate::error::RunError;
use crate::model::{Boundary, Domain, Material, Model, ProbeShape};
use crate::plan::chemistry::receptor_pairs;
use crate::plan::{Arena, Plan};
use crate::record::{
    ConservationRecord, DomainRecord, GroupRecord, Health, HistogramRecord, Performance, ProbeRecord,
    ReactionRecord, RunRecord, SpeciesRecord,
};
use crate::results::Results;
use crate::sampling::{self, probe::occupancy_name};
use crate::simulation::{Outcome, Ready, Tally};
use crate::tables::{Columns, SeriesBlock};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The record of a block before it runs.
#[must_use]
pub fn record(plan: &Plan, block: &Range<u32>, ready: &Ready, threads: usize) -> RunRecord {
    let model = &plan.model;
    let names = model.domain.group_names();
    RunRecord {
        program: "gillesph".into(),
        version: env!("CARGO_PKG_VERSION").into(),
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
        probes: probes(plan),
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
        steps: ready.steps(),
        hybrid: Vec::new(),
        health: Health::default(),
        performance: Performance { threads, ..Performance::default() },
    }
}

/// Results without any realization yet.
#[must_use]
pub fn empty(plan: &Plan, record: RunRecord) -> Results {
    Results {
        record,
        times: plan.model.output.times.clone(),
        columns: sampling::columns(plan),
        blocks: Vec::new(),
        probes: Vec::new(),
        covariance: plan.model.output.covariance,
    }
}

/// Puts what a block came to into its record: status, checks, costs. The blocks are already in the results.
pub fn conclude(
    plan: &Plan,
    results: &mut Results,
    tally: &Tally,
    error: Option<&RunError>,
    interrupted: bool,
) {
    let record = &mut results.record;
    record.status = match (error, interrupted) {
        (Some(_), _) => "failed",
        (None, true) => "interrupted",
        (None, false) => "finished",
    }
    .into();
    record.error = error.map(ToString::to_string);
    let whole = results.times.len() == record.times.len();
    record.finished = if whole { results.blocks.len() as u32 } else { 0 };
    record.steps = tally.steps.clone();
    let earlier = std::mem::replace(&mut record.hybrid, tally.hybrid.clone());
    for (own, other) in record.hybrid.iter_mut().zip(&earlier) {
        own.absorb(other);
    }
    // Realizations of an interrupted run that were taken up count as well.
    let earlier = std::mem::take(&mut record.health);
    let earlier_flow = earlier.clone();
    let mut supplied: BTreeMap<String, f64> = plan
        .reactor
        .species
        .iter()
        .cloned()
        .zip(tally.supplied.iter().copied())
        .filter(|(_, n)| *n != 0.0)
        .collect();
    for (species, molecules) in earlier.molecules_supplied {
        *supplied.entry(species).or_default() += molecules;
    }
    let conservation = conservation(plan, &results.columns, &results.blocks, &supplied);
    let flow = tally.flow.as_ref();
    record.health = Health {
        molecules_created_or_lost: earlier.molecules_created_or_lost + tally.lost,
        molecules_supplied: supplied,
        conservation,
        momentum_drift: flow.and_then(|f| f.momentum_drift),
        penetrations: flow.map(|f| f.penetrations),
        bounces: flow.map(|f| f.bounces),
        largest_mach: flow.map(|f| f.largest_mach),
        largest_density_change: flow.map(|f| f.largest_density_change),
        temperature: flow.and_then(|f| f.temperature),
        warnings: joined(
            earlier.warnings,
            plan.warnings.iter().map(|warning| warning.line()).chain(tally.warnings()).collect(),
        ),
    };
    record.health.absorb_flow(&earlier_flow, record.steps.shared_flow);
    let performance = &mut record.performance;
    performance.particle_steps += tally.particle_steps;
    performance.pair_evaluations += tally.pair_evaluations;
    performance.fluid_seconds += tally.fluid_seconds;
    performance.reaction_events += tally.reaction_events;
    performance.hops += tally.hops;
    performance.chemistry_seconds += tally.chemistry_seconds;
}

/// Warnings of both, each once.
fn joined(mut earlier: Vec<String>, now: Vec<String>) -> Vec<String> {
    for warning in now {
        if !earlier.contains(&warning) {
            earlier.push(warning);
        }
    }
    earlier
}

/// Takes an outcome into results that may hold earlier realizations; cuts the output times to those seen.
pub fn keep(
    results: &mut Results,
    dir: &std::path::Path,
    outcome: &mut Outcome,
    vtk: bool,
) -> Result<(), RunError> {
    results.times.truncate(outcome.times);
    results.add(dir, std::mem::take(&mut outcome.observed), vtk)
}

/// How far each conserved sum strays within a realization.
fn conservation(
    plan: &Plan,
    columns: &Columns,
    blocks: &[SeriesBlock],
    supplied: &BTreeMap<String, f64>,
) -> Vec<ConservationRecord> {
    let width = columns.len();
    let held: BTreeSet<usize> = held_species(plan);
    plan.conservation_laws()
        .into_iter()
        .map(|(sum, coefficients)| {
            let members: Vec<(usize, f64)> = coefficients
                .iter()
                .enumerate()
                .filter(|(_, c)| **c != 0.0)
                .filter_map(|(s, &c)| columns.find("all", &plan.reactor.species[s]).map(|column| (column, c)))
                .collect();
            let value = |row: &[f64]| -> f64 { members.iter().map(|&(column, c)| c * row[column]).sum() };
            let mut largest = 0.0_f64;
            for block in blocks {
                let mut rows = block.amount.chunks_exact(width).map(value);
                if let Some(first) = rows.next() {
                    largest = rows.fold(largest, |largest, now| largest.max((now - first).abs()));
                }
            }
            let open: Vec<&str> = coefficients
                .iter()
                .enumerate()
                .filter(|(s, c)| {
                    **c != 0.0 && (held.contains(s) || supplied.contains_key(&plan.reactor.species[*s]))
                })
                .map(|(s, _)| plan.reactor.species[s].as_str())
                .collect();
            ConservationRecord {
                sum,
                start: blocks.first().and_then(|b| b.amount.get(..width)).map_or(0.0, value),
                largest_deviation: largest,
                exempt: if open.is_empty() {
                    String::new()
                } else {
                    format!("reservoirs supply {}", open.join(", "))
                },
            }
        })
        .collect()
}

/// Species that some condition supplies.
fn held_species(plan: &Plan) -> BTreeSet<usize> {
    use crate::model::conditions::What;
    let Domain::Particles(domain) = &plan.model.domain else { return BTreeSet::new() };
    domain
        .conditions
        .iter()
        .flat_map(|condition| match &condition.what {
            What::Sponge { species, .. } | What::Held { species, .. } => {
                species.iter().map(|(s, _)| *s).collect()
            }
            _ => Vec::new(),
        })
        .collect()
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
