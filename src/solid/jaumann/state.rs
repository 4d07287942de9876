//! What must be kept of the updated-Lagrangian form to go on with it later, to the bit.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::Jaumann;
use crate::solid::elastic::Tally;
use crate::space::matrix::Matrix;
use crate::vector::Vector;

/// The state between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JaumannState<'a, const D: usize> {
    positions: Cow<'a, [Vector<D>]>,
    velocities: Cow<'a, [Vector<D>]>,
    /// Of the half step before: viscosity has seen the velocities there.
    accelerations: Cow<'a, [Vector<D>]>,
    loads: Cow<'a, [Vector<D>]>,
    densities: Cow<'a, [f64]>,
    deviators: Cow<'a, [Matrix<D>]>,
    gradients: Cow<'a, [Matrix<D>]>,
    time: f64,
    steps: u64,
    tally: Tally,
}

impl<const D: usize> Jaumann<D> {
    /// The state as it is now.
    #[must_use]
    pub fn image(&self) -> JaumannState<'_, D> {
        JaumannState {
            positions: Cow::Borrowed(&self.positions),
            velocities: Cow::Borrowed(&self.velocities),
            accelerations: Cow::Borrowed(&self.accelerations),
            loads: Cow::Borrowed(&self.loads),
            densities: Cow::Borrowed(&self.densities),
            deviators: Cow::Borrowed(&self.deviators),
            gradients: Cow::Borrowed(&self.gradients),
            time: self.time,
            steps: self.steps,
            tally: self.tally.clone(),
        }
    }

    /// Puts a solid of the same setup into the state of an image; `None` if the image belongs to another setup.
    #[must_use]
    pub fn restore(&mut self, image: JaumannState<D>) -> Option<()> {
        let n = self.len();
        let vectors = [&image.positions, &image.velocities, &image.accelerations, &image.loads];
        let matrices = [&image.deviators, &image.gradients];
        if vectors.iter().any(|v| v.len() != n)
            || matrices.iter().any(|m| m.len() != n)
            || image.densities.len() != n
        {
            return None;
        }
        self.positions = image.positions.into_owned();
        self.velocities = image.velocities.into_owned();
        self.accelerations = image.accelerations.into_owned();
        self.loads = image.loads.into_owned();
        self.densities = image.densities.into_owned();
        self.deviators = image.deviators.into_owned();
        self.gradients = image.gradients.into_owned();
        (self.time, self.steps, self.tally) = (image.time, image.steps, image.tally);
        // Whom the lists hold beyond the cut-off adds nothing, so that new lists change no sum.
        self.near.make(&self.positions, &self.domain);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::{Form, Hold, Law, Material, Options, Setup};
    use crate::space::{Domain, KernelKind};

    fn block(columns: usize, form: Form) -> Jaumann<2> {
        let places: Vec<Vector<2>> =
            (0..columns * 5).map(|k| Vector::<2>::new((k / 5) as f64, (k % 5) as f64)).collect();
        let setup = Setup {
            domain: Domain {
                min: Vector::<2>::repeat(-20.0),
                max: Vector::<2>::repeat(20.0),
                periodic: [false; 2],
            },
            kernel: KernelKind::Lucy,
            cutoff: 1.6,
            volumes: vec![1.0; places.len()],
            holds: places.iter().map(|x| if x[0] < 1.5 { Hold::Clamped } else { Hold::Free }).collect(),
            places,
            material: Material::of_young(Law::NeoHookean, 1.0, 2.0, 0.3),
            options: Options { drag: 0.01, ..Options::default() },
        };
        let mut solid = Jaumann::new(setup, form).expect("a sound setup");
        // Fast enough that lists of neighbours are made anew.
        solid.set_velocity(|x| Vector::<2>::new(0.0, 3e-3 * x[0] * x[0]));
        solid.loads_mut().fill(Vector::<2>::new(1e-4, 0.0));
        solid
    }

    #[test]
    fn a_solid_goes_on_from_an_image_as_if_nothing_had_been() {
        for form in [Form::printed(), Form::default()] {
            let go = |solid: &mut Jaumann<2>| (0..60).for_each(|_| solid.step(0.1).expect("stable"));
            let mut straight = block(12, form);
            go(&mut straight);
            let file = postcard::to_allocvec(&straight.image()).expect("serializes");
            go(&mut straight);
            let moved = (straight.position(59) - straight.places()[59]).norm();
            // More than a tenth of the cut-off: lists were made anew.
            assert!(moved > 0.2, "{moved}");
            let mut resumed = block(12, form);
            resumed.restore(postcard::from_bytes(&file).expect("deserializes")).expect("fits");
            go(&mut resumed);
            assert!(straight.image() == resumed.image());
            let image = postcard::from_bytes(&file).expect("deserializes");
            assert!(block(11, form).restore(image).is_none());
        }
    }
}
