//! Particles of a model: places, bodies of the flow, zones, barriers, sponges.

use super::bodies::motion;
use super::solids::{self, SolidPlan};
use super::vessels;
use crate::error::Fault;
use crate::fluid::{
    Barrier, Body, BodyKind, Domain, Kernel, KernelKind, Motion, Noise, Placed, Setup, Slip, Sponge, Weights,
};
use crate::geometry::shape::embed;
use crate::geometry::{Fill, Shape, fill};
use crate::model::conditions::{WallMotion, WallName, What};
use crate::model::fluid::Velocity;
use crate::model::groups::Group;
use crate::model::names::{axis_name, side_name};
use crate::model::{Amount, Boundary, Deal, FluidModel, Material, Model, ParticleDomain, SolidModel};
use crate::quantity::readable::length;
use crate::random::{Purpose, stream};
use crate::vector::Vector;
use std::sync::Arc;

/// All particles of a model at the start, and what acts on them. Voxels are particles, same index.
pub struct ParticlePlan<const D: usize> {
    pub domain: Domain<D>,
    pub kernel: KernelKind,
    /// Weights of the diffusion operator.
    pub weights: Weights,
    /// Kernel cut-off h, m.
    pub cutoff: f64,
    /// Volume (m³) of a particle over its volume in D dimensions (m^D).
    pub thickness: f64,
    pub particles: Vec<Placed<D>>,
    /// Home group of each particle; walls round the box have the number after the last group.
    pub home: Vec<u8>,
    /// Whether the particles of each group are wall, walls round the box last.
    walls: Vec<bool>,
    /// Groups that stay where they are and have a shape of their own.
    pub still: Vec<(u8, Shape)>,
    /// The other groups that own particles: those that flow or move, and what is left.
    pub loose: Vec<u8>,
    /// Zones: group number and region.
    pub zones: Vec<(u8, Shape)>,
    pub barriers: Vec<Barrier>,
    pub sponges: Vec<SpongePlan>,
    pub held: Vec<HeldPlan>,
    /// Surfaces through which molecules enter or leave.
    pub surfaces: Vec<WallName>,
    /// What the flow is built from, if there is one.
    pub flow: Option<Setup<D>>,
    /// Open ends, if there are any.
    pub openings: Option<super::OpeningsPlan<D>>,
    /// Of the fluid at the start.
    pub velocity: Velocity,
    /// Species that make the fluid lighter or heavier.
    pub lifts: Vec<super::Lift<D>>,
    /// Elastic solids, in the order of the model.
    pub solids: Vec<SolidPlan<D>>,
    /// How long the flow runs before t = 0, s.
    pub settle: f64,
    /// Smallest spacing, m.
    finest: f64,
}

/// A sponge as the chemistry sees it.
pub struct SpongePlan {
    pub group: u8,
    /// 1/s.
    pub rate: f64,
    pub species: Vec<(usize, Amount)>,
}

/// Held amounts.
pub struct HeldPlan {
    pub group: u8,
    pub species: Vec<(usize, Amount)>,
    pub deal: Deal,
}

/// k, J/K (exact, SI).
pub const BOLTZMANN: f64 = 1.380_649e-23;

pub(super) fn narrow<const D: usize>(x: &Vector<3>) -> Vector<D> {
    Vector::from_fn(|k, _| x[k])
}

