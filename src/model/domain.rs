//! The `domain:` of a model, its groups of particles and its fluid.

use super::conditions::{self, Condition};
use super::node::{Key, Node};
use super::reader::{Faults, Fields, nearest};
use super::shapes;
use crate::chemistry::Network;
use crate::error::Place;
use crate::fluid::kernel::KernelKind;
use crate::geometry::{Lattice, Shape};
use crate::quantity::Dimension;
use crate::vector::Vector;

/// Where the chemistry happens.
#[derive(Clone, Debug)]
pub enum Domain {
    /// One volume, m³.
    WellMixed { volume: f64 },
    /// Compartments: volumes (m³), names, and links (i, j, G in m).
    Graph { volumes: Vec<f64>, names: Vec<String>, links: Vec<(usize, usize, f64)> },
    /// Particles in a box.
    Particles(Box<ParticleDomain>),
}

/// What happens at the two ends of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    Periodic,
    NoSlip,
    FreeSlip,
}

/// A box filled with particles; lengths in m. Unused coordinates are zero.
#[derive(Clone, Debug)]
pub struct ParticleDomain {
    /// 1, 2 or 3.
    pub dimensions: usize,
    /// Extent of each direction that is not simulated, m.
    pub thickness: f64,
    pub min: Vector<3>,
    pub max: Vector<3>,
    pub boundaries: Vec<Boundary>,
    pub spacing: f64,
    pub kernel: KernelKind,
    /// Kernel cut-off over spacing.
    pub support: f64,
    pub groups: Vec<Group>,
    pub fluid: Option<FluidModel>,
    pub conditions: Vec<Condition>,
}

/// What a group is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Moves with the flow (rests if there is none).
    Fluid,
    /// Solid: no slip or free slip.
    Wall { free_slip: bool },
    /// A region that particles of other groups pass through; owns no particles.
    Zone,
}

/// A named group of particles.
#[derive(Clone, Debug)]
pub struct Group {
    pub name: String,
    pub material: Material,
    pub shape: Shape,
    pub lattice: Lattice,
    /// m.
    pub spacing: f64,
    /// Random displacement of each particle, in spacings.
    pub jitter: f64,
    /// Indices of the species that may live here; all if `None`.
    pub holds: Option<Vec<usize>>,
    pub place: Place,
}

/// The fluid of a moving model.
#[derive(Clone, Debug)]
pub struct FluidModel {
    /// kg/m³.
    pub density: f64,
    /// Pa s.
    pub viscosity: f64,
    /// Reference speed, m/s.
    pub speed: f64,
    /// m/s; from the flow numbers if `None`.
    pub sound_speed: Option<f64>,
    /// Largest pressure difference expected, Pa, for the automatic sound speed.
    pub pressure_scale: Option<f64>,
    /// Velocity at the start, m/s.
    pub velocity: Vector<3>,
    /// How long the flow runs before t = 0, s.
    pub settle: f64,
}

impl ParticleDomain {
    /// Index of the group of this name.
    #[must_use]
    pub fn group(&self, name: &str) -> Option<usize> {
        self.groups.iter().position(|group| group.name == name)
    }
}

impl Domain {
    /// Names of the groups tables and `only_in` speak of, without the sum `all`.
    #[must_use]
    pub fn group_names(&self) -> Vec<String> {
        match self {
            Domain::WellMixed { .. } => Vec::new(),
            Domain::Graph { names, .. } => names.clone(),
            Domain::Particles(box_) => box_.groups.iter().map(|group| group.name.clone()).collect(),
        }
    }
}

/// The other sections of a document that belong to the domain.
pub struct Sections<'a> {
    pub domain: &'a Node,
    pub particles: Option<&'a Node>,
    pub groups: Option<&'a Node>,
    pub fluid: Option<&'a Node>,
    pub conditions: Option<&'a Node>,
}

#[derive(Clone, Copy)]
enum Kind {
    WellMixed,
    Graph,
    Particles,
}

