//! From files to a checked [`Model`]: every fault of every file in one report.

use super::conditions::What;
use super::flow_file::FlowFile;
use super::node::{self, Node, Value};
use super::reader::{Faults, Fields};
use super::sweep::{self, Setting};
use super::times::End;
use super::{
    Chemistry, Integrator, Method, Model, Places, Run, domain, flow_file, initial, names, output, precision,
    reactions,
};
use crate::chemistry::{Network, Representation};
use crate::error::{Fault, ModelError, Place, Source};
use crate::quantity::Dimension;
use crate::record::{ModelText, PARTICLE_COLUMNS, SOLID_COLUMNS};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// What a file turned out to hold.
pub enum Document {
    Model(Box<Model>),
    Reactions(Network),
}

/// Reads a model, with the values of `--set path.to.key=value` put in.
pub fn model(path: &Path, overrides: &[String]) -> Result<Model, ModelError> {
    match document(path, overrides)? {
        Document::Model(model) => Ok(*model),
        Document::Reactions(_) => Err(Fault::general(
            format!("{} is a reactions file, not a model", path.display()),
            "a model has `reactions`, `domain` and `run`; use `gillesph network` or `gillesph check` on a reactions file",
        )
        .into()),
    }
}

/// Reads a model or a reactions file.
pub fn document(path: &Path, overrides: &[String]) -> Result<Document, ModelError> {
    read_document(path, &Changes { files: &[], overrides, point: None })
}

/// The model at one point of its sweep, without a sweep of its own. The files are those that were read for `base`,
/// whatever stands on the disk by now.
///
/// # Errors
/// All faults at this point.
pub fn point(path: &Path, base: &ModelText, settings: &[Setting]) -> Result<Model, ModelError> {
    let changes = Changes { files: &base.files, overrides: &base.overrides, point: Some(settings) };
    match read_document(path, &changes)? {
        Document::Model(model) => Ok(*model),
        Document::Reactions(_) => {
            Err(Fault::general("a reactions file has no sweep", "sweep the parameters of a model").into())
        }
    }
}

/// What is changed in the documents before they are read.
struct Changes<'a> {
    /// Files that were read before: path as shown and text.
    files: &'a [(String, String)],
    /// `path.to.key=value` of `--set`.
    overrides: &'a [String],
    /// Values of a point of a sweep.
    point: Option<&'a [Setting]>,
}

impl Changes<'_> {
    /// Puts the changes into a document; `here` is what a path is called in it, if it leads there.
    fn put(&self, root: &mut Node, here: &dyn Fn(&str) -> Option<String>, faults: &mut Faults) {
        let overrides = || self.overrides.iter().filter_map(|a| here(a));
        root.place.source.replace(overrides().flat_map(|a| node::trail(root, &a)).collect());
        let set = overrides().map(|a| node::set(root, &a)).collect::<Vec<_>>();
        let settings = self.point.unwrap_or_default().iter();
        let swept = settings.filter_map(|s| Some(node::put(root, &here(&s.path)?, s.node.clone(), &s.key)));
        let swept: Vec<_> = swept.collect();
        faults.list.extend(set.into_iter().chain(swept).filter_map(Result::err));
    }

    /// The assignments that make up these changes.
    fn assignments(&self) -> Vec<String> {
        let settings = self.point.unwrap_or_default().iter().map(Setting::assignment);
        self.overrides.iter().cloned().chain(settings).collect()
    }
}

fn read_document(path: &Path, changes: &Changes) -> Result<Document, ModelError> {
    let source = read_file(path, None, changes.files)?;
    let mut root = node::parse(&source)?;
    sweep::rejoin(&mut root);
    let mut faults = Faults::default();
    // What is set below `reactions` may belong to a file of its own, which is read later.
    let names_file = root.field("reactions").is_some_and(|n| matches!(n.value, Value::Text(_)));
    let here = |path: &str| (!(names_file && below_reactions(path).is_some())).then(|| path.to_string());
    changes.put(&mut root, &here, &mut faults);
    let is_reactions = matches!(&root.value, Value::Map(entries)
        if entries.iter().any(|(k, _)| k.name == "species") && !entries.iter().any(|(k, _)| k.name == "domain"));
    if is_reactions {
        let network = reactions::read(&root, &mut faults);
        faults.name_keys(&root);
        return match network {
            Some(network) if faults.list.is_empty() => Ok(Document::Reactions(network)),
            _ => Err(faults.into_error()),
        };
    }
    let mut text = ModelText {
        hash: String::new(),
        files: vec![(source.path.clone(), source.text.clone())],
        overrides: changes.assignments(),
    };
    let model = read(&root, path, changes, &mut text, &mut faults);
    faults.name_keys(&root);
    match model {
        Some(mut model) if faults.list.is_empty() => {
            text.hash = hash(&text, model.flow.as_ref());
            model.text = text;
            Ok(Document::Model(Box::new(model)))
        }
        _ => Err(faults.into_error()),
    }
}

