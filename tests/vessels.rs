//! Walls in balance as a user meets them: softening, growth, molecules shared out, messages.

mod face;

use face::{Bench, amounts};
use gillesph::samples::ProbeRows;
use gillesph::tables::{list_particles, read_particles, read_probes, read_series};
use std::path::Path;
use std::process::Command;

/// A small cell whose wall grows all round: every column divides.
const CELL: &str = "\
name: cell
reactions: { species: { A: { diffusion: 1 um^2/s }, B: { diffusion: 1 um^2/s, representation: continuous } } }
chemistry: { step: 1 s }
domain: { kind: particles, dimensions: 2, min: [-20 um, -20 um], max: [20 um, 20 um], thickness: 1 um }
particles: { spacing: 0.8 um, support: 2 }
groups:
  wall: { material: solid, shape: { ring: { centre: [0, 0], inner: 4 um, outer: 6.4 um } } }
solids:
  wall:
    density: 1000 kg/m^3
    youngs_modulus: 20 MPa
    poisson_ratio: 0.3
    law: neo_hookean
    placement: layers
    turgor: { pressure: 0.5 MPa }
    growth: { rate: 2e-8 1/Pa/s, yield: 0.4 MPa, insert_at: 1.3, reserve: 600 }
mechanics: { mode: quasi_static, tolerance: 1e-4 }
fluid: { method: none }
initial: { wall: { A: 5000, B: 5000 } }
run: { until: 30 s, realizations: 2 }
output: { every: 5 s }
";

fn history(dir: &Path, quantity: &str) -> Vec<f64> {
    let wanted = |row: &&ProbeRows| row.probe == "wall" && row.quantity == quantity && row.realization == 0;
    read_probes(dir).unwrap().iter().filter(wanted).map(|row| row.value[0]).collect()
}

#[test]
fn a_wall_grows_and_shares_its_molecules_out() {
    let bench = Bench::new();
    let dir = bench.run(&bench.model("cell.yaml", CELL), "out", &[]);
    let columns = history(&dir, "columns");
    assert!(columns.last() > columns.first(), "{columns:?}");
    // Booked to rounding; in balance to the tolerance; no way out at any step.
    assert!(history(&dir, "mass_balance").iter().all(|lost| lost.abs() < 1e-12));
    assert!(history(&dir, "residual").iter().all(|left| *left <= 1e-4));
    assert!(history(&dir, "escapes").iter().all(|n| *n == 0.0));
    assert!(history(&dir, "time_ratio").iter().all(|ratio| *ratio < 1e-3));
    // A reservoir: the pressure stays while the volume grows.
    let (pressure, volume) = (history(&dir, "pressure_inside"), history(&dir, "volume_inside"));
    assert!(pressure.iter().all(|p| *p == 0.5e6) && volume.windows(2).all(|w| w[1] > w[0]));
    // Every molecule is somewhere: discrete ones exactly.
    let series = read_series(&dir).unwrap();
    for time in [0.0, 15.0, 30.0] {
        assert_eq!(amounts(&series, "wall", "A", time), [5000.0; 2]);
        // Rounding of diffusion.
        assert!(amounts(&series, "wall", "B", time).iter().all(|n| (n / 5000.0 - 1.0).abs() < 1e-9));
    }
}

/// New columns belong to the surface their donors are of, and share its molecules out.
#[test]
fn the_skin_of_a_wall_grows_with_it() {
    let bench = Bench::new();
    let text = CELL
        .replacen("A: { diffusion: 1 um^2/s }", "A: { diffusion: 1 um^2/s, only_in: [skin] }", 1)
        .replacen(
            "solids:",
            "  skin: { material: surface, of: wall, shape: { ring: { centre: [0, 0], inner: 5.6 um, outer: 6.4 um } } }\nsolids:",
            1,
        )
        .replacen("wall: { A: 5000, B: 5000 }", "skin: { A: 5000 }, wall: { B: 5000 }", 1)
        .replacen("output: { every: 5 s }", "output: { every: 5 s, particles: { times: [0, 30 s] } }", 1);
    let dir = bench.run(&bench.model("cell.yaml", &text), "out", &[]);
    let columns = history(&dir, "columns");
    let frames = read_particles(&list_particles(&dir)[0].2).unwrap().1;
    for (frame, columns) in [(&frames[0], columns[0]), (&frames[1], columns[columns.len() - 1])] {
        let skin: Vec<usize> = (0..frame.len()).filter(|&i| frame.group_name(i) == "skin").collect();
        assert_eq!(skin.len(), columns as usize);
        assert_eq!(skin.iter().map(|&i| frame.amounts[0][i]).sum::<f64>(), 5000.0);
    }
    assert!(columns[columns.len() - 1] > columns[0], "{columns:?}");
}

