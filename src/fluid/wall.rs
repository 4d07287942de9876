//! How fluid particles are kept out of walls.

use crate::fluid::blocks::Block;
use crate::fluid::motion::Motion;
use crate::fluid::particles::{Material, Own, Side};
use crate::fluid::setup::{Body, BodyKind};
use crate::space::domain::Domain;
use crate::vector::Vector;

/// The solids and the box as obstacles.
pub struct Obstacles<'a, const D: usize> {
    pub bodies: &'a [Body<D>],
    /// By number of a particle its place among those of its body.
    pub rows: &'a [u32],
    pub domain: &'a Domain<D>,
    /// Time at the end of the step, s.
    pub time: f64,
    /// Step, s.
    pub dt: f64,
    /// Volume fraction of solid that marks the surface.
    pub surface_fraction: f64,
    /// Distance of fluid particles, m: the scale of difference quotients.
    pub spacing: f64,
    /// Axes that end in walls.
    pub closed: [bool; D],
}

/// What happened to a particle at a wall.
#[derive(Clone, Copy, Debug)]
pub struct Bounce<const D: usize> {
    /// New less old position, m.
    pub correction: Vector<D>,
    pub bounced: bool,
    /// Still inside a solid after all corrections.
    pub inside: bool,
}

impl<const D: usize> Obstacles<'_, D> {
    /// Sends fluid particle `row` back if its volume fraction says it is at the surface, then makes sure by the
    /// signed distances and the box that it is outside every solid. The momentum velocity is not touched.
    #[must_use]
    pub fn bounce(
        &self,
        block: &Block<D>,
        row: usize,
        fraction: f64,
        positions: &[Vector<D>],
        sides: &[Side<D>],
    ) -> Bounce<D> {
        let here = positions[block.first + row];
        let mut place = here;
        let mut bounced = false;
        if fraction >= self.surface_fraction {
            place += self.reflect(block, row, &here, sides);
            bounced = true;
        }
        let mut inside = false;
        if block.near_solid[row] {
            let near = Near { block, row, here, sides };
            bounced |= self.push_out(&mut place, &mut inside, &near);
        }
        bounced |= self.keep_in_box(&mut place);
        Bounce { correction: place - here, bounced, inside }
    }

    /// SPH-BVF Eqs (46)-(49): with the normal e out of the wall and the wall's velocity and acceleration v_w,
    /// a_w as means over the solid neighbours, weighted by V F (SPH-BVF takes W; F weighs the nearest more), the transport velocity becomes
    /// u' = 2 v_w + dt a_w - u + 2 max(0, (u - v_w)·e) e and the particle moves by dt (u' - u).
    /// The means are normalised by the solid sum; e points down the gradient of the fraction (Eq. (47) prints
    /// the other sign). Along walls that are free slip what slides is not turned round: u' = u - 2 min(0, (u - v_w)·e) e.
    fn reflect(&self, block: &Block<D>, row: usize, here: &Vector<D>, sides: &[Side<D>]) -> Vector<D> {
        let side = &sides[block.first + row];
        let (mut all, mut slippery, mut normal) = (0.0, 0.0, Vector::zeros());
        let (mut wall, mut wall_acceleration) = (Vector::zeros(), Vector::zeros());
        for c in block.row(row) {
            let s = &sides[c.j as usize];
            if let BodyKind::Solid { motion, .. } = &self.bodies[s.body as usize].kind {
                let share = s.volume * c.weight;
                let (velocity, acceleration) = match motion {
                    Motion::Elastic(coupled) => {
                        let row = self.rows[s.id as usize] as usize;
                        (coupled.velocity(row), coupled.acceleration(row))
                    }
                    _ => {
                        let place = here - c.x;
                        (motion.velocity(&place, self.time), motion.acceleration(&place, self.time))
                    }
                };
                all += share;
                slippery += if s.material == Material::FreeSlip { share } else { 0.0 };
                normal += c.x * share;
                wall += velocity * share;
                wall_acceleration += acceleration * share;
            }
        }
        let length = normal.norm();
        if all <= 0.0 || length <= 0.0 {
            return Vector::zeros();
        }
        let (e, wall, wall_acceleration) = (normal / length, wall / all, wall_acceleration / all);
        let u = side.velocity + side.drift;
        let along = (u - wall).dot(&e);
        let after = if slippery > 0.5 * all {
            u + e * (wall_acceleration.dot(&e) * self.dt - 2.0 * along.min(0.0))
        } else {
            wall * 2.0 + wall_acceleration * self.dt - u + e * (2.0 * along.max(0.0))
        };
        (after - u) * self.dt
    }

    /// Mirrors a place inside a solid at its surface, along the gradient of the signed distance, until it is
    /// outside all of them; at most eight times, since bodies may touch.
    fn push_out(&self, place: &mut Vector<D>, inside: &mut bool, near: &Near<D>) -> bool {
        let mut bounced = false;
        for attempt in 0..8 {
            let mut clear = true;
            for (body, number) in self.bodies.iter().zip(0_u8..) {
                let Some((depth, out)) = self.depth(body, number, place, near) else { continue };
                clear = false;
                bounced = true;
                // A little further each time, for distances that are only bounds.
                *place += out * (2.0 * depth * f64::from(1 << attempt) + 1e-6 * self.spacing);
            }
            *inside = !clear;
            if clear {
                return bounced;
            }
        }
        *inside = self
            .bodies
            .iter()
            .zip(0_u8..)
            .any(|(body, number)| self.depth(body, number, place, near).is_some());
        bounced
    }

    /// How deep (m) a place is inside a body and which way out of it; `None` outside. The body is asked in its own frame,
    /// inside the box, an elastic one in that of its undeformed particle nearest to the place.
    fn depth(
        &self,
        body: &Body<D>,
        number: u8,
        place: &Vector<D>,
        near: &Near<D>,
    ) -> Option<(f64, Vector<D>)> {
        let BodyKind::Solid { motion, surface: Some(surface), .. } = &body.kind else { return None };
        let step = 1e-4 * self.spacing;
        let Motion::Elastic(coupled) = motion else {
            let distance =
                |x: &Vector<D>| surface(&self.domain.wrap(&motion.origin(&self.domain.wrap(x), self.time)));
            let depth = -distance(place);
            return (depth > 0.0).then(|| (depth, direction(&gradient(distance, place, step))));
        };
        let (row, away) = near.nearest(number, place, self.rows)?;
        let origin = coupled.origin_beside(row, &away);
        // Further from its particles than their corners there is no solid, whatever a gradient foresees.
        if (origin - coupled.solid().places()[row]).norm_squared() > D as f64 * coupled.edge(row).powi(2) {
            return None;
        }
        let distance = |x: &Vector<D>| surface(&self.domain.wrap(x));
        let depth = -distance(&origin);
        (depth > 0.0).then(|| {
            let out = coupled.push_forward(row, &direction(&gradient(distance, &origin, step)));
            let stretch = out.norm();
            // Half way between two surfaces there is no way out.
            if stretch > 0.0 { (depth / stretch, out / stretch) } else { (depth, Vector::zeros()) }
        })
    }

    /// Mirrors a place beyond a wall of the box at that wall. Further than half a box out it is left there, for
    /// the check of the numbers to find.
    fn keep_in_box(&self, place: &mut Vector<D>) -> bool {
        let mut bounced = false;
        for k in (0..D).filter(|&k| self.closed[k]) {
            let (low, high) = (self.domain.min[k], self.domain.max[k]);
            let over = (low - place[k]).max(place[k] - high);
            if over > 0.0 && over < 0.5 * (high - low) {
                place[k] = if place[k] < low { 2.0 * low - place[k] } else { 2.0 * high - place[k] };
                bounced = true;
            }
        }
        bounced
    }
}

