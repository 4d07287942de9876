//! Internal forces of an elastic solid, in two passes over the bonds.
//!
//! ```text
//! F_i = 1 + [Σ_j V_j (u_j - u_i)⊗∇W0_ij] B_i,     F_e = F F_g⁻¹,   P = det(F_g) P_e(F_e) F_g⁻ᵀ
//! f_i = V_i Σ_j V_j (P_i B_i + P_j B_j) ∇W0_ij + hourglass + viscosity
//! ```
//!
//! The sum is the exact slope of the energy Σ V_i W(F_i), antisymmetric pair by pair. Hourglass control (Ganzenmüller
//! 2015): -(α/2) E V_i V_j (W0/R²) [((F_i + F_j) X_ij - 2 x_ij)·e] e, e = x_ij/|x_ij|, without which modes that leave
//! every F as it is cost nothing.

use rayon::prelude::*;

use crate::error::RunError;
use crate::solid::elastic::{Elastic, Strain};
use crate::space::matrix::{Matrix, determinant, dyad};
use crate::vector::Vector;

/// Particles a thread takes at a time.
pub(super) const CHUNK: usize = 512;

impl<const D: usize> Elastic<D> {
    /// First pass: F and P B of all particles.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] for a particle that is turned inside out.
    pub(super) fn strain(&mut self) -> Result<(), RunError> {
        if self.bonds.is_consistent() {
            return self.strain_consistent();
        }
        let (bonds, u, material) = (&self.bonds, &self.displacements, &self.material);
        let (softness, growth) = (&self.softness, self.growth.as_deref());
        let one = |i: usize, out: &mut Strain<D>| -> f64 {
            let here = u[i];
            let mut sum = Matrix::<D>::zeros();
            for bond in bonds.of(i) {
                sum += dyad(&((u[bond.j as usize] - here) * bond.f), &bond.x);
            }
            let correction = bonds.correction[i];
            let f = Matrix::<D>::identity() + sum * correction;
            let (elastic, grown) = match growth {
                Some(growth) => (f * growth[i], Some(growth[i])),
                None => (f, None),
            };
            let volume = determinant(&elastic);
            let stress = if volume > 0.0 {
                let stress = material.stress(&elastic, softness[i]);
                match grown {
                    Some(back) => stress * back.transpose() / determinant(&back),
                    None => stress,
                }
            } else {
                Matrix::zeros()
            };
            *out = Strain { f, pull: stress * correction };
            volume
        };
        let inverted = self
            .strains
            .par_chunks_mut(CHUNK)
            .enumerate()
            .map(|(chunk, strains)| {
                let mut fault = None;
                for (row, out) in strains.iter_mut().enumerate() {
                    let i = chunk * CHUNK + row;
                    let volume = one(i, out);
                    if (volume.is_nan() || volume <= 0.0) && fault.is_none() {
                        fault = Some(i);
                    }
                }
                fault
            })
            .reduce(|| None, Option::or);
        match inverted {
            None => Ok(()),
            Some(i) => Err(self.inverted(i)),
        }
    }

    /// Second pass: the forces.
    pub(super) fn pull(&mut self) {
        if self.bonds.is_consistent() {
            return self.pull_consistent();
        }
        let (bonds, u, strains) = (&self.bonds, &self.displacements, &self.strains);
        let (softness, velocities, volumes) = (&self.softness, &self.velocities, &self.volumes);
        let hourglass = 0.25 * self.options.hourglass * self.material.young();
        let viscosity = self.options.viscosity;
        self.forces.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, forces)| {
            for (row, out) in forces.iter_mut().enumerate() {
                let i = chunk * CHUNK + row;
                let (here, mine, soft) = (u[i], &strains[i], softness[i]);
                let mut force: Vector<D> = Vector::zeros();
                for bond in bonds.of(i) {
                    let j = bond.j as usize;
                    let its = &strains[j];
                    force += (mine.pull + its.pull) * bond.x * bond.f;
                    let x = bond.x + (u[j] - here);
                    // Twice what x lacks of what the gradients foresee, along x.
                    let lack = ((mine.f + its.f) * bond.x - x * 2.0).dot(&x);
                    let mut along = -hourglass * (soft + softness[j]) * lack;
                    if viscosity > 0.0 {
                        along += viscosity * (velocities[j] - velocities[i]).dot(&x);
                    }
                    force += x * (along * bond.w / x.norm_squared());
                }
                *out = force * volumes[i];
            }
        });
        self.tally.bond_evaluations += self.bonds.count() as u64;
    }

    pub(super) fn inverted(&self, i: usize) -> RunError {
        let f = &self.strains[i].f;
        let rows: Vec<String> = (0..D)
            .map(|a| (0..D).map(|b| format!("{:.3}", f[(a, b)])).collect::<Vec<_>>().join(", "))
            .collect();
        RunError::BlowUp {
            step: self.steps,
            time: self.time,
            particle: i,
            quantity: format!(
                "determinant of the deformation gradient F = [{}] of a solid particle",
                rows.join("; ")
            ),
            value: determinant(f),
            remedy:
                "the solid is crushed or torn here: smaller loads, a finer spacing, or a stiffer material"
                    .into(),
        }
    }
}
