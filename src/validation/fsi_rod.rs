//! A soft rod in the stream of a micro-channel (Jacob et al. 2021, section 4.6), against finite elements whose mesh bends
//! with the rod.

use super::findings::{Curves, Findings};
use super::flow::{judged, stated};
use super::table::Table;
use super::{Row, Scope, Shipped, Verdict, failed, planned, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, palette};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::fluid::interpolate::Carriers;
use crate::fluid::{Interpolator, Kernel};
use crate::plan::{Arena, ParticlePlan};
use crate::scene::Scene;
use crate::space::matrix::Matrix;
use crate::statistics::{mean, relative_l2};
use crate::vector::Vector;
use std::time::Instant;

/// Of the finite elements: where the middle of the tip goes, m, and the force along the stream, N per m of depth.
const TIP: [f64; 2] = [11.159e-6, -1.466e-6];
const FORCE: f64 = 1.321e-3;
/// Velocity of the plug that enters, m/s; width and length of the channel, m.
const PLUG: f64 = 33.3e-3;
const WIDTH: f64 = 100e-6;
const LENGTH: f64 = 300e-6;
/// Looks per unit of time, s; the last of them make the means, those before them the state it is compared with.
const EVERY: f64 = 0.05e-3;
const LAST: usize = 10;
/// Where the flux is read, m.
const GATES: [f64; 3] = [50e-6, 160e-6, 270e-6];
const ACROSS: usize = 50;
/// Squares along and across in whose middles the kinetic energy is read.
const SQUARES: [usize; 2] = [60, 20];

/// The model as it is shipped (with coarser fluid too in full).
pub fn rod(scope: Scope) -> Result<Verdict, RunError> {
    timed("fsi_rod: a soft rod bends in the stream of a micro-channel", || {
        let mut case = Case::default();
        for (spacing, quick) in [("1.25", true), ("1.6666666667", false)] {
            if scope.takes(spacing, quick) {
                case.run(spacing)?;
            }
        }
        Ok(case.draw())
    })
}

/// What is seen of a run at an instant.
struct Seen {
    time: f64,
    tip: [f64; 2],
    force: f64,
    energy: f64,
    flux: [f64; 3],
    /// Velocities at the points of the reference, m/s.
    field: Vec<Vector<2>>,
}

#[derive(Default)]
struct Case {
    rows: Vec<Row>,
    curves: Vec<Curves>,
    tips: Vec<Trace>,
    shapes: Vec<Trace>,
    lines: Vec<Trace>,
}

/// Places of a table, m.
fn points(table: &Table, x: &str, y: Option<&str>) -> Vec<Vector<2>> {
    let at = |row| Vector::from([table.number(row, x), y.map_or(0.5 * WIDTH, |y| table.number(row, y))]);
    (0..table.len()).map(at).collect()
}

impl Case {
    fn run(&mut self, spacing: &str) -> Result<(), RunError> {
        let shipped = Shipped { model: include_str!("../../models/fsi_rod.yaml"), reactions: None };
        let values = [format!("particles.spacing={spacing} um")];
        planned(&shipped, &values, |plan, _| match &plan.arena {
            Arena::Plane(arena) => self.follow(arena, plan.model.run.until, spacing),
            _ => Err(failed("the rod bends in a plane".into())),
        })
    }

    fn follow(&mut self, arena: &ParticlePlan<2>, until: f64, spacing: &str) -> Result<(), RunError> {
        let begun = Instant::now();
        let line = Table::read(include_str!("data/fsi_rod_centreline.csv"));
        let sections = Table::read(include_str!("data/fsi_rod_sections.csv"));
        let mut places = points(&line, "x_m", None);
        places.extend(points(&sections, "x_m", Some("y_m")));
        let mut scene = Scene::new(arena, 0)?;
        let looks = (until / EVERY).round();
        let limit = scene.flow.as_ref().map_or(f64::NAN, |flow| flow.step_limit().seconds);
        let steps = (until / looks / limit).ceil();
        let mut seen = Vec::new();
        for look in 0..looks as usize {
            scene.advance(until / looks / steps, steps as u64, &|| false)?;
            let late = look + LAST >= looks as usize;
            seen.extend(see(&scene, if late { &places } else { &[] }));
        }
        if seen.len() < 2 * LAST {
            return Err(failed("the rod must be watched for longer".into()));
        }
        let what = format!("fluid {spacing} um");
        self.judge(&what, &seen, (&line, &sections));
        self.health(&what, &scene, begun.elapsed().as_secs_f64());
        self.keep(spacing, &seen, &scene, &line);
        Ok(())
    }