/// Gradient of a distance at a place, by difference quotients of `step` (m).
fn gradient<const D: usize>(distance: impl Fn(&Vector<D>) -> f64, place: &Vector<D>, step: f64) -> Vector<D> {
    Vector::from_fn(|k, _| {
        let (mut up, mut down) = (*place, *place);
        up[k] += step;
        down[k] -= step;
        (distance(&up) - distance(&down)) / (2.0 * step)
    })
}

/// A vector of length one along another, or none along none.
fn direction<const D: usize>(x: &Vector<D>) -> Vector<D> {
    let length = x.norm();
    if length > 0.0 { x / length } else { Vector::zeros() }
}

/// The solid particles near a fluid particle.
struct Near<'a, const D: usize> {
    block: &'a Block<D>,
    row: usize,
    /// Where the fluid particle was when its contacts were found, m.
    here: Vector<D>,
    sides: &'a [Side<D>],
}

impl<const D: usize> Near<'_, D> {
    /// The particle of a body nearest to a place (m): its number in the body, and the way from it to the place.
    fn nearest(&self, body: u8, place: &Vector<D>, rows: &[u32]) -> Option<(usize, Vector<D>)> {
        let moved = place - self.here;
        let mut found: Option<(usize, Vector<D>)> = None;
        for c in self.block.row(self.row) {
            let side = &self.sides[c.j as usize];
            if side.body == body {
                let away = c.x + moved;
                if found.is_none_or(|(_, least)| away.norm_squared() < least.norm_squared()) {
                    found = Some((rows[side.id as usize] as usize, away));
                }
            }
        }
        found
    }
}

