//! Level lines of a field on a grid, by marching squares.

use std::collections::HashMap;

/// Values on the nodes of a grid: `values[j * columns + i]` at (`x[i]`, `y[j]`).
#[derive(Clone, Debug, PartialEq)]
pub struct GridField {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub values: Vec<f64>,
}

/// An edge of the grid: its lower left node, and whether it goes up.
type Edge = (usize, usize, bool);

impl GridField {
    /// The value at a node.
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.values[j * self.x.len() + i]
    }

    /// Lines on which the field, linear along the edges of the grid, has a value. Cells with a node that is not a
    /// number are left out; in a saddle the mean of the corners decides which are joined.
    #[must_use]
    pub fn level(&self, value: f64) -> Vec<Vec<[f64; 2]>> {
        let mut links: HashMap<Edge, Vec<Edge>> = HashMap::new();
        let mut order: Vec<Edge> = Vec::new();
        for j in 0..self.y.len().saturating_sub(1) {
            for i in 0..self.x.len().saturating_sub(1) {
                for [a, b] in self.cell(i, j, value) {
                    for (from, to) in [(a, b), (b, a)] {
                        links.entry(from).or_default().push(to);
                        order.push(from);
                    }
                }
            }
        }
        let mut lines = Vec::new();
        // Ends of open lines first, then what is closed.
        let open =
            |links: &HashMap<Edge, Vec<Edge>>, edge: &Edge| links.get(edge).is_some_and(|l| l.len() == 1);
        let starts: Vec<Edge> = order.iter().copied().filter(|edge| open(&links, edge)).collect();
        for start in starts.into_iter().chain(order) {
            let mut line = vec![self.crossing(start, value)];
            let mut here = start;
            while let Some(next) = links.get_mut(&here).and_then(Vec::pop) {
                if let Some(back) = links.get_mut(&next)
                    && let Some(k) = back.iter().position(|edge| *edge == here)
                {
                    back.swap_remove(k);
                }
                line.push(self.crossing(next, value));
                here = next;
            }
            if line.len() > 1 {
                lines.push(line);
            }
        }
        lines
    }

    /// Segments through a cell, as pairs of edges.
    fn cell(&self, i: usize, j: usize, value: f64) -> Vec<[Edge; 2]> {
        let corners = [self.at(i, j), self.at(i + 1, j), self.at(i + 1, j + 1), self.at(i, j + 1)];
        if corners.iter().any(|c| !c.is_finite()) {
            return Vec::new();
        }
        let above = corners.map(|c| c > value);
        // Edges in the order of the corners they start from, anticlockwise.
        let edges: [Edge; 4] = [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)];
        let cut: Vec<usize> = (0..4).filter(|&k| above[k] != above[(k + 1) % 4]).collect();
        match cut[..] {
            [a, b] => vec![[edges[a], edges[b]]],
            [_, _, _, _] => {
                let middle = corners.iter().sum::<f64>() / 4.0 > value;
                // Corner k lies between edges k - 1 and k; those of the other kind than the middle are cut off.
                (0..4).filter(|&k| above[k] != middle).map(|k| [edges[(k + 3) % 4], edges[k]]).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Where an edge has the value.
    fn crossing(&self, (i, j, up): Edge, value: f64) -> [f64; 2] {
        let (k, l) = if up { (i, j + 1) } else { (i + 1, j) };
        let (a, b) = (self.at(i, j), self.at(k, l));
        let part = if a == b { 0.5 } else { (value - a) / (b - a) };
        [self.x[i] + part * (self.x[k] - self.x[i]), self.y[j] + part * (self.y[l] - self.y[j])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(n: usize, f: impl Fn(f64, f64) -> f64) -> GridField {
        let x: Vec<f64> = (0..=n).map(|k| 2.0 * k as f64 / n as f64 - 1.0).collect();
        let values = x.iter().flat_map(|&y| x.iter().map(move |&x| (x, y))).map(|(x, y)| f(x, y)).collect();
        GridField { y: x.clone(), x, values }
    }

    #[test]
    fn a_circle_is_one_closed_line() {
        let lines = field(40, |x, y| x * x + y * y).level(0.25);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        // Linear between nodes 0.05 apart: off by at most 0.05²/8 of the curvature 2 over the slope 1.
        assert!(lines[0].iter().all(|p| (p[0].hypot(p[1]) - 0.5).abs() < 7e-4));
    }

    #[test]
    fn lines_that_leave_the_grid_are_open_and_saddles_are_parted() {
        let straight = field(4, |x, _| x).level(0.1);
        assert_eq!((straight.len(), straight[0].len()), (1, 5));
        // x y = 0.3 has two branches.
        assert_eq!(field(21, |x, y| x * y).level(0.3).len(), 2);
        let holed = field(4, |x, y| if x == 0.0 && y == 0.0 { f64::NAN } else { x }).level(0.1);
        assert_eq!(holed.len(), 2);
    }
}
