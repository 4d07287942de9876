//! Species in and on elastic solids: along walls and their surfaces, and between a solid and the fluid beside it.

mod face;

use face::Bench;
use gillesph::samples::ParticleFrame;
use gillesph::tables::{list_particles, read_particles};
use rstest::rstest;
use std::f64::consts::PI;
use std::path::Path;

fn frames(dir: &Path) -> Vec<ParticleFrame> {
    let mut parts = list_particles(dir);
    parts.sort();
    parts.iter().flat_map(|(_, _, path)| read_particles(path).unwrap().1).collect()
}

/// A ring of three layers, or a spherical shell, and its outermost layer.
fn wall(space: bool, lives: &str, at: &str) -> String {
    let (dimensions, corner, shape, centre) =
        if space { (3, "8 um, 8 um, 8 um", "shell", "0, 0, 0") } else { (2, "8 um, 8 um", "ring", "0, 0") };
    let low = corner.replace('8', "-8");
    format!(
        "name: wall
reactions: {{ species: {{ A: {{ diffusion: 1 um^2/s, representation: continuous, only_in: [{lives}] }} }} }}
domain: {{ kind: particles, dimensions: {dimensions}, min: [{low}], max: [{corner}] }}
particles: {{ spacing: 0.5 um }}
groups:
  wall: {{ material: solid, shape: {{ {shape}: {{ centre: [{centre}], inner: 3.5 um, outer: 5 um }} }} }}
  skin: {{ material: surface, of: wall, shape: {{ {shape}: {{ centre: [{centre}], inner: 4.5 um, outer: 5 um }} }} }}
solids:
  wall: {{ density: 1000 kg/m^3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, placement: layers }}
mechanics: {{ mode: quasi_static }}
fluid: {{ method: none }}
initial: {{ {at} }}
run: {{ until: 5 s }}
output: {{ every: 5 s, particles: {{ times: [0, 5 s] }} }}
"
    )
}

/// What is spread as 1 + cos θ over a ring of radius r decays at the rate D/r², over a sphere at 2 D/r²; in a wall by the
/// mean of 1/r². Seen: the rate over that, for a species of the skin alone and of the whole wall.
#[rstest]
#[case(false, "skin", 0.015)] // the chord for the arc: (2.5 spacings / r)²/8 at most
#[case(false, "wall, skin", 0.006)]
#[case(true, "skin", 0.015)]
#[case(true, "wall, skin", 0.006)]
fn molecules_spread_along_a_wall(#[case] space: bool, #[case] lives: &str, #[case] limit: f64) {
    let cosine = "A: \"1 mol/m^3 * (1 + x / (5 um))\"";
    let groups: Vec<String> = lives.split(", ").map(|group| format!("{group}: {{ {cosine} }}")).collect();
    let bench = Bench::new();
    let dir = bench.run(&bench.model("m.yaml", &wall(space, lives, &groups.join(", "))), "out", &[]);
    let frames = frames(&dir);
    let radius = |f: &ParticleFrame, i: usize| f.position[i].iter().map(|x| x * x).sum::<f64>().sqrt();
    let held = |f: &ParticleFrame, i: usize| lives.contains(f.group_name(i));
    let lean = |f: &ParticleFrame| -> f64 {
        (0..f.len()).map(|i| f.amounts[0][i] * f.position[i][0] / radius(f, i)).sum()
    };
    let (mut bend, mut volume) = (0.0, 0.0);
    for i in (0..frames[0].len()).filter(|&i| held(&frames[0], i)) {
        bend += frames[0].volume[i] / radius(&frames[0], i).powi(2);
        volume += frames[0].volume[i];
    }
    let exact = if space { 2.0 } else { 1.0 } * 1e-12 * bend / volume;
    let rate = (lean(&frames[0]) / lean(&frames[1])).ln() / 5.0;
    assert!((rate / exact - 1.0).abs() < limit, "{} of the rate", rate / exact);
    let sum = |f: &ParticleFrame| f.amounts[0].iter().sum::<f64>();
    assert!((sum(&frames[1]) / sum(&frames[0]) - 1.0).abs() < 1e-12);
    assert!((0..frames[1].len()).all(|i| held(&frames[1], i) || frames[1].amounts[0][i] == 0.0));
}

