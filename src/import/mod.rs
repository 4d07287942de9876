//! SBML core (Level 2 and 3) -> a reactions file and a model.
//!
//! An SBML file gives numbers, and units beside them; its formulas are formulas of the numbers. What one unit
//! of substance, volume and time comes to in molecules, m³ and s (`units`) is therefore enough to turn every
//! law into a propensity (`rates`). Species in one compartment, or in several that no reaction joins, keep
//! concentrations if their amounts are moles; everything else becomes counts.

mod document;
mod functions;
mod law_text;
mod log;
mod math;
mod mathml;
mod polynomial;
mod rates;
mod sides;
mod source;
mod split;
mod system;
mod units;
mod unsupported;
mod values;
mod written;
mod yaml;

use crate::chemistry::AVOGADRO;
use crate::error::{Fault, ModelError};
use crate::quantity::{Dimension, Quantity};
use log::{Log, Spot};
use std::path::Path;
use units::{Measure, Units};

/// What a user may say that the file does not.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Unit of all amounts in place of the one in the file.
    substance: Option<Measure>,
    /// Volume that the largest compartment gets, m³; all others and all amounts go with it.
    volume: Option<f64>,
    /// End of the run, s.
    until: Option<f64>,
}

impl Options {
    /// From texts as a user writes them: a unit of amount such as `nmol` or `molecule`, a volume, a time.
    ///
    /// # Errors
    /// Texts that are no such quantities, all of them.
    pub fn parse(
        substance: Option<&str>,
        volume: Option<&str>,
        until: Option<&str>,
    ) -> Result<Options, ModelError> {
        let mut faults = Vec::new();
        let mut read = |option: &str, text: Option<String>, dimension: Dimension, example: &str| {
            let text = text?;
            match Quantity::parse(&text) {
                Ok(q) if q.dimension == dimension && q.value > 0.0 => return Some(q.value),
                Ok(_) => faults.push(Fault::general(
                    format!("--{option} {text}: expected {dimension}, larger than zero"),
                    format!("write e.g. --{option} {example}"),
                )),
                Err(fault) => faults.push(Fault::general(
                    format!("--{option} {text}: {}", fault.reason),
                    format!("write e.g. --{option} {example}"),
                )),
            }
            None
        };
        let one = substance.map(|unit| {
            if unit.trim_start().starts_with(|c: char| c.is_ascii_digit()) {
                unit.to_string()
            } else {
                format!("1 {unit}")
            }
        });
        let moles = substance.is_some_and(|unit| !unit.contains("molecule"));
        let substance = read("substance", one, Dimension::AMOUNT, "nmol").map(|amount| Measure {
            size: if moles { amount * AVOGADRO } else { (amount * AVOGADRO).round() },
            moles,
        });
        let volume = read("volume", volume.map(str::to_string), Dimension::VOLUME, "\"1 pL\"");
        let until = read("until", until.map(str::to_string), Dimension::TIME, "\"100 s\"");
        if faults.is_empty() { Ok(Options { substance, volume, until }) } else { Err(ModelError { faults }) }
    }
}

/// The texts an import comes to.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Name of the model and beginning of the file names.
    pub name: String,
    /// The model file; it names `NAME_reactions.yaml` beside it.
    pub model: String,
    /// The reactions file.
    pub reactions: String,
    /// What it comes to, in a few lines.
    pub summary: Vec<String>,
    /// What was assumed or left out.
    pub notes: Vec<String>,
}

/// Reads an SBML file.
///
/// # Errors
/// A text that is no SBML, and every construct in it that cannot be taken over, all at once with their places.
pub fn sbml(path: &Path, options: &Options) -> Result<Imported, ModelError> {
    let source = source::read(path)?;
    let mut log = Log::new(source.clone());
    let settings = roxmltree::ParsingOptions { allow_dtd: false, ..roxmltree::ParsingOptions::default() };
    let xml = roxmltree::Document::parse_with_options(&source.text, settings)
        .map_err(|error| ModelError::from(log.malformed(&error)))?;
    let imported = model(&xml, path, options, &mut log);
    match imported {
        Some(imported) if log.faults.is_empty() => Ok(imported),
        _ => Err(log.faults.finish::<()>(None).err().unwrap_or(ModelError { faults: Vec::new() })),
    }
}

fn model(xml: &roxmltree::Document, path: &Path, options: &Options, log: &mut Log) -> Option<Imported> {
    let root = xml.root_element();
    let spot = Spot::of(root);
    if root.tag_name().name() != "sbml" {
        let reason = format!("this is no SBML: the file begins with <{}>", root.tag_name().name());
        log.fault(spot, reason, "give a file whose outermost element is <sbml>");
        return None;
    }
    let number = |key: &str| root.attribute(key).and_then(|text| text.trim().parse::<u32>().ok());
    let (level, version) = (number("level").unwrap_or(0), number("version").unwrap_or(0));
    if !matches!(level, 2 | 3) {
        let found = root.attribute("level").unwrap_or("none");
        log.fault(
            spot,
            format!("expected SBML Level 2 or 3, found level {found}"),
            "convert the file to Level 3 Version 1, e.g. with the converter of libSBML",
        );
        return None;
    }
    let Some(element) = document::child(root, "model") else {
        log.fault(spot, "there is no <model> in this file", "give a file with a model");
        return None;
    };
    unsupported::name_all(root, element, log);
    let mut sbml = document::read(element, level, version, log);
    functions::inline(&mut sbml, log);
    let units = Units::read(element, level, log);
    let system = system::System::new(&sbml, &units, options, log)?;
    let mut values = values::Values::new(&sbml);
    let prepared: Vec<rates::Prepared> =
        sbml.reactions.iter().filter_map(|r| rates::prepare(r, &system, &mut values, log)).collect();
    if !log.faults.is_empty() {
        return None;
    }
    let local = prepared.iter().all(|reaction| reaction.compartments.len() <= 1);
    let form = if local && system.moles && system.variables.iter().all(|v| !v.counted) {
        rates::Form::Concentration
    } else {
        rates::Form::Molecules
    };
    let directions: Vec<rates::Direction> =
        prepared.iter().flat_map(|p| rates::directions(p, form, &system, log)).collect();
    let network = written::Network::new(&system, &directions, form, log)?;
    yaml::write(&yaml::Parts { path, system: &system, network: &network, form, local, options }, log)
}
