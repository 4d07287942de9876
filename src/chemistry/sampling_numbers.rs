//! Draws of whole numbers: binomial, Poisson; and the unit exponential.
//!
//! Small means by inversion (BINV of Kachitvichyanukul & Schmeiser 1988, one uniform number), large ones by
//! the rejection methods of `rand_distr` (BTPE; Ahrens & Dieter's PD for Poisson). All exact to the
//! resolution of a 53-bit uniform number.

use rand::Rng;
use rand_distr::{Binomial, Distribution, Exp1, Poisson};

/// Mean up to which inversion is used: it takes as many turns as the number drawn, while rejection has a
/// set-up of the order of a hundred nanoseconds.
const INVERSION: f64 = 24.0;

/// A unit exponential.
#[inline]
pub fn exponential<R: Rng>(random: &mut R) -> f64 {
    random.sample(Exp1)
}

/// Successes in `n` trials of probability `p` (0 for p ≤ 0, n for p ≥ 1).
#[inline]
pub fn binomial<R: Rng>(random: &mut R, n: u64, p: f64) -> u64 {
    if n == 0 || p <= 0.0 {
        return 0;
    }
    if p >= 1.0 {
        return n;
    }
    if p > 0.5 {
        return n - binomial_below_half(random, n, 1.0 - p);
    }
    binomial_below_half(random, n, p)
}

/// [`binomial`] where ln(1 - p) is known beforehand.
#[inline]
pub fn binomial_of_log<R: Rng>(random: &mut R, n: u64, p: f64, log: f64) -> u64 {
    if p <= 0.5 && n as f64 * p < INVERSION {
        return invert_binomial(random, n, p / (1.0 - p), (n as f64 * log).exp());
    }
    binomial(random, n, p)
}

#[inline]
fn binomial_below_half<R: Rng>(random: &mut R, n: u64, p: f64) -> u64 {
    if n as f64 * p < INVERSION {
        let none = (n as f64 * (-p).ln_1p()).exp();
        return invert_binomial(random, n, p / (1.0 - p), none);
    }
    binomial_by_rejection(random, n, p)
}

#[cold]
#[inline(never)]
fn binomial_by_rejection<R: Rng>(random: &mut R, n: u64, p: f64) -> u64 {
    // `Binomial::new` refuses only p outside [0, 1], which the callers have excluded.
    Binomial::new(n, p).map_or(0, |b| b.sample(random))
}

/// 1, 1, 1/2, 1/3, …: divisions would take most of the time of an inversion.
const RECIPROCAL: [f64; 64] = {
    let mut table = [1.0; 64];
    let mut x = 1;
    while x < 64 {
        table[x] = 1.0 / x as f64;
        x += 1;
    }
    table
};

/// Inversion from zero upwards; `odds` = p/(1-p), `none` = (1-p)^n.
#[inline]
fn invert_binomial<R: Rng>(random: &mut R, n: u64, odds: f64, none: f64) -> u64 {
    loop {
        let mut left: f64 = random.random();
        if left < none {
            return 0;
        }
        let mut mass = none;
        let mut trials = odds * n as f64; // odds (n - x)
        for x in 1..=n {
            left -= mass;
            mass *= trials * RECIPROCAL.get(x as usize).copied().unwrap_or_else(|| 1.0 / x as f64);
            trials -= odds;
            if left < mass {
                return x;
            }
            // Past the mean the masses only fall; once they are below rounding nothing is left to find.
            if mass < 1e-18 && x as f64 > n as f64 * odds {
                break;
            }
        }
        // Rounding left a sliver above the last mass (chance below 1e-15): draw again.
    }
}

/// A binomial of one probability and many different n; keeps the powers (1-p)^n of small n.
#[derive(Clone, Debug)]
pub struct Trials {
    p: f64,
    odds: f64,
    /// (1-p)^n.
    none: [f64; Trials::KEPT],
}

impl Trials {
    const KEPT: usize = 32;

    /// Trials of probability `p` in [0, 1].
    #[must_use]
    pub fn new(p: f64) -> Trials {
        let mut none = [1.0; Trials::KEPT];
        for n in 1..Trials::KEPT {
            none[n] = none[n - 1] * (1.0 - p);
        }
        Trials { p, odds: p / (1.0 - p), none }
    }

    /// Successes among `n`.
    #[inline]
    pub fn draw<R: Rng>(&self, random: &mut R, n: u64) -> u64 {
        if n < Trials::KEPT as u64 && self.p <= 0.5 {
            return invert_binomial(random, n, self.odds, self.none[n as usize]);
        }
        binomial(random, n, self.p)
    }
}

