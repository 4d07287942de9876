//! The updated-Lagrangian solid of Gray, Monaghan & Swift (2001), SPH-BVF Eqs. (16)-(22): for comparison.
//!
//! ```text
//! L_i = Σ_j V_j (v_j - v_i)⊗∇W_ij,   ε = (L + Lᵀ)/2,   ω = (L - Lᵀ)/2
//! Ṡ = 2 G (ε - tr(ε)/3 1) + S·ωᵀ + ω·S,   ρ̇ = -ρ tr L,   P = K (ρ/ρ0 - 1),   σ = S - P 1
//! a_i = Σ_j m_j [σ_i/ρ_i² + σ_j/ρ_j² + (R_i + R_j) (W/W(Δ))⁴ - Π] ∇W_ij
//! ```
//!
//! The third of the trace is taken off whatever the dimension: strain is plane in 2D. The artificial stress R acts in
//! the principal axes of σ, -ε σ_a/ρ² where σ_a > 0. Π is the artificial viscosity of Monaghan (1992). Against the
//! total-Lagrangian form it knows no state at rest: neighbours are found anew as particles move, and what the stress
//! has gathered in a cycle need not come back to zero.

mod force;
mod measure;
mod state;

pub use state::JaumannState;

use rayon::prelude::*;

use crate::error::RunError;
use crate::solid::elastic::{Hold, Setup, Tally};
use crate::solid::force::CHUNK;
use crate::solid::limit::StepLimit;
use crate::solid::material::Material;
use crate::solid::nearby::Nearby;
use crate::solid::step::driven;
use crate::space::matrix::{Matrix, determinant, dyad, inverse};
use crate::space::{Domain, Kernel};
use crate::vector::Vector;

/// Longest step that is stable, times the speed of pressure waves over the cut-off: 0.57 for beams with h = 3 spacings
/// (the fastest mode of [`Elastic`](super::Elastic) without hourglass control), 0.67 with 1.6.
const STABLE: f64 = 0.5;

/// Numbers of the form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// Coefficient ε of the artificial stress.
    pub artificial_stress: f64,
    /// Linear coefficient α of the artificial viscosity; the quadratic one is twice as large.
    pub artificial_viscosity: f64,
    /// Whether gradients are corrected, so that a rigid turn strains nothing: ∇W_ij B_i with
    /// B_i = [Σ_j V_j (v_j - v_i → x_j - x_i)⊗∇W_ij]⁻¹. As printed they are not.
    pub corrected: bool,
}

impl Default for Form {
    fn default() -> Form {
        // Without artificial stress a beam with h = 1.6 spacings tears within two periods of V0 = 1e-2; with it, and
        // less viscosity than this, its noise grows.
        Form { artificial_stress: 0.2, artificial_viscosity: 0.05, corrected: true }
    }
}

impl Form {
    /// As in SPH-BVF, section 4.5. With h = 3 spacings a beam needs this much viscosity: artificial stress makes the
    /// stiffness unsymmetric, so that short waves gain (half of it does not hold them for a small swing).
    #[must_use]
    pub fn printed() -> Form {
        Form { artificial_stress: 0.2, artificial_viscosity: 1.0, corrected: false }
    }
}

/// What a particle shows to those near it.
#[derive(Clone, Copy, Debug)]
struct Pull<const D: usize> {
    /// σ B/ρ², m²/s² per kg/m³.
    stress: Matrix<D>,
    /// R, as `stress`.
    artificial: Matrix<D>,
}

