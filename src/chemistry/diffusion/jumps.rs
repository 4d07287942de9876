//! How many virtual jumps a molecule makes in a step.

/// Stage by stage chances of the number of virtual jumps K ~ Poisson(λ), λ = Λ τ.
#[derive(Clone, Debug, Default)]
pub struct Jumps {
    /// P(K ≥ s), s = 1, 2, …, down to rounding.
    pub tail: Vec<f64>,
    /// P(K ≥ s | K ≥ s - 1), s = 1, 2, …
    pub onward: Vec<f64>,
}

/// Largest λ taken at once; longer steps are cut into equal pieces, which changes nothing in law.
const LONGEST: f64 = 30.0;

impl Jumps {
    /// The chances for `expected` = Λ τ jumps, and into how many equal pieces the step is cut.
    #[must_use]
    pub fn expected(expected: f64) -> (Jumps, usize) {
        let pieces = (expected / LONGEST).ceil().max(1.0);
        (Jumps::of(expected / pieces), pieces as usize)
    }

    /// λ at most [`LONGEST`], so that e^-λ is far from underflow.
    fn of(lambda: f64) -> Jumps {
        if lambda <= 0.0 {
            return Jumps::default();
        }
        let mut masses = vec![(-lambda).exp()];
        while let Some(&last) = masses.last() {
            let s = masses.len() as f64;
            // The tail beyond is below this mass times s / (s - λ).
            if last < 1e-25 && s > 2.0 * lambda {
                break;
            }
            masses.push(last * lambda / s);
        }
        // Summed from the small end, so that every tail is good to relative rounding.
        let mut tail: Vec<f64> = masses
            .iter()
            .rev()
            .scan(0.0, |sum, mass| {
                *sum += mass;
                Some(*sum)
            })
            .collect();
        tail.reverse();
        tail.remove(0);
        let mut before = 1.0;
        let onward = tail.iter().map(|&t| f64::min(t / std::mem::replace(&mut before, t), 1.0)).collect();
        Jumps { tail, onward }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_of_the_poisson_law() {
        let (jumps, pieces) = Jumps::expected(0.5);
        assert_eq!(pieces, 1);
        let none = (-0.5_f64).exp();
        // Rounding of sums of a few terms.
        assert!((jumps.tail[0] - (1.0 - none)).abs() < 1e-15);
        assert!((jumps.tail[1] - (1.0 - 1.5 * none)).abs() < 1e-15);
        assert!((jumps.onward[1] - jumps.tail[1] / jumps.tail[0]).abs() < 1e-15);
        // Sum of tails is the mean, also of a long step that is cut up.
        let (jumps, pieces) = Jumps::expected(100.0);
        assert_eq!(pieces, 4);
        assert!((jumps.tail.iter().sum::<f64>() - 25.0).abs() < 1e-12);
        assert!(Jumps::expected(0.0).0.tail.is_empty());
    }
}