/// Reads the domain and what belongs to it.
pub fn read(sections: &Sections, network: &Network, faults: &mut Faults) -> Option<Domain> {
    let mut fields = Fields::of(sections.domain, "domain", faults)?;
    let kind = fields.required("kind", faults)?.choice(
        &[("well_mixed", Kind::WellMixed), ("graph", Kind::Graph), ("particles", Kind::Particles)],
        faults,
    )?;
    if !matches!(kind, Kind::Particles) {
        for (section, name) in [
            (sections.particles, "particles"),
            (sections.groups, "groups"),
            (sections.fluid, "fluid"),
            (sections.conditions, "conditions"),
        ] {
            if let Some(node) = section {
                faults.at(
                    &node.place,
                    format!("`{name}` belongs to a domain of kind particles"),
                    format!("remove `{name}`, or set domain.kind: particles"),
                );
            }
        }
    }
    match kind {
        Kind::WellMixed => {
            let volume =
                fields.required("volume", faults).and_then(|n| n.positive(Dimension::VOLUME, faults));
            fields.finish(faults);
            // A volume with a fault stays, so that the rest of the model can be checked.
            Some(Domain::WellMixed { volume: volume.unwrap_or(1.0) })
        }
        Kind::Graph => graph(fields, faults),
        Kind::Particles => {
            particles(fields, sections, network, faults).map(|domain| Domain::Particles(Box::new(domain)))
        }
    }
}

fn graph(mut fields: Fields, faults: &mut Faults) -> Option<Domain> {
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
    let mut links = Vec::new();
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
                } else {
                    links.push((i, j, g));
                }
            }
        }
    }
    let volumes = volumes.into_iter().map(|volume| volume.unwrap_or(1.0)).collect();
    Some(Domain::Graph { volumes, names, links })
}

fn particles(
    mut fields: Fields,
    sections: &Sections,
    network: &Network,
    faults: &mut Faults,
) -> Option<ParticleDomain> {
    let dimensions = fields.required("dimensions", faults).and_then(|n| {
        let d = n.integer(faults)?;
        if (1..=3).contains(&d) {
            return Some(d as usize);
        }
        faults.at(&n.place, format!("expected 1, 2 or 3 dimensions, found {d}"), "write 1, 2 or 3");
        None
    });
    let thickness = fields.optional("thickness").map(|n| n.positive(Dimension::LENGTH, faults));
    let corners = (fields.required("min", faults), fields.required("max", faults));
    let boundaries_node = fields.optional("boundaries");
    fields.finish(faults);
    let d = dimensions?;
    let min = corners.0?.vector(Dimension::LENGTH, d, faults);
    let max = corners.1?.vector(Dimension::LENGTH, d, faults);
    let boundaries = boundaries(boundaries_node, d, faults);
    let layout = layout(sections.particles, sections.domain, faults);
    let (min, max) = (pad(&min?), pad(&max?));
    for k in 0..d {
        if max[k] <= min[k] {
            faults.at(
                &corners.1?.place,
                format!("the box has no extent along {}", axis_name(k)),
                "each entry of max must be larger than the one of min",
            );
            return None;
        }
    }
    let fluid = sections.fluid.and_then(|node| fluid(node, d, faults));
    // A layout with a fault is replaced, so that groups and conditions can be checked; NaN fits any box.
    let (spacing, kernel, support) = layout.unwrap_or((f64::NAN, KernelKind::Lucy, 3.0));
    let groups = groups(sections, d, (&min, &max), spacing, network, faults);
    let mut domain = ParticleDomain {
        dimensions: d,
        thickness: match thickness {
            Some(given) => given.unwrap_or(1e-6),
            None => 1e-6,
        },
        min,
        max,
        boundaries: boundaries.unwrap_or_else(|| vec![Boundary::NoSlip; d]),
        spacing,
        kernel,
        support,
        groups: groups?,
        fluid,
        conditions: Vec::new(),
    };
    if let Some(node) = sections.conditions {
        domain.conditions = conditions::read(node, &domain, network, faults);
    }
    Some(domain)
}