/// Takes a solid particle, `row` of its body, to its place of time `t` and gives it its own velocity, that of the middle of
/// a step of `dt` (s) as the fluid's: in a rigid rotation the divergence of fluid and wall is then none.
pub fn carry<const D: usize>(
    body: &Body<D>,
    row: usize,
    own: &Own<D>,
    position: &mut Vector<D>,
    side: &mut Side<D>,
    (t, dt): (f64, f64),
) {
    if let BodyKind::Solid { motion, .. } = &body.kind {
        if let Motion::Elastic(coupled) = motion {
            *position = coupled.solid().position(row);
            side.velocity = coupled.velocity(row);
            side.volume = coupled.solid().volume(row);
            side.invert();
            return;
        }
        let middle = t - 0.5 * dt;
        if motion.moves() {
            side.velocity = motion.velocity(&motion.position(&own.start, middle), middle);
            *position = motion.position(&own.start, t);
            if let Motion::Deforming(deformation) = motion {
                side.volume = own.rest_volume() * deformation.growth(&own.start, t);
                side.invert();
            }
        } else {
            side.velocity = motion.velocity(position, middle);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::setup::Slip;
    use std::sync::Arc;

    type V = Vector<2>;

    fn disc(centre: V, motion: Motion<2>) -> Body<2> {
        let surface: Arc<dyn Fn(&V) -> f64 + Send + Sync> = Arc::new(move |x| (x - centre).norm() - 1.0);
        Body {
            name: "disc".to_owned(),
            kind: BodyKind::Solid { slip: Slip::NoSlip, motion, surface: Some(surface) },
        }
    }

    #[test]
    fn a_place_inside_solids_or_beyond_the_box_is_mirrored_out() {
        let domain = Domain { min: V::new(-5.0, -5.0), max: V::new(5.0, 5.0), periodic: [true, false] };
        // Two discs that overlap, the second having moved to x = 1.5; one across the wrap.
        let bodies = [
            disc(V::zeros(), Motion::Still),
            disc(V::new(0.5, 0.0), Motion::Translating { velocity: V::new(0.5, 0.0) }),
        ];
        let obstacles = Obstacles {
            bodies: &bodies,
            rows: &[],
            domain: &domain,
            time: 2.0,
            dt: 0.1,
            surface_fraction: 0.49,
            spacing: 0.2,
            closed: [false, true],
        };
        let block = Block::default();
        let near = Near { block: &block, row: 0, here: V::zeros(), sides: &[] };
        for start in [V::new(0.0, 0.9), V::new(0.75, 0.01), V::new(2.3, -0.2), V::new(-0.99, 0.0)] {
            let (mut place, mut inside) = (start, false);
            assert!(obstacles.push_out(&mut place, &mut inside, &near) && !inside);
            assert!(place.norm() >= 1.0 && (place - V::new(1.5, 0.0)).norm() >= 1.0, "{place}");
        }
        let mut shallow = V::new(0.0, 0.9);
        assert!(obstacles.push_out(&mut shallow, &mut false, &near));
        // Mirrored: as far outside as it was inside, plus a millionth of the spacing.
        assert!((shallow - V::new(0.0, 1.1)).norm() < 1e-6);
        let mut beyond = V::new(7.0, 5.25);
        assert!(obstacles.keep_in_box(&mut beyond));
        assert_eq!(beyond, V::new(7.0, 4.75));
    }

    /// A particle that slides down on a floor: a sticky one sends it back where it came from, a slippery one lets it slide on.
    #[test]
    fn a_bounce_turns_sliding_round_only_where_fluid_sticks() {
        use crate::fluid::blocks::build_blocks;
        use crate::fluid::terms::tests::side;
        use crate::fluid::{Kernel, KernelKind};
        let domain = Domain { min: V::repeat(-20.0), max: V::repeat(20.0), periodic: [false; 2] };
        let mut positions: Vec<V> =
            (0..27).map(|k| V::new(f64::from(k % 9) - 4.0, -0.5 - f64::from(k / 9))).collect();
        positions.push(V::new(0.0, 0.2));
        for (slip, material, along) in
            [(Slip::NoSlip, Material::NoSlip, -1.0), (Slip::FreeSlip, Material::FreeSlip, 1.0)]
        {
            let kind = BodyKind::Solid { slip, motion: Motion::Still, surface: None };
            let bodies = [Body { name: "floor".to_owned(), kind }];
            let mut sides: Vec<Side<2>> =
                (0..28).map(|id| Side { material, body: 0, id, ..side(1.0, 0.0) }).collect();
            sides[27] = Side { material: Material::Fluid, velocity: V::new(1.0, -0.5), ..sides[27] };
            let rows: Vec<u32> = (0..28).collect();
            let mut blocks = Vec::new();
            build_blocks(&mut blocks, &positions, &sides, &domain, 3.0, true);
            blocks[0].find(
                &Kernel::new(KernelKind::Lucy, 3.0),
                None,
                &domain.shortest(),
                (&positions, &sides),
            );
            let (time, dt, surface_fraction, spacing) = (0.0, 0.1, 0.0, 1.0);
            let (rows, domain) = (rows.as_slice(), &domain);
            let bodies = &bodies;
            let closed = [false; 2];
            let obstacles = Obstacles { bodies, rows, domain, time, dt, surface_fraction, spacing, closed };
            let moved = obstacles.bounce(&blocks[0], 27, 0.5, &positions, &sides).correction / dt;
            let after = V::new(1.0, -0.5) + moved;
            assert!((after - V::new(along, 0.5)).norm() < 1e-12, "{after}");
        }
    }

    /// A block turned by a radian and stretched by 1.3: what is inside it is found in its undeformed frame and mirrored at
    /// its nearest face, what is outside stays.
    #[test]
    fn a_place_inside_a_bent_solid_is_mirrored_out() {
        use crate::fluid::blocks::build_blocks;
        use crate::fluid::terms::tests::side;
        use crate::fluid::{Coupled, Kernel, KernelKind};
        use crate::solid::{self, Elastic, Hold, Law};
        let domain = Domain { min: V::repeat(-20.0), max: V::repeat(20.0), periodic: [false; 2] };
        let places: Vec<V> =
            (0..60).map(|k| V::new(0.5 + f64::from(k % 12), 0.5 + f64::from(k / 12))).collect();
        let mut solid = Elastic::new(solid::Setup {
            domain: domain.clone(),
            kernel: KernelKind::Lucy,
            cutoff: 1.6,
            volumes: vec![1.0; places.len()],
            holds: vec![Hold::Free; places.len()],
            places,
            material: solid::Material::of_young(Law::NeoHookean, 1.0, 1.0, 0.3),
            options: solid::Options::default(),
        })
        .expect("a sound solid");
        let (sin, cos) = 1.0_f64.sin_cos();
        let map = move |x: &V| V::new(1.3 * cos * x[0] - sin * x[1], 1.3 * sin * x[0] + cos * x[1]);
        solid.displace(|x| map(x) - x).expect("not inside out");
        let mut positions: Vec<V> = (0..solid.len()).map(|i| solid.position(i)).collect();
        let surface: Arc<dyn Fn(&V) -> f64 + Send + Sync> =
            Arc::new(|x| (-x[0]).max(x[0] - 12.0).max(-x[1]).max(x[1] - 5.0));
        let motion = Coupled::motion(solid).expect("a sound solid");
        let kind = BodyKind::Solid { slip: Slip::NoSlip, motion, surface: Some(surface) };
        let bodies = [Body { name: "block".to_owned(), kind }];
        let rows: Vec<u32> = (0..61).collect();
        let mut sides: Vec<Side<2>> =
            (0..61).map(|id| Side { material: Material::NoSlip, body: 0, id, ..side(1.0, 0.0) }).collect();
        sides[60] = Side { material: Material::Fluid, body: 1, id: 60, ..side(1.0, 0.0) };
        // Inside, by the place at rest, and where it is to come out; the last two are outside.
        for (inside, out) in [
            (V::new(6.3, 4.8), V::new(6.3, 5.2)),
            (V::new(0.3, 2.4), V::new(-0.3, 2.4)),
            (V::new(3.0, -0.1), V::new(3.0, -0.1)),
            (V::new(12.2, 2.0), V::new(12.2, 2.0)),
        ] {
            positions.truncate(60);
            positions.push(map(&inside));
            let mut blocks = Vec::new();
            build_blocks(&mut blocks, &positions, &sides, &domain, 3.0, true);
            let kernel = Kernel::new(KernelKind::Lucy, 3.0);
            blocks[0].find(&kernel, None, &domain.shortest(), (&positions, &sides));
            let obstacles = Obstacles {
                bodies: &bodies,
                rows: &rows,
                domain: &domain,
                time: 0.0,
                dt: 0.1,
                surface_fraction: 0.49,
                spacing: 1.0,
                closed: [false; 2],
            };
            let near = Near { block: &blocks[0], row: 60, here: positions[60], sides: &sides };
            let (mut place, mut stays) = (positions[60], false);
            obstacles.push_out(&mut place, &mut stays, &near);
            // To a millionth of the spacing beyond the mirror image.
            assert!(!stays && (place - map(&out)).norm() < 1e-5, "{inside} {place} {}", map(&out));
        }
    }
}
