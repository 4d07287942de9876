//! The `solids:` and `mechanics:` of a model: elastic solids, one entry for each group of `material: solid`.

mod form;
mod living;
mod material;
mod points;

pub use form::Form;
pub use living::{Growth, Softening, Turgor};
pub use material::law_name;
pub use points::Point;
pub(super) use points::{check_names, read as read_points};

use super::domain::{KERNELS, ParticleDomain, Sections};
use super::fluid::field::{self, Field};
use super::fluid::velocity::{self, Velocity};
use super::groups::{Group, Material as GroupMaterial};
use super::names::group_index;
use super::node::{Key, Node};
use super::reader::{Faults, Fields};
use super::shapes;
use crate::chemistry::Network;
use crate::error::Place;
use crate::geometry::Shape;
use crate::quantity::Dimension;
use crate::solid::Material;
use crate::space::KernelKind;

/// An elastic solid as it is described.
#[derive(Clone, Debug)]
pub struct SolidModel {
    pub group: usize,
    pub material: Material,
    pub form: Form,
    /// Of its own particles, m.
    pub spacing: f64,
    /// Of its own bonds.
    pub kernel: KernelKind,
    /// Cut-off of the kernel at rest over spacing.
    pub support: f64,
    pub placement: Placement,
    /// Strength of hourglass control.
    pub hourglass: f64,
    /// Rate at which all velocity is lost, 1/s.
    pub drag: f64,
    /// Pa s.
    pub viscosity: f64,
    /// At t = 0.
    pub velocity: Velocity,
    /// What is in it at rest stays where it is.
    pub clamped: Option<Shape>,
    /// What is in it at rest is displaced as told, m.
    pub driven: Option<(Shape, Field)>,
    pub softening: Option<Softening>,
    pub turgor: Option<Turgor>,
    pub growth: Option<Growth>,
    pub places: SolidPlaces,
}

/// Where parts of a solid are described.
#[derive(Clone, Debug)]
pub struct SolidPlaces {
    /// Its name.
    pub entry: Place,
    /// Its spacing, else its name.
    pub spacing: Place,
    pub clamped: Option<Place>,
    pub driven: Option<Place>,
    pub softening: Option<Place>,
    pub growth: Option<Place>,
    /// What acts on motion only, and its name.
    pub in_motion: Vec<(&'static str, Place)>,
}

/// How the particles of a solid are laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// A lattice of whole cells in the box round its shape.
    #[default]
    Lattice,
    /// Columns across the wall of a ring or spherical shell.
    Layers,
}

/// How the solids of a model move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Mechanics {
    /// With their inertia.
    #[default]
    Dynamic,
    /// In balance at every chemistry step, to this tolerance.
    QuasiStatic { tolerance: f64 },
}

/// Reads `mechanics:`.
pub(super) fn mechanics(node: Option<&Node>, faults: &mut Faults) -> Mechanics {
    let Some(node) = node else { return Mechanics::Dynamic };
    let Some(mut fields) = Fields::of(node, "mechanics", faults) else { return Mechanics::Dynamic };
    let quasi = fields
        .required("mode", faults)
        .and_then(|n| n.choice(&[("dynamic", false), ("quasi_static", true)], faults));
    let asked = fields.optional("tolerance");
    let tolerance = asked.and_then(|n| {
        let tolerance = n.positive(Dimension::NONE, faults)?;
        if tolerance < 1.0 {
            return Some(tolerance);
        }
        faults.at(
            &n.place,
            format!("a tolerance is a number between 0 and 1, found {tolerance}"),
            "it is what is left of the forces when they are called balanced; 1e-4 is usual",
        );
        None
    });
    if let (Some(false), Some(n)) = (quasi, asked) {
        faults.at(
            &n.place,
            "a tolerance belongs to the quasi-static mode",
            "set mode: quasi_static, or remove `tolerance`",
        );
    }
    fields.finish(faults);
    match quasi {
        Some(true) => Mechanics::QuasiStatic { tolerance: tolerance.unwrap_or(1e-4) },
        _ => Mechanics::Dynamic,
    }
}

