//! The `sweep:` of a model: which of its values are varied, and the points that come of it.

mod braces;
mod design;
mod paths;
mod values;
mod written;

pub(super) use braces::rejoin;

use super::node::{Key, Node, Value};
use super::reader::{Faults, Fields};
use crate::chemistry::Network;
use crate::error::{Fault, Place};
use crate::record::SweptRecord;
use paths::path_of;
use values::{Kind, MOST, Taken, Valued, Values, too_many};

/// How the points lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// Every combination of the values.
    Grid,
    /// The first values together, the second ones, and so on.
    List,
    /// Spread over ranges.
    LatinHypercube,
}

impl Design {
    /// Every design, as it is named in a model.
    pub const NAMES: [(&str, Design); 3] =
        [("grid", Design::Grid), ("list", Design::List), ("latin_hypercube", Design::LatinHypercube)];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        Design::NAMES.iter().find(|(_, design)| *design == self).map_or("", |(name, _)| name)
    }
}

/// Points at which a model is to be run.
#[derive(Clone, Debug)]
pub struct Sweep {
    pub design: Design,
    /// Every point has the same seed; otherwise each has its own.
    pub common_random_numbers: bool,
    pub parameters: Vec<SweptRecord>,
    /// Point by point a value for each parameter.
    pub points: Vec<Vec<Setting>>,
}

/// A value of a swept parameter.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Where it goes, as after `--set`.
    pub path: String,
    /// Where the sweep names the parameter.
    pub key: Place,
    /// The value, with the place where the sweep says it.
    pub node: Node,
    pub si: f64,
}

impl Setting {
    /// `path=value`, as it could be given with `--set`.
    #[must_use]
    pub fn assignment(&self) -> String {
        format!("{}={}", self.path, self.node.plain())
    }

    /// Whether a fault stands where the sweep names the parameter or says the value.
    #[must_use]
    pub fn owns(&self, fault: &Fault) -> bool {
        fault.place.as_ref().is_some_and(|place| *place == self.key || *place == self.node.place)
    }
}

/// Keys that are no parameters.
const OPTIONS: [&str; 3] = ["design", "points", "common_random_numbers"];

/// Points of a hypercube if nothing is said.
const USUAL_POINTS: usize = 20;

/// A parameter while the sweep is read.
struct Swept {
    key: Key,
    path: String,
    values: Values,
}

impl Swept {
    fn set(&self, value: Valued) -> Setting {
        Setting { path: self.path.clone(), key: self.key.place.clone(), node: value.node, si: value.si }
    }

    /// Tells what is wrong with the parameter itself at its first value.
    fn try_at(&self, at: &dyn Fn(&[Setting]) -> Vec<Fault>, faults: &mut Faults) {
        let first = match &self.values.taken {
            Taken::Each(values) => values.first().cloned(),
            Taken::Range(range) => range.at(0.0),
        };
        let Some(setting) = first.map(|value| self.set(value)) else { return };
        let own = |fault: &Fault| setting.owns(fault);
        at(std::slice::from_ref(&setting)).into_iter().filter(own).for_each(|fault| faults.push(fault));
    }
}

