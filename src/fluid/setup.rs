//! What a flow is made of.

use std::sync::Arc;

use crate::error::RunError;
use crate::fluid::motion::Motion;
use crate::space::domain::Domain;
use crate::space::kernel::KernelKind;
use crate::vector::Vector;

/// Signed distance to a surface, m: negative inside the solid. In the frame of the body at t = 0, asked for points
/// inside the box; a surface that reaches over a periodic end must itself know of its images.
pub type Surface<const D: usize> = Arc<dyn Fn(&Vector<D>) -> f64 + Send + Sync>;

/// Everything a [`Flow`](crate::fluid::Flow) is built from.
#[derive(Clone)]
pub struct Setup<const D: usize> {
    pub domain: Domain<D>,
    pub kernel: KernelKind,
    /// Cut-off h of the kernel, m.
    pub cutoff: f64,
    /// Distance of fluid particles on their lattice, m.
    pub spacing: f64,
    pub particles: Vec<Placed<D>>,
    /// At most 255; [`Placed::body`] points here.
    pub bodies: Vec<Body<D>>,
    /// U: the largest speed to be expected, m/s.
    pub reference_speed: f64,
    /// L: the width of the flow, m.
    pub reference_length: f64,
    /// c0, m/s; chosen by [`Setup::automatic_sound_speed`] if `None`.
    pub sound_speed: Option<f64>,
    /// Pressure differences to be expected, Pa; estimated if `None`.
    pub pressure_scale: Option<f64>,
    /// Acceleration of the fluid, m/s².
    pub body_force: Vector<D>,
    /// The largest size of what buoyancy may add to it along each axis, m/s²; for the sound speed.
    pub buoyancy: Vector<D>,
    pub sponges: Vec<Sponge<D>>,
    /// Of all fluid, m/s.
    pub initial_velocity: Vector<D>,
    pub method: Method,
    pub friction: Friction,
    pub state: EquationOfState,
    /// Thermal noise, if any.
    pub noise: Option<Noise>,
    pub options: Options,
}

/// Nothing in no box: for what is not stated of a setup. Unit speed, length and spacing, a cut-off of three.
impl<const D: usize> Default for Setup<D> {
    fn default() -> Setup<D> {
        Setup {
            domain: Domain { min: Vector::zeros(), max: Vector::zeros(), periodic: [false; D] },
            kernel: KernelKind::Lucy,
            cutoff: 3.0,
            spacing: 1.0,
            particles: Vec::new(),
            bodies: Vec::new(),
            reference_speed: 1.0,
            reference_length: 1.0,
            sound_speed: None,
            pressure_scale: None,
            body_force: Vector::zeros(),
            buoyancy: Vector::zeros(),
            sponges: Vec::new(),
            initial_velocity: Vector::zeros(),
            method: Method::default(),
            friction: Friction::default(),
            state: EquationOfState::default(),
            noise: None,
            options: Options::default(),
        }
    }
}

/// The equations of the fluid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Transport velocity with walls found from a volume fraction (Jacob et al. 2021).
    #[default]
    SphBvf,
    /// Smoothed dissipative particle dynamics (Español & Revenga 2003): particles move with their momentum, the
    /// density is the integral of the rate of its sum Σ m W, the pressure force m_i m_j (p_i/rho_i² + p_j/rho_j²).
    /// Without dissipation it conserves energy, which is what thermal noise wants; without density diffusion.
    Sdpd,
    /// Weakly compressible SPH as it was before transport velocities (Monaghan 1994; Morris, Fox & Zhu 1997): the
    /// equations of [`Method::Sdpd`], always with the friction of Morris.
    Sph,
}

/// The form of the friction between neighbours, and with it of the thermal noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Friction {
    /// Along the difference of velocities (Morris, Fox & Zhu 1997).
    #[default]
    Morris,
    /// With a part along the line of centres (Español & Revenga 2003).
    EspanolRevenga,
}

/// Pressure as a function of density.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EquationOfState {
    /// p = c0² (rho - rho0).
    #[default]
    Linear,
    /// p = c0² rho0/7 ((rho/rho0)⁷ - 1).
    Tait7,
}

/// Thermal noise between neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// kT over the thickness of the directions that are not simulated, J/m^(3-D).
    pub energy: f64,
    pub seed: u64,
    pub realization: u64,
}

/// A particle at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed<const D: usize> {
    /// m.
    pub position: Vector<D>,
    /// m^D.
    pub volume: f64,
    pub body: u8,
}

/// Particles of one material.
#[derive(Clone)]
pub struct Body<const D: usize> {
    pub name: String,
    pub kind: BodyKind<D>,
}

