//! The `fluid:` of a model.

use super::names::pad;
use super::node::Node;
use super::reader::{Faults, Fields};
use crate::quantity::Dimension;
use crate::vector::Vector;

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

/// Reads the fluid; `None` where nothing moves.
pub(super) fn read(node: &Node, d: usize, faults: &mut Faults) -> Option<FluidModel> {
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
