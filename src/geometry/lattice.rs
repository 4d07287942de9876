//! Particles that fill a region.

use crate::geometry::shape::{Shape, embed};
use crate::vector::Vector;
use rand::Rng;

/// How the particles of a group are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lattice {
    /// Square or cubic, centred in the cells of a grid that starts at the corner of the domain.
    Square,
    /// As square, of as many cells as go best into the box round the shape: their edges differ a little from the
    /// spacing.
    Fitted,
    /// Concentric rings, each particle with its exact share of the area (discs and rings in 2D).
    Rings,
}

/// A region to fill and how.
#[derive(Clone, Debug)]
pub struct Fill<'a> {
    pub shape: &'a Shape,
    /// Regions already claimed by others; left empty.
    pub without: Vec<&'a Shape>,
    pub lattice: Lattice,
    /// m.
    pub spacing: f64,
    /// Largest random displacement along each axis, in spacings; 0 for none.
    pub jitter: f64,
}

/// Places and volumes (m^D) of the particles that fill a region of the box `min..max`.
pub fn fill<const D: usize>(
    region: &Fill,
    min: &Vector<D>,
    max: &Vector<D>,
    random: &mut impl Rng,
) -> Vec<(Vector<D>, f64)> {
    match region.lattice {
        Lattice::Square => {
            let cells = |k: usize| ((max[k] - min[k]) / region.spacing).round() as i64;
            let grid = Grid {
                min: *min,
                edge: Vector::from_fn(|_, _| region.spacing),
                cells: std::array::from_fn(cells),
            };
            square(region, (min, max), &grid, random)
        }
        Lattice::Fitted => {
            let (low, high) = region.shape.bounds(&embed(min), &embed(max));
            let cells: [i64; D] =
                std::array::from_fn(|k| ((high[k] - low[k]) / region.spacing).round().max(1.0) as i64);
            let edge = Vector::from_fn(|k, _| (high[k] - low[k]) / cells[k] as f64);
            let grid = Grid { min: Vector::from_fn(|k, _| low[k]), edge, cells };
            square(region, (min, max), &grid, random)
        }
        Lattice::Rings => {
            let mut found = rings(region.shape, region.spacing);
            if let Shape::Union(_) = region.shape {
                // It goes on beyond a periodic side: what lies there is at the side across.
                for (x, _) in &mut found {
                    for k in 0..D {
                        x[k] = min[k] + (x[k] - min[k]).rem_euclid(max[k] - min[k]);
                    }
                }
            }
            found
        }
    }
}

/// Cells in whose centres particles lie.
struct Grid<const D: usize> {
    min: Vector<D>,
    edge: Vector<D>,
    cells: [i64; D],
}

fn square<const D: usize>(
    region: &Fill,
    (min, max): (&Vector<D>, &Vector<D>),
    grid: &Grid<D>,
    random: &mut impl Rng,
) -> Vec<(Vector<D>, f64)> {
    let (low, high) = region.shape.bounds(&embed(min), &embed(max));
    let Grid { min, edge, cells } = grid;
    // Cells of the grid that may hold a centre inside the region.
    let first: [i64; D] =
        std::array::from_fn(|k| ((low[k] - min[k]) / edge[k] - 0.5).floor().max(0.0) as i64);
    let last: [i64; D] =
        std::array::from_fn(|k| cells[k].min(((high[k] - min[k]) / edge[k] + 0.5).ceil() as i64));
    let volume = edge.iter().product();
    let mut found = Vec::new();
    let mut cell = first;
    if (0..D).any(|k| first[k] >= last[k]) {
        return found;
    }
    loop {
        let mut x = Vector::<D>::from_fn(|k, _| min[k] + (cell[k] as f64 + 0.5) * edge[k]);
        let place = embed(&x);
        if region.shape.holds(&place) && !region.without.iter().any(|other| other.holds(&place)) {
            if region.jitter > 0.0 {
                for k in 0..D {
                    x[k] += edge[k] * region.jitter * random.random_range(-1.0..1.0);
                }
            }
            found.push((x, volume));
        }
        let mut axis = 0;
        loop {
            cell[axis] += 1;
            if cell[axis] < last[axis] {
                break;
            }
            cell[axis] = first[axis];
            axis += 1;
            if axis == D {
                return found;
            }
        }
    }
}