/// At the rim of a surface columns divide too, with a donor on either side: what lives in the surface alone stays in it.
#[test]
fn molecules_of_half_a_skin_stay_in_it() {
    let bench = Bench::new();
    let text = CELL
        .replacen("A: { diffusion: 1 um^2/s }", "A: { diffusion: 1 um^2/s, only_in: [cap] }", 1)
        .replacen("B: { diffusion: 1 um^2/s", "B: { only_in: [cap], diffusion: 1 um^2/s", 1)
        .replacen(
            "solids:",
            "  cap: { material: surface, of: wall, shape: { box: { min: [0, -20 um], max: [20 um, 20 um] } } }\nsolids:",
            1,
        )
        .replacen("wall: { A: 5000, B: 5000 }", "cap: { A: 5000, B: 5000 }", 1);
    let dir = bench.run(&bench.model("cell.yaml", &text), "out", &[]);
    let series = read_series(&dir).unwrap();
    for time in [0.0, 15.0, 30.0] {
        assert_eq!(amounts(&series, "cap", "A", time), [5000.0; 2]);
        assert!(amounts(&series, "cap", "B", time).iter().all(|n| (n / 5000.0 - 1.0).abs() < 1e-9));
    }
}

/// About 40 molecules in a particle: some are whole numbers, some real amounts, and both divide.
#[test]
fn hybrid_species_are_shared_out_whichever_way_they_are_carried() {
    let bench = Bench::new();
    let text = CELL
        .replacen("A: { diffusion: 1 um^2/s }", "A: { diffusion: 1 um^2/s, representation: hybrid }", 1)
        .replacen(
            "chemistry: { step: 1 s }",
            "chemistry: { step: 1 s, hybrid: { above: 38, below: 30 } }",
            1,
        );
    let dir = bench.run(&bench.model("cell.yaml", &text), "out", &[]);
    assert!(history(&dir, "columns").last() > Some(&60.0));
    let series = read_series(&dir).unwrap();
    for time in [0.0, 15.0, 30.0] {
        let all = amounts(&series, "wall", "A", time);
        // Part of a molecule may be left over for the next change.
        assert!(all.iter().all(|n| (n - 5000.0).abs() < 1.0 + 1e-6), "{all:?}");
    }
    let record = face::record(&dir);
    let carried = &record["hybrid"][0];
    assert!(carried["to_continuous"].as_u64().unwrap() > 0 && carried["to_discrete"].as_u64().unwrap() > 0);
    assert!(record["health"]["molecules_created_or_lost"].as_f64().unwrap() < 1e-6);
}

/// What a run of the cell says when it fails, with `from` replaced by `to`.
fn told(from: &str, to: &str) -> String {
    assert!(CELL.contains(from), "{from}");
    let bench = Bench::new();
    let model = bench.model("cell.yaml", &CELL.replacen(from, to, 1));
    let out = bench.path("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_gillesph"));
    let output = command.arg("run").arg(model).arg("--quiet").arg("--out").arg(out).output().unwrap();
    assert!(!output.status.success(), "{to}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn what_cannot_be_in_balance_is_said() {
    let cases: [(&str, &str, &[&str]); 13] = [
        (
            "mechanics: { mode: quasi_static, tolerance: 1e-4 }",
            "",
            &["add mechanics: { mode: quasi_static }"],
        ),
        ("    placement: layers\n", "", &["that of closed walls", "remove `mechanics`"]),
        ("reserve: 600", "reserve: 9", &["raise growth.reserve (particles)"]),
        ("youngs_modulus: 20 MPa", "youngs_modulus: 0.2 MPa", &["balloons"]),
        // Far beyond what it holds the load turns particles inside out before they are stretched far.
        ("pressure: 0.5 MPa", "pressure: 50 MPa", &["balloons"]),
        ("tolerance: 1e-4", "tolerance: 1e-16", &["all but balanced", "set mechanics.tolerance"]),
        ("pressure: 0.5 MPa", "pressure: -0.5 MPa", &["cell.yaml:15:25", "negative turgor is no turgor"]),
        ("    placement:", "    drag: 3 1/s\n    placement:", &["cell.yaml:14:5", "`drag` has no effect"]),
        (
            "    placement:",
            "    velocity: [0, 0]\n    placement:",
            &["cell.yaml:14:5", "`velocity` has no effect"],
        ),
        (
            "    placement:",
            "    hourglass: -1\n    placement:",
            &["\"hourglass\": number may not be negative"],
        ),
        ("20 MPa", "20 MPaa", &["did you mean \"MPa\"?"]),
        // At the start, before anything has run.
        (
            "    growth:",
            "    softening: { by: B, factor: 0.9, at: 50 nM }\n    growth:",
            &["cell.yaml:16:5", "of `B` at", "at the start the shear modulus of `wall`"],
        ),
        (
            "B: { diffusion: 1 um^2/s, representation: continuous } } }",
            "B: { diffusion: 1 um^2/s, only_in: [rest] } } }\n#",
            &["unknown group `rest`"],
        ),
    ];
    for (from, to, words) in cases {
        let told = told(from, to);
        assert!(words.iter().all(|words| told.contains(words)), "{words:?}: {told}");
    }
}

