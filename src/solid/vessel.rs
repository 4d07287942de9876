//! A closed wall under turgor that follows its softness, grows and gets new columns: always in equilibrium.

use serde::{Deserialize, Serialize};

use crate::error::RunError;
use crate::solid::bonds::Bonds;
use crate::solid::elastic::{Elastic, Setup};
use crate::solid::growth::{Rates, lockhart};
use crate::solid::insert::{Birth, Present};
use crate::solid::outline::Outline;
use crate::solid::relax::{Relaxation, Relaxed};
use crate::solid::shell::Wall;
use crate::solid::surface::volume;
use crate::solid::turgor::{Inside, Turgor};
use crate::space::matrix::{Matrix, embed};
use crate::space::{Domain, Kernel, KernelKind};
use crate::vector::Vector;

/// Numbers of Lockhart's law and of what follows from growth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Growth {
    /// Stress below which nothing grows, Pa.
    pub yields: f64,
    /// Distance of two columns over the longest at the start, beyond which one is put between them.
    pub insert_at: f64,
    /// Columns that may come.
    pub reserve: usize,
}

/// Growth of any particle in one step at most; longer steps are divided.
const MOST: f64 = 0.02;
/// Edges that long, in edges at the start, are gaps.
const GAP: f64 = 2.0;

/// What must be kept of a vessel to go on with it later, to the bit; what follows from it is left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VesselState<const D: usize> {
    wall: Wall<D>,
    places: Vec<Vector<D>>,
    volumes: Vec<f64>,
    displacements: Vec<Vector<D>>,
    growth: Option<Vec<Matrix<D>>>,
    softness: Vec<f64>,
    before: Vec<Matrix<D>>,
    delivered: f64,
    step: f64,
    inside: Inside,
    last: Relaxed,
    time: f64,
    tally: crate::solid::elastic::Tally,
}

/// A closed wall in equilibrium with the turgor of what it encloses.
pub struct Vessel<const D: usize> {
    pub solid: Elastic<D>,
    pub wall: Wall<D>,
    turgor: Turgor,
    growth: Option<Growth>,
    relaxation: Relaxation,
    kernel: KernelKind,
    support: f64,
    domain: Domain<D>,
    /// At the start: volume inside (m^D), longest edges of the inner surface, middle and outer surface (m), mass (kg per
    /// unit thickness), columns.
    start: (f64, [f64; 3], f64, usize),
    /// Deformation before the present state of rest.
    before: Vec<Matrix<D>>,
    delivered: f64,
    step: f64,
    inside: Inside,
    last: Relaxed,
    time: f64,
}

impl<const D: usize> Vessel<D> {
    /// A wall as it is built, without load; [`Vessel::relax`] puts it under turgor.
    ///
    /// # Errors
    /// As [`Elastic::new`].
    pub fn new(
        setup: Setup<D>,
        wall: Wall<D>,
        turgor: Turgor,
        growth: Option<Growth>,
        relaxation: Relaxation,
    ) -> Result<Vessel<D>, RunError> {
        let (kernel, support, domain) = (setup.kernel, setup.cutoff, setup.domain.clone());
        let mut solid = Elastic::new(setup)?;
        solid.consist(&wall.skin(&solid.places, &solid.volumes));
        let inside = volume(&wall.inner(|i| solid.position(i)), &wall.faces);
        let edge = wall.longest_edges(|i| solid.position(i));
        let mass = (0..solid.len()).map(|i| solid.mass(i)).sum();
        Ok(Vessel {
            start: (inside, edge, mass, wall.columns),
            before: vec![Matrix::identity(); solid.len()],
            solid,
            wall,
            turgor,
            growth,
            relaxation,
            kernel,
            support,
            domain,
            delivered: 0.0,
            step: 0.0,
            inside: Inside { volume: inside, pressure: 0.0 },
            last: Relaxed::default(),
            time: 0.0,
        })
    }

