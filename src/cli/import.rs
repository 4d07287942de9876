//! The verb `import`: models of other programs.

use super::Stop;
use crate::error::{Fault, ModelError, RunError};
use crate::import::{self, Options};
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

/// Formats that can be read.
#[derive(Subcommand)]
pub(crate) enum Format {
    /// SBML core, Level 2 or 3: writes NAME.yaml (model) and NAME_reactions.yaml
    Sbml(Sbml),
}

/// Options of `import sbml`.
#[derive(Args)]
pub(crate) struct Sbml {
    /// SBML file; its name without the ending becomes the model's
    file: PathBuf,
    /// Folder to write
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Replace files that are there
    #[arg(long)]
    force: bool,
    /// Read amounts as molecules, whatever unit the file gives
    #[arg(long, conflicts_with = "substance")]
    molecules: bool,
    /// Read amounts in this unit, whatever unit the file gives, e.g. nmol
    #[arg(long, value_name = "UNIT")]
    substance: Option<String>,
    /// Volume of the largest compartment; the others and all amounts go with it, concentrations stay
    #[arg(long, value_name = "VOLUME", conflicts_with = "molecules")]
    volume: Option<String>,
    /// End of the run (default: 100 of the file's units of time)
    #[arg(long, value_name = "TIME")]
    until: Option<String>,
}

/// Reads a file of another program and writes a model.
pub(crate) fn import(format: &Format) -> Result<(), Stop> {
    let Format::Sbml(asked) = format;
    let substance = if asked.molecules { Some("molecule") } else { asked.substance.as_deref() };
    let options = Options::parse(substance, asked.volume.as_deref(), asked.until.as_deref())?;
    let imported = import::sbml(&asked.file, &options)?;
    let model = asked.out.join(format!("{}.yaml", imported.name));
    let reactions = asked.out.join(format!("{}_reactions.yaml", imported.name));
    if !asked.force {
        refuse_existing(&[&model, &reactions])?;
    }
    write(&asked.out, &reactions, &imported.reactions)?;
    write(&asked.out, &model, &imported.model)?;
    for note in &imported.notes {
        tell!("note: {note}");
    }
    for line in &imported.summary {
        tell!("{line}");
    }
    tell!("wrote {} and {}", model.display(), reactions.display());
    Ok(())
}

fn refuse_existing(files: &[&Path]) -> Result<(), ModelError> {
    let there = files.iter().filter(|file| file.exists());
    let faults: Vec<Fault> = there
        .map(|file| {
            Fault::general(
                format!("{} is there already", file.display()),
                "name another folder with --out, or replace it with --force",
            )
        })
        .collect();
    if faults.is_empty() { Ok(()) } else { Err(ModelError { faults }) }
}

fn write(folder: &Path, path: &Path, text: &str) -> Result<(), RunError> {
    let failed = |error: std::io::Error| RunError::File {
        path: path.display().to_string(),
        reason: error.to_string(),
    };
    std::fs::create_dir_all(folder).and_then(|()| std::fs::write(path, text)).map_err(failed)
}
