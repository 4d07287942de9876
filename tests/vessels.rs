//! Walls in balance as a user meets them: softening, growth, molecules shared out, messages.

mod face;

use face::{Bench, amounts};
use gillesph::samples::ProbeRows;
use gillesph::tables::{read_probes, read_series};
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

#[test]
fn what_cannot_be_in_balance_is_said() {
    let cases: [(&str, &str, &str); 4] = [
        ("mechanics: { mode: quasi_static, tolerance: 1e-4 }", "", "add mechanics: { mode: quasi_static }"),
        ("    placement: layers\n", "", "the quasi-static mode is that of closed walls"),
        ("reserve: 600", "reserve: 9", "raise growth.reserve"),
        ("youngs_modulus: 20 MPa", "youngs_modulus: 0.2 MPa", "balloons"),
    ];
    for (from, to, words) in cases {
        let bench = Bench::new();
        let model = bench.model("cell.yaml", &CELL.replacen(from, to, 1));
        let out = bench.path("out");
        let mut command = Command::new(env!("CARGO_BIN_EXE_gillesph"));
        let output = command.arg("run").arg(model).arg("--quiet").arg("--out").arg(out).output().unwrap();
        assert!(!output.status.success(), "{words}");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(told.contains(words), "{words}: {told}");
    }
}
