//! Published cases and exact answers, each run with ours beside the published and the reference values.
//!
//! The cases are the models that are shipped, changed only by values a user could give with `--set`.

mod annihilation;
mod beam_modes;
mod beams;
mod bessel;
mod cantilever;
mod cavity;
mod compact;
mod compartments;
mod cylinder;
mod duct;
mod findings;
mod flow;
mod fsi_rod;
mod lame;
mod moving_walls;
mod natural_convection;
mod nodes;
mod pheromone;
mod poiseuille;
mod reading;
mod series;
mod stream_function;
mod table;
mod table_2_1;
mod table_2_2;
mod table_2_3;
mod taylor_green;
mod thermostat;
mod verdict;
mod vortices;

use crate::ensemble;
use crate::ensemble::Results;
use crate::error::RunError;
use crate::model::load;
use crate::plan::Plan;
use crate::samples::ParticleFrame;
use crate::simulation::{NotReady, Ready, Watch};
use findings::Findings;
pub use findings::{Curves, write};
use std::cell::Cell;
use std::path::{Path, PathBuf};
pub use verdict::{Row, Verdict};

/// A case by name.
pub struct Case {
    pub name: &'static str,
    /// One line on it.
    pub what: &'static str,
    /// Runs it.
    pub run: fn(Scope) -> Result<Verdict, RunError>,
}

/// What of a case is asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scope<'a> {
    /// All resolutions.
    pub full: bool,
    /// Only the parts whose name holds these words, e.g. `Re 1000 200`; where a case has such parts.
    pub only: Option<&'a str>,
    /// Whether any part had such a name.
    pub met: Option<&'a Cell<bool>>,
}

impl Scope<'_> {
    /// Whether a part runs; `quick` ones run without being asked for.
    #[must_use]
    pub fn takes(&self, part: &str, quick: bool) -> bool {
        // Whole words: 20 is not meant to be 320.
        let apart = |c: Option<char>| !c.is_some_and(char::is_alphanumeric);
        let holds = |text: &str| {
            part.match_indices(text).any(|(at, _)| {
                apart(part[..at].chars().next_back()) && apart(part[at + text.len()..].chars().next())
            })
        };
        let Some(only) = self.only else { return self.full || quick };
        let taken = holds(only);
        if let Some(met) = self.met.filter(|_| taken) {
            met.set(true);
        }
        taken
    }
}

/// All cases, in the order they run.
pub const CASES: &[Case] = &[
    Case {
        name: "birth_death",
        what: "birth and death in one volume: mean and variance of a Poisson number",
        run: compartments::birth_death,
    },
    Case {
        name: "two_compartments",
        what: "diffusion between two volumes: binomial at every time, 80 to 20 in the end",
        run: compartments::two_compartments,
    },
    Case {
        name: "table_2_1",
        what: "diffusion on a line, table 2.1 of the dissertation: the printed operator, ours, whole molecules",
        run: table_2_1::line,
    },
    Case {
        name: "table_2_2",
        what: "diffusion into a plate, table 2.2 (--full: whole molecules on 33 x 33 and 65 x 65 too)",
        run: table_2_2::plate,
    },
    Case {
        name: "table_2_3",
        what: "A + B -> 0 on a line, table 2.3 (--full: whole molecules on 65 particles too)",
        run: table_2_3::line,
    },
    Case {
        name: "annihilation_front",
        what: "A + B -> 0 on lines of 17 to 65 particles against finite differences, over the transient",
        run: annihilation::front,
    },
    Case {
        name: "pheromone_slip",
        what: "yeast cell in a channel with slip walls against finite elements (spacing 0.04 H; --full: 0.02 H)",
        run: pheromone::slip,
    },
    Case { name: "pheromone_no_slip", what: "the same with no-slip walls", run: pheromone::no_slip },
    Case {
        name: "poiseuille",
        what: "channel from rest to the parabola, 20 to 80 across (--full: to 320, and the other kernels)",
        run: poiseuille::channel,
    },
    Case {
        name: "taylor_green",
        what: "decaying vortices, Re 100, from a lattice of 50 x 50 (--full: 100 x 100, 200 x 200)",
        run: taylor_green::vortices,
    },
    Case {
        name: "cavity",
        what: "lid-driven cavity, Re 100, 50 x 50 (--full: 100 x 100; Re 1000; Re 10000 with 200 x 200)",
        run: cavity::lid,
    },
    Case {
        name: "natural_convection",
        what: "hot cylinder in a cold square, Ra 1e4, to 100 x 100 (--full: to Ra 1e6 and 200 x 200)",
        run: natural_convection::cylinder,
    },
    Case {
        name: "duct_3d",
        what: "square duct in space, 20 x 20 across (--full: 12 x 12 and 30 x 30 too)",
        run: duct::square_duct,
    },
    Case {
        name: "couette_start",
        what: "start of plane Couette flow, over the transient",
        run: moving_walls::couette_start,
    },
    Case {
        name: "stokes_second",
        what: "oscillating plate (Stokes' second problem) in a channel",
        run: moving_walls::stokes_second,
    },
    Case {
        name: "spinning_cylinder",
        what: "spin-up of the fluid inside a cylinder that starts to turn",
        run: cylinder::spin_up,
    },
    Case {
        name: "cantilever",
        what: "clamped plate that swings, 10 and 20 across (--full: 30, ten large swings, the form of Jaumann)",
        run: cantilever::plate,
    },
    Case {
        name: "beam_modes",
        what: "a slender, a free and a doubly clamped beam, a second mode, one in space (--full: finer)",
        run: beam_modes::beams,
    },
    Case {
        name: "lame",
        what: "rings and spherical shells under pressure from inside (--full: finer shells)",
        run: lame::walls,
    },
    Case {
        name: "fsi_rod",
        what: "a soft rod bends in the stream of a micro-channel, against finite elements (--full: finer)",
        run: fsi_rod::rod,
    },
    Case {
        name: "thermostat",
        what: "thermal noise in two and three dimensions, both forms of friction: temperature, shape, momentum",
        run: thermostat::noise,
    },
];

