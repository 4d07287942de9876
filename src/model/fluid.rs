//! The `fluid:` of a model.

pub(super) mod field;
pub(super) mod velocity;

use super::node::{Node, Value};
use super::reader::{Faults, Fields};
use crate::chemistry::Network;
use crate::error::Place;
use crate::fluid::{EquationOfState, Friction, Method, Options};
use crate::quantity::Dimension;

pub use field::Field;
pub use velocity::Velocity;

/// The fluid of a moving model.
#[derive(Clone, Debug)]
pub struct FluidModel {
    pub method: Method,
    pub friction: Friction,
    pub state: EquationOfState,
    /// kg/m³.
    pub density: f64,
    /// Pa s.
    pub viscosity: f64,
    /// Reference speed, m/s.
    pub speed: f64,
    /// Reference length, m: the width across which the flow is sheared; from the box if `None`.
    pub length: Option<f64>,
    /// m/s; from the flow numbers if `None`.
    pub sound_speed: Option<f64>,
    /// Largest pressure difference expected, Pa, for the automatic sound speed.
    pub pressure_scale: Option<f64>,
    /// Of the thermal noise, K; no noise if `None`.
    pub temperature: Option<f64>,
    /// At the start.
    pub velocity: Velocity,
    /// How long the flow runs before t = 0, s; nothing lifts it meanwhile.
    pub settle: f64,
    pub options: Options,
    pub places: FluidPlaces,
}

/// Where numbers of a fluid are stated.
#[derive(Clone, Debug)]
pub struct FluidPlaces {
    pub speed: Place,
    pub sound_speed: Option<Place>,
    /// Of the velocity at the start, else of the section.
    pub velocity: Place,
}

/// Methods by name; `none` leaves the particles where they are.
const METHODS: [(&str, Option<Method>); 4] = [
    ("sph_bvf", Some(Method::SphBvf)),
    ("sdpd", Some(Method::Sdpd)),
    ("sph", Some(Method::Sph)),
    ("none", None),
];
const FRICTIONS: [(&str, Friction); 2] =
    [("morris", Friction::Morris), ("espanol_revenga", Friction::EspanolRevenga)];
const STATES: [(&str, EquationOfState); 2] =
    [("linear", EquationOfState::Linear), ("tait", EquationOfState::Tait7)];

/// Reads the fluid; `None` where nothing moves.
pub(super) fn read(node: &Node, d: usize, network: &Network, faults: &mut Faults) -> Option<FluidModel> {
    let mut fields = Fields::of(node, "fluid", faults)?;
    let method = match fields.optional("method") {
        None => Some(Method::default()),
        Some(n) => n.choice(&METHODS, faults).unwrap_or_else(|| Some(Method::default())),
    };
    let Some(method) = method else {
        fields.finish(faults);
        return None;
    };
    let friction = fields.optional("friction").map(|n| {
        let friction = n.choice(&FRICTIONS, faults)?;
        if method == Method::Sph && friction != Friction::Morris {
            faults.at(
                &n.place,
                "`sph` has the friction of Morris, Fox & Zhu whatever is asked for",
                "remove `friction`, or choose method: sdpd or sph_bvf",
            );
            return None;
        }
        Some(friction)
    });
    let state = fields.optional("equation_of_state").map(|n| n.choice(&STATES, faults));
    let speed_place = fields.optional("speed").map(|n| n.place.clone());
    let mut required = |fields: &mut Fields, key: &'static str, dimension| {
        fields.required(key, faults).and_then(|n| n.positive(dimension, faults))
    };
    let density = required(&mut fields, "density", Dimension::DENSITY);
    let viscosity = required(&mut fields, "viscosity", Dimension::DYNAMIC_VISCOSITY);
    let speed = required(&mut fields, "speed", Dimension::VELOCITY);
    // Outer `None`: not given; inner: given with a fault.
    let sound_speed_place = fields.optional("sound_speed").map(|n| n.place.clone());
    let sound_speed = match fields.optional("sound_speed") {
        Some(n) if matches!(&n.value, Value::Text(word) if word == "auto") => None,
        found => found.map(|n| n.positive(Dimension::VELOCITY, faults)),
    };
    let mut optional = |fields: &mut Fields, key: &'static str, dimension| {
        fields.optional(key).map(|n| n.positive(dimension, faults))
    };
    let length = optional(&mut fields, "length", Dimension::LENGTH);
    let pressure_scale = optional(&mut fields, "pressure_scale", Dimension::PRESSURE);
    let temperature = optional(&mut fields, "temperature", Dimension::TEMPERATURE);
    let velocity_place = fields.optional("velocity").map(|n| n.place.clone());
    let velocity = match fields.optional("velocity") {
        Some(n) => velocity::read(n, d, network, faults),
        None => Some(Velocity::default()),
    };
    let settle = fields.optional("settle").map(|n| n.non_negative(Dimension::TIME, faults));
    let options = match fields.optional("options") {
        Some(n) => options(n, faults),
        None => Some(Options::default()),
    };
    fields.finish(faults);
    // What has a fault is replaced, so that conditions can be checked; NaN fits any flow.
    Some(FluidModel {
        method,
        friction: friction.flatten().unwrap_or_default(),
        state: state.flatten().unwrap_or_default(),
        density: density.unwrap_or(f64::NAN),
        viscosity: viscosity.unwrap_or(f64::NAN),
        speed: speed.unwrap_or(f64::NAN),
        length: length.flatten(),
        sound_speed: sound_speed.flatten(),
        pressure_scale: pressure_scale.flatten(),
        temperature: temperature.flatten(),
        velocity: velocity.unwrap_or_default(),
        settle: settle.flatten().unwrap_or(0.0),
        options: options.unwrap_or_default(),
        places: FluidPlaces {
            speed: speed_place.unwrap_or_else(|| node.place.clone()),
            sound_speed: sound_speed_place,
            velocity: velocity_place.unwrap_or_else(|| node.place.clone()),
        },
    })
}

