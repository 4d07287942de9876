//! The split sampler of particle chemistry. Statistical limits: 4.5 standard errors (chance 7e-6 each),
//! distributions at 1e-4; seeds fixed beforehand.

mod chemistry_cases;
use chemistry_cases::*;
use gillesph::chemistry::split::{Frozen, SplitState, step_bounds};
use gillesph::chemistry::{GroupSet, Links, Reactor};
use proptest::prelude::*;

const LIMIT: f64 = 4.5;

fn still(reactor: &Reactor, links: &Links, volumes: &[f64], held: &[bool]) -> Frozen {
    let groups = vec![0; volumes.len()];
    Frozen::build(reactor, links, volumes, &groups, &groups, held).unwrap()
}

/// A line of `n` voxels of unit volume, conductance `g`.
fn line(n: usize, g: f64) -> Links {
    let pairs: Vec<_> = (1..n).map(|i| (i - 1, i, g)).collect();
    Links::from_pairs(n, &pairs)
}

/// Binomial transient and the 80/20 equilibrium, whatever the step.
#[test]
fn two_voxels_at_any_step() {
    let reactor = discrete(&[("A", 1.0)], &[]);
    let links = Links::from_pairs(2, &[(0, 1, 0.5 * UNIT)]);
    let frozen = still(&reactor, &links, &[UNIT, 0.25 * UNIT], &[]);
    for (time, steps, p) in [(0.5, 1, 0.8573009593720381), (0.5, 7, 0.8573009593720381), (50.0, 1, 0.8)] {
        let mut seen = Vec::new();
        for run in 0..10_000 {
            let mut state = SplitState::new(&reactor, vec![100.0, 0.0], 21, run);
            for _ in 0..steps {
                state.diffuse(&reactor, &frozen, 0.0, time / f64::from(steps)).unwrap();
            }
            assert_eq!(state.total(0), 100.0);
            seen.push(state.amounts[0]);
        }
        assert_mean(&seen, 100.0 * p, 100.0 * p * (1.0 - p), LIMIT, "n0");
        assert_variance(&seen, 100.0 * p * (1.0 - p), binomial_m4(100.0, p), LIMIT, "n0");
        assert_distribution(&seen, &binomial_masses(100, p), "n0");
    }
}

/// The whole of a split step against the master equation: A + B -> 0 with diffusion, volumes 1 and 0.5.
/// At τ = 0.02 the Strang error is of the order (rate τ)² = 1e-4 of the mean, far below 1/100.
#[test]
fn two_voxel_annihilation() {
    let reactor = discrete(&[("A", 0.6), ("B", 0.2)], &[(&[(0, 1), (1, 1)], &[], 0.4)]);
    let frozen = still(&reactor, &Links::from_pairs(2, &[(0, 1, UNIT)]), &[UNIT, 0.5 * UNIT], &[]);
    let mut total = Vec::new();
    for run in 0..10_000 {
        let mut state = SplitState::new(&reactor, vec![6.0, 0.0, 0.0, 4.0], 22, run);
        for k in 0..50 {
            state.step(&reactor, &frozen, 0.02 * f64::from(k), 0.02).unwrap();
        }
        assert_eq!(state.total(0) - state.total(1), 2.0);
        total.push(state.total(1));
    }
    let masses = [
        0.030071343079525244,
        0.20871813770111253,
        0.40666702631346646,
        0.2879858286147126,
        0.06655766429118358,
    ];
    assert_distribution(&total, &masses, "B at 1");
}

/// Slow decay: 100 molecules, 1000 steps of 1e-3 at rate 0.1: 90.48 on average, binomial.
#[test]
fn slow_decay_keeps_its_clock() {
    let reactor = discrete(&[("A", 0.0)], &[(&[(0, 1)], &[], 0.1)]);
    let frozen = still(&reactor, &Links::none(1), &[UNIT], &[]);
    let p = (-0.1_f64).exp();
    let mut seen = Vec::new();
    for run in 0..4000 {
        let mut state = SplitState::new(&reactor, vec![100.0], 23, run);
        for k in 0..1000 {
            state.react(&reactor, &frozen, 1e-3 * f64::from(k), 1e-3).unwrap();
        }
        assert_eq!(state.counters.events as f64, 100.0 - state.amounts[0]);
        seen.push(state.amounts[0]);
    }
    assert_mean(&seen, 100.0 * p, 100.0 * p * (1.0 - p), LIMIT, "left");
    assert_variance(&seen, 100.0 * p * (1.0 - p), binomial_m4(100.0, p), LIMIT, "left");
}

