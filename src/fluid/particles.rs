//! The state of a flow: what a pair needs of each side, and what only the particle itself needs.

use crate::fluid::symmetric::Symmetric;
use crate::vector::Vector;
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};

/// What a particle is to its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Material {
    #[default]
    Fluid,
    /// Solid with a no-slip surface.
    NoSlip,
    /// Solid with a frictionless surface.
    FreeSlip,
}

/// One side of a pair: packed, since a sweep reads all of it at a random place. Whole lines of the cache for each were
/// slower: they take more of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[repr(C)]
pub struct Side<const D: usize> {
    /// Momentum velocity v, m/s. Of a solid: its own velocity in the density sweep, the mirrored velocity of
    /// [`crate::fluid::wall::mirror`] in the force sweep.
    pub velocity: Vector<D>,
    /// Transport velocity less momentum velocity, m/s; zero for solids.
    pub drift: Vector<D>,
    /// kg/m³.
    pub density: f64,
    /// m^D.
    pub volume: f64,
    /// 1/rho, m³/kg; as the next kept up to date by [`Side::invert`].
    pub inverse_density: f64,
    /// V^-1/2, m^(-D/2).
    pub inverse_root: f64,
    /// Index in [`Setup::particles`](crate::fluid::Setup).
    pub id: u32,
    pub material: Material,
    /// Index of the body.
    pub body: u8,
    /// Whether the factor of friction may need its limits, [`crate::fluid::terms::Moment`].
    pub uneven: bool,
    /// Whether a sponge sets its velocity faster than it passes: its mass goes where that leads, and does not diffuse.
    pub held: bool,
    /// Pa.
    pub pressure: f64,
    /// Dynamic viscosity, Pa s; of a solid that of as much of the lightest fluid.
    pub viscosity: f64,
    /// What friction makes of the second moment of the neighbours, [`crate::fluid::terms::Moment`].
    pub moment: Symmetric<D>,
    /// Of a solid Σ V W over the fluid before it, dimensionless; of a fluid without meaning.
    pub reach: f64,
}

impl<const D: usize> Side<D> {
    /// What pairs would divide by, after a change of density or volume: a division a particle, not one a pair.
    #[inline(always)]
    pub fn invert(&mut self) {
        self.inverse_density = 1.0 / self.density;
        self.inverse_root = 1.0 / self.volume.sqrt();
    }

    /// Whether the particle is part of a solid.
    #[inline(always)]
    #[must_use]
    pub fn is_solid(&self) -> bool {
        self.material != Material::Fluid
    }
}

/// What a particle shows to its neighbours besides its [`Side`] where there is no noise. Apart from it, since with noise
/// nobody looks at it. Of a solid nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slopes<const D: usize> {
    /// ∇rho over the same fluid, kg/m⁴; zero without density diffusion. The next step asks for it.
    pub density: Vector<D>,
    /// rho v⊗w - θ eta ∇v G⁻¹, N/m²: what momentum the drift w carries
    /// ([`TransportStress`](crate::fluid::terms::TransportStress)), and what makes friction one of the fourth order
    /// ([`flux`](crate::fluid::terms::viscosity::flux)).
    #[serde(skip, default = "SMatrix::zeros")]
    pub flux: SMatrix<f64, D, D>,
    /// Whether no solid is in reach.
    #[serde(skip)]
    pub clear: bool,
}

impl<const D: usize> Default for Slopes<D> {
    fn default() -> Slopes<D> {
        Slopes { density: Vector::zeros(), flux: SMatrix::zeros(), clear: false }
    }
}

/// What a particle keeps to itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Own<const D: usize> {
    /// Mass per unit thickness, kg/m^(3-D); of a solid that of as much of the lightest fluid.
    pub mass: f64,
    /// Density at zero pressure, kg/m³; of a solid that of the lightest fluid.
    pub rest_density: f64,
    /// Place at t = 0, m; solids move relative to it.
    pub start: Vector<D>,
    /// m/s².
    pub acceleration: Vector<D>,
    /// Acceleration of this particle besides gravity, m/s²: buoyancy.
    pub lift: Vector<D>,
    /// ∇²v of a fluid particle near a solid, as its friction sums it, 1/(m s).
    pub bend: Vector<D>,
    /// Of a solid particle how deep it lies behind the surface, m, zero where that is not known, and how the surface is
    /// bent there, 1/m; [`crate::fluid::depth::Cover`].
    pub depth: f64,
    pub curvature: f64,
    /// Volume fraction of solid around the particle.
    pub fraction: f64,
    /// Of a solid particle Σ m_f W of the fluid in reach at the start, kg/m³; [`crate::fluid::mirror::filling`].
    pub filling: f64,
}

impl<const D: usize> Own<D> {
    /// Volume at the start (of a fluid particle at rest density), m^D.
    #[must_use]
    pub fn rest_volume(&self) -> f64 {
        self.mass / self.rest_density
    }
}
