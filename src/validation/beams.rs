//! Beams that swing: their particles, their periods, what they keep of their energy.

mod finite_elements;
mod timoshenko;

pub use finite_elements::Sheet;
pub use timoshenko::{Ends, Timoshenko};

use crate::error::RunError;
use crate::solid::{Elastic, Hold, Jaumann, Law, Material, Options, Setup};
use crate::space::{Domain, KernelKind};
use crate::vector::Vector;
use std::time::Instant;

/// A beam of length and height (m) along x from 0 on, `across` particles high; in space of square section.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    pub length: f64,
    pub height: f64,
    pub across: usize,
    pub ends: Ends,
    /// Cut-off over spacing.
    pub support: f64,
    pub material: Material,
}

/// Columns of clamped particles beyond an end.
const HELD: usize = 4;

impl Beam {
    /// The plate of SPH-BVF, section 4.5.
    #[must_use]
    pub fn published(across: usize, ends: Ends) -> Beam {
        let material = Material::of_young(Law::SaintVenantKirchhoff, 1000.0, 2e6, 0.3975);
        Beam { length: 0.2, height: 0.02, across, ends, support: 1.6, material }
    }

    /// Its particles.
    #[must_use]
    pub fn setup<const D: usize>(&self) -> Setup<D> {
        let spacing = self.height / self.across as f64;
        let along = (self.length / spacing).round() as usize;
        let (left, right) = match self.ends {
            Ends::Cantilever => (HELD, 0),
            Ends::Free => (0, 0),
            Ends::Clamped => (HELD, HELD),
        };
        let section = self.across.pow(D as u32 - 1);
        let mut places = Vec::with_capacity((left + along + right) * section);
        let mut holds = Vec::with_capacity(places.capacity());
        for column in 0..left + along + right {
            for cell in 0..section {
                let row = |k: usize| cell / self.across.pow(k as u32 - 1) % self.across;
                places.push(Vector::from_fn(|k, _| match k {
                    0 => (column as f64 - left as f64 + 0.5) * spacing,
                    _ => (row(k) as f64 + 0.5) * spacing - 0.5 * self.height,
                }));
                let free = (left..left + along).contains(&column);
                holds.push(if free { Hold::Free } else { Hold::Clamped });
            }
        }
        Setup {
            domain: Domain {
                min: Vector::from_element(-2.0 * self.length),
                max: Vector::from_element(3.0 * self.length),
                periodic: [false; D],
            },
            kernel: KernelKind::Lucy,
            cutoff: self.support * spacing,
            volumes: vec![spacing.powi(D as i32); places.len()],
            holds,
            places,
            material: self.material,
            options: Options::default(),
        }
    }

    /// Deflection of mode `n` of the thin beam at x (m), one at its right end or, if that is held, about one.
    pub fn shape(&self, n: usize) -> impl Fn(f64) -> f64 + use<> {
        let (k, ends, length) = (self.ends.wave(n), self.ends, self.length);
        let (sin, cos, sinh, cosh) = (k.sin(), k.cos(), k.sinh(), k.cosh());
        // cosh ∓ cos - ratio (sinh ∓ sin), with the lower sign where the left end is free.
        let ratio = match ends {
            Ends::Cantilever => (sinh - sin) / (cosh + cos),
            _ => (cosh - cos) / (sinh - sin),
        };
        let sign = if ends == Ends::Free { -1.0 } else { 1.0 };
        move |x| {
            let kx = k * (x / length).clamp(0.0, 1.0);
            0.5 * (kx.cosh() - sign * kx.cos() - ratio * (kx.sinh() - sign * kx.sin()))
        }
    }

    /// Longest time in which a mode moves once to and fro by the theory of beams, s.
    #[must_use]
    pub fn theory(&self, n: usize, plane: bool) -> f64 {
        let Beam { length, height, material, .. } = *self;
        2.0 * std::f64::consts::PI / Timoshenko { length, height, material, plane }.frequency(self.ends, n)
    }

    /// Period in plane strain by finite elements of a sixteenth of the height, s.
    #[must_use]
    pub fn reference(&self, n: usize) -> f64 {
        let held = match self.ends {
            Ends::Cantilever => [true, false],
            Ends::Free => [false; 2],
            Ends::Clamped => [true; 2],
        };
        let elements = [(16.0 * self.length / self.height).round() as usize, 16];
        let Beam { length, height, material, .. } = *self;
        let sheet = Sheet { length, height, elements, held, material };
        2.0 * std::f64::consts::PI / sheet.frequency(2.0 * std::f64::consts::PI / self.theory(n, true))
    }
}

/// What moves: either form of the equations.
pub trait Solid<const D: usize> {
    /// One step of `dt` (s).
    ///
    /// # Errors
    /// [`RunError::BlowUp`] if it blows up.
    fn go(&mut self, dt: f64) -> Result<(), RunError>;
    /// s.
    fn now(&self) -> f64;
    /// m.
    fn place(&self, i: usize) -> Vector<D>;
    /// Kinetic and elastic, J per unit thickness.
    fn energy(&self) -> f64;
}

