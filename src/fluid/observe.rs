//! What can be seen of a flow: a snapshot of the particles, and whether the numbers are sound.

use crate::fluid::flow::Flow;
use crate::fluid::motion::Motion;
use crate::fluid::setup::BodyKind;
use crate::vector::Vector;

/// The particles at one time, in the order of [`Setup::particles`](crate::fluid::Setup).
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Snapshot<const D: usize> {
    /// m, inside the box on periodic axes.
    pub position: Vec<Vector<D>>,
    /// Momentum velocity, m/s; of a solid its own.
    pub velocity: Vec<Vector<D>>,
    /// kg/m³.
    pub density: Vec<f64>,
    /// Pa; of a solid that of the fluid before it.
    pub pressure: Vec<f64>,
    /// m^D.
    pub volume: Vec<f64>,
    /// Volume fraction of solid: 0 in the open, about ½ at a surface, 1 for solids.
    pub volume_fraction: Vec<f64>,
}

/// Whether the numbers are sound, over all steps so far.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowHealth<const D: usize> {
    /// Fluid particles inside a solid at the end of a step; must be 0.
    pub penetrations: u64,
    /// Positions corrected at walls.
    pub bounces: u64,
    /// Largest |v|/c0.
    pub largest_mach: f64,
    /// Largest |rho/rho0 - 1|.
    pub largest_density_change: f64,
    /// Momentum of the fluid now, per unit thickness: kg m/s times m^(D-3).
    pub momentum: Vector<D>,
    /// Anything a user should know, one line each.
    pub warnings: Vec<String>,
}

/// Mach number and relative change of density up to which a flow passes as incompressible. The density changes with
/// Mach², by 1 % at the usual design value 0.1 (Monaghan 1994, J. Comput. Phys. 110, 399), by 4 % at twice that.
pub const LARGEST_MACH: f64 = 0.2;
pub const LARGEST_DENSITY_CHANGE: f64 = 0.05;

impl<const D: usize> Flow<D> {
    /// The particles now.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<D> {
        let n = self.sides.len();
        let mut snapshot = Snapshot {
            position: vec![Vector::zeros(); n],
            velocity: vec![Vector::zeros(); n],
            density: vec![0.0; n],
            pressure: vec![0.0; n],
            volume: vec![0.0; n],
            volume_fraction: vec![0.0; n],
        };
        for ((place, side), own) in self.positions.iter().zip(&self.sides).zip(&self.own) {
            let i = side.id as usize;
            snapshot.position[i] = self.domain.wrap(place);
            snapshot.velocity[i] = match &self.bodies[side.body as usize].kind {
                BodyKind::Fluid { .. } => side.velocity,
                BodyKind::Solid { motion: Motion::Elastic(coupled), .. } => {
                    coupled.velocity(self.rows[i] as usize)
                }
                BodyKind::Solid { motion, .. } => motion.velocity(place, self.time()),
            };
            snapshot.density[i] = side.density;
            snapshot.pressure[i] = side.pressure;
            snapshot.volume[i] = side.volume;
            snapshot.volume_fraction[i] = own.fraction;
        }
        snapshot
    }

    /// Penetrations, largest Mach number and the like over all steps so far.
    #[must_use]
    pub fn health(&self) -> FlowHealth<D> {
        let momentum = self
            .sides
            .iter()
            .zip(&self.own)
            .filter(|(side, _)| !side.is_solid())
            .fold(Vector::zeros(), |sum: Vector<D>, (side, own)| sum + side.velocity * own.mass);
        let mach = self.tally.largest_speed / self.sound_speed;
        let change = self.tally.largest_density_change;
        let mut warnings = Vec::new();
        if self.tally.penetrations > 0 {
            warnings.push(format!(
                "{} times a fluid particle ended a step inside a solid",
                self.tally.penetrations
            ));
        }
        // Ten times the largest speed, and what makes the density change by 1 %, which falls with c0².
        let c = self.sound_speed;
        let enough = (10.0 * self.tally.largest_speed).max(c * (change / 0.01).sqrt());
        if mach > LARGEST_MACH {
            warnings.push(format!(
                "largest Mach number {mach:.2} ({:.3e} m/s at a sound speed of {c:.3e} m/s), above 0.2: set fluid.sound_speed: {enough:.2e} m/s",
                self.tally.largest_speed
            ));
        }
        if change > LARGEST_DENSITY_CHANGE {
            warnings.push(format!(
                "density changed by {:.1} % at a sound speed of {c:.3e} m/s, above 5 %: set fluid.sound_speed: {enough:.2e} m/s",
                100.0 * change
            ));
        }
        FlowHealth {
            penetrations: self.tally.penetrations,
            bounces: self.tally.bounces,
            largest_mach: mach,
            largest_density_change: change,
            momentum,
            warnings,
        }
    }

    /// Particles times steps so far.
    #[must_use]
    pub fn particle_steps(&self) -> u64 {
        self.tally.particle_steps
    }

    /// Pairs within the cut-off so far, each counted from both sides once a step (pairs of two solid particles
    /// are not looked at and not counted).
    #[must_use]
    pub fn pair_evaluations(&self) -> u64 {
        self.tally.pair_evaluations
    }

    /// How often the neighbour lists were built.
    #[must_use]
    pub fn rebuilds(&self) -> u64 {
        self.tally.rebuilds
    }
}
