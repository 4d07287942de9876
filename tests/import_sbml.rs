//! `gillesph import sbml`: propensities at the start worked out by hand, means of ensembles, and what is refused.

mod face;

use assert_cmd::Command;
use face::{Bench, amounts, shipped};
use gillesph::chemistry::{AVOGADRO, Propensities};
use gillesph::model::{Domain, Model, load};
use gillesph::plan::Plan;
use gillesph::plan::start::{Voxels, start};
use gillesph::tables::read_series;
use rstest::rstest;
use std::path::{Path, PathBuf};

/// Imports a file into the folder of a bench; the model's path and what was said.
fn import(bench: &Bench, file: &Path, options: &[&str]) -> (PathBuf, String) {
    let out = bench.path("imported");
    let arguments = [&["import", "sbml", file.to_str().unwrap(), "--out", out.to_str().unwrap()], options];
    let output = face::gillesph(&arguments.concat());
    assert!(output.stdout.is_empty(), "nothing belongs on standard output");
    let name = format!("{}.yaml", file.file_stem().unwrap().to_str().unwrap());
    (out.join(name), String::from_utf8(output.stderr).unwrap())
}

fn fixture(name: &str) -> PathBuf {
    shipped(&format!("tests/sbml/{name}.xml"))
}

/// Propensities of a model of one volume at the start, by name, 1/s.
fn propensities(path: &Path) -> Vec<(String, f64)> {
    let model: Model = load::model(path, &[]).unwrap();
    let Domain::WellMixed { volume } = model.domain else { panic!("one volume expected") };
    let network = model.network.clone();
    let plan = Plan::new(model, 1).unwrap();
    let volumes = [volume];
    let voxels = Voxels {
        positions: &[gillesph::vector::Vector::zeros()],
        volumes: &volumes,
        home: &[0],
        current: &[0],
    };
    let amounts = start(&plan, &voxels).amounts;
    let compiled = Propensities::compile(&network, &vec![true; network.species.len()]);
    let value = |r: usize| compiled.propensity(r, &amounts, volume);
    network.reactions.iter().enumerate().map(|(r, reaction)| (reaction.name.clone(), value(r))).collect()
}

/// Units carry a few roundings.
fn assert_propensities(path: &Path, expected: &[(&str, f64)]) {
    let found = propensities(path);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for ((name, value), (expected_name, expected)) in found.iter().zip(expected) {
        assert_eq!(name, expected_name);
        assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{name}: {value} against {expected}");
    }
}

/// A Level 2 model in one compartment, its parts given as XML.
fn level_2(units: &str, compartment: &str, species: &str, parameters: &str, reactions: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<sbml xmlns=\"http://www.sbml.org/sbml/level2/version4\" level=\"2\" version=\"4\">\n\
         <model id=\"m\">\n<listOfUnitDefinitions>{units}</listOfUnitDefinitions>\n\
         <listOfCompartments>{compartment}</listOfCompartments>\n<listOfSpecies>{species}</listOfSpecies>\n\
         <listOfParameters>{parameters}</listOfParameters>\n<listOfReactions>{reactions}</listOfReactions>\n</model>\n</sbml>\n"
    )
}

/// `id: left -> right` with a law in MathML; sides are lists of species, each once.
fn reaction(id: &str, left: &[&str], right: &[&str], reversible: bool, law: &str) -> String {
    let side = |list: &str, side: &[&str]| {
        let references: String =
            side.iter().map(|s| format!("<speciesReference species=\"{s}\"/>")).collect();
        if side.is_empty() { String::new() } else { format!("<{list}>{references}</{list}>") }
    };
    format!(
        "<reaction id=\"{id}\" reversible=\"{reversible}\">{}{}<kineticLaw>\
         <math xmlns=\"http://www.w3.org/1998/Math/MathML\">{law}</math></kineticLaw></reaction>\n",
        side("listOfReactants", left),
        side("listOfProducts", right)
    )
}

fn apply(operator: &str, arguments: &[&str]) -> String {
    let written: String = arguments
        .iter()
        .map(|a| match a.starts_with('<') {
            true => (*a).to_string(),
            false if a.starts_with(|c: char| c.is_ascii_digit()) => format!("<cn>{a}</cn>"),
            false => format!("<ci>{a}</ci>"),
        })
        .collect();
    format!("<apply><{operator}/>{written}</apply>")
}

