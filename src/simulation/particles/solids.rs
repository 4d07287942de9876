//! The numbers of the elastic solids, for the record.

use super::Ready;
use crate::chemistry::AVOGADRO;
use crate::error::{Fault, ModelError};
use crate::geometry::Shape;
use crate::model::Domain;
use crate::model::solids::{Form, law_name};
use crate::plan::start::Start;
use crate::plan::{Plan, SolidPlan, VesselPlan};
use crate::quantity::readable::{show, significant};
use crate::record::SolidRecord;
use crate::scene::Scene;
use crate::simulation::clock::Interval;
use crate::solid::{Hold, StepLimit};

impl<const D: usize> Ready<'_, D> {
    /// The elastic solids and their numbers, in the order of the model.
    #[must_use]
    pub fn solids(&self) -> Vec<SolidRecord> {
        let Domain::Particles(domain) = &self.plan.model.domain else { return Vec::new() };
        let steps = self.solid_steps.iter().cloned().map(Some).chain(std::iter::repeat(None));
        let all = domain.solids.iter().zip(&self.scene.plan.solids).zip(steps);
        all.map(|((described, plan), step)| {
            let material = plan.setup.material;
            let count = |wanted: fn(&Hold<D>) -> bool| plan.setup.holds.iter().filter(|h| wanted(h)).count();
            let StepLimit { seconds, limited_by } = match &plan.vessel {
                Some(_) => StepLimit { seconds: self.longest_tick(), limited_by: AT_EACH.into() },
                None => step.unwrap_or_default(),
            };
            let vessel = plan.vessel.as_ref();
            SolidRecord {
                name: plan.name.clone(),
                particles: plan.setup.places.len(),
                spacing: plan.spacing,
                thickness: plan.thickness,
                // A rate of stress, integrable to no energy.
                law: match described.form {
                    Form::TotalLagrangian => law_name(material.law).into(),
                    Form::Jaumann(_) => "hypoelastic".into(),
                },
                method: described.form.name().into(),
                density: material.density,
                bulk_modulus: material.bulk,
                shear_modulus: material.shear,
                youngs_modulus: material.young(),
                poisson_ratio: material.poisson(),
                sound_speed: material.sound_speed(),
                step: seconds,
                limited_by,
                clamped: count(|hold| matches!(hold, Hold::Clamped)),
                driven: count(|hold| matches!(hold, Hold::Driven(_))),
                softening: plan.softening.map_or_else(String::new, |softening| {
                    format!(
                        "shear modulus times 1 - {} c/({}), c the concentration of {}",
                        significant(softening.factor, 4),
                        show(softening.at, "mol/m^3"),
                        self.plan.reactor.species[softening.species]
                    )
                }),
                columns: vessel
                    .map(|v| format!("{} of {} layers", v.wall.columns, v.wall.layers))
                    .unwrap_or_default(),
                balance: vessel.map(|v| self.balance_words(v)).unwrap_or_default(),
                turgor: vessel.map(turgor_words).unwrap_or_default(),
                growth: vessel.map(|v| self.growth_words(v)).unwrap_or_default(),
            }
        })
        .collect()
    }

    pub(super) fn longest_tick(&self) -> f64 {
        self.clock.iter().map(Interval::tick).fold(0.0, f64::max)
    }

    fn balance_words(&self, vessel: &VesselPlan<D>) -> String {
        format!(
            "at every chemistry step of {}, but for {} of the loads",
            show(self.longest_tick(), "s"),
            significant(vessel.relaxation.tolerance, 3)
        )
    }

    fn growth_words(&self, vessel: &VesselPlan<D>) -> String {
        let Some(growth) = vessel.growth else { return String::new() };
        let by = vessel.by.map_or_else(String::new, |(species, at)| {
            let name = &self.plan.reactor.species[species];
            format!(" times c/({}), c the concentration of {name},", show(at, "mol/m^3"))
        });
        format!(
            "{} 1/(Pa s){by} above a stress of {}; new columns at a stretch of {}, {} particles for them",
            significant(vessel.rate, 4),
            show(growth.yields, "Pa"),
            significant(growth.insert_at, 4),
            growth.reserve * vessel.wall.layers
        )
    }

    /// Warnings of walls that would grow beyond measure in one chemistry step: at their yield stress over again, or at the
    /// stress of a thin wall under their turgor if that is larger.
    #[must_use]
    pub fn rash_growth(&self) -> Vec<String> {
        let Domain::Particles(domain) = &self.plan.model.domain else { return Vec::new() };
        let mut found = Vec::new();
        for (described, plan) in domain.solids.iter().zip(&self.scene.plan.solids) {
            let Some((vessel, growth)) = plan.vessel.as_ref().and_then(|v| Some((v, v.growth?))) else {
                continue;
            };
            let Shape::Shell { inner, outer, .. } = &domain.groups[described.group].shape else { continue };
            let pull = vessel.turgor.pressure * inner / (outer - inner) / (D as f64 - 1.0);
            let (stress, tick) = (pull.max(growth.yields), self.longest_tick());
            let grown = vessel.rate * stress * tick;
            if grown > 1.0 {
                found.push(format!(
                    "growth of `{}`: growth.rate times a stress of {} and a chemistry step of {} is {}, the wall would be e^{} times as long after it; look at the unit of growth.rate, or make chemistry.step shorter",
                    plan.name,
                    show(stress, "Pa"),
                    show(tick, "s"),
                    significant(grown, 3),
                    significant(grown, 3)
                ));
            }
        }
        found
    }
}

