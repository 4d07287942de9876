//! An order of the particles in which neighbours in space are neighbours in memory: along Hilbert's curve.

use crate::space::domain::Domain;
use crate::vector::Vector;

/// The order of places (m) along Hilbert's curve through cells of width `width` (m), as indices.
#[must_use]
pub fn along_a_curve<const D: usize>(places: &[Vector<D>], domain: &Domain<D>, width: f64) -> Vec<u32> {
    let (mut min, mut max) = (domain.min, domain.max);
    for place in places {
        (min, max) = (min.inf(place), max.sup(place));
    }
    // Cells of the longest axis; 20 bits of each of three axes fit a key of 64.
    let cells = ((max - min).max() / width).clamp(1.0, f64::from(1 << 20));
    let bits = (cells.log2().ceil() as u32).clamp(1, 20);
    let scale = f64::from(1_u32 << bits) / ((max - min).max() * (1.0 + 1e-9));
    let mut keys: Vec<(u64, u32)> = places
        .iter()
        .zip(0..)
        .map(|(place, i)| {
            (hilbert::<D>(std::array::from_fn(|k| ((place[k] - min[k]) * scale) as u32), bits), i)
        })
        .collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, i)| i).collect()
}

/// Number of a cell along Hilbert's curve of `bits` bits an axis; Skilling 2004, "Programming the Hilbert curve".
fn hilbert<const D: usize>(mut x: [u32; D], bits: u32) -> u64 {
    // Undo the rotations from the largest square down.
    for bit in (1..bits).rev() {
        let (here, below) = (1 << bit, (1 << bit) - 1);
        for k in 0..D {
            if x[k] & here != 0 {
                x[0] ^= below;
            } else {
                let swap = (x[0] ^ x[k]) & below;
                x[0] ^= swap;
                x[k] ^= swap;
            }
        }
    }
    // Gray code.
    for k in 1..D {
        x[k] ^= x[k - 1];
    }
    let mut flip = 0;
    for bit in (1..bits).rev() {
        if x[D - 1] & (1 << bit) != 0 {
            flip ^= (1 << bit) - 1;
        }
    }
    let mut key = 0;
    for bit in (0..bits).rev() {
        for k in x {
            key = key << 1 | u64::from((k ^ flip) >> bit & 1);
        }
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_a_curve<const D: usize>(bits: u32) {
        let n = 1_u32 << bits;
        let count = n.pow(D as u32);
        let mut cells: Vec<(u64, [u32; D])> = (0..count)
            .map(|index| {
                let cell = std::array::from_fn(|k| index / n.pow(k as u32) % n);
                (hilbert(cell, bits), cell)
            })
            .collect();
        cells.sort_unstable();
        // Every number once, and from each cell to the next one step along one axis.
        assert!(cells.iter().zip(0..).all(|((key, _), n)| *key == n));
        for pair in cells.windows(2) {
            let steps: u32 = (0..D).map(|k| pair[0].1[k].abs_diff(pair[1].1[k])).sum();
            assert_eq!(steps, 1);
        }
    }

    #[test]
    fn the_curve_visits_every_cell_and_never_jumps() {
        is_a_curve::<1>(5);
        is_a_curve::<2>(4);
        is_a_curve::<3>(3);
    }
}
