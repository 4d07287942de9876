//! Conductances where the voxels of a species end and no image stands for what is missing: the skin of a moving solid,
//! a wall of few layers, a membrane one voxel thick.
//!
//! One number per voxel, the lattice bias α, takes the neighbours to stand evenly all round. In a sheet they do not, and
//! molecules would run along it too fast: twice as fast in a line of voxels in the plane, by a fifth in three layers.
//! Next to an edge the weights of a voxel are therefore F_ij A_i:(e⊗e), e = x_ij/|x_ij|, with
//!
//! ```text
//! Σ_j V_j F_ij r_ij² (A_i:(e⊗e)) e⊗e = 1 - (c/2) n⊗n,    c = |Σ_j V_j F_ij x_ij| / Σ_j V_j F_ij |x_ij·n|,
//! ```
//!
//! n the direction without neighbours (c counts as max(0, 2c - 1): neighbours that are only uneven are no edge): along the
//! edge conductance is that of a full neighbourhood, across it half of that where all neighbours stand on one side, as
//! between the first two cells of a row. Of directions in which there is no neighbour (those across a sheet) nothing is
//! asked. A pair takes the mean of its two sides.

use crate::fluid::exchange::WHOLE;
use crate::space::matrix::{Matrix, dyad, embed};
use crate::vector::Vector;

/// Independent entries of a symmetric matrix of three rows.
const ENTRIES: usize = 6;
/// Of directions that count less than this part of all nothing is asked.
const UNSEEN: f64 = 0.01;
/// A weight is at least this part of the one without regard to direction.
const LEAST: f64 = 0.1;
/// One-sidedness of the neighbours from which on a voxel of little α is at an edge, and the least second moment along any
/// axis below which it is: a lattice has 1, half of one 0.5; where voxels are scattered α may be small with neighbours
/// all round.
const ONE_SIDED: f64 = 0.75;
const THIN: f64 = 0.3;
/// Stands for a voxel that is at no edge.
const NONE: u32 = u32::MAX;

/// c of a voxel, from |Σ V F x| and Σ V F |x·n|.
fn one_sided(pull: f64, across: f64) -> f64 {
    if across > 0.0 { (pull / across).min(1.0) } else { 0.0 }
}

/// Voxels whose neighbours end where no image stands for what is missing, of biases `alpha` and sums `pull` of V F x; `each`
/// hands over voxel, V F and x of all neighbours.
pub(super) fn bare<const D: usize>(
    hosts: &[bool],
    alpha: &[f64],
    pull: &[Vector<D>],
    each: impl FnOnce(&mut dyn FnMut(usize, f64, &Vector<D>)),
) -> Vec<bool> {
    let mut found: Vec<bool> =
        alpha.iter().zip(hosts).map(|(alpha, host)| *host && *alpha <= WHOLE).collect();
    if !found.contains(&true) {
        return found;
    }
    let normal: Vec<Vector<D>> = pull.iter().map(|b| b / b.norm().max(f64::MIN_POSITIVE)).collect();
    let mut sums = vec![(Matrix::<D>::zeros(), 0.0); alpha.len()];
    each(&mut |i, weight, x| {
        if found[i] {
            let (second, across) = &mut sums[i];
            *second += dyad(x, x) * weight;
            *across += weight * x.dot(&normal[i]).abs();
        }
    });
    for i in (0..alpha.len()).filter(|&i| alpha[i] <= WHOLE) {
        let (second, across) = &sums[i];
        let thin = D > 1 && embed(second, 1.0).symmetric_eigenvalues().min() < THIN;
        found[i] &= thin || one_sided(pull[i].norm(), *across) > ONE_SIDED;
    }
    found
}

/// Voxels at an edge, and their tensors A.
pub(super) struct Edges<const D: usize> {
    rank: Vec<u32>,
    edges: Vec<Edge<D>>,
}

#[derive(Clone)]
struct Edge<const D: usize> {
    /// Σ V F r² s⊗s with s the entries of e⊗e.
    fourth: [[f64; ENTRIES]; ENTRIES],
    /// Where neighbours are missing, a unit vector or none.
    normal: Vector<D>,
    /// |Σ V F x| and Σ V F |x·n|.
    pull: f64,
    across: f64,
    /// Entries of A.
    tensor: [f64; ENTRIES],
}

