//! What a reactions file may say, and every way it is refused: message, line and column.

use super::*;
use crate::chemistry::network::Rate;
use crate::error::Source;
use crate::model::node::parse;
use rstest::rstest;
use std::sync::Arc;

/// A network from text that is known to be right.
pub(crate) fn network(text: &str) -> Network {
    let (network, faults) = read_text(text);
    assert!(faults.is_empty(), "{}", faults.into_error());
    network.unwrap()
}

fn read_text(text: &str) -> (Option<Network>, Faults) {
    let source = Arc::new(Source::new("r.yaml", text));
    let mut faults = Faults::new();
    let node = parse(&source).unwrap_or_else(|error| panic!("{error}"));
    let network = read(&node, &mut faults);
    (network, faults)
}

const CONTRACT: &str = r#"
name: alpha-factor binding
description: The example of the manual.
species:
  L:  { diffusion: 347 um^2/s }
  R:  { diffusion: 0, only_in: [membrane] }
  RL: { diffusion: 0, only_in: membrane, representation: discrete }
  S:
  P: {}
parameters:
  k_on: 1.0 m^3/mol/s
  k_off: 1.0 1/s
  vmax: 1 uM/s
  km: 3 uM
kinetics: concentration
reactions:
  binding: { equation: R + L <-> RL, rate: k_on, reverse: 2 * k_off }
  decay:   { equation: L -> 0, rate: 0.01 1/s }
  feed:    { equation: 0 -> L, rate: 1 nM/s, only_in: [inlet] }
  enzyme:  { equation: S -> P, law: "vmax * S / (km + S)" }
  1:       { equation: 2 S -> P, rate: 2e6 /M/s }
"#;

#[test]
fn the_example_of_the_contract_is_read() {
    let network = network(CONTRACT);
    assert_eq!(network.name, "alpha-factor binding");
    assert_eq!(network.kinetics, Kinetics::Concentration);
    assert_eq!(network.species.len(), 5);
    assert_eq!(network.species[0].diffusion, 347e-12);
    for species in &network.species[1..3] {
        assert_eq!(species.only_in.as_ref().unwrap()[0].name, "membrane");
    }
    assert_eq!(network.species[2].representation, Some(Representation::Discrete));
    let names: Vec<&str> = network.reactions.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["binding", "binding (reverse)", "decay", "feed", "enzyme", "1"]);
    let rates: Vec<f64> = network
        .reactions
        .iter()
        .map(|r| if let Rate::MassAction(k) = r.rate { k } else { f64::NAN })
        .collect();
    // 1 nM/s = 1e-6 mol/m³/s; 2e6 /M/s = 2e3 m³/mol/s.
    assert_eq!(rates[..4], [1.0, 2.0, 0.01, 1e-6]);
    assert_eq!(rates[5], 2e3);
    assert_eq!(network.reactions[0].equation, "R + L -> RL");
    assert_eq!(network.reactions[1].equation, "RL -> R + L");
    assert_eq!(network.reactions[3].equation, "0 -> L");
    assert_eq!(network.reactions[3].only_in.as_ref().unwrap()[0].name, "inlet");
    assert_eq!(network.reactions[5].reactants, [(3, 2)]);
    assert_eq!(network.reactions[2].place.line, 18);
    let Rate::Law(law) = &network.reactions[4].rate else { panic!("a law") };
    assert_eq!(law.uses(), [3]);
}

#[test]
fn molecules_and_lists_of_species() {
    let text = "kinetics: molecules\nspecies: [A, B]\nreactions:\n  d: { equation: 2 A -> B, rate: 0.1 1/s }\n  e: { equation: B -> 0, law: 0.5 s^-1 * B }\n  f: { equation: 0 -> A, rate: 3 }\n";
    let network = network(text);
    assert_eq!(network.kinetics, Kinetics::Molecules);
    assert_eq!(network.reactions.len(), 3);
}

/// A file with one reaction and a place for more in it; the reaction stands in line 6 from column 8.
fn with_reaction(reaction: &str) -> String {
    format!(
        "species:\n  R: {{ diffusion: 0 }}\n  L: {{ diffusion: 347 um^2/s }}\nparameters: {{ k_on: 1 m^3/mol/s, k: 2 }}\nreactions:\n  one: {{ {reaction} }}\n"
    )
}

