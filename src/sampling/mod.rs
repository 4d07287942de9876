//! What is observed when: amounts by group, probes, particles. A [`Lens`] is made once for a geometry and
//! looks at any number of realizations.

pub mod probe;
pub mod solids;
mod vessels;

use crate::chemistry::AVOGADRO;
use crate::plan::Plan;
use crate::samples::{Columns, ParticleFrame, ProbeRows, SeriesBlock};
use crate::scene::Scene;
use probe::ProbeLens;
use serde::{Deserialize, Serialize};

/// What one realization has shown so far.
///
/// What was handed over already is counted and gone: `series`, `probes` and `frames` hold the rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observed {
    pub series: SeriesBlock,
    pub probes: Vec<ProbeRows>,
    pub frames: Vec<ParticleFrame>,
    /// Number of the output time at which `series` begins, and output times in it.
    pub first: u32,
    pub outputs: u32,
    /// Probes up to the end of each output time in `series`; empty where there are none.
    pub marks: Vec<u32>,
    /// Parts of the particle table handed over, and frames in them.
    pub parts: (u32, u32),
}

impl Observed {
    /// Nothing yet.
    #[must_use]
    pub fn new(realization: u32) -> Observed {
        Observed { series: SeriesBlock { realization, ..SeriesBlock::default() }, ..Observed::default() }
    }

    /// Numbers held, without those of the frames.
    #[must_use]
    pub fn bulk(&self) -> usize {
        let probes: usize = self.probes.iter().map(|rows| 5 * rows.s.len()).sum();
        2 * self.series.amount.len() + probes
    }
}

/// Names of the columns of the series.
#[must_use]
pub fn columns(plan: &Plan) -> Columns {
    Columns {
        groups: plan.columns.iter().map(|column| plan.group_name(column)).collect(),
        species: plan.columns.iter().map(|column| plan.reactor.species[column.species].clone()).collect(),
    }
}

/// How voxels are summed into the columns of the series.
pub struct Sums<'p> {
    plan: &'p Plan,
    /// Slot of each voxel: the number of its group.
    slot: Vec<u32>,
    /// Volume of each slot, m³.
    volume: Vec<f64>,
}

impl<'p> Sums<'p> {
    /// `slot[i]` is the group voxel i counts to, `groups` the number of groups; voxels with a higher slot
    /// (walls round the box) count to none.
    #[must_use]
    pub fn new(plan: &'p Plan, slot: Vec<u32>, volumes: &[f64], groups: usize) -> Sums<'p> {
        let mut volume = vec![0.0; groups];
        for (&slot, v) in slot.iter().zip(volumes) {
            if let Some(sum) = volume.get_mut(slot as usize) {
                *sum += v;
            }
        }
        Sums { plan, slot, volume }
    }

    /// Appends one output time to what a realization has shown.
    pub fn look(&self, amounts: &[f64], seen: &mut Observed) {
        seen.outputs += 1;
        let block = &mut seen.series;
        let species = self.plan.reactor.species.len();
        let mut sums = vec![0.0; self.volume.len() * species];
        for (voxel, &slot) in amounts.chunks_exact(species).zip(&self.slot) {
            let Some(sum) = sums.get_mut(slot as usize * species..(slot as usize + 1) * species) else {
                continue;
            };
            for (sum, amount) in sum.iter_mut().zip(voxel) {
                *sum += amount;
            }
        }
        let all: f64 = self.volume.iter().sum();
        for column in &self.plan.columns {
            let (amount, volume) = match column.group {
                Some(g) => (sums[g * species + column.species], self.volume[g]),
                None => ((0..self.volume.len()).map(|g| sums[g * species + column.species]).sum(), all),
            };
            block.amount.push(amount);
            // A zone may be empty for a moment.
            block.concentration.push(if volume > 0.0 { amount / (AVOGADRO * volume) } else { 0.0 });
        }
    }
}

/// A particle geometry at an output time, ready to look at realizations.
pub struct Lens<'p, const D: usize> {
    plan: &'p Plan,
    sums: Sums<'p>,
    probes: Vec<ProbeLens<'p, D>>,
    /// What the solids show.
    solids: Vec<solids::Row>,
    outlines: Vec<vessels::OutlineLens>,
    /// Places, velocities and the like of all particles but the walls round the box; amounts to be added.
    frame: Option<(ParticleFrame, Vec<u32>)>,
}