impl<const D: usize> ParticlePlan<D> {
    /// Lays out the particles; faults for empty and overlapping groups.
    pub fn new(model: &Model, domain: &ParticleDomain, faults: &mut Vec<Fault>) -> ParticlePlan<D> {
        let (min, max) = (narrow::<D>(&domain.min), narrow::<D>(&domain.max));
        let cutoff = domain.support * domain.spacing;
        let mut particles = Vec::new();
        let mut home = Vec::new();
        let mut bodies: Vec<Body<D>> = Vec::new();
        if let Some(fluid) = &domain.fluid {
            let kind = BodyKind::Fluid { density: fluid.density, viscosity: fluid.viscosity };
            bodies.push(Body { name: "fluid".into(), kind });
        }
        let space = Domain {
            min,
            max,
            periodic: std::array::from_fn(|k| domain.boundaries[k] == Boundary::Periodic),
        };
        let mut elastic: Vec<Option<SolidPlan<D>>> = vec![None; domain.solids.len()];
        let mut random = stream(model.run.seed, 0, Purpose::Placement);
        let solid: Vec<&Group> = domain.groups.iter().filter(|g| g.material.is_filled()).collect();
        for (g, group) in domain.groups.iter().enumerate() {
            if !group.material.is_filled() {
                continue;
            }
            let others =
                solid.iter().filter(|other| other.name != group.name && other.shape != Shape::EverythingElse);
            let without = match group.shape {
                Shape::EverythingElse => others.map(|other| &other.shape).collect(),
                _ => Vec::new(),
            };
            let region = Fill {
                shape: &group.shape,
                without,
                lattice: group.lattice,
                spacing: group.spacing,
                jitter: group.jitter,
            };
            let body = match group.material {
                Material::Wall { free_slip } if domain.fluid.is_some() => {
                    bodies.push(wall_body(domain, g, group, free_slip));
                    bodies.len() - 1
                }
                // How it moves is known when it is built.
                Material::Solid if domain.fluid.is_some() => {
                    bodies.push(wall_body(domain, g, group, false));
                    bodies.len() - 1
                }
                _ => 0,
            };
            // Points on a surface that two groups share go to the one that comes first.
            let earlier: Vec<&Shape> =
                solid.iter().take_while(|other| other.name != group.name).map(|other| &other.shape).collect();
            let described = domain.solids.iter().position(|solid| solid.group == g);
            let mut found = match described {
                Some(k) => solids::places(domain, &domain.solids[k], (&min, &max), &mut random),
                None => fill::<D>(&region, &min, &max, &mut random),
            };
            found.retain(|(x, _)| {
                let on = |shape: &&Shape| shape.signed_distance(&embed(x)).abs() <= 1e-9 * group.spacing;
                !earlier.iter().any(on) && !too_near(domain, group, &embed(x))
            });
            if found.is_empty() {
                faults.push(Fault::at(
                    &group.place,
                    format!("group `{}` has no particles", group.name),
                    format!("its shape must hold points of a lattice of spacing {}; make the shape larger or the spacing finer", length(group.spacing)),
                ));
            }
            check_overlap(group, &found, &solid, faults);
            if let Some(k) = described.filter(|_| !found.is_empty()) {
                let at = (&space, particles.len(), body);
                elastic[k] = Some(solids::solid(domain, &domain.solids[k], at, &found, faults));
            }
            let volume = found.first().map_or(0.0, |one| one.1);
            let parts: Vec<(usize, &Group)> =
                domain.groups.iter().enumerate().filter(|(_, part)| part.of == Some(g)).collect();
            let mut shared = None;
            for (position, volume) in found {
                particles.push(Placed { position, volume, body: body as u8 });
                let mut holds = parts.iter().filter(|(_, part)| part.shape.holds(&embed(&position)));
                let part = holds.next();
                home.push(part.map_or(g, |(part, _)| *part) as u8);
                if let (Some((_, one)), Some((_, other))) = (part, holds.next()) {
                    shared.get_or_insert((*one, *other, position));
                }
            }
            check_parts(group, &parts, shared, &home, faults);
            let vessel = described.and_then(|k| {
                let growth = domain.solids[k].growth.as_ref();
                elastic[k].as_ref()?.vessel.as_ref().map(|vessel| (vessel, growth))
            });
            if let Some((vessel, growth)) = vessel {
                // Beyond the box, where no voxel is.
                let nowhere = min - (max - min);
                let waiting = vessels::reserve(vessel, growth, (nowhere, volume));
                home.extend(waiting.iter().map(|_| domain.groups.len() as u8));
                particles.extend(waiting);
            }
        }
        let mut plan = ParticlePlan {
            domain: space,
            kernel: domain.kernel,
            weights: domain.weights,
            cutoff,
            thickness: domain.thickness.powi(3 - D as i32),
            particles,
            home,
            walls: domain
                .groups
                .iter()
                .map(|group| matches!(group.material, Material::Wall { .. }))
                .chain([true])
                .collect(),
            still: domain
                .groups
                .iter()
                .enumerate()
                .filter(|(g, group)| stays(domain, *g, group))
                .map(|(g, group)| (g as u8, group.shape.clone()))
                .collect(),
            loose: domain
                .groups
                .iter()
                .enumerate()
                .filter(|(g, group)| group.material != Material::Zone && !stays(domain, *g, group))
                .map(|(g, _)| g as u8)
                .collect(),
            zones: domain
                .groups
                .iter()
                .enumerate()
                .filter(|(_, group)| group.material == Material::Zone)
                .map(|(g, group)| (g as u8, group.shape.clone()))
                .collect(),
            barriers: Vec::new(),
            sponges: Vec::new(),
            held: Vec::new(),
            surfaces: super::surfaces::surfaces(domain),
            flow: None,
            openings: None,
            velocity: domain.fluid.as_ref().map_or_else(Velocity::default, |fluid| fluid.velocity.clone()),
            lifts: super::lift::lifts(domain),
            solids: elastic.into_iter().flatten().collect(),
            settle: domain.fluid.as_ref().map_or(0.0, |fluid| fluid.settle),
            finest: domain.groups.iter().map(|group| group.spacing).fold(domain.spacing, f64::min),
        };
        super::bodies::check(domain, &plan, faults);
        plan.check_zones(domain, faults);
        plan.read_conditions(domain);
        if let Some(fluid) = &domain.fluid {
            if !plan.particles.iter().any(|placed| placed.body == 0) && faults.is_empty() {
                faults.push(Fault::at(
                    &model.places.fluid,
                    "no particle is fluid: all groups are walls or solids",
                    "add a group that flows, e.g. water: { material: fluid, shape: everything_else }",
                ));
            }
            plan.add_side_walls(domain, &mut bodies);
            let openings = super::openings::add(&mut plan, domain, &mut bodies);
            let mut setup = plan.setup(model, domain, fluid, bodies);
            plan.openings = openings.map(|openings| openings.with_reserve(&mut plan, &mut setup));
            plan.flow = Some(setup);
        }
        plan.check_extent(model, faults);
        plan
    }

