//! The sweeps and the filling of lists compiled twice: for any processor of the architecture, and for the wider registers of AVX2, chosen while
//! running. No product is fused with a sum in either, so the same bits come out of both.

use crate::fluid::blocks::Block;
use crate::fluid::candidates::Candidates;
use crate::fluid::particles::{Side, Slopes};
use crate::fluid::pass::{Rates, densities, forces};
use crate::fluid::physics::Terms;
use crate::space::domain::Shortest;
use crate::space::kernel::Kernel;
use crate::vector::Vector;

/// First sweep over a block: finds the contacts, sums density rates, second moments and volume fractions of solid.
pub fn sweep_densities<const D: usize>(
    block: &mut Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    shortest: &Shortest<D>,
    positions: &[Vector<D>],
    seen: (&[Side<D>], &[Slopes<D>]),
) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2")]
        fn wide<const D: usize>(
            block: &mut Block<D>,
            rates: &mut [Rates<D>],
            terms: &Terms<D>,
            kernel: &Kernel<D>,
            shortest: &Shortest<D>,
            positions: &[Vector<D>],
            seen: (&[Side<D>], &[Slopes<D>]),
        ) {
            densities(block, rates, terms, kernel, shortest, positions, seen);
        }
        if has_avx2() {
            // SAFETY: the processor has been asked for AVX2 in the line above.
            return unsafe { wide(block, rates, terms, kernel, shortest, positions, seen) };
        }
    }
    densities(block, rates, terms, kernel, shortest, positions, seen);
}

/// Second sweep over a block: forces and crowding of the fluid particles, from the contacts of the first.
pub fn sweep_forces<const D: usize>(
    block: &Block<D>,
    rates: &mut [Rates<D>],
    terms: &Terms<D>,
    kernel: &Kernel<D>,
    seen: (&[Side<D>], &[Slopes<D>]),
) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2")]
        fn wide<const D: usize>(
            block: &Block<D>,
            rates: &mut [Rates<D>],
            terms: &Terms<D>,
            kernel: &Kernel<D>,
            seen: (&[Side<D>], &[Slopes<D>]),
        ) {
            forces(block, rates, terms, kernel, seen);
        }
        if has_avx2() {
            // SAFETY: the processor has been asked for AVX2 in the line above.
            return unsafe { wide(block, rates, terms, kernel, seen) };
        }
    }
    forces(block, rates, terms, kernel, seen);
}

/// The lists of a block, [`Block::fill`].
pub fn fill_lists<const D: usize>(
    block: &mut Block<D>,
    all: &Candidates<D>,
    positions: &[Vector<D>],
    sides: &[Side<D>],
    solids: bool,
    mutual: bool,
) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2")]
        fn wide<const D: usize>(
            block: &mut Block<D>,
            all: &Candidates<D>,
            positions: &[Vector<D>],
            sides: &[Side<D>],
            solids: bool,
            mutual: bool,
        ) {
            block.fill(all, positions, sides, solids, mutual);
        }
        if has_avx2() {
            // SAFETY: the processor has been asked for AVX2 in the line above.
            return unsafe { wide(block, all, positions, sides, solids, mutual) };
        }
    }
    block.fill(all, positions, sides, solids, mutual);
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::{Body, BodyKind, Domain, Flow, KernelKind, Noise, Placed, Setup};
    use crate::random::mix;

    /// Any processor finds the same bits, with AVX2 or without: a test of the dispatch only where there is AVX2.
    fn agree<const D: usize>(n: usize, noise: Option<Noise>) {
        let any = |seed: usize| (mix(seed as u64) >> 11) as f64 / (1_u64 << 53) as f64;
        let place = |i: usize, k: usize| (i / n.pow(k as u32) % n) as f64 + 0.4 * any(i * D + k);
        let length: Vector<D> = Vector::from_element(n as f64);
        let setup = Setup {
            domain: Domain { min: Vector::zeros(), max: length, periodic: [true; D] },
            kernel: KernelKind::Lucy,
            cutoff: 2.2,
            spacing: 1.0,
            particles: (0..n.pow(D as u32))
                .map(|i| Placed { position: Vector::from_fn(|k, _| place(i, k)), volume: 1.0, body: 0 })
                .collect(),
            bodies: vec![Body {
                name: "fluid".to_owned(),
                kind: BodyKind::Fluid { density: 1.0, viscosity: 0.5 },
            }],
            reference_speed: 1.0,
            reference_length: n as f64,
            sound_speed: Some(10.0),
            pressure_scale: None,
            body_force: Vector::zeros(),
            buoyancy: Vector::zeros(),
            sponges: Vec::new(),
            initial_velocity: Vector::zeros(),
            method: Default::default(),
            friction: Default::default(),
            state: Default::default(),
            noise,
            options: Default::default(),
        };
        let mut flow = Flow::new(setup).expect("a sound setup");
        flow.set_velocity(|x| x.map(|x| any(x.to_bits() as usize)));
        let Flow { blocks, terms, kernel, shortest, positions, sides, slopes, .. } = &flow;
        for block in blocks {
            let rows = block.near_solid.len();
            let (mut one, mut two) = (vec![Rates::default(); rows], vec![Rates::default(); rows]);
            let (mut block, mut other) = (block.clone(), block.clone());
            densities(&mut block, &mut one, terms, kernel, shortest, positions, (sides, slopes));
            sweep_densities(&mut other, &mut two, terms, kernel, shortest, positions, (sides, slopes));
            forces(&block, &mut one, terms, kernel, (sides, slopes));
            sweep_forces(&other, &mut two, terms, kernel, (sides, slopes));
            assert!(one.iter().any(|rates| rates.force.norm() > 0.0 && rates.density != 0.0));
            assert_eq!(one, two);
        }
    }

    #[test]
    fn wide_registers_change_no_bit() {
        for noise in [None, Some(Noise { energy: 0.01, seed: 3, realization: 0 })] {
            agree::<1>(30, noise);
            agree::<2>(16, noise);
            agree::<3>(8, noise);
        }
    }
}