impl<const D: usize> Solid<D> for Elastic<D> {
    fn go(&mut self, dt: f64) -> Result<(), RunError> {
        self.step(dt)
    }

    fn now(&self) -> f64 {
        self.time()
    }

    fn place(&self, i: usize) -> Vector<D> {
        self.position(i)
    }

    fn energy(&self) -> f64 {
        self.kinetic_energy() + self.elastic_energy()
    }
}

impl<const D: usize> Solid<D> for Jaumann<D> {
    fn go(&mut self, dt: f64) -> Result<(), RunError> {
        self.step(dt)
    }

    fn now(&self) -> f64 {
        self.time()
    }

    fn place(&self, i: usize) -> Vector<D> {
        self.position(i)
    }

    fn energy(&self) -> f64 {
        self.kinetic_energy() + self.elastic_energy()
    }
}

/// How a beam swung.
#[derive(Clone, Debug, Default)]
pub struct Swing {
    /// Of the first to and fro, and of the last, s.
    pub period: f64,
    pub last: f64,
    /// Energy at the end over that at the beginning.
    pub energy: f64,
    /// Times (s), deflections along the mode over the largest, and energies over the first.
    pub times: Vec<f64>,
    pub deflections: Vec<f64>,
    pub energies: Vec<f64>,
    /// Of each particle x and y when it first goes back, and at rest, m.
    pub bent: Vec<[f64; 4]>,
    pub particle_steps: f64,
    /// Wall time, s.
    pub seconds: f64,
}

/// Samples kept of each period.
const SAMPLES: f64 = 100.0;
/// Steps from one look to the next: a part of a thousand of a period, between which deflections are straight.
const EVERY: u64 = 8;

/// Lets a solid swing `periods` times in steps of `dt` (s) and looks along the mode `shape`; `expected` (s) is about
/// its period.
///
/// # Errors
/// As [`Solid::go`], or where it does not swing.
pub fn swing<const D: usize>(
    solid: &mut impl Solid<D>,
    places: &[Vector<D>],
    shape: impl Fn(f64) -> f64,
    (dt, expected, periods): (f64, f64, usize),
) -> Result<Swing, RunError> {
    let begun = Instant::now();
    let weights: Vec<f64> = places.iter().map(|x| shape(x[0])).collect();
    let size: f64 = weights.iter().map(|w| w * w).sum();
    let mut out = Swing::default();
    let (first, mut zeros, mut last, mut next) = (solid.energy(), Vec::new(), (0.0, 0.0), 0.0);
    while zeros.len() < 2 * periods {
        for _ in 0..EVERY {
            solid.go(dt)?;
        }
        let now = solid.now();
        let moved = |i: usize| (solid.place(i) - places[i])[1];
        let deflection = (0..places.len()).map(|i| weights[i] * moved(i)).sum::<f64>() / size;
        if last.1 != 0.0 && (deflection < 0.0) != (last.1 < 0.0) {
            zeros.push(last.0 + (now - last.0) * last.1 / (last.1 - deflection));
        }
        if out.bent.is_empty() && deflection < last.1 {
            let four = |i: usize| {
                let (x, rest) = (solid.place(i), places[i]);
                [x[0], x[1], rest[0], rest[1]]
            };
            out.bent = (0..places.len()).map(four).collect();
        }
        last = (now, deflection);
        if now >= next {
            next += expected / SAMPLES;
            out.times.push(now);
            out.deflections.push(deflection);
            out.energies.push(solid.energy() / first);
        }
        out.particle_steps += (EVERY * places.len() as u64) as f64;
        if now > 3.0 * expected * periods as f64 {
            return Err(super::failed("the beam does not swing".into()));
        }
    }
    out.period = zeros[1];
    out.last = zeros[2 * periods - 1] - if periods > 1 { zeros[2 * periods - 3] } else { 0.0 };
    out.energy = solid.energy() / first;
    out.seconds = begun.elapsed().as_secs_f64();
    Ok(out)
}

/// Lets an elastic beam swing in mode `n`, `speed` (m/s) at its fastest about the middle line.
///
/// # Errors
/// As [`swing`].
pub fn elastic<const D: usize>(
    beam: &Beam,
    setup: Setup<D>,
    (n, speed, periods): (usize, f64, usize),
) -> Result<Swing, RunError> {
    let places = setup.places.clone();
    let mut solid = Elastic::new(setup)?;
    let shape = beam.shape(n);
    solid.set_velocity(|x| Vector::from_fn(|k, _| if k == 1 { speed * shape(x[0]) } else { 0.0 }));
    let dt = solid.step_limit()?;
    swing(&mut solid, &places, shape, (dt, beam.theory(n, D == 2), periods))
}