    /// The kernel of this plan.
    #[must_use]
    pub fn kernel(&self) -> Kernel<D> {
        Kernel::new(self.kernel, self.cutoff)
    }

    /// Whether the particles of a home group are wall.
    #[must_use]
    pub fn is_wall(&self, home: u8) -> bool {
        self.walls[usize::from(home)]
    }

    /// Whether the particles of a home group are fluid that flows.
    #[must_use]
    pub fn flows(&self, home: u8) -> bool {
        self.flow.is_some() && !self.is_wall(home) && !self.solids.iter().any(|solid| solid.owns(home))
    }

    /// A particle is in one zone at a time.
    fn check_zones(&self, domain: &ParticleDomain, faults: &mut Vec<Fault>) {
        for (k, (a, shape)) in self.zones.iter().enumerate() {
            for (b, other) in &self.zones[..k] {
                let both = |x: &Vector<3>| shape.holds(x) && other.holds(x);
                if self.particles.iter().any(|p| both(&embed(&p.position))) {
                    let (a, b) = (&domain.groups[usize::from(*a)], &domain.groups[usize::from(*b)]);
                    faults.push(Fault::at(
                        &a.place,
                        format!("the zones `{}` and `{}` overlap", a.name, b.name),
                        "cut one out of the other, e.g. shape: { difference: [..., ...] }",
                    ));
                }
            }
        }
    }

