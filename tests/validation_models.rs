//! The models of the published tables as a user runs them, and the case that is quick.

mod face;

use face::{Bench, gillesph, record, shipped};

/// A run says by which printed operator and integrator it was made.
#[test]
fn printed_operators_are_named_in_the_record() {
    for (name, operator) in [
        ("table_2_1", "printed operator (softened, unnormalised)"),
        ("table_2_2", "printed operator (unnormalised)"),
        ("table_2_3", "printed operator (softened, unnormalised)"),
    ] {
        let bench = Bench::new();
        let model = shipped(&format!("models/validation/{name}.yaml"));
        let short =
            ["--set", "run.until=0.1 s", "--set", "output.times=[0.1 s]", "--set", "output.particles=false"];
        let steps = &record(&bench.run(&model, "out", &short))["steps"];
        assert!(steps["method"].as_str().unwrap().contains("forward Euler"), "{name}");
        let approximations = steps["approximations"].to_string();
        assert!(approximations.contains(operator), "{name}: {approximations}");
        assert!(approximations.contains("forward Euler: first order"), "{name}: {approximations}");
    }
}

#[test]
fn table_2_1_is_met() {
    let bench = Bench::new();
    let out = bench.path("validation");
    let printed = gillesph(&["validate", "table_2_1", "--out", out.to_str().unwrap()]);
    let text = String::from_utf8(printed.stdout).unwrap();
    let rows = std::fs::read_to_string(out.join("table_2_1/verdict.csv")).unwrap();
    assert_eq!(rows.lines().count() + 1, text.lines().count(), "{rows}");
    assert!(text.contains("N = 65, our operator") && !text.contains("FAILED"), "{text}");
}

/// Every model of the published flows is one a user can check.
#[test]
fn the_models_are_sound() {
    for entry in std::fs::read_dir(shipped("models/validation")).unwrap() {
        gillesph(&["check", entry.unwrap().path().to_str().unwrap()]);
    }
}

/// Where friction is weak, what the shift carries next to walls is bounded. Unbounded it blows up at 2.8 L/U; bounded no fluid is
/// faster than 0.8 times the lid (1.2 times at 100², 1.3 times at 200², while the flow starts).
#[test]
fn a_cavity_at_re_10000_neither_blows_up_nor_outruns_its_lid() {
    let bench = Bench::new();
    let model = shipped("models/validation/cavity.yaml");
    let rapid = [
        "--set",
        "fluid.viscosity=1e-4 Pa s",
        "--set",
        "run.until=3 s",
        "--set",
        "output={every: 1 s, particles: false}",
    ];
    let health = &record(&bench.run(&model, "out", &rapid))["health"];
    assert_eq!(health["penetrations"], 0);
    assert!(health["largest_mach"].as_f64().unwrap() < 0.15, "{health}");
}