/// What an assignment sets below `reactions`, if it does.
fn below_reactions(assignment: &str) -> Option<&str> {
    assignment.trim_start().strip_prefix("reactions.")
}

fn hash(text: &ModelText, flow: Option<&FlowFile>) -> String {
    let mut hasher = Sha256::new();
    if let Some(FlowFile::Replay(path)) = flow {
        // On another flow it is another run. What cannot be read is told where it is needed.
        let _ = File::open(path).and_then(|mut file| std::io::copy(&mut file, &mut hasher));
    }
    for (_, content) in &text.files {
        hasher.update((content.len() as u64).to_le_bytes());
        hasher.update(content.as_bytes());
    }
    for assignment in &text.overrides {
        hasher.update((assignment.len() as u64).to_le_bytes());
        hasher.update(assignment.as_bytes());
    }
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A file, if it is not among those `known`.
fn read_file(
    path: &Path,
    asked_at: Option<&Place>,
    known: &[(String, String)],
) -> Result<Arc<Source>, Fault> {
    let shown = path.display().to_string();
    if let Some((_, text)) = known.iter().find(|(path, _)| *path == shown) {
        return Ok(Arc::new(Source::new(shown, text.clone())));
    }
    std::fs::read_to_string(path).map(|text| Arc::new(Source::new(shown.clone(), text))).map_err(|error| {
        let reason = match error.kind() {
            std::io::ErrorKind::NotFound => format!("the file {shown} does not exist"),
            std::io::ErrorKind::InvalidData => format!("the file {shown} is not text in UTF-8"),
            std::io::ErrorKind::IsADirectory => format!("{shown} is a folder, not a file"),
            _ => format!("the file {shown} cannot be read: {error}"),
        };
        let remedy = "check the path; paths in a model are relative to the model file";
        match asked_at {
            Some(place) => Fault::at(place, reason, remedy),
            None => Fault::general(reason, "give the path of a model or reactions file, a text in YAML"),
        }
    })
}

/// `models/../reactions/x.yaml` -> `reactions/x.yaml`, so that messages show what a user would type.
fn tidy(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for part in path.components() {
        let above = tidy.components().next_back();
        match part {
            Component::ParentDir if matches!(above, Some(Component::Normal(_))) => {
                tidy.pop();
            }
            Component::CurDir => {}
            other => tidy.push(other),
        }
    }
    tidy
}

fn read(
    root: &Node,
    path: &Path,
    changes: &Changes,
    text: &mut ModelText,
    faults: &mut Faults,
) -> Option<Model> {
    let mut fields = Fields::of(root, "the model", faults)?;
    let name = fields.required("name", faults).and_then(|n| {
        let name = n.text(faults)?;
        if name.is_empty() || name.contains(['/', '\\']) || name.starts_with('.') {
            faults.at(&n.place, format!("`{name}` cannot name a folder"), "use letters, digits, - and _");
            return None;
        }
        Some(name.to_string())
    });
    let description = match fields.optional("description") {
        Some(n) => n.text(faults).unwrap_or_default().to_string(),
        None => String::new(),
    };
    let network_node = fields.required("reactions", faults);
    let domain_node = fields.required("domain", faults);
    let sections = [
        fields.optional("particles"),
        fields.optional("groups"),
        fields.optional("fluid"),
        fields.optional("conditions"),
        fields.optional("solids"),
        fields.optional("mechanics"),
    ];
    let flow_node = fields.optional("flow");
    let chemistry_node = fields.optional("chemistry");
    let initial_node = fields.optional("initial");
    let run_node = fields.required("run", faults);
    let output_node = fields.optional("output");
    let sweep_node = fields.optional("sweep").filter(|_| changes.point.is_none());
    fields.finish(faults);

    let network = network_node.and_then(|n| network(n, path, changes, text, faults));
    let run = run_node.and_then(|n| output::read_run(n, faults));
    let chemistry = chemistry(chemistry_node, faults);
    let network = network?;
    let seed = run.as_ref().map_or(1, |run| run.seed);
    let read_so_far = text.clone();
    let at =
        |settings: &[Setting]| point(path, &read_so_far, settings).err().map_or_else(Vec::new, |e| e.faults);
    let sweep = sweep_node.and_then(|n| sweep::read(n, &network, seed, changes.overrides, &at, faults));
    let domain = domain_node.and_then(|node| {
        domain::read(
            &domain::Sections {
                domain: node,
                particles: sections[0],
                groups: sections[1],
                fluid: sections[2],
                conditions: sections[3],
                solids: sections[4],
                mechanics: sections[5],
            },
            &network,
            faults,
        )
    });
    let domain = domain?;
    check_only_in(&network, &domain, faults);
    check_names(&network, &domain, faults);
    let initial = initial::read(initial_node, &domain, &network, faults);
    // Nothing lies after an end that could not be read: comparisons with NaN find no fault.
    let until = run.as_ref().map_or(f64::NAN, |run| run.until);
    let shortened = text.overrides.iter().any(|assignment| assignment.trim_start().starts_with("run.until="));
    let end = End { time: until, shortened };
    let asked = run_node.and_then(|node| node.field("until_precision"));
    let mut precision = asked.and_then(|node| precision::read(node, end, &domain, &network, faults));
    let output = output::read_output(output_node, end, &domain, &network, precision.as_mut(), faults);
    let run = Run { until_precision: precision, ..run? };
    let flow = flow_node.and_then(|n| flow_file::read(n, path.parent().unwrap_or(Path::new("")), faults));
    if let (Some(node), Some(_), Some(FlowFile::Record(_))) = (flow_node, sweep_node, &flow) {
        faults.at(
            &node.place,
            "every point of the sweep would record its flow into the same file",
            "record it at one point first, with --set sweep=null, then replay it",
        );
    }
    if let Some(node) = flow_node {
        let reason = match &domain {
            domain::Domain::Particles(domain) if domain.fluid.is_some() => {
                let alone = domain.fluid.as_ref().is_some_and(|fluid| fluid.temperature.is_some());
                let lifted = domain.conditions.iter().any(|c| matches!(c.what, What::Buoyancy { .. }));
                match (alone, lifted) {
                    (true, _) => "with thermal noise each realization has a flow of its own",
                    (_, true) => "with buoyancy the flow depends on the species",
                    _ => "",
                }
            }
            _ => "nothing flows in this model",
        };
        if !reason.is_empty() {
            faults.at(&node.place, format!("{reason}: there is no flow to share"), "leave `flow` out");
        }
    }
    let place = |node: Option<&Node>| node.map_or_else(|| root.place.clone(), |n| n.place.clone());
    Some(Model {
        name: name?,
        description,
        network,
        domain,
        flow,
        chemistry: chemistry?,
        initial,
        run,
        output: output?,
        sweep,
        text: ModelText::default(),
        places: Places {
            document: root.place.clone(),
            domain: place(domain_node),
            chemistry: place(chemistry_node.or(domain_node)),
            fluid: place(sections[2].or(domain_node)),
            run: place(run_node),
        },
    })
}

/// The network given inline, or in a file of its own.
fn network(
    node: &Node,
    model_path: &Path,
    changes: &Changes,
    text: &mut ModelText,
    faults: &mut Faults,
) -> Option<Network> {
    if matches!(node.value, Value::Map(_)) {
        return reactions::read(node, faults);
    }
    let relative = node.text(faults)?;
    let path = tidy(&model_path.parent().unwrap_or(Path::new("")).join(relative));
    match read_file(&path, Some(&node.place), changes.files) {
        Err(fault) => {
            faults.list.push(fault);
            None
        }
        Ok(source) => {
            text.files.push((source.path.clone(), source.text.clone()));
            match node::parse(&source) {
                Ok(mut root) => {
                    let here = |path: &str| below_reactions(path).map(str::to_string);
                    changes.put(&mut root, &here, faults);
                    let network = reactions::read(&root, faults);
                    faults.name_keys(&root);
                    network
                }
                Err(error) => {
                    faults.list.extend(error.faults);
                    None
                }
            }
        }
    }
}

fn chemistry(node: Option<&Node>, faults: &mut Faults) -> Option<Chemistry> {
    let mut chemistry = Chemistry {
        representation: Representation::Discrete,
        method: None,
        step: None,
        integrator: Integrator::Exponential,
        hops: 0.2,
        change: 0.1,
        tolerance: 0.03, // Cao, Gillespie & Petzold (2006)
        above: 1000.0,
        below: 500.0,
    };
    let Some(node) = node else { return Some(chemistry) };
    let mut fields = Fields::of(node, "chemistry", faults)?;
    let representation =
        fields.optional("representation").and_then(|n| n.choice(&Representation::NAMED, faults));
    chemistry.representation = representation.unwrap_or(chemistry.representation);
    chemistry.method = fields.optional("method").and_then(|n| n.choice(&Method::NAMES, faults));
    chemistry.step = fields.optional("step").and_then(|n| n.positive(Dimension::TIME, faults));
    let integrator = fields.optional("integrator").and_then(|n| {
        n.choice(&[("exponential", Integrator::Exponential), ("euler", Integrator::Euler)], faults)
    });
    chemistry.integrator = integrator.unwrap_or_default();
    for (key, value) in [("hops", &mut chemistry.hops), ("change", &mut chemistry.change)] {
        let given = fields.optional(key).and_then(|n| n.positive(Dimension::NONE, faults));
        *value = given.unwrap_or(*value);
    }
    if let Some(node) = fields.optional("tolerance") {
        match node.positive(Dimension::NONE, faults) {
            _ if chemistry.method != Some(Method::TauLeaping) => faults.at(
                &node.place,
                "a tolerance belongs to tau-leaping",
                "set method: tau_leaping, or remove `tolerance`",
            ),
            Some(tolerance) if tolerance >= 1.0 => faults.at(
                &node.place,
                format!("a tolerance is a number between 0 and 1, found {tolerance}"),
                "0.03 is usual: propensities may change by 3 % in a leap",
            ),
            Some(tolerance) => chemistry.tolerance = tolerance,
            None => {}
        }
    }
    if let Some(n) = fields.optional("hybrid") {
        thresholds(n, &mut chemistry, faults);
    }
    fields.finish(faults);
    Some(chemistry)
}

/// `hybrid: { above: 1000, below: 500 }`: molecules in a voxel between which a hybrid species stays as it is.
fn thresholds(node: &Node, chemistry: &mut Chemistry, faults: &mut Faults) {
    let Some(mut fields) = Fields::of(node, "hybrid", faults) else { return };
    let above = fields.optional("above").and_then(|n| n.positive(Dimension::NONE, faults));
    let below = fields.optional("below").and_then(|n| n.positive(Dimension::NONE, faults));
    fields.finish(faults);
    chemistry.above = above.unwrap_or(chemistry.above);
    chemistry.below = below.unwrap_or(0.5 * chemistry.above);
    if !(chemistry.below >= FEWEST && chemistry.below < chemistry.above) {
        faults.at(
            &node.place,
            format!(
                "hybrid species would be continuous from {} molecules on and discrete below {}",
                chemistry.above, chemistry.below
            ),
            format!("`below` lies between {FEWEST} and `above`, so that numbers near it do not change over and over"),
        );
    }
}

/// Fewer molecules than this in a voxel are never carried as a real amount by choice of the program.
const FEWEST: f64 = 10.0;

/// A species may be called neither like a group nor, on particles, like a column of their table.
fn check_names(network: &Network, domain: &domain::Domain, faults: &mut Faults) {
    let groups = domain.group_names();
    let particles = matches!(domain, domain::Domain::Particles(_));
    for species in &network.species {
        let name = species.name.as_str();
        let taken = if groups.iter().any(|group| group == name) {
            "a group of this model"
        } else if particles && (PARTICLE_COLUMNS.contains(&name) || SOLID_COLUMNS.contains(&name)) {
            "a column of the particle tables"
        } else {
            continue;
        };
        faults.at(
            &species.place,
            format!("the species name `{name}` is taken: it is the name of {taken}"),
            "rename the species",
        );
    }
}

/// Every `only_in` must name a group of the domain.
fn check_only_in(network: &Network, domain: &domain::Domain, faults: &mut Faults) {
    let groups = domain.group_names();
    let mut check = |only_in: &Option<Vec<crate::chemistry::network::Named>>| {
        for named in only_in.iter().flatten() {
            names::group_index(&named.name, &named.place, &groups, faults);
        }
    };
    for species in &network.species {
        check(&species.only_in);
    }
    for reaction in &network.reactions {
        check(&reaction.only_in);
    }
}