/// Two channels of equal rate that share a reactant end equal, also under diffusion.
#[test]
fn equal_channels_split_equally() {
    let reactor = discrete(
        &[("A", 1.0), ("B", 0.0), ("C", 0.0)],
        &[(&[(0, 1)], &[(1, 1)], 1.0), (&[(0, 1)], &[(2, 1)], 1.0)],
    );
    let n = 10;
    let frozen = still(&reactor, &line(n, UNIT), &vec![UNIT; n], &[]);
    let mut amounts = vec![0.0; 3 * n];
    amounts[0] = 100_000.0;
    let mut state = SplitState::new(&reactor, amounts, 24, 0);
    for k in 0..300 {
        state.step(&reactor, &frozen, 0.1 * f64::from(k), 0.1).unwrap();
    }
    assert_eq!(state.total(0) + state.total(1) + state.total(2), 100_000.0);
    // Binomial(100 000, 1/2): standard error 158.
    assert!((state.total(1) - 50_000.0).abs() < 4.5 * 158.2);
}

/// A lattice between two held edges: mean = the continuous solution, variance = mean, and the books balance.
/// Held at a fixed count and dealt Poisson.
#[test]
fn held_edges_keep_the_interior_poisson() {
    let reactor = discrete(&[("A", 1.0)], &[(&[(0, 1)], &[], 0.1)]);
    let n = 9;
    let mut held = vec![false; n];
    (held[0], held[n - 1]) = (true, true);
    let links = line(n, UNIT);
    let frozen = still(&reactor, &links, &vec![UNIT; n], &held);
    let smooth = Reactor::everywhere(&network(&[("A", 1.0)], &[(&[(0, 1)], &[], 0.1)]), &[false]);
    let mut start = vec![0.0; n];
    (start[0], start[n - 1]) = (12.0, 3.0);
    let (steps, dt) = (12, 0.5);
    let mut expected = SplitState::new(&smooth, start.clone(), 0, 0);
    for k in 0..steps {
        expected
            .step(&smooth, &still(&smooth, &links, &vec![UNIT; n], &held), dt * f64::from(k), dt)
            .unwrap();
    }
    for dealt in [false, true] {
        let mut seen = vec![Vec::new(); n];
        for run in 0..10_000 {
            let mut state = SplitState::new(&reactor, start.clone(), 25, run);
            for k in 0..steps {
                state.react(&reactor, &frozen, 0.0, 0.5 * dt).unwrap();
                if dealt {
                    state.deal_held(&reactor, &[0, n as u32 - 1], 0, &[12.0, 3.0]);
                }
                state.diffuse(&reactor, &frozen, dt * f64::from(k), dt).unwrap();
                state.react(&reactor, &frozen, 0.0, 0.5 * dt).unwrap();
            }
            let decayed = state.counters.events as f64;
            assert_eq!(state.total(0), 15.0 + state.supplied[0] - decayed);
            seen.iter_mut().zip(&state.amounts).for_each(|(x, &a)| x.push(a));
        }
        for (i, x) in seen.iter().enumerate().take(n - 1).skip(1) {
            let mu = expected.amounts[i];
            assert_mean(x, mu, mu, LIMIT, &format!("voxel {i}, dealt {dealt}"));
            assert_variance(x, mu, poisson_m4(mu), LIMIT, &format!("voxel {i}, dealt {dealt}"));
            assert_distribution(x, &poisson_masses(mu, 60), &format!("voxel {i}, dealt {dealt}"));
        }
    }
}