    fn read_conditions(&mut self, domain: &ParticleDomain) {
        for condition in &domain.conditions {
            match &condition.what {
                What::Barrier { axis, at } => self.barriers.push(Barrier { axis: *axis, at: *at }),
                What::Sponge { group, rate, species, .. } if !species.is_empty() => {
                    self.sponges.push(SpongePlan {
                        group: *group as u8,
                        rate: *rate,
                        species: species.clone(),
                    });
                }
                What::Held { group, species, deal } => {
                    self.held.push(HeldPlan { group: *group as u8, species: species.clone(), deal: *deal });
                }
                _ => {}
            }
        }
    }

    /// Layers of wall particles, as thick as the cut-off, behind every side that is not periodic.
    fn add_side_walls(&mut self, domain: &ParticleDomain, bodies: &mut Vec<Body<D>>) {
        let spacing = domain.spacing;
        let layers = (self.cutoff / spacing - 1e-9).ceil() as i64;
        let cells: [i64; D] =
            std::array::from_fn(|k| ((self.domain.max[k] - self.domain.min[k]) / spacing).round() as i64);
        let margin: [i64; D] = std::array::from_fn(|k| if self.domain.periodic[k] { 0 } else { layers });
        let boundary = domain.groups.len() as u8;
        let mut body_of_side = [[None; 2]; 3];
        let open: [bool; D] = std::array::from_fn(|k| domain.boundaries[k] == Boundary::Open);
        // Walls go on beside the buffers of open ends, and behind them.
        let margin: [i64; D] = std::array::from_fn(|k| match open[k] {
            true => 2 * layers + 1,
            false => margin[k],
        });
        for axis in (0..D).filter(|&axis| !self.domain.periodic[axis] && !open[axis]) {
            for upper in [false, true] {
                let surface_at = if upper { self.domain.max[axis] } else { self.domain.min[axis] };
                let sign = if upper { -1.0 } else { 1.0 };
                let slip = match domain.boundaries[axis] {
                    Boundary::FreeSlip => Slip::FreeSlip,
                    _ => Slip::NoSlip,
                };
                bodies.push(Body {
                    name: side_name(axis, upper),
                    kind: BodyKind::Solid {
                        slip,
                        motion: motion(domain, WallName::Side { axis, upper }),
                        surface: Some(Arc::new(move |x: &Vector<D>| sign * (x[axis] - surface_at))),
                    },
                });
                body_of_side[axis][usize::from(upper)] = Some(bodies.len() - 1);
            }
        }
        let mut cell: [i64; D] = std::array::from_fn(|k| -margin[k]);
        loop {
            let body_of = |k: usize| body_of_side[k][usize::from(cell[k] >= 0)];
            let moves = |body: usize| match &bodies[body].kind {
                BodyKind::Solid { motion, .. } => *motion != Motion::Still,
                BodyKind::Fluid { .. } => false,
            };
            let sides =
                || (0..D).filter(|&k| !open[k] && (cell[k] < 0 || cell[k] >= cells[k])).filter_map(body_of);
            // The corners go with a side that moves: a lid that ended where the fluid ends would seem to the fluid at
            // its ends to draw matter in and push it out (the cavity's core turned 10 % too fast).
            let position = Vector::from_fn(|k, _| self.domain.min[k] + (cell[k] as f64 + 0.5) * spacing);
            // An elastic solid may be held by what of it reaches into the wall.
            let taken = domain.solids.iter().any(|s| domain.groups[s.group].shape.holds(&embed(&position)));
            if let Some(body) =
                sides().find(|&body| moves(body)).or_else(|| sides().next()).filter(|_| !taken)
            {
                self.particles.push(Placed { position, volume: spacing.powi(D as i32), body: body as u8 });
                self.home.push(boundary);
            }
            let mut axis = 0;
            loop {
                cell[axis] += 1;
                if cell[axis] < cells[axis] + margin[axis] {
                    break;
                }
                cell[axis] = -margin[axis];
                axis += 1;
                if axis == D {
                    return;
                }
            }
        }
    }

