//! The outline of an obstacle that no molecule enters: what it blocks, and the mirror images behind it.
//!
//! Next to a wall a voxel lacks half of its neighbours. Images of the voxels before the wall take their place: at
//! x - 2 s n, s the distance from the outline and n its normal. Reflection at a bent outline shrinks (or stretches)
//! what is reflected by 1 - 2 s κ in each direction along it, κ the curvature at s, and with it the volume of the
//! image; on average over the directions (1 - 2 s ∇²s/(D - 1))^(D - 1), exact in the plane and for a ball.
//!
//! i sees the image of j at a distance that differs from that at which j sees the image of i, by second order in
//! the curvature; conductances take the mean of both.

use crate::fluid::exchange::{LEAST, Met, Voxels};
use crate::fluid::surface::Facing;
use crate::vector::Vector;

/// Steps of the difference quotients for normal and curvature, in cut-offs.
const STEP: f64 = 0.02;

/// Most by which an image may be larger than what it reflects, in the hollow of an outline.
const LARGEST: f64 = 3.0;

/// Stands for no place among the mirrors.
const NONE: u32 = u32::MAX;

/// An obstacle as the voxels see it.
pub(super) struct Outline<'a, const D: usize> {
    number: u32,
    cutoff: f64,
    distance: &'a (dyn Fn(&Vector<D>) -> f64 + Sync),
    /// Distance of each particle, m.
    away: Vec<f64>,
    /// Place among the mirrors of each particle, or [`NONE`].
    rank: Vec<u32>,
    mirrors: Vec<Mirror<D>>,
}

/// A voxel before an outline and what its image needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirror<const D: usize> {
    voxel: u32,
    /// Distance from the outline, m.
    away: f64,
    /// Gradient of the distance, a unit vector.
    pub normal: Vector<D>,
    /// Volume of the image over that of the voxel.
    size: f64,
}

/// What voxels i and j exchange by way of each other's images: `[0]` as i sees that of j, `[1]` as j sees that of i.
pub(super) struct Behind<const D: usize> {
    /// The direct pair it belongs to; `None` for a voxel and its own image.
    pub met: Option<u32>,
    pub outline: u32,
    pub i: u32,
    pub j: u32,
    /// F times the size of the image.
    pub f: [f64; 2],
    /// x_i less the image of j, and the image of i less x_j, m.
    pub x: [Vector<D>; 2],
    /// Normals at i and j.
    normal: [Vector<D>; 2],
    /// Twice the distances of i and j, m.
    pub depth: [f64; 2],
}

impl<const D: usize> Voxels<'_, D> {
    /// The outlines of the obstacles, with the mirrors of the hosts among the first `n` particles that are within
    /// `cutoff` of them.
    pub(super) fn outlines(&self, n: usize, cutoff: f64) -> Vec<Outline<'_, D>> {
        let mut outlines = Vec::with_capacity(self.obstacles.len());
        for &distance in self.obstacles {
            let away: Vec<f64> = self.positions[..n].iter().map(distance).collect();
            let mut rank = vec![NONE; n];
            let mut mirrors = Vec::new();
            for i in (0..n).filter(|&i| self.hosts[i] && (0.0..cutoff).contains(&away[i])) {
                let found = Mirror::new(i as u32, &self.positions[i], away[i], STEP * cutoff, distance);
                if let Some(mirror) = found {
                    rank[i] = mirrors.len() as u32;
                    mirrors.push(mirror);
                }
            }
            outlines.push(Outline { number: outlines.len() as u32, cutoff, distance, away, rank, mirrors });
        }
        outlines
    }
}

impl<const D: usize> Outline<'_, D> {
    /// Whether particle j lies inside.
    pub fn holds(&self, j: usize) -> bool {
        self.away[j] < 0.0
    }

    /// Number of voxels with an image.
    pub fn mirrors(&self) -> usize {
        self.mirrors.len()
    }

    /// Place of voxel `i` among those with an image.
    #[inline]
    pub fn rank(&self, i: usize) -> Option<usize> {
        let rank = self.rank[i];
        (rank != NONE).then_some(rank as usize)
    }

    /// How voxel `i` is mirrored, if it is near enough.
    #[inline]
    pub fn mirror(&self, i: usize) -> Option<&Mirror<D>> {
        self.rank(i).map(|rank| &self.mirrors[rank])
    }

    /// Whether the way -x from particle `i`, of squared length `r2`, leads through the obstacle, judged at its
    /// quarters.
    #[inline]
    pub fn blocks(&self, i: usize, from: &Vector<D>, x: &Vector<D>, r2: f64) -> bool {
        let away = self.away[i];
        // Nothing of an obstacle is nearer than its distance.
        if away > 0.0 && away * away >= r2 {
            return false;
        }
        [0.25, 0.5, 0.75].iter().any(|&part| (self.distance)(&(from - x * part)) < -1e-9 * self.cutoff)
    }

    /// The voxels with an image and their `areas` (m²), none of them nearer than `nearest` (m): on the surface
    /// itself one would feel it infinitely strongly.
    pub fn facing(&self, areas: &[f64], nearest: f64) -> Vec<Facing> {
        self.mirrors
            .iter()
            .zip(areas)
            .filter(|(_, area)| **area > 0.0)
            .map(|(mirror, &area)| Facing { voxel: mirror.voxel, area, distance: mirror.away.max(nearest) })
            .collect()
    }
}