impl<'p, const D: usize> Lens<'p, D> {
    /// Works out sums, probe weights and the particle frame of a scene.
    #[must_use]
    pub fn new(plan: &'p Plan, scene: &Scene<D>) -> Lens<'p, D> {
        let groups = plan.model.domain.group_names();
        let slot: Vec<u32> = scene.current.iter().map(|&g| u32::from(g)).collect();
        let wanted = plan.model.output.particles.as_ref();
        let frame = wanted.map(|_| frame(scene, &groups));
        Lens {
            plan,
            sums: Sums::new(plan, slot, &scene.volumes, groups.len()),
            probes: plan.model.output.probes.iter().map(|probe| ProbeLens::new(plan, probe, scene)).collect(),
            solids: solids::rows(plan, scene),
            outlines: vessels::outlines(scene),
            frame,
        }
    }

    /// Appends an instant to what a realization has shown. `shared` tells that all realizations see one flow,
    /// whose velocities only the first one (number 0) records.
    pub fn look(&self, amounts: &[f64], time: f64, shared: bool, observed: &mut Observed) {
        self.sums.look(amounts, observed);
        let realization = observed.series.realization;
        for probe in &self.probes {
            probe.look(amounts, time, realization, realization == 0 || !shared, &mut observed.probes);
        }
        if realization == 0 || !shared {
            observed.probes.extend(self.solids.iter().map(|row| row.rows(realization, time)));
        }
        for outline in &self.outlines {
            observed.probes.extend(outline.look(self.plan, amounts, (realization, time)));
        }
        if !(self.probes.is_empty() && self.solids.is_empty()) {
            observed.marks.push(observed.probes.len() as u32);
        }
        let Some((frame, rows)) = &self.frame else { return };
        let wanted = self.plan.model.output.particles.as_ref();
        if wanted.is_some_and(|(times, count)| realization < *count && times.contains(&time)) {
            let species = self.plan.reactor.species.len();
            let mut frame = ParticleFrame { time, ..frame.clone() };
            frame.amounts = (0..species)
                .map(|s| rows.iter().map(|&i| amounts[i as usize * species + s]).collect())
                .collect();
            observed.frames.push(frame);
        }
    }
}

/// All particles of a scene that belong to a group, and their numbers.
fn frame<const D: usize>(scene: &Scene<D>, groups: &[String]) -> (ParticleFrame, Vec<u32>) {
    let rows: Vec<u32> = (0..scene.positions.len() as u32)
        .filter(|&i| usize::from(scene.current[i as usize]) < groups.len())
        .collect();
    // What there is not of any particle is empty.
    let of = |values: &[f64]| -> Vec<f64> {
        rows.iter().filter_map(|&i| values.get(i as usize).copied()).collect()
    };
    let (stress, stretch) = solids::strains(scene);
    let three = |v: &crate::vector::Vector<D>| -> [f64; 3] {
        std::array::from_fn(|k| if k < D { v[k] } else { 0.0 })
    };
    let frame = ParticleFrame {
        time: 0.0,
        groups: groups.to_vec(),
        group: rows.iter().map(|&i| u16::from(scene.current[i as usize])).collect(),
        position: rows.iter().map(|&i| three(&scene.snapshot.position[i as usize])).collect(),
        velocity: rows.iter().map(|&i| three(&scene.snapshot.velocity[i as usize])).collect(),
        density: of(&scene.snapshot.density),
        pressure: of(&scene.snapshot.pressure),
        volume_fraction: of(&scene.snapshot.volume_fraction),
        volume: of(&scene.volumes),
        stress: of(&stress),
        stretch: of(&stretch),
        amounts: Vec::new(),
    };
    (frame, rows)
}
