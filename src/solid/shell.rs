//! Closed walls built column by column: rings in 2D, spherical shells in 3D.
//!
//! A column stands on each node of a closed mesh of the unit sphere and holds one particle a layer; particle number =
//! column · layers + layer, layer 0 inside. Nodes in 3D are those of a geodesic sphere (icosahedron, class I).

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use crate::vector::Vector;

/// Which particles of a solid are a closed wall, and how its columns hang together.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Wall<const D: usize> {
    pub layers: usize,
    /// Columns joined by a face of the mesh (an edge in 2D, a triangle in 3D), anticlockwise seen from outside.
    #[serde(with = "faces")]
    pub faces: Vec<[u32; D]>,
    /// Number of columns.
    pub columns: usize,
}

/// A wall and the particles it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Built<const D: usize> {
    pub wall: Wall<D>,
    /// Layer mid-radii on the columns, m.
    pub places: Vec<Vector<D>>,
    /// Exact volumes of the sectors, m^D; their sum is that of the shell.
    pub volumes: Vec<f64>,
}

/// Faces as a flat list: serde knows no arrays of `D`.
mod faces {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<const D: usize, S: Serializer>(
        faces: &[[u32; D]],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        faces.concat().serialize(serializer)
    }

    pub fn deserialize<'de, const D: usize, T: Deserializer<'de>>(
        from: T,
    ) -> Result<Vec<[u32; D]>, T::Error> {
        let flat: Vec<u32> = Vec::deserialize(from)?;
        Ok(flat.chunks_exact(D).map(|face| std::array::from_fn(|k| face[k])).collect())
    }
}

impl<const D: usize> Wall<D> {
    /// Number of the particle in a layer of a column.
    #[inline]
    #[must_use]
    pub fn particle(&self, column: usize, layer: usize) -> usize {
        column * self.layers + layer
    }

    /// A ring (2D) or spherical shell (3D) of radii `inner` and `outer` (m), particles about `spacing` (m) apart. At
    /// least three layers.
    #[must_use]
    pub fn round(centre: &Vector<D>, inner: f64, outer: f64, spacing: f64) -> Built<D> {
        let layers = (((outer - inner) / spacing).round() as usize).max(3);
        let (directions, faces) = sphere::<D>(0.5 * (inner + outer) / spacing);
        let angles = solid_angles(&directions, &faces);
        let thickness = (outer - inner) / layers as f64;
        let dimension = D as i32;
        let (mut places, mut volumes) = (Vec::new(), Vec::new());
        for (direction, angle) in directions.iter().zip(&angles) {
            for layer in 0..layers {
                let r = inner + layer as f64 * thickness;
                places.push(centre + direction * (r + 0.5 * thickness));
                volumes.push(angle * ((r + thickness).powi(dimension) - r.powi(dimension)) / D as f64);
            }
        }
        Built { wall: Wall { layers, faces, columns: directions.len() }, places, volumes }
    }
}

/// Nodes and faces of the unit sphere such that on a radius of `radius` spacings each node owns about one spacing
/// squared (in 2D: one spacing).
fn sphere<const D: usize>(radius: f64) -> (Vec<Vector<D>>, Vec<[u32; D]>) {
    if D == 2 {
        let n = ((TAU * radius).round() as u32).max(8);
        let angle = |i: u32| TAU * f64::from(i) / f64::from(n);
        let nodes = (0..n).map(|i| Vector::from_fn(|k, _| [angle(i).cos(), angle(i).sin()][k])).collect();
        return (nodes, (0..n).map(|i| std::array::from_fn(|k| [i, (i + 1) % n][k])).collect());
    }
    let frequency = (((4.0 * PI * radius * radius - 2.0) / 10.0).max(4.0).sqrt().round() as u32).max(2);
    let (nodes, faces) = geodesic(frequency);
    let to = |node: &Vector<3>| Vector::from_fn(|k, _| node[k]);
    (nodes.iter().map(to).collect(), faces.iter().map(|face| std::array::from_fn(|k| face[k])).collect())
}