#[rstest]
#[case("equation: R + Q -> L, rate: 1", 24, "unknown species \"Q\"", "species are declared in r.yaml:1")]
#[case("equation: r + L -> 0, rate: 1", 20, "unknown species \"r\"", "did you mean \"R\"?")]
#[case("equation: 2 RR -> L, rate: 1", 22, "unknown species \"RR\"", "did you mean \"R\"?")]
#[case("equation: 4 R -> L, rate: 1", 20, "of order 4", "law")]
#[case("equation: R -> L, rate: -1 1/s", 34, "may not be negative", "reverse")]
#[case("equation: R -> L, rate: -1", 34, "may not be negative", "")]
#[case("equation: R -> L, rate: .nan", 34, "found not a number", "")]
#[case("equation: R -> L, rate: .inf", 34, "infinite", "")]
#[case("equation: R -> L, rate: 1 m", 34, "found length (m), expected rate (1/s)", "1/s")]
#[case("equation: R + L -> 0, rate: 1 1/s", 38, "expected m^3/mol/s for the rate constant of order 2", "")]
#[case("equation: R -> L, rate: k_on", 34, "found m^3/mol/s, expected rate (1/s)", "")]
#[case("equation: R -> L, rate: k_onn", 34, "unknown name \"k_onn\"", "did you mean \"k_on\"?")]
#[case("equation: R -> L, rate: 2 * k_on", 34, "expected rate (1/s)", "")]
#[case("equation: R -> L, rate: 2 * L", 34, "depends on the species \"L\"", "law")]
#[case("equation: R -> L, rate: 3 1/sx", 38, "unknown unit \"sx\"", "")]
#[case("equation: R -> L, rate: [1]", 34, "found a list", "")]
#[case("equation: R -> L, rate: 1, reverse: 2", 46, "belongs to an equation with \"<->\"", "")]
#[case("equation: R <-> L, rate: 1", 20, "needs \"reverse\"", "")]
#[case("equation: R <-> L, law: k * R", 34, "belongs to one direction", "")]
#[case("equation: R -> L, rate: 1, law: k * R", 34, "has a rate and a law", "")]
#[case("equation: R -> L", 3, "\"rate\" is missing", "")]
#[case("rate: 1", 8, "\"equation\" is missing", "")]
#[case("equation: R -> R, rate: 1", 20, "changes nothing", "")]
#[case("equation: R + L <-> L + R, rate: 1, reverse: 1", 20, "changes nothing", "")]
#[case("equation: 2R -> L, rate: 1", 20, "do not start with a digit", "write \"2 R\"")]
#[case("equation: R L, rate: 1", 20, "needs an arrow", "")]
#[case("equation: R -> L, rate: 1, only_in: []", 46, "empty list", "")]
#[case("equation: R -> L, rate: 1, onlyin: x", 37, "unknown key \"onlyin\"", "did you mean \"only_in\"?")]
#[case("equation: R -> L, rate: 1, rate: 2", 37, "\"rate\" is given twice", "r.yaml:6:28")]
#[case("equation: R -> L, law: \"R / (km + R)\"", 39, "unknown name \"km\"", "")]
#[case("equation: R -> L, law: \"k_on * R\"", 34, "expected concentration per time", "")]
#[case("equation: R -> L, law: -1", 33, "may not be negative", "")]
fn bad_reactions_say_where_and_what(
    #[case] reaction: &str,
    #[case] column: u32,
    #[case] reason: &str,
    #[case] remedy: &str,
) {
    let (_, faults) = read_text(&with_reaction(reaction));
    let list = faults.into_error().faults;
    assert!(!list.is_empty(), "{reaction} is accepted");
    let shown: String = list.iter().map(ToString::to_string).collect();
    let fault = list.iter().find(|f| f.reason.contains(reason)).unwrap_or_else(|| panic!("{shown}"));
    let place = fault.place.as_ref().unwrap();
    assert!(fault.remedy.contains(remedy), "{shown}");
    assert_eq!((place.line, place.column), (6, column), "{shown}");
    assert_eq!(list.len(), 1, "{shown}");
}

