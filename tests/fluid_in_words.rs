//! What a user can say about a fluid and its solids, and the warnings that answer it.

mod face;

use face::{Bench, gillesph, record};
use gillesph::tables::read_probes;
use rstest::rstest;

/// A box of 20 µm, periodic along x.
fn model(groups: &str, fluid: &str, conditions: &str) -> String {
    format!(
        "name: words
reactions: {{ species: {{ A: {{ diffusion: 1 um^2/s }} }}, reactions: {{}} }}
domain: {{ kind: particles, dimensions: 2, min: [0, 0], max: [20 um, 20 um], boundaries: {{ x: periodic, y: no_slip }} }}
particles: {{ spacing: 1 um, support: 3 }}
groups:
  {groups}
  medium: {{ material: fluid, shape: everything_else }}
fluid: {{ density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s{fluid} }}
conditions: {{ {conditions} }}
run: {{ until: 1 us }}
output: {{ every: 1 us }}
"
    )
}

const POST: &str = "post: { material: wall, shape: { disc: { centre: [10 um, 10 um], radius: 4 um } } }";

/// Runs a model for a moment; what `check` prints of it.
fn checked(text: &str) -> String {
    let bench = Bench::new();
    let path = bench.model("m.yaml", text);
    bench.run(&path, "out", &[]);
    String::from_utf8(gillesph(&["check", path.to_str().unwrap()]).stdout).unwrap()
}

#[rstest]
#[case::method(", method: sdpd, friction: espanol_revenga, equation_of_state: tait, temperature: 300 K")]
#[case::plain(", method: sph, length: 20 um, sound_speed: 20 mm/s, pressure_scale: 1 Pa")]
#[case::printed(
    ", options: { pressure_switch: true, shepard: 20, density_rate: printed, shift: 5, courant: 0.1, delta: 0.1, surface_fraction: 0.5, drift_correction: 0 }"
)]
fn fluids(#[case] fluid: &str) {
    checked(&model(POST, fluid, ""));
}

#[rstest]
#[case::belt("m: { moving_wall: { in: y_max, velocity: [1 mm/s, 0] } }")]
#[case::travelling("m: { moving_wall: { in: post, velocity: [1 mm/s, 0], travels: true } }")]
#[case::oscillating("m: { moving_wall: { in: post, velocity: [0, 1 mm/s], frequency: 1 kHz } }")]
#[case::oscillating_side("m: { moving_wall: { in: y_min, velocity: [1 mm/s, 0], frequency: 1 kHz } }")]
#[case::rotating("m: { moving_wall: { in: post, rotation: 100 1/s, centre: [10 um, 10 um] } }")]
#[case::rotating_about_its_middle("m: { moving_wall: { in: post, rotation: 100 1/s } }")]
fn solids_move(#[case] motion: &str) {
    let text = model(POST, "", motion);
    checked(&text);
    // The same in space.
    let text = text
        .replace("dimensions: 2", "dimensions: 3")
        .replace("20 um, 20 um]", "20 um, 20 um, 20 um]")
        .replace("min: [0, 0]", "min: [0, 0, 0]")
        .replace("disc: { centre: [10 um, 10 um]", "ball: { centre: [10 um, 10 um, 10 um]")
        .replace("centre: [10 um, 10 um] }", "centre: [10 um, 10 um, 10 um], axis: [0, 1, 0] }")
        .replace("[1 mm/s, 0]", "[1 mm/s, 0, 0]")
        .replace("[0, 1 mm/s]", "[0, 1 mm/s, 0]")
        .replace("spacing: 1 um, support: 3", "spacing: 2 um, support: 2.6");
    checked(&text);
}

