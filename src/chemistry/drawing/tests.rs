use super::layout::{Box2, place};
use super::*;
use crate::model::reactions::tests::network;

fn binding() -> Network {
    network(
        "name: binding <&>\nspecies:\n  L: { diffusion: 347 um^2/s }\n  R: { only_in: [membrane] }\n  RL: { only_in: [membrane], representation: discrete }\nreactions:\n  b: { equation: R + L <-> RL, rate: 1, reverse: 0.5 }\n  d: { equation: 2 L -> 0, rate: 3 }\n  f: { equation: 0 -> L, rate: 1, only_in: inlet }\n",
    )
}

#[test]
fn the_text_says_it_all() {
    let expected = "\
binding <&>
  kinetics: concentration (rate constants in mol, m, s)

species (3)
  L   diffusivity 3.47e-10 m^2/s
  R   diffusivity 0 m^2/s, only in membrane
  RL  diffusivity 0 m^2/s, only in membrane, discrete

reactions (4)
  b            R + L -> RL  order 2  a = 1 m^3/mol/s / (N_A V) * X_R * X_L
  b (reverse)  RL -> R + L  order 1  a = 0.5 1/s * X_RL
  d            2 L -> 0     order 2  a = 3 m^3/mol/s / (N_A V) * X_L (X_L - 1), L changes by -2
  f            0 -> L       order 0  a = 1 mol/m^3/s * N_A V, only in inlet

conservation laws (1)
  R + RL

linkage classes (2)
  { L + R, RL }
  { 2 L, 0, L }

deficiency 1 = 5 complexes - 2 linkage classes - rank 2
";
    assert_eq!(text(&binding()), expected);
}

#[test]
fn dot_and_svg_hold_every_node_and_escape_names() {
    let dot = dot(&binding());
    assert_eq!(dot.matches("shape=box").count(), 3);
    assert_eq!(dot.matches("shape=circle").count(), 3);
    assert_eq!(dot.matches(" -> ").count(), 5);
    let svg = svg(&binding());
    assert_eq!(svg.matches("<circle").count(), 3);
    assert_eq!(svg.matches("rx=\"9\"").count(), 3);
    assert_eq!(svg.matches("<path d=\"M").count(), 5 + 1, "five lines and the arrow head");
    assert!(svg.contains("binding &lt;&amp;&gt;") && !svg.contains("<&>"));
    assert_eq!(svg.matches("<g>").count(), svg.matches("</g>").count());
}

#[test]
fn nodes_never_overlap() {
    // A ring, a star and loners: 20 nodes.
    let mut edges: Vec<(usize, usize)> = (0..8).map(|k| (k, (k + 1) % 8)).collect();
    edges.extend((9..15).map(|k| (8, k)));
    edges.extend([(14, 8), (3, 12), (12, 3)]);
    let nodes: Vec<Box2> = (0..20).map(|k| Box2 { width: 40.0 + 3.0 * f64::from(k) }).collect();
    let layout = place(&nodes, &edges);
    for a in 0..nodes.len() {
        for b in 0..a {
            let dx = (layout.centre[a][0] - layout.centre[b][0]).abs();
            let dy = (layout.centre[a][1] - layout.centre[b][1]).abs();
            assert!(dx > 0.5 * (nodes[a].width + nodes[b].width) || dy > 40.0, "{a} and {b}");
        }
        let [x, y] = layout.centre[a];
        assert!(x > 0.0 && y > 0.0 && x < layout.size[0] && y < layout.size[1]);
    }
}

#[test]
fn an_empty_network_is_drawn() {
    let alone = network("species: { A: }\n");
    assert!(svg(&alone).contains(">A<"));
    assert!(text(&alone).contains("deficiency 0"));
}

/// Writes pictures for the eye: `DRAWINGS=folder cargo test --release draw_examples -- --ignored`.
#[test]
#[ignore = "writes files for inspection"]
fn draw_examples() {
    let Ok(folder) = std::env::var("DRAWINGS") else { return };
    let enzyme = network(
        "species: [E, S, ES, P, F, FP]\nreactions:\n  bind: { equation: E + S <-> ES, rate: 1, reverse: 1 }\n  catalysis: { equation: ES -> E + P, rate: 1 }\n  binds: { equation: F + P <-> FP, rate: 1, reverse: 1 }\n  back: { equation: FP -> F + S, rate: 1 }\n",
    );
    let oregonator = network(
        "species: [A, B, X, Y, Z, P]\nreactions:\n  one: { equation: A + Y -> X + P, rate: 1 }\n  two: { equation: X + Y -> 2 P, rate: 1 }\n  three: { equation: A + X -> 2 X + 2 Z, rate: 1 }\n  four: { equation: 2 X -> A + P, rate: 1 }\n  five: { equation: B + Z -> Y, rate: 1 }\n",
    );
    for (name, network) in [("binding", binding()), ("enzyme", enzyme), ("oregonator", oregonator)] {
        std::fs::write(format!("{folder}/{name}.svg"), svg(&network)).unwrap();
    }
}
