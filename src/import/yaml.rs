//! The two files an import comes to, and what is said of them.

use super::law_text::{number, tidy};
use super::log::Log;
use super::rates::Form;
use super::system::{System, Variable};
use super::written::Network;
use super::{Imported, Options};
use crate::chemistry::AVOGADRO;
use std::fmt::Write;
use std::path::Path;

/// What the files are written from.
pub(super) struct Parts<'a> {
    pub path: &'a Path,
    pub system: &'a System<'a>,
    pub network: &'a Network,
    pub form: Form,
    /// No reaction joins compartments.
    pub local: bool,
    pub options: &'a Options,
}

/// More whole molecules than this in a volume cannot be counted in double precision.
const MOST_MOLECULES: f64 = 9.0e15;

/// Event by event, this many molecules take minutes.
const MANY_MOLECULES: f64 = 1e7;

/// Writes both files; `None` after a fault.
pub(super) fn write(parts: &Parts, log: &mut Log) -> Option<Imported> {
    let initial = initial(parts, log);
    if !log.faults.is_empty() {
        return None;
    }
    let system = parts.system;
    if system.compartments.len() > 1 && !parts.local {
        log.note(
            "reactions join compartments: the model is one volume in which every species is counted; \
             amounts are right, concentrations in the tables are per volume of all compartments together",
        );
    }
    if parts.form == Form::Molecules && parts.network.reactions.iter().any(|r| r.key == "law") {
        log.note("rate laws hold for these volumes: they are laws of numbers of molecules");
    }
    let total: f64 = system.variables.iter().map(|v| v.start).sum();
    if total > MANY_MOLECULES {
        log.note(format!(
            "{total:.1e} molecules: single events take long; a smaller volume, e.g. --volume \"1 fL\", keeps \
             concentrations, and chemistry: {{ representation: continuous }} solves rate equations"
        ));
    }
    let stem = path_stem(parts.path);
    Some(Imported {
        model: model(parts, &stem, &initial),
        reactions: reactions(parts, log),
        summary: summary(parts, total),
        notes: log.notes.clone(),
        name: stem,
    })
}