/// A shipped model: its file, and the reactions file it names, if any.
struct Shipped {
    model: &'static str,
    reactions: Option<(&'static str, &'static str)>,
}

/// A plan that could not be made: shipped models have no faults, so this is ours.
fn failed(reason: String) -> RunError {
    RunError::File { path: "validation model".into(), reason }
}

/// Makes a plan of a shipped model with values changed as by `--set`, and hands it on with a folder that is
/// removed afterwards.
fn planned<T>(
    shipped: &Shipped,
    overrides: &[String],
    then: impl FnOnce(&Plan, &Path) -> Result<T, RunError>,
) -> Result<T, RunError> {
    let folder = tempfile::tempdir().map_err(|error| failed(error.to_string()))?;
    let write = |path: &str, text: &str| -> Result<PathBuf, RunError> {
        let path = folder.path().join(path);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|error| failed(error.to_string()))?;
        }
        std::fs::write(&path, text).map_err(|error| failed(error.to_string()))?;
        Ok(path)
    };
    if let Some((name, text)) = shipped.reactions {
        write(&format!("reactions/{name}"), text)?;
    }
    let path = write("models/model.yaml", shipped.model)?;
    let model = load::model(&path, overrides).map_err(|error| failed(error.to_string()))?;
    let realizations = model.run.realizations;
    let plan = Plan::new(model, realizations).map_err(|error| failed(error.to_string()))?;
    then(&plan, folder.path())
}

/// The same, ready to run.
fn with_plan<T>(
    shipped: &Shipped,
    overrides: &[String],
    then: impl FnOnce(&Plan, Ready, &Path) -> Result<T, RunError>,
) -> Result<T, RunError> {
    planned(shipped, overrides, |plan, folder| {
        let ready = Ready::new(plan).map_err(|error| match error {
            NotReady::Model(error) => failed(error.to_string()),
            NotReady::Run(error) => error,
        })?;
        then(plan, ready, folder)
    })
}

/// Runs a shipped model with values changed as by `--set`, without writing anything but a folder that is removed.
fn run(shipped: &Shipped, overrides: &[String]) -> Result<Results, RunError> {
    with_plan(shipped, overrides, |plan, ready, _| ensemble::in_memory(plan, ready))
}

/// Runs a shipped model likewise and returns what its particle tables would hold, realization by realization.
fn frames(shipped: &Shipped, overrides: &[String]) -> Result<Vec<ParticleFrame>, RunError> {
    with_plan(shipped, overrides, |plan, ready, _| {
        let numbers: Vec<u32> = (0..plan.model.run.realizations).collect();
        let outcome = ready.run(&numbers, &Watch::silent());
        match outcome.error {
            Some(error) => Err(error),
            None => Ok(outcome.observed.into_iter().flat_map(|one| one.frames).collect()),
        }
    })
}

/// Runs a case and notes how long it took.
fn timed<F: Into<Findings>>(
    case: &str,
    find: impl FnOnce() -> Result<F, RunError>,
) -> Result<Verdict, RunError> {
    let begun = std::time::Instant::now();
    let Findings { rows, curves, figures } = find()?.into();
    Ok(Verdict { case: case.into(), rows, curves, figures, seconds: begun.elapsed().as_secs_f64() })
}
