//! The `run:` and `output:` of a model: for how long, how often, and what is looked at.

use super::domain::{Domain, ParticleDomain};
use super::names::{axis_name, group_index, pad, species_index, species_named};
use super::node::{Node, Value};
use super::reader::{Faults, Fields};
use crate::chemistry::Network;
use crate::quantity::Dimension;
use crate::vector::Vector;

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
}

/// What is looked at, and when.
#[derive(Clone, Debug, Default)]
pub struct Output {
    /// Rising, s.
    pub times: Vec<f64>,
    /// Times of the particle tables (each one of `times`) and the number of realizations that write them.
    pub particles: Option<(Vec<f64>, u32)>,
    pub probes: Vec<Probe>,
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

/// A place where fields are read off.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    pub name: String,
    pub shape: ProbeShape,
    /// Species read off.
    pub species: Vec<usize>,
    /// Whether velocities are read off too.
    pub velocity: bool,
}

/// Where a probe looks.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbeShape {
    /// Points at equal distances, both ends included.
    Line { from: Vector<3>, to: Vector<3>, points: usize },
    /// Sectors of a ring (2D) in which the particles of a group are summed; angle 0 along +x, counter-clockwise.
    Ring { centre: Vector<3>, inner: f64, outer: f64, sectors: usize, group: Option<usize> },
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
    fields.finish(faults);
    // What has a fault of its own is replaced, so that the output can be checked.
    Some(Run {
        until: until.unwrap_or(f64::NAN),
        realizations: realizations.unwrap_or(1),
        seed: seed.unwrap_or(1),
        threads: threads.unwrap_or(None),
        checkpoint_every: checkpoint_every.unwrap_or(None),
    })
}

const MOST_OUTPUTS: f64 = 1e6;

/// Multiples of `every` up to and including `until`.
fn multiples(every: f64, until: f64) -> Vec<f64> {
    let count = (until / every * (1.0 + 1e-12)).floor() as usize;
    let mut times: Vec<f64> = (0..=count).map(|k| k as f64 * every).collect();
    if let Some(last) = times.last_mut() {
        if (until - *last).abs() <= 1e-9 * until {
            *last = until;
        } else {
            times.push(until);
        }
    }
    times
}

fn times(fields: &mut Fields, until: f64, faults: &mut Faults) -> Option<Option<Vec<f64>>> {
    let (every, list) = (fields.optional("every"), fields.optional("times"));
    match (every, list) {
        (Some(n), None) => {
            let every = n.positive(Dimension::TIME, faults)?;
            if until / every > MOST_OUTPUTS {
                faults.at(
                    &n.place,
                    format!("{:.3e} output times", until / every),
                    "at most a million are possible; make `every` longer",
                );
                return None;
            }
            if every > until {
                faults.at(
                    &n.place,
                    format!("an interval of {every} s is longer than the run of {until} s"),
                    "make `every` shorter or run.until longer",
                );
                return None;
            }
            Some(Some(multiples(every, until)))
        }
        (None, Some(n)) => {
            let mut found = Vec::new();
            for item in n.list(faults)? {
                let t = item.non_negative(Dimension::TIME, faults)?;
                if t > until * (1.0 + 1e-12) {
                    faults.at(
                        &item.place,
                        format!("{t} s lies after the end of the run, {until} s"),
                        "make run.until longer or remove it",
                    );
                    return None;
                }
                found.push(t);
            }
            if found.is_empty() {
                faults.at(&n.place, "no output times", "give at least one, e.g. times: [1 s], or `every`");
                return None;
            }
            found.sort_by(f64::total_cmp);
            found.dedup();
            Some(Some(found))
        }
        (None, None) => Some(None),
        (Some(n), Some(_)) => {
            faults.at(&n.place, "both `every` and `times` are given", "keep one of them");
            None
        }
    }
}

