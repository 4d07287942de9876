//! Faults that users of other programs met, asked of the whole program: YAML in, tables out.
//!
//! 10 000 realizations where nothing else is said; means and variances within 4.5 standard errors (chance 7e-6
//! each, some 30 quantities), distributions at 1e-4. Seeds fixed beforehand.

#[path = "chemistry_cases/mod.rs"]
mod cases;
mod face;

use cases::*;
use face::{Bench, amounts};
use gillesph::tables::{ParticleFrame, list_particles, read_particles};
use rstest::rstest;

const LIMIT: f64 = 4.5;

/// A slow decay over 1000 steps: 100 molecules, k t = 0.1, so 90.48 are left, binomially. Programs that force an
/// event in every step, or forget the time left until the next one, leave none or all.
#[rstest]
#[case("method: split, step: 1 ms")]
#[case("method: direct")]
fn slow_decay_over_a_thousand_steps(#[case] method: &str) {
    let text = format!(
        "name: slow\nreactions: {{ species: [A], reactions: {{ decay: {{ equation: A -> 0, rate: 0.1 1/s }} }} }}\n\
         domain: {{ kind: well_mixed, volume: 1 fL }}\ninitial: {{ A: 100 }}\nchemistry: {{ {method} }}\n\
         run: {{ until: 1 s, realizations: 10000, seed: 121 }}\noutput: {{ times: [0.5 s, 1 s] }}\n"
    );
    let series = Bench::new().series(&text, &[]);
    for time in [0.5, 1.0] {
        let (left, p) = (amounts(&series, "all", "A", time), (-0.1 * time).exp());
        assert_mean(&left, 100.0 * p, 100.0 * p * (1.0 - p), LIMIT, method);
        assert_variance(&left, 100.0 * p * (1.0 - p), binomial_m4(100.0, p), LIMIT, method);
        assert_distribution(&left, &binomial_masses(100, p), method);
    }
}

/// Particles of 1 µm and of 0.5 µm side by side in a closed box: volumes 1 to 0.25, half of the volume each.
/// 100 molecules, all in one corner at the start, end up multinomial in the volumes: per particle 80 to 20, in
/// either half Binomial(100, 1/2). Equal counts per particle would put 80 % into the fine half.
#[test]
fn unequal_particles_share_by_volume() {
    let text = "name: unequal
reactions: { species: { A: { diffusion: 10 um^2/s } }, reactions: {} }
domain: { kind: particles, dimensions: 2, min: [0, 0], max: [6 um, 3 um] }
particles: { spacing: 1 um, support: 2 }
groups:
  fine: { spacing: 0.5 um, shape: { box: { min: [3 um, 0], max: [6 um, 3 um] } } }
  coarse: { shape: everything_else }
fluid: { method: none }
initial: { A: { molecules: 100, at: [0.5 um, 0.5 um] } }
chemistry: { step: 1 s }
run: { until: 40 s, realizations: 10000, seed: 122 }
output: { times: [40 s], particles: { times: [40 s], realizations: 500 } }
";
    let bench = Bench::new();
    let model = bench.model("unequal.yaml", text);
    let dir = bench.run(&model, "out", &[]);
    let series = gillesph::tables::read_series(&dir).unwrap();
    let coarse = amounts(&series, "coarse", "A", 40.0);
    assert_mean(&coarse, 50.0, 25.0, LIMIT, "coarse half");
    assert_variance(&coarse, 25.0, binomial_m4(100.0, 0.5), LIMIT, "coarse half");
    assert_distribution(&coarse, &binomial_masses(100, 0.5), "coarse half");
    // Shape among the particles: 9 coarse of a chance of 1/18 and 36 fine ones of 1/72, 50 000 molecules in all.
    let frames = last_frames(&dir);
    assert_eq!((frames.len(), frames[0].len()), (500, 45));
    let square: f64 = (0..45)
        .map(|i| {
            let seen: f64 = frames.iter().map(|frame| frame.amounts[0][i]).sum();
            let expected = if frames[0].position[i][0] < 3e-6 { 5e4 / 18.0 } else { 5e4 / 72.0 };
            (seen - expected).powi(2) / expected
        })
        .sum();
    // 44 degrees of freedom: 86.9 has the chance 1e-4.
    assert!(square < 86.9, "chi-square {square}");
}

/// The last frame of every realization that has one.
fn last_frames(dir: &std::path::Path) -> Vec<ParticleFrame> {
    list_particles(dir).iter().map(|(_, _, path)| read_particles(path).unwrap().1.pop().unwrap()).collect()
}

