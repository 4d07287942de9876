//! What all forms of an elastic solid show.

use crate::solid::elastic::{Elastic, Tally};
use crate::solid::jaumann::Jaumann;
use crate::space::matrix::Matrix;
use crate::vector::Vector;

/// An elastic solid as it is now, whatever its equations.
pub trait Body<const D: usize> {
    /// Number of particles.
    fn len(&self) -> usize;

    /// Where the particles are at rest, m.
    fn places(&self) -> &[Vector<D>];

    /// Where particle `i` is, m; not wrapped round periodic axes.
    fn position(&self, i: usize) -> Vector<D>;

    /// m/s.
    fn velocities(&self) -> &[Vector<D>];

    /// Deformation gradient F of particle `i` from its place at rest.
    fn gradient(&self, i: usize) -> Matrix<D>;

    /// Mass of particle `i`, kg per unit thickness.
    fn mass(&self, i: usize) -> f64;

    /// Volume of particle `i` now, m^D.
    fn volume(&self, i: usize) -> f64;

    /// Cauchy stress of particle `i`, Pa; in fewer than three dimensions that of plane strain.
    fn stress(&self, i: usize) -> nalgebra::Matrix3<f64>;

    /// Whether particle `i` is held or driven.
    fn is_held(&self, i: usize) -> bool;

    /// J per unit thickness.
    fn kinetic_energy(&self) -> f64;

    /// J per unit thickness.
    fn elastic_energy(&self) -> f64;

    /// Time, s.
    fn time(&self) -> f64;

    /// What was counted.
    fn tally(&self) -> &Tally;

    /// Whether there is no particle.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The largest stretch of particle `i`, elastic and grown together: √ of the largest eigenvalue of FᵀF.
    fn stretch(&self, i: usize) -> f64;

    /// The largest stretch of all particles.
    fn largest_stretch(&self) -> f64 {
        (0..self.len()).map(|i| self.stretch(i)).fold(0.0, f64::max)
    }
}

/// A form shows what its own methods of the same names say.
macro_rules! shows {
    ($form:ident) => {
        impl<const D: usize> Body<D> for $form<D> {
            fn len(&self) -> usize {
                $form::len(self)
            }

            fn places(&self) -> &[Vector<D>] {
                $form::places(self)
            }

            fn position(&self, i: usize) -> Vector<D> {
                $form::position(self, i)
            }

            fn velocities(&self) -> &[Vector<D>] {
                $form::velocities(self)
            }

            fn gradient(&self, i: usize) -> Matrix<D> {
                $form::gradient(self, i)
            }

            fn stretch(&self, i: usize) -> f64 {
                $form::stretch(self, i)
            }

            fn mass(&self, i: usize) -> f64 {
                $form::mass(self, i)
            }

            fn volume(&self, i: usize) -> f64 {
                $form::volume(self, i)
            }

            fn stress(&self, i: usize) -> nalgebra::Matrix3<f64> {
                $form::stress(self, i)
            }

            fn is_held(&self, i: usize) -> bool {
                $form::is_held(self, i)
            }

            fn kinetic_energy(&self) -> f64 {
                $form::kinetic_energy(self)
            }

            fn elastic_energy(&self) -> f64 {
                $form::elastic_energy(self)
            }

            fn time(&self) -> f64 {
                $form::time(self)
            }

            fn tally(&self) -> &Tally {
                $form::tally(self)
            }
        }
    };
}

shows!(Elastic);
shows!(Jaumann);
