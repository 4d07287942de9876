//! A sheet in plane strain by finite elements: what the particles are compared with.
//!
//! Biquadratic squares (nine nodes, 3 x 3 points of Gauss), consistent mass; the frequency nearest to a guess by
//! inverse iteration on K - σ M, factorised within its band. Bathe (1996), Finite element procedures.

use crate::solid::Material;

/// A sheet of length and height (m), and how many elements it has along each.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    pub length: f64,
    pub height: f64,
    pub elements: [usize; 2],
    /// Whether the left and the right end are held.
    pub held: [bool; 2],
    pub material: Material,
}

/// A symmetric matrix within its band, row by row from the diagonal leftwards.
struct Band {
    width: usize,
    rows: Vec<f64>,
}

impl Band {
    fn zeros(n: usize, width: usize) -> Band {
        Band { width, rows: vec![0.0; n * (width + 1)] }
    }

    fn add(&mut self, i: usize, j: usize, value: f64) {
        if j <= i {
            self.rows[i * (self.width + 1) + i - j] += value;
        }
    }

    fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        for i in 0..x.len() {
            for back in 0..=self.width.min(i) {
                let value = self.rows[i * (self.width + 1) + back];
                out[i] += value * x[i - back];
                if back > 0 {
                    out[i - back] += value * x[i];
                }
            }
        }
        out
    }

    /// L D Lᵀ in place, without exchange of rows: a shift that is no frequency of a part of the sheet allows it.
    fn factorise(&mut self) {
        let (width, step) = (self.width, self.width + 1);
        let n = self.rows.len() / step;
        for i in 0..n {
            let first = i.saturating_sub(width);
            for j in first..i {
                let mut sum = self.rows[i * step + i - j];
                for k in first.max(j.saturating_sub(width))..j {
                    sum -= self.rows[i * step + i - k] * self.rows[j * step + j - k];
                }
                self.rows[i * step + i - j] = sum;
            }
            let mut pivot = self.rows[i * step];
            for j in first..i {
                let lower = self.rows[i * step + i - j] / self.rows[j * step];
                pivot -= lower * self.rows[i * step + i - j];
                self.rows[i * step + i - j] = lower;
            }
            self.rows[i * step] = pivot;
        }
    }

    /// Solves with what [`Band::factorise`] left.
    fn solve(&self, x: &mut [f64]) {
        let (width, step) = (self.width, self.width + 1);
        for i in 0..x.len() {
            for j in i.saturating_sub(width)..i {
                x[i] -= self.rows[i * step + i - j] * x[j];
            }
        }
        for (i, x) in x.iter_mut().enumerate() {
            *x /= self.rows[i * step];
        }
        for i in (0..x.len()).rev() {
            for j in i.saturating_sub(width)..i {
                x[j] -= self.rows[i * step + i - j] * x[i];
            }
        }
    }
}

impl Sheet {
    /// Angular frequency (1/s) nearest to `guess` of the modes that bend.
    #[must_use]
    pub fn frequency(&self, guess: f64) -> f64 {
        let (stiffness, mass) = self.matrices();
        let mut shifted = Band { width: stiffness.width, rows: stiffness.rows.clone() };
        shifted.rows.iter_mut().zip(&mass.rows).for_each(|(k, m)| *k -= guess * guess * m);
        shifted.factorise();
        let n = stiffness.rows.len() / (stiffness.width + 1);
        // Across, by no symmetric shape.
        let mut mode: Vec<f64> =
            (0..n).map(|k| if k % 2 == 1 { 1.0 + 1e-4 * k as f64 } else { 0.0 }).collect();
        let mut square = 0.0;
        for _ in 0..60 {
            let load = mass.times(&mode);
            let size = dot(&mode, &load).sqrt();
            mode = load.iter().map(|f| f / size).collect();
            shifted.solve(&mut mode);
            let before = square;
            square = dot(&mode, &stiffness.times(&mode)) / dot(&mode, &mass.times(&mode));
            if (square - before).abs() < 1e-12 * square {
                break;
            }
        }
        square.sqrt()
    }

