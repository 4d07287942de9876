//! Particles as they are at an instant: what the chemistry and the observers see of geometry and flow.

use crate::chemistry::Links;
use crate::chemistry::reactor::Reactor;
use crate::error::RunError;
use crate::fluid::{Flow, Snapshot, Voxels, exchange};
use crate::geometry::shape::embed;
use crate::plan::ParticlePlan;
use crate::plan::start::Voxels as Places;
use crate::vector::Vector;

/// The geometry of a particle plan at an instant, and the flow that moves it, if there is one.
pub struct Scene<'p, const D: usize> {
    pub plan: &'p ParticlePlan<D>,
    pub flow: Option<Flow<D>>,
    pub snapshot: Snapshot<D>,
    /// Places with three coordinates, m.
    pub positions: Vec<Vector<3>>,
    /// m³.
    pub volumes: Vec<f64>,
    /// Zone a particle is in, or its home group.
    pub current: Vec<u8>,
    /// Whether any diffusing species may be in a particle.
    hosts: Vec<bool>,
}

impl<'p, const D: usize> Scene<'p, D> {
    /// The particles at the start, the flow built but not yet run.
    pub fn new(plan: &'p ParticlePlan<D>, reactor: &Reactor) -> Result<Scene<'p, D>, RunError> {
        let flow = plan.flow.clone().map(Flow::new).transpose()?;
        let hosts = plan
            .home
            .iter()
            .map(|&home| {
                (0..reactor.species.len())
                    .any(|s| reactor.diffusivity[s] > 0.0 && reactor.habitat[s].holds(home))
            })
            .collect();
        let count = plan.particles.len();
        let mut scene = Scene {
            plan,
            flow,
            snapshot: Snapshot {
                position: plan.particles.iter().map(|p| p.position).collect(),
                velocity: vec![Vector::zeros(); count],
                density: vec![0.0; count],
                pressure: vec![0.0; count],
                volume: plan.particles.iter().map(|p| p.volume).collect(),
                volume_fraction: vec![0.0; count],
            },
            positions: Vec::new(),
            volumes: Vec::new(),
            current: Vec::new(),
            hosts,
        };
        scene.look();
        Ok(scene)
    }

    /// Reads places and volumes off the flow.
    pub fn look(&mut self) {
        if let Some(flow) = &self.flow {
            self.snapshot = flow.snapshot();
        }
        self.positions = self.snapshot.position.iter().map(embed).collect();
        self.volumes = self.snapshot.volume.iter().map(|v| v * self.plan.thickness).collect();
        self.current = self
            .positions
            .iter()
            .zip(&self.plan.home)
            .map(|(x, &home)| {
                // Walls do not pass through zones; what flows, or rests in one, is counted to it.
                let zone = self.plan.zones.iter().find(|(_, shape)| shape.holds(x));
                match zone {
                    Some(&(zone, _)) if !self.plan.is_wall(home) => zone,
                    _ => home,
                }
            })
            .collect();
    }

    /// Moves the flow by `steps` steps of `dt` seconds and looks again.
    pub fn advance(&mut self, dt: f64, steps: u64) -> Result<(), RunError> {
        if let Some(flow) = &mut self.flow {
            flow.advance(dt, steps)?;
            self.look();
        }
        Ok(())
    }

    /// Conductances between the particles as they are now.
    #[must_use]
    pub fn links(&self) -> Links {
        let voxels = Voxels {
            positions: &self.snapshot.position,
            volumes: &self.snapshot.volume,
            hosts: &self.hosts,
            domain: &self.plan.domain,
            barriers: &self.plan.barriers,
        };
        exchange::links(&voxels, &self.plan.kernel(), self.plan.thickness)
    }

    /// The voxels as the start of the chemistry sees them.
    #[must_use]
    pub fn places(&self) -> Places<'_> {
        Places {
            positions: &self.positions,
            volumes: &self.volumes,
            home: &self.plan.home,
            current: &self.current,
        }
    }

    /// Numbers of the particles that are in a group now, by home or by zone.
    #[must_use]
    pub fn members(&self, group: u8) -> Vec<u32> {
        (0..self.positions.len() as u32)
            .filter(|&i| self.current[i as usize] == group || self.plan.home[i as usize] == group)
            .collect()
    }
}