/// Between water (12 µm) and an elastic slab beside it (8 µm, particles as fine, finer and coarser): what was all in the
/// water spreads as a cosine series.
#[rstest]
#[case("0.5 um", 0.003)]
#[case("0.25 um", 0.003)]
#[case("0.75 um", 0.004)]
fn molecules_pass_between_a_fluid_and_a_solid(#[case] spacing: &str, #[case] limit: f64) {
    let text = format!(
        "name: exchange
reactions: {{ species: {{ A: {{ diffusion: 1000 um^2/s, representation: continuous }} }} }}
domain: {{ kind: particles, dimensions: 2, min: [0, 0], max: [20 um, 6 um], boundaries: {{ x: no_slip, y: periodic }} }}
particles: {{ spacing: 0.5 um }}
groups:
  slab: {{ material: solid, spacing: {spacing}, shape: {{ box: {{ min: [12 um, 0], max: [20 um, 6 um] }} }} }}
  water: {{ material: fluid, shape: everything_else }}
solids:
  slab: {{ density: 1000 kg/m^3, youngs_modulus: 10 Pa, poisson_ratio: 0.3, clamped: {{ box: {{ min: [18 um, 0], max: [23 um, 6 um] }} }} }}
fluid: {{ method: sph_bvf, density: 1000 kg/m^3, viscosity: 0.01 mPa s, speed: 0.1 mm/s, length: 6 um }}
initial: {{ water: {{ A: 10 uM }} }}
run: {{ until: 10 ms }}
output: {{ every: 5 ms, particles: {{ times: [5 ms, 10 ms] }} }}
"
    );
    let bench = Bench::new();
    let dir = bench.run(&bench.model("m.yaml", &text), "out", &[]);
    let (length, water, diffusivity) = (20e-6, 12e-6, 1e-9);
    let exact = |x: f64, t: f64| {
        let term = |n: u32| {
            let k = f64::from(n) * PI / length;
            2.0 / (length * k) * (k * water).sin() * (k * x).cos() * (-diffusivity * k * k * t).exp()
        };
        water / length + (1..400).map(term).sum::<f64>()
    };
    for frame in frames(&dir) {
        for i in 0..frame.len() {
            let found = frame.amounts[0][i] / (frame.volume[i] * 6.022_140_76e23 * 0.01);
            let exact = exact(frame.position[i][0], frame.time);
            // Both sides step down at the particle, not at the surface between them.
            assert!(
                (found - exact).abs() < limit,
                "{} s, {:?}: {found} {exact}",
                frame.time,
                frame.position[i]
            );
        }
    }
}

/// What is bound to a surface stays with it while the solid swings.
#[test]
fn a_surface_moves_with_its_solid() {
    let text = "\
name: bar
reactions: { species: { R: { diffusion: 1e4 um^2/s, only_in: [top] } } }
domain: { kind: particles, dimensions: 2, min: [-4 um, -10 um], max: [30 um, 14 um] }
particles: { spacing: 0.5 um }
groups:
  bar: { material: solid, shape: { box: { min: [-2 um, 0], max: [20 um, 4 um] } } }
  top: { material: surface, of: bar, shape: { box: { min: [-2 um, 3.5 um], max: [20 um, 4 um] } } }
solids:
  bar:
    density: 1000 kg/m^3
    bulk_modulus: 2 kPa
    shear_modulus: 500 Pa
    velocity: [0, \"2000 s^-1 * x\"]
    clamped: { box: { min: [-2 um, 0], max: [0, 4 um] } }
initial: { top: { R: 1000 } }
run: { until: 0.1 ms }
output: { every: 10 us, particles: { times: [0, 0.1 ms] } }
";
    let bench = Bench::new();
    let dir = bench.run(&bench.model("m.yaml", text), "out", &[]);
    let frames = frames(&dir);
    let top: Vec<usize> = (0..frames[1].len()).filter(|&i| frames[1].group_name(i) == "top").collect();
    assert_eq!(top.len(), 44);
    assert_eq!(top.iter().map(|&i| frames[1].amounts[0][i]).sum::<f64>(), 1000.0);
    assert!(top.iter().all(|&i| frames[0].group_name(i) == "top"), "no particle changes sides");
    // It has swung far, and its molecules have spread over it.
    assert!(top.iter().any(|&i| (frames[1].position[i][1] - frames[0].position[i][1]).abs() > 1e-6));
    assert!(top.iter().any(|&i| frames[1].amounts[0][i] != frames[0].amounts[0][i]));
}
