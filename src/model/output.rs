//! The `run:` and `output:` of a model: for how long, how often, and what is looked at.

use super::domain::Domain;
use super::names::{group_index, species_index};
use super::node::{Node, Value};
use super::precision::Precision;
use super::probes::{self, Probe};
use super::reader::{Faults, Fields};
use super::solids::{self, Point};
use super::times::{End, multiples, times};
use crate::chemistry::Network;
use crate::quantity::Dimension;

/// How long and how many.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// s.
    pub until: f64,
    pub realizations: u32,
    pub seed: u64,
    /// All cores if `None`.
    pub threads: Option<usize>,
    /// Wall time between checkpoints, s.
    pub checkpoint_every: Option<f64>,
    pub until_precision: Option<Precision>,
}

/// What is looked at, and when.
#[derive(Clone, Debug, Default)]
pub struct Output {
    /// Rising, s.
    pub times: Vec<f64>,
    /// Times of the particle tables (each one of `times`) and the number of realizations that write them.
    pub particles: Option<(Vec<f64>, u32)>,
    pub probes: Vec<Probe>,
    /// Points of solids that are followed.
    pub points: Vec<Point>,
    pub covariance: bool,
    pub histograms: Vec<Histogram>,
    pub vtk: bool,
}

/// A distribution across realizations: species, group (`None` = all), times.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    pub species: usize,
    pub group: Option<usize>,
    pub times: Vec<f64>,
}

/// Reads `run:`.
pub fn read_run(node: &Node, faults: &mut Faults) -> Option<Run> {
    let mut fields = Fields::of(node, "run", faults)?;
    let until = fields.required("until", faults).and_then(|n| n.positive(Dimension::TIME, faults));
    let realizations = match fields.optional("realizations") {
        None => Some(1),
        Some(n) => n.integer(faults).and_then(|count| {
            if count < 1 || count > i64::from(u32::MAX) {
                faults.at(
                    &n.place,
                    format!("expected a number of realizations from 1 to {}, found {count}", u32::MAX),
                    "give how many times the model is to be run, e.g. realizations: 100",
                );
                return None;
            }
            Some(count as u32)
        }),
    };
    let seed = match fields.optional("seed") {
        None => Some(1),
        Some(n) => n.integer(faults).and_then(|seed| {
            if seed < 0 {
                faults.at(
                    &n.place,
                    format!("expected a seed of at least 0, found {seed}"),
                    "any whole number from 0 will do",
                );
                return None;
            }
            Some(seed as u64)
        }),
    };
    let threads = match fields.optional("threads") {
        None => Some(None),
        Some(n) => n.integer(faults).and_then(|threads| {
            if !(1..=4096).contains(&threads) {
                faults.at(
                    &n.place,
                    format!("expected 1 to 4096 threads, found {threads}"),
                    "give a number from 1 to 4096, or leave it out for all cores",
                );
                return None;
            }
            Some(Some(threads as usize))
        }),
    };
    let checkpoint_every = match fields.optional("checkpoint_every") {
        None => Some(None),
        Some(n) => n.positive(Dimension::TIME, faults).map(Some),
    };
    // Read once species and groups are known.
    fields.optional("until_precision");
    fields.finish(faults);
    // What has a fault of its own is replaced, so that the output can be checked.
    Some(Run {
        until: until.unwrap_or(f64::NAN),
        realizations: realizations.unwrap_or(1),
        seed: seed.unwrap_or(1),
        threads: threads.unwrap_or(None),
        checkpoint_every: checkpoint_every.unwrap_or(None),
        until_precision: None,
    })
}