    /// The state as it is now.
    #[must_use]
    pub fn image(&self) -> VesselState<D> {
        let solid = &self.solid;
        VesselState {
            wall: self.wall.clone(),
            places: solid.places.clone(),
            volumes: solid.volumes.clone(),
            displacements: solid.displacements.clone(),
            growth: solid.growth.clone(),
            softness: solid.softness.clone(),
            before: self.before.clone(),
            delivered: self.delivered,
            step: self.step,
            inside: self.inside,
            last: self.last,
            time: self.time,
            tally: solid.tally.clone(),
        }
    }

    /// Puts a vessel of the same setup into a state; `None` if the state belongs to another.
    #[must_use]
    pub fn restore(&mut self, state: VesselState<D>) -> Option<()> {
        let n = state.places.len();
        let fits = state.wall.columns * state.wall.layers == n
            && state.wall.columns >= self.start.3
            && [state.volumes.len(), state.displacements.len(), state.softness.len(), state.before.len()]
                == [n; 4]
            && state.growth.as_ref().is_none_or(|growth| growth.len() == n);
        if !fits {
            return None;
        }
        self.wall = state.wall;
        let skin = self.wall.skin(&state.places, &state.volumes);
        let bonds = self.bonds(&state.places, &state.volumes).ok()?;
        self.solid.begin_at(state.places, state.volumes, bonds);
        self.solid.growth = state.growth;
        self.solid.softness = state.softness;
        self.solid.consist(&skin);
        self.solid.displacements = state.displacements;
        self.solid.renew().ok()?;
        self.solid.time = state.time;
        self.solid.tally = state.tally;
        (self.before, self.delivered, self.step) = (state.before, state.delivered, state.step);
        (self.inside, self.last, self.time) = (state.inside, state.last, state.time);
        Some(())
    }

    /// From one equilibrium to the next, `dt` (s) later: with the softness of now the wall relaxes, grows (particle i at
    /// φ = `phi[i]`, 1/(Pa s)) and gets new columns; who gave what to whom, in order.
    ///
    /// # Errors
    /// As [`Vessel::relax`] and [`Vessel::insert`].
    pub fn advance(&mut self, dt: f64, phi: &[f64]) -> Result<Vec<Birth>, RunError> {
        let end = self.time + dt;
        self.solid.renew()?;
        if self.growth.is_some() && phi.iter().any(|&phi| phi > 0.0) {
            self.relax(self.time)?;
            self.grow(dt, phi)?;
        }
        self.relax(end)?;
        self.insert()
    }

    /// Brings the wall to equilibrium with the turgor of time `t` (s).
    ///
    /// # Errors
    /// As [`Elastic::relax`].
    pub fn relax(&mut self, t: f64) -> Result<Relaxed, RunError> {
        let (wall, turgor, start) = (&self.wall, &self.turgor, self.start.0);
        let inside = &mut self.inside;
        self.time = t;
        self.solid.time = t;
        let before = self.last.period;
        self.last = self.solid.relax(&self.relaxation, &mut self.step, |solid| {
            *inside = turgor.load(solid, wall, t, start);
        })?;
        // What was in balance already did not move.
        if self.last.period == 0.0 {
            self.last.period = before;
        }
        Ok(self.last)
    }

    /// Grows from the present equilibrium over `dt` (s) to the next, particle i at φ = `phi[i]` (1/(Pa s)): midpoint
    /// steps, as many as keep each step small.
    ///
    /// # Errors
    /// As [`Vessel::relax`].
    pub fn grow(&mut self, dt: f64, phi: &[f64]) -> Result<(), RunError> {
        let Some(growth) = self.growth else { return Ok(()) };
        let mut left = dt;
        while left > 1e-9 * dt {
            let rates = self.rates(&growth, phi);
            let fastest = rates.iter().map(Rates::sum).fold(0.0, f64::max);
            if fastest == 0.0 {
                self.time += left;
                return Ok(());
            }
            // Growth relaxes differences of stress at the rate φ E/(1 - ν²): explicit steps must follow that.
            let parts = (left * (fastest / MOST).max(self.maxwell(&rates, phi))).ceil().max(1.0);
            let (step, t) = (left / parts, self.time);
            let before = self.solid.growth.clone();
            self.solid.grow(&rates, 0.5 * step);
            self.solid.strain()?;
            self.solid.pull();
            self.relax(t + 0.5 * step)?;
            let rates = self.rates(&growth, phi);
            self.solid.growth = before;
            self.solid.strain()?;
            self.delivered += self.solid.grow(&rates, step);
            self.solid.strain()?;
            self.solid.pull();
            self.relax(t + step)?;
            left -= step;
        }
        Ok(())
    }