impl<const D: usize> Edges<D> {
    /// The voxels that `at_edge` says; `pull` is Σ V F (x_i - x_j) of each.
    pub fn new(at_edge: &[bool], pull: &[Vector<D>]) -> Edges<D> {
        let mut rank = vec![NONE; at_edge.len()];
        let mut edges = Vec::new();
        for i in (0..at_edge.len()).filter(|&i| at_edge[i]) {
            rank[i] = edges.len() as u32;
            let size = pull[i].norm();
            edges.push(Edge {
                fourth: [[0.0; ENTRIES]; ENTRIES],
                normal: if size > 0.0 { pull[i] / size } else { Vector::zeros() },
                pull: size,
                across: 0.0,
                tensor: [0.0; ENTRIES],
            });
        }
        Edges { rank, edges }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// Takes a neighbour of voxel `i` into account: `weight` is V_j F_ij, `x` the way to it (m, either sense).
    #[inline]
    pub fn add(&mut self, i: usize, weight: f64, x: &Vector<D>) {
        let Some(edge) = self.edges.get_mut(self.rank[i] as usize) else { return };
        let r2 = x.norm_squared();
        let s = entries(x, r2);
        for (row, a) in edge.fourth.iter_mut().zip(s).take(count(D)) {
            for (cell, b) in row.iter_mut().zip(s).take(count(D)) {
                *cell += weight * r2 * a * b;
            }
        }
        edge.across += weight * x.dot(&edge.normal).abs();
    }

    /// Finds A when all neighbours are known.
    pub fn solve(&mut self) {
        for edge in &mut self.edges {
            let one_sided = (2.0 * one_sided(edge.pull, edge.across) - 1.0).max(0.0);
            let wanted = Matrix::<D>::identity() - dyad(&edge.normal, &edge.normal) * (0.5 * one_sided);
            let mut right = [0.0; ENTRIES];
            for (entry, (a, b)) in right.iter_mut().zip(pairs::<D>()) {
                *entry = wanted[(a, b)] * if a == b { 1.0 } else { std::f64::consts::SQRT_2 };
            }
            edge.tensor = match D {
                1 => solved::<1>(&edge.fourth, &right),
                2 => solved::<3>(&edge.fourth, &right),
                _ => solved::<6>(&edge.fourth, &right),
            };
        }
    }

    /// Factor on F of a pair of biases `alpha`, times which the mean bias gives the weight that is meant: with `x` as
    /// voxel i sees it and as j does. `None` if neither is at an edge.
    #[inline]
    pub fn factor(&self, [i, j]: [usize; 2], x: [&Vector<D>; 2], alpha: [f64; 2]) -> Option<f64> {
        if self.rank[i] == NONE && self.rank[j] == NONE {
            return None;
        }
        let mean = 0.5 * (alpha[0] + alpha[1]);
        let of = |k: usize, x: &Vector<D>, alpha: f64| match self.edges.get(self.rank[k] as usize) {
            None => mean / alpha,
            Some(edge) => {
                let s = entries(x, x.norm_squared());
                mean * s.iter().zip(edge.tensor).map(|(s, a)| s * a).sum::<f64>()
            }
        };
        Some((0.5 * (of(i, x[0], alpha[0]) + of(j, x[1], alpha[1]))).max(LEAST))
    }
}

/// Independent entries of a symmetric matrix of `d` rows.
const fn count(d: usize) -> usize {
    d * (d + 1) / 2
}

/// Their rows and columns.
fn pairs<const D: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..D).flat_map(|a| (a..D).map(move |b| (a, b)))
}

/// Entries of e⊗e, e = x/|x|, such that products of matrices are those of their entries.
#[inline]
fn entries<const D: usize>(x: &Vector<D>, r2: f64) -> [f64; ENTRIES] {
    let mut out = [0.0; ENTRIES];
    if r2 > 0.0 {
        for (entry, (a, b)) in out.iter_mut().zip(pairs::<D>()) {
            *entry = x[a] * x[b] / r2 * if a == b { 1.0 } else { std::f64::consts::SQRT_2 };
        }
    }
    out
}

