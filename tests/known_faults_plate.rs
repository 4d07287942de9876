//! A plate of 65² particles whose edge is held, with 0.1, 1 and 5 hops per molecule and step: molecules that
//! come from reservoirs of Poisson numbers stay independent Poisson numbers whose mean is the continuous
//! solution. Hop counts drawn at once from all neighbours and clipped at zero gave a variance over mean of 4.6.
//!
//! 600 realizations, all from Poisson numbers of mean 5; the left edge is held at a mean of 20, the others at 5.
//! Given the sum of the 600 counts of a voxel, the index of dispersion s²/mean has the mean one exactly and the
//! variance 2/599 (1 - 1/sum), so the plate mean over 63² voxels has a standard error of 9.2e-4 and the limit of
//! 0.005 stands at 5.4 of them (chance 6e-8). One voxel: 599 s²/mean is chi-square of 599 degrees of freedom
//! nearly; 3 x 3969 voxels and two sides at a chance of 1e-3 in all allow 4.2e-8 each, a normal deviate of 5.36
//! (Wilson & Hilferty 1931), rounded up to 5.6 for the skewness that Poisson numbers of mean 5 have beyond
//! chi-square.

mod chemistry_cases;
use chemistry_cases::*;
use gillesph::chemistry::Reactor;
use gillesph::chemistry::sampling_numbers::poisson;
use gillesph::chemistry::split::{Frozen, SplitState};
use gillesph::fluid::exchange::{Voxels, links};
use gillesph::fluid::weights::Weights;
use gillesph::random::{Purpose, stream};
use gillesph::space::domain::Domain;
use gillesph::space::kernel::{Kernel, KernelKind};
use gillesph::vector::Vector;
use rstest::rstest;

const SIDE: usize = 65;
const REALIZATIONS: u64 = 600;

#[rstest]
fn fano_factor_with_held_edges(#[values((0.1, 60), (1.0, 20), (5.0, 8))] (hops, steps): (f64, u32)) {
    let n = SIDE * SIDE;
    let positions: Vec<Vector<2>> =
        (0..n).map(|i| Vector::<2>::new((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5)).collect();
    let domain =
        Domain { min: Vector::zeros(), max: Vector::from_element(SIDE as f64), periodic: [false; 2] };
    let voxels = Voxels {
        positions: &positions,
        volumes: &vec![1.0; n],
        hosts: &vec![true; n],
        domain: &domain,
        barriers: &[],
        obstacles: &[],
    };
    let mut links = links(&voxels, &Kernel::new(KernelKind::Lucy, 3.0), Weights::Normalised, 1.0);
    links.conductance.iter_mut().for_each(|g| *g *= UNIT);
    let held: Vec<bool> =
        positions.iter().map(|x| x.iter().any(|x| *x < 1.0 || *x > SIDE as f64 - 1.0)).collect();
    let edge: Vec<u32> = (0..n as u32).filter(|&i| held[i as usize]).collect();
    let edge_means: Vec<f64> =
        edge.iter().map(|&i| if positions[i as usize][0] < 1.0 { 20.0 } else { 5.0 }).collect();
    let build = |discrete: bool| {
        let reactor = Reactor::everywhere(&network(&[("A", 1.0)], &[]), &[discrete]);
        let groups = vec![0; n];
        let frozen = Frozen::build(&reactor, &links, &vec![UNIT; n], &groups, &groups, &held).unwrap();
        (reactor, frozen)
    };
    let (reactor, frozen) = build(false);
    let dt = hops / frozen.table(0).unwrap().rate;
    let mut smooth = SplitState::new(&reactor, vec![5.0; n], 0, 0);
    smooth.hold(&edge, 0, &edge_means);
    for _ in 0..steps {
        smooth.diffuse(&reactor, &frozen, 0.0, dt).unwrap();
    }

    let (reactor, frozen) = build(true);
    let (mut sum, mut squares) = (vec![0.0; n], vec![0.0; n]);
    for run in 0..REALIZATIONS {
        let mut random = stream(111, run, Purpose::Deal);
        let start: Vec<f64> = (0..n).map(|_| poisson(&mut random, 5.0) as f64).collect();
        let before: f64 = start.iter().sum();
        let mut state = SplitState::new(&reactor, start, 111, run);
        for _ in 0..steps {
            state.deal_held(&reactor, &edge, 0, &edge_means);
            state.diffuse(&reactor, &frozen, 0.0, dt).unwrap();
        }
        assert_eq!(state.total(0), before + state.supplied[0]);
        for (i, &count) in state.amounts.iter().enumerate() {
            sum[i] += count;
            squares[i] += count * count;
        }
    }
    let runs = REALIZATIONS as f64;
    let freedom = runs - 1.0;
    let inner: Vec<usize> = (0..n).filter(|&i| !held[i]).collect();
    let (mut plate, mut deviation, mut worst, mut furthest) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    for &i in &inner {
        let mean = sum[i] / runs;
        let fano = (squares[i] - sum[i] * mean) / freedom / mean;
        plate += fano / inner.len() as f64;
        let c = 2.0 / (9.0 * freedom);
        worst = worst.max(((fano.cbrt() - 1.0 + c) / c.sqrt()).abs());
        let z = (mean - smooth.amounts[i]) / (smooth.amounts[i] / runs).sqrt();
        furthest = furthest.max(z.abs());
        deviation += z * z;
    }
    // Sum of 3969 squares of normal deviates; 4.5 standard errors (chance 7e-6).
    let deviation = (deviation / inner.len() as f64 - 1.0) / (2.0 / inner.len() as f64).sqrt();
    println!(
        "{hops} hops: Fano factor {plate:.5}, worst voxel {worst:.2}, means {deviation:.2}, furthest {furthest:.2}"
    );
    assert!((plate - 1.0).abs() < 0.005, "plate mean {plate}");
    assert!(worst < 5.6 && furthest < 5.6, "worst voxel {worst}, furthest mean {furthest}");
    assert!(deviation.abs() < 4.5, "means: {deviation}");
}
