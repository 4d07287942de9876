//! The numbers of a flow, for the record.

use super::Ready;
use crate::fluid::{Friction, Method};
use crate::model::Domain;
use crate::plan::flow::{fastest, reference_length};
use crate::record::{FluidRecord, NoiseRecord};

impl<const D: usize> Ready<'_, D> {
    /// The fluid and its numbers, if anything flows.
    #[must_use]
    pub fn fluid(&self) -> Option<FluidRecord> {
        let Domain::Particles(domain) = &self.plan.model.domain else { return None };
        let (fluid, plan) = (domain.fluid.as_ref()?, self.scene.plan);
        // A flow that is replayed was told of by the run that recorded it.
        let (setup, sound_speed) = (plan.flow.as_ref()?, Some(self.sound_speed).filter(|c| *c > 0.0)?);
        let fastest = fastest(&self.plan.model, domain, plan)?;
        let (length, length_of) = reference_length(domain, fluid);
        let noise = fluid.temperature.zip(setup.noise).map(|(temperature, noise)| NoiseRecord {
            temperature,
            energy: noise.energy * plan.thickness,
            thermal_speed: (noise.energy / (fluid.density * setup.spacing.powi(D as i32))).sqrt(),
            friction: match fluid.friction {
                Friction::Morris => "morris",
                Friction::EspanolRevenga => "espanol_revenga",
            }
            .into(),
        });
        Some(FluidRecord {
            method: match fluid.method {
                Method::SphBvf => "sph_bvf",
                Method::Sdpd => "sdpd",
                Method::Sph => "sph",
            }
            .into(),
            density: fluid.density,
            viscosity: fluid.viscosity,
            sound_speed,
            mach: fastest.speed / sound_speed,
            reynolds: fluid.density * fastest.speed * length / fluid.viscosity,
            speed: fastest.speed,
            speed_of: fastest.what,
            length,
            length_of,
            noise,
        })
    }
}
