//! What a user can get wrong: one message with place, reason and remedy, exit status 2, nothing written.

use assert_cmd::Command;
use rstest::rstest;
use std::path::Path;
use tempfile::TempDir;

const VOLUME: &str = "\
name: t
reactions:
  species: { A: { diffusion: 1 um^2/s }, B: { diffusion: 0 } }
  kinetics: concentration
  parameters: { k: 1 1/s, zero: 0 }
  reactions: { decay: { equation: A -> B, rate: k } }
domain: { kind: well_mixed, volume: 1 fL }
initial: { A: 100 }
run: { until: 1 s, realizations: 3, seed: 1 }
output: { every: 0.1 s }
";

const PARTICLES: &str = "\
name: t
reactions:
  species: { A: { diffusion: 1 um^2/s }, B: { diffusion: 0 } }
  reactions: { decay: { equation: A -> B, rate: 1 1/s } }
domain:
  kind: particles
  dimensions: 2
  min: [0, 0]
  max: [8 um, 8 um]
  boundaries: { x: periodic, y: no_slip }
particles: { spacing: 1 um, support: 2 }
groups:
  medium: { material: fluid, shape: everything_else }
fluid: { method: sph_bvf, density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s }
initial: { medium: { A: 1000 } }
run: { until: 1 us, realizations: 2, seed: 1 }
output: { every: 1 us }
";