/// The name of a coordinate axis.
#[must_use]
pub fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}

fn boundaries(node: Option<&Node>, d: usize, faults: &mut Faults) -> Option<Vec<Boundary>> {
    let mut found = vec![Boundary::NoSlip; d];
    let Some(node) = node else { return Some(found) };
    let kinds =
        [("periodic", Boundary::Periodic), ("no_slip", Boundary::NoSlip), ("free_slip", Boundary::FreeSlip)];
    let mut fields = Fields::of(node, "boundaries", faults)?;
    for (axis, slot) in found.iter_mut().enumerate() {
        if let Some(choice) = fields.optional(axis_name(axis)).and_then(|n| n.choice(&kinds, faults)) {
            *slot = choice;
        }
    }
    fields.finish(faults);
    Some(found)
}

fn layout(node: Option<&Node>, domain: &Node, faults: &mut Faults) -> Option<(f64, KernelKind, f64)> {
    let Some(node) = node else {
        faults.at(
            &domain.place,
            "a domain of particles needs the section `particles`",
            "add particles: { spacing: 0.8 um }",
        );
        return None;
    };
    let mut fields = Fields::of(node, "particles", faults)?;
    let spacing = fields.required("spacing", faults).and_then(|n| n.positive(Dimension::LENGTH, faults));
    let kernel = fields.optional("kernel").map(|n| {
        n.choice(
            &[
                ("lucy", KernelKind::Lucy),
                ("cubic_spline", KernelKind::CubicSpline),
                ("wendland", KernelKind::Wendland),
            ],
            faults,
        )
    });
    let support = fields.optional("support").map(|n| {
        let value = n.number(faults)?;
        if (1.2..=6.0).contains(&value) {
            return Some(value);
        }
        faults.at(
            &n.place,
            format!("a support of {value} spacings"),
            "support is the kernel's cut-off over the spacing, between 1.2 and 6; 3 is usual",
        );
        None
    });
    fields.finish(faults);
    Some((spacing?, kernel.unwrap_or(Some(KernelKind::Lucy))?, support.unwrap_or(Some(3.0))?))
}

#[derive(Clone, Copy)]
enum MaterialName {
    Fluid,
    Wall,
    Zone,
}

fn groups(
    sections: &Sections,
    d: usize,
    corners: (&Vector<3>, &Vector<3>),
    spacing: f64,
    network: &Network,
    faults: &mut Faults,
) -> Option<Vec<Group>> {
    let Some(node) = sections.groups else {
        // The whole box is one group of fluid.
        return Some(vec![Group {
            name: "medium".into(),
            material: Material::Fluid,
            shape: Shape::EverythingElse,
            lattice: Lattice::Square,
            spacing,
            jitter: 0.0,
            holds: None,
            place: sections.domain.place.clone(),
        }]);
    };
    let fields = Fields::of(node, "groups", faults)?;
    let mut found: Vec<Group> = Vec::new();
    for (key, node) in fields.entries() {
        if key.name == "all" || key.name == "boundary" {
            faults.at(
                &key.place,
                format!("the group name `{}` is taken by the program", key.name),
                "choose another name",
            );
        }
        // A group with a fault stays known by its name, so that its uses are not reported as well.
        let read = group(&key.name, &key.place, node, d, spacing, network, faults);
        found.push(read.unwrap_or_else(|| unread(key, spacing)));
    }
    if found.len() > 60 {
        faults.at(
            &node.place,
            format!("{} groups; at most 60 are possible", found.len()),
            "join some of them",
        );
    }
    let rest = found
        .iter()
        .filter(|group| group.shape == Shape::EverythingElse && group.material != Material::Zone)
        .count();
    if rest > 1 {
        let place =
            found.iter().rfind(|group| group.shape == Shape::EverythingElse).map(|group| &group.place);
        faults.at(
            place.unwrap_or(&node.place),
            format!("{rest} groups are `everything_else`"),
            "only one group can take what is left; give the others a shape of their own",
        );
    }
    for group in &found {
        check_fit(group, d, corners, faults);
    }
    Some(found)
}

