//! An elastic solid in motion.

use std::sync::Arc;

use crate::error::RunError;
use crate::solid::bonds::Bonds;
use crate::solid::material::Material;
use crate::space::matrix::Matrix;
use crate::space::{Domain, Kernel, KernelKind};
use crate::vector::Vector;

/// A displacement u(X, t), m, of the particle at X (m) at rest.
pub type Drive<const D: usize> = Arc<dyn Fn(&Vector<D>, f64) -> Vector<D> + Send + Sync>;

/// What holds a particle.
#[derive(Clone, Default)]
pub enum Hold<const D: usize> {
    #[default]
    Free,
    /// It stays where it is; its stress follows its neighbours.
    Clamped,
    /// It goes where it is told.
    Driven(Drive<D>),
}

/// What a solid is made of.
#[derive(Clone)]
pub struct Setup<const D: usize> {
    pub domain: Domain<D>,
    pub kernel: KernelKind,
    /// Cut-off h of the kernel at rest, m.
    pub cutoff: f64,
    /// At rest, m.
    pub places: Vec<Vector<D>>,
    /// At rest, m^D.
    pub volumes: Vec<f64>,
    /// Particle by particle.
    pub holds: Vec<Hold<D>>,
    pub material: Material,
    pub options: Options<D>,
}

/// Numbers of the method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options<const D: usize> {
    /// Strength α of hourglass control (Ganzenmüller 2015).
    pub hourglass: f64,
    /// Rate at which all velocity is lost, 1/s.
    pub drag: f64,
    /// Viscosity along bonds, Pa s: damps deformation, conserves momentum.
    pub viscosity: f64,
    /// Acceleration of every particle, m/s².
    pub body_force: Vector<D>,
    /// Step as a part of the longest stable one.
    pub courant: f64,
}

impl<const D: usize> Default for Options<D> {
    fn default() -> Options<D> {
        Options { hourglass: 0.1, drag: 0.0, viscosity: 0.0, body_force: Vector::zeros(), courant: 0.7 }
    }
}

/// What a particle shows to those bound to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Strain<const D: usize> {
    /// Deformation gradient F from the places at rest.
    pub f: Matrix<D>,
    /// P B, Pa.
    pub pull: Matrix<D>,
}

/// An elastic solid in motion.
#[derive(Clone)]
pub struct Elastic<const D: usize> {
    pub(super) places: Vec<Vector<D>>,
    pub(super) volumes: Vec<f64>,
    pub(super) holds: Vec<Hold<D>>,
    pub(super) material: Material,
    pub(super) options: Options<D>,
    pub(super) bonds: Bonds<D>,
    /// u, m.
    pub(super) displacements: Vec<Vector<D>>,
    /// m/s.
    pub(super) velocities: Vec<Vector<D>>,
    /// Internal forces, N per unit thickness.
    pub(super) forces: Vec<Vector<D>>,
    /// Forces from outside, N per unit thickness; they stay until set again.
    pub(super) loads: Vec<Vector<D>>,
    pub(super) strains: Vec<Strain<D>>,
    /// Corrected gradients, beside the consistent ones where those are used.
    pub(super) fits: Vec<Matrix<D>>,
    /// Factor of the shear modulus.
    pub(super) softness: Vec<f64>,
    /// Inverse of the growth F_g: F_e = F F_g⁻¹; where nothing has grown none.
    pub(super) growth: Option<Vec<Matrix<D>>>,
    pub(super) time: f64,
    pub(super) steps: u64,
    pub(super) tally: Tally,
}

/// What is counted over the steps.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tally {
    pub particle_steps: u64,
    pub bond_evaluations: u64,
}

