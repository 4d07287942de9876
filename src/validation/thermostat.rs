//! Thermal noise: kinetic temperature, shape of the distribution, momentum (Español & Revenga 2003).

use super::findings::{Curves, Findings};
use super::flow::{End, Look, Pace, stated, watch_plane, watch_space};
use super::{Row, Scope, Shipped, Verdict, timed};
use crate::error::RunError;
use crate::figures::colours::{BLACK, palette};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::statistics::{mean, sem};
use crate::vector::Vector;

/// kT of the models, J: 300 K.
const ENERGY: f64 = 300.0 * 1.380_649e-23;
/// Time between looks, s.
const EVERY: f64 = 4e-10;
/// Looks at the start that do not count: 80 ns, 35 times the decay time of the slowest mode.
const WARM_UP: usize = 200;
/// Blocks of looks whose means are taken as independent.
const BLOCKS: usize = 20;
/// Limits: relative error of the temperature and of the kurtosis, |Σ m v| over Σ m |v|.
const TEMPERATURE_LIMIT: f64 = 0.005;
const KURTOSIS_LIMIT: f64 = 0.01;
const MOMENTUM_LIMIT: f64 = 1e-12;
/// Width of the classes of the histogram of one component, in sqrt(kT/m).
const CLASS: f64 = 0.2;
const CLASSES: usize = 40;

/// A run of one form of friction at one step.
struct Bath {
    name: String,
    dimensions: usize,
    end: End,
    /// T/T0 at each look after the warm-up.
    temperature: Vec<f64>,
    /// Sums of |v|² and |v|⁴ and their number.
    moments: [f64; 3],
    momentum: f64,
    /// Counts of one component over sqrt(kT/m), from -4 to 4.
    counts: Vec<f64>,
    looks: usize,
}

impl Bath {
    fn new(name: String, dimensions: usize) -> Bath {
        let counts = vec![0.0; CLASSES];
        let (temperature, moments) = (Vec::new(), [0.0; 3]);
        Bath { name, dimensions, end: End::default(), temperature, moments, momentum: 0.0, counts, looks: 0 }
    }

    fn see<const D: usize>(&mut self, look: &Look<D>) -> bool {
        self.looks += 1;
        if self.looks <= WARM_UP {
            return true;
        }
        let (mut twice_energy, mut momentum, mut size) = (0.0, Vector::<D>::zeros(), 0.0);
        for ((rho, volume), v) in look.density.iter().zip(&look.volume).zip(&look.velocity) {
            let mass = rho * volume * look.plan.thickness;
            twice_energy += mass * v.norm_squared();
            momentum += v * mass;
            size += mass * v.norm();
            // In units of kT/m, for a mass that is the same for all.
            let square = v.norm_squared() * mass / ENERGY;
            self.moments =
                [self.moments[0] + square, self.moments[1] + square * square, self.moments[2] + 1.0];
            let class = (v[0] * (mass / ENERGY).sqrt() / CLASS + 0.5 * CLASSES as f64).floor();
            if (0.0..CLASSES as f64).contains(&class) {
                self.counts[class as usize] += 1.0;
            }
        }
        // The total momentum is given: one particle less.
        let freedom = (D * (look.velocity.len() - 1)) as f64;
        self.temperature.push(twice_energy / (freedom * ENERGY));
        self.momentum = self.momentum.max(momentum.norm() / size);
        true
    }

    fn rows(&self) -> Vec<Row> {
        let size = self.temperature.len() / BLOCKS;
        let blocks: Vec<f64> = self.temperature.chunks_exact(size.max(1)).map(mean).collect();
        let found = mean(&self.temperature);
        let expected = (self.dimensions + 2) as f64 / self.dimensions as f64;
        let [square, fourth, count] = self.moments;
        let kurtosis = fourth * count / (square * square);
        let name = &self.name;
        let mut rows = vec![
            Row {
                quantity: format!("{name}: T/T0"),
                ours: found,
                // The printed noise heats to twice the temperature.
                published: Some(2.0),
                reference: Some(1.0),
                error: (found - 1.0).abs(),
                limit: TEMPERATURE_LIMIT,
            },
            stated(format!("{name}: standard error of T/T0, {BLOCKS} blocks"), sem(&blocks)),
            Row {
                quantity: format!("{name}: <v⁴>/<v²>², relative error"),
                ours: kurtosis,
                reference: Some(expected),
                error: (kurtosis / expected - 1.0).abs(),
                limit: KURTOSIS_LIMIT,
                ..Row::default()
            },
            super::flow::judged(format!("{name}: |Σ m v| / Σ m |v|"), self.momentum, None, MOMENTUM_LIMIT),
        ];
        rows.extend(self.end.rows(name));
        rows
    }
}