    fn setup(
        &self,
        model: &Model,
        domain: &ParticleDomain,
        fluid: &FluidModel,
        bodies: Vec<Body<D>>,
    ) -> Setup<D> {
        let mut body_force = Vector::<D>::zeros();
        let mut sponges = Vec::new();
        for condition in &domain.conditions {
            match &condition.what {
                What::Force { acceleration } => body_force += narrow::<D>(acceleration),
                What::Sponge { group, rate, velocity: Some(velocity), .. } => {
                    let shape = domain.groups[*group].shape.clone();
                    let target = narrow::<D>(velocity);
                    sponges.push(Sponge {
                        region: Arc::new(move |x: &Vector<D>| shape.holds(&embed(x))),
                        rate: *rate,
                        velocity: Arc::new(move |_: &Vector<D>| target),
                    });
                }
                _ => {}
            }
        }
        Setup {
            domain: self.domain.clone(),
            kernel: self.kernel,
            cutoff: self.cutoff,
            spacing: domain.spacing,
            particles: self.particles.clone(),
            bodies,
            reference_speed: fluid.speed,
            reference_length: super::flow::reference_length(domain, fluid).0,
            sound_speed: fluid.sound_speed,
            pressure_scale: fluid.pressure_scale,
            body_force,
            buoyancy: super::lift::strongest(model, domain, &self.particles),
            sponges,
            initial_velocity: fluid.velocity.uniform().map_or_else(Vector::zeros, |v| narrow::<D>(&v)),
            method: fluid.method,
            friction: fluid.friction,
            state: fluid.state,
            // A volume of the flow stands for one of this depth, so that kT is shared out over it.
            noise: fluid.temperature.map(|temperature| Noise {
                energy: BOLTZMANN * temperature / self.thickness,
                seed: model.run.seed,
                realization: 0,
            }),
            options: fluid.options.clone(),
        }
    }

    /// A particle must not see another twice round a periodic axis, nor its image's image between two sides.
    fn check_extent(&self, model: &Model, faults: &mut Vec<Fault>) {
        for k in 0..D {
            let extent = self.domain.max[k] - self.domain.min[k];
            let (needed, what) = match (self.domain.periodic[k], self.flow.is_some()) {
                (true, true) => (3.0, "periodic"),
                (true, false) => (2.0, "periodic"),
                (false, _) => (1.0, "closed"),
            };
            // Along a single layer of particles nothing moves.
            let single = !self.domain.periodic[k] && extent < 1.5 * self.finest;
            if extent < needed * self.cutoff * (1.0 - 1e-9) && !single {
                faults.push(Fault::at(
                    &model.places.domain,
                    format!(
                        "the box is {} along the {what} axis {}; {needed} {} needed",
                        length(extent),
                        axis_name(k),
                        if needed == 1.0 {
                            format!("cut-off of {} is", length(self.cutoff))
                        } else {
                            format!("cut-offs of {} are", length(self.cutoff))
                        }
                    ),
                    "make the box longer, or the spacing or support smaller",
                ));
            }
        }
    }
}

/// Whether a place is nearer to the surface of an elastic solid than half a spacing of a group of fluid: a lattice that
/// goes with the solid ends there, as it does at walls.
fn too_near(domain: &ParticleDomain, group: &Group, x: &Vector<3>) -> bool {
    let near = |solid: &SolidModel| {
        domain.groups[solid.group].shape.signed_distance(x) < (0.5 - 1e-6) * group.spacing
    };
    group.material == Material::Fluid && domain.solids.iter().any(near)
}

/// Whether a group has a shape of its own and stays in it.
fn stays(domain: &ParticleDomain, g: usize, group: &Group) -> bool {
    let solid = match group.material {
        Material::Zone | Material::Solid | Material::Surface => false,
        Material::Fluid => domain.fluid.is_none(),
        Material::Wall { .. } => !domain.conditions.iter().any(|condition| {
            matches!(&condition.what, What::MovingWall { wall: WallName::Group(moved), motion }
                if *moved == g && !matches!(motion, WallMotion::Belt(_)))
                || matches!(&condition.what, What::FreeBody { group, .. } if *group == g)
        }),
    };
    solid && group.shape != Shape::EverythingElse
}

