//! The verb `check`: reads a model and prints the compiled plan.

use super::job::ready;
use super::{Stop, print};
use crate::chemistry::drawing;
use crate::ensemble;
use crate::model::load::{self, Document};
use crate::model::{Domain, Model, Sweep};
use crate::plan::Plan;
use crate::plan::limits::estimate;
use crate::quantity::readable::{length, show, significant};
use crate::record::{FluidRecord, RunRecord, SolidRecord};
use crate::simulation::Ready;
use std::fmt::Write;
use std::path::Path;

/// Directed pairs that one core sweeps in a second, and voxels times realizations that take a chemistry step:
/// round figures of a common machine, for the estimate of the run time only.
const PAIRS_PER_SECOND: f64 = 5e7;
const VOXEL_STEPS_PER_SECOND: f64 = 3e6;
/// Particles of elastic solids that a core takes a step in a second, and rounds of a wall until it is in balance.
const SOLID_STEPS_PER_SECOND: f64 = 1.5e7;
const SOLID_STEPS_IN_SPACE: f64 = 4e6;
const ROUNDS: f64 = 400.0;

/// Checks a file and prints its plan.
pub(crate) fn check(file: &Path, overrides: &[String]) -> Result<(), Stop> {
    let model = match load::document(file, overrides)? {
        Document::Reactions(network) => {
            print(&drawing::text(&network));
            return Ok(());
        }
        Document::Model(model) => *model,
    };
    let realizations = model.run.realizations;
    let sweep = match &model.sweep {
        Some(sweep) => {
            ensemble::sweep::check(file, &model, sweep, realizations)?;
            points(&model, sweep)
        }
        None => String::new(),
    };
    let plan = Plan::new(model, realizations)?;
    let ready = ready(&plan)?;
    print(&(describe(&plan, &ready) + &sweep));
    Ok(())
}

/// Points listed at most, but for the last.
const LISTED: usize = 200;

/// The points of a sweep.
fn points(model: &Model, sweep: &Sweep) -> String {
    let record = ensemble::sweep::record(model, sweep, &(0..model.run.realizations), 0);
    let (count, each) = (record.points.len(), model.run.realizations);
    let seeds =
        if sweep.common_random_numbers { "the same random numbers at each" } else { "a seed for each" };
    let runs = f64::from(each) * count as f64;
    let mut text = format!(
        "\nsweep: {count} points ({}), {each} realizations at each: {runs} in all; {seeds}\n",
        record.design.replace('_', " ")
    );
    let last = count.saturating_sub(1);
    for point in record.points.iter().filter(|p| (p.point as usize) < LISTED || p.point as usize == last) {
        if point.point as usize == last && last > LISTED {
            text += "  …\n";
        }
        let seed = if sweep.common_random_numbers { String::new() } else { format!(", seed {}", point.seed) };
        text += &format!("  {:04}  {}{seed}\n", point.point, point.words(&record.parameters));
    }
    text
}