/// What limits the steps of a wall in balance.
pub(super) const AT_EACH: &str = "the chemistry step: in balance at each";

fn turgor_words<const D: usize>(vessel: &VesselPlan<D>) -> String {
    let turgor = vessel.turgor;
    let mut words = show(turgor.pressure, "Pa");
    if turgor.stiffness > 0.0 {
        words += &format!(" - {} (V/V0 - 1)", show(turgor.stiffness, "Pa"));
    }
    if turgor.rise > 0.0 {
        words += &format!(", risen after {}", show(turgor.rise, "s"));
    }
    words
}

/// Refuses solids that what is in them at the start (means where it is dealt) softens to nothing.
pub(super) fn check_softening<const D: usize>(
    plan: &Plan,
    scene: &Scene<D>,
    start: &Start,
) -> Result<(), ModelError> {
    let Domain::Particles(domain) = &plan.model.domain else { return Ok(()) };
    let (count, amounts) = (plan.reactor.species_count(), start.means());
    let soft = |solid: &SolidPlan<D>, i: usize| {
        let softening = solid.softening?;
        let found = amounts[i * count + softening.species] / (AVOGADRO * scene.volumes[i]);
        Some((1.0 - softening.factor * found / softening.at, found, i))
    };
    let mut faults = Vec::new();
    for (described, solid) in domain.solids.iter().zip(&scene.plan.solids) {
        let all = solid.first..solid.first + solid.setup.places.len();
        let softest = all.filter_map(|i| soft(solid, i)).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((left, found, i)) = softest.filter(|softest| softest.0 <= 0.0) else { continue };
        let at = crate::quantity::readable::show_vector(&scene.positions[i].as_slice()[..D], "m");
        let (Some(softening), places) = (solid.softening, &described.places) else { continue };
        faults.push(Fault::at(
            places.softening.as_ref().unwrap_or(&places.entry),
            format!(
                "with {} of `{}` at {at} at the start the shear modulus of `{}` is {} times that without: a modulus is positive",
                show(found, "mol/m^3"),
                plan.reactor.species[softening.species],
                solid.name,
                significant(left, 3)
            ),
            format!(
                "make factor smaller or `at` larger, or begin with less than {}",
                show(softening.at / softening.factor, "mol/m^3")
            ),
        ));
    }
    if faults.is_empty() { Ok(()) } else { Err(ModelError { faults }) }
}