    /// The means over the last looks beside the finite elements.
    fn judge(&mut self, what: &str, seen: &[Seen], (line, sections): (&Table, &Table)) {
        let (before, last) = seen[seen.len() - 2 * LAST..].split_at(LAST);
        let of =
            |part: &[Seen], value: &dyn Fn(&Seen) -> f64| mean(&part.iter().map(value).collect::<Vec<_>>());
        let mut relative = |name: &str, value: &dyn Fn(&Seen) -> f64, reference: f64, limit: f64| {
            let ours = of(last, value);
            self.rows.push(Row {
                quantity: format!("{what}: {name}"),
                ours,
                reference: Some(reference),
                error: (ours / reference - 1.0).abs(),
                limit,
                ..Row::default()
            });
        };
        relative("tip along the stream, um", &|s| 1e6 * s.tip[0], 1e6 * TIP[0], 0.05);
        relative("tip down, um", &|s| -1e6 * s.tip[1], -1e6 * TIP[1], 0.05);
        relative("force along the stream, mN/m", &|s| 1e3 * s.force, 1e3 * FORCE, 0.05);
        for (k, at) in GATES.iter().enumerate() {
            relative(
                &format!("flux at x = {:.0} um over that which enters", 1e6 * at),
                &|s| s.flux[k],
                1.0,
                0.02,
            );
        }
        let change = (of(last, &|s| s.energy) / of(before, &|s| s.energy) - 1.0).abs();
        self.rows.push(judged(
            format!("{what}: change of kinetic energy over {:.1} ms", 1e3 * EVERY * LAST as f64),
            change,
            None,
            1e-3,
        ));
        let field = mean_field(last);
        let column = |table: &Table, name: &str| table.every(name, 1);
        let (on, off) = field.split_at(line.len());
        let along: Vec<f64> = on.iter().map(|v| v[0]).collect();
        let error = relative_l2(&along, &column(line, "vx_m_per_s"));
        self.rows.push(judged(
            format!("{what}: velocity along the centreline, relative L2 error"),
            error,
            None,
            0.05,
        ));
        let both: Vec<f64> = off.iter().map(|v| v[0]).chain(off.iter().map(|v| v[1])).collect();
        let mut exact = column(sections, "vx_m_per_s");
        exact.extend(column(sections, "vy_m_per_s"));
        let error = relative_l2(&both, &exact);
        self.rows.push(judged(
            format!("{what}: velocity across at five places, relative L2 error"),
            error,
            None,
            0.05,
        ));
    }

    fn health(&mut self, what: &str, scene: &Scene<2>, seconds: f64) {
        let Some(flow) = &scene.flow else { return };
        let health = flow.health();
        let solid = scene.solid_health().unwrap_or_default();
        self.rows.push(judged(format!("{what}: penetrations"), health.penetrations as f64, None, 0.0));
        self.rows.push(judged(
            format!("{what}: largest density change"),
            health.largest_density_change,
            None,
            0.05,
        ));
        self.rows.push(stated(format!("{what}: largest stretch of the rod"), solid.largest_stretch));
        self.rows.push(stated(
            format!("{what}: million fluid particle-steps"),
            1e-6 * flow.particle_steps() as f64,
        ));
        self.rows.push(stated(
            format!("{what}: million solid particle-steps"),
            1e-6 * solid.particle_steps as f64,
        ));
        self.rows.push(stated(format!("{what}: wall time, s"), seconds));
    }