/// The vortices of Taylor and Green said by expressions; after a millisecond they have decayed by e^{-2 k² ν t} = 0.674
/// (k = 2 π/L). The probe's kernel of 3 spacings flattens a wave of 20 by 8 % at either time.
#[test]
fn a_velocity_by_expression() {
    let bench = Bench::new();
    let text = "name: vortices
reactions: { species: { A: { diffusion: 1 um^2/s } }, parameters: { k: 6283.185307 1/m }, reactions: {} }
domain: { kind: particles, dimensions: 2, min: [0, 0], max: [1 mm, 1 mm], boundaries: { x: periodic, y: periodic } }
particles: { spacing: 50 um, support: 3 }
fluid:
  density: 1000 kg/m^3
  viscosity: 5 mPa s
  speed: 10 mm/s
  length: 1 mm
  velocity: [\"-10 mm/s * cos(k * x) * sin(2 * pi * y / 1 mm)\", \"10 mm/s * sin(k * x) * cos(k * y)\"]
run: { until: 1 ms }
output: { times: [0, 1 ms], probes: { line: { line: { from: [0.25 mm, 0], to: [0.25 mm, 1 mm], points: 3 } } } }
";
    let dir = bench.run(&bench.model("vortices.yaml", text), "vortices", &[]);
    let rows = read_probes(&dir).unwrap();
    let k = std::f64::consts::TAU / 1e-3;
    for (time, row) in [0.0, 1e-3].into_iter().zip(rows.iter().filter(|r| r.quantity == "vy")) {
        let expected = 10e-3 * (-2.0 * k * k * 5e-6 * time).exp();
        for (v, sign) in row.value.iter().zip([1.0, -1.0, 1.0]) {
            assert!((v * sign / expected - 0.92).abs() < 0.03, "{time}: {v} against {expected}");
        }
    }
    assert!(record(&dir)["health"]["momentum_drift"].as_f64().unwrap() < 1e-10);
}

/// A post on the periodic side is the post in the middle, seen from half a box further.
#[rstest]
fn a_post_goes_on_beyond_a_periodic_side(#[values("square", "rings")] lattice: &str) {
    let bench = Bench::new();
    let profile = |centre: &str, line: &str| {
        let post = POST.replace("[10 um", &format!("[{centre} um"));
        let post = post.replace("wall,", &format!("wall, lattice: {lattice},"));
        let text = model(&post, "", "pull: { force: { acceleration: [1000 m/s^2, 0] } }")
            .replace("until: 1 us", "until: 20 us")
            .replace(
                "{ every: 1 us }",
                &format!("{{ times: [20 us], probes: {{ up: {{ line: {{ from: [{line} um, 0], to: [{line} um, 20 um], points: 9 }} }} }} }}"),
            );
        let dir = bench.run(&bench.model(&format!("m{centre}.yaml"), &text), centre, &[]);
        assert_eq!(record(&dir)["health"]["penetrations"], 0);
        let rows = read_probes(&dir).unwrap();
        let row = rows.iter().find(|row| row.quantity == "vx").unwrap();
        row.value.clone()
    };
    let (middle, side) = (profile("10", "16"), profile("20", "6"));
    assert!(middle[4] > 1e-3, "{middle:?}");
    // The same sums in another order.
    assert!(middle.iter().zip(&side).all(|(a, b)| (a - b).abs() < 1e-9 * middle[4]), "{middle:?} {side:?}");
}

/// Thermal noise is keyed by realization, so that no flow can be shared.
#[test]
fn noise_gives_each_realization_a_flow_of_its_own() {
    let bench = Bench::new();
    let text = model(POST, ", temperature: 300 K", "").replace("until: 1 us", "until: 1 us, realizations: 3");
    let dir = bench.run(&bench.model("m.yaml", &text), "out", &[]);
    let (noisy, shared) = (record(&dir), |r: &serde_json::Value| r["steps"]["shared_flow"].clone());
    assert_eq!((shared(&noisy), &noisy["finished"]), (false.into(), &3.into()));
    let text = text.replace(", temperature: 300 K", "");
    let dir = bench.run(&bench.model("m.yaml", &text), "out", &["--force"]);
    assert_eq!(shared(&record(&dir)), true);
}

#[rstest]
#[case::thin_wall(
    "plate: { material: wall, shape: { box: { min: [0, 9 um], max: [20 um, 11 um] } } }",
    &["m.yaml:6:3", "`plate` is 2 µm thick at (", "cut-off of 3 µm", "acts through it"]
)]
#[case::nothing_behind(
    "tube: { material: wall, lattice: rings, shape: { ring: { centre: [10 um, 10 um], inner: 3 um, outer: 4 um } } }\n  hole: { material: zone, shape: { disc: { centre: [10 um, 10 um], radius: 3 um } } }",
    &["m.yaml:6:3", "`tube` is 1 µm thick at (", "with nothing behind it"]
)]
#[case::narrow_gap(
    "plate: { material: wall, shape: { box: { min: [0, 3 um], max: [20 um, 6 um] } } }",
    &["m.yaml:6:3", "`plate` and the side y_min stand 3 µm apart at (0.5, 1.5) µm", "3.0 particles across"]
)]
#[case::slot(
    "plate: { material: wall, shape: { difference: [ { box: { min: [4 um, 4 um], max: [16 um, 16 um] } }, { box: { min: [9 um, 9 um], max: [11 um, 20 um] } } ] } }",
    &["`plate` closes to 2 µm apart", "fluid particles begin with a volume fraction of solid above 0.49", "(9.5, 9.5) µm, next to `plate`"]
)]
fn walls_that_do_not_fit_the_particles_are_told(#[case] wall: &str, #[case] words: &[&str]) {
    let mut text = model(wall, "", "");
    if wall.contains("hole") {
        text = text.replace(
            "shape: everything_else",
            "shape: { difference: [ { box: { min: [0, 0], max: [20 um, 20 um] } }, { disc: { centre: [10 um, 10 um], radius: 4 um } } ] }",
        );
    }
    let bench = Bench::new();
    let path = bench.model("m.yaml", &text);
    let said = String::from_utf8(gillesph(&["check", path.to_str().unwrap()]).stdout).unwrap();
    let dir = bench.run(&path, "out", &[]);
    let kept = record(&dir)["health"]["warnings"].to_string();
    for word in words {
        assert!(said.contains(word), "`{word}` is missing:\n{said}");
        assert!(kept.contains(word), "`{word}` is missing:\n{kept}");
    }
    assert!(said.contains("^^^^"), "{said}");
}

