//! What is seen of elastic solids: points that are followed, and each solid as a whole.

use super::vessels;
use crate::geometry::shape::embed;
use crate::model::names::axis_name;
use crate::model::solids::Point;
use crate::model::{Domain, Model};
use crate::plan::Plan;
use crate::record::ProbeRecord;
use crate::samples::ProbeRows;
use crate::scene::Scene;
use crate::solid::Body;
use crate::space::matrix::Matrix;
use crate::vector::Vector;

/// One number of a solid at an instant; it stands in the table of the probes, under the name of the solid or point.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub name: String,
    pub quantity: String,
    /// m.
    pub at: [f64; 3],
    pub value: f64,
}

impl Row {
    /// As the table has it.
    #[must_use]
    pub fn rows(&self, realization: u32, time: f64) -> ProbeRows {
        ProbeRows {
            probe: self.name.clone(),
            realization,
            time,
            quantity: self.quantity.clone(),
            s: vec![0.0],
            position: vec![self.at],
            value: vec![self.value],
        }
    }
}

/// What a whole solid shows, and its units.
const OF_SOLID: [(&str, &str); 3] =
    [("kinetic_energy", "J"), ("elastic_energy", "J"), ("largest_stretch", "1")];

/// Name of the force of the fluid along an axis.
fn force_along(axis: usize) -> String {
    format!("force_{}", axis_name(axis))
}

/// All that is seen of the solids of a scene now.
#[must_use]
pub fn rows<const D: usize>(plan: &Plan, scene: &Scene<D>) -> Vec<Row> {
    let mut found = Vec::new();
    for (number, solid) in scene.plan.solids.iter().enumerate() {
        let Some(elastic) = scene.elastic(number) else { continue };
        for point in plan.model.output.points.iter().filter(|p| p.group == usize::from(solid.group)) {
            found.extend(of_point(point, elastic));
        }
        found.extend(of_solid(&solid.name, elastic, scene.plan.thickness, scene.force_on_solid(number)));
        if let Some(body) = scene.vessel(number) {
            // Stretched from the very first state of rest, through all states of rest since.
            for row in
                found.iter_mut().filter(|row| row.name == solid.name && row.quantity == "largest_stretch")
            {
                row.value = body.vessel.largest_stretch();
            }
            found.extend(vessels::rows(&solid.name, body, scene.plan.thickness));
        }
    }
    found
}

/// Displacement and velocity of the material that was at a place X at rest, from the particle next to it at X_n:
/// u = u_n + (F_n - 1)(X - X_n), v = v_n.
fn of_point<const D: usize>(point: &Point, elastic: &dyn Body<D>) -> Vec<Row> {
    let place = Vector::<D>::from_fn(|k, _| point.at[k]);
    let away = |i: usize| (elastic.places()[i] - place).norm_squared();
    let Some(n) = (0..elastic.len()).min_by(|&a, &b| away(a).total_cmp(&away(b))) else { return Vec::new() };
    let beside = place - elastic.places()[n];
    let moved =
        elastic.position(n) - elastic.places()[n] + (elastic.gradient(n) - Matrix::<D>::identity()) * beside;
    let velocity = elastic.velocities()[n];
    let row = |quantity: String, value: f64| Row {
        name: point.name.clone(),
        quantity,
        at: embed(&(place + moved)).into(),
        value,
    };
    let moves = (0..D).map(|k| row(format!("d{}", axis_name(k)), moved[k]));
    let speeds = (0..D).map(|k| row(format!("v{}", axis_name(k)), velocity[k]));
    moves.chain(speeds).collect()
}

/// Energies (of the depth that a model of fewer than three dimensions stands for), the largest stretch, and the force of
/// the fluid, if there is one.
fn of_solid<const D: usize>(
    name: &str,
    elastic: &dyn Body<D>,
    thickness: f64,
    force: Option<Vector<D>>,
) -> Vec<Row> {
    let n = elastic.len();
    let mass: f64 = (0..n).map(|i| elastic.mass(i)).sum();
    let centre =
        (0..n).fold(Vector::<D>::zeros(), |sum, i| sum + elastic.position(i) * elastic.mass(i)) / mass;
    let values = [
        elastic.kinetic_energy() * thickness,
        elastic.elastic_energy() * thickness,
        elastic.largest_stretch(),
    ];
    let forces = force.into_iter().flat_map(|force| (0..D).map(move |k| (force_along(k), force[k])));
    let row = |(quantity, value)| Row { name: name.into(), quantity, at: embed(&centre).into(), value };
    OF_SOLID
        .iter()
        .zip(values)
        .map(|((quantity, _), value)| ((*quantity).into(), value))
        .chain(forces)
        .map(row)
        .collect()
}

/// Points and solids as the record names them: after the probes.
#[must_use]
pub fn records(model: &Model) -> Vec<ProbeRecord> {
    let Domain::Particles(domain) = &model.domain else { return Vec::new() };
    let components = |letter: &'static str, unit: &'static str| {
        (0..domain.dimensions).map(move |k| (format!("{letter}{}", axis_name(k)), unit.to_string()))
    };
    let axes = if domain.fluid.is_some() { domain.dimensions } else { 0 };
    let forces = || (0..axes).map(|k| (force_along(k), "N".to_string()));
    let points = model.output.points.iter().map(|point| ProbeRecord {
        name: point.name.clone(),
        kind: "point".into(),
        quantities: components("d", "m").chain(components("v", "m/s")).collect(),
    });
    let solids = domain.solids.iter().map(|solid| ProbeRecord {
        name: domain.groups[solid.group].name.clone(),
        kind: "solid".into(),
        quantities: {
            let of_vessel =
                if vessels::is_vessel(domain, solid.placement) { &vessels::OF_VESSEL[..] } else { &[] };
            OF_SOLID
                .iter()
                .chain(of_vessel)
                .map(|&(name, unit)| (name.into(), unit.into()))
                .chain(forces())
                .collect()
        },
    });
    let species: Vec<String> = model.network.species.iter().map(|species| species.name.clone()).collect();
    points.chain(solids).chain(vessels::records(domain, &species)).collect()
}

/// Von Mises stress (Pa) and largest stretch of the particles of a scene; those that are no solid have none.
#[must_use]
pub fn strains<const D: usize>(scene: &Scene<D>) -> (Vec<f64>, Vec<f64>) {
    if scene.plan.solids.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let n = scene.positions.len();
    let (mut stress, mut stretch) = (vec![0.0; n], vec![1.0; n]);
    for (number, solid) in scene.plan.solids.iter().enumerate() {
        let Some(elastic) = scene.elastic(number) else { continue };
        let vessel = scene.vessel(number);
        for i in 0..elastic.len() {
            let sigma = elastic.stress(i);
            let shear = sigma - nalgebra::Matrix3::identity() * (sigma.trace() / 3.0);
            stress[solid.first + i] = (1.5 * shear.norm_squared()).sqrt();
            stretch[solid.first + i] =
                vessel.map_or_else(|| elastic.stretch(i), |body| body.vessel.stretch(i));
        }
    }
    (stress, stretch)
}