/// What a body is made of.
#[derive(Clone)]
pub enum BodyKind<const D: usize> {
    /// Rest density (kg/m³) and dynamic viscosity (Pa s).
    Fluid { density: f64, viscosity: f64 },
    /// A wall or an obstacle. With a `surface` no fluid particle can end a step inside.
    Solid { slip: Slip, motion: Motion<D>, surface: Option<Surface<D>> },
}

impl<const D: usize> Body<D> {
    /// Whether the fluid moves it.
    #[must_use]
    pub fn is_free(&self) -> bool {
        matches!(self.kind, BodyKind::Solid { motion: Motion::Free(_), .. })
    }

    /// Whether the fluid moves and bends it.
    #[must_use]
    pub fn is_elastic(&self) -> bool {
        matches!(self.kind, BodyKind::Solid { motion: Motion::Elastic(_), .. })
    }
}

/// What a solid does to the tangential velocity of the fluid at its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Slip {
    NoSlip,
    FreeSlip,
}

/// A region where the velocity relaxes to a target: dv/dt = -rate (v - target), solved exactly, so any rate
/// is stable. A very strong rate makes the region a plug that acts as a pump.
#[derive(Clone)]
pub struct Sponge<const D: usize> {
    pub region: Arc<dyn Fn(&Vector<D>) -> bool + Send + Sync>,
    /// 1/s.
    pub rate: f64,
    /// Target velocity by position, m/s.
    pub velocity: Arc<dyn Fn(&Vector<D>) -> Vector<D> + Send + Sync>,
}

/// A that keeps particles even in every case of `gillesph validate`. More stirs them: with 10 a Taylor-Green vortex of
/// 50² particles leaves its lattice with an error of 5 %, with 2 of 0.6 %; with 0.5 they clump, and it loses 4 % of its energy.
const USUAL_SHIFT: f64 = 2.0;

/// Largest A h U/ν where the momentum that the shift carries is not bounded ([`Setup::bounds_drift`]). That is the divergence of
/// ρ v⊗w: besides w·∇v it holds v ∇·w, by which velocities grow where particles draw apart, and only friction holds that. A
/// cavity of 100² at Re = 10 000 (h U/ν = 300) then blows up with A = 2 at 1.4 L/U, with 0.5 comes to 4.8 times the speed of
/// its lid within 8 L/U, with 0.3 to 1.5 times, while the flow starts; at Re = 1000 (30) A = 2 is steady.
const HELD_BY_FRICTION: f64 = 90.0;

/// Numerical choices; the defaults are meant to be kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Strength of the density diffusion (Antuono et al. 2010), dimensionless.
    pub delta: f64,
    /// Strength A of the shift; if `None` as [`Setup::shift`] says; 0 turns it off.
    pub shift: Option<f64>,
    /// Courant number dt (c0 + U)/h; 1/A but at most 0.2 if `None`.
    pub courant: Option<f64>,
    /// Volume fraction of solid from which a fluid particle is sent back.
    pub surface_fraction: f64,
    /// Extra radius of the neighbour lists, in cut-offs.
    pub skin: f64,
    /// Steps between corrections of the mean density; 0 turns them off.
    pub drift_correction: u64,
    /// SPH-BVF Eqs (26)-(29): another form of the pressure force where pressure is negative. Breaks conservation
    /// of momentum; for comparison with print.
    pub pressure_switch: bool,
    /// Steps between Shepard filters of the density, if any.
    pub shepard: Option<u64>,
    /// Whether friction is multiplied by what restores the second moment of the neighbours
    /// ([`crate::fluid::terms::Moment`]) and is of the fourth order, the divergence is that of
    /// [`Corrected`](crate::fluid::terms::Continuity::Corrected), and the density diffusion knows slopes.
    pub corrected: bool,
    /// The density rate as printed; it drifts where particles crowd. For comparison.
    pub printed_density_rate: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            delta: 0.1,
            shift: None,
            courant: None,
            // Fraction seen by a particle on a flat surface for h = 2.6-3 spacings, itself included.
            surface_fraction: 0.49,
            skin: 0.15,
            drift_correction: 20,
            pressure_switch: false,
            shepard: None,
            corrected: true,
            printed_density_rate: false,
        }
    }
}

impl<const D: usize> Setup<D> {
    /// Whether there is any solid.
    #[must_use]
    pub fn has_solids(&self) -> bool {
        self.bodies.iter().any(|body| matches!(body.kind, BodyKind::Solid { .. }))
    }