fn describe(plan: &Plan, ready: &Ready) -> String {
    let mut text = String::new();
    let record = ensemble::record(plan, &(0..plan.model.run.realizations), ready, 0);
    // Writing to a string cannot fail.
    let mut line = |words: String| {
        let _ = writeln!(text, "{words}");
    };
    match record.description.as_str() {
        "" => line(record.name.clone()),
        description => line(format!("{}: {description}", record.name)),
    }
    line(format!("\nspecies ({})", record.species.len()));
    for species in &record.species {
        let place = if species.only_in.is_empty() {
            String::new()
        } else {
            format!(", only in {}", species.only_in.join(", "))
        };
        line(format!(
            "  {:<12} {}, {}{place}",
            species.name,
            species.representation,
            if species.diffusion > 0.0 {
                format!("diffusivity {}", show(species.diffusion, "m^2/s"))
            } else {
                "immobile".into()
            }
        ));
    }
    line(format!("\nreactions ({})", record.reactions.len()));
    for reaction in &record.reactions {
        line(format!("  {:<24} {:<28} {}", reaction.name, reaction.equation, reaction.propensity));
    }
    line("\nconservation laws".to_string());
    if record.conservation_laws.is_empty() {
        line("  none".into());
    }
    for law in &record.conservation_laws {
        line(format!("  {law} = constant"));
    }
    line(format!("\ndomain: {}", record.domain.kind));
    for group in &record.domain.groups {
        let size = if group.material == "zone" {
            "a zone that particles pass through".to_string()
        } else {
            format!(
                "{} {}, {}",
                group.particles,
                if record.domain.kind == "particles" { "particles" } else { "volume" },
                show(group.volume, "m^3")
            )
        };
        line(format!("  {:<12} {:<7} {size}  {}", group.name, group.material, group.shape));
    }
    for condition in &record.conditions {
        line(format!("  {condition}"));
    }
    if let Domain::Particles(domain) = &plan.model.domain {
        let filled: f64 = record.domain.groups.iter().map(|group| group.volume).sum();
        let side =
            |k: usize| if k < domain.dimensions { domain.max[k] - domain.min[k] } else { domain.thickness };
        let share = filled / (0..3).map(side).product::<f64>();
        // Shapes are filled to the nearest particle, so a full box is full to a few per cent.
        if share < 0.95 {
            line(format!("  the groups fill {:.0} % of the box; the rest is empty", 100.0 * share));
        }
    }
    if let Some(fluid) = &record.fluid {
        for words in flow(fluid, plan) {
            line(words);
        }
    }
    for solid in &record.solids {
        solid_words(solid).into_iter().for_each(&mut line);
    }
    line("\nat the start".to_string());
    let amounts = ready.amounts(plan);
    if amounts.is_empty() {
        line("  no molecules".into());
    }
    for (group, species, amount) in amounts {
        line(format!("  {group:<12} {species:<12} {} molecules", significant(amount, 7)));
    }
    line(format!("\nmethod: {}", record.steps.method));
    for (what, step) in [
        ("fluid", &record.steps.fluid),
        ("solid", &record.steps.solid),
        ("chemistry", &record.steps.chemistry),
    ] {
        if let Some(step) = step {
            line(format!(
                "  {what} step {}, {} steps, limited by {}",
                show(step.step, "s"),
                step.count,
                step.limited_by
            ));
        }
    }
    for warning in &plan.warnings {
        line(format!("  warning: {}", warning.to_string().trim_end()));
    }
    for warning in ready.rash_growth().into_iter().chain(ready.coarse()) {
        line(format!("  warning: {warning}"));
    }
    for approximation in &record.steps.approximations {
        line(format!("  {approximation}"));
    }
    let rough = estimate(&plan.model, plan.model.run.realizations);
    line(format!(
        "\nrun{}: {} realization{} until {}, {} output times; about {:.0} MB of memory{}",
        if plan.model.sweep.is_some() { " of each point (above: values as in the file)" } else { "" },
        plan.model.run.realizations,
        if plan.model.run.realizations == 1 { "" } else { "s" },
        show(plan.model.run.until, "s"),
        plan.model.output.times.len(),
        (rough.bytes / 1e6).max(30.0),
        run_time(plan, &record, rough.voxels, rough.neighbours)
    ));
    text
}

