//! Areas that a surface offers to the voxels before it, for fluxes through it and absorption at it.
//!
//! A concentration that varies linearly towards a wall, C = C_w + g s at distance s, is not at rest under
//! conductances that reflect at the wall: it is odd where the mirror images are even. Voxel i misses D g A_i,
//!
//! ```text
//! A_i = Σ_j G_ij' 2 s_j    over the images j' behind the surface
//! ```
//!
//! Fed with J A_i, the voxels keep a linear profile of slope -J/D, and Σ_i A_i is the area of the surface (exactly
//! so for a plane between lattice layers). The same areas carry the linear profile of an absorbing wall,
//! D dC/ds = κ C_w: a voxel loses κ A_i C_w = κ A_i C_i / (1 + κ s_i / D). [`exchange`](crate::fluid::exchange)
//! sums them up along with the conductances.

use crate::fluid::exchange::Voxels;

/// A voxel before a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    pub voxel: u32,
    /// Its share of the surface, m².
    pub area: f64,
    /// Its distance from the surface, m.
    pub distance: f64,
}

/// The hosts that face a side of the box that is not periodic, in order; `areas` as the exchange found them within
/// `cutoff` (m) of the sides, `thickness` in m^(3-D).
#[must_use]
pub fn side<const D: usize>(
    voxels: &Voxels<D>,
    areas: &[f64],
    cutoff: f64,
    thickness: f64,
    (axis, upper): (usize, bool),
) -> Vec<Facing> {
    let Voxels { positions, domain, .. } = *voxels;
    let distance = |i: usize| {
        if upper { domain.max[axis] - positions[i][axis] } else { positions[i][axis] - domain.min[axis] }
    };
    // A voxel on the surface itself would feel it infinitely strongly.
    let facing =
        |i: usize| Facing { voxel: i as u32, area: areas[i], distance: distance(i).max(NEAREST * cutoff) };
    let mut found: Vec<Facing> = (0..areas.len()).filter(|&i| areas[i] > 0.0).map(facing).collect();
    // Among disordered voxels the sum is off by some per cent: brought to what they face of the side.
    let sum: f64 = found.iter().map(|f| f.area).sum();
    let faced = faced(voxels, cutoff, axis, distance) * thickness;
    found.iter_mut().for_each(|f| f.area *= faced / sum);
    found
}

/// Least distance from a surface, in cut-offs.
pub(super) const NEAREST: f64 = 0.01;