    /// Whether gradients of the velocity are known. With noise there are the plain sums, whose adjoint is the pressure force and
    /// whose noise is known: what is not adjoint heats the bath.
    #[must_use]
    pub fn knows_gradients(&self) -> bool {
        let options = &self.options;
        self.method == Method::SphBvf
            && options.corrected
            && !options.printed_density_rate
            && self.noise.is_none()
    }

    /// Whether what the drift carries is bounded next to solids (`carried`): where all of them move as told, so that nobody asks
    /// for the momentum they take. Far from solids, and where the fluid moves a solid, momentum is conserved to rounding.
    #[must_use]
    pub fn bounds_drift(&self) -> bool {
        self.knows_gradients() && !self.bodies.iter().any(|body| body.is_free() || body.is_elastic())
    }

    /// Strength A of the shift: 2, but at most 90 ν/(h U) where something else than solids that move as told disturbs the
    /// particles, as ends that are `open`, and where there are no walls; none where particles move
    /// with their momentum.
    #[must_use]
    pub fn shift(&self, open: bool) -> f64 {
        if self.method != Method::SphBvf {
            return 0.0;
        }
        let nu = self.bodies.iter().fold(f64::INFINITY, |least, body| match body.kind {
            BodyKind::Fluid { density, viscosity } => least.min(viscosity / density),
            BodyKind::Solid { .. } => least,
        });
        let held = USUAL_SHIFT.min(HELD_BY_FRICTION * nu / (self.cutoff * self.reference_speed));
        // Pumps, open ends and other fluids disturb particles too, and nothing bounds what they do.
        let fluids = self.bodies.iter().filter(|body| matches!(body.kind, BodyKind::Fluid { .. })).count();
        let only_solids = self.has_solids() && self.sponges.is_empty() && fluids == 1 && !open;
        let usual = if only_solids && self.bounds_drift() { USUAL_SHIFT } else { held };
        self.options.shift.unwrap_or(usual)
    }

    /// The lightest rest density and the largest viscosity among the fluids.
    pub(super) fn lightest_and_stickiest(&self) -> (f64, f64) {
        self.bodies.iter().fold((f64::INFINITY, 0.0), |(rho, mu), body| match body.kind {
            BodyKind::Fluid { density, viscosity } => (density.min(rho), viscosity.max(mu)),
            BodyKind::Solid { .. } => (rho, mu),
        })
    }

    /// Pressure differences to be expected, Pa: as given, or the drop of a plane Poiseuille flow of mean speed
    /// U and width L along the longest edge of the box, 12 mu U X/L².
    #[must_use]
    pub fn expected_pressure(&self) -> f64 {
        let longest = self.domain.lengths().max();
        let (_, mu) = self.lightest_and_stickiest();
        let length = self.reference_length;
        self.pressure_scale.unwrap_or(12.0 * mu * self.reference_speed * longest / (length * length))
    }

    /// The sound speed at which pressures change the density by 1 %, m/s: c0² = 100 max(p/rho0, |g| H) with p of
    /// [`Setup::expected_pressure`], or `prescribed` (Pa) if that is more, and H the extent of the box along g, buoyancy
    /// included, where walls bear the weight (on periodic axes the fluid falls freely and none is needed).
    #[must_use]
    pub fn pressed_sound_speed(&self, prescribed: f64) -> f64 {
        let (rho, _) = self.lightest_and_stickiest();
        let lengths = self.domain.lengths();
        let heavy = |k: usize| (self.body_force[k].abs() + self.buoyancy[k]) * lengths[k];
        let weight: f64 = (0..D).filter(|&k| !self.domain.periodic[k]).map(heavy).sum();
        (100.0 * self.expected_pressure().max(prescribed) / rho).max(100.0 * weight).sqrt()
    }

    /// The sound speed that keeps the density within about 1 %, m/s: the larger of 10 U and
    /// [`Setup::pressed_sound_speed`].
    /// With noise it is at least 150 times the thermal speed of a particle, so that densities stray by 0.7 %, in the
    /// worst of very many by 4: with 70 times SDPD of 10 nm particles blew up.
    /// A flow raises it up to threefold as long as friction, not sound, limits its step.
    #[must_use]
    pub fn automatic_sound_speed(&self) -> f64 {
        let (rho, _) = self.lightest_and_stickiest();
        let kinetic = (10.0 * self.reference_speed).powi(2);
        let thermal = self.noise.map_or(0.0, |noise| noise.energy / (rho * self.spacing.powi(D as i32)));
        let loudest = (150.0_f64).powi(2) * thermal;
        kinetic.max(loudest).sqrt().max(self.pressed_sound_speed(0.0))
    }

