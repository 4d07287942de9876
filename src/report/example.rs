//! A run folder without a run: made-up samples of a ring of receptors in a channel, to try the page on.

use super::write;
use crate::record::*;
use crate::statistics::Summary;
use crate::tables::*;
use rand::Rng;
use rand_distr::{Distribution, Poisson};
use std::path::Path;

const SPACING: f64 = 0.5e-6;
const CENTRE: [f64; 2] = [26e-6, 12.5e-6];

pub fn record(realizations: u32, times: &[f64]) -> RunRecord {
    let group = |name: &str, material: &str, particles, shape: &str, outlines| GroupRecord {
        name: name.into(),
        material: material.into(),
        particles,
        volume: particles as f64 * SPACING * SPACING * 1e-6,
        shape: shape.into(),
        outlines,
    };
    let circle = |r: f64| -> Vec<[f64; 2]> {
        let turn = |k: u32| f64::from(k) * 5f64.to_radians();
        (0..72).map(|k| [CENTRE[0] + r * turn(k).cos(), CENTRE[1] + r * turn(k).sin()]).collect()
    };
    let species = |name: &str, diffusion, only_in: &[&str]| SpeciesRecord {
        name: name.into(),
        diffusion,
        representation: "discrete".into(),
        only_in: only_in.iter().map(|s| s.to_string()).collect(),
    };
    let reaction = |name: &str, equation: &str, propensity: &str| ReactionRecord {
        name: name.into(),
        equation: equation.into(),
        propensity: propensity.into(),
    };
    let units = |list: &[(&str, &str)]| list.iter().map(|(a, b)| (a.to_string(), b.to_string())).collect();
    RunRecord {
        program: "gillesph".into(),
        version: "0.1.0".into(),
        format: 1,
        status: "finished".into(),
        error: None,
        name: "ring of receptors in a channel".into(),
        description: "A pheromone flows past a cell whose membrane binds it.".into(),
        model: ModelText {
            hash: "0".repeat(64),
            files: vec![("models/channel.yaml".into(), "name: channel\n# <made up>\n".into())],
            overrides: vec!["run.until=2 s".into()],
        },
        seed: 1,
        realizations: [0, realizations],
        finished: realizations,
        times: times.to_vec(),
        domain: DomainRecord {
            kind: "particles".into(),
            dimensions: 2,
            min: vec![0.0, 0.0],
            max: vec![52e-6, 25e-6],
            thickness: 1e-6,
            boundaries: vec!["periodic".into(), "no_slip".into()],
            groups: vec![
                group("water", "fluid", 4996, "", vec![]),
                group("cell", "wall", 79, "disc, centre (26, 12.5) µm, 2.5 µm", vec![circle(2.5e-6)]),
                group("membrane", "static", 125, "ring, centre (26, 12.5) µm, 2.5–4 µm", vec![circle(4e-6)]),
            ],
        },
        species: vec![
            species("L", 347e-12, &["water", "membrane"]),
            species("R", 0.0, &["membrane"]),
            species("RL", 0.0, &["membrane"]),
        ],
        reactions: vec![
            reaction("binding", "R + L -> RL", "1.66·10⁻⁶ s⁻¹ · R · L (V = 0.25 fL)"),
            reaction("binding (reverse)", "RL -> R + L", "1 s⁻¹ · RL"),
        ],
        conservation_laws: vec!["R + RL".into(), "L + RL".into()],
        conditions: vec!["inlet holds L at 200 nM for x < 2 µm".into()],
        probes: vec![
            ProbeRecord {
                name: "ring".into(),
                kind: "ring".into(),
                quantities: units(&[("L", "mol/m^3"), ("occupancy", "1")]),
            },
            ProbeRecord {
                name: "axis".into(),
                kind: "line".into(),
                quantities: units(&[("L", "mol/m^3"), ("vx", "m/s")]),
            },
        ],
        histograms: vec![],
        solids: vec![],
        precision: None,
        steps: StepsRecord {
            solid: None,
            fluid: Some(StepRecord { step: 1e-6, count: 2_000_000, limited_by: "speed of sound".into() }),
            chemistry: Some(StepRecord { step: 1e-4, count: 20_000, limited_by: "diffusion of L".into() }),
            method: "exact split sampling (Strang)".into(),
            approximations: vec!["operator splitting: second order in the chemistry step".into()],
            shared_flow: true,
            splitting_error: Some(2e-4),
        },
        fluid: Some(FluidRecord {
            method: "sph_bvf".into(),
            density: 1000.0,
            viscosity: 1e-3,
            sound_speed: 20e-3,
            speed: 2e-3,
            speed_of: "fluid.speed".into(),
            length: 25e-6,
            length_of: "the width between the walls along y".into(),
            mach: 0.1,
            reynolds: 0.05,
            noise: Some(NoiseRecord {
                temperature: 300.0,
                energy: 4.14e-21,
                thermal_speed: 4e-6,
                friction: "morris".into(),
            }),
        }),
        hybrid: vec![],
        health: Health {
            conservation: vec![
                ConservationRecord { sum: "R + RL".into(), start: 2000.0, ..Default::default() },
                ConservationRecord {
                    sum: "L + RL".into(),
                    start: 0.0,
                    largest_deviation: 4e5,
                    exempt: "inlet supplies L".into(),
                },
            ],
            molecules_supplied: [("L".to_string(), 8.1e6)].into(),
            penetrations: Some(0),
            bounces: Some(123_456),
            largest_mach: Some(0.08),
            largest_density_change: Some(0.011),
            temperature: Some(TemperatureRecord { mean: 299.0, looks: 21 }),
            warnings: vec!["the spacing resolves the membrane with 3 particles".into()],
            ..Default::default()
        },
        performance: Performance {
            particle_steps: 10_400_000_000,
            pair_evaluations: 291_000_000_000,
            solid_particle_steps: 0,
            bond_evaluations: 0,
            fluid_seconds: 512.0,
            reaction_events: 1_234_567,
            hops: 88_123_456,
            chemistry_seconds: 90.0,
            wall_seconds: 310.0,
            cpu_seconds: 602.0,
            peak_rss_bytes: 180 << 20,
            threads: 2,
        },
    }
}

