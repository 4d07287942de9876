//! The flow as a whole: its state, and how it is built.

use crate::error::RunError;
use crate::fluid::blocks::Block;
use crate::fluid::depth::covers;
use crate::fluid::mirror::Mirror;
use crate::fluid::noise::ThermalNoise;
use crate::fluid::open::{Open, Openings};
use crate::fluid::particles::{Material, Own, Side, Slopes};
use crate::fluid::pass::Rates;
use crate::fluid::physics::Terms;
use crate::fluid::setup::{Body, BodyKind, EquationOfState, Friction, Method, Setup, Slip, Sponge};
use crate::fluid::symmetric::Symmetric;
use crate::fluid::terms::{
    Continuity, DensityDiffusion, Moment, Pressure, Shift, TransportStress, Viscosity,
};
use crate::space::domain::{Domain, Shortest};
use crate::space::kernel::Kernel;
use crate::vector::Vector;
use serde::{Deserialize, Serialize};

/// A flow in progress.
pub struct Flow<const D: usize> {
    pub(super) domain: Domain<D>,
    pub(super) bodies: Vec<Body<D>>,
    pub(super) positions: Vec<Vector<D>>,
    pub(super) sides: Vec<Side<D>>,
    pub(super) own: Vec<Own<D>>,
    /// Empty where nobody looks at them.
    pub(super) slopes: Vec<Slopes<D>>,
    pub(super) sound_speed: f64,
    pub(super) tally: Tally,
    pub(super) kernel: Kernel<D>,
    pub(super) shortest: Shortest<D>,
    pub(super) terms: Terms<D>,
    pub(super) sponges: Vec<Sponge<D>>,
    pub(super) setup: Scales<D>,
    pub(super) blocks: Vec<Block<D>>,
    pub(super) rates: Vec<Rates<D>>,
    pub(super) mirrors: Vec<Mirror<D>>,
    pub(super) solids: Vec<u32>,
    /// By number of the particle its place among those of its body.
    pub(super) rows: Vec<u32>,
    /// The ends where particles enter and leave.
    pub(super) openings: Option<Openings<D>>,
    /// Bodies whose reaction is asked for.
    pub(super) asks: Vec<bool>,
    /// Where the particles were when the lists were built, m.
    pub(super) listed: Vec<Vector<D>>,
    /// How far fluid is at most from there at the last drift, m.
    pub(super) strayed: f64,
    /// Bound on how far solids moved since, m.
    pub(super) travel: f64,
    pub(super) time: f64,
    pub(super) steps: u64,
    /// Step the noise in the accelerations was drawn for, s.
    pub(super) noise_step: f64,
    /// The step that is or was last taken, s.
    pub(super) step_length: f64,
}

/// What the steps need of the setup.
pub(super) struct Scales<const D: usize> {
    pub spacing: f64,
    pub skin: f64,
    pub gravity: Vector<D>,
    pub reference_speed: f64,
    /// That of [`Setup::automatic_sound_speed`], m/s.
    pub expected_sound_speed: f64,
    pub courant: f64,
    pub shift: f64,
    pub surface_fraction: f64,
    pub drift_correction: u64,
    pub state: EquationOfState,
    pub shepard: Option<u64>,
    /// Of the lightest fluid, kg/m³.
    pub rest_density: f64,
    /// The largest of the fluids, Pa s.
    pub viscosity: f64,
}

/// What is counted over the steps.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Tally {
    pub penetrations: u64,
    pub bounces: u64,
    pub largest_speed: f64,
    pub largest_density_change: f64,
    pub particle_steps: u64,
    pub pair_evaluations: u64,
    pub rebuilds: u64,
}

impl<const D: usize> Flow<D> {
    /// Builds a flow at rest (or at its initial velocity) and sums its first forces.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] at step 0 where the setup cannot run: a box shorter than two cut-offs on a periodic
    /// axis, a body without description, a place, volume, density or scale that is no positive number.
    pub fn new(setup: Setup<D>) -> Result<Flow<D>, RunError> {
        Flow::with_ends(setup, None)
    }