/// Outputs stand at the times asked for and show the state of these times, whatever the chemistry step, with
/// particles at rest and with particles that flow. A decays as exp(-k t), exactly in each half step.
#[rstest]
#[case("{ method: none }")]
#[case("{ method: sph_bvf, density: 1000 kg/m^3, viscosity: 1 mPa s, speed: 1 mm/s }")]
fn outputs_stand_at_the_times_asked_for(#[case] fluid: &str) {
    let times = [0.0, 0.1e-3, 0.137e-3, 0.5e-3, 0.501e-3, 1.0e-3];
    let text = format!(
        "name: times\nreactions: {{ species: {{ A: {{ diffusion: 10 um^2/s }} }}, \
         reactions: {{ decay: {{ equation: A -> 0, rate: 2000 1/s }} }} }}\n\
         domain: {{ kind: particles, dimensions: 2, min: [0, 0], max: [9 um, 9 um], \
         boundaries: {{ x: periodic, y: periodic }} }}\nparticles: {{ spacing: 1 um }}\n\
         groups: {{ medium: {{ material: fluid, shape: everything_else }} }}\nfluid: {fluid}\n\
         initial: {{ A: 1 uM }}\nchemistry: {{ representation: continuous, step: 0.3 ms }}\n\
         run: {{ until: 1 ms, realizations: 1, seed: 123 }}\noutput: {{ times: {times:?} }}\n"
    );
    let series = Bench::new().series(&text, &[]);
    assert_eq!(series.times, times);
    let start = amounts(&series, "all", "A", 0.0)[0];
    for time in times {
        let left = amounts(&series, "all", "A", time)[0] / start;
        // The rate equations are solved to 1e-9 relative in each of a few steps.
        assert!((left / (-2000.0 * time).exp() - 1.0).abs() < 1e-7, "{time}: {left}");
    }
}

/// Molecules asked for at a place are all in the nearest particle that holds the species, and in no other.
#[rstest]
#[case(1, "[3.4 um]", "")]
#[case(2, "[3.4 um, 1.2 um]", "")]
#[case(2, "[3.4 um, 1.2 um]", ", jitter: 0.3")]
#[case(3, "[3.4 um, 1.2 um, 2.7 um]", ", jitter: 0.3")]
fn molecules_start_where_asked(#[case] dimensions: usize, #[case] at: &str, #[case] jitter: &str) {
    let (min, max) = (vec!["0"; dimensions], vec!["6 um"; dimensions]);
    let text = format!(
        "name: placed\nreactions: {{ species: {{ A: {{ diffusion: 1 um^2/s }}, B: {{ only_in: [right] }} }}, \
         reactions: {{}} }}\n\
         domain: {{ kind: particles, dimensions: {dimensions}, min: [{}], max: [{}] }}\n\
         particles: {{ spacing: 1 um }}\ngroups:\n  \
         right: {{ shape: {{ box: {{ min: [{}], max: [{}] }} }} }}\n  \
         left: {{ shape: everything_else{jitter} }}\nfluid: {{ method: none }}\n\
         initial: {{ A: {{ molecules: 57, at: {at} }}, B: {{ molecules: 19, at: {at} }} }}\n\
         run: {{ until: 1 ms, realizations: 2, seed: 124 }}\n\
         output: {{ times: [0, 1 ms], particles: {{ times: [0], realizations: 2 }} }}\n",
        min.join(", "),
        max.join(", "),
        [&["4 um"], &min[1..]].concat().join(", "),
        max.join(", "),
    );
    let bench = Bench::new();
    let dir = bench.run(&bench.model("placed.yaml", &text), "out", &[]);
    let place = [3.4e-6, 1.2e-6, 2.7e-6];
    let frames = last_frames(&dir);
    assert_eq!(frames.len(), 2);
    for frame in frames {
        let far =
            |i: usize| -> f64 { (0..dimensions).map(|k| (frame.position[i][k] - place[k]).powi(2)).sum() };
        for (species, count, from) in [(0, 57.0, 0.0), (1, 19.0, 4e-6)] {
            let nearest = (0..frame.len())
                .filter(|&i| frame.position[i][0] > from)
                .min_by(|&a, &b| far(a).total_cmp(&far(b)))
                .unwrap();
            for i in 0..frame.len() {
                let expected = if i == nearest { count } else { 0.0 };
                assert_eq!(frame.amounts[species][i], expected, "particle {i} of species {species}");
            }
        }
    }
}
