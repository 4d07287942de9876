//! What a run says of itself besides its tables: the content of `run.json`.
//!
//! `report` reads this file and the tables, nothing else, so that figures can be drawn again at any time.

mod solids;
mod sweep;

pub use solids::SolidRecord;
pub use sweep::{PointRecord, SWEEP_COLUMNS, SweepRecord, SweptRecord};

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Columns of a particle table before those of the species.
pub const PARTICLE_COLUMNS: [&str; 13] = [
    "time",
    "particle",
    "group",
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
    "density",
    "pressure",
    "volume_fraction",
    "volume",
];

/// Columns that follow where there are elastic solids.
pub const SOLID_COLUMNS: [&str; 2] = ["stress", "stretch"];

/// The whole of `run.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    pub program: String,
    pub version: String,
    /// Of what is kept while it runs: a run can be taken up by a program that has the same.
    #[serde(default)]
    pub format: u32,
    /// `running`, `interrupted`, `failed` or `finished`.
    pub status: String,
    /// What stopped a failed run.
    pub error: Option<String>,
    pub name: String,
    /// Free text of the model's author.
    pub description: String,
    pub model: ModelText,
    pub seed: u64,
    /// First realization and one past the last of the block asked for.
    pub realizations: [u32; 2],
    /// Realizations whose tables are complete.
    pub finished: u32,
    /// Output times, s.
    pub times: Vec<f64>,
    pub domain: DomainRecord,
    pub species: Vec<SpeciesRecord>,
    pub reactions: Vec<ReactionRecord>,
    /// Conserved sums in words, e.g. `R + RL`.
    pub conservation_laws: Vec<String>,
    /// Conditions in words (sponges, held values, barriers, …).
    pub conditions: Vec<String>,
    pub probes: Vec<ProbeRecord>,
    /// Distributions asked for.
    pub histograms: Vec<HistogramRecord>,
    /// What flows, if anything does.
    #[serde(default)]
    pub fluid: Option<FluidRecord>,
    /// Elastic solids.
    #[serde(default)]
    pub solids: Vec<SolidRecord>,
    pub steps: StepsRecord,
    /// If the run went on until a number was known well enough.
    #[serde(default)]
    pub precision: Option<PrecisionRecord>,
    /// Where hybrid species were carried how.
    #[serde(default)]
    pub hybrid: Vec<HybridRecord>,
    pub health: Health,
    pub performance: Performance,
}

/// The files a user wrote, word for word, and the hash that names them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelText {
    /// SHA-256 over all files and `--set` values, hex.
    pub hash: String,
    /// Path as typed and text.
    pub files: Vec<(String, String)>,
    /// `path=value` given on the command line.
    pub overrides: Vec<String>,
}

/// Geometry of the domain, for drawings to scale. Lengths in m.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DomainRecord {
    /// `well_mixed`, `graph` or `particles`.
    pub kind: String,
    /// 0 for well-mixed and graph.
    pub dimensions: usize,
    pub min: Vec<f64>,
    pub max: Vec<f64>,
    pub thickness: f64,
    /// `periodic`, `no_slip` or `free_slip` per axis.
    pub boundaries: Vec<String>,
    pub groups: Vec<GroupRecord>,
}

/// A group of voxels: name, what it is made of, size at the start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroupRecord {
    pub name: String,
    /// `fluid`, `wall`, `static`, `zone` or `volume`.
    pub material: String,
    pub particles: usize,
    /// m³.
    pub volume: f64,
    /// Outline of the shape in words, e.g. `ring, centre (22, 10) µm, 1.5-2.5 µm`.
    pub shape: String,
    /// Closed outlines in 2D, m, for drawings; empty where there is nothing to draw.
    pub outlines: Vec<Vec<[f64; 2]>>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpeciesRecord {
    pub name: String,
    /// m²/s.
    pub diffusion: f64,
    /// `discrete` or `continuous`.
    pub representation: String,
    /// Groups it lives in; empty if everywhere.
    pub only_in: Vec<String>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReactionRecord {
    pub name: String,
    pub equation: String,
    /// The propensity with its numbers, in words.
    pub propensity: String,
}

/// A probe and the figures it asks for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeRecord {
    pub name: String,
    /// `line` (s in m), `ring` (s = angle in rad) or `surface` (s = 0).
    pub kind: String,
    /// Quantities it records and their units, e.g. `L` -> `mol/m^3`, `vx` -> `m/s`, `occupancy` -> `1`.
    pub quantities: BTreeMap<String, String>,
}

/// A distribution across realizations that the user asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HistogramRecord {
    pub group: String,
    pub species: String,
    /// Times asked for, s; each one of the output times.
    pub times: Vec<f64>,
}

