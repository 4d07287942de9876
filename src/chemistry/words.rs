//! Propensities in words, with their numbers, so that a reader sees every factor of two.

use crate::chemistry::network::{Kinetics, Network, Rate, Reaction, SurfaceKind};
use crate::quantity::Dimension;

/// The propensity of a reaction in words: `a = 1 m^3/mol/s / (N_A V) * X_R * X_L`.
///
/// X_A is the number of molecules of A in the voxel, V its volume, N_A the Avogadro constant. Conventions:
/// kinetics `concentration` a = k (N_A V)^(1-n) Π X …, n the order; kinetics `molecules`
/// a = c Π binomial(X, ν). A species that falls or rises by more than one is named at the end.
#[must_use]
pub fn propensity_words(network: &Network, reaction: &Reaction) -> String {
    let mut text = match &reaction.rate {
        Rate::MassAction(k) => mass_action(network, reaction, *k),
        Rate::Surface(surface) => through_surface(network, reaction, surface.kind),
        Rate::Law(program) => {
            let names: Vec<&str> = program.uses().iter().map(|&s| network.species[s].name.as_str()).collect();
            let what = names.join(", ");
            match (network.kinetics, names.is_empty()) {
                (Kinetics::Concentration, true) => format!("a = N_A V * ({})", program.text()),
                (Kinetics::Concentration, false) => {
                    format!("a = N_A V * ({}) with {what} in mol/m^3", program.text())
                }
                (Kinetics::Molecules, true) => format!("a = {}", program.text()),
                (Kinetics::Molecules, false) => format!("a = {} with {what} in molecules", program.text()),
            }
        }
    };
    for (s, change) in reaction.change().into_iter().filter(|(_, change)| change.abs() > 1) {
        text.push_str(&format!(", {} changes by {change:+}", network.species[s].name));
    }
    text
}

/// `area` is the voxel's share of the surface, `distance` that of the voxel from it, D the diffusivity.
fn through_surface(network: &Network, reaction: &Reaction, kind: SurfaceKind) -> String {
    let species = reaction.reactants.first().map_or("", |&(s, _)| network.species[s].name.as_str());
    match kind {
        SurfaceKind::Held(concentration) => {
            format!("a = {} mol/m^3 * N_A * area * D / distance", number(concentration))
        }
        SurfaceKind::Flux(flux) => format!("a = {} 1/m^2/s * area", number(flux)),
        SurfaceKind::Absorption(kappa) if kappa.is_finite() => {
            format!("a = area / V / (1 / ({} m/s) + distance / D) * X_{species}", number(kappa))
        }
        SurfaceKind::Absorption(_) => format!("a = area / V * D / distance * X_{species}"),
    }
}

fn mass_action(network: &Network, reaction: &Reaction, k: f64) -> String {
    let order = reaction.order();
    let mut text = match network.kinetics {
        Kinetics::Concentration => {
            let unit = Dimension::rate_constant(order).unit();
            let volume = match order {
                0 => " * N_A V".to_string(),
                1 => String::new(),
                2 => " / (N_A V)".to_string(),
                n => format!(" / (N_A V)^{}", n - 1),
            };
            format!("a = {} {unit}{volume}", number(k))
        }
        Kinetics::Molecules => format!("a = {} 1/s", number(k)),
    };
    for &(s, nu) in &reaction.reactants {
        let x = format!("X_{}", network.species[s].name);
        text.push_str(&format!(" * {x}"));
        for taken in 1..nu {
            text.push_str(&format!(" ({x} - {taken})"));
        }
    }
    if network.kinetics == Kinetics::Molecules {
        // Binomials: the distinct combinations of ν molecules of a kind.
        let combinations: f64 =
            reaction.reactants.iter().map(|&(_, nu)| (1..=nu).map(f64::from).product::<f64>()).product();
        if combinations > 1.0 {
            text.push_str(&format!(" / {}", number(combinations)));
        }
    }
    text
}

/// A number as people write it: plain where it is short, with a power of ten otherwise; all its digits.
#[must_use]
pub fn number(value: f64) -> String {
    let plain = value.to_string();
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) && plain.len() <= 10 {
        plain
    } else {
        let scientific = format!("{value:e}");
        if scientific.len() <= 14 { scientific } else { format!("{value:.6e}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::reactions::tests::network;

    fn words(text: &str) -> Vec<String> {
        let network = network(text);
        network.reactions.iter().map(|r| propensity_words(&network, r)).collect()
    }

    #[test]
    fn concentrations_show_the_power_of_the_volume() {
        let found = words(
            "species: [A, B, C]\nreactions:\n  a: { equation: A + B <-> C, rate: 1, reverse: 0.5 }\n  b: { equation: 2 A -> B, rate: 2e3 }\n  c: { equation: 0 -> A, rate: 1 nM/s }\n  d: { equation: 2 A + B -> 3 C, rate: 7 }\n  e: { equation: A -> B, law: 2 uM/s * A / (A + 1 uM) }\n",
        );
        assert_eq!(found[0], "a = 1 m^3/mol/s / (N_A V) * X_A * X_B");
        assert_eq!(found[1], "a = 0.5 1/s * X_C");
        assert_eq!(found[2], "a = 2000 m^3/mol/s / (N_A V) * X_A (X_A - 1), A changes by -2");
        assert_eq!(found[3], "a = 1e-6 mol/m^3/s * N_A V");
        assert_eq!(
            found[4],
            "a = 7 m^6/mol^2/s / (N_A V)^2 * X_A (X_A - 1) * X_B, A changes by -2, C changes by +3"
        );
        assert_eq!(found[5], "a = N_A V * (2 uM/s * A / (A + 1 uM)) with A in mol/m^3");
    }

    #[test]
    fn molecules_show_the_combinations() {
        let found = words(
            "kinetics: molecules\nspecies: [A, B]\nreactions:\n  a: { equation: 2 A -> B, rate: 0.3 }\n  b: { equation: 3 A -> B, rate: 1e-9 }\n  c: { equation: A + B -> 0, rate: 0.1 1/s }\n  d: { equation: 0 -> A, rate: 5 }\n  e: { equation: A -> 0, law: 0.5 * A }\n",
        );
        assert_eq!(found[0], "a = 0.3 1/s * X_A (X_A - 1) / 2, A changes by -2");
        assert_eq!(found[1], "a = 1e-9 1/s * X_A (X_A - 1) (X_A - 2) / 6, A changes by -3");
        assert_eq!(found[2], "a = 0.1 1/s * X_A * X_B");
        assert_eq!(found[3], "a = 5 1/s");
        assert_eq!(found[4], "a = 0.5 * A with A in molecules");
    }
}