    /// Stiffness and mass of the nodes that are not held, column of nodes by column.
    fn matrices(&self) -> (Band, Band) {
        let [along, across] = self.elements;
        let (columns, rows) = (2 * along + 1, 2 * across + 1);
        let first = usize::from(self.held[0]);
        let last = columns - usize::from(self.held[1]);
        let unknown = |column: usize, row: usize, c: usize| {
            (first..last).contains(&column).then(|| 2 * ((column - first) * rows + row) + c)
        };
        let n = 2 * (last - first) * rows;
        let width = 2 * (2 * rows + 2) + 1;
        let (mut stiffness, mut mass) = (Band::zeros(n, width), Band::zeros(n, width));
        let (k, m) = self.element();
        for a in 0..along {
            for b in 0..across {
                let place = |node: usize, c: usize| unknown(2 * a + node / 3, 2 * b + node % 3, c);
                for p in 0..18 {
                    for q in 0..18 {
                        if let (Some(i), Some(j)) = (place(p / 2, p % 2), place(q / 2, q % 2)) {
                            stiffness.add(i, j, k[p][q]);
                            mass.add(i, j, m[p][q]);
                        }
                    }
                }
            }
        }
        (stiffness, mass)
    }

    /// Stiffness and mass of one element; node 3 a + b stands in column a and row b.
    fn element(&self) -> ([[f64; 18]; 18], [[f64; 18]; 18]) {
        let size = [self.length / self.elements[0] as f64, self.height / self.elements[1] as f64];
        let (g, lambda) = (self.material.shear, self.material.bulk - 2.0 / 3.0 * self.material.shear);
        let far = 0.6_f64.sqrt();
        let points = [(-far, 5.0 / 9.0), (0.0, 8.0 / 9.0), (far, 5.0 / 9.0)];
        let shape = |s: f64| [0.5 * s * (s - 1.0), 1.0 - s * s, 0.5 * s * (s + 1.0)];
        let slope = |s: f64| [s - 0.5, -2.0 * s, s + 0.5];
        let (mut k, mut m) = ([[0.0; 18]; 18], [[0.0; 18]; 18]);
        for (s, ws) in points {
            for (t, wt) in points {
                let weight = ws * wt * 0.25 * size[0] * size[1];
                let value = |node: usize| shape(s)[node / 3] * shape(t)[node % 3];
                let gradient = |node: usize| {
                    [
                        slope(s)[node / 3] * shape(t)[node % 3] * 2.0 / size[0],
                        shape(s)[node / 3] * slope(t)[node % 3] * 2.0 / size[1],
                    ]
                };
                for p in 0..18 {
                    for q in 0..18 {
                        let (a, b, c, d) = (gradient(p / 2), gradient(q / 2), p % 2, q % 2);
                        // λ ∂_c N_p ∂_d N_q + G (δ_cd ∇N_p·∇N_q + ∂_d N_p ∂_c N_q).
                        let same = if c == d { a[0] * b[0] + a[1] * b[1] } else { 0.0 };
                        k[p][q] += weight * (lambda * a[c] * b[d] + g * (same + a[d] * b[c]));
                        if c == d {
                            m[p][q] += weight * self.material.density * value(p / 2) * value(q / 2);
                        }
                    }
                }
            }
        }
        (k, m)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::super::timoshenko::{Ends, Timoshenko};
    use super::*;
    use crate::solid::Law;
    use std::f64::consts::PI;

    fn sheet(held: [bool; 2], length: f64, elements: [usize; 2]) -> Sheet {
        let material = Material::of_young(Law::SaintVenantKirchhoff, 1000.0, 2e6, 0.3975);
        Sheet { length, height: 0.02, elements, held, material }
    }

    #[test]
    fn elements_and_the_theory_of_beams_agree_where_nothing_is_held() {
        let beam = Timoshenko {
            length: 0.2,
            height: 0.02,
            material: sheet([false; 2], 0.2, [1; 2]).material,
            plane: true,
        };
        let guess = beam.frequency(Ends::Free, 1);
        let ours = sheet([false; 2], 0.2, [40, 4]).frequency(guess);
        // Timoshenko's theory with the shear coefficient of a plate is good to some 1e-4 at this slenderness.
        assert!((ours / guess - 1.0).abs() < 5e-4, "{ours} {guess}");
    }

    #[test]
    fn the_cantilever_has_converged() {
        let period = |elements| 2.0 * PI / sheet([true, false], 0.2, elements).frequency(24.6);
        let (coarse, fine) = (period([80, 8]), period([160, 16]));
        // The corners of the clamp leave 1e-4; 0.2552 s is what others found for this case.
        assert!((coarse / fine - 1.0).abs() < 4e-4 && (fine / 0.2552 - 1.0).abs() < 2e-4, "{coarse} {fine}");
    }
}