/// The numbers of a fluid.
fn flow(fluid: &FluidRecord, plan: &Plan) -> Vec<String> {
    let stated = match &plan.model.domain {
        Domain::Particles(domain) => domain.fluid.as_ref().is_some_and(|fluid| fluid.sound_speed.is_some()),
        _ => false,
    };
    let mut lines = vec![
        format!(
            "\nfluid: {}, density {}, viscosity {}",
            fluid.method,
            show(fluid.density, "kg/m^3"),
            show(fluid.viscosity, "Pa s")
        ),
        format!("  largest speed expected {}: {}", show(fluid.speed, "m/s"), fluid.speed_of),
        format!(
            "  sound speed {}{}: Mach number {}",
            show(fluid.sound_speed, "m/s"),
            if stated { "" } else { ", chosen" },
            significant(fluid.mach, 3)
        ),
        format!(
            "  Reynolds number {}: length {}, {}",
            significant(fluid.reynolds, 3),
            show(fluid.length, "m"),
            fluid.length_of
        ),
    ];
    if let Some(noise) = &fluid.noise {
        lines.push(format!(
            "  thermal noise at {}: kT = {:.3e} J, thermal speed of a particle {}",
            show(noise.temperature, "K"),
            noise.energy,
            show(noise.thermal_speed, "m/s")
        ));
    }
    lines
}

/// The numbers of an elastic solid.
fn solid_words(solid: &SolidRecord) -> Vec<String> {
    let mut lines = vec![
        format!(
            "\nelastic solid {}: {}, {}, density {}",
            solid.name,
            solid.law.replace('_', " "),
            solid.method.replace('_', " "),
            show(solid.density, "kg/m^3")
        ),
        format!(
            "  {} particles, spacing {}; {} thin, {} particles across; {} clamped, {} driven",
            solid.particles,
            length(solid.spacing),
            length(solid.thickness),
            significant(solid.thickness / solid.spacing, 3),
            solid.clamped,
            solid.driven
        ),
        format!(
            "  K {}, G {} (E {}, Poisson ratio {}); sound speed {}",
            show(solid.bulk_modulus, "Pa"),
            show(solid.shear_modulus, "Pa"),
            show(solid.youngs_modulus, "Pa"),
            significant(solid.poisson_ratio, 4),
            show(solid.sound_speed, "m/s")
        ),
    ];
    if solid.balance.is_empty() {
        lines.push(format!("  longest step {}, limited by {}", show(solid.step, "s"), solid.limited_by));
    }
    let more = [
        ("columns", &solid.columns),
        ("in balance", &solid.balance),
        ("turgor", &solid.turgor),
        ("growth", &solid.growth),
        ("softened", &solid.softening),
    ];
    let more = more.into_iter().filter(|(_, words)| !words.is_empty());
    lines.extend(more.map(|(what, words)| format!("  {what}: {words}")));
    lines
}

/// An estimate of the run time on this machine, where the steps are known beforehand.
fn run_time(plan: &Plan, record: &RunRecord, voxels: f64, neighbours: f64) -> String {
    let steps = &record.steps;
    if !matches!(plan.model.domain, Domain::Particles(_)) {
        return String::new();
    }
    let cores = std::thread::available_parallelism().map_or(1.0, |n| n.get() as f64);
    let flows = if plan.model.flows_differ() { f64::from(plan.model.run.realizations) } else { 1.0 };
    let fluid = flows
        * steps.fluid.as_ref().map_or(0.0, |s| s.count as f64 * voxels * neighbours * 1.5 / PAIRS_PER_SECOND);
    let speed = if record.domain.dimensions == 3 { SOLID_STEPS_IN_SPACE } else { SOLID_STEPS_PER_SECOND };
    let rounds = |solid: &SolidRecord| if solid.balance.is_empty() { 1.0 } else { ROUNDS };
    let solids: f64 = record.solids.iter().map(|solid| solid.particles as f64 * rounds(solid)).sum();
    let fluid = fluid + flows * steps.solid.as_ref().map_or(0.0, |s| s.count as f64 * solids / speed);
    let chemistry = steps.chemistry.as_ref().map_or(0.0, |s| {
        s.count as f64 * voxels * f64::from(plan.model.run.realizations) / VOXEL_STEPS_PER_SECOND
    });
    format!(", roughly {:.0} s on {cores} cores", ((fluid + chemistry) / cores).max(1.0))
}
