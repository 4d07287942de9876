//! A run folder without a run: made-up samples of cells whose walls put out a projection, to try the figures of solids on.

use super::write;
use crate::chemistry::AVOGADRO;
use crate::record::*;
use crate::tables::*;
use rand::Rng;
use std::path::Path;

const RADIUS: f64 = 10e-6;
const SPACING: f64 = 0.5e-6;
const LAYERS: u32 = 5;
const COLUMNS: u32 = 110;

/// Outer radius towards an angle: a round cell with a finger of a length.
fn outer(angle: f64, towards: f64, length: f64) -> f64 {
    let away = (angle - towards).sin().atan2((angle - towards).cos());
    RADIUS + length * (-(away / 0.3).powi(2)).exp()
}

fn record(realizations: u32, times: &[f64]) -> RunRecord {
    let units = |list: &[(&str, &str)]| list.iter().map(|(a, b)| (a.to_string(), b.to_string())).collect();
    let mut record = super::example::record(realizations, times);
    record.name = "a cell that puts out a projection".into();
    record.description = "Made up.".into();
    record.fluid = None;
    record.steps.fluid = None;
    record.domain.min = vec![-15e-6, -15e-6];
    record.domain.max = vec![25e-6, 25e-6];
    record.domain.groups = vec![GroupRecord {
        name: "wall".into(),
        material: "solid".into(),
        particles: (LAYERS * COLUMNS) as usize,
        volume: 1e-16,
        shape: "ring".into(),
        outlines: vec![],
    }];
    record.probes = vec![
        ProbeRecord {
            name: "tip".into(),
            kind: "point".into(),
            quantities: units(&[("dx", "m"), ("dy", "m"), ("vx", "m/s")]),
        },
        ProbeRecord {
            name: "wall".into(),
            kind: "solid".into(),
            quantities: units(&[
                ("largest_stretch", "1"),
                ("length", "m"),
                ("width", "m"),
                ("tip_curvature", "1/m"),
                ("hull_ratio", "1"),
                ("direction", "rad"),
                ("pressure_inside", "Pa"),
                ("mass", "kg"),
                ("escapes", "1"),
                ("mass_balance", "1"),
                ("residual", "1"),
                ("time_ratio", "1"),
            ]),
        },
        ProbeRecord {
            name: "wall outline".into(),
            kind: "outline".into(),
            quantities: units(&[("stress", "Pa")]),
        },
    ];
    record
}

/// Writes a whole run folder.
fn example(dir: &Path, realizations: u32) {
    let times: Vec<f64> = (0..=24).map(|k| f64::from(k) * 150.0).collect();
    let mut rng = crate::random::stream(8, 0, crate::random::Purpose::Deal);
    let (mut probes, mut frames) = (Vec::new(), Vec::new());
    for realization in 0..realizations {
        let (towards, fast) = (0.6 + rng.random_range(-0.5..0.5), rng.random_range(0.7..1.3));
        for &time in &times {
            let part = time / 3600.0;
            let length = 6e-6 * fast * part * part;
            let (sin, cos) = f64::sin_cos(towards);
            let tip = [(RADIUS + length) * cos, (RADIUS + length) * sin, 0.0];
            let mut push = |probe: &str, quantity: &str, value: f64| {
                probes.push(ProbeRows {
                    probe: probe.into(),
                    realization,
                    time,
                    quantity: quantity.into(),
                    s: vec![0.0],
                    position: vec![tip],
                    value: vec![value],
                });
            };
            push("tip", "dx", length * cos);
            push("tip", "dy", length * sin);
            push("tip", "vx", 1e-9);
            for (quantity, value) in [
                ("escapes", 0.0),
                ("largest_stretch", 1.0 + 0.4 * part),
                ("length", length),
                ("width", 5e-6),
                ("tip_curvature", 1e5 + 2e5 * part),
                ("hull_ratio", 1.0 + 0.05 * part * fast),
                ("direction", towards),
                ("pressure_inside", 2e5 * (time / 300.0).min(1.0)),
                ("mass", 1e-13 * (1.0 + 0.2 * part * fast)),
                ("mass_balance", 3e-9),
                ("residual", 8e-5),
                ("time_ratio", 2e-7),
            ] {
                push("wall", quantity, value);
            }
            let ring: Vec<f64> =
                (0..COLUMNS).map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(COLUMNS)).collect();
            let at = |a: &f64| {
                let r = outer(*a, towards, length);
                [r * a.cos(), r * a.sin(), 0.0]
            };
            probes.push(ProbeRows {
                probe: "wall outline".into(),
                realization,
                time,
                quantity: "stress".into(),
                s: ring.iter().map(|a| a * RADIUS).collect(),
                position: ring.iter().map(at).collect(),
                value: ring.iter().map(|a| 1e6 * a.cos().abs()).collect(),
            });
            if realization == 0 {
                frames.push(frame(time, towards, length, &mut rng));
            }
        }
    }
    write_probes(dir, &probes).unwrap();
    write_particles(dir, 0, 0, &["E".into()], &frames).unwrap();
    write_record(dir, &record(realizations, &times)).unwrap();
}