fn gillesph(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output =
        Command::cargo_bin("gillesph").unwrap().current_dir(folder).args(arguments).output().unwrap();
    assert!(output.stdout.is_empty(), "nothing belongs on standard output");
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// Runs a model with one change; the only entry of its folder must stay the model.
fn refused(model: &str, from: &str, to: &str, options: &[&str]) -> String {
    assert!(model.contains(from), "{from}");
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("m.yaml"), model.replacen(from, to, 1)).unwrap();
    let (status, message) = gillesph(folder.path(), &[&["run", "m.yaml"], options].concat());
    assert_eq!(status, 2, "{message}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "something was written");
    assert!(!message.contains("should never be in"), "{message}");
    message
}

#[rstest]
#[case::unknown_species("A -> B", "A -> Bb", "m.yaml:6:40", &["unknown species \"Bb\"", "did you mean \"B\""])]
#[case::unknown_species_at_the_start("{ A: 100", "{ AA: 100", "m.yaml:8:12", &["unknown species `AA`", "did you mean `A`"])]
#[case::unknown_unit("1 fL", "1 fLitre", "m.yaml:7:39", &["unknown unit \"fLitre\"", "units are written"])]
#[case::wrong_dimension("1 fL", "1 um", "m.yaml:7:37", &["expected a volume", "found a length"])]
#[case::syntax("100 }", "100", "m.yaml:9:4", &["not valid YAML", "missing comma"])]
#[case::tab("  kinetics", "\tkinetics", "m.yaml:4:1", &["a tab in the indentation"])]
#[case::duplicate_key("seed: 1", "seed: 1, seed: 2", "m.yaml:9:46", &["\"seed\" is given twice", "m.yaml:9:37"])]
#[case::unknown_key("seed: 1", "sead: 1", "m.yaml:9:37", &["unknown key \"sead\"", "did you mean \"seed\""])]
#[case::order_four("A -> B", "2 A + 2 B -> B", "m.yaml:6:35", &["order 4", "up to 3"])]
#[case::negative_rate("rate: k", "rate: -1 1/s", "m.yaml:6:49", &["a rate may not be negative", "reverse"])]
#[case::rate_not_a_number("rate: k", "rate: .nan", "m.yaml:6:49", &["expected a finite number"])]
#[case::infinite_rate("rate: k", "rate: .inf", "m.yaml:6:49", &["expected a finite number"])]
#[case::division_by_zero("rate: k", "rate: k / zero", "m.yaml:6:49", &["not a finite number", "division by zero"])]
#[case::law_with_unknown_name("rate: k", "law: \"vmax * A\"", "m.yaml:6:49", &["unknown name \"vmax\"", "A, B, k"])]
#[case::law_of_wrong_dimension("rate: k", "law: \"A * A\"", "m.yaml:6:49", &["expected concentration per time"])]
#[case::only_in_without_groups("B: { diffusion: 0", "B: { diffusion: 0, only_in: cell", "m.yaml:3:70", &["unknown group `cell`", "no groups"])]
#[case::negative_conductance("well_mixed, volume: 1 fL", "graph, volumes: [1 fL, 1 fL], links: [[0, 1, -1 um]]", "m.yaml:7:62", &["may not be negative"])]
#[case::unstable_euler("well_mixed, volume: 1 fL }", "graph, volumes: [1 fL, 1 fL], links: [[0, 1, 1 um]] }\nchemistry: { integrator: euler, representation: continuous, step: 3 s }", "m.yaml:8:12", &["forward Euler is unstable", "below 1.000e0 s"])]
#[case::no_realizations("realizations: 3", "realizations: 0", "m.yaml:9:34", &["realizations from 1", "found 0"])]
#[case::half_a_realization("realizations: 3", "realizations: 2.5", "m.yaml:9:34", &["expected a whole number"])]
#[case::no_threads("seed: 1", "seed: 1, threads: 0", "m.yaml:9:55", &["1 to 4096 threads"])]
#[case::negative_molecules("A: 100", "A: -5", "m.yaml:8:15", &["whole number of molecules", "found -5"])]
#[case::amount_without_unit("A: 100", "A: \"10.5\"", "m.yaml:8:16", &["has no unit", "20 nM"])]
#[case::half_a_molecule("A: 100", "A: 2.5", "m.yaml:8:15", &["whole number of molecules", "found 2.5"])]
#[case::concentration_in_metres("A: 100", "A: 5 um", "m.yaml:8:15", &["expected a concentration", "found a length"])]
#[case::negative_concentration("A: 100", "A: -5 nM", "m.yaml:8:15", &["concentration may not be negative"])]
#[case::output_after_the_end("every: 0.1 s", "times: [0, 3 s]", "m.yaml:10:22", &["3 s lies after the end"])]
#[case::too_many_outputs("every: 0.1 s", "every: 1e-12 s", "m.yaml:10:18", &["output times", "at most a million"])]
#[case::histogram_of_unknown("every: 0.1 s", "histogram: [ { species: C } ]", "m.yaml:10:35", &["unknown species `C`"])]
#[case::section_of_particles("output", "groups: { a: {} }\noutput", "m.yaml:10:9", &["belongs to a domain of kind particles"])]
#[case::too_much_memory("realizations: 3", "realizations: 4000000000", "m.yaml:9:6", &["of memory", "are free", "--realizations A..B"])]
#[case::unknown_method("initial", "chemistry: { method: tau_leeping }\ninitial", "m.yaml:8:22", &["did you mean", "tau_leaping"])]
#[case::tolerance_of_another_method("initial", "chemistry: { tolerance: 0.1 }\ninitial", "m.yaml:8:25", &["belongs to tau-leaping"])]
#[case::event_driven_rate_equations("initial", "chemistry: { method: next_reaction, representation: continuous }\ninitial", "m.yaml:8:12", &["needs discrete species", "split"])]
#[case::time_that_ends_at_once("until: 1 s", "until: 0 s", "m.yaml:9:15", &["expected a positive time"])]
fn of_a_volume(#[case] from: &str, #[case] to: &str, #[case] place: &str, #[case] words: &[&str]) {
    check(&refused(VOLUME, from, to, &[]), place, words);
}

#[rstest]
#[case::only_in_no_group("B: { diffusion: 0", "B: { diffusion: 0, only_in: mediom", "m.yaml:3:70", &["unknown group `mediom`", "did you mean `medium`"])]
#[case::empty_group("groups:\n", "groups:\n  cell: { shape: { disc: { centre: [99 um, 0], radius: 1 um } } }\n", "m.yaml:13:3", &["group `cell` has no particles"])]
#[case::overlapping_walls("groups:\n", "groups:\n  a: { material: wall, shape: { disc: { centre: [3 um, 4 um], radius: 2 um } } }\n  b: { material: wall, shape: { disc: { centre: [5 um, 4 um], radius: 2 um } } }\n", "m.yaml:13:3", &["the walls `a` and `b` overlap", "difference"])]
#[case::spacing_that_does_not_fit("spacing: 1 um", "spacing: 0.3 um", "m.yaml:13:3", &["does not fit the box", "whole cells"])]
#[case::two_take_the_rest("groups:\n", "groups:\n  rest: { shape: everything_else }\n", "m.yaml:14:3", &["`everything_else`", "only one"])]
#[case::group_named_all("groups:\n  medium", "groups:\n  all", "m.yaml:13:3", &["`all` is taken"])]
#[case::short_periodic_axis("[8 um, 8 um]", "[4 um, 8 um]", "m.yaml:6:3", &["periodic axis x", "3 cut-offs"])]
#[case::short_axis_in_metres("  max: [8 um, 8 um]\n  boundaries: { x: periodic, y: no_slip }\nparticles: { spacing: 1 um, support: 2 }", "  max: [8 m, 3 m]\n  boundaries: { x: periodic, y: no_slip }\nparticles: { spacing: 1 m, support: 4 }", "m.yaml:6:3", &["the box is 8 m along the periodic axis x; 3 cut-offs of 4 m are needed", "closed axis y; 1 cut-off of 4 m is needed"])]
#[case::box_inside_out("[8 um, 8 um]", "[-8 um, 8 um]", "m.yaml:9:8", &["no extent along x"])]
#[case::too_many_particles("[8 um, 8 um]", "[8 m, 8 m]", "m.yaml:6:3", &["of memory", "spacing coarser"])]
#[case::too_many_fluid_steps("until: 1 us, realizations: 2, seed: 1 }\noutput: { every: 1 us }", "until: 1e5 s }\noutput: { every: 1e4 s }", "m.yaml:16:6", &["fluid steps", "at most 1e9", "set by viscosity"])]
#[case::too_many_chemistry_steps("initial:", "chemistry: { step: 1e-20 s }\ninitial:", "m.yaml:15:12", &["chemistry steps", "the step given in the model"])]
#[case::species_named_like_a_column("B: {", "vx: {", "m.yaml:3:42", &["`vx` is taken", "particle tables"])]
#[case::species_named_like_a_group("B: {", "medium: {", "m.yaml:3:42", &["`medium` is taken", "a group"])]
#[case::line_outside("every: 1 us", "probes: { p: { line: { from: [0, 0], to: [9 um, 0] } } }", "m.yaml:17:52", &["`to` lies outside the box"])]
#[case::ring_outside("every: 1 us", "probes: { p: { ring: { centre: [4 um, 30 um], inner: 1 um, outer: 2 um } } }", "m.yaml:17:32", &["the ring lies outside the box"])]
#[case::histogram_in_no_group("every: 1 us", "histogram: [ { species: A, in: cell } ]", "m.yaml:17:42", &["unknown group `cell`"])]
#[case::unknown_condition("initial:", "conditions: { c: { spong: {} } }\ninitial:", "m.yaml:15:20", &["unknown condition `spong`"])]
#[case::weights_that_could_be_negative("support: 2", "support: 2, weights: corrected", "m.yaml:11:50", &["can be negative", "weights: normalised"])]
#[case::unknown_weights("support: 2", "support: 2, weights: soft", "m.yaml:11:50", &["not one of normalised, plain, softened"])]
#[case::euler_for_molecules("initial:", "chemistry: { integrator: euler, step: 1 ns }\ninitial:", "m.yaml:15:12", &["continuous species", "which `A` is not"])]
#[case::euler_without_step("initial:", "chemistry: { integrator: euler, representation: continuous }\ninitial:", "m.yaml:15:12", &["none is", "add one"])]
#[case::euler_in_a_flow("initial:", "chemistry: { integrator: euler, representation: continuous, step: 1 ns }\ninitial:", "m.yaml:15:12", &["particles at rest", "method: none"])]
#[case::event_driven_particles("initial:", "chemistry: { method: direct }\ninitial:", "m.yaml:15:12", &["particles at rest", "split method"])]
#[case::tau_leaping_on_particles("fluid: { method: sph_bvf, density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s }", "fluid: { method: none }\nchemistry: { method: tau_leaping }", "m.yaml:15:12", &["one volume", "split method"])]
#[case::event_driven_continuous("fluid: { method: sph_bvf, density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s }", "fluid: { method: none }\nchemistry: { method: direct, representation: continuous }", "m.yaml:15:12", &["needs discrete species"])]
fn of_particles(#[case] from: &str, #[case] to: &str, #[case] place: &str, #[case] words: &[&str]) {
    check(&refused(PARTICLES, from, to, &[]), place, words);
}

const GRAPH: &str = "\
name: t
reactions:
  species: { A: { diffusion: 1 um^2/s }, B: { diffusion: 0 } }
  reactions: { decay: { equation: A -> B, rate: 1 1/s } }
domain: { kind: graph, volumes: [1 fL, 1 fL, 1 fL], names: [a, b, c], links: [[0, 1, 1 um], [1, 2, 1 um]] }
initial: { A: 100 }
run: { until: 1 s }
output: { every: 0.1 s }
";

#[rstest]
#[case::no_path("A: { diffusion: 1 um^2/s", "A: { diffusion: 1 um^2/s, only_in: [a, c]", "m.yaml:3:14", &["no link joins two voxels of a, c", "those in between"])]
#[case::nowhere_to_hop("A: { diffusion: 1 um^2/s", "A: { diffusion: 1 um^2/s, only_in: a", "m.yaml:3:14", &["nowhere to hop", "diffusion to 0"])]
#[case::negative_link("[0, 1, 1 um]", "[0, 1, -1 um]", "m.yaml:5:86", &["negative"])]
#[case::unknown_volume("[0, 1, 1 um]", "[a, d, 1 um]", "m.yaml:5:83", &["unknown volume `d`", "a, b, c"])]
#[case::linked_twice("[1, 2, 1 um]", "[1, 0, 1 um]", "m.yaml:5:93", &["linked twice"])]
#[case::hybrid_thresholds("initial:", "chemistry: { hybrid: { above: 100, below: 200 } }\ninitial:", "m.yaml:6:22", &["`below` lies between"])]
#[case::event_driven_hybrid("initial:", "chemistry: { method: next_subvolume, representation: hybrid }\ninitial:", "m.yaml:6:12", &["needs discrete species"])]
fn of_a_graph(#[case] from: &str, #[case] to: &str, #[case] place: &str, #[case] words: &[&str]) {
    check(&refused(GRAPH, from, to, &[]), place, words);
}

#[rstest]
#[case::unknown_method("method: sph_bvf", "method: magic", "m.yaml:14:18", &["not one of sph_bvf, sdpd, sph, none"])]
#[case::cold("1 mm/s }", "1 mm/s, temperature: -3 K }", "m.yaml:14:97", &["expected a positive temperature"])]
#[case::temperature_of_another_dimension("1 mm/s }", "1 mm/s, temperature: 3 s }", "m.yaml:14:97", &["expected a temperature (K), found a time"])]
#[case::one_component("1 mm/s }", "1 mm/s, velocity: [1 mm/s] }", "m.yaml:14:94", &["expected 2 components, found 1", "expression of x, y, z"])]
#[case::velocity_of_another_dimension("1 mm/s }", "1 mm/s, velocity: [\"1 mm * sin(x / 1 um)\", 0] }", "m.yaml:14:96", &["velocity"])]
#[case::velocity_of_unknown("1 mm/s }", "1 mm/s, velocity: [\"1 mm/s * sin(q)\", 0] }", "m.yaml:14:109", &["unknown name \"q\""])]
#[case::courant("1 mm/s }", "1 mm/s, options: { courant: 2 } }", "m.yaml:14:104", &["a Courant number of 2", "no step above 1"])]
#[case::density_rate("1 mm/s }", "1 mm/s, options: { density_rate: print } }", "m.yaml:14:109", &["not one of default, printed"])]
#[case::unknown_option("1 mm/s }", "1 mm/s, options: { shfit: 5 } }", "m.yaml:14:95", &["unknown key", "shift"])]
#[case::friction_of_sph("method: sph_bvf", "method: sph, friction: espanol_revenga", "m.yaml:14:33", &["friction of Morris", "remove `friction`"])]
#[case::shift("1 mm/s }", "1 mm/s, options: { shift: 50 } }", "m.yaml:14:102", &["a shift of 50; at most 20", "2 is usual"])]
#[case::delta("1 mm/s }", "1 mm/s, options: { delta: 3 } }", "m.yaml:14:102", &["a delta of 3; at most 1", "0.1 is usual"])]
#[case::shift_and_courant("1 mm/s }", "1 mm/s, options: { shift: 10, courant: 0.2 } }", "m.yaml:14:115", &["with a shift of 10", "above 1", "0.10 would do"])]
#[case::no_number("1 mm/s }", "1 mm/s, options: { delta: foo } }", "m.yaml:14:102", &["expected a number, found \"foo\"", "without a unit"])]
#[case::no_density("1000 kg/m^3", "water", "m.yaml:14:36", &["expected a number with a unit, found \"water\"", "5 kg/m^3"])]
#[case::celsius("1 mm/s }", "1 mm/s, temperature: 27 C }", "m.yaml:14:100", &["unknown unit \"C\"", "did you mean \"degC\""])]
fn of_fluids(#[case] from: &str, #[case] to: &str, #[case] place: &str, #[case] words: &[&str]) {
    check(&refused(PARTICLES, from, to, &[]), place, words);
}

#[rstest]
#[case::no_gravity("buoyancy: { species: A, expansion: 1 m^3/mol }", "m.yaml:15:30", &["\"gravity\" is missing"])]
#[case::expansion_of_another_dimension("buoyancy: { species: A, expansion: 1 uM, gravity: [0, -10 m/s^2] }", "m.yaml:15:55", &["found a concentration"])]
#[case::lifted_by_unknown("buoyancy: { species: Q, expansion: 1 m^3/mol, gravity: [0, -10 m/s^2] }", "m.yaml:15:41", &["unknown species"])]
#[case::held_what_stays("held: { in: y_min, species: { B: 1 uM } }", "m.yaml:15:26", &["does not diffuse", "hold the particles"])]
#[case::held_molecules_at_a_side("held: { in: y_min, species: { A: 100 } }", "m.yaml:15:26", &["holds one concentration", "A: 1 uM"])]
#[case::held_nothing("held: { in: y_min }", "m.yaml:15:26", &["holds no species", "species: { A: 1 uM }"])]
#[case::held_no_species("held: { in: medium, species: {} }", "m.yaml:15:26", &["holds no species"])]
#[case::held_and_absorbed("held: { in: y_min, species: { A: 1 uM } } }, d: { absorbing: { in: y_min, species: { A: perfect } }", "m.yaml:15:65", &["`A` of `d` (absorbing)", "`c` (held)", "remove one"])]
#[case::held_twice("held: { in: y_min, species: { A: 1 uM } } }, d: { held: { in: y_min, species: { A: 2 uM } }", "m.yaml:15:65", &["`c` (held) already rules"])]
#[case::held_at_a_periodic_side("held: { in: x_min, species: { A: 1 uM } }", "m.yaml:15:32", &["periodic along x"])]
#[case::held_surface_of_the_medium("held: { in: medium, at: surface, species: { A: 1 uM } }", "m.yaml:15:32", &["no surface of its own"])]
fn of_buoyancy_and_held_surfaces(#[case] condition: &str, #[case] place: &str, #[case] words: &[&str]) {
    let with = format!("conditions: {{ c: {{ {condition} }} }}\ninitial:");
    check(&refused(PARTICLES, "initial:", &with, &[]), place, words);
}

#[rstest]
#[case::buoyancy("buoyancy: { species: A, expansion: 1 m^3/mol, gravity: [0, 1 m/s^2] }", "m.yaml:15:30")]
#[case::force("force: { acceleration: [1 m/s^2, 0] }", "m.yaml:15:27")]
#[case::lid("moving_wall: { in: y_max, velocity: [1 mm/s, 0] }", "m.yaml:15:33")]
#[case::sponge("sponge: { in: medium, rate: 1 1/s, velocity: [1 mm/s, 0] }", "m.yaml:15:65")]
fn without_a_flow(#[case] condition: &str, #[case] place: &str) {
    let message = refused(
        &PARTICLES.replace("initial:", &format!("conditions: {{ c: {{ {condition} }} }}\ninitial:")),
        "fluid: { method: sph_bvf, density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s }",
        "fluid: { method: none }",
        &[],
    );
    check(&message, place, &["none moves here", "`fluid:`"]);
}

/// What moves a fluid that is described, with a fault, is none.
#[test]
fn a_fault_of_the_fluid_is_told_alone() {
    let lid = "conditions: { c: { moving_wall: { in: y_max, velocity: [1 mm/s, 0] } } }\ninitial:";
    let message = refused(&PARTICLES.replace("initial:", lid), "viscosity: 1 mPa s", "viscosity: 1 mPa", &[]);
    assert!(message.contains("1 fault"), "{message}");
    assert!(!message.contains("none moves here"), "{message}");
}

#[test]
fn a_probe_of_a_surface_that_nothing_passes() {
    let message = refused(PARTICLES, "every: 1 us", "every: 1 us, probes: { p: { surface: y_min } }", &[]);
    check(&message, "m.yaml:17:48", &["no molecules pass this surface", "held (at: surface)"]);
}

#[rstest]
#[case::side_of_a_periodic_axis("flux: { in: x_min, species: { A: 1 /um^2/s } }", "m.yaml:15:32", &["periodic along x", "no wall"])]
#[case::negative_flux("flux: { in: y_min, species: { A: -1 /um^2/s } }", "m.yaml:15:53", &["may not be negative"])]
#[case::flux_of_another_dimension("flux: { in: y_min, species: { A: 1 uM } }", "m.yaml:15:53", &["found a concentration"])]
#[case::flux_of_unknown("flux: { in: y_min, species: { C: 1 /um^2/s } }", "m.yaml:15:50", &["unknown species `C`"])]
#[case::absorbing_what_stays("absorbing: { in: y_min, species: { B: 1 um/s } }", "m.yaml:15:31", &["does not diffuse"])]
#[case::absorbing_at_no_speed("absorbing: { in: y_min, species: { A: 0 um/s } }", "m.yaml:15:58", &["expected a positive"])]
#[case::surface_of_the_medium("absorbing: { in: medium, species: { A: 1 um/s } }", "m.yaml:15:37", &["no surface of its own"])]
#[case::surface_of_nothing("flux: { in: wall, species: { A: 1 /um^2/s } }", "m.yaml:15:32", &["unknown group `wall`"])]
fn of_surfaces(#[case] condition: &str, #[case] place: &str, #[case] words: &[&str]) {
    let with = format!("conditions: {{ c: {{ {condition} }} }}\ninitial:");
    check(&refused(PARTICLES, "initial:", &with, &[]), place, words);
}

/// The place begins a line, the source line and a caret follow, and the words stand somewhere.
fn check(message: &str, place: &str, words: &[&str]) {
    let lines: Vec<&str> = message.lines().collect();
    let at = lines.iter().position(|line| line.starts_with(&format!("{place}  ")));
    let Some(at) = at else { panic!("no fault at {place}:\n{message}") };
    assert!(lines[at + 1].contains(" | ") && lines[at + 2].contains('^'), "{message}");
    assert!(lines[at + 3].starts_with("    "), "what to do is missing:\n{message}");
    for word in words {
        assert!(message.contains(word), "`{word}` is missing:\n{message}");
    }
}

#[rstest]
#[case(&["--realizations", "0"], "at least one realization")]
#[case(&["--realizations", "9..5"], "reversed")]
#[case(&["--realizations", "5..5"], "at least one realization")]
#[case(&["--realizations", "a..b"], "found `a`")]
#[case(&["--realizations", "-1"], "found `-1`")]
#[case(&["--threads", "0"], "1 to 4096 threads")]
#[case(&["--threads", "-2"], "'-2'")]
#[case(&["--set", "run.until"], "has no \"=\"")]
#[case(&["--set", "run.util=1 s"], "did you mean \"until\"")]
#[case(&["--set", "run.until=1 kg"], "expected a time")]
#[case(&["--set", "run.until=["], "not valid YAML")]
#[case(&["--resume"], "no run to resume")]
#[case(&["--out", "m.yaml"], "is not a folder")]
#[case(&["--out", "m.yaml/x"], "another folder with --out")]
fn of_options(#[case] options: &[&str], #[case] words: &str) {
    let message = refused(VOLUME, "name", "name", options);
    assert!(message.contains(words), "{message}");
}

#[rstest]
#[case::missing(None, "does not exist")]
#[case::empty(Some(&b""[..]), "the file is empty")]
#[case::binary(Some(&b"\x7fELF\xff\xfe\x00\x01"[..]), "not text in UTF-8")]
#[case::list(Some(&b"- a\n- b\n"[..]), "m.yaml:1:1  the model: expected a mapping")]
#[case::two_documents(Some(&b"name: a\n---\nname: b\n"[..]), "a second YAML document")]
fn of_files(
    #[case] content: Option<&[u8]>,
    #[case] words: &str,
    #[values("check", "run", "network")] verb: &str,
) {
    let folder = TempDir::new().unwrap();
    if let Some(content) = content {
        std::fs::write(folder.path().join("m.yaml"), content).unwrap();
    }
    let (status, message) = gillesph(folder.path(), &[verb, "m.yaml"]);
    assert!(status == 2 && message.contains(words), "{status}: {message}");
}

#[rstest]
#[case(&["check", "."], "is a folder")]
#[case(&["report", "."], "holds no run")]
#[case(&["report", "nowhere"], "holds no run")]
#[case(&["merge", "whole", "nowhere"], "holds no run")]
#[case(&["validate", "nocase"], "unknown case `nocase`")]
fn of_other_verbs(#[case] arguments: &[&str], #[case] words: &str) {
    let folder = TempDir::new().unwrap();
    let (status, message) = gillesph(folder.path(), arguments);
    assert!(status == 2 && message.contains(words), "{status}: {message}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_missing_reactions_file_is_pointed_at() {
    let start = VOLUME.find("reactions:").unwrap();
    let end = VOLUME.find("domain:").unwrap();
    let model = format!("{}reactions: nowhere.yaml\n{}", &VOLUME[..start], &VOLUME[end..]);
    let message = refused(&model, "name", "name", &[]);
    check(&message, "m.yaml:2:12", &["nowhere.yaml does not exist", "relative to the model file"]);
}

#[test]
fn all_faults_come_at_once_in_the_order_of_the_file() {
    let model = "\
name: a/b
reactions:
  species: { A: { diffusion: 1 um }, B: { difusion: 1 um^2/s } }
  reactions: { decay: { equation: A -> Q, rate: -1 1/s } }
domain: { kind: well_mixed, volume: 1 s }
chemistry: { method: magic }
initial: { Z: 100 }
run: { until: 1 s, realizations: 0, sed: 1 }
output: { every: -0.1 s, histogram: [ { species: K } ] }
";
    let message = refused(model, "name", "name", &[]);
    let places: Vec<&str> = message
        .lines()
        .filter(|line| line.starts_with("m.yaml:"))
        .filter_map(|l| l.split("  ").next())
        .collect();
    let expected =
        ["1:7", "3:30", "3:43", "4:40", "4:49", "5:37", "6:22", "7:12", "8:34", "8:37", "9:18", "9:50"];
    assert_eq!(places, expected.map(|at| format!("m.yaml:{at}")), "{message}");
    assert!(message.ends_with("12 faults; nothing was written\n"));
}

#[test]
fn folders_that_are_in_use_are_refused() {
    let folder = TempDir::new().unwrap();
    let run =
        |arguments: &[&str]| gillesph(folder.path(), &[&["run", "m.yaml", "--quiet"], arguments].concat());
    std::fs::write(folder.path().join("m.yaml"), VOLUME).unwrap();
    std::fs::create_dir(folder.path().join("notes")).unwrap();
    std::fs::write(folder.path().join("notes/mine.txt"), "keep").unwrap();
    for options in [&["--out", "notes"][..], &["--out", "notes", "--force"], &["--out", "notes", "--resume"]]
    {
        let (status, message) = run(options);
        assert!(status == 2 && message.contains("holds no run of this program"), "{message}");
    }
    assert_eq!(std::fs::read_dir(folder.path().join("notes")).unwrap().count(), 1);
    for (out, block) in [("a", "0..3"), ("b", "2..4"), ("c", "5..6")] {
        assert_eq!(run(&["--out", out, "--realizations", block]).0, 0);
    }
    assert_eq!(run(&["--out", "d", "--realizations", "3..5", "--seed", "9"]).0, 0);
    let (status, message) = run(&["--out", "a"]);
    assert!(status == 2 && message.contains("finished run") && message.contains("--force"), "{message}");
    for (block, words) in
        [("b", "overlap: realizations 2..3"), ("c", "3..5 are missing"), ("d", "different seeds")]
    {
        let (status, message) = gillesph(folder.path(), &["merge", "whole", "a", block]);
        assert!(status == 2 && message.contains(words), "{message}");
        assert!(!folder.path().join("whole").exists());
    }
}

/// A law that falls below zero stops the run, and the message holds all that is needed to see why.
#[test]
fn a_negative_propensity_is_shown_with_its_expression() {
    for method in
        ["direct", "next_reaction", "composition_rejection", "next_subvolume", "tau_leaping", "split"]
    {
        let folder = TempDir::new().unwrap();
        let model = VOLUME
            .replace("until: 1 s", "until: 100 s")
            .replace("every: 0.1 s", "every: 10 s")
            .replace("rate: k }", "law: \"k * (A - 90.5 nM)\" }")
            .replace(
                "initial: { A: 100 }",
                &format!("initial: {{ A: 100 }}\nchemistry: {{ method: {method} }}"),
            );
        std::fs::write(folder.path().join("m.yaml"), model).unwrap();
        let (status, message) = gillesph(folder.path(), &["run", "m.yaml"]);
        assert_eq!(status, 1, "{message}");
        for word in
            ["voxel 0", "propensity of decay", "A = 54", "B = 46", "k * (A - 90.5 nM)", "A in mol/m^3"]
        {
            assert!(message.contains(word), "{method}: `{word}` is missing:\n{message}");
        }
    }
}

#[rstest]
#[case::open_without_conditions("x: periodic", "x: open", "", "m.yaml:15:13", &["open along x", "at x_min", "pressure: 0"])]
#[case::one_end_only("x: periodic", "x: open", "a: { open: { at: x_min, pressure: 0 } }", "m.yaml:15:13", &["at x_max"])]
#[case::an_end_twice("x: periodic", "x: open", "a: { open: { at: x_min, pressure: 0 } }, b: { open: { at: x_max, pressure: 0 } }, c: { open: { at: x_max, pressure: 0 } }", "m.yaml:15:97", &["second condition for the end x_max"])]
#[case::two_velocities("x: periodic", "x: open", "a: { open: { at: x_min, velocity: [1 mm/s, 0] } }, b: { open: { at: x_max, velocity: [1 mm/s, 0] } }", "m.yaml:15:66", &["nothing sets the pressure"])]
#[case::two_open_axes("x: periodic, y: no_slip", "x: open, y: open", "", "m.yaml:10:15", &["two axes are open"])]
#[case::end_of_a_closed_axis("x: periodic", "x: periodic", "a: { open: { at: y_min, pressure: 0 } }", "m.yaml:15:32", &["not open along y", "boundaries: { y: open }"])]
#[case::no_such_end("x: periodic", "x: open", "a: { open: { at: inlet, pressure: 0 } }", "m.yaml:15:32", &["no end of the box"])]
#[case::velocity_and_pressure("x: periodic", "x: open", "a: { open: { at: x_min, velocity: [0, 0], pressure: 0 } }", "m.yaml:15:26", &["either a velocity or a pressure"])]
#[case::molecules_that_enter("x: periodic", "x: open", "a: { open: { at: x_min, pressure: 0, species: { A: 100 } } }", "m.yaml:15:26", &["is a concentration"])]
#[case::wall_at_an_open_end("x: periodic", "x: open", "a: { moving_wall: { in: x_min, velocity: [0, 1 mm/s] } }", "m.yaml:15:39", &["open along x; there is no wall"])]
#[case::held_in_what_flows_out("x: periodic", "x: open", "a: { open: { at: x_min, pressure: 0 } }, b: { open: { at: x_max, pressure: 0 } }, h: { held: { in: medium, species: { A: 1 uM } } }", "m.yaml:15:97", &["leave the box", "sponge"])]
#[case::velocity_of_another_dimension("x: periodic", "x: open", "a: { open: { at: x_min, velocity: [\"1 mm/s * 4 * y * (8 um - y)\", 0] } }, b: { open: { at: x_max, pressure: 0 } }", "m.yaml:15:51", &["volume flow rate", "expected velocity"])]
#[case::less_than_nothing_enters("x: periodic", "x: open", "a: { open: { at: x_min, velocity: [1 mm/s, 0], species: { A: \"1 uM * (y - 4 um) / 1 um\" } } }, b: { open: { at: x_max, pressure: 0 } }", "m.yaml:15:15", &["the concentration of `A` is -", "max(0, ...)"])]
#[case::an_end_with_a_fault_is_told_once("x: periodic", "x: open", "a: { open: { at: x_min, pressure: 1 mM } }, b: { open: { at: x_max, pressure: 0 } }", "m.yaml:15:49", &["expected a pressure", "1 fault"])]
fn of_open_ends(
    #[case] from: &str,
    #[case] to: &str,
    #[case] conditions: &str,
    #[case] place: &str,
    #[case] words: &[&str],
) {
    let model = PARTICLES.replace("initial:", &format!("conditions: {{ {conditions} }}\ninitial:"));
    check(&refused(&model, from, to, &[]), place, words);
}

#[rstest]
#[case::across_a_side("post", "disc: { centre: [92 um, 4 um], radius: 2 um }", "m.yaml:13:3", &["`post` has no particles", "outside the box along x"])]
#[case::half_of_the_box("post", "half_space: { point: [6 um, 0], normal: [1, 0] }", "m.yaml:13:3", &["does not go on", "as a box"])]
#[case::all_of_the_box("medium", "box: { min: [-1 um, -1 um], max: [9 um, 9 um] }", "m.yaml:14:8", &["no particle is fluid"])]
#[case::lattice_of_the_sides("spaced", "", "m.yaml:11:12", &["walls round the box", "cells along x"])]
fn of_walls(#[case] name: &str, #[case] shape: &str, #[case] place: &str, #[case] words: &[&str]) {
    let wall = format!("{name}: {{ material: wall, shape: {{ {shape} }} }}");
    let model = match name {
        "medium" => PARTICLES.replace("medium: { material: fluid, shape: everything_else }", &wall),
        "spaced" => PARTICLES
            .replace("spacing: 1 um,", "spacing: 0.9 um,")
            .replace("medium: { material", "medium: { spacing: 1 um, material"),
        _ => PARTICLES.replace("groups:\n", &format!("groups:\n  {wall}\n")),
    };
    check(&refused(&model, "name: t", "name: t", &[]), place, words);
}

#[rstest]
#[case::no_density("post", "free_body: { in: post }", "m.yaml:16:31", &["\"density\" is missing"])]
#[case::free_side("post", "free_body: { in: y_min, density: 1 kg/L }", "m.yaml:16:37", &["a side of the box cannot move freely"])]
#[case::free_fluid("post", "free_body: { in: medium, density: 1 kg/L }", "m.yaml:16:37", &["is no wall"])]
#[case::free_body_at_a_wall("low", "free_body: { in: low, density: 1 kg/L }", "m.yaml:16:15", &["touches the end of the box along y", "one spacing"])]
#[case::told_twice("post", "free_body: { in: post, density: 1 kg/L } }, n: { moving_wall: { in: post, rotation: 1 1/s }", "m.yaml:16:64", &["`m` already says"])]
#[case::displaced_from_the_start("post", "moving_wall: { in: post, displacement: [1 um, 0] }", "m.yaml:16:15", &["at t = 0", "begin at zero"])]
#[case::displacement_of_another_dimension("post", "moving_wall: { in: post, displacement: [\"1 um/s\", 0] }", "m.yaml:16:61", &["expected a length"])]
#[case::displacement_by_a_species("post", "moving_wall: { in: post, displacement: [\"A * t\", 0] }", "m.yaml:16:61", &["unknown name \"A\""])]
#[case::displacement_of_three("post", "moving_wall: { in: post, displacement: [0, 0, 0] }", "m.yaml:16:59", &["expected 2 components"])]
#[case::belt_through_its_side("post", "moving_wall: { in: y_min, velocity: [0, 1 mm/s] }", "m.yaml:16:33", &["only move along itself"])]
#[case::side_that_closes("post", "moving_wall: { in: y_min, displacement: [0, \"1 um/s * t\"] }", "m.yaml:16:60", &["cannot be displaced along y"])]
#[case::displacement_and_velocity("post", "moving_wall: { in: post, displacement: [0, 0], velocity: [0, 0] }", "m.yaml:16:67", &["does not go with `displacement`"])]
fn of_moving_solids(
    #[case] group: &str,
    #[case] condition: &str,
    #[case] place: &str,
    #[case] words: &[&str],
) {
    let height = if group == "low" { 1.5 } else { 4.0 };
    let model = PARTICLES
        .replace("[8 um, 8 um]", "[12 um, 12 um]")
        .replace(
            "groups:\n",
            &format!("groups:\n  {group}: {{ material: wall, shape: {{ disc: {{ centre: [4 um, {height} um], radius: 2 um }} }} }}\n"),
        )
        .replace("initial:", &format!("conditions: {{ m: {{ {condition} }} }}\ninitial:"));
    check(&refused(&model, "name: t", "name: t", &[]), place, words);
}