/// Nanomole, minutes and litres: 60 221 of S (100 nM in 1 pL) and 6022 of A. The law of Haldane with S = 100 nM:
/// 50 · 100/20 / (1 + 5) nM/min forward; 2 A -> A2 at 2 /nM/min: k X (X - 1) / (N_A V); X is held at 5 nM.
#[test]
fn nanomoles_and_minutes() {
    let bench = Bench::new();
    let (path, said) = import(&bench, &fixture("enzyme_nanomole_minutes"), &[]);
    assert!(said.contains("S (S - 1)"), "{said}");
    let nano = 1e-9 * AVOGADRO * 1e-12; // molecules in 1 nM
    // 100 nM are 60221.4 molecules, of which 60221 are there.
    let s = (100.0 * nano).round() / nano;
    let a = (10.0 * nano).round();
    let forward = 50.0 * s / 20.0 / (1.0 + s / 20.0) * nano / 60.0;
    let expected = [
        ("enz", forward),
        ("enz_reverse", 0.0),
        ("dim", 2.0 / 60.0 * a * (a - 1.0) / nano),
        ("dim (reverse)", 0.0),
        ("feed", 0.1 * 5.0 * nano / 60.0),
    ];
    assert_propensities(&path, &expected);
    face::gillesph(&["check", path.to_str().unwrap()]);
}

/// P (A_c - A_n) in litres per second: 5e-16/4e-15 = 1/8 per s out of the cytosol, 1/2 per s back. In numbers:
/// 0.3 · 20 · 19 / 2, by the law's own k.
#[test]
fn transport_and_discrete_laws() {
    let bench = Bench::new();
    let (path, said) = import(&bench, &fixture("transport"), &[]);
    assert!(said.contains("reactions join compartments"), "{said}");
    assert_propensities(
        &path,
        &[("pass", 400.0 / 8.0), ("pass (reverse)", 0.0), ("dimer", 57.0), ("loss", 0.0)],
    );
    let network = load::model(&path, &[]).unwrap().network;
    assert_eq!(network.reactions[3].equation, "A_n + D2 -> D2");
}

/// Passage alone is linear: every molecule is in the nucleus with chance 0.2 (1 - exp(-0.625 t)), a binomial
/// number of 400. 2000 realizations; the mean within five standard errors (chance of a false alarm 6e-7).
#[test]
fn an_ensemble_of_transport() {
    let bench = Bench::new();
    let (path, _) = import(&bench, &fixture("transport"), &["--until", "2 s"]);
    let options = ["--realizations", "2000", "--set", "reactions.parameters.k=0", "--seed", "31"];
    let series = read_series(&bench.run(&path, "out", &options)).unwrap();
    let found = amounts(&series, "all", "A_n", 2.0);
    let chance = 0.2 * (1.0 - (-1.25_f64).exp());
    let (mean, variance) = (400.0 * chance, 400.0 * chance * (1.0 - chance));
    let average = found.iter().sum::<f64>() / found.len() as f64;
    assert!((average - mean).abs() < 5.0 * (variance / 2000.0).sqrt(), "{average} against {mean}");
}

/// Rate equations of the imported dimerisation: dA/dt = -2 k A² + 2 r A2 with A + 2 A2 = T conserved, so that
/// A' = -2 k (A - p)(A - q), p and q the roots of 2 k A² + r A - r T (per nM and minute).
#[test]
fn rate_equations_of_a_dimer() {
    let bench = Bench::new();
    let (path, _) = import(&bench, &fixture("enzyme_nanomole_minutes"), &[]);
    let set = ["--set", "chemistry.representation=continuous", "--set", "run.until=60 s"];
    let series = read_series(&bench.run(&path, "out", &set)).unwrap();
    let (k, r, total): (f64, f64, f64) = (2.0, 0.5, 10.0);
    let root = (r * r + 8.0 * k * r * total).sqrt();
    let (p, q) = ((-r + root) / (4.0 * k), (-r - root) / (4.0 * k));
    let start = (total - p) / (total - q) * (-2.0 * k * (p - q)).exp(); // after one minute
    let exact = (p - q * start) / (1.0 - start) * 1e-9 * AVOGADRO * 1e-12;
    let found = amounts(&series, "all", "A", 60.0)[0];
    // The start is 10 nM to the last digit; the integrator errs by less than 1e-6 (see rate_laws.rs).
    assert!((found / exact - 1.0).abs() < 1e-6, "{found} against {exact}");
}

