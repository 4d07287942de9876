//! The smaller verbs: `report`, `merge`, `network`, `validate`, `completions`.

use super::{Stop, print};
use crate::chemistry::drawing;
use crate::ensemble::{self, NotJoined};
use crate::error::Fault;
use crate::model::load::{self, Document};
use crate::validation::Scope;
use crate::{report, validation};
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
    let mut faults = Vec::new();
    for dir in blocks.iter().filter(|dir| !dir.join("run.json").exists()) {
        faults.push(Fault::general(
            format!("{} holds no run", dir.display()),
            "name folders of finished blocks",
        ));
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
    let whole = ensemble::merge(out, blocks).map_err(|error| match error {
        NotJoined::Model(error) => Stop::Model(error),
        NotJoined::Run(error) => Stop::Run(error),
    })?;
    report::write(out)?;
    tell!(
        "joined {} blocks, realizations {}..{}: {}",
        blocks.len(),
        whole.realizations[0],
        whole.realizations[1],
        out.join("report.html").display()
    );
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
        let met = std::cell::Cell::new(false);
        let verdict = (case.run)(Scope { met: Some(&met), ..scope }).map_err(Stop::from)?;
        if let Some(only) = scope.only.filter(|_| !met.get()) {
            return Err(Fault::general(
                format!("--only {only}: `{}` has no part of that name", case.name),
                "parts are named as in the first column of its table, e.g. `Re 1000 200`, `Ra 1e5 100`, `320`; without the option the case runs as it is",
            )
            .into());
        }
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