    /// Rate at which growth relaxes stress, where it is fastest, 1/s.
    fn maxwell(&self, rates: &[Rates<D>], phi: &[f64]) -> f64 {
        let nu = self.solid.material.poisson();
        let stiffness = self.solid.material.young() / (1.0 - nu * nu);
        let grows = rates.iter().zip(phi).filter(|one| one.0.sum() > 0.0);
        grows.map(|one| one.1).fold(0.0, |most: f64, phi| most.max(*phi)) * stiffness
    }

    fn rates(&self, growth: &Growth, phi: &[f64]) -> Vec<Rates<D>> {
        let normals = self.wall.normals(&self.solid);
        // The stress of the particle itself, not the recovered one: what grows gives way to its own stress, so energy is
        // only lost and nothing can build up from particle to particle.
        let one = |i| lockhart(&self.solid.stress(i), &normals[i / self.wall.layers], phi[i], growth.yields);
        (0..self.solid.len()).map(one).collect()
    }

    /// Puts new columns where the wall is stretched too far, and relaxes again; returns who gave what to whom, in order.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] when the reserve is used up; as [`Vessel::relax`].
    pub fn insert(&mut self) -> Result<Vec<Birth>, RunError> {
        let Some(growth) = self.growth else { return Ok(Vec::new()) };
        let at = |i| self.solid.position(i);
        if self.wall.stretched(at, &self.start.1).all(|(_, stretch)| stretch <= growth.insert_at) {
            return Ok(Vec::new());
        }
        let mut present = Present::new(&self.solid, &self.before);
        let capacity = self.start.3 + growth.reserve;
        let density = self.solid.material.density;
        let births = present.refine(
            &mut self.wall,
            (growth.insert_at, &self.start.1),
            capacity,
            density,
            self.time,
        )?;
        let bonds = self.bonds(&present.places, &present.volumes)?;
        self.before = std::mem::take(&mut present.gradients);
        let skin = self.wall.skin(&present.places, &present.volumes);
        self.solid.begin_again(present, bonds, &skin)?;
        self.step = 0.0;
        self.relax(self.time)?;
        Ok(births)
    }

    /// Bonds whose reach follows the longest edge of each column.
    fn bonds(&self, places: &[Vector<D>], volumes: &[f64]) -> Result<Bonds<D>, RunError> {
        let mut wide = vec![1.0_f64; self.wall.columns];
        for (edge, stretch) in self.wall.stretched(|i| places[i], &self.start.1) {
            for end in edge {
                wide[end as usize] = wide[end as usize].max(stretch);
            }
        }
        let widest = wide.iter().copied().fold(1.0, f64::max) * self.support;
        let layers = self.wall.layers;
        Bonds::each(places, volumes, &self.domain, widest, |i, j| {
            Kernel::new(self.kernel, 0.5 * self.support * (wide[i / layers] + wide[j / layers]))
        })
    }

    /// Turgor and volume inside.
    #[must_use]
    pub fn inside(&self) -> Inside {
        self.inside
    }

    /// Time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// How the last relaxation went.
    #[must_use]
    pub fn last(&self) -> Relaxed {
        self.last
    }