fn polar(x: f64, y: f64) -> (f64, f64) {
    let (dx, dy) = (x - CENTRE[0], y - CENTRE[1]);
    (dx.hypot(dy), dy.atan2(dx))
}

/// mol/m³, a front that washes in, with a wake behind the cell.
fn level(x: f64, y: f64, time: f64) -> f64 {
    let (r, angle) = polar(x, y);
    let front = 1.0 / (1.0 + ((x - 40e-6 * time) / 5e-6).exp());
    4e-4 * front * (1.0 - 0.6 * (-(r / 8e-6)).exp() * (1.0 + angle.cos()) / 2.0)
}

/// Writes a whole run folder.
pub fn example(dir: &Path, realizations: u32) {
    let times: Vec<f64> = (0..=40).map(|k| f64::from(k) * 0.05).collect();
    let columns = Columns {
        groups: ["water", "membrane", "membrane", "membrane", "all", "all", "all"].map(String::from).to_vec(),
        species: ["L", "L", "R", "RL", "L", "R", "RL"].map(String::from).to_vec(),
    };
    let mut rng = crate::random::stream(7, 0, crate::random::Purpose::Deal);
    let (mut blocks, mut probes) = (Vec::new(), Vec::new());
    let draw = |mean: f64, rng: &mut crate::random::Stream| {
        Poisson::new(mean.max(1e-9)).map_or(0.0, |p| p.sample(rng))
    };
    for realization in 0..realizations {
        let mut block = SeriesBlock { realization, ..Default::default() };
        for &t in &times {
            let (water, near) =
                (draw(3e5 * (1.0 - (-t).exp()), &mut rng), draw(4000.0 * (1.0 - (-t).exp()), &mut rng));
            let bound = draw(700.0 * (1.0 - (-2.0 * t).exp()), &mut rng).min(2000.0);
            let values = [water, near, 2000.0 - bound, bound, water + near, 2000.0 - bound, bound];
            block.concentration.extend(values.map(|v| v * 1e-9));
            block.amount.extend(values);
        }
        blocks.push(block);
        for &t in times.iter().step_by(10) {
            let angles: Vec<f64> = (0..48).map(|k| f64::from(k) * 7.5f64.to_radians()).collect();
            let at = |a: f64| [CENTRE[0] + 4e-6 * a.cos(), CENTRE[1] + 4e-6 * a.sin(), 0.0];
            let xs: Vec<f64> = (0..104).map(|k| (f64::from(k) + 0.5) * SPACING).collect();
            let on_ring = angles.iter().map(|&a| at(a)).collect::<Vec<_>>();
            let on_axis = xs.iter().map(|&x| [x, 12.5e-6, 0.0]).collect::<Vec<_>>();
            for (probe, quantity, s, position) in [
                ("ring", "L", &angles, &on_ring),
                ("ring", "occupancy", &angles, &on_ring),
                ("axis", "L", &xs, &on_axis),
                ("axis", "vx", &xs, &on_axis),
            ] {
                let mut value = |p: &[f64; 3]| match quantity {
                    "L" => level(p[0], p[1], t) * rng.random_range(0.8..1.2),
                    "vx" => {
                        if polar(p[0], p[1]).0 < 3e-6 {
                            f64::NAN
                        } else {
                            2e-3 * (1.0 - 3e-6 / polar(p[0], p[1]).0)
                        }
                    }
                    _ => (0.5 - 0.2 * polar(p[0], p[1]).1.cos()) * t / 2.0 * rng.random_range(0.8..1.2),
                };
                let value = position.iter().map(&mut value).collect();
                let (probe, quantity, s, position) =
                    (probe.into(), quantity.into(), s.clone(), position.clone());
                probes.push(ProbeRows { probe, realization, time: t, quantity, s, position, value });
            }
        }
    }
    write_series(dir, &times, &columns, &blocks).unwrap();
    let series = SeriesTable { times: times.to_vec(), columns: columns.clone(), blocks };
    let cells = (0..times.len()).flat_map(|t| (0..columns.len()).map(move |c| (t, c)));
    let summaries: Vec<Summary> = cells.map(|(t, c)| Summary::of(&series.across(t, c))).collect();
    let mut statistics = StatisticsWriter::new(dir, &columns).unwrap();
    statistics.push(&times, &summaries).unwrap();
    statistics.finish().unwrap();
    write_probes(dir, &probes).unwrap();
    let frames: Vec<ParticleFrame> = times.iter().step_by(10).map(|&t| frame(t, &mut rng)).collect();
    write_particles(dir, 0, 0, &["L".into(), "R".into(), "RL".into()], &frames).unwrap();
    write_record(dir, &record(realizations, &times)).unwrap();
}