impl<const D: usize> Elastic<D> {
    /// A solid at rest.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] at step 0 for a particle that hangs on too few others.
    pub fn new(setup: Setup<D>) -> Result<Elastic<D>, RunError> {
        let n = setup.places.len();
        let kernel = Kernel::new(setup.kernel, setup.cutoff);
        let bonds = Bonds::new(&setup.places, &setup.volumes, &setup.domain, &kernel)?;
        let none = Vector::zeros();
        let mut solid = Elastic {
            places: setup.places,
            volumes: setup.volumes,
            holds: setup.holds,
            material: setup.material,
            options: setup.options,
            bonds,
            displacements: vec![none; n],
            velocities: vec![none; n],
            forces: vec![none; n],
            loads: vec![none; n],
            strains: vec![Strain { f: Matrix::identity(), pull: Matrix::zeros() }; n],
            fits: Vec::new(),
            softness: vec![1.0; n],
            growth: None,
            time: 0.0,
            steps: 0,
            tally: Tally::default(),
        };
        solid.drive(0.0)?;
        solid.strain()?;
        solid.pull();
        Ok(solid)
    }

    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is no particle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Where particle `i` is, m; not wrapped round periodic axes.
    #[must_use]
    pub fn position(&self, i: usize) -> Vector<D> {
        self.places[i] + self.displacements[i]
    }

    /// Where the particles are at rest, m.
    #[must_use]
    pub fn places(&self) -> &[Vector<D>] {
        &self.places
    }

    /// What the particles fill at rest, m^D.
    #[must_use]
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// Whether particle `i` is held or driven.
    #[must_use]
    pub fn is_held(&self, i: usize) -> bool {
        !matches!(self.holds[i], Hold::Free)
    }

    /// m/s.
    #[must_use]
    pub fn velocities(&self) -> &[Vector<D>] {
        &self.velocities
    }

    /// Of all forces on particle `i`, m/s²; zero where it is held.
    #[must_use]
    pub fn acceleration(&self, i: usize) -> Vector<D> {
        match self.holds[i] {
            Hold::Free => (self.forces[i] + self.loads[i]) / self.mass(i) + self.options.body_force,
            _ => Vector::zeros(),
        }
    }

    /// kg/m³ at rest.
    #[must_use]
    pub fn density(&self) -> f64 {
        self.material.density
    }

    /// Mass of particle `i` without what has grown, kg per unit thickness.
    #[must_use]
    pub fn mass(&self, i: usize) -> f64 {
        self.material.density * self.volumes[i]
    }

    /// Gives the particles velocities (m/s) by their places at rest.
    pub fn set_velocity(&mut self, of: impl Fn(&Vector<D>) -> Vector<D>) {
        for ((velocity, place), hold) in self.velocities.iter_mut().zip(&self.places).zip(&self.holds) {
            if matches!(hold, Hold::Free) {
                *velocity = of(place);
            }
        }
    }

    /// Displaces the free particles (m) by their places at rest.
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn displace(&mut self, of: impl Fn(&Vector<D>) -> Vector<D>) -> Result<(), RunError> {
        for ((u, place), hold) in self.displacements.iter_mut().zip(&self.places).zip(&self.holds) {
            if matches!(hold, Hold::Free) {
                *u = of(place);
            }
        }
        self.strain()?;
        self.pull();
        Ok(())
    }

    /// Forces from outside on the particles, N per unit thickness; they act until changed.
    pub fn loads_mut(&mut self) -> &mut [Vector<D>] {
        &mut self.loads
    }

    /// Factor of the shear modulus of each particle, from the coming forces on.
    pub fn softness_mut(&mut self) -> &mut [f64] {
        &mut self.softness
    }

    /// Takes gradients that are consistent with a surface from the coming forces on, and hourglass control that is the
    /// slope of an energy; `skin` is the area vector each particle carries, m^(D-1).
    pub(super) fn consist(&mut self, skin: &[Vector<D>]) {
        self.bonds.consist(&self.volumes, skin);
        self.fits = vec![Matrix::identity(); self.places.len()];
    }

    /// Forces anew, with the softness of now.
    ///
    /// # Errors
    /// As [`Elastic::step`].
    pub fn renew(&mut self) -> Result<(), RunError> {
        self.strain()?;
        self.pull();
        Ok(())
    }

    /// Time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// What was counted.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.tally
    }
}
