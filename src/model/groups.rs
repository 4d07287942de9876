//! The `groups:` of a model: named particles with material and shape.

use super::domain::Sections;
use super::names::{axis_name, group_index, species_named};
use super::node::Node;
use super::reader::{Faults, Fields};
use super::shapes;
use crate::chemistry::Network;
use crate::error::Place;
use crate::geometry::{Lattice, Shape};
use crate::quantity::Dimension;
use crate::quantity::readable::length;
use crate::vector::Vector;

/// What a group is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Moves with the flow (rests if there is none).
    Fluid,
    /// Rigid: no slip or free slip.
    Wall { free_slip: bool },
    /// Elastic, as `solids` describes it.
    Solid,
    /// A region that particles of other groups pass through; owns no particles.
    Zone,
    /// Those particles of an elastic solid that lie in the shape at rest; they move with it.
    Surface,
}

impl Material {
    /// Whether groups of it are filled with particles of their own.
    #[must_use]
    pub fn is_filled(self) -> bool {
        !matches!(self, Material::Zone | Material::Surface)
    }
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
    /// The solid whose particles these are, of a surface.
    pub of: Option<usize>,
    pub place: Place,
    /// An axis along which it goes on beyond a periodic side.
    pub crosses: Option<usize>,
    /// Whether only its name is known.
    pub unread: bool,
}

#[derive(Clone, Copy)]
enum MaterialName {
    Fluid,
    Wall,
    Solid,
    Zone,
    Surface,
}

/// Reads all groups.
pub(super) fn read(
    sections: &Sections,
    d: usize,
    corners: (&Vector<3>, &Vector<3>),
    spacing: f64,
    network: &Network,
    faults: &mut Faults,
) -> Option<Vec<Group>> {
    let Some(node) = sections.groups else {
        // The whole box is one group of fluid.
        let medium = Group::everywhere("medium", Material::Fluid, &sections.domain.place, spacing);
        check_fit(&medium, d, corners, faults);
        return Some(vec![medium]);
    };
    let fields = Fields::of(node, "groups", faults)?;
    let mut found: Vec<Group> = Vec::new();
    let names: Vec<String> = fields.entries().iter().map(|(key, _)| key.name.clone()).collect();
    for (key, node) in fields.entries() {
        if key.name == "all" || key.name == "boundary" {
            faults.at(
                &key.place,
                format!("the group name `{}` is taken by the program", key.name),
                "choose another name",
            );
        }
        // A group with a fault stays known by its name, so that its uses are not reported as well.
        let read = group(&key.name, &key.place, node, d, (spacing, &names, network), faults);
        found.push(read.unwrap_or_else(|| Group::unread(&key.name, &key.place, spacing)));
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
        .filter(|group| group.shape == Shape::EverythingElse && group.material.is_filled())
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
        let solid = group.of.and_then(|g| found.get(g));
        if let Some(solid) = solid.filter(|solid| solid.material != Material::Solid && !solid.unread) {
            faults.at(
                &group.place,
                format!("`{}` is a surface of `{}`, which is no elastic solid", group.name, solid.name),
                "name a group of material: solid in its `of`",
            );
        }
    }
    Some(found)
}

impl Group {
    /// A group of all that no other group takes.
    fn everywhere(name: &str, material: Material, place: &Place, spacing: f64) -> Group {
        Group {
            name: name.into(),
            material,
            shape: Shape::EverythingElse,
            lattice: Lattice::Square,
            spacing,
            jitter: 0.0,
            holds: None,
            of: None,
            place: place.clone(),
            crosses: None,
            unread: false,
        }
    }

    /// Stands for a group of which only the name is known.
    pub(super) fn unread(name: &str, place: &Place, spacing: f64) -> Group {
        Group { unread: true, ..Group::everywhere(name, Material::Zone, place, spacing) }
    }
}

/// A square lattice must fit the box in whole cells.
fn check_fit(group: &Group, d: usize, corners: (&Vector<3>, &Vector<3>), faults: &mut Faults) {
    // A solid has a lattice that fits its own shape.
    if matches!(group.material, Material::Zone | Material::Solid | Material::Surface)
        || group.lattice != Lattice::Square
    {
        return;
    }
    whole_cells(&format!("group `{}`", group.name), group.spacing, (d, corners), &group.place, faults);
}

/// Walls round the box are laid out at the spacing of `particles`, whatever that of the groups is; `at` is where it is stated.
pub(super) fn check_sides(
    groups: &[Group],
    spacing: f64,
    (d, corners): (usize, (&Vector<3>, &Vector<3>)),
    at: &Place,
    faults: &mut Faults,
) {
    let same = |group: &Group| {
        group.material.is_filled() && group.lattice == Lattice::Square && group.spacing == spacing
    };
    // What fits a group of this spacing fits the walls; what does not is told there.
    if !groups.iter().any(same) {
        whole_cells("the walls round the box", spacing, (d, corners), at, faults);
    }
}

fn whole_cells(
    what: &str,
    spacing: f64,
    (d, (min, max)): (usize, (&Vector<3>, &Vector<3>)),
    at: &Place,
    faults: &mut Faults,
) {
    for k in 0..d {
        let cells = (max[k] - min[k]) / spacing;
        if (cells - cells.round()).abs() > 1e-6 * cells.max(1.0) || cells.round() < 1.0 {
            let whole = cells.round().max(1.0);
            faults.at(
                at,
                format!(
                    "the spacing {} of {what} does not fit the box: {cells:.4} cells along {}",
                    length(spacing),
                    axis_name(k)
                ),
                format!("{} would give {whole} whole cells", length((max[k] - min[k]) / whole)),
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
    (default_spacing, names, network): (f64, &[String], &Network),
    faults: &mut Faults,
) -> Option<Group> {
    let mut fields = Fields::of(node, &format!("group `{name}`"), faults)?;
    let kinds = [
        ("fluid", MaterialName::Fluid),
        ("wall", MaterialName::Wall),
        ("solid", MaterialName::Solid),
        ("zone", MaterialName::Zone),
        ("surface", MaterialName::Surface),
    ];
    let material = match fields.optional("material") {
        None => MaterialName::Fluid,
        Some(n) => n.choice(&kinds, faults)?,
    };
    let shape = fields.required("shape", faults).and_then(|n| shapes::read(n, d, faults));
    let mut lattice = Lattice::Square;
    let (mut spacing, mut jitter, mut holds) = (default_spacing, 0.0, None);
    let of = match material {
        MaterialName::Surface => {
            let n = fields.required("of", faults)?;
            Some(group_index(n.text(faults)?, &n.place, names, faults)?)
        }
        _ => None,
    };
    if !matches!(material, MaterialName::Zone | MaterialName::Surface) {
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
        if let (MaterialName::Solid, Some(n)) =
            (material, fields.optional("lattice").or_else(|| fields.optional("jitter")))
        {
            faults.at(
                &n.place,
                "how a solid is filled is said in `solids`",
                "remove it; see solids: placement",
            );
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
    }
    if let (false, Some(n)) = (matches!(material, MaterialName::Zone), fields.optional("holds")) {
        holds = species_held(n, network, faults);
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
        MaterialName::Solid => Material::Solid,
        MaterialName::Zone => Material::Zone,
        MaterialName::Surface => Material::Surface,
    };
    Some(Group {
        name: name.into(),
        material,
        shape: shape?,
        lattice,
        spacing,
        jitter,
        holds,
        of,
        place: place.clone(),
        crosses: None,
        unread: false,
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