/// Reads `sweep:`. A path that leads nowhere and a value that does not fit are found when a point is read; `at` reads one,
/// so that such faults are told together with those of other parameters.
pub(super) fn read(
    node: &Node,
    network: &Network,
    seed: u64,
    overrides: &[String],
    at: &dyn Fn(&[Setting]) -> Vec<Fault>,
    faults: &mut Faults,
) -> Option<Sweep> {
    let before = faults.list.len();
    let mut fields = Fields::of(node, "sweep", faults)?;
    let design =
        fields.optional("design").and_then(|n| n.choice(&Design::NAMES, faults)).unwrap_or(Design::Grid);
    let points = fields.optional("points");
    let common = fields.optional("common_random_numbers").and_then(|n| n.boolean(faults)).unwrap_or(true);
    let mut swept: Vec<Swept> = Vec::new();
    for (key, value) in fields.entries().iter().filter(|(key, _)| !OPTIONS.contains(&key.name.as_str())) {
        let Some(path) = path_of(key, network, overrides, faults) else { continue };
        if let Some(other) = swept.iter().find(|other| other.path == path) {
            let reason = format!("`{}` is swept already, as `{}`", key.name, other.key.name);
            faults.at(&key.place, reason, "remove one of them");
        }
        if value.value == Value::Null {
            faults.at(&key.place, format!("`{}` has no values", key.name), "e.g. [1 1/s, 2 1/s]");
            continue;
        }
        let written = path.strip_prefix("reactions.parameters.");
        let known = network.parameters.iter().find(|(name, _)| Some(name.as_str()) == written);
        let kind = Kind {
            molecules: path.starts_with("initial."),
            // A bare number is SI, whatever is meant by it.
            dimension: known.map(|(_, quantity)| quantity.dimension).filter(|d| !d.is_none()),
        };
        let Some(values) = values::read(value, &kind, faults) else { continue };
        match (&values.taken, design) {
            (Taken::Each(_), Design::LatinHypercube) => faults.at(
                &value.place,
                format!("`{}` has no range for a hypercube", key.name),
                "write uniform(a, b) or loguniform(a, b), or choose design: grid or list",
            ),
            (Taken::Range(_), Design::Grid | Design::List) => faults.at(
                &value.place,
                format!("a range is no list of values for a {}", design.name()),
                "write linspace(a, b, n) or logspace(a, b, n), or choose design: latin_hypercube",
            ),
            _ => {}
        }
        swept.push(Swept { key: key.clone(), path, values });
    }
    if swept.is_empty() && faults.list.len() == before {
        faults.at(
            &node.place,
            "a sweep over nothing",
            "name a parameter and its values, e.g. k_on: [1 1/s, 2 1/s]",
        );
    }
    let count = points.map(|n| number_of_points(n, design, faults)).unwrap_or(Some(USUAL_POINTS));
    if faults.list.len() > before {
        swept.iter().for_each(|one| one.try_at(at, faults));
        return None;
    }
    let points = points_of(node, design, &swept, count?, seed, faults)?;
    let parameters = swept.into_iter().map(|one| SweptRecord {
        name: one.key.name,
        path: one.path,
        unit: one.values.unit,
        per_si: one.values.per_si,
        logarithmic: one.values.logarithmic,
    });
    Some(Sweep { design, common_random_numbers: common, parameters: parameters.collect(), points })
}

fn number_of_points(node: &Node, design: Design, faults: &mut Faults) -> Option<usize> {
    let count = node.positive_count(faults)?;
    if design != Design::LatinHypercube {
        faults.at(
            &node.place,
            "the number of points follows from the values",
            "remove `points`, or choose design: latin_hypercube",
        );
        return None;
    }
    if count > MOST as u64 {
        too_many(&node.place, count as f64, faults);
        return None;
    }
    Some(count as usize)
}

fn points_of(
    node: &Node,
    design: Design,
    swept: &[Swept],
    points: usize,
    seed: u64,
    faults: &mut Faults,
) -> Option<Vec<Vec<Setting>>> {
    let lists: Vec<&[Valued]> = swept
        .iter()
        .map(|one| match &one.values.taken {
            Taken::Each(values) => values.as_slice(),
            Taken::Range(_) => &[],
        })
        .collect();
    let counts: Vec<usize> = lists.iter().map(|list| list.len()).collect();
    let indices: Vec<Vec<usize>> = match design {
        Design::Grid => {
            let total: f64 = counts.iter().map(|n| *n as f64).product();
            if total > MOST as f64 {
                too_many(&node.place, total, faults);
                return None;
            }
            design::grid(&counts)
        }
        Design::List => {
            if let Some(k) = counts.iter().position(|n| *n != counts[0]) {
                let (first, other) = (&swept[0].key, &swept[k].key);
                faults.at(
                    &other.place,
                    format!("`{}` has {} values, `{}` has {}", other.name, counts[k], first.name, counts[0]),
                    "a list takes the k-th value of each; for every combination choose design: grid",
                );
                return None;
            }
            (0..counts[0]).map(|k| vec![k; counts.len()]).collect()
        }
        Design::LatinHypercube => {
            let value = |(one, part): (&Swept, f64)| match &one.values.taken {
                Taken::Range(range) => range.at(part).map(|value| one.set(value)),
                Taken::Each(_) => None,
            };
            let point = |parts: Vec<f64>| swept.iter().zip(parts).map(value).collect();
            return design::latin_hypercube(points, swept.len(), seed).into_iter().map(point).collect();
        }
    };
    let point = |point: Vec<usize>| {
        let values = lists.iter().zip(point).map(|(list, k)| list[k].clone());
        swept.iter().zip(values).map(|(one, value)| one.set(value)).collect()
    };
    Some(indices.into_iter().map(point).collect())
}