#[test]
fn walls_that_fit_are_not_warned_of() {
    assert!(!checked(&model(POST, "", "")).contains("warning"));
}

/// A lid ten times faster than stated.
#[test]
fn a_flow_too_fast_for_its_sound_speed_is_told_with_one_that_would_do() {
    let bench = Bench::new();
    let text = model(POST, ", sound_speed: 20 mm/s, velocity: [5 mm/s, 0]", "");
    let dir = bench.run(&bench.model("m.yaml", &text), "out", &[]);
    let warnings = record(&dir)["health"]["warnings"].to_string();
    for word in ["largest Mach number 0.2", "sound speed of 2.000e-2 m/s", "set fluid.sound_speed: 5"] {
        assert!(warnings.contains(word), "{warnings}");
    }
    assert!(std::fs::read_to_string(dir.join("report.html")).unwrap().contains("set fluid.sound_speed"));
}

/// What `check` tells of a flow, by its own arithmetic: Re = rho U L/mu, kT and its speed in a particle of 1 µm³.
#[test]
fn the_numbers_of_a_flow_are_told() {
    let said = checked(&model(POST, ", method: sdpd, temperature: 300 K, sound_speed: 20 mm/s", ""));
    for words in [
        "fluid: sdpd, density 1000 kg/m³, viscosity 1 mPa s",
        "largest speed expected 1 mm/s: fluid.speed",
        "sound speed 20 mm/s: Mach number 0.05",
        "Reynolds number 0.02: length 20 µm, the width between the walls along y",
        "thermal noise at 300 K: kT = 4.142e-21 J, thermal speed of a particle 2.04 mm/s",
    ] {
        assert!(said.contains(words), "`{words}` is missing:\n{said}");
    }
}

