//! New columns where a wall has been stretched too far.
//!
//! The present equilibrium becomes the state of rest: places x, volumes J V, and F_g⁻¹ := V_e, the elastic stretch seen
//! from the present (F_e = V_e R), so that every stress is kept. Then each edge of the mesh that is too long is split. The
//! new column takes from each end's particles the part that the halved faces take from its nodes, of mass, volume and
//! whatever else they hold.

use crate::error::RunError;
use crate::solid::bonds::Bonds;
use crate::solid::elastic::{Elastic, Hold, Strain};
use crate::solid::growth::rotation;
use crate::solid::shell::Wall;
use crate::solid::surface::{area_vector, normals};
use crate::space::matrix::{Matrix, determinant};
use crate::vector::Vector;

/// A particle that came into being, and what its two donors gave: parts of all they hold.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Birth {
    pub particle: usize,
    pub donors: [(usize, f64); 2],
}

impl Birth {
    /// The donor that gave more: what it belongs to, the new particle belongs to.
    #[must_use]
    pub fn parent(&self) -> usize {
        let [a, b] = self.donors;
        if a.1 >= b.1 { a.0 } else { b.0 }
    }
}

/// A wall between two states of rest, particle by particle.
pub(super) struct Present<const D: usize> {
    pub places: Vec<Vector<D>>,
    pub volumes: Vec<f64>,
    pub masses: Vec<f64>,
    /// V_e.
    pub stretches: Vec<Matrix<D>>,
    /// Deformation from the very first state of rest.
    pub gradients: Vec<Matrix<D>>,
    pub softness: Vec<f64>,
}

impl<const D: usize> Present<D> {
    /// Of a solid whose deformation before its state of rest was `before`.
    pub fn new(solid: &Elastic<D>, before: &[Matrix<D>]) -> Present<D> {
        let all = 0..solid.len();
        let stretch = |i| {
            let f = solid.elastic_gradient(i);
            let v = f * rotation(&f).transpose();
            (v + v.transpose()) * 0.5
        };
        Present {
            places: all.clone().map(|i| solid.position(i)).collect(),
            volumes: all.clone().map(|i| solid.volume(i)).collect(),
            masses: all.clone().map(|i| solid.grown_mass(i)).collect(),
            stretches: all.clone().map(stretch).collect(),
            gradients: all.map(|i| solid.gradient(i) * before[i]).collect(),
            softness: solid.softness.clone(),
        }
    }

    /// Splits the edge between two columns; returns the particles of the new one.
    fn split(&mut self, wall: &mut Wall<D>, [a, b]: [u32; 2]) -> Vec<Birth> {
        let layers = wall.layers;
        let middle = wall.middle(|i| self.places[i]);
        let upright = normals(&middle, &wall.faces);
        let (mut at_edge, mut at_a, mut at_b) = (0.0, 0.0, 0.0);
        for face in &wall.faces {
            let area = area_vector(&middle, face).norm();
            let (has_a, has_b) = (face.contains(&a), face.contains(&b));
            at_a += if has_a { area } else { 0.0 };
            at_b += if has_b { area } else { 0.0 };
            at_edge += if has_a && has_b { area } else { 0.0 };
        }
        let given = [0.5 * at_edge / at_a, 0.5 * at_edge / at_b];
        let normal = (upright[a as usize] + upright[b as usize]).normalize();
        let column = wall.columns;
        let mut births = Vec::with_capacity(layers);
        for layer in 0..layers {
            let ends = [wall.particle(a as usize, layer), wall.particle(b as usize, layer)];
            let [x, y] = ends.map(|i| self.places[i]);
            // The middle of the arc that leaves both ends at right angles to their normals.
            let rise = (y - x).dot(&(upright[b as usize] - upright[a as usize])) / 8.0;
            self.places.push((x + y) * 0.5 + normal * rise);
            let mean = |of: &[Matrix<D>]| (of[ends[0]] + of[ends[1]]) * 0.5;
            let (stretch, gradient) = (mean(&self.stretches), mean(&self.gradients));
            self.softness.push(0.5 * (self.softness[ends[0]] + self.softness[ends[1]]));
            let (mut mass, mut parts) = (0.0, [(0, 0.0); 2]);
            for (k, &end) in ends.iter().enumerate() {
                parts[k] = (end, given[k]);
                mass += given[k] * self.masses[end];
                self.masses[end] *= 1.0 - given[k];
                self.volumes[end] *= 1.0 - given[k];
            }
            self.masses.push(mass);
            self.stretches.push(stretch);
            self.gradients.push(gradient);
            // Of its mass and its stretch; filled in when the density is known.
            self.volumes.push(0.0);
            births.push(Birth { particle: wall.particle(column, layer), donors: parts });
        }
        wall.columns += 1;
        let new = column as u32;
        let halved = std::mem::take(&mut wall.faces);
        for face in halved {
            if face.contains(&a) && face.contains(&b) {
                wall.faces.push(face.map(|node| if node == b { new } else { node }));
                wall.faces.push(face.map(|node| if node == a { new } else { node }));
            } else {
                wall.faces.push(face);
            }
        }
        births
    }

