//! What a user wrote, checked: documents in YAML become a [`Model`] in SI units. Strings and units end here.

pub mod changes;
pub mod conditions;
pub mod domain;
pub mod flow_file;
pub mod fluid;
pub mod graph;
pub mod groups;
pub mod initial;
pub mod load;
pub mod names;
pub mod node;
pub mod output;
pub mod precision;
pub mod probes;
pub mod reactions;
pub mod reader;
mod seams;
pub mod shapes;
pub mod solids;
pub mod sweep;
mod times;

use crate::chemistry::{Network, Representation};
use crate::error::Place;
use crate::record::ModelText;

pub use conditions::Condition;
pub use domain::{Boundary, Domain, ParticleDomain};
pub use flow_file::FlowFile;
pub use fluid::{FluidModel, FluidPlaces};
pub use groups::{Group, Material};
pub use initial::{Amount, Deal, Initial};
pub use output::{Output, Run};
pub use precision::Precision;
pub use probes::{Probe, ProbeShape};
pub use solids::{Mechanics, SolidModel};
pub use sweep::Sweep;

/// A checked model, everything in SI units, groups and species by index.
#[derive(Clone, Debug)]
pub struct Model {
    pub name: String,
    /// The author's words on it; may be empty.
    pub description: String,
    pub network: Network,
    pub domain: Domain,
    /// Where the flow is recorded, or taken from.
    pub flow: Option<FlowFile>,
    pub chemistry: Chemistry,
    pub initial: Vec<Initial>,
    pub run: Run,
    pub output: Output,
    /// Values to run it with, one point after the other; none of a single point.
    pub sweep: Option<Sweep>,
    pub text: ModelText,
    /// Where parts of the document stand, for faults found while the plan is made.
    pub places: Places,
}

impl Model {
    /// Whether each realization has a flow of its own: thermal noise, or buoyancy, softening or growth by
    /// species that may differ between realizations, which they do unless all are continuous.
    #[must_use]
    pub fn flows_differ(&self) -> bool {
        let Domain::Particles(domain) = &self.domain else { return false };
        let lifts = domain.conditions.iter().any(|c| matches!(c.what, conditions::What::Buoyancy { .. }));
        let representation =
            |s: &crate::chemistry::Species| s.representation.unwrap_or(self.chemistry.representation);
        let chance = self.network.species.iter().any(|s| representation(s) != Representation::Continuous);
        let noise = domain.fluid.as_ref().is_some_and(|fluid| fluid.temperature.is_some());
        let softens = domain.solids.iter().any(|s| s.softening.is_some() || s.growth.is_some());
        noise || (lifts || softens) && chance
    }
}

/// Where the parts of a document stand.
#[derive(Clone, Debug)]
pub struct Places {
    pub document: Place,
    pub domain: Place,
    pub chemistry: Place,
    pub fluid: Place,
    pub run: Place,
}

/// How the chemistry is to be carried and sampled.
#[derive(Clone, Debug, PartialEq)]
pub struct Chemistry {
    /// For species that do not say their own.
    pub representation: Representation,
    /// Sampling method by name; chosen by the program if `None`.
    pub method: Option<Method>,
    /// Chemistry step, s; chosen by the program if `None`.
    pub step: Option<f64>,
    /// How continuous species are taken over a step.
    pub integrator: Integrator,
    /// Largest expected number of hops of a molecule in half a step, for the automatic step.
    pub hops: f64,
    /// Largest expected relative change of a reactant in a step, for the automatic step.
    pub change: f64,
    /// Largest expected relative change of a propensity in a leap of tau-leaping.
    pub tolerance: f64,
    /// Molecules in a voxel from which on a hybrid species is continuous there, and below which it is discrete
    /// again.
    pub above: f64,
    pub below: f64,
}

/// Time integrators of continuous species by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Diffusion by the exact exponential and reactions by Dormand & Prince in turn (Strang splitting).
    #[default]
    Exponential,
    /// Forward Euler on diffusion and reactions together, with the step given.
    Euler,
}

/// Sampling methods by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Gillespie's direct method.
    Direct,
    /// Gibson & Bruck's next reaction method.
    NextReaction,
    /// Composition and rejection of Slepoy, Thompson & Plimpton.
    CompositionRejection,
    /// Elf & Ehrenberg's next subvolume method.
    NextSubvolume,
    /// Tau-leaping with the step of Cao, Gillespie & Petzold: approximate.
    TauLeaping,
    /// Exact sampling of diffusion and reaction in turn (Strang splitting).
    Split,
}

impl Method {
    /// Every method, as it is named in a model.
    pub const NAMES: [(&str, Method); 6] = [
        ("direct", Method::Direct),
        ("next_reaction", Method::NextReaction),
        ("composition_rejection", Method::CompositionRejection),
        ("next_subvolume", Method::NextSubvolume),
        ("tau_leaping", Method::TauLeaping),
        ("split", Method::Split),
    ];

    /// Whether every reaction and every hop is an event of its own.
    #[must_use]
    pub fn event_driven(self) -> bool {
        self != Method::Split
    }
}