fn frame(time: f64, rng: &mut crate::random::Stream) -> ParticleFrame {
    let mut f = ParticleFrame {
        time,
        groups: ["water", "cell", "membrane"].map(String::from).to_vec(),
        amounts: vec![vec![]; 3],
        ..Default::default()
    };
    let volume = SPACING * SPACING * 1e-6;
    for k in 0..104 * 50 {
        let (x, y) = ((f64::from(k % 104) + 0.5) * SPACING, (f64::from(k / 104) + 0.5) * SPACING);
        let (r, angle) = polar(x, y);
        let group = if r < 2.5e-6 {
            1
        } else if r < 4e-6 {
            2
        } else {
            0
        };
        f.group.push(group);
        let jitter = if group == 0 { 0.15 * SPACING } else { 0.0 };
        f.position.push([
            x + jitter * rng.random_range(-1.0..1.0),
            y + jitter * rng.random_range(-1.0..1.0),
            0.0,
        ]);
        // Potential flow around a disc, faded to zero at the walls.
        let (q, wall) = ((4e-6 / r).powi(2).min(1.0), 4.0 * y / 25e-6 * (1.0 - y / 25e-6));
        let (u, v) = (1.0 - q * (2.0 * angle).cos(), -q * (2.0 * angle).sin());
        f.velocity.push(if group == 0 { [2e-3 * wall * u, 2e-3 * wall * v, 0.0] } else { [0.0; 3] });
        f.density.push(1000.0);
        f.pressure.push(if group == 0 { 0.5 * (1.0 - u * u - v * v) } else { 0.0 });
        f.volume_fraction.push(f64::from(u8::from(group > 0)));
        f.volume.push(volume);
        let mean = if group == 1 { 0.0 } else { level(x, y, time) * volume * crate::chemistry::AVOGADRO };
        f.amounts[0].push(Poisson::new(mean.max(1e-12)).map_or(0.0, |p| p.sample(rng)));
        let bound = if group == 2 { (5.0 * time).floor() } else { 0.0 };
        f.amounts[1].push(if group == 2 { 16.0 - bound } else { 0.0 });
        f.amounts[2].push(bound);
    }
    f
}