/// An elastic solid whose stress is integrated in time.
pub struct Jaumann<const D: usize> {
    domain: Domain<D>,
    kernel: Kernel<D>,
    form: Form,
    places: Vec<Vector<D>>,
    masses: Vec<f64>,
    pub(super) holds: Vec<Hold<D>>,
    material: Material,
    options: super::Options<D>,
    /// Distance of particles at rest, m.
    spacing: f64,
    /// m.
    positions: Vec<Vector<D>>,
    /// m/s.
    velocities: Vec<Vector<D>>,
    /// kg/m³.
    densities: Vec<f64>,
    /// S, Pa. Its trace with what is out of the plane is zero.
    deviators: Vec<Matrix<D>>,
    /// F, gathered from L as the stress is.
    gradients: Vec<Matrix<D>>,
    corrections: Vec<Matrix<D>>,
    pulls: Vec<Pull<D>>,
    /// By internal forces, m/s².
    accelerations: Vec<Vector<D>>,
    /// Forces from outside, N per unit thickness.
    loads: Vec<Vector<D>>,
    near: Nearby<D>,
    time: f64,
    steps: u64,
    tally: Tally,
}

impl<const D: usize> Jaumann<D> {
    /// Advances by `duration` (s) in equal steps of at most `longest` (s).
    ///
    /// # Errors
    /// As [`Jaumann::step`].
    pub fn advance(&mut self, duration: f64, longest: f64) -> Result<(), RunError> {
        let steps = (duration / longest).ceil().max(1.0);
        for _ in 0..steps as u64 {
            self.step(duration / steps)?;
        }
        Ok(())
    }

    /// A solid at rest. Hourglass control and growth are not part of this form.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] at step 0 for a particle that hangs on too few others, if gradients are corrected.
    pub fn new(setup: Setup<D>, form: Form) -> Result<Jaumann<D>, RunError> {
        let n = setup.places.len();
        let kernel = Kernel::new(setup.kernel, setup.cutoff);
        let volume = setup.volumes.iter().sum::<f64>() / n.max(1) as f64;
        let none = Vector::zeros();
        let mut solid = Jaumann {
            near: Nearby::new(&setup.places, &setup.domain, setup.cutoff),
            domain: setup.domain,
            kernel,
            form,
            masses: setup.volumes.iter().map(|v| v * setup.material.density).collect(),
            positions: setup.places.clone(),
            places: setup.places,
            holds: setup.holds,
            material: setup.material,
            options: setup.options,
            spacing: volume.powf(1.0 / D as f64),
            velocities: vec![none; n],
            densities: vec![setup.material.density; n],
            deviators: vec![Matrix::zeros(); n],
            gradients: vec![Matrix::identity(); n],
            corrections: vec![Matrix::identity(); n],
            pulls: vec![Pull { stress: Matrix::zeros(), artificial: Matrix::zeros() }; n],
            accelerations: vec![none; n],
            loads: vec![none; n],
            time: 0.0,
            steps: 0,
            tally: Tally::default(),
        };
        solid.accelerate()?;
        Ok(solid)
    }

    /// One step of `dt` (s): half a kick; stress and density with the velocity gradient half way; the second half.
    /// The stress is turned as by Hughes & Winget (1980): exactly so in a rigid turn of any size.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] for a particle that is lost.
    pub fn step(&mut self, dt: f64) -> Result<(), RunError> {
        self.kick(0.5 * dt);
        for i in 0..self.positions.len() {
            if let Hold::Driven(drive) = &self.holds[i] {
                let at = |t| driven(drive, (i, &self.places[i]), (self.steps, t));
                self.velocities[i] = (at(self.time + dt)? - at(self.time)?) / dt;
            }
        }
        self.drift(0.5 * dt);
        self.near.renew(&self.positions, &self.domain);
        self.flow(dt)?;
        self.drift(0.5 * dt);
        self.time += dt;
        self.steps += 1;
        self.near.renew(&self.positions, &self.domain);
        self.accelerate()?;
        self.kick(0.5 * dt);
        self.tally.particle_steps += self.positions.len() as u64;
        Ok(())
    }

    /// The longest step that is used and what limits it.
    #[must_use]
    pub fn limit(&self) -> StepLimit {
        let limited_by = "the speed of pressure waves in the solid".into();
        StepLimit { seconds: self.step_limit(), limited_by }
    }

    /// The longest step that is used, s, by the speed of pressure waves and the cut-off.
    #[must_use]
    pub fn step_limit(&self) -> f64 {
        let wave = ((self.material.bulk + 4.0 / 3.0 * self.material.shear) / self.material.density).sqrt();
        let fastest = self.velocities.iter().map(|v| v.norm()).fold(0.0, f64::max);
        self.options.courant * STABLE * self.kernel.cutoff() / (wave + fastest)
    }