    /// Mass now less that at the start less what was delivered, over that at the start.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        (self.mass() - self.start.2 - self.delivered) / self.start.2
    }

    /// Mass of the wall, kg per unit thickness.
    #[must_use]
    pub fn mass(&self) -> f64 {
        (0..self.solid.len()).map(|i| self.solid.grown_mass(i)).sum()
    }

    /// Stretch of particle `i` from the very first state of rest, the largest of all directions.
    #[must_use]
    pub fn stretch(&self, i: usize) -> f64 {
        let f = self.solid.gradient(i) * self.before[i];
        embed(&(f.transpose() * f), 0.0).symmetric_eigenvalues().max().max(0.0).sqrt()
    }

    /// The largest stretch of all particles.
    #[must_use]
    pub fn largest_stretch(&self) -> f64 {
        (0..self.solid.len()).map(|i| self.stretch(i)).fold(0.0, f64::max)
    }

    /// The least distance of the inner from the outer surface, column by column, m.
    #[must_use]
    pub fn thinnest(&self) -> f64 {
        let at = |i| self.solid.position(i);
        let (inner, outer) = (self.wall.inner(at), self.wall.outer(at));
        inner.iter().zip(&outer).map(|(a, b)| (a - b).norm()).fold(f64::INFINITY, f64::min)
    }

    /// Ways out: gaps between columns, at the inner side, the middle or the outer side of the wall, and places where the inner
    /// or outer surface crosses itself.
    #[must_use]
    pub fn escapes(&self) -> usize {
        let at = |i| self.solid.position(i);
        let gaps = self.wall.stretched(at, &self.start.1).filter(|(_, stretch)| *stretch > GAP).count();
        gaps + self.wall.crossings(&self.wall.inner(at)) + self.wall.crossings(&self.wall.outer(at))
    }

    /// The shape of the outer surface.
    #[must_use]
    pub fn outline(&self) -> Outline<D> {
        Outline::new(&self.wall, &self.wall.outer(|i| self.solid.position(i)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::{Hold, Law, Material, Options};
    const TIGHT: Relaxation = Relaxation { tolerance: 1e-7, rounds: 100_000, stretch: 8.0 };

    /// A wall about the origin, outer radius one.
    fn vessel<const D: usize>(
        inner: f64,
        layers: usize,
        young: f64,
        pressure: f64,
        growth: Option<Growth>,
    ) -> Vessel<D> {
        let spacing = (1.0 - inner) / layers as f64;
        let built = Wall::<D>::round(&Vector::zeros(), inner, 1.0, spacing);
        let n = built.places.len();
        let setup = Setup {
            domain: Domain {
                min: Vector::from_element(-9.0),
                max: Vector::from_element(9.0),
                periodic: [false; D],
            },
            kernel: KernelKind::Lucy,
            cutoff: 1.6 * spacing,
            places: built.places,
            volumes: built.volumes,
            holds: vec![Hold::Free; n],
            material: Material::of_young(Law::NeoHookean, 1000.0, young, 0.3),
            options: Options::default(),
        };
        Vessel::new(setup, built.wall, Turgor { pressure, stiffness: 0.0, rise: 0.0 }, growth, TIGHT).unwrap()
    }

    /// Root mean square errors of radial displacement, radial and hoop stress against Lamé's solution, over their size.
    fn lame<const D: usize>(inner: f64, layers: usize) -> [f64; 3] {
        let (p, nu, d) = (1e-4, 0.3, D as i32);
        let mut vessel = vessel::<D>(inner, layers, 1.0, p, None);
        vessel.relax(0.0).unwrap();
        let normals = vessel.wall.normals(&vessel.solid);
        let stresses = vessel.wall.stresses(&vessel.solid, &normals);
        let k = p * inner.powi(d) / (1.0 - inner.powi(d));
        let (mut error, mut size) = ([0.0; 3], [0.0; 3]);
        for (i, stress) in stresses.iter().enumerate() {
            let x = vessel.solid.places()[i];
            let (r, out) = (x.norm(), crate::solid::recover::space(&(x / x.norm())));
            let (u, across) = ((vessel.solid.position(i) - x).dot(&x) / r, out.dot(&(stress * out)));
            let bulge = r.powi(-d);
            let exact = if D == 2 {
                [(1.0 + nu) * k * ((1.0 - 2.0 * nu) * r + 1.0 / r), k * (1.0 - bulge), k * (1.0 + bulge)]
            } else {
                let u = k * ((1.0 - 2.0 * nu) * r + (1.0 + nu) * 0.5 / (r * r));
                [u, k * (1.0 - bulge), k * (1.0 + 0.5 * bulge)]
            };
            let plane: f64 = (0..D).map(|a| stress[(a, a)]).sum();
            let hoop = (plane - across) / (D as f64 - 1.0);
            for (at, (ours, exact)) in [u, across, hoop].into_iter().zip(exact).enumerate() {
                error[at] += (ours - exact).powi(2);
                size[at] += exact * exact;
            }
        }
        // Both stresses against the size of the whole stress.
        let whole = size[1] + size[2];
        [(error[0] / size[0]).sqrt(), (error[1] / whole).sqrt(), (error[2] / whole).sqrt()]
    }

    #[test]
    fn rings_and_shells_under_pressure_follow_lame() {
        // Measured: 0.5, 0.7 and 1.1 % (thick ring), 0.2, 0.2 and 0.4 % (thin), 0.8, 1.5 and 1.5 % (shell).
        for [u, across, hoop] in [lame::<2>(0.75, 4), lame::<2>(0.9, 4), lame::<3>(0.75, 4)] {
            assert!(u < 0.02 && across < 0.02 && hoop < 0.02, "{u} {across} {hoop}");
        }
        let errors: Vec<[f64; 3]> = [4, 6, 8].into_iter().map(|layers| lame::<2>(0.75, layers)).collect();
        for (k, name) in ["displacement", "radial stress", "hoop stress"].into_iter().enumerate() {
            let order = (errors[0][k] / errors[2][k]).log2();
            // First order at least, within what changes with the number of layers.
            assert!(errors[2][k] < errors[0][k] && order > 0.4, "{name}: order {order}");
        }
    }

    /// Radius of the inner surface (outer one at rest: 1) of a neo-Hookean ring under pressure, plane strain: shooting on
    /// dP_R/dR = (P_Θ - P_R)/R, λ_r = r', λ_θ = r/R, P_k = G (λ_k - 1/λ_k) + λ ln(λ_r λ_θ)/λ_k.
    fn inflated(inner: f64, pressure: f64, material: &Material) -> f64 {
        let (g, lame) = (material.shear, material.bulk - 2.0 / 3.0 * material.shear);
        let stress = |a: f64, b: f64| g * (a - 1.0 / a) + lame * (a * b).ln() / a;
        // λ_r of a radial stress, by Newton's method.
        let radial = |p: f64, hoop: f64| {
            let mut a = 1.0;
            for _ in 0..50 {
                let slope = g * (1.0 + 1.0 / (a * a)) + lame * (1.0 - (a * hoop).ln()) / (a * a);
                a -= (stress(a, hoop) - p) / slope;
            }
            a
        };
        // Radial stress that is left outside when the inner surface goes to `r`.
        let outside = |r: f64| {
            let (steps, mut at) = (400, [r, -pressure * r / inner]);
            let h = (1.0 - inner) / f64::from(steps);
            let rate = |x: f64, at: [f64; 2]| {
                let (hoop, a) = (at[0] / x, radial(at[1], at[0] / x));
                [a, (stress(hoop, a) - at[1]) / x]
            };
            for k in 0..steps {
                let x = inner + h * f64::from(k);
                let a = rate(x, at);
                let b = rate(x + 0.5 * h, [at[0] + 0.5 * h * a[0], at[1] + 0.5 * h * a[1]]);
                at = [at[0] + h * b[0], at[1] + h * b[1]];
            }
            at[1]
        };
        let (mut low, mut high) = (inner, 1.6 * inner);
        for _ in 0..60 {
            let r = 0.5 * (low + high);
            if outside(r) < 0.0 { low = r } else { high = r }
        }
        low
    }

    #[test]
    fn a_ring_blown_up_by_a_quarter_follows_the_exact_solution() {
        let mut vessel = vessel::<2>(0.75, 4, 1.0, 0.05, None);
        vessel.relax(0.0).unwrap();
        let exact = inflated(0.75, 0.05, &vessel.solid.material);
        let inner = vessel.wall.inner(|i| vessel.solid.position(i));
        let ours = inner.iter().map(|x| x.norm()).sum::<f64>() / inner.len() as f64;
        // Measured: 0.5 %.
        assert!(exact > 0.85 && ((ours - exact) / (exact - 0.75)).abs() < 0.02, "{ours} {exact}");
    }

    #[test]
    fn a_wall_without_equilibrium_is_told() {
        // A neo-Hookean ring holds no more than about G ln(outer/inner) = 0.11.
        let told = vessel::<2>(0.75, 4, 1.0, 0.14, None).relax(0.0).unwrap_err().to_string();
        assert!(told.contains("no equilibrium") && told.contains("stretched"), "{told}");
    }

    #[test]
    fn free_growth_that_fits_is_free_of_stress() {
        fn grown<const D: usize>() {
            let mut vessel = vessel::<D>(0.75, 3, 1.0, 0.0, None);
            let rates: Vec<Rates<D>> = vessel
                .wall
                .normals(&vessel.solid)
                .iter()
                .flat_map(|_| {
                    vec![
                        Rates {
                            directions: std::array::from_fn(|k| Matrix::<D>::identity().column(k).into()),
                            rates: [0.1; D]
                        };
                        3
                    ]
                })
                .collect();
            let delivered = vessel.solid.grow(&rates, 1.0);
            vessel.solid.strain().unwrap();
            vessel.solid.pull();
            vessel.relax(0.0).unwrap();
            let factor = 0.1_f64.exp();
            for i in 0..vessel.solid.len() {
                // To the tolerance of the relaxation, of a strain of 1e-4.
                let ratio = vessel.solid.position(i).norm() / vessel.solid.places()[i].norm();
                assert!((ratio / factor - 1.0).abs() < 1e-6, "{ratio}");
                assert!(vessel.solid.stress(i).norm() < 1e-6);
            }
            let grown = vessel.start.2 * (0.1 * D as f64).exp_m1();
            assert!((delivered / grown - 1.0).abs() < 1e-12);
        }
        grown::<2>();
        grown::<3>();
    }

    /// Radius of the middle and mass of a thin ring over those at the start after growing under constant turgor, and the
    /// worst of growth over that of Lockhart's law with the stress p r_i/t of the moment.
    fn lockhart_ring(steps: u32, young: f64) -> (f64, f64) {
        let (phi, yields) = (0.04, 3.0);
        let mut vessel = vessel::<2>(0.9, 3, young, 1.0, Some(Growth { yields, insert_at: 9.0, reserve: 0 }));
        vessel.relax(0.0).unwrap();
        let (n, dt) = (vessel.solid.len(), 0.25 / f64::from(steps));
        let mut worst: f64 = 0.0;
        for _ in 0..steps {
            let pull = |vessel: &Vessel<2>| {
                let at = |i| vessel.solid.position(i);
                let size =
                    |nodes: Vec<Vector<2>>| nodes.iter().map(|x| x.norm()).sum::<f64>() / nodes.len() as f64;
                let (inner, outer) = (size(vessel.wall.inner(at)), size(vessel.wall.outer(at)));
                inner / (outer - inner)
            };
            let (before, mass) = (pull(&vessel), vessel.mass());
            vessel.grow(dt, &vec![phi; n]).unwrap();
            // The mean of both ends is second order in the step.
            let exact = phi * (0.5 * (before + pull(&vessel)) - yields);
            worst = worst.max(((vessel.mass() / mass).ln() / dt / exact - 1.0).abs());
        }
        assert!(vessel.imbalance().abs() < 1e-12, "{}", vessel.imbalance());
        let middle = vessel.wall.middle(|i| vessel.solid.position(i));
        (middle.iter().map(|x| x.norm()).sum::<f64>() / middle.len() as f64, worst)
    }

    #[test]
    fn a_ring_above_yield_grows_as_lockhart_says() {
        let (stiff, worst) = lockhart_ring(10, 300.0);
        // Measured 0.1 %: the wall is a tenth of the radius and strained by 3 %.
        assert!(stiff > 1.0 && worst < 0.01, "{worst}");
        // Midpoint: halving the step divides what is left by four.
        let radius = [8, 16, 32].map(|steps| lockhart_ring(steps, 60.0).0);
        let ratio = (radius[0] - radius[1]) / (radius[1] - radius[2]);
        assert!((3.0..5.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_vessel_goes_on_from_a_state_as_if_nothing_had_been() {
        let growth = Growth { yields: 1.0, insert_at: 1.2, reserve: 200 };
        let new = || vessel::<2>(0.75, 3, 20.0, 1.0, Some(growth));
        let phi = |vessel: &Vessel<2>| -> Vec<f64> {
            (0..vessel.solid.len()).map(|i| 0.05 * f64::from(vessel.solid.position(i)[0] > 0.9)).collect()
        };
        let mut straight = new();
        straight.relax(0.0).unwrap();
        let mut births = 0;
        for _ in 0..4 {
            births += straight.advance(0.3, &phi(&straight)).unwrap().len();
        }
        let file = postcard::to_allocvec(&straight.image()).unwrap();
        let mut resumed = new();
        resumed.restore(postcard::from_bytes(&file).unwrap()).expect("fits");
        for vessel in [&mut straight, &mut resumed] {
            for _ in 0..4 {
                births += vessel.advance(0.3, &phi(vessel)).unwrap().len();
            }
        }
        assert!(births > 0 && straight.image() == resumed.image());
        // One of fewer columns belongs to another setup.
        let mut larger = vessel::<2>(0.9, 3, 20.0, 1.0, None);
        assert!(larger.restore(new().image()).is_none());
    }

    #[test]
    fn columns_come_in_without_a_jump() {
        let growth = Growth { yields: 1.0, insert_at: 1.5, reserve: 200 };
        let mut vessel = vessel::<2>(0.75, 4, 20.0, 1.0, Some(growth));
        vessel.relax(0.0).unwrap();
        let phi: Vec<f64> = vessel
            .solid
            .places()
            .iter()
            .map(|x| 0.1 * (-8.0 * (x - Vector::<2>::x()).norm_squared()).exp())
            .collect();
        let mut phi = phi;
        let mut came = 0;
        for _ in 0..12 {
            vessel.grow(0.1, &phi).unwrap();
            let (mass, inside) = (vessel.mass(), vessel.inside().volume);
            let before: Vec<_> = vessel.wall.stresses(&vessel.solid, &vessel.wall.normals(&vessel.solid));
            let births = vessel.insert().unwrap();
            came += births.len();
            for birth in &births {
                phi.push(birth.donors.iter().map(|one| 0.5 * phi[one.0]).sum());
            }
            if !births.is_empty() {
                assert!((vessel.mass() / mass - 1.0).abs() < 1e-13);
                let after = vessel.wall.stresses(&vessel.solid, &vessel.wall.normals(&vessel.solid));
                let change =
                    before.iter().zip(&after).map(|(a, b)| (a - b).norm_squared()).sum::<f64>().sqrt();
                let size = before.iter().map(|a| a.norm_squared()).sum::<f64>().sqrt();
                let swell = vessel.inside().volume / inside - 1.0;
                // Measured: stress 1.3, 1.0 and 0.9 %, most of it at the new columns; volume 0.16, 0.02 and 0.02 %.
                assert!(change < 0.02 * size && swell.abs() < 3e-3, "{} {swell}", change / size);
            }
        }
        assert!(came > 0 && vessel.imbalance().abs() < 1e-12 && vessel.escapes() == 0);
    }
}