fn rings<const D: usize>(shape: &Shape, spacing: f64) -> Vec<(Vector<D>, f64)> {
    let shape = match shape {
        // The first is the one described, the others are its images.
        Shape::Union(parts) => &parts[0],
        shape => shape,
    };
    let (centre, inner, outer) = match shape {
        Shape::Ball { centre, radius } => (centre, 0.0, *radius),
        Shape::Shell { centre, inner, outer } => (centre, *inner, *outer),
        _ => return Vec::new(), // refused when the model is checked
    };
    let layers = ((outer - inner) / spacing).round().max(1.0) as usize;
    let thickness = (outer - inner) / layers as f64;
    let mut found = Vec::new();
    for layer in 0..layers {
        let (r0, r1) = (inner + layer as f64 * thickness, inner + (layer + 1) as f64 * thickness);
        let middle = 0.5 * (r0 + r1);
        let count = (std::f64::consts::TAU * middle / spacing).round().max(3.0) as usize;
        let volume = std::f64::consts::PI * (r1 * r1 - r0 * r0) / count as f64;
        for k in 0..count {
            // Every other ring is turned by half a particle, which packs them like bricks.
            let angle = (k as f64 + 0.5 * (layer % 2) as f64) / count as f64 * std::f64::consts::TAU;
            let mut x = Vector::<D>::zeros();
            x[0] = centre[0] + middle * angle.cos();
            x[1] = centre[1] + middle * angle.sin();
            found.push((x, volume));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};

    #[test]
    fn a_square_lattice_fills_its_box_exactly() {
        let region = Fill {
            shape: &Shape::EverythingElse,
            without: vec![],
            lattice: Lattice::Square,
            spacing: 0.1,
            jitter: 0.0,
        };
        let mut random = stream(1, 0, Purpose::Placement);
        let found = fill::<2>(&region, &[0.0, 0.0].into(), &[2.0, 1.0].into(), &mut random);
        assert_eq!(found.len(), 200);
        assert!((found.iter().map(|p| p.1).sum::<f64>() - 2.0).abs() < 1e-12);
        let found = fill::<3>(&region, &[0.0; 3].into(), &[0.5, 0.5, 0.2].into(), &mut random);
        assert_eq!(found.len(), 50);
    }

    #[test]
    fn a_fitted_lattice_fills_what_no_spacing_divides() {
        let shape = Shape::Box { min: [0.3, 0.1, -1.0].into(), max: [1.3, 0.34, 1.0].into() };
        let region =
            Fill { shape: &shape, without: vec![], lattice: Lattice::Fitted, spacing: 0.07, jitter: 0.0 };
        let mut random = stream(1, 0, Purpose::Placement);
        let found = fill::<2>(&region, &[0.0, 0.0].into(), &[2.0, 1.0].into(), &mut random);
        // 14 by 3 cells.
        assert_eq!(found.len(), 42);
        assert!((found.iter().map(|p| p.1).sum::<f64>() - 0.24).abs() < 1e-12);
        assert!((found[0].0 - Vector::<2>::new(0.3 + 0.5 / 14.0, 0.14)).norm() < 1e-12);
    }

    #[test]
    fn rings_share_the_exact_area() {
        let shape = Shape::Shell { centre: [1.0, 1.0, 0.0].into(), inner: 0.3, outer: 0.5 };
        let region =
            Fill { shape: &shape, without: vec![], lattice: Lattice::Rings, spacing: 0.07, jitter: 0.0 };
        let found =
            fill::<2>(&region, &[0.0, 0.0].into(), &[2.0, 2.0].into(), &mut stream(1, 0, Purpose::Placement));
        let exact = std::f64::consts::PI * (0.25 - 0.09);
        assert!((found.iter().map(|p| p.1).sum::<f64>() / exact - 1.0).abs() < 1e-12);
        assert!(found.iter().all(|(x, _)| shape.holds(&embed(x))));
    }
}
