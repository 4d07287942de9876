//! Probes: fields read off along lines, sums over the sectors of a ring, and what passes a surface.

use crate::chemistry::network::{Surface, SurfaceKind};
use crate::chemistry::{AVOGADRO, Rate};
use crate::fluid::Interpolator;
use crate::fluid::interpolate::Carriers;
use crate::geometry::shape::embed;
use crate::model::{Domain, Probe, ProbeShape};
use crate::plan::Plan;
use crate::plan::chemistry::receptor_pairs;
use crate::plan::surfaces::surfaces;
use crate::samples::ProbeRows;
use crate::scene::Scene;
use crate::vector::Vector;

/// A probe on one geometry.
pub struct ProbeLens<'p, const D: usize> {
    plan: &'p Plan,
    probe: &'p Probe,
    /// Distance along the line (m) or angle (rad) of each point.
    s: Vec<f64>,
    place: Vec<[f64; 3]>,
    reading: Reading<D>,
    /// Velocity components at the points, if they are read.
    velocity: Vec<(String, Vec<f64>)>,
}

enum Reading<const D: usize> {
    /// For each species probed, weights of 1/(N_A V) at each point.
    Line {
        species: Vec<Interpolator<D>>,
        per_amount: Vec<f64>,
    },
    /// For each sector, particles and their share in it, and the volume of all shares (m³).
    Ring {
        sectors: Vec<(Vec<(u32, f64)>, f64)>,
    },
    Surface {
        passing: Vec<Passing>,
    },
}

/// A species that passes a surface.
struct Passing {
    species: usize,
    at: Vec<Gate>,
}

/// A voxel before a surface.
struct Gate {
    voxel: u32,
    /// Molecules that enter, 1/s.
    enters: f64,
    /// Share of the molecules that leaves, 1/s.
    leaves: f64,
}

impl<'p, const D: usize> ProbeLens<'p, D> {
    /// Works out the weights of a probe.
    #[must_use]
    pub fn new(plan: &'p Plan, probe: &'p Probe, scene: &Scene<D>) -> ProbeLens<'p, D> {
        match &probe.shape {
            ProbeShape::Line { from, to, points } => line(plan, probe, scene, from, to, *points),
            ProbeShape::Ring { centre, inner, outer, sectors, group } => {
                let (s, place, sectors) = ring(scene, centre, (*inner, *outer), *sectors, *group);
                ProbeLens { plan, probe, s, place, reading: Reading::Ring { sectors }, velocity: Vec::new() }
            }
            ProbeShape::Surface { .. } => ProbeLens {
                plan,
                probe,
                s: vec![0.0],
                place: vec![[0.0; 3]],
                reading: Reading::Surface { passing: passing(plan, probe, scene) },
                velocity: Vec::new(),
            },
        }
    }

    /// Reads a realization.
    pub fn look(&self, amounts: &[f64], time: f64, realization: u32, flow: bool, rows: &mut Vec<ProbeRows>) {
        let species = self.plan.reactor.species.len();
        let mut push = |quantity: &str, values: Vec<f64>| {
            let kept: Vec<usize> = (0..values.len()).filter(|&k| values[k].is_finite()).collect();
            if kept.is_empty() {
                return;
            }
            rows.push(ProbeRows {
                probe: self.probe.name.clone(),
                realization,
                time,
                quantity: quantity.to_string(),
                s: kept.iter().map(|&k| self.s[k]).collect(),
                position: kept.iter().map(|&k| self.place[k]).collect(),
                value: kept.iter().map(|&k| values[k]).collect(),
            });
        };
        match &self.reading {
            Reading::Line { species: weights, per_amount } => {
                for (&s, weights) in self.probe.species.iter().zip(weights) {
                    let values = (0..weights.points())
                        .map(|k| weights.apply(k, |j| amounts[j * species + s] * per_amount[j]))
                        .collect();
                    push(&self.plan.reactor.species[s], values);
                }
            }
            Reading::Surface { .. } => {}
            Reading::Ring { sectors } => {
                let sum = |s: usize| -> Vec<f64> {
                    sectors
                        .iter()
                        .map(|(members, _)| {
                            members.iter().map(|&(j, share)| share * amounts[j as usize * species + s]).sum()
                        })
                        .collect()
                };
                for &s in &self.probe.species {
                    let values = sum(s).iter().zip(sectors).map(|(n, (_, v))| n / (AVOGADRO * v)).collect();
                    push(&self.plan.reactor.species[s], values);
                }
                for (free, bound) in receptor_pairs(&self.plan.network, &self.plan.analysis) {
                    if self.probe.species.contains(&free) && self.probe.species.contains(&bound) {
                        let (free, held) = (sum(free), sum(bound));
                        let values = free.iter().zip(&held).map(|(r, rl)| rl / (r + rl)).collect();
                        push(&occupancy_name(self.plan, bound), values);
                    }
                }
            }
        }
        if let Reading::Surface { passing } = &self.reading {
            for Passing { species: s, at } in passing {
                let gained = |one: &Gate| {
                    let n = amounts[one.voxel as usize * species + s];
                    one.enters - one.leaves * n
                };
                let supply: f64 = at.iter().map(gained).sum();
                push(&supply_name(self.plan, *s), vec![supply / AVOGADRO]);
            }
        }
        if flow {
            for (name, values) in &self.velocity {
                push(name, values.clone());
            }
        }
    }
}