#[rstest]
#[case("reactions: {}\n", 1, 1, "\"species\" is missing")]
#[case("species: { A: { diffusion: -1 um^2/s } }\n", 1, 28, "may not be negative")]
#[case("species: { A: { diffusion: 5 um } }\n", 1, 28, "expected a diffusivity (m^2/s), found a length (m)")]
#[case("species: { A: { difusion: 1 } }\n", 1, 17, "unknown key \"difusion\"")]
#[case("species: { A: { representation: discreet } }\n", 1, 33, "not one of discrete, continuous")]
#[case("species: { A: 3 }\n", 1, 15, "expected a mapping, found the number 3")]
#[case("species: { A-b: }\n", 1, 12, "no name of a species")]
#[case("species: { exp: }\n", 1, 12, "is a function")]
#[case("species: { pi: }\n", 1, 12, "is a function")]
#[case("species: { A: , A: }\n", 1, 17, "\"A\" is given twice")]
#[case("species: [A, A]\n", 1, 14, "\"A\" is given twice")]
#[case("species: {}\n", 1, 10, "no species")]
#[case("species: A\n", 1, 10, "expected a mapping")]
#[case("species: { A: }\nparameters: { A: 1 }\n", 2, 15, "\"A\" is a species and a parameter")]
#[case("species: { A: }\nparameters: { k: 1_000 }\n", 2, 18, "not a number")]
#[case("species: { A: }\nparameters: { k: .nan }\n", 2, 18, "expected a finite number")]
#[case("species: { A: }\nparameters: { k: 5 umm }\n", 2, 20, "unknown unit \"umm\"")]
#[case("species: { A: }\nparameters: { max: 5 }\n", 2, 15, "is a function")]
#[case("species: { A: }\nkinetics: concentrations\n", 2, 11, "not one of concentration, molecules")]
#[case("species: { A: }\nreaction: {}\n", 2, 1, "unknown key \"reaction\"")]
#[case("species: { A: }\nreactions: [1]\n", 2, 12, "expected a mapping, found a list")]
#[case(
    "species: { A: }\nkinetics: molecules\nreactions: { d: { equation: 2 A -> 0, rate: 1 m^3/mol/s } }\n",
    3,
    45,
    "kinetics: molecules"
)]
fn bad_files_say_where(#[case] text: &str, #[case] line: u32, #[case] column: u32, #[case] reason: &str) {
    let (_, faults) = read_text(text);
    let list = faults.into_error().faults;
    assert!(!list.is_empty(), "{text} is accepted");
    let fault = &list[0];
    let place = fault.place.as_ref().unwrap();
    assert!(fault.reason.contains(reason), "{fault}");
    assert_eq!((place.line, place.column), (line, column), "{fault}");
    assert_eq!(list.len(), 1, "{}", list.iter().map(ToString::to_string).collect::<String>());
}

#[test]
fn one_fault_never_hides_another() {
    let text = "species:\n  A: { diffusion: 5 um }\n  B: { diffusion: -1 }\n  A: {}\nparameters: { k: 1 parsec }\nreactions:\n  one: { equation: A -> C, rate: kk }\n  two: { equation: A + B, rate: -1 }\n  three: { equation: A -> B }\n  one: { equation: B -> A, rate: k }\nfoo: 1\n";
    let (network, faults) = read_text(text);
    let lines: Vec<u32> =
        faults.into_error().faults.iter().map(|f| f.place.as_ref().map_or(0, |p| p.line)).collect();
    assert_eq!(lines, [2, 3, 4, 5, 7, 7, 8, 8, 9, 10, 11]);
    // What could be read is there for the checks of the model around it.
    assert_eq!(network.unwrap().species.len(), 2);
}

#[test]
fn names_of_directions_are_told_apart() {
    let text = "species: [A, B]\nreactions:\n  d: { equation: A <-> B, rate: 1, reverse: 1 }\n  d (reverse): { equation: B -> 0, rate: 1 }\n";
    let (_, faults) = read_text(text);
    assert_eq!(faults.list.len(), 1);
    assert!(faults.list[0].reason.contains("\"d (reverse)\" is given twice"));
}

proptest::proptest! {
    /// Whatever is cut out of or put into a good file, reading ends, and faults lie inside the file.
    #[test]
    fn damaged_files_never_panic(
        at in 0_usize..700, cut in 0_usize..12, put in "[-:{},\\[\\]&*#|>\"'%@! \n\tA0.e<+]{0,4}",
    ) {
        let mut characters: Vec<char> = CONTRACT.chars().collect();
        let at = at.min(characters.len());
        let end = (at + cut).min(characters.len());
        characters.splice(at..end, put.chars());
        let text: String = characters.into_iter().collect();
        let source = Arc::new(Source::new("r.yaml", text));
        let mut faults = Faults::new();
        match parse(&source) {
            Ok(node) => {
                read(&node, &mut faults);
            }
            Err(error) => error.faults.into_iter().for_each(|fault| faults.push(fault)),
        }
        let lines = source.text.lines().count() as u32;
        for fault in faults.list {
            let place = fault.place.clone().expect("a place");
            proptest::prop_assert!(place.line >= 1 && place.line <= lines.max(1), "{fault}");
            proptest::prop_assert!(!fault.reason.is_empty());
        }
    }
}
