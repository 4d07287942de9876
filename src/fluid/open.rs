//! Open ends: particles enter and leave.
//!
//! Beyond each end of the open axis lies a buffer a little deeper than the cut-off. Its particles count as fluid for
//! their neighbours, but their state is prescribed (Federico et al. 2012; Tafuni et al. 2018):
//!
//! | end | velocity | pressure |
//! |---|---|---|
//! | velocity given | as given at the place | mean of the fluid before it, Σ p V W/Σ V W |
//! | pressure given | that at which it left, accelerated along the axis as the fluid before it; if drawn in, the mean of the fluid before it | as given |
//!
//! A buffer particle that comes into the box is fluid from then on, and another one enters the buffer a depth behind
//! it; fluid that leaves the box joins the buffer, and what leaves the buffer is put into the reserve. The reserve are
//! particles of a solid out of reach of all others, so that numbers and tables stay as long as they are.

use std::sync::Arc;

use crate::error::RunError;
use crate::fluid::flow::Flow;
use crate::fluid::particles::Material;
use crate::fluid::setup::{BodyKind, Setup};
use crate::vector::Vector;
use serde::{Deserialize, Serialize};

/// A velocity (m/s) by place (m) and time (s).
pub type Stream<const D: usize> = Arc<dyn Fn(&Vector<D>, f64) -> Vector<D> + Send + Sync>;

/// What is prescribed at an end.
#[derive(Clone)]
pub enum End<const D: usize> {
    Velocity(Stream<D>),
    /// Pa.
    Pressure(f64),
}

/// The open axis of a flow. The setup's particles beyond its ends, as deep as `depth`, are the buffers.
#[derive(Clone)]
pub struct Open<const D: usize> {
    pub axis: usize,
    /// What holds at the lower and at the upper end.
    pub ends: [End<D>; 2],
    /// Depth of the buffers, m: at least a cut-off, and a whole number of spacings.
    pub depth: f64,
    /// The fluid that enters.
    pub fluid: u8,
    /// The solid that the particles in reserve belong to.
    pub reserve: u8,
}

impl<const D: usize> Open<D> {
    /// Coordinate along the axis of the particles in reserve, m: out of reach of the buffers.
    #[must_use]
    pub fn parking(&self, setup: &Setup<D>) -> f64 {
        setup.domain.max[self.axis] + self.depth + 2.0 * (1.0 + setup.options.skin) * setup.cutoff
    }

    /// The largest pressure, positive or negative, that is prescribed at an end, Pa; none if none is.
    #[must_use]
    pub fn largest_pressure(&self) -> f64 {
        self.ends.iter().fold(0.0, |most: f64, end| match end {
            End::Pressure(pressure) => most.max(pressure.abs()),
            End::Velocity(_) => most,
        })
    }
}

/// Where a particle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Zone {
    Inside,
    /// Before the lower (0) or upper (1) end.
    Buffer(u8),
    Reserve,
}

/// A particle as the openings know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Presence {
    pub inside: bool,
    /// How often it came in.
    pub entries: u32,
    /// The end it came in by last: 0 the lower, 1 the upper.
    pub by: u8,
}

/// The openings of a flow in progress.
pub(super) struct Openings<const D: usize> {
    pub open: Open<D>,
    parking: f64,
    /// Mass of a particle that enters, per unit thickness, and rest density and viscosity.
    fluid: (f64, f64, f64),
    /// By number of the particle.
    pub(super) zones: Vec<Zone>,
    pub(super) entries: Vec<(u32, u8)>,
    /// Present indices of the particles in the buffers with their end, and of fluid near an end of given velocity.
    pub(super) buffer: Vec<(u32, u8)>,
    pub(super) rim: Vec<u32>,
    /// By present index: whether it is in a buffer.
    pub(super) marked: Vec<bool>,
    /// By block: whether it has particles in a buffer.
    pub(super) touched: Vec<bool>,
}

impl<const D: usize> Openings<D> {
    pub fn new(open: Open<D>, setup: &Setup<D>) -> Openings<D> {
        let (axis, domain) = (open.axis, &setup.domain);
        let zones = setup.particles.iter().map(|placed| match &setup.bodies[usize::from(placed.body)].kind {
            BodyKind::Solid { .. } if placed.body == open.reserve => Zone::Reserve,
            BodyKind::Fluid { .. } if placed.position[axis] < domain.min[axis] => Zone::Buffer(0),
            BodyKind::Fluid { .. } if placed.position[axis] > domain.max[axis] => Zone::Buffer(1),
            _ => Zone::Inside,
        });
        let (density, viscosity) = match setup.bodies.get(usize::from(open.fluid)).map(|body| &body.kind) {
            Some(BodyKind::Fluid { density, viscosity }) => (*density, *viscosity),
            _ => (1.0, 0.0),
        };
        Openings {
            parking: open.parking(setup),
            fluid: (density * setup.spacing.powi(D as i32), density, viscosity),
            zones: zones.collect(),
            entries: vec![(0, 0); setup.particles.len()],
            buffer: Vec::new(),
            rim: Vec::new(),
            marked: Vec::new(),
            touched: Vec::new(),
            open,
        }
    }
}