/// Reads `output:`; without it a hundred equal intervals.
pub fn read_output(
    node: Option<&Node>,
    until: f64,
    domain: &Domain,
    network: &Network,
    faults: &mut Faults,
) -> Option<Output> {
    let mut output = Output { times: multiples(until / 100.0, until), ..Output::default() };
    if let Domain::Particles(_) = domain {
        output.particles = Some((Vec::new(), 1));
    }
    if let Some(node) = node {
        let mut fields = Fields::of(node, "output", faults)?;
        if let Some(found) = times(&mut fields, until, faults).flatten() {
            output.times = found;
        }
        if let Some(n) = fields.optional("particles") {
            output.particles = particle_output(n, until, domain, faults);
        }
        if let Some(n) = fields.optional("probes") {
            output.probes = probes(n, domain, network, faults);
        }
        if let Some(n) = fields.optional("covariance") {
            output.covariance = n.boolean(faults).unwrap_or(false);
        }
        if let Some(n) = fields.optional("vtk") {
            output.vtk = n.boolean(faults).unwrap_or(false);
        }
        if let Some(n) = fields.optional("histogram") {
            for item in n.list(faults).unwrap_or_default() {
                output.histograms.extend(histogram(item, until, domain, network, faults));
            }
        }
        fields.finish(faults);
    }
    // Whatever is asked for at a time is written at that time.
    let mut extra: Vec<f64> = output.histograms.iter().flat_map(|h| h.times.clone()).collect();
    extra.extend(output.particles.iter().flat_map(|(times, _)| times.clone()));
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
    if let Some((times, _)) = &mut output.particles {
        if times.is_empty() {
            times.clone_from(&output.times);
        }
        times.iter_mut().for_each(snap);
    }
    Some(output)
}

fn particle_output(node: &Node, until: f64, domain: &Domain, faults: &mut Faults) -> Option<(Vec<f64>, u32)> {
    if !matches!(domain, Domain::Particles(_)) {
        faults.at(&node.place, "`particles` belongs to a domain of kind particles", "remove it");
        return None;
    }
    if let Value::Bool(wanted) = node.value {
        return wanted.then(|| (Vec::new(), 1));
    }
    let mut fields = Fields::of(node, "particles", faults)?;
    let found = times(&mut fields, until, faults)?;
    let realizations = match fields.optional("realizations") {
        None => 1,
        Some(n) => n.integer(faults)?.clamp(0, i64::from(u32::MAX)) as u32,
    };
    fields.finish(faults);
    Some((found.unwrap_or_default(), realizations))
}

fn histogram(
    node: &Node,
    until: f64,
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
    let found = times(&mut fields, until, faults)?;
    fields.finish(faults);
    Some(Histogram { species: species?, group, times: found.unwrap_or_else(|| vec![until]) })
}

fn probes(node: &Node, domain: &Domain, network: &Network, faults: &mut Faults) -> Vec<Probe> {
    let Domain::Particles(particles) = domain else {
        faults.at(&node.place, "probes belong to a domain of kind particles", "remove them");
        return Vec::new();
    };
    let Some(fields) = Fields::of(node, "probes", faults) else { return Vec::new() };
    let mut found = Vec::new();
    for (key, node) in fields.entries() {
        let Some(mut fields) = Fields::of(node, "probe", faults) else { continue };
        let (line, ring) = (fields.optional("line"), fields.optional("ring"));
        let species = match fields.optional("species") {
            None => Some((0..network.species.len()).collect()),
            Some(n) => n
                .list(faults)
                .map(|items| items.iter().filter_map(|item| species_named(item, network, faults)).collect()),
        };
        let velocity = match fields.optional("velocity") {
            None => Some(particles.fluid.is_some() && line.is_some()),
            Some(n) => n.boolean(faults),
        };
        fields.finish(faults);
        let shape = match (line, ring) {
            (Some(n), None) => read_line(n, particles, faults),
            (None, Some(n)) => read_ring(n, particles, domain, faults),
            _ => {
                faults.at(
                    &node.place,
                    "a probe is a line or a ring",
                    "for example line: { from: [0, 0], to: [1 um, 0], points: 101 }",
                );
                None
            }
        };
        if let (Some(shape), Some(species), Some(velocity)) = (shape, species, velocity) {
            found.push(Probe { name: key.name.clone(), shape, species, velocity });
        }
    }
    found
}