/// Both forms of friction in two and three dimensions; in two with a tenth of the step too (and a third in full).
pub fn noise(scope: Scope) -> Result<Verdict, RunError> {
    timed("thermostat: water at 300 K in a periodic box of particles of 10 nm", || {
        let mut baths = Vec::new();
        for friction in ["morris", "espanol_revenga"] {
            let shares: &[f64] = if scope.full { &[1.0, 0.3, 0.1] } else { &[1.0, 0.1] };
            for &share in shares {
                let until = if share < 0.2 && !scope.full { 400 } else { 800 };
                baths.push(bath(2, friction, share, until)?);
            }
            for &share in if scope.full { shares } else { &shares[..1] } {
                baths.push(bath(3, friction, share, if scope.full { 800 } else { 400 })?);
            }
        }
        let rows = baths.iter().flat_map(Bath::rows).collect();
        Ok(draw(rows, &baths))
    })
}

/// A bath in two or three dimensions with friction by name, at a share of the longest step, until so many ns.
fn bath(dimensions: usize, friction: &str, share: f64, until: u32) -> Result<Bath, RunError> {
    let mut bath = Bath::new(format!("{dimensions}D {friction}, {share} of the longest step"), dimensions);
    let (values, pace) = (values(friction, until), Pace { every: EVERY, share });
    let shipped = |model| Shipped { model, reactions: None };
    bath.end = if dimensions == 2 {
        let model = include_str!("../../models/validation/thermostat_2d.yaml");
        watch_plane(&shipped(model), &values, pace, |look| bath.see(look))?
    } else {
        let model = include_str!("../../models/validation/thermostat_3d.yaml");
        watch_space(&shipped(model), &values, pace, |look| bath.see(look))?
    };
    Ok(bath)
}

/// Friction by name, and the end in ns.
fn values(friction: &str, until: u32) -> Vec<String> {
    vec![format!("fluid.friction={friction}"), format!("run.until={until} ns")]
}

fn draw(rows: Vec<Row>, baths: &[Bath]) -> Findings {
    let middle: Vec<f64> = (0..CLASSES).map(|k| CLASS * (k as f64 + 0.5 - 0.5 * CLASSES as f64)).collect();
    let normal = |v: &f64| (-0.5 * v * v).exp() / std::f64::consts::TAU.sqrt();
    let fine: Vec<f64> = (0..=160).map(|k| f64::from(k) / 20.0 - 4.0).collect();
    let bell: Vec<f64> = fine.iter().map(normal).collect();
    let mut shape = vec![Trace::new("Maxwell", &fine, &bell, Style::Line, BLACK)];
    let (mut running, mut curves) = (Vec::new(), Vec::new());
    for (k, bath) in baths.iter().enumerate() {
        let total: f64 = bath.counts.iter().sum();
        let density: Vec<f64> = bath.counts.iter().map(|n| n / total / CLASS).collect();
        shape.push(Trace::new(&bath.name, &middle, &density, Style::Points, palette(k)));
        let (mut sum, mut time, mut mean) = (0.0, Vec::new(), Vec::new());
        for (n, value) in bath.temperature.iter().enumerate() {
            sum += value;
            if n % 20 == 19 {
                time.push(EVERY * 1e9 * (n + 1) as f64);
                mean.push(sum / (n + 1) as f64);
            }
        }
        curves.push(Curves::new(
            &format!("running_mean_{k}"),
            [("t_ns", time.clone()), ("temperature_over_T0", mean.clone())],
        ));
        curves.push(Curves::new(
            &format!("distribution_{k}"),
            [("v_over_thermal", middle.clone()), ("density", density)],
        ));
        running.push(Trace::new(&bath.name, &time, &mean, Style::Line, palette(k)));
    }
    let panels = [
        Plot {
            title: "a  one component".into(),
            x: Ruler::linear("v / (kT/m)^½").from(-4.0, 4.0),
            y: Ruler::logarithmic("density").from(1e-5, 1.0),
            traces: shape,
        },
        Plot {
            title: "b  running mean".into(),
            x: Ruler::linear("t after the warm-up (ns)"),
            y: Ruler::linear("T / T₀"),
            traces: running,
        },
    ];
    let caption =
        "a: distribution of one component of the velocity. b: mean kinetic temperature up to a time.";
    let figures = vec![plots("thermostat", "Thermal noise", caption, &panels, 2, 55.0)];
    Findings { rows, curves, figures }
}