#[test]
fn the_page_of_a_run_stands_alone() {
    let temporary = tempfile::tempdir().unwrap();
    // To look at the page, name a folder that stays.
    let kept = std::env::var_os("GILLESPH_EXAMPLE");
    let dir = kept.as_ref().map_or(temporary.path(), Path::new);
    example(dir, 20);
    write(dir).unwrap();
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    for name in ["overview", "setup", "field_L", "velocity", "pressure", "occupancy", "amounts", "fano"] {
        assert!(dir.join(format!("figures/{name}.png")).exists(), "{name}");
    }
    for name in ["probe_ring", "probe_ring_occupancy", "probe_ring_polar", "probe_axis", "distributions"] {
        assert!(dir.join(format!("figures/{name}.png")).exists(), "{name}");
    }
    assert!(dir.join("figures/amounts.svg").exists() && !dir.join("figures/field_L.svg").exists());
    for words in
        ["Fluid</h3>", "sound speed c₀", "Reynolds number (length 25 µm", "299 K (21 looks)", "1.1 %"]
    {
        assert!(page.contains(words), "{words}");
    }
    assert!(page.contains("data:image/png;base64,") && page.contains("&lt;made up&gt;"));
    assert!(!page.contains("<script") && !page.contains("src=\"http") && !page.contains(">NaN"));
    let drawn = |name: &str| std::fs::read(dir.join("figures").join(name)).unwrap();
    let (png, svg) = (drawn("velocity.png"), drawn("amounts.svg"));
    write(dir).unwrap();
    assert!(png == drawn("velocity.png") && svg == drawn("amounts.svg"), "figures drawn again differ");
}

#[test]
fn a_record_without_tables_still_makes_a_page() {
    let dir = tempfile::tempdir().unwrap();
    assert!(write(dir.path()).is_err());
    write_record(dir.path(), &record(0, &[])).unwrap();
    write(dir.path()).unwrap();
    assert!(dir.path().join("report.html").exists());
}

#[test]
fn one_and_three_dimensions_are_drawn() {
    for (dimensions, figure) in [(1, "profiles"), (3, "field_L")] {
        let dir = tempfile::tempdir().unwrap();
        example(dir.path(), 2);
        let mut record = read_record(dir.path()).unwrap();
        record.domain.dimensions = dimensions;
        record.domain.min.resize(dimensions, 0.0);
        record.domain.max.resize(dimensions, 0.0);
        write_record(dir.path(), &record).unwrap();
        write(dir.path()).unwrap();
        assert!(dir.path().join(format!("figures/{figure}.png")).exists(), "{figure}");
    }
}
