//! What is seen of walls in balance with what they enclose: turgor, shape, books; and their outlines.

use super::solids::Row;
use crate::chemistry::AVOGADRO;
use crate::geometry::shape::embed;
use crate::model::ParticleDomain;
use crate::model::solids::Placement;
use crate::plan::Plan;
use crate::record::ProbeRecord;
use crate::samples::ProbeRows;
use crate::scene::{Scene, VesselBody};
use crate::vector::Vector;

/// What a wall shows, and its units.
pub(super) const OF_VESSEL: [(&str, &str); 15] = [
    ("volume_inside", "m^3"),
    ("pressure_inside", "Pa"),
    ("length", "m"),
    ("width", "m"),
    ("tip_curvature", "1/m"),
    ("hull_ratio", "1"),
    ("direction", "rad"),
    ("escapes", "1"),
    ("mass", "kg"),
    ("mass_balance", "1"),
    ("residual", "1"),
    ("time_ratio", "1"),
    ("columns", "1"),
    ("body_radius", "m"),
    ("thinnest", "m"),
];

/// Of each column of a wall its place on the outer surface, von Mises stress (mean of its layers) and volume.
pub struct OutlineLens {
    name: String,
    /// Along the outer surface from the first column, m; in 3D the angle from the tip times the body's radius.
    s: Vec<f64>,
    places: Vec<[f64; 3]>,
    stress: Vec<f64>,
    /// Voxels of each column, from inside to outside.
    voxels: Vec<Vec<usize>>,
    /// Volume of each column, m³.
    volumes: Vec<f64>,
}

/// All that is seen of a wall now; `thickness` is the depth of a model of fewer than three dimensions, to its power.
pub(super) fn rows<const D: usize>(name: &str, body: &VesselBody<D>, thickness: f64) -> Vec<Row> {
    let (vessel, outline) = (&body.vessel, body.vessel.outline());
    let values = [
        vessel.inside().volume * thickness,
        vessel.inside().pressure,
        outline.length,
        outline.width,
        outline.tip_curvature,
        outline.hull_ratio,
        outline.angle(),
        body.course().escapes as f64,
        vessel.mass() * thickness,
        vessel.imbalance(),
        vessel.last().residual,
        body.time_ratio,
        vessel.wall.columns as f64,
        outline.radius,
        vessel.thinnest(),
    ];
    let at: [f64; 3] = embed(&outline.tip).into();
    let row = |((quantity, _), value): (&(&str, &str), f64)| Row {
        name: name.into(),
        quantity: (*quantity).into(),
        at,
        value,
    };
    OF_VESSEL.iter().zip(values).map(row).collect()
}

/// The outlines of a scene.
pub(super) fn outlines<const D: usize>(scene: &Scene<D>) -> Vec<OutlineLens> {
    scene.vessels.iter().map(|body| outline(&scene.plan.solids[body.number].name, body, scene)).collect()
}

fn outline<const D: usize>(name: &str, body: &VesselBody<D>, scene: &Scene<D>) -> OutlineLens {
    let (vessel, wall) = (&body.vessel, &body.vessel.wall);
    let nodes = wall.outer(|i| vessel.solid.position(i));
    let (order, s) = if D == 2 { around(&wall.faces, &nodes) } else { from_tip(body, &nodes) };
    let mises = |i: usize| {
        let sigma = vessel.solid.stress(i);
        let shear = sigma - nalgebra::Matrix3::identity() * (sigma.trace() / 3.0);
        (1.5 * shear.norm_squared()).sqrt()
    };
    let column = |c: usize| (0..wall.layers).map(move |layer| wall.particle(c, layer));
    let voxels: Vec<Vec<usize>> =
        order.iter().map(|&c| column(c).map(|i| body.first + i).collect()).collect();
    OutlineLens {
        name: format!("{name} outline"),
        s,
        places: order.iter().map(|&c| embed(&nodes[c]).into()).collect(),
        stress: order.iter().map(|&c| column(c).map(mises).sum::<f64>() / wall.layers as f64).collect(),
        volumes: voxels.iter().map(|all| all.iter().map(|&i| scene.volumes[i]).sum()).collect(),
        voxels,
    }
}

/// Columns in the order of a closed line, and how far along it they are (m).
fn around<const D: usize>(faces: &[[u32; D]], nodes: &[Vector<D>]) -> (Vec<usize>, Vec<f64>) {
    let mut next = vec![0; nodes.len()];
    for face in faces {
        next[face[0] as usize] = face[1] as usize;
    }
    let (mut at, mut s) = (0, 0.0);
    let mut found = (Vec::with_capacity(nodes.len()), Vec::with_capacity(nodes.len()));
    for _ in 0..nodes.len() {
        found.0.push(at);
        found.1.push(s);
        s += (nodes[next[at]] - nodes[at]).norm();
        at = next[at];
    }
    found
}

/// Columns as they are numbered, and their angle from the tip times the radius of the body (m).
fn from_tip<const D: usize>(body: &VesselBody<D>, nodes: &[Vector<D>]) -> (Vec<usize>, Vec<f64>) {
    let outline = body.vessel.outline();
    let centre = outline.tip - outline.direction * (outline.radius + outline.length);
    let angle = |x: &Vector<D>| (x - centre).normalize().dot(&outline.direction).clamp(-1.0, 1.0).acos();
    ((0..nodes.len()).collect(), nodes.iter().map(|x| angle(x) * outline.radius).collect())
}

impl OutlineLens {
    /// Stress and the mean concentration (mol/m³) of each species in the columns.
    pub(super) fn look(
        &self,
        plan: &Plan,
        amounts: &[f64],
        (realization, time): (u32, f64),
    ) -> Vec<ProbeRows> {
        let count = plan.reactor.species.len();
        let rows = |quantity: &str, value: Vec<f64>| ProbeRows {
            probe: self.name.clone(),
            realization,
            time,
            quantity: quantity.into(),
            s: self.s.clone(),
            position: self.places.clone(),
            value,
        };
        let mut found = vec![rows("stress", self.stress.clone())];
        for (s, species) in plan.reactor.species.iter().enumerate() {
            let there = |(voxels, volume): (&Vec<usize>, &f64)| {
                voxels.iter().map(|&i| amounts[i * count + s]).sum::<f64>() / (AVOGADRO * volume)
            };
            found.push(rows(species, self.voxels.iter().zip(&self.volumes).map(there).collect()));
        }
        found
    }
}

/// Outlines as the record names them.
pub(super) fn records<'a>(
    domain: &'a ParticleDomain,
    species: &'a [String],
) -> impl Iterator<Item = ProbeRecord> + 'a {
    let walls = domain.solids.iter().filter(|solid| is_vessel(domain, solid.placement));
    walls.map(move |solid| ProbeRecord {
        name: format!("{} outline", domain.groups[solid.group].name),
        kind: "outline".into(),
        quantities: std::iter::once(("stress".to_string(), "Pa".to_string()))
            .chain(species.iter().map(|name| (name.clone(), "mol/m^3".to_string())))
            .collect(),
    })
}

/// Whether a solid of the model is a wall in balance.
pub(super) fn is_vessel(domain: &ParticleDomain, placement: Placement) -> bool {
    domain.mechanics != crate::model::Mechanics::Dynamic && placement == Placement::Layers
}