/// Diffusion between a reservoir of 1000 molecules and an empty one (17 particles of spacing 1/16, κ = 0.1,
/// t = 1; with a Lucy kernel of h = 1.8 Δ only nearest neighbours meet): the mean of the semi-discrete scheme,
/// by its matrix exponential, and Poisson around it. Both for molecules and for continuous amounts.
#[test]
fn line_between_reservoirs() {
    let mean_over_1000 = [
        1.0,
        0.8887519004290038,
        0.7796610360272388,
        0.6747573855787941,
        0.575828443639542,
        0.48432636973678295,
        0.401304797836714,
        0.32738866651985754,
        0.2627763024064995,
        0.20726930531975077,
        0.16032307083208033,
        0.12110936679240018,
        0.08858233867659458,
        0.061540513692240735,
        0.03867949436636421,
        0.01863267028672595,
        0.0,
    ];
    let n = 17;
    let mut held = vec![false; n];
    (held[0], held[n - 1]) = (true, true);
    let mut start = vec![0.0; n];
    start[0] = 1000.0;
    let (links, volumes) = (line(n, 16.0 * UNIT), vec![UNIT / 16.0; n]); // rate κ/Δ² = 25.6 /s each way
    let smooth = Reactor::everywhere(&network(&[("A", 0.1)], &[]), &[false]);
    let frozen = still(&smooth, &links, &volumes, &held);
    let mut state = SplitState::new(&smooth, start.clone(), 0, 0);
    (0..3).for_each(|_| state.diffuse(&smooth, &frozen, 0.0, 1.0 / 3.0).unwrap());
    for (a, m) in state.amounts.iter().zip(mean_over_1000) {
        assert!((a - 1000.0 * m).abs() < 1e-9, "{a} {m}"); // rounding of some hundred terms
    }
    let reactor = discrete(&[("A", 0.1)], &[]);
    let mut seen = vec![Vec::new(); n];
    for run in 0..2000 {
        let mut state = SplitState::new(&reactor, start.clone(), 31, run);
        (0..10).for_each(|_| state.diffuse(&reactor, &frozen, 0.0, 0.1).unwrap());
        assert_eq!(state.total(0), 1000.0 + state.supplied[0]);
        seen.iter_mut().zip(&state.amounts).for_each(|(x, &a)| x.push(a));
    }
    for (x, m) in seen.iter().zip(mean_over_1000).take(n - 1).skip(1) {
        let mu = 1000.0 * m;
        assert_mean(x, mu, mu, LIMIT, "line");
        assert_variance(x, mu, poisson_m4(mu), LIMIT, "line");
    }
}

/// Random graphs, volumes and steps: whole counts, nothing below zero, books that balance to the molecule.
#[test]
fn books_balance_on_random_graphs() {
    proptest!(ProptestConfig::with_cases(64), |(
        volumes in proptest::collection::vec(0.01_f64..10.0, 6),
        pairs in proptest::collection::vec((0_usize..6, 0_usize..6, 0.0_f64..5.0), 1..12),
        counts in proptest::collection::vec(0_u32..2000, 18),
        held in proptest::collection::vec(proptest::bool::weighted(0.15), 18),
        dt in 1e-4_f64..2.0,
        seed in 0_u64..1000,
    )| {
        let reactor = discrete(
            &[("A", 1.0), ("B", 0.3), ("C", 0.0)],
            &[(&[(0, 1), (1, 1)], &[(2, 1)], 1e-3), (&[(2, 1)], &[(0, 1), (1, 1)], 0.5)],
        );
        let volumes: Vec<f64> = volumes.iter().map(|v| v * UNIT).collect();
        let pairs: Vec<_> =
            pairs.into_iter().filter(|(i, j, _)| i != j).map(|(i, j, g)| (i, j, g * UNIT)).collect();
        let frozen = still(&reactor, &Links::from_pairs(6, &pairs), &volumes, &held);
        let start: Vec<f64> = counts.into_iter().map(f64::from).collect();
        let mut state = SplitState::new(&reactor, start.clone(), seed, 0);
        let laws = |state: &SplitState, k: usize| state.total(k) + state.total(2);
        let before = [laws(&state, 0), laws(&state, 1)];
        for _ in 0..5 {
            state.step(&reactor, &frozen, 0.0, dt).unwrap();
            for (slot, &a) in state.amounts.iter().enumerate() {
                prop_assert!(a >= 0.0 && a.fract() == 0.0);
                prop_assert!(!held[slot] || a == start[slot]);
            }
            for (k, first) in before.into_iter().enumerate() {
                prop_assert_eq!(laws(&state, k), first + state.supplied[k] + state.supplied[2]);
            }
        }
    });
}