/// The shipped example: 602 molecules of W at 1 µM under V1 W / (K + W) = 1 / 1.1 µM/s.
#[test]
fn the_example() {
    let bench = Bench::new();
    let (path, _) = import(&bench, &shipped("models/covalent_switch.xml"), &[]);
    let micro = 1e-6 * AVOGADRO * 1e-15; // molecules in 1 µM
    let w = micro.round() / micro;
    assert_propensities(&path, &[("modify", w / (0.1 + w) * micro), ("restore", 0.0)]);
    bench.run(&path, "out", &["--realizations", "2", "--set", "run.until=1 s"]);
}

/// No unit anywhere (Level 3): molecules, litres, seconds, each with a note. Compartments that no reaction joins
/// are a graph; a conversion factor and a unit of extent that agree are taken; one that does not is refused.
#[test]
fn level_3_without_units_and_with_a_conversion_factor() {
    let law = |k: &str, s: &str| {
        format!(
            "<kineticLaw><math xmlns=\"http://www.w3.org/1998/Math/MathML\">{}</math></kineticLaw>",
            apply("times", &[k, s])
        )
    };
    let decay = |id: &str, s: &str| {
        format!(
            "<reaction id=\"{id}\" reversible=\"false\" fast=\"false\"><listOfReactants><speciesReference species=\"{s}\" stoichiometry=\"1\" constant=\"true\"/></listOfReactants>{}</reaction>",
            law("2", s)
        )
    };
    let text = |attributes: &str, units: &str, species: &str| {
        format!(
            "<sbml xmlns=\"http://www.sbml.org/sbml/level3/version2/core\" level=\"3\" version=\"2\"><model {attributes}>\n\
             <listOfUnitDefinitions>{units}</listOfUnitDefinitions><listOfCompartments>\
             <compartment id=\"a\" spatialDimensions=\"3\" size=\"1\" constant=\"true\"/>\
             <compartment id=\"b\" spatialDimensions=\"3\" size=\"2\" constant=\"true\"/></listOfCompartments>\n<listOfSpecies>\
             <species id=\"A\" compartment=\"a\" initialAmount=\"12\" hasOnlySubstanceUnits=\"true\" boundaryCondition=\"false\" constant=\"false\" {species}/>\
             <species id=\"B\" compartment=\"b\" initialAmount=\"12\" hasOnlySubstanceUnits=\"true\" boundaryCondition=\"false\" constant=\"false\"/>\
             </listOfSpecies><listOfParameters><parameter id=\"pairs\" value=\"0.5\" constant=\"true\"/></listOfParameters>\n\
             <listOfReactions>{}{}</listOfReactions></model></sbml>",
            decay("da", "A"),
            decay("db", "B")
        )
    };
    let bench = Bench::new();
    let file = bench.model("m.xml", &text("", "", ""));
    let (path, said) = import(&bench, &file, &[]);
    for unit in ["amount: taken for molecules", "volume: taken for litres", "time: taken for seconds"] {
        assert!(said.contains(unit), "{said}");
    }
    let model = load::model(&path, &[]).unwrap();
    let Domain::Graph { volumes, names, .. } = &model.domain else { panic!("a graph expected") };
    assert_eq!((volumes.as_slice(), names.join(" ").as_str()), ([1e-3, 2e-3].as_slice(), "a b"));
    bench.run(&path, "out", &["--realizations", "2"]);
    // A species in pairs of molecules: half a pair is one unit of extent.
    let pair = "<unitDefinition id=\"pair\"><listOfUnits><unit kind=\"item\" multiplier=\"2\" scale=\"0\" exponent=\"1\"/></listOfUnits></unitDefinition>";
    let agreeing = "substanceUnits=\"pair\" conversionFactor=\"pairs\"";
    bench.model("m.xml", &text("substanceUnits=\"item\" extentUnits=\"item\"", pair, agreeing));
    let (path, _) = import(&bench, &file, &["--force"]);
    let start = load::model(&path, &[]).unwrap().initial;
    assert!(matches!(start[0].amount, gillesph::model::Amount::Molecules(24.0)), "{:?}", start[0]);
    bench.model(
        "m.xml",
        &text("substanceUnits=\"item\" extentUnits=\"item\"", pair, "substanceUnits=\"pair\""),
    );
    let (status, message) = refused(&bench, &["import", "sbml", "m.xml"]);
    assert!(status == 2 && message.contains("conversionFactor"), "{message}");
}

const DEFAULT: &str = "<compartment id=\"c\" size=\"2e-15\"/>";