/// Steps and what limited them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepsRecord {
    pub fluid: Option<StepRecord>,
    /// Of elastic solids; as at the start.
    #[serde(default)]
    pub solid: Option<StepRecord>,
    pub chemistry: Option<StepRecord>,
    /// Name of the sampling method, e.g. `exact split sampling (Strang)`.
    pub method: String,
    /// Anything approximate the method does, in words; empty if exact.
    pub approximations: Vec<String>,
    /// One flow served every realization.
    pub shared_flow: bool,
    /// Estimate of the relative error of splitting, where something is split; in mean field.
    #[serde(default)]
    pub splitting_error: Option<f64>,
}

/// A number as JSON has it, which knows no NaN and writes null.
fn number<'de, D: serde::Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
}

/// How well a mean is known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PrecisionRecord {
    /// E.g. `RL in membrane at 0.8 s`.
    pub quantity: String,
    /// Molecules.
    #[serde(deserialize_with = "number")]
    pub mean: f64,
    /// Half the width of the confidence interval of the mean, molecules.
    #[serde(deserialize_with = "number")]
    pub half_width: f64,
    pub confidence: f64,
    /// Half width over mean that was asked for.
    pub asked: f64,
    pub reached: bool,
    /// Realizations at each look at the interval.
    pub looks: Vec<u32>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// s.
    pub step: f64,
    pub count: u64,
    pub limited_by: String,
}

/// A fluid and the numbers that go with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FluidRecord {
    /// By name: `sph_bvf`, `sdpd` or `sph`.
    pub method: String,
    /// kg/m³.
    pub density: f64,
    /// Pa s.
    pub viscosity: f64,
    /// c0, m/s.
    pub sound_speed: f64,
    /// Largest speed to be expected, m/s.
    pub speed: f64,
    /// What is so fast, in words.
    pub speed_of: String,
    /// Width of the flow, m.
    pub length: f64,
    /// What is so wide, in words.
    pub length_of: String,
    /// `speed / sound_speed`.
    #[serde(deserialize_with = "number")]
    pub mach: f64,
    /// `density * speed * length / viscosity`.
    #[serde(deserialize_with = "number")]
    pub reynolds: f64,
    pub noise: Option<NoiseRecord>,
}

/// Thermal noise as asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NoiseRecord {
    /// K.
    pub temperature: f64,
    /// kT, J.
    pub energy: f64,
    /// √(kT/m) of a particle: deviation of one component of its velocity, m/s.
    pub thermal_speed: f64,
    /// Form of friction and noise: `morris` or `espanol_revenga`.
    pub friction: String,
}

/// A temperature as measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TemperatureRecord {
    /// K, mean over the output times of the second half of the run, and over realizations.
    pub mean: f64,
    /// Number of times, all realizations together.
    pub looks: u64,
}

impl TemperatureRecord {
    /// Takes in one more measurement, K.
    pub fn look(&mut self, temperature: f64) {
        self.looks += 1;
        self.mean += (temperature - self.mean) / self.looks as f64;
    }

    /// Takes in what was measured elsewhere.
    pub fn join(own: &mut Option<TemperatureRecord>, other: Option<TemperatureRecord>) {
        *own = match (*own, other) {
            (Some(a), Some(b)) => {
                let looks = a.looks + b.looks;
                let sum = a.mean * a.looks as f64 + b.mean * b.looks as f64;
                Some(TemperatureRecord { mean: sum / looks.max(1) as f64, looks })
            }
            (a, b) => a.or(b),
        };
    }
}

/// A hybrid species in a group.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HybridRecord {
    pub species: String,
    pub group: String,
    /// Share of voxels and chemistry steps in which it was continuous, mean over realizations.
    pub continuous: f64,
    /// Changes from whole molecules to real amounts and back, voxels and realizations together.
    pub to_continuous: u64,
    pub to_discrete: u64,
    /// Realizations of which this tells.
    #[serde(default)]
    pub realizations: u32,
}

impl HybridRecord {
    /// Takes in what other realizations of the same species and group have to tell.
    pub fn absorb(&mut self, other: &HybridRecord) {
        let (own, more) = (f64::from(self.realizations), f64::from(other.realizations));
        self.continuous = (self.continuous * own + other.continuous * more) / (own + more).max(1.0);
        self.to_continuous += other.to_continuous;
        self.to_discrete += other.to_discrete;
        self.realizations += other.realizations;
    }
}