    /// As [`Flow::new`], with an axis that is open.
    ///
    /// # Errors
    /// As [`Flow::new`].
    pub fn with_ends(mut setup: Setup<D>, open: Option<Open<D>>) -> Result<Flow<D>, RunError> {
        setup.check()?;
        if setup.pressure_scale.is_none() {
            // What is prescribed at the ends is a pressure to be expected too.
            let prescribed = open.as_ref().map_or(0.0, Open::largest_pressure);
            setup.pressure_scale = Some(setup.expected_pressure().max(prescribed));
        }
        let shift = setup.shift(open.is_some());
        let openings = open.map(|open| Openings::new(open, &setup));
        let sound_speed = setup.sound_speed.unwrap_or_else(|| setup.automatic_sound_speed());
        let h = setup.cutoff;
        let options = &setup.options;
        let courant = options.courant.unwrap_or(if shift > 5.0 { 1.0 / shift } else { 0.2 });
        let (lightest, stickiest) = setup.lightest_and_stickiest();
        let terms = terms(&setup, shift);
        let (mut positions, mut sides, mut own) = (Vec::new(), Vec::new(), Vec::new());
        for (id, (placed, cover)) in setup.particles.iter().zip(covers(&setup)).enumerate() {
            let (material, density, viscosity) = match &setup.bodies[placed.body as usize].kind {
                BodyKind::Fluid { density, viscosity } => (Material::Fluid, *density, *viscosity),
                BodyKind::Solid { slip: Slip::NoSlip, .. } => (Material::NoSlip, lightest, 0.0),
                BodyKind::Solid { slip: Slip::FreeSlip, .. } => (Material::FreeSlip, lightest, 0.0),
            };
            let fluid = material == Material::Fluid;
            positions.push(placed.position);
            sides.push(Side {
                velocity: if fluid { setup.initial_velocity } else { Vector::zeros() },
                drift: Vector::zeros(),
                density,
                volume: placed.volume,
                inverse_density: 1.0 / density,
                inverse_root: 1.0 / placed.volume.sqrt(),
                id: id as u32,
                material,
                body: placed.body,
                pressure: 0.0,
                viscosity,
                moment: Symmetric::identity(1.0),
                uneven: false,
                held: false,
                reach: 0.0,
            });
            own.push(Own {
                mass: density * placed.volume,
                rest_density: density,
                start: placed.position,
                acceleration: Vector::zeros(),
                lift: Vector::zeros(),
                bend: Vector::zeros(),
                depth: cover.depth,
                curvature: cover.curvature,
                fraction: if fluid { 0.0 } else { 1.0 },
                filling: 0.0,
            });
        }
        let n = positions.len();
        let mut counts = vec![0; setup.bodies.len()];
        let rows = setup.particles.iter().map(|placed| {
            let count = &mut counts[usize::from(placed.body)];
            *count += 1;
            *count - 1
        });
        let rows = rows.collect();
        let given_speed = setup.sound_speed;
        // Diffusion without noise of its own would cool the sound waves of a fluctuating fluid.
        let delta = if setup.method == Method::SphBvf && setup.noise.is_none() { options.delta } else { 0.0 };
        let asks = vec![false; setup.bodies.len()];
        let mut flow = Flow {
            shortest: setup.domain.shortest(),
            kernel: Kernel::new(setup.kernel, h),
            setup: Scales {
                spacing: setup.spacing,
                skin: options.skin * h,
                gravity: setup.body_force,
                reference_speed: setup.reference_speed,
                expected_sound_speed: setup.automatic_sound_speed(),
                courant,
                shift,
                surface_fraction: options.surface_fraction,
                // Where fluid leaves at a given pressure, there is no drift to take out.
                drift_correction: if openings.is_some() { 0 } else { options.drift_correction },
                state: setup.state,
                shepard: options.shepard,
                rest_density: lightest,
                viscosity: stickiest,
            },
            domain: setup.domain,
            bodies: setup.bodies,
            sponges: setup.sponges,
            positions,
            sides,
            own,
            slopes: vec![Slopes::default(); if delta > 0.0 || terms.makeup().spreads() { n } else { 0 }],
            sound_speed,
            tally: Tally::default(),
            terms,
            blocks: Vec::new(),
            rates: vec![Rates::default(); n],
            mirrors: vec![Mirror { velocity: Vector::zeros(), pressure: 0.0 }; n],
            solids: Vec::new(),
            rows,
            openings,
            asks,
            listed: Vec::new(),
            strayed: 0.0,
            travel: 0.0,
            time: 0.0,
            steps: 0,
            noise_step: 0.0,
            step_length: 0.0,
        };
        flow.weigh_bodies();
        flow.carry_solids();
        flow.sort();
        flow.rebuild();
        flow.densities();
        flow.moments();
        if given_speed.is_none() {
            flow.sound_speed = flow.stiffen();
        }
        if delta > 0.0 {
            let (c, u) = (flow.sound_speed, flow.setup.reference_speed);
            flow.terms.density_diffusion = Some(DensityDiffusion::new(delta, h, c, u));
        }
        flow.densities_at_ends();
        flow.note_fillings();
        flow.mirrors();
        flow.forces(0.0);
        flow.finish(0.0);
        flow.tally = Tally::default();
        Ok(flow)
    }

