//! Sums of rates in a binary tree: a choice in proportion to them, and a change, each in log n.

/// The rates stand in the leaves; every node is the sum of its two children, formed anew whenever one of them
/// changes, so that no rounding piles up.
#[derive(Clone, Debug)]
pub(super) struct SumTree {
    /// Node k has the children 2k and 2k + 1; the leaves begin at `leaves`.
    nodes: Vec<f64>,
    leaves: usize,
}

impl SumTree {
    /// From the rates of all items.
    pub fn new(rates: impl ExactSizeIterator<Item = f64>) -> SumTree {
        let leaves = rates.len().next_power_of_two();
        let mut nodes = vec![0.0; 2 * leaves];
        for (node, rate) in nodes[leaves..].iter_mut().zip(rates) {
            *node = rate;
        }
        for k in (1..leaves).rev() {
            nodes[k] = nodes[2 * k] + nodes[2 * k + 1];
        }
        SumTree { nodes, leaves }
    }

    /// Sum of all rates.
    pub fn total(&self) -> f64 {
        self.nodes[1]
    }

    /// Gives an item a new rate.
    pub fn set(&mut self, item: usize, rate: f64) {
        let mut k = self.leaves + item;
        self.nodes[k] = rate;
        while k > 1 {
            k /= 2;
            self.nodes[k] = self.nodes[2 * k] + self.nodes[2 * k + 1];
        }
    }

    /// An item with chance rate / total, never one of rate zero if the total is positive; `uniform` in [0, 1).
    /// Also what is left of the uniform number, uniform in [0, 1) again.
    pub fn choose(&self, uniform: f64) -> (usize, f64) {
        let mut left = uniform * self.nodes[1];
        let mut k = 1;
        while k < self.leaves {
            let (low, high) = (self.nodes[2 * k], self.nodes[2 * k + 1]);
            if left < low || high <= 0.0 {
                k *= 2;
            } else {
                left -= low;
                k = 2 * k + 1;
            }
        }
        let rest =
            if self.nodes[k] > 0.0 { (left / self.nodes[k]).clamp(0.0, 1.0 - f64::EPSILON) } else { 0.0 };
        (k - self.leaves, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_follow_the_rates() {
        let mut tree = SumTree::new([1.0, 0.0, 2.0, 5.0, 0.0].into_iter());
        tree.set(3, 1.0);
        assert_eq!(tree.total(), 4.0);
        let found: Vec<usize> = (0..8).map(|k| tree.choose(f64::from(k) / 8.0).0).collect();
        assert_eq!(found, [0, 0, 2, 2, 2, 2, 3, 3]);
        assert_eq!(tree.choose(0.625), (2, 0.75));
        tree.set(3, 0.0);
        assert_eq!(tree.choose(1.0 - f64::EPSILON / 2.0).0, 2);
    }
}
