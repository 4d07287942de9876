//! Ways out of a closed wall: gaps between its columns, and places where a surface crosses itself.

use crate::solid::shell::Wall;
use crate::space::matrix::Matrix;
use crate::vector::Vector;

impl<const D: usize> Wall<D> {
    /// Every edge of the mesh and how far it is stretched: its length over the longest at the start, at the inner surface,
    /// the middle or the outer surface, wherever that is most. `start`: longest edges of the three at the start, m.
    pub fn stretched(
        &self,
        at: impl Fn(usize) -> Vector<D>,
        start: &[f64; 3],
    ) -> impl Iterator<Item = ([u32; 2], f64)> {
        let surfaces = [self.inner(&at), self.middle(&at), self.outer(&at)];
        let start = *start;
        self.edges().into_iter().map(move |edge| {
            let [a, b] = edge.map(|node| node as usize);
            let over = surfaces.iter().zip(start).map(|(nodes, start)| (nodes[a] - nodes[b]).norm() / start);
            (edge, over.fold(0.0, f64::max))
        })
    }

    /// Longest edges of the inner surface, the middle and the outer surface, m.
    pub fn longest_edges(&self, at: impl Fn(usize) -> Vector<D>) -> [f64; 3] {
        let edges = self.edges();
        [self.inner(&at), self.middle(&at), self.outer(&at)].map(|nodes| {
            let length = |[a, b]: &[u32; 2]| (nodes[*a as usize] - nodes[*b as usize]).norm();
            edges.iter().map(length).fold(0.0, f64::max)
        })
    }

    /// How many edges of a surface pass through faces of it that they do not touch.
    #[must_use]
    pub fn crossings(&self, nodes: &[Vector<D>]) -> usize {
        let edges = self.edges();
        let at = |node: u32| &nodes[node as usize];
        let half = |[a, b]: [u32; 2]| 0.5 * (at(a) - at(b)).norm();
        let reach = edges.iter().map(|&edge| half(edge)).fold(0.0, f64::max);
        // Faces by the place of their first node along x, so that only those nearby are looked at.
        let mut faces: Vec<(f64, &[u32; D])> = self.faces.iter().map(|face| (at(face[0])[0], face)).collect();
        faces.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut count = 0;
        for &[a, b] in &edges {
            let middle = (at(a) + at(b)) * 0.5;
            let near = 3.0 * reach + half([a, b]);
            let from = faces.partition_point(|face| face.0 < middle[0] - near);
            for (_, face) in faces[from..].iter().take_while(|face| face.0 <= middle[0] + near) {
                let apart = (at(face[0]) - middle).norm_squared() > near * near;
                if !apart
                    && !face.contains(&a)
                    && !face.contains(&b)
                    && pierces(at(a), at(b), &face.map(|i| *at(i)))
                {
                    count += 1;
                }
            }
        }
        count
    }
}

/// Whether the way from `a` to `b` passes through a face.
fn pierces<const D: usize>(a: &Vector<D>, b: &Vector<D>, face: &[Vector<D>; D]) -> bool {
    // a + s (b - a) = f_0 + Σ t_k (f_k - f_0), with s and t in 0..1 and Σ t <= 1.
    let m = Matrix::<D>::from_fn(|row, k| if k == 0 { b[row] - a[row] } else { face[0][row] - face[k][row] });
    let size = crate::space::matrix::determinant(&m);
    if size == 0.0 {
        return false;
    }
    let part = crate::space::matrix::inverse(&m) * (face[0] - a);
    part.iter().all(|x| (0.0..=1.0).contains(x)) && part.iter().skip(1).sum::<f64>() <= 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found<const D: usize>() {
        let built = Wall::<D>::round(&Vector::zeros(), 0.8, 1.2, 0.1);
        let mut nodes = built.wall.middle(|i| built.places[i]);
        let start = built.wall.longest_edges(|i| built.places[i]);
        let gaps = |places: &[Vector<D>]| {
            built.wall.stretched(|i| places[i], &start).filter(|(_, stretch)| *stretch > 2.0).count()
        };
        assert_eq!((built.wall.crossings(&nodes), gaps(&built.places)), (0, 0));
        let right = (0..nodes.len()).max_by(|&a, &b| nodes[a][0].total_cmp(&nodes[b][0])).unwrap();
        // One node through the other side.
        nodes[right] *= -1.5;
        let mut places = built.places.clone();
        for layer in 0..built.wall.layers {
            places[built.wall.particle(right, layer)] *= -1.5;
        }
        assert!(built.wall.crossings(&nodes) >= D && gaps(&places) >= D);
    }

    #[test]
    fn a_wall_through_itself_is_found() {
        found::<2>();
        found::<3>();
    }
}