/// A Poisson number of mean `mean` (0 for a mean that is zero or below).
#[inline]
pub fn poisson<R: Rng>(random: &mut R, mean: f64) -> u64 {
    if mean < INVERSION {
        if mean <= 0.0 {
            return 0;
        }
        return invert_poisson(random, mean);
    }
    // Refused are means beyond 1.8e19, whose relative spread of 2e-10 no f64 count could hold anyway.
    Poisson::new(mean).map_or(mean as u64, |p| p.sample(random) as u64)
}

fn invert_poisson<R: Rng>(random: &mut R, mean: f64) -> u64 {
    let none = (-mean).exp();
    loop {
        let mut left: f64 = random.random();
        let (mut mass, mut x) = (none, 0_u64);
        loop {
            if left < mass {
                return x;
            }
            if mass < 1e-18 && x as f64 > mean {
                break;
            }
            left -= mass;
            x += 1;
            mass *= mean / x as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};

    /// Pearson's chi-square of drawn numbers against probabilities, bins pooled to an expected count of 5,
    /// as a standard normal deviate (Wilson & Hilferty 1931).
    fn chi_square_deviate(counts: &[u64], probability: &[f64], draws: f64) -> f64 {
        let (mut sum, mut bins) = (0.0, 0.0);
        let (mut expected, mut seen) = (0.0, 0.0);
        for (&c, &p) in counts.iter().zip(probability) {
            expected += p * draws;
            seen += c as f64;
            if expected >= 5.0 {
                sum += (seen - expected) * (seen - expected) / expected;
                bins += 1.0;
                (expected, seen) = (0.0, 0.0);
            }
        }
        let freedom: f64 = bins - 1.0;
        let c = 2.0 / (9.0 * freedom);
        ((sum / freedom).cbrt() - 1.0 + c) / c.sqrt()
    }

    fn binomial_masses(n: u64, p: f64) -> Vec<f64> {
        let mut log = n as f64 * (-p).ln_1p();
        let mut masses = vec![log.exp()];
        for x in 0..n {
            log += ((n - x) as f64 / (x + 1) as f64 * p / (1.0 - p)).ln();
            masses.push(log.exp());
        }
        masses
    }

    // 200 000 draws each; a deviate above 4 has a chance of 3e-5 under the right law, 11 tests in all.
    const DRAWS: usize = 200_000;

    #[test]
    fn binomials_follow_their_law() {
        let mut random = stream(11, 0, Purpose::Diffusion);
        for (n, p) in [(1, 0.3), (5, 0.7), (10, 0.05), (100, 0.2), (1600, 0.01), (1600, 0.2), (60, 0.9)] {
            let mut counts = vec![0; n as usize + 1];
            for _ in 0..DRAWS {
                counts[binomial(&mut random, n, p) as usize] += 1;
            }
            if n > 1 {
                let z = chi_square_deviate(&counts, &binomial_masses(n, p), DRAWS as f64);
                assert!(z < 4.0, "n {n} p {p}: {z}");
            }
        }
        let trials = Trials::new(0.3);
        let mut counts = vec![0; 21];
        for _ in 0..DRAWS {
            counts[trials.draw(&mut random, 20) as usize] += 1;
        }
        assert!(chi_square_deviate(&counts, &binomial_masses(20, 0.3), DRAWS as f64) < 4.0);
    }

    #[test]
    fn poisson_numbers_follow_their_law() {
        let mut random = stream(12, 0, Purpose::Deal);
        for mean in [0.3_f64, 5.0, 20.0, 60.0] {
            let mut masses = vec![(-mean).exp()];
            for x in 1..200 {
                masses.push(masses[x - 1] * mean / x as f64);
            }
            let mut counts = vec![0; masses.len()];
            for _ in 0..DRAWS {
                counts[poisson(&mut random, mean) as usize] += 1;
            }
            let z = chi_square_deviate(&counts, &masses, DRAWS as f64);
            assert!(z < 4.0, "mean {mean}: {z}");
        }
    }

    #[test]
    fn ends() {
        let mut random = stream(13, 0, Purpose::Deal);
        assert_eq!(binomial(&mut random, 7, 0.0), 0);
        assert_eq!(binomial(&mut random, 7, 1.0), 7);
        assert_eq!(binomial(&mut random, 0, 0.5), 0);
        assert_eq!(poisson(&mut random, 0.0), 0);
        assert_eq!(Trials::new(1.0).draw(&mut random, 9), 9);
    }
}