/// Reads all solids; every group of `material: solid` needs an entry.
pub(super) fn read(
    sections: &Sections,
    domain: &mut ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Vec<SolidModel> {
    domain.mechanics = mechanics(sections.mechanics, faults);
    let mut found: Vec<SolidModel> = Vec::new();
    let mut named: Vec<usize> = Vec::new();
    if let Some(fields) = sections.solids.and_then(|node| Fields::of(node, "solids", faults)) {
        let names: Vec<String> = domain.groups.iter().map(|group| group.name.clone()).collect();
        for (key, node) in fields.entries() {
            let Some(group) = group_index(&key.name, &key.place, &names, faults) else { continue };
            named.push(group);
            let of = &domain.groups[group];
            // A group that could not be read is known by its name only.
            if of.material != GroupMaterial::Solid && !of.unread {
                faults.at(
                    &key.place,
                    format!("group `{}` is no elastic solid", key.name),
                    "set its material: solid, or remove this entry",
                );
            }
            found.extend(solid(key, node, group, domain, network, faults));
        }
    }
    for (g, group) in domain.groups.iter().enumerate() {
        if group.material == GroupMaterial::Solid && !named.contains(&g) {
            faults.at(
                &group.place,
                format!("the elastic solid `{}` has no entry in `solids`", group.name),
                format!(
                    "add solids: {{ {}: {{ density: 1000 kg/m^3, youngs_modulus: 1 MPa, poisson_ratio: 0.3 }} }}",
                    group.name
                ),
            );
        }
    }
    if let (Some(node), true) = (sections.mechanics, named.is_empty() && found.is_empty()) {
        faults.at(&node.place, "`mechanics` is that of elastic solids, and there are none", "remove it");
    }
    for solid in &found {
        let own = |(g, group): &(usize, &mut Group)| *g == solid.group || group.of == Some(solid.group);
        domain.groups.iter_mut().enumerate().filter(own).for_each(|(_, group)| group.spacing = solid.spacing);
    }
    found
}

fn solid(
    key: &Key,
    node: &Node,
    group: usize,
    domain: &ParticleDomain,
    network: &Network,
    faults: &mut Faults,
) -> Option<SolidModel> {
    let d = domain.dimensions;
    let of = &domain.groups[group];
    let mut fields = Fields::of(node, &format!("solid `{}`", key.name), faults)?;
    let material = material::read(&mut fields, faults);
    let form = form::read(&mut fields, (domain.mechanics, domain.fluid.is_some()), faults);
    let spacing_node = fields.optional("spacing");
    let spacing = spacing_node.map(|n| n.positive(Dimension::LENGTH, faults));
    let kernel = fields.optional("kernel").map(|n| n.choice(&KERNELS, faults));
    let support = fields.optional("support").map(|n| support(n, faults));
    let placement = fields
        .optional("placement")
        .map(|n| n.choice(&[("lattice", Placement::Lattice), ("layers", Placement::Layers)], faults));
    let mut rate = |key: &'static str, usual: f64, dimension, faults: &mut Faults| {
        fields.optional(key).map_or(Some(usual), |n| n.non_negative(dimension, faults))
    };
    let hourglass = rate("hourglass", 0.1, Dimension::NONE, faults);
    let drag = rate("drag", 0.0, Dimension::RATE, faults);
    let viscosity = rate("viscosity", 0.0, Dimension::DYNAMIC_VISCOSITY, faults);
    let velocity = fields.optional("velocity").map(|n| velocity::read(n, d, network, faults));
    let clamped = fields.optional("clamped").map(|n| shapes::read(n, d, faults));
    let driven = fields.optional("driven").map(|n| driven(n, d, network, faults));
    let at = (of, d, domain.mechanics);
    let softening = fields.optional("softening").map(|n| living::softening(n, network, faults));
    let turgor = fields.optional("turgor").map(|n| living::turgor(n, at, faults));
    let growth = fields.optional("growth").map(|n| living::growth(n, at, network, faults));
    let place = |key: &str| fields.key_place(key).cloned();
    let places = SolidPlaces {
        entry: key.place.clone(),
        spacing: spacing_node.map_or_else(|| key.place.clone(), |n| n.place.clone()),
        clamped: place("clamped"),
        driven: place("driven"),
        softening: place("softening"),
        growth: place("growth"),
        in_motion: (["drag", "viscosity", "velocity"].into_iter())
            .filter_map(|key| Some((key, place(key)?)))
            .collect(),
    };
    if let (Some(Some(Placement::Layers)), Some(at)) = (&placement, place("placement"))
        && !living::is_wall(of, d)
    {
        faults.at(
            &at,
            "layers fill a ring in 2 dimensions or a spherical shell in 3",
            "use placement: lattice",
        );
    }
    fields.finish(faults);
    if !of.unread && of.shape == Shape::EverythingElse {
        faults.at(
            &of.place,
            format!("the elastic solid `{}` has no shape of its own", of.name),
            "give the group a shape, e.g. shape: { box: { min: [...], max: [...] } }",
        );
        return None;
    }
    Some(SolidModel {
        group,
        material: material?,
        form: form?,
        spacing: spacing.unwrap_or(Some(of.spacing))?,
        kernel: kernel.unwrap_or(Some(domain.kernel))?,
        support: support.unwrap_or(Some(1.6))?,
        placement: placement.unwrap_or(Some(Placement::default()))?,
        hourglass: hourglass?,
        drag: drag?,
        viscosity: viscosity?,
        velocity: velocity.unwrap_or_else(|| Some(Velocity::default()))?,
        clamped: flat(clamped)?,
        driven: flat(driven)?,
        softening: flat(softening)?,
        turgor: flat(turgor)?,
        growth: flat(growth)?,
        places,
    })
}

/// What was left out is none; what could not be read is no solid.
fn flat<T>(read: Option<Option<T>>) -> Option<Option<T>> {
    read.map_or(Some(None), |read| read.map(Some))
}

fn support(node: &Node, faults: &mut Faults) -> Option<f64> {
    let value = node.number(faults)?;
    if (1.2..=4.0).contains(&value) {
        return Some(value);
    }
    faults.at(
        &node.place,
        format!("a support of {value} spacings"),
        "support is the cut-off of the solid's kernel over its spacing, between 1.2 and 4; 1.6 is usual",
    );
    None
}

/// `{ where: <shape>, displacement: ["...", "..."] }`.
fn driven(node: &Node, d: usize, network: &Network, faults: &mut Faults) -> Option<(Shape, Field)> {
    let mut fields = Fields::of(node, "driven", faults)?;
    let shape = fields.required("where", faults).and_then(|n| shapes::read(n, d, faults));
    let displacement = fields
        .required("displacement", faults)
        .and_then(|n| field::read(n, d, Dimension::LENGTH, network, faults));
    fields.finish(faults);
    Some((shape?, displacement?))
}