/// Stands for a group that could not be read.
fn unread(key: &Key, spacing: f64) -> Group {
    Group {
        name: key.name.clone(),
        material: Material::Zone,
        shape: Shape::EverythingElse,
        lattice: Lattice::Square,
        spacing,
        jitter: 0.0,
        holds: None,
        place: key.place.clone(),
    }
}

/// A square lattice must fit the box in whole cells.
fn check_fit(group: &Group, d: usize, (min, max): (&Vector<3>, &Vector<3>), faults: &mut Faults) {
    if group.material == Material::Zone || group.lattice != Lattice::Square {
        return;
    }
    for k in 0..d {
        let cells = (max[k] - min[k]) / group.spacing;
        if (cells - cells.round()).abs() > 1e-6 * cells.max(1.0) || cells.round() < 1.0 {
            let whole = cells.round().max(1.0);
            faults.at(
                &group.place,
                format!(
                    "the spacing {:.6} um of group `{}` does not fit the box: {:.4} cells along {}",
                    group.spacing * 1e6,
                    group.name,
                    cells,
                    axis_name(k)
                ),
                format!("{:.6} um would give {whole} whole cells", (max[k] - min[k]) / whole * 1e6),
            );
            return;
        }
    }
}

fn group(
    name: &str,
    place: &Place,
    node: &Node,
    d: usize,
    default_spacing: f64,
    network: &Network,
    faults: &mut Faults,
) -> Option<Group> {
    let mut fields = Fields::of(node, &format!("group `{name}`"), faults)?;
    let kinds = [("fluid", MaterialName::Fluid), ("wall", MaterialName::Wall), ("zone", MaterialName::Zone)];
    let material = match fields.optional("material") {
        None => MaterialName::Fluid,
        Some(n) => n.choice(&kinds, faults)?,
    };
    let shape = fields.required("shape", faults).and_then(|n| shapes::read(n, d, faults));
    let mut lattice = Lattice::Square;
    let (mut spacing, mut jitter, mut holds) = (default_spacing, 0.0, None);
    if !matches!(material, MaterialName::Zone) {
        if let Some(n) = fields.optional("lattice") {
            lattice = n.choice(&[("square", Lattice::Square), ("rings", Lattice::Rings)], faults)?;
            let round = matches!(shape, Some(Shape::Ball { .. } | Shape::Shell { .. }) | None);
            if lattice == Lattice::Rings && (d != 2 || !round) {
                faults.at(
                    &n.place,
                    "a lattice of rings needs a disc or ring in 2 dimensions",
                    "use lattice: square",
                );
            }
        }
        if let Some(n) = fields.optional("spacing") {
            spacing = n.positive(Dimension::LENGTH, faults)?;
        }
        if let Some(n) = fields.optional("jitter") {
            jitter = n.number(faults)?;
            if !(0.0..=0.4).contains(&jitter) {
                faults.at(
                    &n.place,
                    format!("a jitter of {jitter} spacings"),
                    "jitter lies between 0 and 0.4",
                );
            }
        }
        if let Some(n) = fields.optional("holds") {
            holds = species_held(n, network, faults);
        }
    }
    let free_slip = match (material, fields.optional("slip")) {
        (_, None) => false,
        (MaterialName::Wall, Some(n)) => n.choice(&[("no_slip", false), ("free_slip", true)], faults)?,
        (_, Some(n)) => {
            faults.at(&n.place, "`slip` belongs to a wall", "remove it, or set material: wall");
            false
        }
    };
    fields.finish(faults);
    let material = match material {
        MaterialName::Fluid => Material::Fluid,
        MaterialName::Wall => Material::Wall { free_slip },
        MaterialName::Zone => Material::Zone,
    };
    Some(Group {
        name: name.into(),
        material,
        shape: shape?,
        lattice,
        spacing,
        jitter,
        holds,
        place: place.clone(),
    })
}

