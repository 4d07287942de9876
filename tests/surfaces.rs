//! Molecules that enter through a surface at a given flux or are absorbed by it, through the whole program.

mod face;

use face::{Bench, amounts, record};
use gillesph::tables::{list_particles, read_particles};

/// A line of `cells` particles 10 µm long, cross section 1 µm², diffusivity 100 µm²/s.
fn line(cells: usize, conditions: &str, initial: &str, rest: &str) -> String {
    format!(
        "name: line
reactions: {{ species: {{ A: {{ diffusion: 100 um^2/s }} }}, reactions: {{}} }}
domain: {{ kind: particles, dimensions: 1, min: [0], max: [10 um] }}
particles: {{ spacing: {} um, support: 2.4 }}
conditions: {{ {conditions} }}
initial: {{ {initial} }}
{rest}
",
        10.0 / cells as f64
    )
}

/// Places and amounts of A from left to right at the last output.
fn profile(bench: &Bench, text: &str) -> Vec<(f64, f64)> {
    let dir = bench.run(&bench.model("profile.yaml", text), "profile", &["--force"]);
    let (_, _, path) = list_particles(&dir).remove(0);
    let frames = read_particles(&path).unwrap().1;
    let frame = &frames[frames.len() - 1];
    let mut found: Vec<(f64, f64)> =
        (0..frame.len()).map(|i| (frame.position[i][0], frame.amounts[0][i])).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

const STEADY: &str = "chemistry: { representation: continuous, step: 20 ms }
run: { until: 60 s }
output: { times: [60 s], particles: { times: [60 s] } }";

/// Fed with J = 2000 /µm²/s on the left; on the right κ = 5 µm/s, or everything is taken. At rest the flux is J
/// everywhere: C = J/κ + J (10 µm - x) / D, molecules/µm³. Exact on the lattice with steps of any length, here 20 ms,
/// in which molecules spread over eight spacings; what is left of the start is below 1e-10.
#[test]
fn a_flux_and_an_absorbing_wall_hold_a_linear_profile() {
    let bench = Bench::new();
    for (wall, at_wall) in [("5 um/s", 2000.0 / 5.0), ("perfect", 0.0)] {
        let conditions = format!(
            "feed: {{ flux: {{ in: x_min, species: {{ A: 2000 /um^2/s }} }} }}, sink: {{ absorbing: {{ in: x_max, species: {{ A: {wall} }} }} }}"
        );
        let seen = profile(&bench, &line(20, &conditions, "A: 0", STEADY));
        assert_eq!(seen.len(), 20);
        for (x, n) in seen {
            let expected = (at_wall + 2000.0 * (10.0 - x * 1e6) / 100.0) * 0.5; // 0.5 µm³ each
            assert!((n / expected - 1.0).abs() < 1e-9, "{wall}, x = {x:e}: {n} against {expected}");
        }
    }
}

/// A closed left end and a wall on the right that takes D dC/dx = -κ C: the amount left of a uniform start is
/// Σ 2 B² / (b² (b² + B² + B)) e^{-b² Dt/L²}, b tan b = B, B = κ L / D (Crank 1975, 4.50). Second order.
#[test]
fn absorption_converges_to_the_series_of_crank() {
    let remaining = |big: f64, fourier: f64| -> f64 {
        (0..200)
            .map(|k| {
                // b in (kπ, kπ + π/2) by bisection of b sin b = B cos b.
                let (mut low, mut high) =
                    (f64::from(k) * std::f64::consts::PI, (f64::from(k) + 0.5) * std::f64::consts::PI);
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                for _ in 0..100 {
                    let b = 0.5 * (low + high);
                    if sign * (b * b.sin() - big * b.cos()) < 0.0 { low = b } else { high = b }
                }
                let b = 0.5 * (low + high);
                2.0 * big * big / (b * b * (b * b + big * big + big)) * (-b * b * fourier).exp()
            })
            .sum()
    };
    let bench = Bench::new();
    for (kappa, word) in [(5.0, "5 um/s"), (50.0, "50 um/s"), (1e9, "perfect")] {
        let mut errors = Vec::new();
        for cells in [10, 20, 40] {
            let conditions = format!("sink: {{ absorbing: {{ in: x_max, species: {{ A: {word} }} }} }}");
            let rest = "chemistry: { representation: continuous, step: 10 ms }
run: { until: 0.3 s }
output: { times: [0, 0.3 s] }";
            let series = bench.series(&line(cells, &conditions, "A: 10000", rest), &[]);
            let seen = amounts(&series, "all", "A", 0.3)[0] / 1e4;
            errors.push((seen - remaining(kappa * 10.0 / 100.0, 0.3)).abs());
        }
        let order = (errors[0] / errors[2]).log2() / 2.0;
        assert!(errors[2] < 1e-3 && order > 1.7, "{word}: {errors:?}, order {order}");
    }
}

/// Independent Poisson numbers, mean those of the rate equations: 400 realizations, 10 voxels; mean and variance
/// of each within 4.7 standard errors (a false alarm in 10 voxels and two walls has the chance 1e-4).
#[test]
fn whole_molecules_are_poisson_with_the_mean_of_the_rate_equations() {
    let bench = Bench::new();
    let conditions = "feed: { flux: { in: x_min, species: { A: 100 /um^2/s } } }, sink: { absorbing: { in: x_max, species: { A: 20 um/s } } }";
    let with = |representation: &str, runs: u32| {
        line(
            10,
            conditions,
            "A: 0",
            &format!(
                "chemistry: {{ representation: {representation} }}\nrun: {{ until: 1 s, realizations: {runs}, seed: 5 }}\noutput: {{ times: [1 s], particles: {{ times: [1 s], realizations: {runs} }} }}"
            ),
        )
    };
    let exact = profile(&bench, &with("continuous", 1));
    let model = bench.model("discrete.yaml", &with("discrete", 400));
    let dir = bench.run(&model, "discrete", &[]);
    let mut samples = vec![Vec::new(); 10];
    for (_, _, path) in list_particles(&dir) {
        let frame = read_particles(&path).unwrap().1.remove(0);
        for i in 0..frame.len() {
            samples[(frame.position[i][0] * 1e6) as usize].push(frame.amounts[0][i]);
        }
    }
    for ((x, mean), sample) in exact.into_iter().zip(samples) {
        let n = sample.len() as f64;
        let found = sample.iter().sum::<f64>() / n;
        let variance = sample.iter().map(|s| (s - found) * (s - found)).sum::<f64>() / (n - 1.0);
        assert!((found - mean).abs() < 4.7 * (mean / n).sqrt(), "{x:e}: {found} against {mean}");
        // Fourth central moment of a Poisson number: mean + 3 mean².
        let spread = ((mean + 3.0 * mean * mean - mean * mean) / n).sqrt();
        assert!((variance - mean).abs() < 4.7 * spread, "{x:e}: {variance} against {mean}");
    }
    let health = record(&dir);
    assert_eq!(health["health"]["molecules_created_or_lost"], 0.0);
}

/// The same as a hybrid species, real amounts where the flux enters and molecules where they are absorbed: the total is
/// kept to the molecule, and its mean is within 4.5 standard errors of a Poisson number (its own spread is less; chance
/// 7e-6).
#[test]
fn a_hybrid_species_passes_surfaces_in_both_forms() {
    let bench = Bench::new();
    let conditions = "feed: { flux: { in: x_min, species: { A: 1000 /um^2/s } } }, sink: { absorbing: { in: x_max, species: { A: 20 um/s } } }";
    let total = |chemistry: &str, runs: u32, name: &str| {
        let rest = format!(
            "chemistry: {{ {chemistry} }}\nrun: {{ until: 1 s, realizations: {runs}, seed: 8 }}\noutput: {{ times: [1 s] }}"
        );
        let dir = bench.run(&bench.model("hybrid.yaml", &line(10, conditions, "A: 0", &rest)), name, &[]);
        (amounts(&gillesph::tables::read_series(&dir).unwrap(), "all", "A", 1.0), record(&dir))
    };
    let mean = total("representation: continuous, step: 10 ms", 1, "rates").0[0];
    let (seen, record) =
        total("representation: hybrid, step: 10 ms, hybrid: { above: 80, below: 60 }", 400, "hybrid");
    let found = seen.iter().sum::<f64>() / seen.len() as f64;
    assert!((found - mean).abs() < 4.5 * (mean / seen.len() as f64).sqrt(), "{found} against {mean}");
    // Real amounts do not fluctuate, neither where they enter: less than a Poisson number.
    let variance = seen.iter().map(|s| (s - found) * (s - found)).sum::<f64>() / (seen.len() - 1) as f64;
    assert!(variance < 0.9 * mean, "{variance} of {mean}");
    assert_eq!(record["health"]["molecules_created_or_lost"], 0.0);
    // Both forms occur.
    let share = record["hybrid"][0]["continuous"].as_f64().unwrap();
    assert!(0.05 < share && share < 0.95, "{share}");
}

/// A disc of radius 5 µm takes all that reaches it from a plane held at a concentration beyond 16 µm: the flux is
/// 2 π D C / ln(16/5) per depth. First order in the spacing on curved outlines; 6 per cent at 1 µm.
#[test]
fn a_disc_absorbs_what_diffusion_brings() {
    let bench = Bench::new();
    let text = "name: disc
reactions: { species: { A: { diffusion: 100 um^2/s } }, reactions: {} }
domain: { kind: particles, dimensions: 2, min: [-20 um, -20 um], max: [20 um, 20 um] }
particles: { spacing: 1 um, support: 3 }
groups:
  cell:   { material: wall, shape: { disc: { centre: [0, 0], radius: 5 um } }, holds: none }
  medium: { shape: { difference: [{ disc: { centre: [0, 0], radius: 16 um } }, { disc: { centre: [0, 0], radius: 5 um } }] } }
  bath:   { shape: everything_else }
conditions:
  far:  { held: { in: bath, species: { A: 10 uM } } }
  cell: { absorbing: { in: cell, species: { A: perfect } } }
chemistry: { representation: continuous, step: 2 ms }
run: { until: 3 s }
output: { times: [2 s, 3 s] }
";
    let dir = bench.run(&bench.model("disc.yaml", text), "disc", &[]);
    let supplied = record(&dir)["health"]["molecules_supplied"]["A"].as_f64().unwrap();
    let series = gillesph::tables::read_series(&dir).unwrap();
    let inside = |t| amounts(&series, "medium", "A", t)[0];
    // At rest by 2 s; what the bath gave is what the medium holds and the cell took.
    assert!((inside(3.0) / inside(2.0) - 1.0).abs() < 1e-3);
    let concentration = 10e-3 * 6.022_140_76e23 * 1e-18; // molecules/µm³
    let taken = supplied - inside(3.0);
    let rate = std::f64::consts::TAU * 100.0 * concentration / (16.0_f64 / 5.0).ln();
    // Filling from empty delays the flux by about (16² - 5²) µm² / (4 D); compare over the last second alone.
    let shorter = text.replace("until: 3 s", "until: 2 s").replace("[2 s, 3 s]", "[2 s]");
    let dir = bench.run(&bench.model("shorter.yaml", &shorter), "shorter", &[]);
    let before = record(&dir)["health"]["molecules_supplied"]["A"].as_f64().unwrap() - inside(2.0);
    let ratio = (taken - before) / rate;
    assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
}

/// The same by every exact method: 300 realizations each of the line above, the total within 4.5 standard errors of
/// the rate equations and its variance that of a Poisson number (five methods: a false alarm has the chance 7e-5).
#[rstest::rstest]
fn every_method_knows_surfaces(
    #[values("split", "direct", "next_reaction", "next_subvolume", "composition_rejection")] method: &str,
) {
    let bench = Bench::new();
    let conditions = "feed: { flux: { in: x_min, species: { A: 100 /um^2/s } } }, sink: { absorbing: { in: x_max, species: { A: 20 um/s } } }";
    let total = |chemistry: &str, runs: u32| {
        let rest = format!(
            "chemistry: {{ {chemistry} }}\nrun: {{ until: 1 s, realizations: {runs}, seed: 6 }}\noutput: {{ times: [1 s] }}"
        );
        amounts(&bench.series(&line(10, conditions, "A: 0", &rest), &[]), "all", "A", 1.0)
    };
    let mean = total("representation: continuous, step: 0.1 ms", 1)[0];
    let seen = total(&format!("method: {method}"), 300);
    let n = seen.len() as f64;
    let found = seen.iter().sum::<f64>() / n;
    let variance = seen.iter().map(|s| (s - found) * (s - found)).sum::<f64>() / (n - 1.0);
    assert!((found - mean).abs() < 4.5 * (mean / n).sqrt(), "{found} against {mean}");
    assert!(
        (variance - mean).abs() < 4.5 * ((mean + 2.0 * mean * mean) / n).sqrt(),
        "{variance} against {mean}"
    );
}