    /// Splits all edges stretched by more than a factor, those stretched most first; `start` as of [`Wall::stretched`]; no
    /// more than `capacity` columns.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] when the reserve of columns is used up.
    pub fn refine(
        &mut self,
        wall: &mut Wall<D>,
        (most, start): (f64, &[f64; 3]),
        capacity: usize,
        density: f64,
        time: f64,
    ) -> Result<Vec<Birth>, RunError> {
        let mut births = Vec::new();
        loop {
            let stretched = wall.stretched(|i| self.places[i], start);
            let Some((edge, stretch)) = stretched.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            if stretch <= most {
                break;
            }
            if wall.columns >= capacity {
                let nodes = wall.middle(|i| self.places[i]);
                return Err(used_up(&nodes[edge[0] as usize], wall, stretch / most, time));
            }
            births.extend(self.split(wall, edge));
            for i in self.volumes.len() - wall.layers..self.volumes.len() {
                self.volumes[i] = self.masses[i] * determinant(&self.stretches[i]) / density;
            }
            if D == 3 {
                self.flip(wall);
            }
        }
        Ok(births)
    }

    /// Turns edges of triangles until each has the Delaunay property: the angles opposite to it add up to at most π.
    fn flip(&self, wall: &mut Wall<D>) {
        let nodes = wall.middle(|i| self.places[i]);
        let cosine = |at: u32, a: u32, b: u32| {
            let [o, p, q] = [at, a, b].map(|i| nodes[i as usize]);
            (p - o).normalize().dot(&(q - o).normalize()).clamp(-1.0, 1.0)
        };
        // A few turns settle round a split; the bound is for walls that are folded.
        for _ in 0..64 {
            let mut sides: Vec<(u32, u32, usize)> = Vec::with_capacity(wall.faces.len() * 3);
            for (number, face) in wall.faces.iter().enumerate() {
                for k in 0..3 {
                    sides.push((face[k], face[(k + 1) % D], number));
                }
            }
            sides.sort_unstable();
            let face_of = |a: u32, b: u32| {
                sides.binary_search_by_key(&(a, b), |side| (side.0, side.1)).ok().map(|at| sides[at].2)
            };
            let third = |face: &[u32; D], a: u32, b: u32| face.iter().copied().find(|&c| c != a && c != b);
            let turn = sides.iter().filter(|side| side.0 < side.1).find_map(|&(a, b, left)| {
                let right = face_of(b, a)?;
                let (c, d) = (third(&wall.faces[left], a, b)?, third(&wall.faces[right], a, b)?);
                let angles = cosine(c, a, b).acos() + cosine(d, a, b).acos();
                let bad = angles > std::f64::consts::PI + 1e-6
                    && face_of(c, d).is_none()
                    && face_of(d, c).is_none();
                bad.then_some((a, b, c, d, left, right))
            });
            let Some((a, b, c, d, left, right)) = turn else { return };
            // Left was a b c, right was b a d.
            wall.faces[left] = std::array::from_fn(|k| [a, d, c][k]);
            wall.faces[right] = std::array::from_fn(|k| [d, b, c][k]);
        }
    }
}

impl<const D: usize> Elastic<D> {
    /// Other particles at rest, all free and not displaced; softness and growth are still those of before.
    pub(super) fn begin_at(&mut self, places: Vec<Vector<D>>, volumes: Vec<f64>, bonds: Bonds<D>) {
        let n = places.len();
        (self.places, self.volumes, self.bonds) = (places, volumes, bonds);
        self.holds.resize(n, Hold::Free);
        for field in [&mut self.displacements, &mut self.velocities, &mut self.forces, &mut self.loads] {
            field.clear();
            field.resize(n, Vector::zeros());
        }
        self.strains = vec![Strain { f: Matrix::identity(), pull: Matrix::zeros() }; n];
    }

    /// Begins anew from a present state with new bonds; `skin` is the area vector each particle carries, m^(D-1).
    ///
    /// # Errors
    /// As [`Elastic::new`].
    pub(super) fn begin_again(
        &mut self,
        present: Present<D>,
        bonds: Bonds<D>,
        skin: &[Vector<D>],
    ) -> Result<(), RunError> {
        self.begin_at(present.places, present.volumes, bonds);
        self.growth = Some(present.stretches);
        self.softness = present.softness;
        self.consist(skin);
        self.strain()?;
        self.pull();
        Ok(())
    }
}

fn used_up<const D: usize>(at: &Vector<D>, wall: &Wall<D>, over: f64, time: f64) -> RunError {
    let place: Vec<String> = at.iter().map(|x| format!("{x:.4e}")).collect();
    RunError::BlowUp {
        step: 0,
        time,
        particle: wall.columns * wall.layers,
        quantity: format!(
            "all {} particles of the wall are in use, {} in each of {} columns, and at ({}) m it needs one more; distance over the longest allowed",
            wall.columns * wall.layers,
            wall.layers,
            wall.columns,
            place.join(", ")
        ),
        value: over,
        remedy: "growth outruns insertion: raise growth.reserve (particles), or let it grow less".into(),
    }
}