/// Checks of a run; all sums over its realizations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Health {
    /// Molecules that appeared or vanished outside reactions and booked reservoirs; 0 unless something is wrong.
    pub molecules_created_or_lost: f64,
    /// Net molecules brought in by sponges, sources and held values, per species.
    pub molecules_supplied: BTreeMap<String, f64>,
    /// Largest deviation of each conserved sum within a realization.
    pub conservation: Vec<ConservationRecord>,
    /// Relative drift of total momentum where it should be conserved.
    pub momentum_drift: Option<f64>,
    /// Particles found inside a wall at the end of any step.
    pub penetrations: Option<u64>,
    /// Positions corrected at walls (bounce-back), for information.
    pub bounces: Option<u64>,
    pub largest_mach: Option<f64>,
    /// Largest |density / rest density - 1| of a fluid particle.
    pub largest_density_change: Option<f64>,
    /// With thermal noise.
    #[serde(default)]
    pub temperature: Option<TemperatureRecord>,
    /// Largest stretch of an elastic solid.
    #[serde(default)]
    pub largest_stretch: Option<f64>,
    pub warnings: Vec<String>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ConservationRecord {
    /// E.g. `R + RL`.
    pub sum: String,
    /// Value at the start in realization 0 (molecules).
    pub start: f64,
    /// Largest |value - start| over times and realizations.
    pub largest_deviation: f64,
    /// Why it need not hold, e.g. a reservoir of L; empty if it must.
    pub exempt: String,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Performance {
    pub particle_steps: u64,
    pub pair_evaluations: u64,
    /// Elastic particles times their own steps, and bonds seen from both sides.
    #[serde(default)]
    pub solid_particle_steps: u64,
    #[serde(default)]
    pub bond_evaluations: u64,
    pub fluid_seconds: f64,
    pub reaction_events: u64,
    pub hops: u64,
    pub chemistry_seconds: f64,
    pub wall_seconds: f64,
    pub cpu_seconds: f64,
    pub peak_rss_bytes: u64,
    pub threads: usize,
}

impl RunRecord {
    /// Takes in the record of the block of realizations that follows this one.
    pub fn absorb(&mut self, next: &RunRecord) {
        for (own, other) in self.hybrid.iter_mut().zip(&next.hybrid) {
            own.absorb(other);
        }
        self.realizations[1] = next.realizations[1];
        self.finished += next.finished;
        self.health.absorb(&next.health, self.steps.shared_flow);
        let (own, other) = (&mut self.performance, &next.performance);
        own.particle_steps += other.particle_steps;
        own.pair_evaluations += other.pair_evaluations;
        own.solid_particle_steps += other.solid_particle_steps;
        own.bond_evaluations += other.bond_evaluations;
        own.fluid_seconds += other.fluid_seconds;
        own.reaction_events += other.reaction_events;
        own.hops += other.hops;
        own.chemistry_seconds += other.chemistry_seconds;
        own.wall_seconds += other.wall_seconds;
        own.cpu_seconds += other.cpu_seconds;
        own.peak_rss_bytes = own.peak_rss_bytes.max(other.peak_rss_bytes);
        own.threads = own.threads.max(other.threads);
    }
}

impl Health {
    fn absorb(&mut self, next: &Health, shared_flow: bool) {
        self.molecules_created_or_lost += next.molecules_created_or_lost;
        for (species, supplied) in &next.molecules_supplied {
            *self.molecules_supplied.entry(species.clone()).or_default() += supplied;
        }
        for (own, other) in self.conservation.iter_mut().zip(&next.conservation) {
            own.largest_deviation = own.largest_deviation.max(other.largest_deviation);
        }
        self.absorb_flow(next, shared_flow);
        for warning in &next.warnings {
            if !self.warnings.contains(warning) {
                self.warnings.push(warning.clone());
            }
        }
    }

    /// Takes in what the flow of other realizations says: the same flow again if it is shared, more flows else.
    pub fn absorb_flow(&mut self, next: &Health, shared: bool) {
        fn larger(own: &mut Option<f64>, other: Option<f64>) {
            *own = match (*own, other) {
                (Some(a), Some(b)) => Some(a.max(b)),
                (a, b) => a.or(b),
            };
        }
        larger(&mut self.momentum_drift, next.momentum_drift);
        larger(&mut self.largest_mach, next.largest_mach);
        larger(&mut self.largest_density_change, next.largest_density_change);
        larger(&mut self.largest_stretch, next.largest_stretch);
        // A flow with noise is never shared.
        TemperatureRecord::join(&mut self.temperature, next.temperature);
        for (own, other) in [(&mut self.penetrations, next.penetrations), (&mut self.bounces, next.bounces)] {
            // Every block runs a shared flow as a whole: what it counts is the same, not a sum.
            *own = match (*own, other) {
                (Some(a), Some(b)) if !shared => Some(a + b),
                (a, b) => a.max(b),
            };
        }
    }
}
