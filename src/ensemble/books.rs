//! The books of a run: what its realizations add up to, and whether what must be conserved is.

use crate::error::RunError;
use crate::model::Domain;
use crate::plan::Plan;
use crate::record::{ConservationRecord, Health, RunRecord};
use crate::sampling;
use crate::simulation::{Piece, Tally};
use std::collections::{BTreeMap, BTreeSet};

/// Sums over realizations, filled as these are read in order.
pub struct Books {
    pub tally: Tally,
    width: usize,
    sums: Vec<Sum>,
}

/// A conserved sum as it was seen.
struct Sum {
    words: String,
    /// Column over the whole domain and coefficient.
    members: Vec<(usize, f64)>,
    /// Species in it.
    species: Vec<usize>,
    /// Of the first realization and of the one under way, molecules.
    start: Option<f64>,
    first: f64,
    largest: f64,
}

impl Books {
    /// Empty books of a plan.
    #[must_use]
    pub fn new(plan: &Plan, tally: Tally) -> Books {
        let columns = sampling::columns(plan);
        let sums = plan.conservation_laws().into_iter().map(|(words, coefficients)| {
            let species: Vec<usize> = (0..coefficients.len()).filter(|&s| coefficients[s] != 0.0).collect();
            let members = species
                .iter()
                .filter_map(|&s| Some((columns.find("all", &plan.reactor.species[s])?, coefficients[s])))
                .collect();
            Sum { words, members, species, start: None, first: 0.0, largest: 0.0 }
        });
        Books { tally, width: columns.len(), sums: sums.collect() }
    }

    /// Takes note of a piece of a realization; pieces come in order.
    pub fn see(&mut self, piece: &Piece) {
        for (row, amounts) in piece.amount.chunks_exact(self.width.max(1)).enumerate() {
            for sum in &mut self.sums {
                let value: f64 = sum.members.iter().map(|&(column, c)| c * amounts[column]).sum();
                if piece.first == 0 && row == 0 {
                    sum.first = value;
                    sum.start.get_or_insert(value);
                }
                sum.largest = sum.largest.max((value - sum.first).abs());
            }
        }
    }

    /// Puts what a run came to into its record: status, checks, costs.
    pub fn conclude(
        &self,
        plan: &Plan,
        record: &mut RunRecord,
        finished: usize,
        error: Option<&RunError>,
        interrupted: bool,
    ) {
        record.status = match (error, interrupted) {
            (Some(_), _) => "failed",
            (None, true) => "interrupted",
            (None, false) => "finished",
        }
        .into();
        let tally = &self.tally;
        record.error = error.map(ToString::to_string);
        record.finished = finished as u32;
        record.steps = tally.steps.clone();
        record.hybrid.clone_from(&tally.hybrid);
        let species = plan.reactor.species.iter().cloned();
        let supplied: BTreeMap<String, f64> =
            species.zip(tally.supplied.iter().copied()).filter(|(_, n)| *n != 0.0).collect();
        // Solids move without a fluid too.
        let moved = tally.flow.as_ref();
        let flow = moved
            .filter(|_| matches!(&plan.model.domain, Domain::Particles(domain) if domain.fluid.is_some()));
        let warnings = plan.warnings.iter().map(|warning| warning.line()).chain(tally.warnings());
        record.health = Health {
            molecules_created_or_lost: tally.lost,
            conservation: self.conservation(plan, &supplied),
            molecules_supplied: supplied,
            momentum_drift: flow.and_then(|f| f.momentum_drift),
            penetrations: flow.map(|f| f.penetrations),
            bounces: flow.map(|f| f.bounces),
            largest_mach: flow.map(|f| f.largest_mach),
            largest_density_change: flow.map(|f| f.largest_density_change),
            temperature: flow.and_then(|f| f.temperature),
            largest_stretch: moved.and_then(|f| f.largest_stretch),
            warnings: warnings.chain(std::mem::take(&mut record.health.warnings)).collect(),
        };
        let performance = &mut record.performance;
        performance.particle_steps = tally.particle_steps;
        performance.pair_evaluations = tally.pair_evaluations;
        performance.solid_particle_steps = tally.solid_particle_steps;
        performance.bond_evaluations = tally.bond_evaluations;
        performance.fluid_seconds = tally.fluid_seconds;
        performance.reaction_events = tally.reaction_events;
        performance.hops = tally.hops;
        performance.chemistry_seconds = tally.chemistry_seconds;
    }

    /// How far each conserved sum strays within a realization.
    fn conservation(&self, plan: &Plan, supplied: &BTreeMap<String, f64>) -> Vec<ConservationRecord> {
        let held = held_species(plan);
        let of = |sum: &Sum| {
            let name = |s: usize| plan.reactor.species[s].as_str();
            let open: Vec<&str> = sum
                .species
                .iter()
                .filter(|&&s| held.contains(&s) || supplied.contains_key(name(s)))
                .map(|&s| name(s))
                .collect();
            ConservationRecord {
                sum: sum.words.clone(),
                start: sum.start.unwrap_or(0.0),
                largest_deviation: sum.largest,
                exempt: match open.is_empty() {
                    true => String::new(),
                    false => format!("reservoirs supply {}", open.join(", ")),
                },
            }
        };
        self.sums.iter().map(of).collect()
    }
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