fn frame(time: f64, towards: f64, length: f64, rng: &mut crate::random::Stream) -> ParticleFrame {
    let mut f =
        ParticleFrame { time, groups: vec!["wall".into()], amounts: vec![vec![]], ..Default::default() };
    let volume = SPACING * SPACING * 1e-6;
    for column in 0..COLUMNS {
        let angle = std::f64::consts::TAU * f64::from(column) / f64::from(COLUMNS);
        for layer in 0..LAYERS {
            let r = outer(angle, towards, length) - (f64::from(layer) + 0.5) * SPACING;
            let near = (angle - towards).cos().max(0.0).powi(40);
            f.group.push(0);
            f.position.push([r * angle.cos(), r * angle.sin(), 0.0]);
            f.velocity.push([0.0; 3]);
            f.density.push(1100.0);
            f.pressure.push(0.0);
            f.volume_fraction.push(1.0);
            f.volume.push(volume);
            f.stress.push(8e5 * (1.0 + 0.2 * f64::from(layer)) * (1.0 - 0.6 * near) * (0.2 + time / 3600.0));
            f.stretch.push(1.1);
            f.amounts[0].push((near * rng.random_range(0.5..1.0) * AVOGADRO * volume).floor());
        }
    }
    f
}

#[test]
fn solids_are_drawn_and_checked() {
    let temporary = tempfile::tempdir().unwrap();
    // To look at the page, name a folder that stays.
    let kept = std::env::var_os("GILLESPH_EXAMPLE_SOLID");
    let dir = kept.as_ref().map_or(temporary.path(), Path::new);
    example(dir, 30);
    write(dir).unwrap();
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    for name in ["stress", "E", "outlines", "course", "distributions"] {
        assert!(dir.join(format!("figures/solid_wall_{name}.png")).exists(), "{name}");
    }
    assert!(dir.join("figures/solid_points.png").exists());
    // Nothing of a solid is drawn twice, as a probe along a line.
    assert!(!dir.join("figures/probe_wall_outline.png").exists());
    for words in
        ["<h2>Solids</h2>", "Escapes through wall", "Mass unaccounted for, relative, of wall", "200 kPa"]
    {
        assert!(page.contains(words), "{words}");
    }
    assert!(page.contains("All") && page.contains("checks passed") && !page.contains(">NaN"));
}

#[test]
fn a_wall_that_leaks_fails() {
    let dir = tempfile::tempdir().unwrap();
    example(dir.path(), 1);
    let mut rows = read_probes(dir.path()).unwrap();
    rows.iter_mut().filter(|r| r.quantity == "escapes" && r.time > 3000.0).for_each(|r| r.value[0] = 2.0);
    write_probes(dir.path(), &rows).unwrap();
    write(dir.path()).unwrap();
    let page = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
    assert!(page.contains("Failed: Escapes through wall"));
}
