//! The numbers of the elastic solids, for the record.

use super::Ready;
use crate::model::Domain;
use crate::model::solids::{Form, law_name};
use crate::quantity::readable::{show, significant};
use crate::record::SolidRecord;
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
            let StepLimit { seconds, limited_by } = step.unwrap_or_default();
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
            }
        })
        .collect()
    }
}
