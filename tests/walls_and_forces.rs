//! Walls that move and forces that pull, said in a model: the two plane flows with an exact answer.

mod face;

use face::Bench;
use gillesph::statistics::relative_l2;
use gillesph::tables::read_probes;

const BOX: &str = "
reactions: { species: { L: { diffusion: 10 um^2/s } } }
domain: { kind: particles, dimensions: 2, min: [0, 0], max: [16 um, 20 um], boundaries: { x: periodic, y: no_slip } }
particles: { spacing: 1 um }
fluid: { density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s }
initial: { L: 1 uM }
run: { until: 0.4 ms }                   # ten viscous times H²/(π² ν) of 40 µs
output: { times: [0.4 ms], probes: { cut: { line: { from: [8 um, 1 um], to: [8 um, 19 um], points: 19 } } } }
";

/// Relative L2 error of vx across the channel against `exact` of y/H.
fn error(name: &str, conditions: &str, exact: impl Fn(f64) -> f64) -> f64 {
    let bench = Bench::new();
    let path = bench.model(&format!("{name}.yaml"), &format!("name: {name}{BOX}conditions: {conditions}\n"));
    let dir = bench.run(&path, name, &[]);
    let rows = read_probes(&dir).unwrap();
    let vx = rows.iter().find(|rows| rows.quantity == "vx").unwrap();
    let wanted: Vec<f64> = vx.position.iter().map(|x| exact(x[1] / 20e-6)).collect();
    relative_l2(&vx.value, &wanted)
}

/// u = g H²/(2 ν) y (1 - y). Twenty particles across give 1.2e-2; half the viscosity would give 1.
#[test]
fn a_body_force_drives_a_parabola() {
    let force = "{ pull: { force: { acceleration: [20 m/s^2, 0] } } }";
    let found = error("poiseuille", force, |y| 4e-3 * y * (1.0 - y));
    assert!(found < 2e-2, "{found}");
}

/// u = U y below a moving lid. Twenty particles across give 1e-3.
#[test]
fn a_lid_drags_a_straight_profile() {
    let lid = "{ lid: { moving_wall: { in: y_max, velocity: [1 mm/s, 0] } } }";
    let found = error("couette", lid, |y| 1e-3 * y);
    assert!(found < 5e-3, "{found}");
}
