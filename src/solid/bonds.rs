//! Who is bound to whom in the undeformed solid, and how strongly.
//!
//! A total-Lagrangian solid keeps its neighbours for good: they are found once, at rest. With X_ij = X_j - X_i and
//! F = -W'/R the gradient of the kernel is ∇W0_ij = F X_ij, and the deformation gradient
//!
//! ```text
//! F_i = 1 + Σ_j V_j (u_j - u_i)⊗∇W0_ij B_i,    B_i = [Σ_j V_j F X_ij⊗X_ij]⁻¹
//! ```
//!
//! is exact for every linear displacement (Randles & Libersky 1996; Bonet & Lok 1999).

use crate::error::RunError;
use crate::solid::consistent::Ends;
use crate::space::matrix::{Matrix, determinant, dyad, inverse};
use crate::space::{Domain, Grid, Kernel};
use crate::vector::Vector;

/// What a particle is bound to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond<const D: usize> {
    pub j: u32,
    /// X_ij = X_j - X_i, m.
    pub x: Vector<D>,
    /// V_j F, 1/m².
    pub f: f64,
    /// V_j W0/R², 1/m².
    pub w: f64,
}

/// The bonds of all particles of a solid, particle by particle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bonds<const D: usize> {
    offsets: Vec<u32>,
    bonds: Vec<Bond<D>>,
    /// B_i, m^0: the correction of the gradient.
    pub correction: Vec<Matrix<D>>,
    /// Gradients that are consistent with the surface, bond by bond; none where they are not asked for.
    pub(super) ends: Vec<Ends<D>>,
}

impl<const D: usize> Bonds<D> {
    /// Finds the bonds of particles at `places` (m) with `volumes` (m^D) and the kernel.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] for a particle whose neighbours do not span all directions.
    pub fn new(
        places: &[Vector<D>],
        volumes: &[f64],
        domain: &Domain<D>,
        kernel: &Kernel<D>,
    ) -> Result<Bonds<D>, RunError> {
        Bonds::each(places, volumes, domain, kernel.cutoff(), |_, _| *kernel)
    }

    /// Finds the bonds where every pair has a kernel of its own, the same from both sides; none reaches beyond `widest`
    /// (m).
    ///
    /// # Errors
    /// As [`Bonds::new`].
    pub fn each(
        places: &[Vector<D>],
        volumes: &[f64],
        domain: &Domain<D>,
        widest: f64,
        kernel: impl Fn(usize, usize) -> Kernel<D>,
    ) -> Result<Bonds<D>, RunError> {
        let grid = Grid::build(places, domain, widest);
        let mut all = Bonds {
            offsets: vec![0],
            bonds: Vec::new(),
            correction: Vec::with_capacity(places.len()),
            ends: Vec::new(),
        };
        for (i, place) in places.iter().enumerate() {
            let start = all.bonds.len();
            let mut moment = Matrix::<D>::zeros();
            grid.for_each_near(place, places, |j, away, r2| {
                let r = r2.sqrt();
                let kernel = kernel(i, j);
                if j == i || r >= kernel.cutoff() {
                    return;
                }
                let (x, f) = (-away, volumes[j] * kernel.f(r));
                moment += dyad(&x, &x) * f;
                all.bonds.push(Bond { j: j as u32, x, f, w: volumes[j] * kernel.value(r) / r2 });
            });
            all.bonds[start..].sort_unstable_by_key(|bond| bond.j);
            all.offsets.push(all.bonds.len() as u32);
            // Of a full neighbourhood the moment is about one.
            let span = determinant(&moment);
            if span.is_nan() || span <= 1e-3_f64.powi(D as i32) {
                return Err(RunError::BlowUp {
                    step: 0,
                    time: 0.0,
                    particle: i,
                    quantity: "span of the neighbours of a solid particle".into(),
                    value: span,
                    remedy: "the solid is too thin for its spacing here: give it a smaller spacing, or a larger support".into(),
                });
            }
            all.correction.push(inverse(&moment));
        }
        Ok(all)
    }

    /// The bonds of particle `i`.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, i: usize) -> &[Bond<D>] {
        &self.bonds[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// Whether the gradients are those of [`Bonds::consist`].
    #[inline(always)]
    pub(super) fn is_consistent(&self) -> bool {
        !self.ends.is_empty()
    }

    /// The consistent gradients of the bonds of particle `i`, in their order.
    #[inline(always)]
    pub(super) fn ends_of(&self, i: usize) -> &[Ends<D>] {
        &self.ends[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// Bonds in all, each from both sides.
    #[must_use]
    pub fn count(&self) -> usize {
        self.bonds.len()
    }
}