/// A sponge turns any count into Poisson of its target.
#[test]
fn sponge_is_exact() {
    let reactor = discrete(&[("A", 0.0)], &[]);
    let frozen = still(&reactor, &Links::none(1), &[UNIT], &[]);
    let mut seen = Vec::new();
    for run in 0..10_000 {
        let mut state = SplitState::new(&reactor, vec![50.0], 26, run);
        for _ in 0..4 {
            state.sponge((&reactor, &frozen), &[0], 0, (2.0, &[8.0]), 0.1);
        }
        assert_eq!(state.amounts[0], 50.0 + state.supplied[0]);
        seen.push(state.amounts[0]);
    }
    // Survivors Binomial(50, q) and Poisson(8 (1 - q)), q = e^{-0.8}.
    let q = (-0.8_f64).exp();
    let (mu, var) = (50.0 * q + 8.0 * (1.0 - q), 50.0 * q * (1.0 - q) + 8.0 * (1.0 - q));
    let third = 3.0 * var * var + var; // fourth central moment, to a few per cent
    assert_mean(&seen, mu, var, LIMIT, "sponge");
    assert_variance(&seen, var, third, LIMIT, "sponge");
}

/// Species stay where they may live, and reactions where they happen.
#[test]
fn groups_bound_species_and_reactions() {
    let network = network(&[("A", 1.0), ("B", 1.0)], &[(&[(0, 1)], &[(1, 1)], 1.0)]);
    let reactor = Reactor::new(&network, &[true; 2], &[GroupSet(0b011), GroupSet::ALL], &[GroupSet(0b100)]);
    let home = [0, 1, 2];
    let frozen = Frozen::build(&reactor, &line(3, UNIT), &[UNIT; 3], &home, &home, &[]).unwrap();
    let mut state = SplitState::new(&reactor, vec![100.0, 0.0, 0.0, 0.0, 0.0, 0.0], 27, 0);
    for _ in 0..50 {
        state.step(&reactor, &frozen, 0.0, 0.2).unwrap();
    }
    assert!(state.amounts[4] == 0.0 && state.total(0) == 100.0);
    // Passing zone 2 lets the reaction happen in voxel 1.
    let frozen = Frozen::build(&reactor, &line(3, UNIT), &[UNIT; 3], &home, &[0, 2, 2], &[]).unwrap();
    for _ in 0..500 {
        state.step(&reactor, &frozen, 0.0, 0.2).unwrap();
    }
    assert!(state.amounts[4] == 0.0 && state.total(0) == 0.0 && state.total(1) == 100.0);
}

