//! The `domain:` of a model: which kind it is, and the box of a domain of particles.

use super::conditions::{self, Condition};
use super::fluid::{self, FluidModel};
use super::graph;
use super::groups::{self, Group};
use super::names::{axis_name, pad};
use super::node::{Node, Value};
use super::reader::{Faults, Fields};
use super::seams;
use super::solids::{self, Mechanics, SolidModel};
use crate::chemistry::Network;
use crate::fluid::Weights;
use crate::quantity::Dimension;
use crate::space::kernel::KernelKind;
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
    /// Particles enter and leave; `open` conditions say how.
    Open,
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
    /// Weights of the diffusion operator.
    pub weights: Weights,
    pub groups: Vec<Group>,
    pub fluid: Option<FluidModel>,
    /// Elastic solids.
    pub solids: Vec<SolidModel>,
    pub mechanics: Mechanics,
    pub conditions: Vec<Condition>,
}

impl ParticleDomain {
    /// Index of the group of this name.
    #[must_use]
    pub fn group(&self, name: &str) -> Option<usize> {
        self.groups.iter().position(|group| group.name == name)
    }

    /// Whether anything moves: a fluid or elastic solids.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.fluid.is_some() || !self.solids.is_empty()
    }
}

impl Domain {
    /// Name of group `g`; `all` where there is no such group.
    #[must_use]
    pub fn group_name(&self, g: usize) -> &str {
        match self {
            Domain::WellMixed { .. } => None,
            Domain::Graph { names, .. } => names.get(g).map(String::as_str),
            Domain::Particles(box_) => box_.groups.get(g).map(|group| group.name.as_str()),
        }
        .unwrap_or("all")
    }

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
    pub solids: Option<&'a Node>,
    pub mechanics: Option<&'a Node>,
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
            (sections.solids, "solids"),
            (sections.mechanics, "mechanics"),
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
        Kind::Graph => graph::read(fields, faults),
        Kind::Particles => {
            particles(fields, sections, network, faults).map(|domain| Domain::Particles(Box::new(domain)))
        }
    }
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
    let boundaries_at = boundaries_node.unwrap_or(sections.domain);
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
    let fluid = sections.fluid.and_then(|node| fluid::read(node, d, network, faults));
    // A layout with a fault is replaced, so that groups and conditions can be checked; NaN fits any box.
    let Layout { spacing, kernel, support, weights } = layout.unwrap_or(Layout {
        spacing: f64::NAN,
        kernel: KernelKind::Lucy,
        support: 3.0,
        weights: Weights::Normalised,
    });
    let groups = groups::read(sections, d, (&min, &max), spacing, network, faults);
    let boundaries = boundaries.unwrap_or_else(|| vec![Boundary::NoSlip; d]);
    let mut groups = groups?;
    let walled = boundaries.iter().any(|b| !matches!(b, Boundary::Periodic));
    if let Some(at) = sections.particles.filter(|_| fluid.is_some() && walled) {
        groups::check_sides(&groups, spacing, (d, (&min, &max)), &at.place, faults);
    }
    seams::carry_on(&mut groups, &boundaries, (&min, &max), faults);
    let mut domain = ParticleDomain {
        dimensions: d,
        thickness: match thickness {
            Some(given) => given.unwrap_or(1e-6),
            None => 1e-6,
        },
        min,
        max,
        boundaries,
        spacing,
        kernel,
        support,
        weights,
        groups,
        fluid,
        solids: Vec::new(),
        mechanics: Mechanics::default(),
        conditions: Vec::new(),
    };
    domain.solids = solids::read(sections, &mut domain, network, faults);
    if let Some(node) = sections.conditions {
        domain.conditions = conditions::read(node, &domain, network, faults);
    }
    conditions::check_ends(sections.conditions, &domain, boundaries_at, faults);
    Some(domain)
}

fn boundaries(node: Option<&Node>, d: usize, faults: &mut Faults) -> Option<Vec<Boundary>> {
    let mut found = vec![Boundary::NoSlip; d];
    let Some(node) = node else { return Some(found) };
    let kinds = [
        ("periodic", Boundary::Periodic),
        ("no_slip", Boundary::NoSlip),
        ("free_slip", Boundary::FreeSlip),
        ("open", Boundary::Open),
    ];
    let mut fields = Fields::of(node, "boundaries", faults)?;
    for (axis, slot) in found.iter_mut().enumerate() {
        if let Some(choice) = fields.optional(axis_name(axis)).and_then(|n| n.choice(&kinds, faults)) {
            *slot = choice;
        }
    }
    fields.finish(faults);
    Some(found)
}

/// Kernels by name.
pub(super) const KERNELS: [(&str, KernelKind); 3] = [
    ("lucy", KernelKind::Lucy),
    ("cubic_spline", KernelKind::CubicSpline),
    ("wendland", KernelKind::Wendland),
];

/// What `particles` says.
struct Layout {
    spacing: f64,
    kernel: KernelKind,
    support: f64,
    weights: Weights,
}

fn layout(node: Option<&Node>, domain: &Node, faults: &mut Faults) -> Option<Layout> {
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
    let kernel = fields.optional("kernel").map(|n| n.choice(&KERNELS, faults));
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
    let weights = fields.optional("weights").map(|n| weights(n, faults));
    fields.finish(faults);
    Some(Layout {
        spacing: spacing?,
        kernel: kernel.unwrap_or(Some(KernelKind::Lucy))?,
        support: support.unwrap_or(Some(3.0))?,
        weights: weights.unwrap_or(Some(Weights::Normalised))?,
    })
}

/// Weights by name. Those that could be negative are refused for what they would do to molecules.
fn weights(node: &Node, faults: &mut Faults) -> Option<Weights> {
    if matches!(&node.value, Value::Text(name) if name == "corrected") {
        faults.at(
            &node.place,
            "weights corrected by the kernel's gradient can be negative and differ between the two sides of a pair: no rates at which molecules could hop",
            "use weights: normalised, which correct the diffusivity and stay positive and symmetric",
        );
        return None;
    }
    node.choice(
        &[("normalised", Weights::Normalised), ("plain", Weights::Plain), ("softened", Weights::Softened)],
        faults,
    )
}