    /// Gives every fluid particle the velocity (m/s) `velocity` has at its place (m) and the pressure that goes
    /// with it ([`Flow::balance_pressure`]), and sums the forces anew.
    pub fn set_velocity(&mut self, velocity: impl Fn(&Vector<D>) -> Vector<D>) {
        for (position, side) in self.positions.iter().zip(&mut self.sides) {
            if !side.is_solid() {
                side.velocity = velocity(&self.domain.wrap(position));
            }
        }
        // What walls do here is no step.
        let tally = self.tally.clone();
        self.see();
        // The random velocities of a start in thermal motion have no pressure of their own, and open ends set it.
        if self.terms.noise.is_none() && self.openings.is_none() {
            self.balance_pressure();
            self.see();
        }
        self.forces(0.0);
        self.finish(0.0);
        self.tally = tally;
    }

    /// What particles show to their neighbours as they are now.
    fn see(&mut self) {
        self.carry_solids();
        self.densities();
        self.moments();
        self.densities_at_ends();
        self.mirrors();
    }

    /// Sets the acceleration (m/s²) of every fluid particle besides gravity, by its number in
    /// [`Setup::particles`]; it stays until set again and acts from the coming half step on.
    pub fn set_buoyancy(&mut self, of: impl Fn(usize) -> Vector<D>) {
        for (side, own) in self.sides.iter().zip(&mut self.own) {
            if side.is_solid() {
                continue;
            }
            let lift = of(side.id as usize);
            own.acceleration += lift - own.lift;
            own.lift = lift;
        }
    }

    /// Time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps taken.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// c0, m/s.
    #[must_use]
    pub fn sound_speed(&self) -> f64 {
        self.sound_speed
    }
}

/// The physics a setup asks for, but for the density diffusion, which waits for the sound speed.
fn terms<const D: usize>(setup: &Setup<D>, shift: f64) -> Terms<D> {
    let options = &setup.options;
    let moved = shift > 0.0;
    let form = if setup.method == Method::Sph { Friction::Morris } else { setup.friction };
    // At the interface of two the velocity has a kink.
    let fluids = setup.bodies.iter().filter(|body| matches!(body.kind, BodyKind::Fluid { .. }));
    let one_fluid = fluids.count() == 1;
    let continuity = match setup.method {
        _ if options.printed_density_rate => Continuity::Printed,
        _ if setup.knows_gradients() => Continuity::Corrected,
        Method::SphBvf => Continuity::Advected,
        Method::Sdpd | Method::Sph => Continuity::Summed,
    };
    Terms {
        continuity,
        density_diffusion: None,
        moment: options.corrected.then_some(Moment),
        pressure: match setup.method {
            _ if options.pressure_switch => Pressure::Switched,
            Method::SphBvf => Pressure::Weighted,
            Method::Sdpd | Method::Sph => Pressure::Squares,
        },
        viscosity: Viscosity { form },
        fourth_order: continuity == Continuity::Corrected && form == Friction::Morris && one_fluid,
        transport_stress: moved.then_some(TransportStress),
        bounds_drift: setup.bounds_drift(),
        shift: moved.then_some(Shift::new(shift, setup.cutoff, setup.reference_speed)),
        noise: setup.noise.as_ref().map(ThermalNoise::new),
    }
}
