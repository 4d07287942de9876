//! Small networks and the statistics of the chemistry tests.
#![allow(dead_code)] // each test file uses a part

use gillesph::chemistry::{AVOGADRO, Kinetics, Network, Rate, Reaction, Reactor, Species};
use gillesph::error::{Place, Source};
use std::sync::Arc;

/// A volume in which 1 mol/m³ is one molecule: the unit of volume of the master-equation references, so
/// that their k (per molecule and volume) is k in mol and m³ here.
pub const UNIT: f64 = 1.0 / AVOGADRO;

type Side<'a> = &'a [(usize, u32)];

/// A mass-action network in concentrations from (name, diffusivity) and (reactants, products, k).
pub fn network(species: &[(&str, f64)], reactions: &[(Side, Side, f64)]) -> Network {
    let source = Arc::new(Source::new("test", ""));
    let place = Place { source, line: 1, column: 1, width: 1 };
    let species = species.iter().map(|&(name, diffusion)| Species {
        name: String::from(name),
        diffusion,
        only_in: None,
        representation: None,
        place: place.clone(),
    });
    let reactions = reactions.iter().enumerate().map(|(r, &(reactants, products, k))| Reaction {
        name: format!("reaction {r}"),
        equation: String::new(),
        reactants: reactants.to_vec(),
        products: products.to_vec(),
        rate: Rate::MassAction(k),
        only_in: None,
        place: place.clone(),
    });
    Network {
        name: String::from("test"),
        kinetics: Kinetics::Concentration,
        species: species.collect(),
        parameters: Vec::new(),
        reactions: reactions.collect(),
    }
}

/// The same, every species discrete and everywhere.
pub fn discrete(species: &[(&str, f64)], reactions: &[(Side, Side, f64)]) -> Reactor {
    Reactor::everywhere(&network(species, reactions), &vec![true; species.len()])
}

pub fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Unbiased.
pub fn variance(x: &[f64]) -> f64 {
    let m = mean(x);
    x.iter().map(|v| (v - m) * (v - m)).sum::<f64>() / (x.len() as f64 - 1.0)
}

/// Mean within `limit` standard errors.
pub fn assert_mean(x: &[f64], mu: f64, var: f64, limit: f64, what: &str) {
    let z = (mean(x) - mu) / (var / x.len() as f64).sqrt();
    assert!(z.abs() <= limit, "{what}: mean {} against {mu}, {z:.2} standard errors", mean(x));
}

/// Variance within `limit` standard errors; `m4` is the fourth central moment.
pub fn assert_variance(x: &[f64], var: f64, m4: f64, limit: f64, what: &str) {
    let z = (variance(x) - var) / ((m4 - var * var) / x.len() as f64).sqrt();
    assert!(z.abs() <= limit, "{what}: variance {} against {var}, {z:.2} standard errors", variance(x));
}

/// Binomial masses and Poisson masses.
pub fn binomial_masses(n: u64, p: f64) -> Vec<f64> {
    let mut masses = vec![(n as f64 * (-p).ln_1p()).exp()];
    for x in 0..n {
        let last = masses[x as usize];
        masses.push(last * (n - x) as f64 / (x + 1) as f64 * p / (1.0 - p));
    }
    masses
}

pub fn poisson_masses(mean: f64, last: usize) -> Vec<f64> {
    let mut masses = vec![(-mean).exp()];
    for x in 1..=last {
        masses.push(masses[x - 1] * mean / x as f64);
    }
    masses
}

/// Fourth central moments.
pub fn binomial_m4(n: f64, p: f64) -> f64 {
    let v = n * p * (1.0 - p);
    v * (1.0 + (3.0 * n - 6.0) * p * (1.0 - p))
}

pub fn poisson_m4(mean: f64) -> f64 {
    mean * (1.0 + 3.0 * mean)
}

/// Chi-square over bins pooled to an expected count of 5, as a normal deviate (Wilson & Hilferty); a
/// deviate of 3.72 has the chance 1e-4.
pub fn assert_distribution(x: &[f64], masses: &[f64], what: &str) {
    let mut counts = vec![0.0; masses.len()];
    for &n in x {
        counts[(n as usize).min(masses.len() - 1)] += 1.0;
    }
    let (mut bins, mut open) = (Vec::new(), (0.0, 0.0));
    for (c, p) in counts.iter().zip(masses) {
        open = (open.0 + c, open.1 + p * x.len() as f64);
        if open.1 >= 5.0 {
            bins.push(std::mem::take(&mut open));
        }
    }
    if let Some(last) = bins.last_mut() {
        *last = (last.0 + open.0, last.1 + open.1);
    }
    let sum: f64 = bins.iter().map(|(seen, expected)| (seen - expected) * (seen - expected) / expected).sum();
    let freedom = bins.len() as f64 - 1.0;
    let c = 2.0 / (9.0 * freedom);
    let z = ((sum / freedom).cbrt() - 1.0 + c) / c.sqrt();
    assert!(z < 3.72, "{what}: chi-square {sum} of {freedom} degrees of freedom");
}