/// The file name without its ending, as the name of a folder.
fn path_stem(path: &Path) -> String {
    let stem = path.file_stem().map(|s| s.to_string_lossy().to_string()).unwrap_or_default();
    let plain: String =
        stem.chars().map(|c| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect();
    if plain.is_empty() { "model".to_string() } else { plain }
}

/// Initial amounts, one text a species; faults where they are no numbers of molecules.
fn initial(parts: &Parts, log: &mut Log) -> Vec<(usize, String)> {
    let mut texts = Vec::new();
    let mut rounded = Vec::new();
    for (index, variable) in parts.system.variables.iter().enumerate() {
        let n = variable.start;
        let whole = n.round();
        let id = &variable.id;
        let larger =
            "give a larger --volume, or --substance UNIT if the amounts of this file are in another unit";
        if n < 0.0 {
            log.fault(
                variable.spot,
                format!("\"{id}\" starts with {n} molecules"),
                "amounts are zero or more",
            );
        } else if n > MOST_MOLECULES {
            log.fault(
                variable.spot,
                format!("\"{id}\" starts with {n:.2e} molecules, more than the {MOST_MOLECULES:.0e} that can be counted"),
                "keep the concentrations in a smaller volume with --volume \"1 pL\"; if the numbers in the file \
                 are molecules, add --molecules",
            );
        } else if n > 0.0 && n < 0.5 {
            let reason = format!("\"{id}\" starts with {n:.3} molecules, less than half of one");
            log.fault(variable.spot, reason, larger);
        } else if (n - whole).abs() <= 1e-9 * n.max(1.0) || parts.form == Form::Molecules {
            if (n - whole).abs() > 1e-9 * n.max(1.0) {
                rounded.push(format!("{id} {n:.3}"));
            }
            if whole > 0.0 {
                texts.push((index, format!("{whole:.0}")));
            }
        } else {
            texts.push((index, concentration(variable, parts)));
        }
    }
    if !rounded.is_empty() {
        log.note(format!("rounded to whole molecules: {}", rounded.join(", ")));
    }
    texts
}

/// In mol/L.
fn concentration(variable: &Variable, parts: &Parts) -> String {
    let volume = parts.system.compartments[variable.compartment].volume;
    format!("{} M", number(tidy(variable.start / (AVOGADRO * volume) * 1e-3)))
}

fn model(parts: &Parts, stem: &str, initial: &[(usize, String)]) -> String {
    let system = parts.system;
    let litres = |volume: f64| format!("{} L", number(tidy(volume * 1e3)));
    let mut text = heading(parts);
    let title = match (system.sbml.name.as_str(), system.sbml.id.as_str()) {
        ("", id) => id,
        (name, _) => name,
    };
    // Writing to a string cannot fail.
    let mut line = |words: String| {
        let _ = writeln!(text, "{words}");
    };
    line(format!("name: {}", word(stem)));
    if !title.is_empty() {
        line(format!("description: {}", quoted(title)));
    }
    line(format!("reactions: {}", quoted(&format!("{stem}_reactions.yaml"))));
    let graph = in_graph(parts);
    if graph {
        let volumes: Vec<String> = system.compartments.iter().map(|c| litres(c.volume)).collect();
        let names: Vec<String> = system.compartments.iter().map(|c| word(&c.label)).collect();
        line("domain:".to_string());
        line("  kind: graph".to_string());
        line(format!("  volumes: [{}]", volumes.join(", ")));
        line(format!("  names: [{}]", names.join(", ")));
    } else {
        let volume: f64 = system.compartments.iter().map(|c| c.volume).sum();
        line(format!("domain: {{ kind: well_mixed, volume: {} }}", litres(volume)));
    }
    if !initial.is_empty() {
        line("initial:".to_string());
    }
    for (k, compartment) in system.compartments.iter().enumerate() {
        let here: Vec<&(usize, String)> =
            initial.iter().filter(|(index, _)| system.variables[*index].compartment == k).collect();
        if graph && !here.is_empty() {
            line(format!("  {}:", word(&compartment.label)));
        }
        for (index, amount) in here {
            let indent = if graph { "    " } else { "  " };
            line(format!("{indent}{}: {amount}", word(&system.variables[*index].label)));
        }
    }
    let until = parts.options.until.unwrap_or(100.0 * system.second);
    line("# SBML says neither for how long nor how often: change these.".to_string());
    line(format!("run: {{ until: {} s, realizations: 100, seed: 1 }}", number(tidy(until))));
    text
}

/// Several compartments that no reaction joins.
fn in_graph(parts: &Parts) -> bool {
    parts.local && parts.system.compartments.len() > 1
}

fn reactions(parts: &Parts, log: &Log) -> String {
    let system = parts.system;
    let mut text = heading(parts);
    for note in &log.notes {
        let _ = writeln!(text, "# {}", comment(note));
    }
    let mut line = |words: String| {
        let _ = writeln!(text, "{words}");
    };
    line(format!("name: {}", quoted(&path_stem(parts.path))));
    line("species:".to_string());
    for variable in &system.variables {
        let place = if in_graph(parts) {
            format!(", only_in: [{}]", word(&system.compartments[variable.compartment].label))
        } else {
            String::new()
        };
        let name = match variable.name.as_str() {
            "" => String::new(),
            name => format!("    # {}", comment(name)),
        };
        line(format!("  {}: {{ diffusion: 0{place} }}{name}", word(&variable.label)));
    }
    if !parts.network.parameters.is_empty() {
        line("# Without a unit: the number in the SBML file, in its units; the laws convert.".to_string());
        line("parameters:".to_string());
    }
    for parameter in &parts.network.parameters {
        let was = parameter.was.map(|was| format!("    # SBML: {}", number(was))).unwrap_or_default();
        line(format!("  {}: {}{was}", word(&parameter.label), parameter.text));
    }
    line(format!(
        "kinetics: {}",
        if parts.form == Form::Concentration { "concentration" } else { "molecules" }
    ));
    line(if parts.network.reactions.is_empty() { "reactions: {}".into() } else { "reactions:".into() });
    for entry in &parts.network.reactions {
        let reverse =
            entry.reverse.as_ref().map(|rate| format!(", reverse: {}", quoted(rate))).unwrap_or_default();
        line(format!(
            "  {}: {{ equation: {}, {}: {}{reverse} }}",
            word(&entry.name),
            quoted(&entry.equation),
            entry.key,
            quoted(&entry.rate)
        ));
    }
    text
}

fn heading(parts: &Parts) -> String {
    let file = parts.path.file_name().map(|n| n.to_string_lossy().to_string()).unwrap_or_default();
    let sbml = parts.system.sbml;
    format!("# Imported from {} (SBML Level {} Version {}).\n", comment(&file), sbml.level, sbml.version)
}

fn summary(parts: &Parts, total: f64) -> Vec<String> {
    let system = parts.system;
    let laws = parts.network.reactions.iter().filter(|r| r.key == "law").count();
    let all = parts.network.reactions.len();
    let volume: f64 = system.compartments.iter().map(|c| c.volume).sum();
    let domain = if in_graph(parts) {
        format!("{} volumes that no reaction joins", system.compartments.len())
    } else {
        format!("one volume of {} L", number(tidy(volume * 1e3)))
    };
    vec![
        format!(
            "{} species, {all} reactions ({} by mass action, {laws} by a rate law), {domain}",
            system.variables.len(),
            all - laws
        ),
        format!(
            "kinetics: {}, {total:.0} molecules at the start",
            if parts.form == Form::Concentration { "concentration" } else { "molecules" }
        ),
    ]
}

/// A name as a YAML word; in quotes where YAML or a reader of it could take it for a value.
fn word(name: &str) -> String {
    let lower = name.to_lowercase();
    let value = ["true", "false", "null", "yes", "no", "on", "off", "y", "n", "nan", "inf", "infinity"];
    let plain = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && !value.contains(&lower.as_str());
    if plain { name.to_string() } else { quoted(name) }
}

/// In double quotes; strings of JSON are strings of YAML.
fn quoted(text: &str) -> String {
    serde_json::Value::from(comment(text)).to_string()
}

/// On one line, without characters that would end it.
fn comment(text: &str) -> String {
    let plain: String = text
        .chars()
        .map(|c| if c.is_control() || "\u{2028}\u{2029}\u{85}".contains(c) { ' ' } else { c })
        .collect();
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}
