//! How many of a few molecules make a virtual jump, without a branch on chance.
//!
//! In a dilute voxel the work of a draw is little, but whether any molecule jumps is a toss that a processor
//! guesses wrong; so the number is read off a table of the binomial distribution by comparisons that are summed.

use rand::Rng;

/// Binomial numbers of one probability and up to [`Few::MOST`] trials; rows are worked out when first used.
#[derive(Clone, Debug)]
pub(super) struct Few {
    p: f64,
    /// Bit n: row n is there.
    ready: u32,
    /// P(X ≤ k) 2^64 of n trials at `[n][k]`.
    below: [[u64; Few::MOST]; Few::MOST + 1],
}

impl Default for Few {
    fn default() -> Few {
        Few { p: f64::NAN, ready: 0, below: [[u64::MAX; Few::MOST]; Few::MOST + 1] }
    }
}

impl Few {
    /// Most trials: with 30 molecules per voxel both ways cost the same, `cargo bench --bench particles -- hops`.
    pub const MOST: usize = 16;
    /// Comparisons made in any case; the others only if all of these succeed.
    const ALWAYS: usize = 4;

    /// Sets the probability; the table stays if it is the one there was.
    pub fn of(&mut self, p: f64) {
        if p != self.p {
            (self.p, self.ready) = (p, 0);
        }
    }

    /// Successes among `n` ≤ [`Few::MOST`] trials.
    #[inline]
    pub fn draw<R: Rng>(&mut self, random: &mut R, n: usize) -> usize {
        if self.ready >> n & 1 == 0 {
            self.fill(n);
        }
        let uniform = random.next_u64();
        let row = &self.below[n];
        let mut x = 0;
        for &limit in &row[..Few::ALWAYS] {
            x += usize::from(uniform >= limit);
        }
        if x == Few::ALWAYS {
            for &limit in &row[Few::ALWAYS..] {
                x += usize::from(uniform >= limit);
            }
        }
        x.min(n) // the one number that reaches 2^64 - 1 counts to the last
    }

    #[cold]
    fn fill(&mut self, n: usize) {
        let (p, q) = (self.p, 1.0 - self.p);
        let row = &mut self.below[n];
        row.fill(u64::MAX);
        let mut sum = 0.0;
        let mut ways = 1.0;
        for (k, limit) in row.iter_mut().enumerate().take(n) {
            sum += ways * p.powi(k as i32) * q.powi((n - k) as i32);
            ways *= (n - k) as f64 / (k + 1) as f64;
            *limit = (sum * 18_446_744_073_709_551_616.0) as u64; // 2^64; saturates
        }
        self.ready |= 1 << n;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};

    #[test]
    fn numbers_follow_the_binomial_law() {
        let mut random = stream(14, 0, Purpose::Diffusion);
        let mut few = Few::default();
        for (n, p) in [(1, 0.26), (2, 0.9), (5, 0.26), (16, 0.07), (16, 0.5), (9, 0.999)] {
            few.of(p);
            let mut counts = [0.0; Few::MOST + 1];
            (0..200_000).for_each(|_| counts[few.draw(&mut random, n)] += 1.0);
            let mut mass = (1.0 - p).powi(n as i32);
            for (k, &seen) in counts.iter().enumerate().take(n + 1) {
                // 200 000 draws: five standard errors and a count; 56 comparisons, chance 6e-7 each.
                let expected = 200_000.0 * mass;
                assert!((seen - expected).abs() < 5.0 * expected.sqrt() + 1.0, "{n} {p}: {seen} of {k}");
                mass *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
            }
        }
    }

    #[test]
    fn ends() {
        let mut random = stream(15, 0, Purpose::Diffusion);
        let mut few = Few::default();
        few.of(1.0);
        assert!((0..=Few::MOST).all(|n| few.draw(&mut random, n) == n));
        few.of(0.0);
        assert!((0..=Few::MOST).all(|n| few.draw(&mut random, n) == 0));
    }
}
