//! Where the names of a sweep lead.

use super::OPTIONS;
use crate::chemistry::Network;
use crate::model::node::Key;
use crate::model::reader::{Faults, did_you_mean};
use crate::record::SWEEP_COLUMNS;

/// Where a name leads: a parameter of the reactions, or a path of the model as after `--set`.
pub(super) fn path_of(
    key: &Key,
    network: &Network,
    overrides: &[String],
    faults: &mut Faults,
) -> Option<String> {
    let name = key.name.as_str();
    let parameters = || network.parameters.iter().map(|(name, _)| name.as_str());
    let path = if name.contains('.') {
        name.to_string()
    } else if parameters().any(|known| known == name) {
        format!("reactions.parameters.{name}")
    } else {
        let near = did_you_mean(name, parameters().chain(OPTIONS));
        let known = parameters().collect::<Vec<_>>().join(", ");
        let known =
            if known.is_empty() { "the reactions have none".into() } else { format!("there are: {known}") };
        let path = if network.species.iter().any(|s| s.name == name) { "initial." } else { "" };
        let path = if path.is_empty() { "fluid.viscosity".into() } else { format!("{path}{name}") };
        let remedy = format!("{near} {known}; other values by their path, e.g. {path}");
        faults.at(&key.place, format!("sweep: unknown parameter `{name}`"), remedy.trim());
        return None;
    };
    if name.split('.').any(str::is_empty) {
        faults.at(&key.place, format!("the path `{name}` has an empty part"), "e.g. fluid.viscosity");
        return None;
    }
    let first = path.split('.').next().unwrap_or_default();
    if ["name", "description", "sweep"].contains(&first) || (first == "run" && path != "run.until") {
        faults.at(
            &key.place,
            format!("`{name}` cannot be swept"),
            "sweep values of reactions, domain, groups, fluid, conditions, chemistry, initial, or run.until",
        );
        return None;
    }
    if SWEEP_COLUMNS.contains(&name) {
        let remedy = format!("call it by its path: {path}");
        faults.at(&key.place, format!("`{name}` is another column of the table of the sweep"), remedy);
        return None;
    }
    let given = |set: &&String| set.split_once('=').is_some_and(|(to, _)| to.trim() == path);
    if let Some(set) = overrides.iter().find(given) {
        faults.at(
            &key.place,
            format!("`{name}` is swept and given by --set {set}"),
            format!("set sweep.{name}, or nothing"),
        );
    }
    Some(path)
}
