//! Structure of a network: stoichiometric matrix, conserved sums, complexes, deficiency, dependencies.

mod conservation;

pub use conservation::conservation_laws;

use crate::chemistry::network::{Network, Rate, Reaction};
use nalgebra::DMatrix;
use petgraph::graph::{DiGraph, NodeIndex, UnGraph};

/// What the stoichiometry of a network says, independent of its rates.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// Net change of each species (rows) by each reaction (columns).
    pub stoichiometry: DMatrix<i32>,
    /// Rank of the stoichiometric matrix.
    pub rank: usize,
    /// Conserved sums Σ c_s X_s: one coefficient for each species, without common factor; as many as
    /// species − rank. Non-negative ones where they exist (see [`conservation_laws`]).
    pub conservation: Vec<Vec<i64>>,
    /// The distinct sides of reactions, as species and multiplicity in order of species.
    pub complexes: Vec<Vec<(usize, u32)>>,
    /// Complexes of each linkage class (connected component of the graph of complexes).
    pub linkage_classes: Vec<Vec<usize>>,
    /// complexes − linkage classes − rank; Feinberg, Chem. Eng. Sci. 42, 2229 (1987).
    pub deficiency: usize,
    /// Whether every linkage class is strongly connected: each reaction can be undone by others.
    pub weakly_reversible: bool,
    /// Molecules consumed by each reaction.
    pub orders: Vec<u32>,
    /// For each reaction the reactions whose propensity it changes, itself included where it does; rising.
    pub dependents: Vec<Vec<usize>>,
}

/// Analyses a network.
#[must_use]
pub fn analyse(network: &Network) -> Analysis {
    let stoichiometry = stoichiometry(network);
    let conservation = conservation_laws(&stoichiometry);
    let rank = network.species.len() - conservation.len();
    let (complexes, arrows) = complexes(network);
    let linkage_classes = linkage_classes(complexes.len(), &arrows);
    Analysis {
        rank,
        deficiency: complexes.len().saturating_sub(linkage_classes.len() + rank),
        weakly_reversible: weakly_reversible(complexes.len(), &arrows, linkage_classes.len()),
        orders: network.reactions.iter().map(Reaction::order).collect(),
        dependents: dependents(network),
        stoichiometry,
        conservation,
        complexes,
        linkage_classes,
    }
}

/// Net change of each species (rows) by each reaction (columns).
#[must_use]
pub fn stoichiometry(network: &Network) -> DMatrix<i32> {
    let mut matrix = DMatrix::zeros(network.species.len(), network.reactions.len());
    for (r, reaction) in network.reactions.iter().enumerate() {
        for (s, change) in reaction.change() {
            matrix[(s, r)] = change;
        }
    }
    matrix
}

/// Species on which the propensity of a reaction depends, rising.
#[must_use]
pub fn depends_on(reaction: &Reaction) -> Vec<usize> {
    let mut species = match &reaction.rate {
        Rate::MassAction(_) | Rate::Surface(_) => reaction.reactants.iter().map(|&(s, _)| s).collect(),
        Rate::Law(program) => program.uses(),
    };
    species.sort_unstable();
    species.dedup();
    species
}

/// For each reaction the reactions whose propensity it changes; Gibson & Bruck, J. Phys. Chem. A 104, 1876
/// (2000). Unlike theirs, a reaction is listed under itself only if it changes its own reactants.
#[must_use]
pub fn dependents(network: &Network) -> Vec<Vec<usize>> {
    let mut readers = vec![Vec::new(); network.species.len()];
    for (r, reaction) in network.reactions.iter().enumerate() {
        for s in depends_on(reaction) {
            readers[s].push(r);
        }
    }
    let of = |reaction: &Reaction| {
        let mut list: Vec<usize> = reaction.change().iter().flat_map(|&(s, _)| readers[s].clone()).collect();
        list.sort_unstable();
        list.dedup();
        list
    };
    network.reactions.iter().map(of).collect()
}

/// Conserved sums in words: `R + RL`, `A + 2 B`.
#[must_use]
pub fn conservation_words(analysis: &Analysis, network: &Network) -> Vec<String> {
    analysis.conservation.iter().map(|law| sum_words(law, network)).collect()
}

fn sum_words(law: &[i64], network: &Network) -> String {
    let mut text = String::new();
    for (species, &c) in network.species.iter().zip(law).filter(|(_, c)| **c != 0) {
        match (text.is_empty(), c < 0) {
            (true, true) => text.push('-'),
            (true, false) => {}
            (false, true) => text.push_str(" - "),
            (false, false) => text.push_str(" + "),
        }
        if c.abs() != 1 {
            text.push_str(&format!("{} ", c.abs()));
        }
        text.push_str(&species.name);
    }
    text
}

type Complexes = Vec<Vec<(usize, u32)>>;