/// Moles and litres, the units of Level 2 where a file gives none: A + B at 1e6 /M/s in 2 fL, with and without
/// the compartment in the law; then ten times smaller.
#[test]
fn moles_and_litres() {
    let amounts = |k: f64| k / AVOGADRO;
    let species = format!(
        "<species id=\"A\" compartment=\"c\" initialAmount=\"{:e}\"/><species id=\"B\" compartment=\"c\" initialAmount=\"{:e}\"/>",
        amounts(300.0),
        amounts(50.0)
    );
    let law = apply("times", &["c", "k", "A", "B"]);
    let without = apply("times", &["kv", "A", "B"]);
    let parameters = "<parameter id=\"k\" value=\"1e6\"/><parameter id=\"kv\" value=\"2e-9\"/>";
    let reactions = [
        reaction("bind", &["A", "B"], &[], false, &law),
        reaction("same", &["A", "B"], &[], false, &without),
    ];
    let bench = Bench::new();
    let file = bench.model("m.xml", &level_2("", DEFAULT, &species, parameters, &reactions.concat()));
    let (path, _) = import(&bench, &file, &[]);
    let expected = 1e6 / (AVOGADRO * 2e-15) * 300.0 * 50.0;
    assert_propensities(&path, &[("bind", expected), ("same", expected)]);
    // A volume ten times smaller at the same concentrations: a tenth of the molecules, a tenth of the events.
    let (path, _) = import(&bench, &file, &["--volume", "0.2 fL", "--force"]);
    assert_propensities(&path, &[("bind", expected / 10.0), ("same", expected / 10.0)]);
}

/// Numbers read as molecules whatever the file says: k A in 1 litre.
#[test]
fn amounts_read_as_molecules() {
    let species = "<species id=\"A\" compartment=\"c\" initialAmount=\"100\"/>";
    let law = apply("times", &["c", "k", "A"]);
    let text = level_2(
        "",
        "<compartment id=\"c\" size=\"1\"/>",
        species,
        "<parameter id=\"k\" value=\"0.5\"/>",
        &reaction("decay", &["A"], &[], false, &law),
    );
    let bench = Bench::new();
    let file = bench.model("m.xml", &text);
    let (status, message) = refused(&bench, &["import", "sbml", "m.xml"]);
    assert_eq!(status, 2);
    assert!(message.contains("6.02e25 molecules") && message.contains("--molecules"), "{message}");
    let (path, _) = import(&bench, &file, &["--molecules"]);
    assert_propensities(&path, &[("decay", 50.0)]);
}

/// A law with a conditional, a Hill power and a word of the rate language as the name of a species.
#[test]
fn names_and_functions_of_laws() {
    let items =
        "<unitDefinition id=\"substance\"><listOfUnits><unit kind=\"item\"/></listOfUnits></unitDefinition>";
    let species = ["step", "no", "B"].map(|id| {
        format!("<species id=\"{id}\" compartment=\"c\" initialAmount=\"8\" hasOnlySubstanceUnits=\"true\"/>")
    });
    let hill = apply(
        "divide",
        &[&apply("power", &["step", "2"]), &apply("plus", &["64", &apply("power", &["step", "2"])])],
    );
    let choice = format!(
        "<piecewise><piece>{}{}</piece><otherwise><cn>0</cn></otherwise></piecewise>",
        apply("times", &["3", "no"]),
        apply("and", &[&apply("gt", &["no", "2"]), &apply("leq", &["B", "8"])])
    );
    let reactions = [
        reaction("hill", &["step"], &[], false, &hill),
        reaction("choice", &["no"], &["B"], false, &choice),
        reaction("constant", &[], &["B"], false, &apply("times", &["2", &apply("floor", &["2.5"])])),
        reaction("backward", &["B"], &["no"], false, &apply("minus", &[&apply("times", &["3", "B"]), "no"])),
    ];
    let bench = Bench::new();
    let file = bench.model("m.xml", &level_2(items, DEFAULT, &species.concat(), "", &reactions.concat()));
    let (path, _) = import(&bench, &file, &[]);
    let expected =
        [("hill", 0.5), ("choice", 24.0), ("constant", 4.0), ("backward", 24.0), ("backward (reverse)", 8.0)];
    assert_propensities(&path, &expected);
}