/// Continuous A + B -> 0 with diffusion: the error of Strang splitting falls with the square of the step.
#[test]
fn strang_is_second_order() {
    let net = network(&[("A", 1.0), ("B", 0.5)], &[(&[(0, 1), (1, 1)], &[], 0.3)]);
    let reactor = Reactor::everywhere(&net, &[false, false]);
    let n = 12;
    let frozen = still(&reactor, &line(n, UNIT), &vec![UNIT; n], &[]);
    let start: Vec<f64> = (0..n).flat_map(|i| [10.0 - 0.8 * i as f64, 0.5 + 0.9 * i as f64]).collect();
    let solve = |steps: u32| {
        let mut state = SplitState::new(&reactor, start.clone(), 0, 0);
        let dt = 1.0 / f64::from(steps);
        for k in 0..steps {
            state.step(&reactor, &frozen, dt * f64::from(k), dt).unwrap();
        }
        assert!(state.amounts.iter().all(|&a| a > 0.0));
        state.amounts
    };
    let reference = solve(1280);
    let error = |steps| {
        let n = solve(steps);
        n.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    let (coarse, middle, fine) = (error(20), error(40), error(80));
    for order in [(coarse / middle).log2(), (middle / fine).log2()] {
        assert!((order - 2.0).abs() < 0.2, "order {order}");
    }
}

/// A discrete receptor and a continuous ligand: whole molecules change hands, and their sum stays.
#[test]
fn hybrid_conserves_and_agrees() {
    let net = network(
        &[("L", 1.0), ("R", 0.0), ("RL", 0.0)],
        &[(&[(0, 1), (1, 1)], &[(2, 1)], 0.01), (&[(2, 1)], &[(0, 1), (1, 1)], 1.0), (&[(0, 1)], &[], 0.05)],
    );
    let reactor = Reactor::everywhere(&net, &[false, true, true]);
    let frozen = still(&reactor, &line(2, UNIT), &[UNIT; 2], &[]);
    let run = |seed| {
        let mut state = SplitState::new(&reactor, vec![300.0, 20.0, 0.0, 0.0, 20.0, 0.0], 28, seed);
        for k in 0..100 {
            state.step(&reactor, &frozen, 0.02 * f64::from(k), 0.02).unwrap();
        }
        state
    };
    let mut bound = Vec::new();
    for seed in 0..2000 {
        let state = run(seed);
        for row in state.amounts.chunks(3) {
            assert!(row[1] + row[2] == 20.0 && row[2].fract() == 0.0 && row[0] >= 0.0);
        }
        bound.push(state.total(2));
    }
    // All continuous: the mean-field answer; with about 150 ligands per voxel the covariance of R and L moves
    // the mean by well under one molecule in 24.
    let smooth = Reactor::everywhere(&net, &[false; 3]);
    let frozen = still(&smooth, &line(2, UNIT), &[UNIT; 2], &[]);
    let mut state = SplitState::new(&smooth, vec![300.0, 20.0, 0.0, 0.0, 20.0, 0.0], 0, 0);
    for k in 0..100 {
        state.step(&smooth, &frozen, 0.02 * f64::from(k), 0.02).unwrap();
    }
    assert!((mean(&bound) - state.total(2)).abs() < 0.5, "{} {}", mean(&bound), state.total(2));
}

#[test]
fn bounds_name_what_limits() {
    let reactor = discrete(&[("A", 2.0), ("B", 0.0)], &[(&[(0, 1), (1, 1)], &[(1, 1)], 0.5)]);
    let frozen = still(&reactor, &line(3, UNIT), &[UNIT; 3], &[]);
    let bounds = step_bounds(&reactor, &frozen, &[4.0, 10.0, 0.0, 0.0, 0.0, 30.0], 0.5, 0.1);
    // Λ = 2 D = 4 /s; A is lost at 0.5 * 30 = 15 /s in voxel 2.
    assert!((bounds.hops - 0.125).abs() < 1e-12 && (bounds.reactions - 0.1 / 15.0).abs() < 1e-12);
    assert!(bounds.limited_by().contains("voxel 2") && bounds.step() == bounds.reactions);
}

/// A run cut in two goes on as if it had not been.
#[test]
fn resumed_runs_are_the_same() {
    let reactor = discrete(&[("A", 1.0)], &[(&[(0, 1)], &[], 0.3), (&[], &[(0, 1)], 2.0)]);
    let mut held = vec![false; 5];
    held[0] = true;
    let frozen = still(&reactor, &line(5, UNIT), &[UNIT; 5], &held);
    let play = |state: &mut SplitState| {
        for _ in 0..20 {
            state.step(&reactor, &frozen, 0.0, 0.1).unwrap();
        }
    };
    let mut whole = SplitState::new(&reactor, vec![0.0; 5], 29, 3);
    whole.deal_held(&reactor, &[0], 0, &[7.0]);
    play(&mut whole);
    let cut = whole.snapshot();
    play(&mut whole);
    let mut second = SplitState::resume(&reactor, cut.clone()).unwrap();
    play(&mut second);
    assert_eq!(whole.snapshot(), second.snapshot());
    assert_ne!(whole.snapshot(), cut);
    let other = discrete(&[("A", 1.0), ("B", 0.0)], &[]);
    assert!(SplitState::resume(&other, cut).is_none());
}

/// What the numbers must not do is an error that says where.
#[test]
fn impossible_numbers_are_errors() {
    let reactor = discrete(&[("A", 1.0)], &[(&[(0, 1)], &[], -1.0)]);
    let frozen = still(&reactor, &line(2, UNIT), &[UNIT; 2], &[]);
    let mut state = SplitState::new(&reactor, vec![0.0, 3.0], 30, 0);
    let message = state.react(&reactor, &frozen, 0.0, 0.1).unwrap_err().to_string();
    assert!(message.contains("voxel 1") && message.contains("A = 3"), "{message}");
    state.amounts[0] = -1.0;
    assert!(state.diffuse(&reactor, &frozen, 0.0, 0.1).unwrap_err().to_string().contains("below zero"));
    let negative = line(2, -UNIT);
    let built = Frozen::build(&reactor, &negative, &[UNIT; 2], &[0, 0], &[0, 0], &[]);
    assert!(built.unwrap_err().to_string().contains("conductance"));
}

/// Time of the pheromone-like load: 1500 voxels of 28 neighbours, 1600 molecules each, 20 realizations of
/// 400 steps, and the same at nanomolar counts. For the record; run with --ignored --nocapture.
#[test]
#[ignore = "timing"]
fn timing() {
    let reactor = discrete(&[("L", 1.0)], &[]);
    let (nx, ny) = (50_i64, 30_i64);
    let mut pairs = Vec::new();
    for (i, j) in (0..nx * ny).flat_map(|i| (0..nx * ny).map(move |j| (i, j))).filter(|(i, j)| i < j) {
        let (dx, dy) = ((i % nx - j % nx) as f64, (i / nx - j / nx) as f64);
        let r = (dx * dx + dy * dy).sqrt();
        if r < 3.01 {
            pairs.push((i as usize, j as usize, UNIT * (3.2 - r).powi(2)));
        }
    }
    let links = Links::from_pairs((nx * ny) as usize, &pairs);
    let volumes = vec![UNIT; (nx * ny) as usize];
    let begin = std::time::Instant::now();
    for _ in 0..50 {
        std::hint::black_box(still(&reactor, &links, &volumes, &[]));
    }
    println!("build {:.3} ms", begin.elapsed().as_secs_f64() * 20.0);
    let frozen = still(&reactor, &links, &volumes, &[]);
    let rate = frozen.table(0).unwrap().rate;
    for (count, jumps) in [(1600.0, 0.05), (1600.0, 0.2), (1600.0, 0.5), (3.0, 0.2), (0.0, 0.2)] {
        let mut state = SplitState::new(&reactor, vec![count; volumes.len()], 1, 0);
        let begin = std::time::Instant::now();
        for _ in 0..100 {
            state.diffuse(&reactor, &frozen, 0.0, jumps / rate).unwrap();
        }
        let step = begin.elapsed().as_secs_f64() / 100.0;
        println!(
            "{count} per voxel, {jumps} jumps: {:.3} ms a step, 8000 steps {:.1} s",
            step * 1e3,
            step * 8e3
        );
    }
    let reactor = discrete(
        &[("L", 1.0), ("R", 0.0), ("RL", 0.0)],
        &[(&[(0, 1), (1, 1)], &[(2, 1)], 1e-3), (&[(2, 1)], &[(0, 1), (1, 1)], 1.0)],
    );
    let frozen = still(&reactor, &links, &volumes, &[]);
    for (ligands, receptors) in [(1600.0, 1600.0), (1.0, 3.0)] {
        let start = [ligands, receptors, 0.0].repeat(volumes.len());
        let mut state = SplitState::new(&reactor, start, 1, 0);
        let begin = std::time::Instant::now();
        for k in 0..100 {
            state.react(&reactor, &frozen, 0.001 * f64::from(k), 0.001).unwrap();
        }
        let (step, events) = (begin.elapsed().as_secs_f64() / 100.0, state.counters.events);
        println!(
            "reactions of {ligands}: {:.3} ms a step, {events} events, 16000 steps {:.1} s",
            step * 1e3,
            step * 16e3
        );
    }
}