fn species_held(node: &Node, network: &Network, faults: &mut Faults) -> Option<Vec<usize>> {
    if let super::node::Value::Text(word) = &node.value {
        match word.as_str() {
            "all" => return None,
            "none" => return Some(Vec::new()),
            _ => {}
        }
    }
    let items: Vec<&Node> = match &node.value {
        super::node::Value::List(items) => items.iter().collect(),
        _ => vec![node],
    };
    Some(items.into_iter().filter_map(|item| species_named(item, network, faults)).collect())
}

/// The species a node names, or a fault with the nearest known name.
pub fn species_named(node: &Node, network: &Network, faults: &mut Faults) -> Option<usize> {
    let name = node.text(faults)?;
    species_index(name, &node.place, network, faults)
}

/// The species of this name, or a fault with the nearest known name.
pub fn species_index(name: &str, place: &Place, network: &Network, faults: &mut Faults) -> Option<usize> {
    let found = network.species.iter().position(|species| species.name == name);
    if found.is_none() {
        let names: Vec<&str> = network.species.iter().map(|species| species.name.as_str()).collect();
        faults.at(place, format!("unknown species `{name}`"), did_you_mean(name, &names, "species"));
    }
    found
}

/// The group of this name, or a fault with the nearest known name.
pub fn group_index(name: &str, place: &Place, groups: &[String], faults: &mut Faults) -> Option<usize> {
    let found = groups.iter().position(|group| group == name);
    if found.is_none() && groups.is_empty() {
        faults.at(
            place,
            format!("unknown group `{name}`: a well-mixed volume has no groups"),
            "remove it, or choose a domain of kind graph or particles",
        );
    } else if found.is_none() {
        let names: Vec<&str> = groups.iter().map(String::as_str).collect();
        faults.at(place, format!("unknown group `{name}`"), did_you_mean(name, &names, "groups"));
    }
    found
}

fn did_you_mean(word: &str, known: &[&str], what: &str) -> String {
    match nearest(word, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`? The {what} are: {}", known.join(", ")),
        None => format!("the {what} are: {}", known.join(", ")),
    }
}

fn fluid(node: &Node, d: usize, faults: &mut Faults) -> Option<FluidModel> {
    let mut fields = Fields::of(node, "fluid", faults)?;
    let moving = match fields.optional("method") {
        None => true,
        Some(n) => n.choice(&[("none", false), ("sph_bvf", true)], faults)?,
    };
    if !moving {
        fields.finish(faults);
        return None;
    }
    let mut positive = |fields: &mut Fields, key: &'static str, dimension| {
        fields.required(key, faults).and_then(|n| n.positive(dimension, faults))
    };
    let density = positive(&mut fields, "density", Dimension::DENSITY);
    let viscosity = positive(&mut fields, "viscosity", Dimension::DYNAMIC_VISCOSITY);
    let speed = positive(&mut fields, "speed", Dimension::VELOCITY);
    let sound_speed = match fields.optional("sound_speed") {
        Some(n) if matches!(&n.value, super::node::Value::Text(word) if word == "auto") => None,
        Some(n) => Some(n.positive(Dimension::VELOCITY, faults)?),
        None => None,
    };
    let pressure_scale = match fields.optional("pressure_scale") {
        Some(n) => Some(n.positive(Dimension::PRESSURE, faults)?),
        None => None,
    };
    let velocity = match fields.optional("velocity") {
        Some(n) => pad(&n.vector(Dimension::VELOCITY, d, faults)?),
        None => Vector::zeros(),
    };
    let settle = match fields.optional("settle") {
        Some(n) => n.non_negative(Dimension::TIME, faults)?,
        None => 0.0,
    };
    fields.finish(faults);
    Some(FluidModel {
        density: density?,
        viscosity: viscosity?,
        speed: speed?,
        sound_speed,
        pressure_scale,
        velocity,
        settle,
    })
}

/// Coordinates padded with zeros to three.
#[must_use]
pub fn pad(x: &[f64]) -> Vector<3> {
    Vector::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0))
}
