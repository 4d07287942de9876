//! What must be kept of a solid to go on with it later, to the bit.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::solid::elastic::{Elastic, Tally};
use crate::space::matrix::Matrix;
use crate::vector::Vector;

/// The state of a solid between two steps; what follows from its setup and from the displacements is left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElasticState<'a, const D: usize> {
    displacements: Cow<'a, [Vector<D>]>,
    velocities: Cow<'a, [Vector<D>]>,
    /// Of the half step before: viscosity has seen the velocities there.
    forces: Cow<'a, [Vector<D>]>,
    loads: Cow<'a, [Vector<D>]>,
    softness: Cow<'a, [f64]>,
    growth: Option<Cow<'a, [Matrix<D>]>>,
    time: f64,
    steps: u64,
    tally: Tally,
}

impl<const D: usize> Elastic<D> {
    /// The state as it is now.
    #[must_use]
    pub fn image(&self) -> ElasticState<'_, D> {
        ElasticState {
            displacements: Cow::Borrowed(&self.displacements),
            velocities: Cow::Borrowed(&self.velocities),
            forces: Cow::Borrowed(&self.forces),
            loads: Cow::Borrowed(&self.loads),
            softness: Cow::Borrowed(&self.softness),
            growth: self.growth.as_deref().map(Cow::Borrowed),
            time: self.time,
            steps: self.steps,
            tally: self.tally.clone(),
        }
    }

    /// Puts a solid of the same setup into the state of an image; `None` if the image belongs to another setup.
    #[must_use]
    pub fn restore(&mut self, image: ElasticState<D>) -> Option<()> {
        let n = self.len();
        let fits = [&image.displacements, &image.velocities, &image.forces, &image.loads]
            .iter()
            .all(|vectors| vectors.len() == n)
            && image.softness.len() == n
            && image.growth.as_ref().is_none_or(|growth| growth.len() == n);
        if !fits {
            return None;
        }
        self.displacements = image.displacements.into_owned();
        self.velocities = image.velocities.into_owned();
        self.loads = image.loads.into_owned();
        self.softness = image.softness.into_owned();
        self.growth = image.growth.map(Cow::into_owned);
        self.strain().ok()?;
        self.forces = image.forces.into_owned();
        (self.time, self.steps, self.tally) = (image.time, image.steps, image.tally);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use crate::solid::{Elastic, ElasticState, Hold, Law, Material, Options, Setup};
    use crate::space::{Domain, KernelKind};
    use crate::vector::Vector;

    /// A block of 12 by 5 with its left end clamped, viscous, pulled at and set in motion.
    fn block(columns: usize) -> Elastic<2> {
        let places: Vec<Vector<2>> =
            (0..columns * 5).map(|k| Vector::<2>::new((k % columns) as f64, (k / columns) as f64)).collect();
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
            options: Options { viscosity: 0.05, drag: 0.01, ..Options::default() },
        };
        let mut solid = Elastic::new(setup).expect("a sound setup");
        solid.set_velocity(|x| Vector::<2>::new(0.0, 0.01 * x[0]));
        solid.loads_mut().fill(Vector::<2>::new(1e-4, 0.0));
        solid
    }

    #[test]
    fn a_solid_goes_on_from_an_image_as_if_nothing_had_been() {
        let mut straight = block(12);
        straight.advance(20.0, 0.2).expect("stable");
        let file = postcard::to_allocvec(&straight.image()).expect("serializes");
        straight.advance(20.0, 0.2).expect("stable");
        let mut resumed = block(12);
        let image: ElasticState<2> = postcard::from_bytes(&file).expect("deserializes");
        resumed.restore(image).expect("fits");
        resumed.advance(20.0, 0.2).expect("stable");
        assert_eq!(straight.image(), resumed.image());
        assert_eq!(straight.elastic_energy(), resumed.elastic_energy());
        let image: ElasticState<2> = postcard::from_bytes(&file).expect("deserializes");
        assert!(block(11).restore(image).is_none());
    }
}
