//! A checked model compiled into what the stepping needs: reactor, particles, bodies, columns to observe.

mod bodies;
mod caution;
pub mod chemistry;
pub mod flow;
mod lift;
pub mod limits;
pub mod methods;
pub mod narrow;
mod openings;
pub mod particles;
pub mod solids;
pub mod start;
pub mod surfaces;
mod thickness;
pub mod vessels;

use crate::chemistry::analysis::{Analysis, analyse};
use crate::chemistry::{Links, Network, Reactor};
use crate::error::{Fault, ModelError};
use crate::model::{Domain, Method, Model, ParticleDomain};

pub use lift::Lift;
pub use openings::OpeningsPlan;
pub use particles::ParticlePlan;
pub use solids::SolidPlan;
pub use vessels::VesselPlan;

/// A model ready to run.
pub struct Plan {
    pub model: Model,
    /// The network with the conditions that act like reactions added.
    pub network: Network,
    pub analysis: Analysis,
    pub reactor: Reactor,
    pub arena: Arena,
    /// What the series record, in the order of the table.
    pub columns: Vec<Column>,
    /// What is not wrong but should be known before a run.
    pub warnings: Vec<Fault>,
}

/// One column of the series: a species in a group (`None`: the whole domain).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    pub group: Option<usize>,
    pub species: usize,
}

/// Where the molecules are.
pub enum Arena {
    Compartments(Compartments),
    Line(Box<ParticlePlan<1>>),
    Plane(Box<ParticlePlan<2>>),
    Space(Box<ParticlePlan<3>>),
}

/// Volumes that stay as they are and the links between them.
pub struct Compartments {
    /// m³.
    pub volumes: Vec<f64>,
    /// Class of each volume for `only_in`; volumes that no `only_in` names share class 0.
    pub home: Vec<u8>,
    pub links: Links,
    pub method: Method,
}

impl Plan {
    /// Compiles a model; `realizations` is the number that will run here, for the estimate of memory.
    pub fn new(model: Model, realizations: u32) -> Result<Plan, ModelError> {
        let mut faults = Vec::new();
        let network = chemistry::with_conditions(&model);
        let analysis = analyse(&network);
        let discrete = chemistry::discrete(&model, &network);
        limits::check_memory(&model, realizations)?;
        chemistry::check_integrator(&model, &network, &discrete, &mut faults);
        let (arena, groups) = match &model.domain {
            Domain::WellMixed { volume } => {
                let compartments = Compartments {
                    volumes: vec![*volume],
                    home: vec![0],
                    links: Links::none(1),
                    method: methods::method(&model, &network, &discrete, 1, &mut faults),
                };
                (Arena::Compartments(compartments), vec![vec![0]])
            }
            Domain::Graph { volumes, links, .. } => {
                let (home, groups) = chemistry::classes(&network, &model.domain);
                if groups.iter().flatten().any(|&class| class > 60) {
                    faults.push(Fault::at(
                        &model.places.domain,
                        "`only_in` names more than 60 different volumes",
                        "use a domain of kind particles, whose groups may hold any number of voxels",
                    ));
                }
                let compartments = Compartments {
                    volumes: volumes.clone(),
                    home,
                    links: Links::from_pairs(volumes.len(), links),
                    method: methods::method(&model, &network, &discrete, volumes.len(), &mut faults),
                };
                (Arena::Compartments(compartments), groups)
            }
            Domain::Particles(domain) => {
                methods::check_particles(&model, &network, domain, &discrete, &mut faults);
                let groups = (0..domain.groups.len()).map(|g| vec![g as u8]).collect();
                let arena = match domain.dimensions {
                    1 => Arena::Line(Box::new(ParticlePlan::new(&model, domain, &mut faults))),
                    2 => Arena::Plane(Box::new(ParticlePlan::new(&model, domain, &mut faults))),
                    _ => Arena::Space(Box::new(ParticlePlan::new(&model, domain, &mut faults))),
                };
                (arena, groups)
            }
        };
        let reactor = chemistry::reactor(&model, &network, discrete, &groups, &mut faults);
        let columns = chemistry::columns(&model, &reactor, &groups);
        let mut plan = Plan { model, network, analysis, reactor, arena, columns, warnings: Vec::new() };
        start::check(&plan, &mut faults);
        surfaces::check(&plan, &mut faults);
        if let Domain::Particles(domain) = &plan.model.domain {
            solids::check_species(&plan, domain, &mut faults);
        }
        if !faults.is_empty() {
            return Err(ModelError::sorted(faults));
        }
        if let Domain::Particles(domain) = &plan.model.domain {
            fn of<const D: usize>(
                model: &Model,
                domain: &ParticleDomain,
                plan: &ParticlePlan<D>,
            ) -> Vec<Fault> {
                [flow::warnings(model, domain, plan), narrow::warnings(model, domain, plan)].concat()
            }
            plan.warnings = match &plan.arena {
                Arena::Compartments(_) => Vec::new(),
                Arena::Line(particles) => of(&plan.model, domain, particles),
                Arena::Plane(particles) => of(&plan.model, domain, particles),
                Arena::Space(particles) => of(&plan.model, domain, particles),
            };
        }
        Ok(plan)
    }

    /// Conserved sums in words and their coefficients by species.
    #[must_use]
    pub fn conservation_laws(&self) -> Vec<(String, Vec<f64>)> {
        chemistry::conservation_laws(&self.network, &self.analysis)
    }

    /// How a species is carried: `discrete`, `continuous` or `hybrid`.
    #[must_use]
    pub fn representation(&self, s: usize) -> &'static str {
        let hybrid = self.reactor.hybrid.as_ref().is_some_and(|hybrid| hybrid.bit(s) != 0);
        match (hybrid, self.reactor.discrete[s]) {
            (true, _) => "hybrid",
            (false, true) => "discrete",
            (false, false) => "continuous",
        }
    }

    /// Name of a column's group.
    #[must_use]
    pub fn group_name(&self, column: &Column) -> String {
        match column.group {
            None => "all".into(),
            Some(g) => self.model.domain.group_name(g).to_string(),
        }
    }
}
