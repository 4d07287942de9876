//! A reaction network drawn: as text, as Graphviz dot, as SVG.

mod layout;
mod svg;

pub use svg::svg;

use crate::chemistry::analysis::{analyse, conservation_words};
use crate::chemistry::network::{Kinetics, Network};
use crate::chemistry::words::{number, propensity_words};
use std::fmt::Write as _;

/// The network in words: species, reactions with propensities and orders, conservation laws, linkage classes,
/// deficiency.
#[must_use]
pub fn text(network: &Network) -> String {
    let analysis = analyse(network);
    let kinetics = match network.kinetics {
        Kinetics::Concentration => "concentration (rate constants in mol, m, s)",
        Kinetics::Molecules => "molecules (rates per distinct combination of molecules)",
    };
    let mut out =
        format!("{}\n  kinetics: {kinetics}\n\nspecies ({})\n", network.name, network.species.len());
    let width = column(network.species.iter().map(|s| s.name.as_str()));
    for species in &network.species {
        let mut words = vec![format!("diffusivity {} m^2/s", number(species.diffusion))];
        if let Some(groups) = &species.only_in {
            let names: Vec<&str> = groups.iter().map(|g| g.name.as_str()).collect();
            words.push(format!("only in {}", names.join(", ")));
        }
        words.extend(species.representation.map(|r| r.name().to_string()));
        push_row(&mut out, &species.name, width, &words.join(", "));
    }
    let _ = writeln!(out, "\nreactions ({})", network.reactions.len());
    let width = column(network.reactions.iter().map(|r| r.name.as_str()));
    let equations = column(network.reactions.iter().map(|r| r.equation.as_str()));
    for (reaction, order) in network.reactions.iter().zip(&analysis.orders) {
        let blanks = " ".repeat(equations - reaction.equation.chars().count());
        let words = propensity_words(network, reaction);
        let mut row = format!("{}{blanks}  order {order}  {words}", reaction.equation);
        if let Some(groups) = &reaction.only_in {
            let names: Vec<&str> = groups.iter().map(|g| g.name.as_str()).collect();
            let _ = write!(row, ", only in {}", names.join(", "));
        }
        push_row(&mut out, &reaction.name, width, &row);
    }
    let laws = conservation_words(&analysis, network);
    let _ = writeln!(out, "\nconservation laws ({})", laws.len());
    for law in &laws {
        let _ = writeln!(out, "  {law}");
    }
    let _ = writeln!(out, "\nlinkage classes ({})", analysis.linkage_classes.len());
    for class in &analysis.linkage_classes {
        let members: Vec<String> = class.iter().map(|&c| complex(network, &analysis.complexes[c])).collect();
        let _ = writeln!(out, "  {{ {} }}", members.join(", "));
    }
    let _ = writeln!(
        out,
        "\ndeficiency {} = {} complexes - {} linkage classes - rank {}{}",
        analysis.deficiency,
        analysis.complexes.len(),
        analysis.linkage_classes.len(),
        analysis.rank,
        if analysis.weakly_reversible { ", weakly reversible" } else { "" }
    );
    out
}

fn column<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or(0)
}

fn push_row(out: &mut String, name: &str, width: usize, rest: &str) {
    let blanks = " ".repeat(width.saturating_sub(name.chars().count()));
    let _ = writeln!(out, "  {name}{blanks}  {rest}");
}

/// A complex in words: `A + 2 B`, `0`.
fn complex(network: &Network, complex: &[(usize, u32)]) -> String {
    if complex.is_empty() {
        return "0".to_string();
    }
    let terms: Vec<String> = complex
        .iter()
        .map(|&(s, nu)| {
            let name = &network.species[s].name;
            if nu == 1 { name.clone() } else { format!("{nu} {name}") }
        })
        .collect();
    terms.join(" + ")
}

/// One declared reaction: a direction, or both of a reversible pair.
struct Declared {
    /// Index of the forward direction.
    forward: usize,
    reversible: bool,
}

/// The reactions with the two directions of a pair joined.
fn declared(network: &Network) -> Vec<Declared> {
    let mut out: Vec<Declared> = Vec::new();
    for (r, reaction) in network.reactions.iter().enumerate() {
        if let Some(last) = out.last_mut()
            && last.forward + 1 == r
            && reaction.name.strip_suffix(" (reverse)") == Some(&network.reactions[last.forward].name)
        {
            last.reversible = true;
            continue;
        }
        out.push(Declared { forward: r, reversible: false });
    }
    out
}

/// The network in the Graphviz dot language: species as boxes, reactions as points.
#[must_use]
pub fn dot(network: &Network) -> String {
    let quoted = |text: &str| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
    let mut out = format!("digraph {} {{\n  rankdir=LR;\n", quoted(&network.name));
    out.push_str("  node [fontname=\"Helvetica\"]; edge [fontname=\"Helvetica\", fontsize=10];\n");
    for (s, species) in network.species.iter().enumerate() {
        let _ = writeln!(out, "  s{s} [shape=box, style=rounded, label={}];", quoted(&species.name));
    }
    for (k, one) in declared(network).iter().enumerate() {
        let reaction = &network.reactions[one.forward];
        let _ = writeln!(
            out,
            "  r{k} [shape=circle, width=0.12, label=\"\", style=filled, fillcolor=black, xlabel={}];",
            quoted(&reaction.name)
        );
        let label = |nu: u32| if nu > 1 { format!("label=\"{nu}\"") } else { "label=\"\"".to_string() };
        for &(s, nu) in &reaction.reactants {
            // The stem of an arrow from a reactant has a head only if the reaction runs back as well.
            let direction = if one.reversible { ", dir=back" } else { ", dir=none" };
            let _ = writeln!(out, "  s{s} -> r{k} [{}{direction}];", label(nu));
        }
        for &(s, nu) in &reaction.products {
            let _ = writeln!(out, "  r{k} -> s{s} [{}];", label(nu));
        }
    }
    out.push_str("}\n");
    out
}

#[cfg(test)]
mod tests;