#[rstest]
#[case::fast_lid(", sound_speed: 20 mm/s", "lid: { moving_wall: { in: y_max, velocity: [5 mm/s, 0] } }", &[
    "m.yaml:9:15", "the wall `y_max` moves at 5 mm/s, faster than the fluid.speed of 1 mm/s", "set fluid.speed: 5.000e-3 m/s",
    "a Mach number of 0.25, above 0.2", "set fluid.sound_speed: 2.45e-1 m/s",
])]
#[case::fast_rotor("", "m: { moving_wall: { in: post, rotation: 1000 1/s, centre: [10 um, 10 um] } }", &[
    "the wall `post` moves at 4.", "faster than the fluid.speed",
])]
#[case::fast_start(", velocity: [0, \"3 mm/s * sin(x / (1 um))\"]", "", &["m.yaml:8:77", "the fluid at the start moves at"])]
#[case::too_soft(", sound_speed: 20 mm/s", "", &[
    // 12 mu U X/L² = 0.6 Pa over 1000 kg/m³ (20 mm/s)² = 0.4 Pa.
    "m.yaml:8:80", "change the density by some 150 %, above 5 %", "set fluid.sound_speed: 2.45e-1 m/s",
])]
#[case::hard_driven("", "pull: { force: { acceleration: [1e5 m/s^2, 0] } }", &[
    // g L²/(8 ν) = 5 m/s in the long run; 0.1 m/s in 1 us, of the 0.245 m/s chosen.
    "m.yaml:9:15", "the force `pull` would drive the fluid at up to 100 mm/s in the time of the run", "0.41 of the sound speed", "set fluid.speed",
])]
#[case::hot_walls(", method: sdpd, temperature: 300 K", "b: { free_body: { in: post, density: 1 kg/L } }", &["m.yaml:8:8", "`post` moves", "comes out too hot"])]
#[case::cold_walls(", temperature: 300 K", "", &["m.yaml:8:8", "comes out too cold", "set fluid.method: sdpd"])]
#[case::belt_through_itself("", "m: { moving_wall: { in: post, velocity: [1 mm/s, 0] } }", &[
    "m.yaml:9:15", "the belt `post` moves through its own surface", "travels: true",
])]
fn what_does_not_go_with_its_speed_is_told(
    #[case] fluid: &str,
    #[case] condition: &str,
    #[case] words: &[&str],
) {
    let bench = Bench::new();
    let path = bench.model("m.yaml", &model(POST, fluid, condition));
    let said = String::from_utf8(gillesph(&["check", path.to_str().unwrap()]).stdout).unwrap();
    for word in words {
        assert!(said.contains(word), "`{word}` is missing:\n{said}");
    }
}

/// h U/nu = 300: friction holds a shift of 0.3.
#[test]
fn a_weak_shift_is_told() {
    let bench = Bench::new();
    let text = model(POST, "", "b: { free_body: { in: post, density: 1 kg/L } }")
        .replace("viscosity: 1 mPa s, speed: 1 mm/s", "viscosity: 1 mPa s, speed: 100 m/s");
    let path = bench.model("m.yaml", &text);
    let said = String::from_utf8(gillesph(&["check", path.to_str().unwrap()]).stdout).unwrap();
    assert!(
        said.contains("m.yaml:8:8  particles are kept in order by a shift of 0.3 where 2 is usual"),
        "{said}"
    );
}

/// 400 particles of water in a periodic box, 3 realizations, 11 looks at each in the second half of the run, each 0.2 ns
/// from the last, twenty times the time Δ²/(10 nu) = 10 ps that friction takes: 3 x 11 x 800 numbers, of which neighbours share
/// a part. The standard error is below √(2/26400) = 0.9 %; four of them, passed by chance once in 16 000 runs.
#[test]
fn the_temperature_is_measured() {
    let bench = Bench::new();
    let text = "name: bath
reactions: { species: { A: { diffusion: 1 um^2/s } }, reactions: {} }
domain: { kind: particles, dimensions: 2, min: [0, 0], max: [0.2 um, 0.2 um], boundaries: { x: periodic, y: periodic }, thickness: 10 nm }
particles: { spacing: 10 nm, support: 2.5 }
fluid: { method: sdpd, density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 2 m/s, temperature: 300 K }
run: { until: 4 ns, realizations: 3 }
output: { every: 0.2 ns }
";
    let dir = bench.run(&bench.model("bath.yaml", text), "out", &[]);
    let found = &record(&dir)["health"]["temperature"];
    assert_eq!(found["looks"], 33);
    let mean = found["mean"].as_f64().unwrap();
    assert!((mean / 300.0 - 1.0).abs() < 0.036, "{mean}");
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(page.contains("<h3>Fluid</h3>") && page.contains("thermal speed of a particle"));
}
