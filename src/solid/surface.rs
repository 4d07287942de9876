//! The surfaces of a wall: nodes beyond its last layers, the volume inside, and its exact slope.
//!
//! ```text
//! s = 3/2 x_0 - 1/2 x_1,     V = 1/D Σ_faces A·s,     dV/ds = Σ_faces at s A/D
//! ```
//!
//! with A the area vector of a face. The slope is exact because the mesh is closed.

use crate::solid::shell::Wall;
use crate::vector::Vector;

/// How far the outermost layers are continued: half a layer.
pub const BEYOND: [f64; 2] = [1.5, -0.5];

impl<const D: usize> Wall<D> {
    /// Nodes of the inner surface, m, for particles at `places`.
    #[must_use]
    pub fn inner(&self, places: impl Fn(usize) -> Vector<D>) -> Vec<Vector<D>> {
        self.between(0, 1, places)
    }

    /// Nodes of the outer surface, m.
    #[must_use]
    pub fn outer(&self, places: impl Fn(usize) -> Vector<D>) -> Vec<Vector<D>> {
        self.between(self.layers - 1, self.layers - 2, places)
    }

    /// Nodes of the mean of all layers, m.
    #[must_use]
    pub fn middle(&self, places: impl Fn(usize) -> Vector<D>) -> Vec<Vector<D>> {
        (0..self.columns)
            .map(|column| {
                (0..self.layers).map(|layer| places(self.particle(column, layer))).sum::<Vector<D>>()
                    / self.layers as f64
            })
            .collect()
    }

    fn between(&self, last: usize, before: usize, places: impl Fn(usize) -> Vector<D>) -> Vec<Vector<D>> {
        let at = |column, layer| places(self.particle(column, layer));
        (0..self.columns).map(|c| at(c, last) * BEYOND[0] + at(c, before) * BEYOND[1]).collect()
    }

    /// The area vector of the body's surface each particle carries, m^(D-1), outward: that of the nodes it takes part in.
    /// Scaled so that its moment is the sum of the volumes (m^D), from which meshes with flat faces differ a little.
    #[must_use]
    pub fn skin(&self, places: &[Vector<D>], volumes: &[f64]) -> Vec<Vector<D>> {
        let (inner, outer) = (self.inner(|i| places[i]), self.outer(|i| places[i]));
        let between = volume(&outer, &self.faces) - volume(&inner, &self.faces);
        let scale = volumes.iter().sum::<f64>() / between;
        let mut skin = vec![Vector::zeros(); places.len()];
        for (layers, nodes, sign) in
            [([0, 1], inner, -scale), ([self.layers - 1, self.layers - 2], outer, scale)]
        {
            for (column, slope) in slopes(&nodes, &self.faces).iter().enumerate() {
                for (layer, part) in layers.into_iter().zip(BEYOND) {
                    skin[self.particle(column, layer)] += slope * (sign * part);
                }
            }
        }
        skin
    }

    /// The edges of the mesh, each once, smaller column first, in order.
    #[must_use]
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = self
            .faces
            .iter()
            .flat_map(|face| {
                (0..D).map(|k| {
                    let (a, b) = (face[k], face[(k + 1) % D]);
                    [a.min(b), a.max(b)]
                })
            })
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

/// The area vector of a face, m^(D-1), outward.
#[must_use]
pub fn area_vector<const D: usize>(nodes: &[Vector<D>], face: &[u32; D]) -> Vector<D> {
    let at = face.map(|node| nodes[node as usize]);
    let a = at[1] - at[0];
    if D == 2 {
        return Vector::from_fn(|k, _| [a[1], -a[0]][k]);
    }
    let b = at[D - 1] - at[0];
    Vector::from_fn(|k, _| {
        let (p, q) = ((k + 1) % 3, (k + 2) % 3);
        0.5 * (a[p] * b[q] - a[q] * b[p])
    })
}

/// The volume inside a closed surface, m^D.
#[must_use]
pub fn volume<const D: usize>(nodes: &[Vector<D>], faces: &[[u32; D]]) -> f64 {
    // From the middle, for the sake of rounding.
    let centre = nodes.iter().sum::<Vector<D>>() / nodes.len().max(1) as f64;
    let of = |face: &[u32; D]| area_vector(nodes, face).dot(&(nodes[face[0] as usize] - centre));
    faces.iter().map(of).sum::<f64>() / D as f64
}

/// dV/ds of every node, m^(D-1): its area vector.
#[must_use]
pub fn slopes<const D: usize>(nodes: &[Vector<D>], faces: &[[u32; D]]) -> Vec<Vector<D>> {
    let mut slopes = vec![Vector::zeros(); nodes.len()];
    for face in faces {
        let share = area_vector(nodes, face) / D as f64;
        for &node in face {
            slopes[node as usize] += share;
        }
    }
    slopes
}

/// The outward normal at every node.
#[must_use]
pub fn normals<const D: usize>(nodes: &[Vector<D>], faces: &[[u32; D]]) -> Vec<Vector<D>> {
    let unit = |slope: Vector<D>| slope / slope.norm().max(f64::MIN_POSITIVE);
    slopes(nodes, faces).into_iter().map(unit).collect()
}

/// The area (in 2D: length) of a surface, m^(D-1).
#[must_use]
pub fn area<const D: usize>(nodes: &[Vector<D>], faces: &[[u32; D]]) -> f64 {
    faces.iter().map(|face| area_vector(nodes, face).norm()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn bumpy<const D: usize>() -> (Vec<Vector<D>>, Vec<[u32; D]>) {
        let built = Wall::<D>::round(&Vector::from_element(3.0), 0.8, 1.2, 0.1);
        let middle = built.wall.middle(|i| {
            let x = built.places[i];
            Vector::from_fn(|k, _| x[k] + 0.1 * (2.0 * x[(k + 1) % D]).sin())
        });
        (middle, built.wall.faces)
    }

    fn slope_is_exact<const D: usize>() {
        let (nodes, faces) = bumpy::<D>();
        let slopes = slopes(&nodes, &faces);
        let d = 1e-5;
        for node in [0, 5, 17] {
            for k in 0..D {
                let moved = |by: f64| {
                    let mut nodes = nodes.clone();
                    nodes[node][k] += by;
                    volume(&nodes, &faces)
                };
                let slope = (moved(d) - moved(-d)) / (2.0 * d);
                // Rounding of the volume over the step.
                assert!((slope - slopes[node][k]).abs() < 1e-9, "{D} {node} {k}");
            }
        }
        assert!(slopes.iter().sum::<Vector<D>>().norm() < 1e-13);
    }

    #[test]
    fn area_vectors_are_the_slope_of_the_volume() {
        slope_is_exact::<2>();
        slope_is_exact::<3>();
    }

    #[test]
    fn a_sphere_has_its_volume_and_area() {
        let built = Wall::<3>::round(&Vector::zeros(), 0.9, 1.1, 0.05);
        let nodes = built.wall.middle(|i| built.places[i]);
        // Chords instead of arcs: below by the spacing squared.
        let (inside, skin) = (volume(&nodes, &built.wall.faces), area(&nodes, &built.wall.faces));
        assert!((inside / (4.0 / 3.0 * PI) - 1.0).abs() < 3e-3 && (skin / (4.0 * PI) - 1.0).abs() < 3e-3);
        let outward = normals(&nodes, &built.wall.faces);
        assert!(nodes.iter().zip(&outward).all(|(at, n)| at.dot(n) > 0.999));
        assert_eq!(built.wall.edges().len(), built.wall.faces.len() * 3 / 2);
    }
}
