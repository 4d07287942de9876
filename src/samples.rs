//! What a run has shown, as plain arrays: what the tables are written from and read back to.

use serde::{Deserialize, Serialize};

/// What the columns of a [`SeriesBlock`] are: column c is species `species[c]` in group `groups[c]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    pub groups: Vec<String>,
    pub species: Vec<String>,
}

impl Columns {
    /// Number of columns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.groups.len().min(self.species.len())
    }

    /// Whether there is no column.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The column of a species in a group.
    #[must_use]
    pub fn find(&self, group: &str, species: &str) -> Option<usize> {
        (0..self.len()).find(|&c| self.groups[c] == group && self.species[c] == species)
    }
}

/// One realization, row-major times x columns.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SeriesBlock {
    pub realization: u32,
    /// Molecules.
    pub amount: Vec<f64>,
    /// mol/m³.
    pub concentration: Vec<f64>,
}

/// One quantity along one probe in one realization at one time; the arrays are parallel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeRows {
    pub probe: String,
    pub realization: u32,
    /// s.
    pub time: f64,
    pub quantity: String,
    /// Distance along the line in m, or angle in rad.
    pub s: Vec<f64>,
    /// m.
    pub position: Vec<[f64; 3]>,
    /// In the unit the record of the probe names.
    pub value: Vec<f64>,
}

/// All particles of one realization at one time; the arrays are parallel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParticleFrame {
    /// s.
    pub time: f64,
    /// Names of the groups.
    pub groups: Vec<String>,
    /// Each particle's group, index into `groups`.
    pub group: Vec<u16>,
    /// m; unused directions zero.
    pub position: Vec<[f64; 3]>,
    /// m/s.
    pub velocity: Vec<[f64; 3]>,
    /// kg/m³.
    pub density: Vec<f64>,
    /// Pa.
    pub pressure: Vec<f64>,
    /// Share of a solid in the particle's surroundings, 0 to 1.
    pub volume_fraction: Vec<f64>,
    /// m³; amount / (N_A volume) is the concentration.
    pub volume: Vec<f64>,
    /// Where there are elastic solids: von Mises stress of each particle, Pa, and its largest stretch; empty where there
    /// are none.
    pub stress: Vec<f64>,
    pub stretch: Vec<f64>,
    /// Molecules, species by species.
    pub amounts: Vec<Vec<f64>>,
}

impl ParticleFrame {
    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no particle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Name of a particle's group.
    #[must_use]
    pub fn group_name(&self, particle: usize) -> &str {
        let index = self.group.get(particle).copied().unwrap_or(u16::MAX);
        self.groups.get(usize::from(index)).map_or("", String::as_str)
    }
}
