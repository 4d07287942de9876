//! Compartments: volumes and the links between them.

use super::domain::Domain;
use super::node::Node;
use super::reader::{Faults, Fields};
use crate::quantity::Dimension;

/// Reads a domain of kind graph.
pub(super) fn read(mut fields: Fields, faults: &mut Faults) -> Option<Domain> {
    let volumes_node = fields.required("volumes", faults);
    let names_node = fields.optional("names");
    let links_node = fields.optional("links");
    fields.finish(faults);
    let volumes_node = volumes_node?;
    let volumes: Vec<Option<f64>> =
        volumes_node.list(faults)?.iter().map(|n| n.positive(Dimension::VOLUME, faults)).collect();
    if volumes.is_empty() {
        faults.at(
            &volumes_node.place,
            "a graph needs at least one volume",
            "for example volumes: [1 fL, 0.25 fL]",
        );
        return None;
    }
    let mut names: Vec<String> = (0..volumes.len()).map(|i| i.to_string()).collect();
    if let Some(node) = names_node {
        let given = node.list(faults)?;
        if given.len() == volumes.len() {
            for (i, item) in given.iter().enumerate() {
                if let Some(name) = item.text(faults) {
                    if name == "all" || names[..i].iter().any(|other| other == name) {
                        faults.at(
                            &item.place,
                            format!("the name `{name}` is taken"),
                            "names must differ, and `all` is the sum",
                        );
                    }
                    names[i] = name.to_string();
                }
            }
        } else {
            faults.at(
                &node.place,
                format!("{} names for {} volumes", given.len(), volumes.len()),
                "give one name per volume",
            );
        }
    }
    let mut links: Vec<(usize, usize, f64)> = Vec::new();
    let mut linked = std::collections::BTreeSet::new();
    if let Some(node) = links_node {
        for item in node.list(faults)? {
            let Some([a, b, g]) = item.list(faults) else {
                faults.at(&item.place, "a link is [volume, volume, G]", "for example [0, 1, 0.3 um]");
                continue;
            };
            let mut end = |n: &Node| -> Option<usize> {
                if let super::node::Value::Text(name) = &n.value
                    && let Some(i) = names.iter().position(|known| known == name)
                {
                    return Some(i);
                }
                if let super::node::Value::Text(name) = &n.value {
                    let reason = format!("unknown volume `{name}`");
                    faults.at(&n.place, reason, format!("the volumes are: {}", names.join(", ")));
                    return None;
                }
                let i = n.integer(faults)?;
                if i < 0 || i as usize >= volumes.len() {
                    faults.at(
                        &n.place,
                        format!("volume {i} does not exist"),
                        format!("volumes are numbered 0 to {}", volumes.len() - 1),
                    );
                    return None;
                }
                Some(i as usize)
            };
            let ends = (end(a), end(b));
            let g = g.non_negative(Dimension::LENGTH, faults);
            if let ((Some(i), Some(j)), Some(g)) = (ends, g) {
                if i == j {
                    faults.at(&item.place, "a link joins two different volumes", "remove it");
                } else if !linked.insert((i.min(j), i.max(j))) {
                    let reason = format!("`{}` and `{}` are linked twice", names[i], names[j]);
                    faults.at(&item.place, reason, "a link goes both ways; give the sum of the two once");
                } else {
                    links.push((i, j, g));
                }
            }
        }
    }
    let volumes = volumes.into_iter().map(|volume| volume.unwrap_or(1.0)).collect();
    Some(Domain::Graph { volumes, names, links })
}