/// The solution of `m` a = `right` in the leading K entries; what `m` hardly knows is left out smoothly: the least of
/// |m a - right|² + least² |a|².
fn solved<const K: usize>(m: &[[f64; ENTRIES]; ENTRIES], right: &[f64; ENTRIES]) -> [f64; ENTRIES] {
    let matrix = nalgebra::SMatrix::<f64, K, K>::from_fn(|a, b| m[a][b]);
    let right = nalgebra::SVector::<f64, K>::from_fn(|a, _| right[a]);
    let least = UNSEEN * matrix.trace();
    let mut square = matrix * matrix;
    for a in 0..K {
        square[(a, a)] += least * least;
    }
    let mut out = [0.0; ENTRIES];
    // None only for a voxel without neighbours.
    if let Some(found) = nalgebra::Cholesky::new(square) {
        let entries = found.solve(&(matrix * right));
        out.iter_mut().zip(entries.iter()).for_each(|(out, entry)| *out = *entry);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::Links;
    use crate::fluid::exchange::{Voxels, links};
    use crate::fluid::weights::Weights;
    use crate::space::domain::Domain;
    use crate::space::kernel::{Kernel, KernelKind};

    /// A lattice of spacing one, `layers` deep along the last axis in an otherwise empty box, turned by `angle` in the
    /// plane of the first and the last axis about its middle; its links for a cut-off of `reach`.
    fn slab<const D: usize>(layers: usize, reach: f64, angle: f64) -> (Vec<Vector<D>>, Links) {
        let side = 16_usize;
        let middle = |k: usize| 0.5 * (if k + 1 == D { layers as f64 } else { side as f64 } - 1.0);
        let (sin, cos) = angle.sin_cos();
        let places: Vec<Vector<D>> = (0..layers * side.pow(D as u32 - 1))
            .map(|n| {
                let mut x = Vector::<D>::from_fn(|k, _| {
                    let cells = n / side.pow(k as u32);
                    let cell = if k + 1 == D { cells } else { cells % side };
                    cell as f64 - middle(k)
                });
                (x[0], x[D - 1]) = (cos * x[0] - sin * x[D - 1], sin * x[0] + cos * x[D - 1]);
                x
            })
            .collect();
        let far = Vector::<D>::repeat(40.0);
        let domain = Domain { min: -far, max: far, periodic: [false; D] };
        let ones = vec![1.0; places.len()];
        let hosts = vec![true; places.len()];
        let voxels = Voxels {
            positions: &places,
            volumes: &ones,
            hosts: &hosts,
            domain: &domain,
            barriers: &[],
            obstacles: &[],
        };
        let found = links(&voxels, &Kernel::new(KernelKind::Lucy, reach), Weights::Normalised, 1.0);
        (places, found)
    }

    /// Diffusivity along the sheet, and conductance between the first two layers over that of two cells: one.
    fn seen<const D: usize>(layers: usize, reach: f64, angle: f64) -> (f64, f64) {
        let (places, links) = slab::<D>(layers, reach, angle);
        let (sin, cos) = angle.sin_cos();
        let flat = |x: &Vector<D>| (cos * x[0] + sin * x[D - 1], cos * x[D - 1] - sin * x[0]);
        let (mut along, mut across, mut count) = (0.0, 0.0, 0.0);
        for (i, x) in places.iter().enumerate() {
            let (s, depth) = flat(x);
            let inside = s.abs() < 1.0 && (1..D - 1).all(|k| x[k].abs() < 1.0);
            if !inside {
                continue;
            }
            count += 1.0;
            for (j, g) in links.row(i) {
                let (t, other) = flat(&places[j]);
                along += 0.5 * g * (s - t) * (s - t);
                let layer = |depth: f64| (depth + 0.5 * (layers as f64 - 1.0)).round();
                if layer(depth) == 0.0 && layer(other) > 0.0 {
                    across += g * (other - depth);
                }
            }
        }
        (along / count, across * layers as f64 / count)
    }

    /// Without regard to direction diffusion along one layer is twice as fast in the plane and 3/2 in space, along
    /// three layers by 20 and 12 %, along six by 8 and 5 %.
    #[test]
    fn along_a_sheet_molecules_diffuse_as_they_should() {
        for angle in [0.0, 0.4] {
            for reach in [2.0, 3.0] {
                for layers in [1, 2, 3, 6] {
                    let (plane, space) = (seen::<2>(layers, reach, angle), seen::<3>(layers, reach, angle));
                    for (along, across) in [plane, space] {
                        let what = format!("{layers} layers, cut-off {reach}: {along}, across {across}");
                        // What is left out of directions without neighbours.
                        assert!((along - 1.0).abs() < 3e-3, "{what}");
                        // Cut-offs of several layers blur the edge.
                        assert!(layers == 1 || (across - 1.0).abs() < 0.2, "{what}");
                    }
                }
            }
        }
    }
}
