//! The box a flow lives in: its corners and which axes are periodic.

use crate::vector::Vector;

/// A box, m. On an axis that is not periodic `min` and `max` are the surfaces of the walls.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain<const D: usize> {
    pub min: Vector<D>,
    pub max: Vector<D>,
    pub periodic: [bool; D],
}

impl<const D: usize> Domain<D> {
    /// Edge lengths, m.
    #[must_use]
    pub fn lengths(&self) -> Vector<D> {
        self.max - self.min
    }

    /// a - b by the shortest way round the periodic axes, m. Exactly antisymmetric.
    #[must_use]
    pub fn separation(&self, a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
        let mut x = a - b;
        for k in 0..D {
            if self.periodic[k] {
                let length = self.max[k] - self.min[k];
                x[k] -= length * (x[k] / length).round();
            }
        }
        x
    }

    /// The same point inside `min..max` on the periodic axes.
    #[must_use]
    pub fn wrap(&self, point: &Vector<D>) -> Vector<D> {
        let mut p = *point;
        for k in 0..D {
            if self.periodic[k] && !(self.min[k]..self.max[k]).contains(&p[k]) {
                let length = self.max[k] - self.min[k];
                p[k] -= length * ((p[k] - self.min[k]) / length).floor();
                // Rounding may put a point just below min onto max.
                if p[k] >= self.max[k] {
                    p[k] = self.min[k];
                }
            }
        }
        p
    }

    /// Whether a point lies beyond a side that is not periodic.
    #[must_use]
    pub fn is_beyond(&self, point: &Vector<D>) -> bool {
        (0..D).any(|k| !self.periodic[k] && (point[k] < self.min[k] || point[k] > self.max[k]))
    }

    /// The shortest-way rule prepared for the sweep over pairs.
    #[must_use]
    pub fn shortest(&self) -> Shortest<D> {
        let length = self.lengths();
        let half = Vector::from_fn(|k, _| if self.periodic[k] { 0.5 * length[k] } else { f64::INFINITY });
        Shortest { length, half }
    }
}

/// Separation in a periodic box for points that left it by less than half its length.
#[derive(Clone, Copy, Debug)]
pub struct Shortest<const D: usize> {
    length: Vector<D>,
    half: Vector<D>,
}

impl<const D: usize> Shortest<D> {
    /// a - b by the shortest way round, m. Exactly antisymmetric.
    #[inline(always)]
    #[must_use]
    pub fn separation(&self, a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
        let mut x = a - b;
        for k in 0..D {
            let turn = if x[k] > self.half[k] {
                -self.length[k]
            } else if x[k] < -self.half[k] {
                self.length[k]
            } else {
                0.0
            };
            x[k] += turn;
        }
        x
    }

    /// As [`Shortest::separation`] where it is known whether the way leads round a periodic axis.
    #[inline(always)]
    #[must_use]
    pub fn known(&self, a: &Vector<D>, b: &Vector<D>, turned: bool) -> Vector<D> {
        if turned { self.separation(a, b) } else { a - b }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separation_takes_the_short_way_and_wrap_stays_inside() {
        let domain = Domain {
            min: Vector::<2>::new(-1.0, 0.0),
            max: Vector::<2>::new(3.0, 1.0),
            periodic: [true, false],
        };
        let (a, b) = (Vector::<2>::new(2.9, 0.2), Vector::<2>::new(-0.9, 0.9));
        let x = domain.separation(&a, &b);
        // Rounding of the subtraction only.
        assert!((x - Vector::<2>::new(-0.2, -0.7)).norm() < 1e-14);
        assert_eq!(domain.separation(&b, &a), -x);
        assert!((domain.shortest().separation(&a, &b) - x).norm() < 1e-14);
        for x in [-1.0 - 1e-18, 3.0, 11.5, -7.25] {
            let w = domain.wrap(&Vector::<2>::new(x, 5.0));
            assert!((-1.0..3.0).contains(&w[0]) && w[1] == 5.0);
        }
    }
}