    fn keep(&mut self, spacing: &str, seen: &[Seen], scene: &Scene<2>, line: &Table) {
        let colour = palette(self.tips.len());
        let name = format!("fluid {spacing} um");
        let time: Vec<f64> = seen.iter().map(|s| 1e3 * s.time).collect();
        let tip: Vec<f64> = seen.iter().map(|s| 1e6 * s.tip[0]).collect();
        let force: Vec<f64> = seen.iter().map(|s| 1e3 * s.force).collect();
        let energy: Vec<f64> = seen.iter().map(|s| 1e9 * s.energy).collect();
        self.tips.push(Trace::new(&name, &time, &tip, Style::Line, colour));
        let (height, moved): (Vec<f64>, Vec<f64>) = midline(scene).into_iter().unzip();
        self.shapes.push(Trace::new(&name, &height, &moved, Style::Points, colour));
        let x: Vec<f64> = line.every("x_m", 1).iter().map(|x| 1e6 * x).collect();
        let field = mean_field(&seen[seen.len() - LAST..]);
        let component = |k: usize| field[..line.len()].iter().map(|v| 1e3 * v[k]).collect::<Vec<f64>>();
        self.lines.push(Trace::new(&name, &x, &component(0), Style::Line, colour));
        self.curves.push(Curves::new(
            &format!("tip_{spacing}"),
            [("t_ms", time), ("tip_um", tip), ("force_mN_per_m", force), ("energy_nJ_per_m", energy)],
        ));
        self.curves.push(Curves::new(
            &format!("centreline_{spacing}"),
            [("x_um", x), ("vx_mm_per_s", component(0)), ("vy_mm_per_s", component(1))],
        ));
        self.curves.push(Curves::new(&format!("midline_{spacing}"), [("y_um", height), ("dx_um", moved)]));
    }

    fn draw(mut self) -> Findings {
        let middle = Table::read(include_str!("data/fsi_rod_midline.csv"));
        let line = Table::read(include_str!("data/fsi_rod_centreline.csv"));
        let times = |table: &Table, name: &str, factor: f64| -> Vec<f64> {
            table.every(name, 1).iter().map(|value| factor * value).collect()
        };
        let elements = |x: &[f64], y: &[f64]| Trace::new("finite elements", x, y, Style::Line, BLACK);
        self.shapes.insert(0, elements(&times(&middle, "y_reference_m", 1e6), &times(&middle, "dx_m", 1e6)));
        self.lines.insert(0, elements(&times(&line, "x_m", 1e6), &times(&line, "vx_m_per_s", 1e3)));
        let end = self.tips.iter().flat_map(|trace| &trace.x).copied().fold(0.0, f64::max);
        self.tips.insert(0, elements(&[0.0, end], &[1e6 * TIP[0]; 2]));
        let panels = [
            Plot {
                title: "a  the rod".into(),
                x: Ruler::linear("height at rest (um)").from(0.0, 50.0),
                y: Ruler::linear("displacement along the stream (um)"),
                traces: self.shapes,
            },
            Plot {
                title: "b  centreline".into(),
                x: Ruler::linear("x (um)").from(0.0, 300.0),
                y: Ruler::linear("velocity along the stream (mm/s)"),
                traces: self.lines,
            },
            Plot {
                title: "c  tip".into(),
                x: Ruler::linear("t (ms)"),
                y: Ruler::linear("displacement along the stream (um)"),
                traces: self.tips,
            },
        ];
        let caption = "a: displacement of the rod's middle at the end, over its height at rest. b: velocity half way up the channel, mean over the last looks; inside the rod it is zero. c: the tip from rest; line: the steady state of the finite elements.";
        let figures = vec![plots("fsi_rod", "A soft rod in a stream", caption, &panels, 2, 50.0)];
        Findings { rows: self.rows, curves: self.curves, figures }
    }
}

/// Mean of the velocities at the points of the reference over some looks.
fn mean_field(seen: &[Seen]) -> Vec<Vector<2>> {
    let count = seen.first().map_or(0, |s| s.field.len());
    let at = |k: usize| {
        seen.iter().fold(Vector::zeros(), |sum: Vector<2>, s| sum + s.field[k]) / seen.len() as f64
    };
    (0..count).map(at).collect()
}

