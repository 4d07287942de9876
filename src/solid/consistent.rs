//! Gradients that know their boundary: a constant stress is in equilibrium with its traction, whatever the spacing.
//!
//! With coefficients d_ij of F_i = 1 + 1/V_i Σ_j (u_j - u_i)⊗d_ij the corrected gradient has Σ_j X_ij⊗d_ij = V_i (every
//! linear displacement is exact), but a constant stress leaves forces where spacing or volumes change. Asked for besides is
//!
//! ```text
//! Σ_i d_ij - Σ_k d_jk = A_j
//! ```
//!
//! with A_j the area vector of the body's surface that j carries, the discrete divergence theorem (variationally
//! consistent integration; Chen, Hillman & Rüter 2013). The least change, weighed by G_ij = V_i V_j F, is
//!
//! ```text
//! G_ij (λ_j - λ_i - (∇λ)_i X_ij),     Σ_i G_ij [2 (λ_j - λ_i) - ((∇λ)_i + (∇λ)_j) X_ij] = A_j - what is there
//! ```
//!
//! with ∇ the corrected gradient: a symmetric system, solved by conjugate gradients.

//! Hourglass control is conservative here. Ganzenmüller's force is no slope of an energy, as the change of F is left out,
//! and can feed a mode that is hardly damped; of what the corrected gradient F' leaves of its neighbours,
//!
//! ```text
//! α' E/2 Σ_i V_i Σ_j V_j F |F'_i X_ij - x_ij|²,     force -α' E V_i V_j F [(F'_i X_ij - x_ij) + (F'_j X_ij - x_ij)]
//! ```
//!
//! F' drops out of the derivative, because each F'_i makes its own sum least.

use rayon::prelude::*;

use crate::error::RunError;
use crate::solid::bonds::{Bond, Bonds};
use crate::solid::elastic::{Elastic, Strain};
use crate::solid::force::CHUNK;
use crate::space::matrix::{Matrix, determinant, dyad};
use crate::vector::Vector;

/// α' over α: as stiff as Ganzenmüller's on bonds of average length.
const FIT: f64 = 0.1;
/// Largest part of the imbalance that is left.
const LEFT: f64 = 1e-9;
/// Rounds at most.
const ROUNDS: usize = 4000;

/// What F_i takes from a bond, and what F_j takes from it at the other end, both over V_i, 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends<const D: usize> {
    pub own: Vector<D>,
    pub other: Vector<D>,
}

impl<const D: usize> Bonds<D> {
    /// Makes the gradients consistent with the surface `skin`: the area vector of each particle, m^(D-1), whose moment is
    /// the volume of the body.
    pub(super) fn consist(&mut self, volumes: &[f64], skin: &[Vector<D>]) {
        let n = volumes.len();
        let residual: Vec<Vector<D>> = each(n, |j| {
            let sum: Vector<D> = (self.of(j).iter())
                .map(|bond| (self.correction[bond.j as usize] + self.correction[j]) * bond.x * bond.f)
                .sum();
            skin[j] + sum * volumes[j]
        });
        let scale: Vec<f64> = each(n, |j| volumes[j] * self.of(j).iter().map(|bond| bond.f).sum::<f64>())
            .iter()
            .map(|g| 0.5 / g)
            .collect();
        let lambda = self.solve(volumes, residual, &scale);
        let slope = self.slope(&lambda);
        let mut ends = Vec::with_capacity(self.count());
        for i in 0..n {
            for bond in self.of(i) {
                let j = bond.j as usize;
                let rise = lambda[j] - lambda[i];
                ends.push(Ends {
                    own: (self.correction[i] * bond.x + rise - slope[i] * bond.x) * bond.f,
                    other: (slope[j] * bond.x - rise - self.correction[j] * bond.x) * bond.f,
                });
            }
        }
        self.ends = ends;
    }

    /// λ of the right side, by conjugate gradients with the diagonal as preconditioner.
    fn solve(&self, volumes: &[f64], mut left: Vec<Vector<D>>, scale: &[f64]) -> Vec<Vector<D>> {
        let dot = |a: &[Vector<D>], b: &[Vector<D>]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
        let eased =
            |left: &[Vector<D>]| -> Vec<Vector<D>> { left.iter().zip(scale).map(|(r, s)| r * *s).collect() };
        let mut lambda = vec![Vector::zeros(); left.len()];
        let mut along = eased(&left);
        let mut size = dot(&left, &along);
        let enough = LEFT * LEFT * size;
        for _ in 0..ROUNDS {
            if size <= enough {
                break;
            }
            let image = self.bend(volumes, &along);
            let step = size / dot(&along, &image);
            for ((lambda, left), (along, image)) in
                lambda.iter_mut().zip(&mut left).zip(along.iter().zip(&image))
            {
                *lambda += along * step;
                *left -= image * step;
            }
            let next = eased(&left);
            let new = dot(&left, &next);
            for (along, next) in along.iter_mut().zip(&next) {
                *along = next + *along * (new / size);
            }
            size = new;
        }
        lambda
    }