/// The distinct complexes and, for each reaction, from which to which it leads.
fn complexes(network: &Network) -> (Complexes, Vec<(usize, usize)>) {
    let mut complexes: Complexes = Vec::new();
    let mut index_of = |side: &[(usize, u32)]| {
        let mut side = side.to_vec();
        side.sort_unstable();
        complexes.iter().position(|known| *known == side).unwrap_or_else(|| {
            complexes.push(side);
            complexes.len() - 1
        })
    };
    let arrows = network.reactions.iter().map(|r| (index_of(&r.reactants), index_of(&r.products))).collect();
    (complexes, arrows)
}

fn linkage_classes(complexes: usize, arrows: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut graph = UnGraph::<(), ()>::with_capacity(complexes, arrows.len());
    let nodes: Vec<NodeIndex> = (0..complexes).map(|_| graph.add_node(())).collect();
    for &(from, to) in arrows {
        graph.add_edge(nodes[from], nodes[to], ());
    }
    // Components of an undirected graph are its strongly connected ones.
    let mut classes: Vec<Vec<usize>> = petgraph::algo::tarjan_scc(&graph)
        .into_iter()
        .map(|class| {
            let mut members: Vec<usize> = class.into_iter().map(NodeIndex::index).collect();
            members.sort_unstable();
            members
        })
        .collect();
    classes.sort();
    classes
}

fn weakly_reversible(complexes: usize, arrows: &[(usize, usize)], classes: usize) -> bool {
    let mut graph = DiGraph::<(), ()>::new();
    let nodes: Vec<NodeIndex> = (0..complexes).map(|_| graph.add_node(())).collect();
    for &(from, to) in arrows {
        graph.add_edge(nodes[from], nodes[to], ());
    }
    petgraph::algo::tarjan_scc(&graph).len() == classes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::reactions::tests::network;

    #[test]
    fn binding_conserves_receptors_and_ligand() {
        let network = network(
            "species: { L: , R: , RL: }\nreactions: { b: { equation: R + L <-> RL, rate: 1, reverse: 1 } }\n",
        );
        let analysis = analyse(&network);
        let mut words = conservation_words(&analysis, &network);
        words.sort();
        assert_eq!(words, ["L + RL", "R + RL"]);
        assert_eq!((analysis.rank, analysis.deficiency), (1, 0));
        assert_eq!(analysis.complexes.len(), 2);
        assert_eq!(analysis.linkage_classes, [[0, 1]]);
        assert!(analysis.weakly_reversible);
        assert_eq!(analysis.orders, [2, 1]);
        assert_eq!(analysis.dependents, [[0, 1], [0, 1]]);
        assert_eq!(analysis.stoichiometry.column(0).as_slice(), [-1, -1, 1]);
    }

    #[test]
    fn michaelis_menten_has_two_laws_and_deficiency_zero() {
        let network = network(
            "species: { E: , S: , ES: , P: }\nreactions:\n  bind: { equation: E + S <-> ES, rate: 1, reverse: 1 }\n  cat: { equation: ES -> E + P, rate: 1 }\n",
        );
        let analysis = analyse(&network);
        let mut words = conservation_words(&analysis, &network);
        words.sort();
        assert_eq!(words, ["E + ES", "S + ES + P"]);
        assert_eq!((analysis.deficiency, analysis.weakly_reversible), (0, false));
    }

    #[test]
    fn dimerisation_counts_monomers_and_open_networks_conserve_nothing() {
        let closed = network("species: { A: , B: }\nreactions: { d: { equation: 2 A -> B, rate: 1 } }\n");
        assert_eq!(conservation_words(&analyse(&closed), &closed), ["A + 2 B"]);
        let open = network(
            "species: { A: }\nreactions:\n  f: { equation: 0 -> A, rate: 1 }\n  d: { equation: A -> 0, rate: 1 }\n",
        );
        let analysis = analyse(&open);
        assert!(analysis.conservation.is_empty());
        assert_eq!((analysis.deficiency, analysis.complexes.len()), (0, 2));
        assert_eq!(analysis.dependents, [vec![1], vec![1]], "feeding has a constant propensity");
    }

    #[test]
    fn schloegl_has_the_published_deficiency_and_differences_are_signed() {
        // Schlögl's model A + 2X <-> 3X, B <-> X with A and B counted: complexes 4, classes 2, rank 2.
        let schloegl = network(
            "species: { A: , B: , X: }\nreactions:\n  a: { equation: A + 2 X <-> 3 X, rate: 1, reverse: 1 }\n  b: { equation: B <-> X, rate: 1, reverse: 1 }\n",
        );
        let analysis = analyse(&schloegl);
        assert_eq!((analysis.complexes.len(), analysis.linkage_classes.len(), analysis.rank), (4, 2, 2));
        assert_eq!(analysis.deficiency, 0);
        assert_eq!(conservation_words(&analysis, &schloegl), ["A + B + X"]);
        // Only the difference is conserved.
        let pair = network("species: { A: , B: }\nreactions: { p: { equation: 0 -> A + B, rate: 1 } }\n");
        assert_eq!(conservation_words(&analyse(&pair), &pair), ["A - B"]);
    }
}