/// Name of the quantity that tells which fraction of a receptor is bound.
#[must_use]
pub fn occupancy_name(plan: &Plan, bound: usize) -> String {
    let pairs = receptor_pairs(&plan.network, &plan.analysis);
    if pairs.len() == 1 { "occupancy".into() } else { format!("occupancy {}", plan.reactor.species[bound]) }
}

/// Name of the quantity that tells what enters of a species, mol/s.
#[must_use]
pub fn supply_name(plan: &Plan, s: usize) -> String {
    format!("{} supply", plan.reactor.species[s])
}

/// The reactions at the surface of a probe: surface and species.
fn at_surface(plan: &Plan, probe: &Probe) -> Vec<(Surface, usize)> {
    let (ProbeShape::Surface { wall }, Domain::Particles(domain)) = (&probe.shape, &plan.model.domain) else {
        return Vec::new();
    };
    let walls = surfaces(domain);
    let found = plan.network.reactions.iter().filter_map(|reaction| match &reaction.rate {
        Rate::Surface(surface) if walls.get(surface.number) == Some(wall) => {
            reaction.change().first().map(|&(s, _)| (*surface, s))
        }
        _ => None,
    });
    found.filter(|(_, s)| probe.species.contains(s)).collect()
}

/// Species that pass the surface of a probe, each once.
#[must_use]
pub fn supplied(plan: &Plan, probe: &Probe) -> Vec<usize> {
    let mut found: Vec<usize> = at_surface(plan, probe).into_iter().map(|(_, s)| s).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// What enters and leaves through the surface of a probe on one geometry.
fn passing<const D: usize>(plan: &Plan, probe: &Probe, scene: &Scene<D>) -> Vec<Passing> {
    let reactions = at_surface(plan, probe);
    let of = |s: usize| {
        let mut at: Vec<Gate> = Vec::new();
        let exchange = scene.exchange(plan.reactor.habitat[s]);
        for (surface, _) in reactions.iter().filter(|(_, other)| *other == s) {
            for facing in scene.facing(surface.number, plan.reactor.habitat[s], &exchange) {
                let volume = scene.volumes[facing.voxel as usize];
                let diffusivity = plan.reactor.diffusivity[s];
                let weight = surface.kind.weight(volume, facing.area, facing.distance, diffusivity);
                let (enters, leaves) = match surface.kind {
                    SurfaceKind::Absorption(_) => (0.0, weight),
                    SurfaceKind::Flux(_) | SurfaceKind::Held(_) => (weight, 0.0),
                };
                // Reactions at one surface list its voxels in the same, rising order.
                match at.binary_search_by_key(&facing.voxel, |gate| gate.voxel) {
                    Ok(k) => {
                        at[k].enters += enters;
                        at[k].leaves += leaves;
                    }
                    Err(k) => at.insert(k, Gate { voxel: facing.voxel, enters, leaves }),
                }
            }
        }
        Passing { species: s, at }
    };
    supplied(plan, probe).into_iter().map(of).collect()
}

fn line<'p, const D: usize>(
    plan: &'p Plan,
    probe: &'p Probe,
    scene: &Scene<D>,
    from: &Vector<3>,
    to: &Vector<3>,
    points: usize,
) -> ProbeLens<'p, D> {
    let at = |k: usize| from + (to - from) * (k as f64 / (points - 1) as f64);
    let places: Vec<Vector<D>> = (0..points).map(|k| Vector::from_fn(|axis, _| at(k)[axis])).collect();
    // Fields jump across a barrier at the ends of a periodic axis; nothing is read off through it.
    let mut domain = scene.plan.domain.clone();
    for barrier in &scene.plan.barriers {
        let (low, high) = (domain.min[barrier.axis], domain.max[barrier.axis]);
        let near = |end: f64| (barrier.at - end).abs() <= 1e-9 * (high - low);
        domain.periodic[barrier.axis] &= !(near(low) || near(high));
    }
    let weights_of = |mask: &[bool]| {
        let carriers = Carriers {
            positions: &scene.snapshot.position,
            volumes: &scene.snapshot.volume,
            mask,
            domain: &domain,
        };
        Interpolator::new(&places, &carriers, &scene.plan.kernel())
    };
    let hosts =
        |s: usize| -> Vec<bool> { scene.home.iter().map(|&g| plan.reactor.habitat[s].holds(g)).collect() };
    let mut species: Vec<Interpolator<D>> = Vec::new();
    for (k, &s) in probe.species.iter().enumerate() {
        // Species that live in the same groups share their weights.
        let same = probe.species[..k]
            .iter()
            .position(|&other| plan.reactor.habitat[other] == plan.reactor.habitat[s]);
        let weights = match same {
            Some(earlier) => species[earlier].clone(),
            None => weights_of(&hosts(s)).without(|k| !can_be(plan, scene, s, &embed(&places[k]))),
        };
        species.push(weights);
    }
    let mut velocity = Vec::new();
    if probe.velocity && scene.plan.flow.is_some() {
        let fluid: Vec<bool> = scene.home.iter().map(|&g| !scene.plan.is_wall(g)).collect();
        let weights = weights_of(&fluid).without(|k| in_wall(scene, &embed(&places[k])));
        for axis in 0..D {
            let name = format!("v{}", crate::model::names::axis_name(axis));
            let values =
                (0..points).map(|k| weights.apply(k, |j| scene.snapshot.velocity[j][axis])).collect();
            velocity.push((name, values));
        }
    }
    ProbeLens {
        plan,
        probe,
        s: (0..points).map(|k| (at(k) - from).norm()).collect(),
        place: (0..points).map(|k| at(k).into()).collect(),
        reading: Reading::Line {
            species,
            per_amount: scene.volumes.iter().map(|v| 1.0 / (AVOGADRO * v)).collect(),
        },
        velocity,
    }
}