    /// Refuses a setup that cannot run.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] at step 0 with the first value that is impossible.
    pub fn check(&self) -> Result<(), RunError> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let scales = [
            ("cut-off (m)", self.cutoff),
            ("spacing (m)", self.spacing),
            ("reference speed (m/s)", self.reference_speed),
            ("reference length (m)", self.reference_length),
            ("sound speed (m/s)", self.sound_speed.unwrap_or(1.0)),
        ];
        for (name, value) in scales {
            if !positive(value) {
                return Err(refuse(0, name, value, "it must be a positive number"));
            }
        }
        let lengths = self.domain.lengths();
        let least = 2.0 * self.cutoff * (1.0 + self.options.skin);
        for k in 0..D {
            if !positive(lengths[k]) || (self.domain.periodic[k] && lengths[k] < least) {
                let remedy =
                    format!("a periodic box must be at least {least:.3e} m long: two cut-offs with skin");
                return Err(refuse(0, "length of the box (m)", lengths[k], &remedy));
            }
        }
        if self.bodies.len() > 255 {
            let remedy = "at most 255 bodies can be told apart";
            return Err(refuse(0, "number of bodies", self.bodies.len() as f64, remedy));
        }
        for body in &self.bodies {
            let BodyKind::Fluid { density, viscosity } = body.kind else { continue };
            if !positive(density) {
                return Err(refuse(
                    0,
                    "density (kg/m^3) of a fluid",
                    density,
                    "it must be a positive number",
                ));
            }
            if !(viscosity.is_finite() && viscosity >= 0.0) {
                return Err(refuse(
                    0,
                    "viscosity (Pa s) of a fluid",
                    viscosity,
                    "it must be a number from zero",
                ));
            }
        }
        self.check_elastic()?;
        for (i, placed) in self.particles.iter().enumerate() {
            if placed.body as usize >= self.bodies.len() {
                return Err(refuse(i, "body", f64::from(placed.body), "no such body in the setup"));
            }
            if !positive(placed.volume) || !placed.position.iter().all(|x| x.is_finite()) {
                return Err(refuse(
                    i,
                    "volume (m^D)",
                    placed.volume,
                    "place and volume must be finite numbers",
                ));
            }
        }
        Ok(())
    }

    /// The particles of an elastic body must be those of its solid.
    fn check_elastic(&self) -> Result<(), RunError> {
        for (body, number) in self.bodies.iter().zip(0_u8..) {
            let BodyKind::Solid { motion: Motion::Elastic(coupled), .. } = &body.kind else { continue };
            let mine = self.particles.iter().filter(|placed| placed.body == number);
            let count = mine.clone().count();
            let same = |(placed, place): (&Placed<D>, &Vector<D>)| {
                self.domain.separation(&placed.position, place).norm() <= 1e-6 * self.spacing
            };
            if count != coupled.solid().len() || !mine.zip(coupled.solid().places()).all(same) {
                let what = format!("number of particles of the elastic body `{}`", body.name);
                let remedy = format!(
                    "its solid has {}: they must be the same ones, in the same order, at their places at rest",
                    coupled.solid().len()
                );
                return Err(refuse(0, &what, count as f64, &remedy));
            }
        }
        Ok(())
    }
}

/// A refusal of the setup as a fault of step 0.
fn refuse(particle: usize, quantity: &str, value: f64, remedy: &str) -> RunError {
    RunError::BlowUp {
        step: 0,
        time: 0.0,
        particle,
        quantity: quantity.to_owned(),
        value,
        remedy: remedy.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Friction, weight and buoyancy each change the density by 1 % at the sound speed that is chosen for them.
    #[test]
    fn the_sound_speed_bears_friction_weight_and_buoyancy() {
        let water =
            |density| Body { name: "water".into(), kind: BodyKind::Fluid { density, viscosity: 0.1 } };
        let setup = Setup::<2> {
            domain: Domain { min: Vector::zeros(), max: Vector::<2>::new(4.0, 1.0), periodic: [true, false] },
            bodies: vec![water(2.0)],
            reference_speed: 0.5,
            reference_length: 1.0,
            ..Setup::default()
        };
        // 12 mu U X/L² = 2.4 Pa: c0² = 100 p/rho; 10 U is less.
        assert!((setup.automatic_sound_speed() - 120.0_f64.sqrt()).abs() < 1e-12);
        // Along the periodic axis nothing bears the weight.
        let (pull, lift) = (Vector::<2>::new(7.0, -1.5), Vector::<2>::new(9.0, 2.5));
        let heavy = Setup { body_force: pull, buoyancy: lift, ..setup };
        assert!((heavy.automatic_sound_speed() - 400.0_f64.sqrt()).abs() < 1e-12);
    }
}
