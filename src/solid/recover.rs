//! Stress of a wall, recovered: a straight line through the stresses of a particle and all it is bound to.
//!
//! The stress of one particle of a thin wall carries an error that alternates from layer to layer; a linear fit over the
//! neighbourhood takes it out and keeps every linear field (as the patch recovery of Zienkiewicz & Zhu 1992). The
//! stresses of neighbours are first turned by the least rotation that takes their normal to that of the particle, so that
//! curvature counts for nothing.

use nalgebra::{Matrix3, Vector3};

use crate::solid::elastic::Elastic;
use crate::solid::shell::Wall;
use crate::solid::surface::normals;
use crate::space::matrix::{Matrix, determinant, dyad, inverse};
use crate::vector::Vector;

impl<const D: usize> Wall<D> {
    /// Outward normals of the columns, from the mean of their layers.
    #[must_use]
    pub fn normals(&self, solid: &Elastic<D>) -> Vec<Vector<D>> {
        normals(&self.middle(|i| solid.position(i)), &self.faces)
    }

    /// Cauchy stress of every particle, Pa, recovered; `normals` those of the columns.
    #[must_use]
    pub fn stresses(&self, solid: &Elastic<D>, normals: &[Vector<D>]) -> Vec<Matrix3<f64>> {
        let raw: Vec<Matrix3<f64>> = (0..solid.len()).map(|i| solid.stress(i)).collect();
        (0..solid.len())
            .map(|i| {
                let (here, normal) = (solid.position(i), space(&normals[i / self.layers]));
                let turned = |j: usize| {
                    let turn = least_turn(&space(&normals[j / self.layers]), &normal);
                    turn * raw[j] * turn.transpose()
                };
                let others = || solid.bonds.of(i).iter().map(|bond| bond.j as usize);
                let count = (1 + others().count()) as f64;
                let mean = (raw[i] + others().map(turned).sum::<Matrix3<f64>>()) / count;
                let centre = others().map(|j| solid.position(j) - here).sum::<Vector<D>>() / count;
                let mut moment: Matrix<D> = dyad(&centre, &centre);
                for j in others() {
                    let x = solid.position(j) - here - centre;
                    moment += dyad(&x, &x);
                }
                if determinant(&moment) <= 0.0 {
                    return raw[i];
                }
                // The fit at zero is the mean and Σ (σ_j - mean) x_j·M⁻¹(-centre).
                let slope = -inverse(&moment) * centre;
                let own = (raw[i] - mean) * -centre.dot(&slope);
                let rest: Matrix3<f64> = others()
                    .map(|j| (turned(j) - mean) * (solid.position(j) - here - centre).dot(&slope))
                    .sum();
                mean + own + rest
            })
            .collect()
    }
}

/// The vector in space.
#[must_use]
pub(super) fn space<const D: usize>(v: &Vector<D>) -> Vector3<f64> {
    Vector3::from_fn(|k, _| if k < D { v[k] } else { 0.0 })
}

/// The least rotation that takes the unit vector `a` to `b`, which does not point the other way.
#[must_use]
pub(super) fn least_turn(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    let v = a.cross(b).cross_matrix();
    Matrix3::identity() + v + v * v / (1.0 + a.dot(b)).max(1e-6)
}