/// Whether a species can be at a place: in a group that stays where it is and holds it, or, outside all of
/// those, in one that takes what is left or flows. Where there are elastic solids the nearest particle tells.
fn can_be<const D: usize>(plan: &Plan, scene: &Scene<D>, s: usize, x: &Vector<3>) -> bool {
    let owner = scene.plan.still.iter().find(|(_, shape)| shape.holds(x));
    let habitat = plan.reactor.habitat[s];
    match owner {
        Some((group, _)) => habitat.holds(*group),
        None if scene.plan.solids.is_empty() => scene.plan.loose.iter().any(|&group| habitat.holds(group)),
        None => {
            let away = |i: &usize| (scene.positions[*i] - x).norm_squared();
            let nearest = (0..scene.positions.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
            nearest.is_some_and(|i| habitat.holds(scene.home[i]))
        }
    }
}

/// Whether a place is inside a wall that stays where it is.
fn in_wall<const D: usize>(scene: &Scene<D>, x: &Vector<3>) -> bool {
    scene.plan.still.iter().any(|(group, shape)| scene.plan.is_wall(*group) && shape.holds(x))
}

type Sectors = Vec<(Vec<(u32, f64)>, f64)>;

/// Sectors centred on multiples of 2π/n, and the share of each particle's arc that lies in each.
fn ring<const D: usize>(
    scene: &Scene<D>,
    centre: &Vector<3>,
    (inner, outer): (f64, f64),
    count: usize,
    group: Option<usize>,
) -> (Vec<f64>, Vec<[f64; 3]>, Sectors) {
    let width = std::f64::consts::TAU / count as f64;
    let mut sectors: Sectors = vec![(Vec::new(), 0.0); count];
    for (i, x) in scene.positions.iter().enumerate() {
        let apart = x - centre;
        let r = apart.norm();
        let member =
            group.is_none_or(|g| usize::from(scene.home[i]) == g || usize::from(scene.current[i]) == g);
        if !member || r < inner || r > outer || r == 0.0 {
            continue;
        }
        // The particle stands for an arc as long as its own width.
        let half = (0.5 * scene.snapshot.volume[i].powf(1.0 / D as f64) / r).min(std::f64::consts::PI);
        let angle = apart[1].atan2(apart[0]);
        let (low, high) = ((angle - half) / width + 0.5, (angle + half) / width + 0.5);
        for k in low.floor() as i64..=high.floor() as i64 {
            let overlap = high.min((k + 1) as f64) - low.max(k as f64);
            if overlap > 0.0 {
                let share = overlap / (high - low);
                let (members, volume) = &mut sectors[k.rem_euclid(count as i64) as usize];
                members.push((i as u32, share));
                *volume += share * scene.volumes[i];
            }
        }
    }
    let middle = 0.5 * (inner + outer);
    let angles: Vec<f64> = (0..count).map(|k| k as f64 * width).collect();
    let places =
        angles.iter().map(|a| [centre[0] + middle * a.cos(), centre[1] + middle * a.sin(), 0.0]).collect();
    (angles, places, sectors)
}