#[test]
fn a_species_that_cannot_make_a_wall_grow_is_told_at_its_growth() {
    let bench = Bench::new();
    let text = CELL
        .replacen("representation: continuous", "representation: continuous, only_in: [rest]", 1)
        .replacen("solids:", "  rest: { shape: everything_else }\nsolids:", 1)
        .replacen("wall: { A: 5000, B: 5000 }", "wall: { A: 5000 }", 1)
        .replacen("rate: 2e-8 1/Pa/s", "rate: 2e-8 1/Pa/s, by: B, at: 1 uM", 1)
        .replacen("    growth:", "    softening: { by: A, factor: 0.1, at: 1 mM }\n    growth:", 1);
    let told = check(&bench.model("cell.yaml", &text), &[]);
    assert!(told.contains("cell.yaml:18:5  `B` cannot be in `wall`"), "{told}");
}

fn check(model: &Path, more: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gillesph"));
    let output = command.arg("check").arg(model).args(more).output().unwrap();
    String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned()
}

#[test]
fn check_tells_what_a_wall_does() {
    let bench = Bench::new();
    let model = bench.model("cell.yaml", CELL);
    let plain = check(&model, &[]);
    for words in [
        "columns: 41 of 3 layers",
        "in balance: at every chemistry step of 1 s, but for 0.0001 of the loads",
        "turgor: 500 kPa",
        "above a stress of 400 kPa; new columns at a stretch of 1.3, 600 particles for them",
        "solid step 1 s, 30 steps, limited by the chemistry step",
    ] {
        assert!(plain.contains(words), "{words}: {plain}");
    }
    assert!(!plain.contains("warning"), "{plain}");
    let rash = check(&model, &["--set", "solids.wall.growth.rate=2e-3 1/Pa/s"]);
    assert!(rash.contains("warning: growth of `wall`") && rash.contains("look at the unit"), "{rash}");
    // What is told where the file shows another value says what was set.
    let set = check(&model, &["--set", "chemistry.step=1e-12 s"]);
    assert!(
        set.contains("chemistry steps of") && set.contains("= with --set chemistry.step=1e-12 s"),
        "{set}"
    );
}

/// Of 2 mM that is held on one side of a wall that grows, what comes into being there has as much.
#[test]
fn new_columns_of_a_held_part_are_held() {
    let text = CELL
        .replacen(
            "solids:",
            "  side: { material: zone, shape: { box: { min: [0, -20 um], max: [20 um, 20 um] } } }\nsolids:",
            1,
        )
        .replacen("fluid:", "conditions: { hold: { held: { in: side, species: { B: 2 mM } } } }\nfluid:", 1)
        .replacen(
            "A: { diffusion: 1 um^2/s }, B: { diffusion: 1 um^2/s",
            "A: { diffusion: 0 }, B: { diffusion: 0",
            1,
        )
        .replacen("initial: { wall: { A: 5000, B: 5000 } }", "initial: { wall: { A: 5000 } }", 1)
        .replacen("output: { every: 5 s }", "output: { every: 5 s, particles: { times: [0, 30 s] } }", 1);
    let bench = Bench::new();
    let dir = bench.run(&bench.model("cell.yaml", &text), "out", &[]);
    let (_, frames) = read_particles(&list_particles(&dir)[0].2).unwrap();
    let (first, last) = (&frames[0], frames.last().unwrap());
    let b = first.amounts.len() - 1;
    let there = |i: usize| last.amounts[b][i] / (gillesph::chemistry::AVOGADRO * last.volume[i]);
    // Particles keep their numbers; those above 123 came into being.
    let born: Vec<f64> = (123..last.len()).map(there).filter(|c| *c > 1e-9).collect();
    assert!(born.len() >= 12, "{}", born.len());
    let off = |c: &f64| (c / 2.0 - 1.0).abs();
    // Those between the sides have one donor that is not held.
    let held = born.iter().filter(|c| off(c) < 1e-9).count();
    assert!(held + 12 >= born.len(), "{born:?}");
}
