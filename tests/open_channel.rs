//! Species carried through a channel with open ends: booked to the last molecule.

mod face;

use face::{Bench, gillesph, record, shipped};
use gillesph::tables::read_series;

/// A plug flow with free slip, L at 2 µM from the start and at the inlet.
fn plug(representation: &str, until: &str) -> String {
    format!(
        "name: plug
reactions: {{ species: {{ L: {{ diffusion: 50 um^2/s }}, P: {{ diffusion: 50 um^2/s }} }}, reactions: {{ turn: {{ equation: L -> P, rate: 100 1/s }} }} }}
domain: {{ kind: particles, dimensions: 2, min: [0, 0], max: [20 um, 10 um], boundaries: {{ x: open, y: free_slip }} }}
particles: {{ spacing: 1 um }}
fluid: {{ density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s, velocity: [1 mm/s, 0] }}
conditions:
  inlet: {{ open: {{ at: x_min, velocity: [1 mm/s, 0], species: {{ L: 2 uM }} }} }}
  outlet: {{ open: {{ at: x_max, pressure: 0 }} }}
initial: {{ L: 2 uM }}
chemistry: {{ representation: {representation} }}
run: {{ until: {until}, realizations: 4, seed: 11 }}
output: {{ every: 4 ms }}
"
    )
}

#[test]
fn molecules_enter_and_leave_with_their_particles() {
    let bench = Bench::new();
    let dir = bench.run(&bench.model("m.yaml", &plug("discrete", "40 ms")), "out", &[]);
    let series = read_series(&dir).unwrap();
    // L falls as exp(-k x/u) along the box: mean over it (1 - e^-2)/2 of 2 µM in 200 fL: 104.2 of L, the rest is P.
    let (inlet, length) = (2e-3 * 6.022_140_76e23 * 200e-18, 2.0_f64);
    let expected = inlet * (1.0 - (-length).exp()) / length;
    let (mut l, mut p, mut n) = (0.0, 0.0, 0.0);
    for time in [24e-3, 28e-3, 32e-3, 36e-3, 40e-3] {
        for (a, b) in
            face::amounts(&series, "all", "L", time).iter().zip(face::amounts(&series, "all", "P", time))
        {
            assert!(a.fract() == 0.0 && b.fract() == 0.0);
            (l, p, n) = (l + a, p + b, n + 1.0);
        }
    }
    let (l, p) = (l / n, p / n);
    println!("L {l:.1} of {expected:.1}, P {p:.1} of {:.1}", inlet - expected);
    // Poisson numbers, 4 realizations and 5 times of which those next to each other share 80 % of their particles, so
    // about 8 independent: standard errors 114 and 131; five of them (a false alarm in a million), and half a per cent
    // for diffusion (D k/u² = 0.5 %) and the rows of particles.
    let (of_l, of_p) = (5.0 * 114.0 + 0.005 * expected, 5.0 * 131.0 + 0.005 * (inlet - expected));
    assert!((l - expected).abs() < of_l && (p - (inlet - expected)).abs() < of_p);
    let run = record(&dir);
    let text = serde_json::to_string(&run).unwrap();
    assert!(
        text.contains("\"molecules_created_or_lost\":0.0")
            || text.contains("\"molecules_created_or_lost\":0,"),
        "{text}"
    );
    assert!(text.contains("\"penetrations\":0"));
}

#[test]
fn a_continuous_species_reaches_its_profile() {
    let bench = Bench::new();
    let dir = bench.run(&bench.model("m.yaml", &plug("continuous", "40 ms")), "out", &[]);
    let series = read_series(&dir).unwrap();
    let l = face::amounts(&series, "all", "L", 40e-3)[0];
    let inlet = 2e-3 * 6.022_140_76e23 * 200e-18;
    let expected = inlet * (1.0 - (-2.0_f64).exp()) / 2.0;
    println!("L {l:.2} of {expected:.2}");
    // D k/u² = 0.5 %, and what a column of particles more or less makes of the edges.
    assert!((l / expected - 1.0).abs() < 0.01, "{l} {expected}");
}

#[test]
fn the_shipped_models_are_sound() {
    for model in ["models/open_channel.yaml", "models/free_bead.yaml", "models/peristalsis.yaml"] {
        gillesph(&["check", shipped(model).to_str().unwrap()]);
    }
}

#[test]
fn tables_do_not_depend_on_the_threads() {
    let bench = Bench::new();
    let text = std::fs::read_to_string(shipped("models/open_channel.yaml")).unwrap();
    let model = bench.model("m.yaml", &text.replace("until: 40 ms", "until: 5 ms"));
    let read = |name: &str, threads: &str| {
        let dir = bench.run(&model, name, &["--threads", threads]);
        std::fs::read(dir.join("tables/series.parquet")).unwrap()
    };
    assert!(read("one", "1") == read("three", "3"));
}

#[test]
fn a_free_bead_in_a_model() {
    let bench = Bench::new();
    let text = std::fs::read_to_string(shipped("models/free_bead.yaml")).unwrap();
    let dir = bench.run(&bench.model("m.yaml", &text.replace("until: 20 ms", "until: 2 ms")), "out", &[]);
    let run = serde_json::to_string(&record(&dir)).unwrap();
    assert!(run.contains("\"penetrations\":0"), "{run}");
}