/// Runs in the bench's folder; status and message.
fn refused(bench: &Bench, arguments: &[&str]) -> (i32, String) {
    let output =
        Command::cargo_bin("gillesph").unwrap().current_dir(bench.path("")).args(arguments).output().unwrap();
    assert!(output.stdout.is_empty(), "nothing belongs on standard output");
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn everything_unsupported_in_one_message() {
    let bench = Bench::new();
    std::fs::copy(fixture("unsupported"), bench.path("u.xml")).unwrap();
    let (status, message) = refused(&bench, &["import", "sbml", "u.xml"]);
    assert_eq!(status, 2);
    for expected in [
        "u.xml:2:1  the package \"comp\"",
        "u.xml:14:7  a rate rule for \"x\"",
        "u.xml:15:7  an algebraic rule",
        "u.xml:18:7  fast reaction \"pulse\"",
        "u.xml:21:36  a formula that depends on the time",
        "u.xml:27:18  a delay",
        "u.xml:32:7  event \"kick\"",
        "7 faults; nothing was written",
    ] {
        assert!(message.contains(expected), "{expected} is missing in\n{message}");
    }
    assert_eq!(std::fs::read_dir(bench.path("")).unwrap().count(), 1, "something was written");
}

#[rstest]
#[case("<sbml", "m.xml:1:", "this is no XML")]
#[case("<a><b></a>", "m.xml:1:7", "expected 'b' tag")]
#[case("<html/>", "m.xml:1:1", "this is no SBML")]
#[case("<sbml level=\"1\" version=\"2\"/>", "m.xml:1:1", "Level 2 or 3")]
#[case("<sbml level=\"3\" version=\"1\"/>", "m.xml:1:1", "no <model>")]
#[case("<sbml level=\"3\" version=\"1\"><model/></sbml>", "m.xml:1:29", "no species")]
#[case("<!DOCTYPE a []><a/>", "m.xml:1:", "DTD")]
#[case("", "", "this is no XML")]
fn malformed(#[case] text: &str, #[case] place: &str, #[case] reason: &str) {
    let bench = Bench::new();
    bench.model("m.xml", text);
    let (status, message) = refused(&bench, &["import", "sbml", "m.xml"]);
    assert_eq!(status, 2, "{message}");
    assert!(message.contains(place) && message.contains(reason), "{message}");
}

/// Each is a fault of its own kind in an otherwise sound model.
#[rstest]
#[case("stoichiometry=\"0.5\"", "k", "whole numbers")]
#[case("", "q", "unknown symbol \"q\"")]
#[case("", "unset", "has no value")]
fn faults_of_reactions(#[case] attribute: &str, #[case] constant: &str, #[case] reason: &str) {
    let species = "<species id=\"A\" compartment=\"c\" initialAmount=\"1e-21\"/>";
    let decay = reaction("decay", &["A"], &[], false, &apply("times", &[constant, "A"]));
    let decay = decay.replace("species=\"A\"", &format!("species=\"A\" {attribute}"));
    let text =
        level_2("", DEFAULT, species, "<parameter id=\"k\" value=\"1\"/><parameter id=\"unset\"/>", &decay);
    let bench = Bench::new();
    bench.model("m.xml", &text);
    let (status, message) = refused(&bench, &["import", "sbml", "m.xml"]);
    assert_eq!(status, 2, "{message}");
    assert!(message.contains(reason), "{message}");
}

/// A net rate without a visible difference acts in both directions at once, which chance does not.
#[test]
fn a_net_rate_that_does_not_come_apart() {
    let species =
        ["A", "B"].map(|s| format!("<species id=\"{s}\" compartment=\"c\" initialAmount=\"1e-21\"/>"));
    let law = apply("times", &["k", &apply("sin", &[&apply("minus", &["A", "B"])])]);
    let text = level_2(
        "",
        DEFAULT,
        &species.concat(),
        "<parameter id=\"k\" value=\"1\"/>",
        &reaction("r", &["A"], &["B"], true, &law),
    );
    let bench = Bench::new();
    bench.model("m.xml", &text);
    let (status, message) = refused(&bench, &["import", "sbml", "m.xml"]);
    assert_eq!(status, 2, "{message}");
    assert!(message.contains("two directions"), "{message}");
}

#[test]
fn files_are_not_overwritten_unasked() {
    let bench = Bench::new();
    let (path, _) = import(&bench, &fixture("transport"), &[]);
    std::fs::write(&path, "mine").unwrap();
    let file = fixture("transport");
    let arguments = ["import", "sbml", file.to_str().unwrap(), "--out", "imported"];
    let (status, message) = refused(&bench, &arguments);
    assert_eq!(status, 2);
    assert!(message.contains("is there already"), "{message}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    import(&bench, &file, &["--force"]);
    assert_ne!(std::fs::read_to_string(&path).unwrap(), "mine");
}