/// Tip, force, energy and fluxes of a scene, and its velocities at `places`.
fn see(scene: &Scene<2>, places: &[Vector<2>]) -> Option<Seen> {
    let (flow, rod) = (scene.flow.as_ref()?, scene.elastic(0)?);
    let tip = Vector::from([102.5e-6, 50e-6]);
    let away = |i: usize| (rod.places()[i] - tip).norm_squared();
    let n = (0..rod.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)))?;
    let beside = (rod.gradient(n) - Matrix::<2>::identity()) * (tip - rod.places()[n]);
    let moved = rod.position(n) - rod.places()[n] + beside;
    let middle = |k: usize, n: usize, length: f64| (k as f64 + 0.5) * length / n as f64;
    let [along, across] = SQUARES;
    let mut points: Vec<Vector<2>> = (0..along * across)
        .map(|k| Vector::from([middle(k / across, along, LENGTH), middle(k % across, across, WIDTH)]))
        .collect();
    for gate in GATES {
        points.extend((0..ACROSS).map(|k| Vector::from([gate, middle(k, ACROSS, WIDTH)])));
    }
    points.extend(places);
    let found = velocities(scene, &points);
    let (squares, rest) = found.split_at(along * across);
    let (gates, field) = rest.split_at(GATES.len() * ACROSS);
    let square = LENGTH * WIDTH / (along * across) as f64;
    let flux =
        |k: usize| gates[k * ACROSS..][..ACROSS].iter().map(|v| v[0]).sum::<f64>() / (ACROSS as f64 * PLUG);
    Some(Seen {
        time: flow.time(),
        tip: moved.into(),
        force: scene.force_on_solid(0)?[0],
        energy: squares.iter().map(|v| 0.5 * 1e3 * square * v.norm_squared()).sum(),
        flux: std::array::from_fn(flux),
        field: field.to_vec(),
    })
}

/// Velocities of fluid, rod and walls at places, m/s.
fn velocities(scene: &Scene<2>, points: &[Vector<2>]) -> Vec<Vector<2>> {
    let (plan, seen) = (scene.plan, &scene.snapshot);
    let boundary = plan.home.iter().copied().max().unwrap_or(0);
    let there = |i: usize| {
        let x = &seen.position[i];
        // Walls beside the channel, but neither what waits beyond its ends nor what is in reserve.
        let beside = (0.0..=LENGTH).contains(&x[0]) && !(0.0..=WIDTH).contains(&x[1]);
        scene.home[i] != boundary || beside
    };
    let mask: Vec<bool> = (0..seen.position.len()).map(there).collect();
    let carriers =
        Carriers { positions: &seen.position, volumes: &seen.volume, mask: &mask, domain: &plan.domain };
    // Two spacings: narrow, so that the stream beside the rod is not mixed with what is at rest.
    let kernel = Kernel::new(plan.kernel, plan.cutoff * 2.0 / 3.0);
    let read = Interpolator::new(points, &carriers, &kernel);
    let at = |p: usize| Vector::from([0, 1].map(|k| read.apply(p, |j| seen.velocity[j][k])));
    (0..points.len()).map(at).collect()
}

/// Height at rest and displacement along the stream of the rod's middle, um: the mean of the two particles beside it.
fn midline(scene: &Scene<2>) -> Vec<(f64, f64)> {
    let Some(rod) = scene.elastic(0) else { return Vec::new() };
    let edge = scene.plan.solids[0].spacing;
    let mut rows: Vec<(f64, Vec<f64>)> = Vec::new();
    for (i, place) in rod.places().iter().enumerate() {
        if (place[0] - 102.5e-6).abs() > 0.75 * edge {
            continue;
        }
        let moved = 1e6 * (rod.position(i) - place)[0];
        match rows.iter_mut().find(|(y, _)| (y - 1e6 * place[1]).abs() < 1e-3) {
            Some((_, row)) => row.push(moved),
            None => rows.push((1e6 * place[1], vec![moved])),
        }
    }
    rows.iter().map(|(y, row)| (*y, mean(row))).collect()
}