impl<const D: usize> Flow<D> {
    /// Of an open flow, by number of the particle, which are in the box and how often they came in.
    #[must_use]
    pub fn presence(&self) -> Option<Vec<Presence>> {
        let openings = self.openings.as_ref()?;
        let all = openings.zones.iter().zip(&openings.entries);
        Some(
            all.map(|(zone, &(entries, by))| Presence { inside: *zone == Zone::Inside, entries, by })
                .collect(),
        )
    }

    /// Axes that end in walls.
    pub(super) fn closed_axes(&self) -> [bool; D] {
        let open = self.openings.as_ref().map(|openings| openings.open.axis);
        std::array::from_fn(|k| !self.domain.periodic[k] && open != Some(k))
    }

    /// How far beyond an end a place lies, m.
    pub(super) fn beyond(&self, axis: usize, end: u8, place: &Vector<D>) -> f64 {
        if end == 0 { self.domain.min[axis] - place[axis] } else { place[axis] - self.domain.max[axis] }
    }

    /// Takes particles over the ends: from buffers into the box and out of it, out of buffers into the reserve and
    /// back. The lists must be built anew.
    ///
    /// # Errors
    /// [`RunError::BlowUp`] when more particles enter than leave until the reserve is used up.
    pub(super) fn pass_ends(&mut self) -> Result<(), RunError> {
        let Some(mut openings) = self.openings.take() else { return Ok(()) };
        let Open { axis, depth, reserve, .. } = openings.open;
        let mut entering: Vec<(usize, u8)> = Vec::new();
        let mut parked: Vec<usize> = Vec::new();
        for i in 0..self.sides.len() {
            let id = self.sides[i].id as usize;
            if self.sides[i].body == reserve {
                parked.push(i);
                continue;
            }
            if self.sides[i].is_solid() {
                continue;
            }
            match openings.zones[id] {
                Zone::Inside => {
                    let left = (0..2).find(|&end| self.beyond(axis, end, &self.positions[i]) > 0.0);
                    if let Some(end) = left {
                        openings.zones[id] = Zone::Buffer(end);
                        if let End::Pressure(_) = openings.open.ends[usize::from(end)] {
                            // It leaves straight on; nothing would hold it off a wall of the buffer.
                            let along = self.sides[i].velocity[axis];
                            self.sides[i].velocity =
                                Vector::from_fn(|k, _| if k == axis { along } else { 0.0 });
                        }
                        self.own[i].acceleration = Vector::zeros();
                        self.sides[i].drift = Vector::zeros();
                    }
                }
                Zone::Buffer(end) => {
                    let out = self.beyond(axis, end, &self.positions[i]);
                    if out <= 0.0 {
                        openings.zones[id] = Zone::Inside;
                        openings.entries[id] = (openings.entries[id].0 + 1, end);
                        entering.push((i, end));
                    } else if out > depth {
                        openings.zones[id] = Zone::Reserve;
                        let (position, side, own) =
                            (&mut self.positions[i], &mut self.sides[i], &mut self.own[i]);
                        position[axis] = openings.parking;
                        own.start = *position;
                        (side.material, side.body) = (Material::NoSlip, reserve);
                        (side.velocity, side.drift) = (Vector::zeros(), Vector::zeros());
                        (side.pressure, side.density) = (0.0, own.rest_density);
                        (own.acceleration, own.fraction) = (Vector::zeros(), 1.0);
                        parked.push(i);
                    }
                }
                Zone::Reserve => {}
            }
        }
        let mut fault = None;
        parked.reverse();
        for (front, end) in entering {
            let Some(i) = parked.pop() else {
                let mut error = self.blow_up(front, "particles kept in reserve for the open ends", 0.0);
                if let RunError::BlowUp { remedy, .. } = &mut error {
                    *remedy = "more fluid enters than leaves; make the velocities of the ends agree, or give one end a pressure".to_owned();
                }
                fault = Some(error);
                break;
            };
            let mut place = self.positions[front];
            place[axis] += if end == 0 { -depth } else { depth };
            let (mass, density, viscosity) = openings.fluid;
            let velocity = self.sides[front].velocity;
            let (side, own) = (&mut self.sides[i], &mut self.own[i]);
            (side.material, side.body) = (Material::Fluid, openings.open.fluid);
            (side.velocity, side.drift) = (velocity, Vector::zeros());
            (side.density, side.volume, side.pressure) = (density, mass / density, 0.0);
            (side.viscosity, own.mass, own.rest_density) = (viscosity, mass, density);
            (own.start, own.acceleration, own.lift) = (place, Vector::zeros(), Vector::zeros());
            (own.bend, own.fraction, side.uneven) = (Vector::zeros(), 0.0, false);
            side.held = false;
            self.positions[i] = place;
            openings.zones[side.id as usize] = Zone::Buffer(end);
        }
        self.openings = Some(openings);
        self.solids = (0..self.sides.len() as u32).filter(|&i| self.sides[i as usize].is_solid()).collect();
        fault.map_or(Ok(()), Err)
    }
}