fn at_least(
    fields: &mut Fields,
    key: &'static str,
    least: i64,
    usual: usize,
    faults: &mut Faults,
) -> Option<usize> {
    let Some(n) = fields.optional(key) else { return Some(usual) };
    let value = n.integer(faults)?;
    if value < least || value > 1_000_000 {
        faults.at(&n.place, format!("{value} {key}"), format!("give a number from {least} to a million"));
        return None;
    }
    Some(value as usize)
}

fn read_line(node: &Node, domain: &ParticleDomain, faults: &mut Faults) -> Option<ProbeShape> {
    let d = domain.dimensions;
    let mut fields = Fields::of(node, "line", faults)?;
    let mut end = |key: &'static str, faults: &mut Faults| {
        let node = fields.required(key, faults)?;
        let x = pad(&node.vector(Dimension::LENGTH, d, faults)?);
        if outside(&x, domain) > 0.0 {
            faults.at(&node.place, format!("the line's end `{key}` lies outside the box"), box_words(domain));
        }
        Some(x)
    };
    let from = end("from", faults);
    let to = end("to", faults);
    let points = at_least(&mut fields, "points", 2, 101, faults);
    fields.finish(faults);
    Some(ProbeShape::Line { from: from?, to: to?, points: points? })
}

/// How far a place lies outside the box, m; up to a billionth of the box is rounding.
fn outside(x: &Vector<3>, domain: &ParticleDomain) -> f64 {
    let (min, max) = (&domain.min, &domain.max);
    let beyond: Vector<3> = Vector::from_fn(|k, _| (min[k] - x[k]).max(x[k] - max[k]).max(0.0));
    let far = beyond.norm();
    if far <= 1e-9 * (max - min).norm() { 0.0 } else { far }
}

fn box_words(domain: &ParticleDomain) -> String {
    let side = |k: usize| {
        format!("{} from {:.6} to {:.6} um", axis_name(k), domain.min[k] * 1e6, domain.max[k] * 1e6)
    };
    let sides: Vec<String> = (0..domain.dimensions).map(side).collect();
    format!("move it into the box: {}", sides.join(", "))
}

fn read_ring(
    node: &Node,
    particles: &ParticleDomain,
    domain: &Domain,
    faults: &mut Faults,
) -> Option<ProbeShape> {
    let mut fields = Fields::of(node, "ring", faults)?;
    if particles.dimensions != 2 {
        faults.at(&node.place, "a ring probe needs 2 dimensions", "use a line");
        return None;
    }
    let centre = fields.required("centre", faults).and_then(|n| n.vector(Dimension::LENGTH, 2, faults));
    let inner = fields.required("inner", faults).and_then(|n| n.non_negative(Dimension::LENGTH, faults));
    let outer = fields.required("outer", faults).and_then(|n| n.positive(Dimension::LENGTH, faults));
    let sectors = at_least(&mut fields, "sectors", 3, 72, faults);
    let group = match fields.optional("in") {
        None => None,
        Some(n) => Some(group_index(n.text(faults)?, &n.place, &domain.group_names(), faults)?),
    };
    fields.finish(faults);
    let (centre, inner, outer) = (pad(&centre?), inner?, outer?);
    if inner >= outer {
        faults.at(
            &node.place,
            "the ring has no width: `inner` is not less than `outer`",
            "make `outer` larger",
        );
    }
    if outside(&centre, particles) > outer {
        faults.at(&node.place, "the ring lies outside the box", box_words(particles));
    }
    Some(ProbeShape::Ring { centre, inner, outer, sectors: sectors?, group })
}