/// A value that may be left out; `None` if it was given with a fault.
fn given(value: Option<Option<f64>>) -> Option<Option<f64>> {
    match value {
        Some(None) => None,
        Some(found) => Some(found),
        None => Some(None),
    }
}

/// Largest strengths of density diffusion and shift. Antuono et al. 2010 use 0.1 of the first; 1 damps sound within a
/// cut-off. Twenty of the second leaves a Courant number of 1/20.
const MOST_DELTA: f64 = 1.0;
const MOST_SHIFT: f64 = 20.0;

/// Numerical choices, for comparison with what others printed; the defaults are meant to be kept.
fn options(node: &Node, faults: &mut Faults) -> Option<Options> {
    let usual = Options::default();
    let mut fields = Fields::of(node, "options", faults)?;
    let mut number = |fields: &mut Fields, key: &'static str, most: f64, usual: &str| {
        fields.optional(key).map(|n| {
            let value = n.non_negative(Dimension::NONE, faults)?;
            if value > most {
                faults.at(&n.place, format!("a {key} of {value}; at most {most} makes sense"), usual);
                return None;
            }
            Some(value)
        })
    };
    let delta = number(
        &mut fields,
        "delta",
        MOST_DELTA,
        "0.1 is usual, and chosen without this option; 0 turns the density diffusion off",
    );
    let shift = number(
        &mut fields,
        "shift",
        MOST_SHIFT,
        "2 is usual, and chosen without this option (less where friction is weak); 0 turns the shift off",
    );
    let courant = fields.optional("courant").map(|n| {
        let value = n.positive(Dimension::NONE, faults)?;
        if value > 1.0 {
            faults.at(
                &n.place,
                format!("a Courant number of {value}"),
                "no step above 1 is stable; 0.1 to 0.2 is usual, and chosen without this option",
            );
            return None;
        }
        // A shift A is stable for A times the Courant number up to one.
        if let Some(Some(shift)) = shift.filter(|shift| shift.is_some_and(|shift| shift * value > 1.0)) {
            faults.at(
                &n.place,
                format!("a Courant number of {value} with a shift of {shift}: their product is above 1"),
                format!("a Courant number of {:.2} would do, or a smaller shift", 1.0 / shift),
            );
            return None;
        }
        Some(value)
    });
    let surface_fraction = fields.optional("surface_fraction").map(|n| {
        let value = n.positive(Dimension::NONE, faults)?;
        if value >= 1.0 {
            let reason = format!("a surface at a volume fraction of {value}");
            faults.at(&n.place, reason, "it lies between 0 and 1; 0.49 fits kernels of 2.6 to 3 spacings");
            return None;
        }
        Some(value)
    });
    let mut steps = |fields: &mut Fields, key: &'static str| fields.optional(key).map(|n| n.count(faults));
    let drift_correction = steps(&mut fields, "drift_correction");
    let shepard = steps(&mut fields, "shepard");
    let pressure_switch = fields.optional("pressure_switch").map(|n| n.boolean(faults));
    let density_rate =
        fields.optional("density_rate").map(|n| n.choice(&[("default", false), ("printed", true)], faults));
    let corrected = fields.optional("corrected").map(|n| n.boolean(faults));
    fields.finish(faults);
    Some(Options {
        corrected: corrected.unwrap_or(Some(usual.corrected))?,
        delta: delta.unwrap_or(Some(usual.delta))?,
        shift: given(shift)?,
        courant: given(courant)?,
        surface_fraction: surface_fraction.unwrap_or(Some(usual.surface_fraction))?,
        drift_correction: drift_correction.unwrap_or(Some(usual.drift_correction))?,
        pressure_switch: pressure_switch.unwrap_or(Some(usual.pressure_switch))?,
        shepard: match shepard {
            Some(steps) => Some(steps?).filter(|&steps| steps > 0),
            None => usual.shepard,
        },
        printed_density_rate: density_rate.unwrap_or(Some(usual.printed_density_rate))?,
        ..usual
    })
}
