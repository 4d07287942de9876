//! Sizes of the vortices in the lower corners of a cavity.

use crate::figures::contour::GridField;

/// A corner of the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    Left,
    Right,
}

/// How far the dividing stream line of a corner vortex reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Along the floor from the corner.
    pub width: f64,
    /// Up the wall from the corner.
    pub height: f64,
}

/// The vortex of a lower corner of the unit square: where the stream function has the other sign than in the
/// middle. Its extent is that of the line of zero, along the floor and up the wall; `None` where there is none.
#[must_use]
pub fn corner(psi: &GridField, corner: Corner) -> Option<Extent> {
    let (columns, rows) = (psi.x.len(), psi.y.len());
    let strongest = psi.values.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    // Seen from the corner: i along the floor, j up; positive where it turns the other way.
    let value = |i: usize, j: usize| {
        let i = if corner == Corner::Left { i } else { columns - 1 - i };
        -psi.at(i, j) * strongest.signum()
    };
    let quarter = || (1..rows / 2).flat_map(|j| (1..columns / 2).map(move |i| (i, j)));
    let (i, j) = quarter().max_by(|a, b| value(a.0, a.1).total_cmp(&value(b.0, b.1)))?;
    if value(i, j) <= 0.0 {
        return None;
    }
    // All nodes that hang together with the strongest one.
    let mut inside = vec![false; columns * rows];
    let mut open = vec![(i, j)];
    let mut extent = Extent { width: 0.0, height: 0.0 };
    let along = |i: usize| psi.x[i] - psi.x[0];
    let up = |j: usize| psi.y[j] - psi.y[0];
    // Where the sign changes between two neighbours.
    let between = |a: f64, b: f64, from: f64, to: f64| from + a / (a - b) * (to - from);
    while let Some((i, j)) = open.pop() {
        if std::mem::replace(&mut inside[j * columns + i], true) {
            continue;
        }
        let here = value(i, j);
        for (k, l) in [(i + 1, j), (i.wrapping_sub(1), j), (i, j + 1), (i, j.wrapping_sub(1))] {
            if k == 0 || l == 0 || k + 1 >= columns || l + 1 >= rows {
                continue;
            }
            let there = value(k, l);
            if there > 0.0 {
                open.push((k, l));
            } else if k > i {
                extent.width = extent.width.max(between(here, there, along(i), along(k)));
            } else if l > j {
                extent.height = extent.height.max(between(here, there, up(j), up(l)));
            }
        }
    }
    Some(extent)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A main vortex cut off at the corners by straight lines from (w, 0) to (0, h), left and right.
    fn field(n: usize, left: Extent, right: Extent) -> GridField {
        let x: Vec<f64> = (0..=n).map(|k| k as f64 / n as f64).collect();
        let one = |x: f64, y: f64| {
            let l = x / left.width + y / left.height - 1.0;
            let r = (1.0 - x) / right.width + y / right.height - 1.0;
            -x * (1.0 - x) * y * (1.0 - y) * l * r
        };
        let values = x.iter().flat_map(|&y| x.iter().map(move |&x| (x, y))).map(|(x, y)| one(x, y)).collect();
        GridField { y: x.clone(), x, values }
    }

    #[test]
    fn extents_are_those_of_the_dividing_lines() {
        let (left, right) = (Extent { width: 0.2, height: 0.15 }, Extent { width: 0.3, height: 0.35 });
        let psi = field(100, left, right);
        // Read off on the first row above the floor, one hundredth up: short by 0.01 w/h and 0.01 h/w.
        for (which, wanted) in [(Corner::Left, left), (Corner::Right, right)] {
            let found = corner(&psi, which).unwrap();
            assert!((found.width - wanted.width).abs() < 0.015, "{found:?}");
            assert!((found.height - wanted.height).abs() < 0.015, "{found:?}");
        }
        let none = GridField { values: psi.values.iter().map(|v| -v.abs()).collect(), ..psi };
        assert_eq!(corner(&none, Corner::Left), None);
    }
}