    /// The left side of the system.
    fn bend(&self, volumes: &[f64], lambda: &[Vector<D>]) -> Vec<Vector<D>> {
        let slope = self.slope(lambda);
        each(lambda.len(), |j| {
            let sum: Vector<D> = (self.of(j).iter())
                .map(|bond| {
                    let i = bond.j as usize;
                    ((lambda[j] - lambda[i]) * 2.0 + (slope[i] + slope[j]) * bond.x) * bond.f
                })
                .sum();
            sum * volumes[j]
        })
    }

    /// The corrected gradient.
    fn slope(&self, lambda: &[Vector<D>]) -> Vec<Matrix<D>> {
        each(lambda.len(), |i| {
            let rise = |bond: &Bond<D>| lambda[bond.j as usize] - lambda[i];
            self.of(i).iter().map(|bond| dyad(&(rise(bond) * bond.f), &bond.x)).sum::<Matrix<D>>()
                * self.correction[i]
        })
    }
}

impl<const D: usize> Elastic<D> {
    /// First pass: F, P and the fit F' of all particles.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] for a particle that is turned inside out.
    pub(super) fn strain_consistent(&mut self) -> Result<(), RunError> {
        let (bonds, u, material) = (&self.bonds, &self.displacements, &self.material);
        let (softness, growth) = (&self.softness, self.growth.as_deref());
        let one = |i: usize, out: &mut Strain<D>, fitted: &mut Matrix<D>| -> bool {
            let here = u[i];
            let (mut f, mut fit) = (Matrix::<D>::identity(), Matrix::<D>::zeros());
            for (bond, ends) in bonds.of(i).iter().zip(bonds.ends_of(i)) {
                let rise = u[bond.j as usize] - here;
                f += dyad(&rise, &ends.own);
                fit += dyad(&(rise * bond.f), &bond.x);
            }
            *fitted = Matrix::<D>::identity() + fit * bonds.correction[i];
            let back = growth.map_or_else(Matrix::identity, |growth| growth[i]);
            let elastic = f * back;
            let whole = determinant(&elastic) > 0.0;
            let pull = if whole {
                material.stress(&elastic, softness[i]) * back.transpose() / determinant(&back)
            } else {
                Matrix::zeros()
            };
            *out = Strain { f, pull };
            whole
        };
        let inverted = (self.strains.par_chunks_mut(CHUNK).zip(self.fits.par_chunks_mut(CHUNK)).enumerate())
            .map(|(chunk, (strains, fits))| {
                let mut fault = None;
                for (row, (out, fit)) in strains.iter_mut().zip(fits).enumerate() {
                    let i = chunk * CHUNK + row;
                    if !one(i, out, fit) && fault.is_none() {
                        fault = Some(i);
                    }
                }
                fault
            })
            .reduce(|| None, Option::or);
        inverted.map_or(Ok(()), |i| Err(self.inverted(i)))
    }

    /// Second pass: the forces.
    pub(super) fn pull_consistent(&mut self) {
        let (bonds, u, strains, fits) = (&self.bonds, &self.displacements, &self.strains, &self.fits);
        let (softness, velocities, volumes) = (&self.softness, &self.velocities, &self.volumes);
        let hourglass = FIT * self.options.hourglass * self.material.young();
        let viscosity = self.options.viscosity;
        self.forces.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, forces)| {
            for (row, out) in forces.iter_mut().enumerate() {
                let i = chunk * CHUNK + row;
                let (here, pull, fit, soft) = (u[i], strains[i].pull, fits[i], softness[i]);
                let mut force: Vector<D> = Vector::zeros();
                for (bond, ends) in bonds.of(i).iter().zip(bonds.ends_of(i)) {
                    let j = bond.j as usize;
                    force += pull * ends.own - strains[j].pull * ends.other;
                    let x = bond.x + (u[j] - here);
                    let lack = (fit * bond.x - x) * soft + (fits[j] * bond.x - x) * softness[j];
                    force -= lack * (hourglass * bond.f);
                    if viscosity > 0.0 {
                        let along = viscosity * (velocities[j] - velocities[i]).dot(&x);
                        force += x * (along * bond.w / x.norm_squared());
                    }
                }
                *out = force * volumes[i];
            }
        });
        self.tally.bond_evaluations += self.bonds.count() as u64;
    }
}

/// A value for every particle.
fn each<T: Send>(n: usize, of: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    (0..n).into_par_iter().with_min_len(CHUNK).map(of).collect()
}