/// The geodesic sphere of a frequency f: 10 f² + 2 nodes, 20 f² triangles.
fn geodesic(frequency: u32) -> (Vec<Vector<3>>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners: Vec<Vector<3>> = Vec::with_capacity(12);
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        for turn in 0..3 {
            corners.push(Vector::<3>::from_fn(|k, _| [0.0, a, b][(k + turn) % 3]));
        }
    }
    // Corners of the icosahedron are two apart.
    let near = |a: usize, b: usize| (corners[a] - corners[b]).norm() < 2.1;
    let (mut nodes, mut faces) = (Vec::new(), Vec::new());
    let mut known = BTreeMap::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if !(near(a, b) && near(b, c) && near(a, c)) {
                    continue;
                }
                let outside = corners[a].dot(&corners[b].cross(&corners[c])) > 0.0;
                let corner = if outside { [a, b, c] } else { [a, c, b] };
                let mut node = |i: u32, j: u32| {
                    let weights = [frequency - i - j, i, j];
                    let mut key: Vec<(usize, u32)> =
                        corner.iter().copied().zip(weights).filter(|one| one.1 > 0).collect();
                    key.sort_unstable();
                    *known.entry(key).or_insert_with_key(|key| {
                        // In the order of the corners' numbers, so that a node of two faces is the same from both.
                        let sum: Vector<3> =
                            key.iter().map(|&(at, weight)| corners[at] * f64::from(weight)).sum();
                        nodes.push(sum.normalize());
                        nodes.len() as u32 - 1
                    })
                };
                for i in 0..frequency {
                    for j in 0..frequency - i {
                        faces.push([node(i, j), node(i + 1, j), node(i, j + 1)]);
                        if i + j + 2 <= frequency {
                            faces.push([node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
                        }
                    }
                }
            }
        }
    }
    (nodes, faces)
}

/// The angle (2D) or solid angle (3D) of each node: half or a third of that of its faces.
fn solid_angles<const D: usize>(nodes: &[Vector<D>], faces: &[[u32; D]]) -> Vec<f64> {
    let mut angles = vec![0.0; nodes.len()];
    for face in faces {
        let at = face.map(|node| &nodes[node as usize]);
        let angle = if D == 2 {
            at[0].dot(at[1]).clamp(-1.0, 1.0).acos()
        } else {
            // Van Oosterom & Strackee 1983.
            let (a, b, c) = (at[0], at[1], at[2]);
            let volume =
                crate::space::matrix::determinant::<D>(&nalgebra::SMatrix::from_columns(&at.map(|v| *v)));
            2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
        };
        for &node in face {
            angles[node as usize] += angle / D as f64;
        }
    }
    angles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volumes_add_up_to_the_shell() {
        let ring = Wall::<2>::round(&Vector::zeros(), 7.5, 10.0, 0.625);
        assert_eq!((ring.wall.layers, ring.wall.columns), (4, 88));
        assert_eq!(ring.places.len(), 352);
        // Rounding of the sums.
        assert!((ring.volumes.iter().sum::<f64>() / (PI * (100.0 - 56.25)) - 1.0).abs() < 1e-13);
        let shell = Wall::<3>::round(&Vector::zeros(), 7.5, 10.0, 0.625);
        let exact = 4.0 / 3.0 * PI * (1000.0 - 421.875);
        assert!((shell.volumes.iter().sum::<f64>() / exact - 1.0).abs() < 1e-13);
        assert_eq!(shell.wall.columns, 10 * 16 * 16 + 2);
    }

    #[test]
    fn a_geodesic_sphere_is_closed() {
        for frequency in [1, 2, 5] {
            let (nodes, faces) = geodesic(frequency);
            let f = frequency as usize;
            assert_eq!((nodes.len(), faces.len()), (10 * f * f + 2, 20 * f * f));
            // Every edge once in each direction.
            let mut edges: Vec<(u32, u32)> =
                faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
            edges.sort_unstable();
            let count = edges.len();
            edges.dedup();
            assert_eq!(edges.len(), count);
            assert!(edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok()));
            assert!(faces.iter().all(|&[a, b, c]| {
                let at = [a, b, c].map(|i| nodes[i as usize]);
                at[0].dot(&at[1].cross(&at[2])) > 0.0
            }));
        }
    }
}
