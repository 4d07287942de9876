//! Two equal channels that compete for one reactant, under diffusion of different strength. In programs that
//! let diffusion enter the choice of a reaction they fired 8041 to 603 times.

mod chemistry_cases;
use chemistry_cases::*;
use gillesph::chemistry::Links;
use gillesph::chemistry::split::{Frozen, SplitState};
use rstest::rstest;

/// A -> B and A -> C at equal rates on a square of 8 x 8 voxels, 200 000 molecules of A in one corner; B and C
/// stay where they are made. B among all is Binomial(200 000, 1/2): standard error 224, 4.5 of them allowed
/// (chance 7e-6). In each voxel that holds n of B and C, (B - C)²/n has the mean one; the sum over the voxels is
/// chi-square, as a normal deviate below 3.72 (chance 1e-4; Wilson & Hilferty 1931).
#[rstest]
fn equal_channels_fire_equally(#[values(0.0, 1.0, 10.0)] diffusivity: f64, #[values(0.02, 0.5)] step: f64) {
    const SIDE: usize = 8;
    const MOLECULES: f64 = 200_000.0;
    let reactor = discrete(
        &[("A", diffusivity), ("B", 0.0), ("C", 0.0)],
        &[(&[(0, 1)], &[(1, 1)], 1.0), (&[(0, 1)], &[(2, 1)], 1.0)],
    );
    let n = SIDE * SIDE;
    let right = (0..n).filter(|i| i % SIDE + 1 < SIDE).map(|i| (i, i + 1, UNIT));
    let up = (0..n - SIDE).map(|i| (i, i + SIDE, UNIT));
    let links = Links::from_pairs(n, &right.chain(up).collect::<Vec<_>>());
    let groups = vec![0; n];
    let frozen = Frozen::build(&reactor, &links, &vec![UNIT; n], &groups, &groups, &[]).unwrap();
    // Another realization for each case.
    let mut amounts = vec![0.0; 3 * n];
    amounts[0] = MOLECULES;
    let mut state = SplitState::new(&reactor, amounts, 131, (10.0 * diffusivity + 100.0 * step) as u64);
    let mut time = 0.0;
    while state.total(0) > 0.0 {
        state.step(&reactor, &frozen, time, step).unwrap();
        time += step;
        assert_eq!(state.total(0) + state.total(1) + state.total(2), MOLECULES);
    }
    let made = state.total(1);
    assert_eq!(state.fired[0] as f64, made);
    let z = (made - 0.5 * MOLECULES) / (0.25 * MOLECULES).sqrt();
    let (mut square, mut voxels) = (0.0, 0.0);
    for row in state.amounts.chunks(3).filter(|row| row[1] + row[2] >= 20.0) {
        square += (row[1] - row[2]).powi(2) / (row[1] + row[2]);
        voxels += 1.0;
    }
    let c = 2.0 / (9.0 * voxels);
    let shape = ((square / voxels).cbrt() - 1.0 + c) / c.sqrt();
    println!(
        "D {diffusivity}, step {step}: {made} of {MOLECULES}, {z:.2} errors; {voxels} voxels {shape:.2}"
    );
    assert!(z.abs() < 4.5, "{made} of {MOLECULES}");
    assert!((voxels > 1.0) == (diffusivity > 0.0) && shape < 3.72, "{voxels}: {shape}");
}