fn wall_body<const D: usize>(domain: &ParticleDomain, g: usize, group: &Group, free_slip: bool) -> Body<D> {
    let shape = group.shape.clone();
    let surface: crate::fluid::setup::Surface<D> = match group.shape {
        // What no other group claims begins where they end.
        Shape::EverythingElse => {
            let others = domain.groups.iter().filter(|o| o.material.is_filled() && o.name != group.name);
            let shapes: Vec<Shape> = others.map(|other| other.shape.clone()).collect();
            Arc::new(move |x: &Vector<D>| {
                let place = embed(x);
                -shapes.iter().map(|shape| shape.signed_distance(&place)).fold(f64::INFINITY, f64::min)
            })
        }
        _ => Arc::new(move |x: &Vector<D>| shape.signed_distance(&embed(x))),
    };
    Body {
        name: group.name.clone(),
        kind: BodyKind::Solid {
            slip: if free_slip { Slip::FreeSlip } else { Slip::NoSlip },
            motion: motion(domain, WallName::Group(g)),
            surface: Some(surface),
        },
    }
}

/// Two surfaces of a solid that hold the same particle, and where that is.
type Shared<'a, const D: usize> = (&'a Group, &'a Group, Vector<D>);

/// Surfaces of a solid need particles of it, each its own; `shared` is one that two of them hold.
fn check_parts<const D: usize>(
    solid: &Group,
    parts: &[(usize, &Group)],
    shared: Option<Shared<D>>,
    home: &[u8],
    faults: &mut Vec<Fault>,
) {
    if let Some((one, other, at)) = shared {
        faults.push(Fault::at(
            &other.place,
            format!(
                "the surfaces `{}` and `{}` of the solid `{}` both hold its particle at {}",
                one.name,
                other.name,
                solid.name,
                crate::quantity::readable::show_vector(at.as_slice(), "m")
            ),
            "let their shapes not overlap",
        ));
    }
    for (g, part) in parts {
        if !home.contains(&(*g as u8)) {
            faults.push(Fault::at(
                &part.place,
                format!(
                    "no particle of the solid `{}` lies in its surface `{}` at rest",
                    solid.name, part.name
                ),
                format!(
                    "make the shape deeper: particles lie {} and more below the surface of the solid",
                    length(0.5 * solid.spacing)
                ),
            ));
        }
    }
}

/// No particle of one group may lie inside the shape of another.
fn check_overlap<const D: usize>(
    group: &Group,
    found: &[(Vector<D>, f64)],
    solid: &[&Group],
    faults: &mut Vec<Fault>,
) {
    if group.shape == Shape::EverythingElse {
        return;
    }
    for other in solid {
        if other.name == group.name || other.shape == Shape::EverythingElse {
            continue;
        }
        let inside = found
            .iter()
            .filter(|(x, _)| other.shape.signed_distance(&embed(x)) < -1e-9 * group.spacing)
            .count();
        let known = format!("`{}` and `{}` overlap", other.name, group.name);
        if inside > 0 && !faults.iter().any(|fault| fault.reason.contains(&known)) {
            let walls =
                matches!((group.material, other.material), (Material::Wall { .. }, Material::Wall { .. }));
            faults.push(Fault::at(
                &group.place,
                format!(
                    "{} `{}` and `{}` overlap: {inside} particles of `{}` lie inside `{}`",
                    if walls { "the walls" } else { "the groups" },
                    group.name,
                    other.name,
                    group.name,
                    other.name
                ),
                format!(
                    "cut one out of the other, e.g. shape: {{ difference: [..., ...] }} for `{}`",
                    group.name
                ),
            ));
        }
    }
}