/// The part of a side that hosts face, m^(D-1): all of it, or else their volume within `depth` of it over `depth`.
fn faced<const D: usize>(
    voxels: &Voxels<D>,
    depth: f64,
    axis: usize,
    distance: impl Fn(usize) -> f64,
) -> f64 {
    let lengths = voxels.domain.lengths();
    let whole: f64 = (0..D).filter(|&k| k != axis).map(|k| lengths[k]).product();
    let within: f64 = (0..voxels.hosts.len())
        .filter(|&i| voxels.hosts[i] && distance(i) < 2.0 * depth)
        .map(|i| {
            let width = voxels.volumes[i].powf(1.0 / D as f64);
            voxels.volumes[i] * ((depth - distance(i)) / width + 0.5).clamp(0.0, 1.0)
        })
        .sum();
    let faced = within / depth;
    // What disorder makes of a full side.
    if (faced / whole - 1.0).abs() < 0.05 { whole } else { faced }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::Weights;
    use crate::fluid::exchange::exchange;
    use crate::space::domain::Domain;
    use crate::space::kernel::{Kernel, KernelKind};
    use crate::vector::Vector;

    const CUTOFF: f64 = 2.4;

    /// A closed box of `cells` unit cells per axis.
    fn cube<const D: usize>(cells: usize) -> (Domain<D>, Vec<Vector<D>>) {
        let domain =
            Domain { min: Vector::zeros(), max: Vector::from_element(cells as f64), periodic: [false; D] };
        let points = (0..cells.pow(D as u32))
            .map(|index| Vector::from_fn(|k, _| (index / cells.pow(k as u32) % cells) as f64 + 0.5))
            .collect();
        (domain, points)
    }

    fn whole_side<const D: usize>() {
        let (domain, positions) = cube::<D>(6);
        let (volumes, hosts) = (vec![1.0; positions.len()], vec![true; positions.len()]);
        let voxels = Voxels {
            positions: &positions,
            volumes: &volumes,
            hosts: &hosts,
            domain: &domain,
            barriers: &[],
            obstacles: &[],
        };
        let kernel = Kernel::new(KernelKind::Lucy, CUTOFF);
        let all = exchange(&voxels, &kernel, Weights::Normalised, 1.0);
        for (axis, upper) in [(0, false), (D - 1, true)] {
            let found = side(&voxels, &all.sides[2 * axis + usize::from(upper)], CUTOFF, 1.0, (axis, upper));
            let area: f64 = found.iter().map(|f| f.area).sum();
            assert!((area - 6.0_f64.powi(D as i32 - 1)).abs() < 1e-12, "{D} {axis} {area}");
            // Only the layers within the cut-off, each voxel at its distance.
            assert!(found.iter().all(|f| f.distance < CUTOFF && f.area > 0.0));
        }
        // Fed on one side and drained on the other, a linear profile along axis 0 is at rest to rounding.
        let mut change: Vec<f64> = (0..positions.len())
            .map(|i| all.links.row(i).map(|(j, g)| g * (positions[i][0] - positions[j][0])).sum())
            .collect();
        for (upper, sign) in [(false, 1.0), (true, -1.0)] {
            for f in side(&voxels, &all.sides[usize::from(upper)], CUTOFF, 1.0, (0, upper)) {
                change[f.voxel as usize] += sign * f.area;
            }
        }
        let largest = change.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
        assert!(largest < 1e-13, "{D}: {largest}");
    }

    #[test]
    fn a_side_is_shared_out_and_keeps_a_linear_profile() {
        whole_side::<1>();
        whole_side::<2>();
        whole_side::<3>();
    }

    #[test]
    fn a_disordered_side_and_half_a_side_show_their_length() {
        use rand::Rng;
        let mut random = crate::random::stream(3, 0, crate::random::Purpose::Placement);
        let (domain, mut positions) = cube::<2>(40);
        for x in &mut positions {
            *x += Vector::from_fn(|_, _| 0.2 * (2.0 * random.random::<f64>() - 1.0));
        }
        let volumes = vec![1.0; positions.len()];
        for part in [40.0, 20.0] {
            let hosts: Vec<bool> = positions.iter().map(|x| x[1] < part).collect();
            let voxels = Voxels {
                positions: &positions,
                volumes: &volumes,
                hosts: &hosts,
                domain: &domain,
                barriers: &[],
                obstacles: &[],
            };
            let kernel = Kernel::new(KernelKind::Lucy, CUTOFF);
            let all = exchange(&voxels, &kernel, Weights::Normalised, 1.0);
            let area: f64 =
                side(&voxels, &all.sides[0], CUTOFF, 1.0, (0, false)).iter().map(|f| f.area).sum();
            assert!((area / part - 1.0).abs() < 0.03, "{part}: {area}");
        }
    }

    #[test]
    fn a_disc_shows_its_circumference() {
        // Discs of growing radius in a plane of unit cells: 2 π R. The staircase scatters by a few per cent.
        for radius in [4.0, 8.0, 16.0] {
            let (domain, positions) = cube::<2>(48);
            let centre = Vector::from([24.1, 23.7]);
            let distance = move |x: &Vector<2>| (x - centre).norm() - radius;
            let hosts: Vec<bool> = positions.iter().map(|x| distance(x) >= 0.0).collect();
            let volumes = vec![1.0; positions.len()];
            let voxels = Voxels {
                positions: &positions,
                volumes: &volumes,
                hosts: &hosts,
                domain: &domain,
                barriers: &[],
                obstacles: &[&distance],
            };
            let kernel = Kernel::new(KernelKind::Lucy, 3.0);
            let all = exchange(&voxels, &kernel, Weights::Normalised, 1.0);
            let area: f64 = all.obstacles[0].iter().map(|f| f.area).sum();
            let ratio = area / (std::f64::consts::TAU * radius);
            assert!((ratio - 1.0).abs() < 0.02, "R = {radius}: {ratio}");
        }
    }
}