/// Reads `output:`; without it a hundred equal intervals.
pub(super) fn read_output(
    node: Option<&Node>,
    end: End,
    domain: &Domain,
    network: &Network,
    precision: Option<&mut Precision>,
    faults: &mut Faults,
) -> Option<Output> {
    let until = end.time;
    let mut output = Output { times: multiples(until / 100.0, until), ..Output::default() };
    if let Domain::Particles(_) = domain {
        output.particles = Some((Vec::new(), 1));
    }
    if let Some(node) = node {
        let mut fields = Fields::of(node, "output", faults)?;
        if let Some(found) = times(&mut fields, end, faults).flatten() {
            output.times = found;
        }
        if let Some(n) = fields.optional("particles") {
            output.particles = particle_output(n, end, domain, faults);
        }
        if let Some(n) = fields.optional("probes") {
            output.probes = probes::read(n, domain, network, faults);
        }
        if let Some(n) = fields.optional("points") {
            output.points = solids::read_points(n, domain, faults);
        }
        solids::check_names(fields.optional("probes"), &output.points, domain, faults);
        if let Some(n) = fields.optional("covariance") {
            output.covariance = n.boolean(faults).unwrap_or(false);
        }
        if let Some(n) = fields.optional("vtk") {
            output.vtk = n.boolean(faults).unwrap_or(false);
        }
        if let Some(n) = fields.optional("histogram") {
            for item in n.list(faults).unwrap_or_default() {
                output.histograms.extend(histogram(item, end, domain, network, faults));
            }
        }
        fields.finish(faults);
    }
    // Whatever is asked for at a time is written at that time.
    let mut extra: Vec<f64> = output.histograms.iter().flat_map(|h| h.times.clone()).collect();
    extra.extend(output.particles.iter().flat_map(|(times, _)| times.clone()));
    extra.extend(precision.iter().map(|precision| precision.time));
    for t in extra {
        if !output.times.iter().any(|known| (known - t).abs() <= 1e-9 * until) {
            output.times.push(t);
        }
    }
    output.times.sort_by(f64::total_cmp);
    let snap = |t: &mut f64| {
        if let Some(known) = output.times.iter().find(|known| (*known - *t).abs() <= 1e-9 * until) {
            *t = *known;
        }
    };
    output.histograms.iter_mut().flat_map(|h| h.times.iter_mut()).for_each(snap);
    precision.into_iter().map(|precision| &mut precision.time).for_each(snap);
    if let Some((times, _)) = &mut output.particles {
        if times.is_empty() {
            times.clone_from(&output.times);
        }
        times.iter_mut().for_each(snap);
    }
    Some(output)
}

fn particle_output(node: &Node, end: End, domain: &Domain, faults: &mut Faults) -> Option<(Vec<f64>, u32)> {
    if !matches!(domain, Domain::Particles(_)) {
        faults.at(&node.place, "`particles` belongs to a domain of kind particles", "remove it");
        return None;
    }
    if let Value::Bool(wanted) = node.value {
        return wanted.then(|| (Vec::new(), 1));
    }
    let mut fields = Fields::of(node, "particles", faults)?;
    let found = times(&mut fields, end, faults)?;
    let realizations = match fields.optional("realizations") {
        None => 1,
        Some(n) => n.integer(faults)?.clamp(0, i64::from(u32::MAX)) as u32,
    };
    fields.finish(faults);
    Some((found.unwrap_or_default(), realizations))
}

fn histogram(
    node: &Node,
    end: End,
    domain: &Domain,
    network: &Network,
    faults: &mut Faults,
) -> Option<Histogram> {
    let mut fields = Fields::of(node, "histogram", faults)?;
    let species = fields
        .required("species", faults)
        .and_then(|n| species_index(n.text(faults)?, &n.place, network, faults));
    let group = match fields.optional("in") {
        None => None,
        Some(n) if matches!(&n.value, Value::Text(word) if word == "all") => None,
        Some(n) => Some(group_index(n.text(faults)?, &n.place, &domain.group_names(), faults)?),
    };
    let found = times(&mut fields, end, faults)?;
    fields.finish(faults);
    Some(Histogram { species: species?, group, times: found.unwrap_or_else(|| vec![end.time]) })
}
