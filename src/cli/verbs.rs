//! The smaller verbs: `report`, `merge`, `network`, `validate`, `completions`.

use super::{Stop, print};
use crate::chemistry::drawing;
use crate::error::{Fault, RunError};
use crate::model::load::{self, Document};
use crate::results::{self, Results};
use crate::validation::Scope;
use crate::{report, tables, validation};
use std::path::{Path, PathBuf};

pub(crate) fn report(dir: &Path) -> Result<(), Stop> {
    if !dir.join("run.json").exists() {
        return Err(Fault::general(
            format!("{} holds no run", dir.display()),
            "name the folder of a run, e.g. reports/birth_death",
        )
        .into());
    }
    report::write(dir)?;
    tell!("report: {}", dir.join("report.html").display());
    Ok(())
}

pub(crate) fn merge(out: &Path, blocks: &[PathBuf], force: bool) -> Result<(), Stop> {
    let mut parts = Vec::new();
    let mut faults = Vec::new();
    for dir in blocks {
        if dir.join("run.json").exists() {
            parts.push((dir.display().to_string(), Results::read(dir)?));
        } else {
            faults.push(Fault::general(
                format!("{} holds no run", dir.display()),
                "name folders of finished blocks",
            ));
        }
    }
    if out.join("run.json").exists() && !force {
        faults.push(Fault::general(
            format!("{} already holds a run", out.display()),
            "name another folder, or add --force",
        ));
    }
    if !faults.is_empty() {
        return Err(crate::error::ModelError { faults }.into());
    }
    let whole = results::join(parts)?;
    for dir in blocks {
        copy_particles(dir, out)?;
    }
    whole.write(out)?;
    report::write(out)?;
    tell!(
        "joined {} blocks, realizations {}..{}: {}",
        blocks.len(),
        whole.record.realizations[0],
        whole.record.realizations[1],
        out.join("report.html").display()
    );
    Ok(())
}

/// Copies the particle tables of a block; each realization has a folder of its own.
fn copy_particles(from: &Path, to: &Path) -> Result<(), RunError> {
    for (realization, part, path) in tables::list_particles(from) {
        let folder = to.join(format!("tables/particles/realization={realization:04}"));
        let target = folder.join(format!("part-{part:05}.parquet"));
        std::fs::create_dir_all(&folder).and_then(|()| std::fs::copy(&path, &target)).map_err(|error| {
            RunError::File { path: target.display().to_string(), reason: error.to_string() }
        })?;
    }
    Ok(())
}

pub(crate) fn network(file: &Path, svg: bool, dot: bool) -> Result<(), Stop> {
    let network = match load::document(file, &[])? {
        Document::Model(model) => model.network,
        Document::Reactions(network) => network,
    };
    print(&if svg {
        drawing::svg(&network)
    } else if dot {
        drawing::dot(&network)
    } else {
        drawing::text(&network)
    });
    Ok(())
}

pub(crate) fn validate(names: &[String], list: bool, scope: Scope, out: &Path) -> Result<(), Stop> {
    if list {
        for case in validation::CASES {
            print(&format!("{:<24} {}\n", case.name, case.what));
        }
        return Ok(());
    }
    let mut chosen = Vec::new();
    let mut faults = Vec::new();
    for name in names {
        match validation::CASES.iter().find(|case| case.name == name) {
            Some(case) => chosen.push(case),
            None => {
                let known: Vec<&str> = validation::CASES.iter().map(|case| case.name).collect();
                faults.push(Fault::general(
                    format!("unknown case `{name}`"),
                    format!("the cases are: {}", known.join(", ")),
                ));
            }
        }
    }
    if !faults.is_empty() {
        return Err(crate::error::ModelError { faults }.into());
    }
    if names.is_empty() {
        chosen = validation::CASES.iter().collect();
    }
    let mut failed = false;
    for case in chosen {
        let verdict = (case.run)(scope).map_err(Stop::from)?;
        print(&verdict.to_string());
        let dir = out.join(case.name);
        validation::write(&verdict, &dir)?;
        tell!("tables and figures: {}", dir.display());
        failed |= !verdict.passed();
    }
    if failed { Err(Stop::Status(1)) } else { Ok(()) }
}

pub(crate) fn completions(shell: clap_complete::Shell, command: &mut clap::Command) {
    let mut text = Vec::new();
    clap_complete::generate(shell, command, "gillesph", &mut text);
    print(&String::from_utf8_lossy(&text));
}
