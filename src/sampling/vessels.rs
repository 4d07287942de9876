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

/// A line on the outer surface of a wall, closed: in 2D all columns, in 3D the cut with the x-y plane through the middle.
pub struct OutlineLens {
    name: String,
    /// Along the line, m.
    s: Vec<f64>,
    places: Vec<[f64; 3]>,
    /// Columns at and beside each place, and how much of each.
    spots: Vec<[(usize, f64); 2]>,
    /// Of each column: von Mises stress (Pa, mean of its layers), voxels from inside to outside, volume (m³).
    stress: Vec<f64>,
    voxels: Vec<Vec<usize>>,
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
    let nodes: Vec<Vector<3>> = wall.outer(|i| vessel.solid.position(i)).iter().map(embed).collect();
    let spots = if D == 2 { around(&wall.faces) } else { cut(&wall.edges(), &nodes) };
    let at = |spot: &[(usize, f64); 2]| spot.iter().map(|&(c, part)| nodes[c] * part).sum::<Vector<3>>();
    let places: Vec<Vector<3>> = spots.iter().map(at).collect();
    let mut s = vec![0.0; places.len()];
    for k in 1..places.len() {
        s[k] = s[k - 1] + (places[k] - places[k - 1]).norm();
    }
    let mises = |i: usize| {
        let sigma = vessel.solid.stress(i);
        let shear = sigma - nalgebra::Matrix3::identity() * (sigma.trace() / 3.0);
        (1.5 * shear.norm_squared()).sqrt()
    };
    let column = |c: usize| (0..wall.layers).map(move |layer| wall.particle(c, layer));
    let voxels: Vec<Vec<usize>> =
        (0..wall.columns).map(|c| column(c).map(|i| body.first + i).collect()).collect();
    OutlineLens {
        name: format!("{name} outline"),
        s,
        places: places.iter().map(|&x| x.into()).collect(),
        spots,
        stress: (0..wall.columns).map(|c| column(c).map(mises).sum::<f64>() / wall.layers as f64).collect(),
        volumes: voxels.iter().map(|all| all.iter().map(|&i| scene.volumes[i]).sum()).collect(),
        voxels,
    }
}

/// Columns in the order of a closed line.
fn around<const D: usize>(faces: &[[u32; D]]) -> Vec<[(usize, f64); 2]> {
    let mut next = vec![0; faces.len()];
    for face in faces {
        next[face[0] as usize] = face[1] as usize;
    }
    let mut at = 0;
    let step = |_| {
        let here = at;
        at = next[at];
        [(here, 1.0), (here, 0.0)]
    };
    (0..faces.len()).map(step).collect()
}

/// Where edges cross the x-y plane through the middle of all nodes, in the order of their angle in it.
fn cut(edges: &[[u32; 2]], nodes: &[Vector<3>]) -> Vec<[(usize, f64); 2]> {
    let middle = nodes.iter().sum::<Vector<3>>() / nodes.len().max(1) as f64;
    let level = |c: usize| nodes[c][2] - middle[2];
    let mut found: Vec<(f64, [(usize, f64); 2])> = Vec::new();
    for edge in edges {
        let [a, b] = edge.map(|c| c as usize);
        if (level(a) > 0.0) == (level(b) > 0.0) {
            continue;
        }
        let part = level(a) / (level(a) - level(b));
        let x = nodes[a] * (1.0 - part) + nodes[b] * part - middle;
        found.push((x[1].atan2(x[0]), [(a, 1.0 - part), (b, part)]));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|one| one.1).collect()
}

impl OutlineLens {
    /// Stress and concentration (mol/m³) of each species along the line, means over the thickness of the wall.
    pub(super) fn look(
        &self,
        plan: &Plan,
        amounts: &[f64],
        (realization, time): (u32, f64),
    ) -> Vec<ProbeRows> {
        let count = plan.reactor.species.len();
        let rows = |quantity: &str, columns: &[f64]| ProbeRows {
            probe: self.name.clone(),
            realization,
            time,
            quantity: quantity.into(),
            s: self.s.clone(),
            position: self.places.clone(),
            value: self
                .spots
                .iter()
                .map(|spot| spot.iter().map(|&(c, part)| part * columns[c]).sum())
                .collect(),
        };
        let mut found = vec![rows("stress", &self.stress)];
        for (s, species) in plan.reactor.species.iter().enumerate() {
            let there = |(voxels, volume): (&Vec<usize>, &f64)| {
                voxels.iter().map(|&i| amounts[i * count + s]).sum::<f64>() / (AVOGADRO * volume)
            };
            let columns: Vec<f64> = self.voxels.iter().zip(&self.volumes).map(there).collect();
            found.push(rows(species, &columns));
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