    fn drift(&mut self, dt: f64) {
        for (i, x) in self.positions.iter_mut().enumerate() {
            if !matches!(self.holds[i], Hold::Clamped) {
                *x += self.velocities[i] * dt;
            }
        }
    }

    fn kick(&mut self, dt: f64) {
        let drag = (-self.options.drag * dt).exp();
        for (i, velocity) in self.velocities.iter_mut().enumerate() {
            if matches!(self.holds[i], Hold::Free) {
                let pull = self.accelerations[i] + self.loads[i] / self.masses[i] + self.options.body_force;
                *velocity = (*velocity + pull * dt) * drag;
            }
        }
    }

    /// Density, stress and deformation over `dt` with the velocity gradient of now.
    fn flow(&mut self, dt: f64) -> Result<(), RunError> {
        let corrections = self.moments()?;
        let (x, v, kernel, material) = (&self.positions, &self.velocities, &self.kernel, &self.material);
        let (masses, near, domain) = (&self.masses, &self.near, &self.domain);
        let gradients: Vec<Matrix<D>> = {
            let densities = &self.densities;
            (0..x.len())
                .into_par_iter()
                .with_min_len(CHUNK)
                .map(|i| {
                    let mut sum = Matrix::<D>::zeros();
                    for &j in near.of(i) {
                        let j = j as usize;
                        let away = domain.separation(&x[j], &x[i]);
                        let f = kernel.f(away.norm()) * masses[j] / densities[j];
                        sum += dyad(&((v[j] - v[i]) * f), &away);
                    }
                    sum * corrections[i]
                })
                .collect()
        };
        for (i, l) in gradients.iter().enumerate() {
            let (strain, spin) = ((l + l.transpose()) * (0.5 * dt), (l - l.transpose()) * (0.25 * dt));
            let one = Matrix::<D>::identity();
            let turn = inverse(&(one - spin)) * (one + spin);
            let spread = strain.trace();
            let mut deviator = turn * self.deviators[i] * turn.transpose() + strain * (2.0 * material.shear);
            for k in 0..D {
                deviator[(k, k)] -= 2.0 / 3.0 * material.shear * spread;
            }
            self.deviators[i] = deviator;
            let half = l * (0.5 * dt);
            self.gradients[i] = inverse(&(one - half)) * (one + half) * self.gradients[i];
            // Exact for a constant rate of volume.
            self.densities[i] *= (-spread).exp();
        }
        Ok(())
    }

    /// B_i of all particles, or one.
    fn moments(&self) -> Result<Vec<Matrix<D>>, RunError> {
        let x = &self.positions;
        if !self.form.corrected {
            return Ok(vec![Matrix::identity(); x.len()]);
        }
        let moments: Vec<Matrix<D>> = (0..x.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| {
                self.near.of(i).iter().fold(Matrix::zeros(), |sum, &j| {
                    let j = j as usize;
                    let away = self.domain.separation(&x[j], &x[i]);
                    let f = self.kernel.f(away.norm()) * self.masses[j] / self.densities[j];
                    sum + dyad(&away, &away) * f
                })
            })
            .collect();
        for (i, moment) in moments.iter().enumerate() {
            let span = determinant(moment);
            if span.is_nan() || span <= 1e-3_f64.powi(D as i32) {
                let remedy =
                    "the solid is torn or too thin for its spacing here: smaller loads, or a larger support";
                return Err(self.fault(i, "span of the neighbours of a solid particle", span, remedy));
            }
        }
        Ok(moments.iter().map(inverse).collect())
    }

    fn fault(&self, i: usize, quantity: &str, value: f64, remedy: &str) -> RunError {
        RunError::BlowUp {
            step: self.steps,
            time: self.time,
            particle: i,
            quantity: quantity.into(),
            value,
            remedy: remedy.into(),
        }
    }
}
