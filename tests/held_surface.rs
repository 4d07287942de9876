//! Concentrations held at surfaces: order against an exact transient, and in a fluid that moves.

mod face;

use face::{Bench, amounts, record};
use gillesph::tables::read_probes;

/// A line of 10 µm, D = 100 µm²/s, empty at the start, the left surface at 1 µM and the right one at none. Amount at
/// time t over that of 1 µM everywhere: 1/2 - Σ over odd n of 4/(n² π²) e^{-n² π² D t/L²} (Crank 1975, section 4.3).
#[test]
fn a_held_surface_converges_to_the_exact_transient() {
    let bench = Bench::new();
    let fourier = 0.1; // D t / L² with t = 0.1 s
    let pi2 = std::f64::consts::PI.powi(2);
    let exact = 0.5
        - (1..200)
            .step_by(2)
            .map(|n| f64::from(n * n))
            .map(|n2| 4.0 / (n2 * pi2) * (-n2 * pi2 * fourier).exp())
            .sum::<f64>();
    let full = 1e-3 * 10e-6 * 1e-12 * gillesph::chemistry::AVOGADRO; // 1 µM in 10 µm x 1 µm²
    let mut errors = Vec::new();
    for cells in [10, 20, 40] {
        let series = bench.series(
            &format!(
                "name: line
reactions: {{ species: {{ A: {{ diffusion: 100 um^2/s }} }}, reactions: {{}} }}
domain: {{ kind: particles, dimensions: 1, min: [0], max: [10 um] }}
particles: {{ spacing: {} um, support: 2.4 }}
conditions: {{ on: {{ held: {{ in: x_min, species: {{ A: 1 uM }} }} }}, off: {{ held: {{ in: x_max, species: {{ A: 0 }} }} }} }}
chemistry: {{ representation: continuous, step: 10 ms }}
run: {{ until: 0.1 s }}
output: {{ times: [0, 0.1 s] }}
",
                10.0 / f64::from(cells)
            ),
            &[],
        );
        errors.push((amounts(&series, "all", "A", 0.1)[0] / full - exact).abs());
    }
    let order = (errors[0] / errors[2]).log2() / 2.0;
    println!("errors {errors:?}, order {order:.2}");
    assert!(errors[2] < 1e-3 && order > 1.7, "{errors:?}, order {order}");
}

/// Couette flow between a wall at rest and one that moves (Pe = 20, Sc = 1), concentration held or flux given at the
/// one, held at the other: the profile across the flow is linear, and what enters on one side leaves on the other.
/// Disorder of the particles costs some per cent next to the walls.
#[test]
fn walls_hold_and_feed_a_moving_fluid() {
    let bench = Bench::new();
    // J L / D = 2 µM for both: 2e-3 mol/m³ over 10 µm at 1e-6 m²/s.
    for feed in
        ["held: { in: x_min, species: { A: 3 uM } }", "flux: { in: x_min, species: { A: 2e-4 mol/m^2/s } }"]
    {
        let dir = bench.run(
            &bench.model(
                "couette.yaml",
                &format!(
                    "name: couette
reactions: {{ species: {{ A: {{ diffusion: 1e-6 m^2/s }} }}, reactions: {{}} }}
domain: {{ kind: particles, dimensions: 2, min: [0, 0], max: [10 um, 8 um], boundaries: {{ x: no_slip, y: periodic }} }}
particles: {{ spacing: 1 um, support: 2.6 }}
fluid: {{ density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 2 m/s }}
conditions:
  feed: {{ {feed} }}
  drain: {{ held: {{ in: x_max, species: {{ A: 1 uM }} }} }}
  lid: {{ moving_wall: {{ in: x_max, velocity: [0, 2 m/s] }} }}
chemistry: {{ representation: continuous }}
run: {{ until: 0.2 ms }}
output:
  times: [0.2 ms]
  probes:
    across: {{ line: {{ from: [1 um, 4 um], to: [9 um, 4 um], points: 9 }} }}
    fed: {{ surface: x_min }}
    taken: {{ surface: x_max }}
"
                ),
            ),
            "couette",
            &["--force"],
        );
        let rows = read_probes(&dir).unwrap();
        let row = |probe: &str, quantity: &str| {
            rows.iter().find(|r| r.probe == probe && r.quantity == quantity).unwrap().clone()
        };
        let (profile, speed) = (row("across", "A"), row("across", "vy"));
        for ((s, c), v) in profile.s.iter().zip(&profile.value).zip(&speed.value) {
            let x = s * 1e6 + 1.0;
            let expected = (1.0 + 2.0 * (1.0 - x / 10.0)) * 1e-3;
            assert!((c - expected).abs() < 0.05 * 2e-3, "{feed}: {c} at {x}, expected {expected}");
            assert!((v - 0.2 * x).abs() < 0.05 * 2.0, "vy {v} at {x}");
        }
        // J times 8 µm times 1 µm, mol/s.
        let expected = 2e-4 * 8e-12;
        for (probe, sign) in [("fed", 1.0), ("taken", -1.0)] {
            let found = row(probe, "A supply").value[0];
            assert!((found / expected - sign).abs() < 0.05, "{feed}: {probe} {found}, expected {expected}");
        }
        assert_eq!(record(&dir)["health"]["penetrations"], 0);
    }
}