impl<const D: usize> Mirror<D> {
    /// Of voxel `voxel` at `place`; `None` where the outline has no normal.
    fn new(
        voxel: u32,
        place: &Vector<D>,
        away: f64,
        step: f64,
        distance: &(dyn Fn(&Vector<D>) -> f64 + Sync),
    ) -> Option<Mirror<D>> {
        let mut gradient = Vector::<D>::zeros();
        let mut bend = 0.0;
        for k in 0..D {
            let (mut low, mut high) = (*place, *place);
            low[k] -= step;
            high[k] += step;
            let (low, high) = (distance(&low), distance(&high));
            gradient[k] = (high - low) / (2.0 * step);
            bend += (high + low - 2.0 * away) / (step * step);
        }
        let length = gradient.norm();
        let size = if D == 1 {
            1.0
        } else {
            (1.0 - 2.0 * away * bend / (D - 1) as f64).max(0.0).powi(D as i32 - 1).min(LARGEST)
        };
        // Half way between two faces the slopes cancel.
        (length > 0.5).then(|| Mirror { voxel, away, normal: gradient / length, size })
    }

    /// The same with another normal, as beyond a side of the box.
    pub fn leaning(&self, normal: Vector<D>) -> Mirror<D> {
        Mirror { normal, ..*self }
    }

    /// `vector` as the image has it.
    fn reflect(normal: &Vector<D>, vector: &Vector<D>) -> Vector<D> {
        vector - normal * (2.0 * vector.dot(normal))
    }
}

impl<const D: usize> Behind<D> {
    /// Voxel `i` and its own image.
    pub fn own(i: usize, mirror: &Mirror<D>, outline: &Outline<D>, weight: impl Fn(f64) -> f64) -> Behind<D> {
        let x = mirror.normal * (2.0 * mirror.away);
        let f = mirror.size * weight(x.norm_squared());
        Behind {
            met: None,
            outline: outline.number,
            i: i as u32,
            j: i as u32,
            f: [f; 2],
            x: [x, -x],
            normal: [mirror.normal; 2],
            depth: [2.0 * mirror.away; 2],
        }
    }

    /// What comes with direct pair number `met` of voxels mirrored by `here` and `there`; `None` if out of reach.
    pub fn of(
        met: u32,
        pair: &Met<D>,
        (here, there): (&Mirror<D>, &Mirror<D>),
        outline: &Outline<D>,
        weight: impl Fn(f64) -> f64,
    ) -> Option<Behind<D>> {
        let depth = [2.0 * here.away, 2.0 * there.away];
        let x = [pair.x + there.normal * depth[1], pair.x - here.normal * depth[0]];
        let f = [there.size * weight(x[0].norm_squared()), here.size * weight(x[1].norm_squared())];
        let normal = [here.normal, there.normal];
        let (outline, met) = (outline.number, Some(met));
        (f[0] + f[1] > 0.0).then_some(Behind { met, outline, i: pair.i, j: pair.j, f, x, normal, depth })
    }

    /// Tilts both weights by the pulls of i and j.
    pub fn tilt(&mut self, here: &Vector<D>, there: &Vector<D>) {
        let images = [Mirror::reflect(&self.normal[0], here), Mirror::reflect(&self.normal[1], there)];
        self.f[0] *= (1.0 - (here - images[1]).dot(&self.x[0])).max(LEAST);
        self.f[1] *= (1.0 - (images[0] - there).dot(&self.x[1])).max(LEAST);
    }

    /// The weight of the pair.
    pub fn mean(&self) -> f64 {
        0.5 * (self.f[0] + self.f[1])
    }
}
