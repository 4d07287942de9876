//! The event-driven methods against exact answers of the master equation (matrix exponential over the full
//! state space, or the closed form named). 10 000 realizations each, seeds fixed beforehand. Limits: mean 4.5
//! standard errors, variance 4.5 (chance 7e-6 each, some 40 quantities), distributions at 1e-4.

mod chemistry_cases;
use chemistry_cases::*;
use gillesph::chemistry::split::{Frozen, SplitState};
use gillesph::chemistry::ssa::{
    CompositionRejection, Direct, EventMethod, NextReaction, NextSubvolume, System,
};
use gillesph::chemistry::{Links, Reactor};
use rstest::rstest;

const RUNS: u64 = 10_000;
const LIMIT: f64 = 4.5;

/// Every exact method; all play the same cases, on one voxel or on many.
#[derive(Clone, Copy, Debug)]
enum Method {
    Direct,
    NextReaction,
    CompositionRejection,
    NextSubvolume,
}

use Method::{CompositionRejection as Composition, Direct as D, NextReaction as Next, NextSubvolume as Sub};

impl Method {
    fn start<'a>(
        self,
        system: &'a System<'a>,
        amounts: Vec<f64>,
        key: (u64, u64),
    ) -> Box<dyn EventMethod + 'a> {
        match self {
            D => Box::new(Direct::new(system, amounts, key).unwrap()),
            Next => Box::new(NextReaction::new(system, amounts, key).unwrap()),
            Composition => Box::new(CompositionRejection::new(system, amounts, key).unwrap()),
            Sub => Box::new(NextSubvolume::new(system, amounts, key).unwrap()),
        }
    }
}

fn frozen(reactor: &Reactor, volumes: &[f64], links: &Links, held: &[bool]) -> Frozen {
    let groups = vec![0; volumes.len()];
    Frozen::build(reactor, links, volumes, &groups, &groups, held).unwrap()
}

/// A + B <-> C in volume 2, k = 0.05 and 0.5, from 20, 15, 0: moments of C.
#[rstest]
fn abc_equilibrium(#[values(D, Next, Composition, Sub)] method: Method) {
    let reactor = discrete(
        &[("A", 0.0), ("B", 0.0), ("C", 0.0)],
        &[(&[(0, 1), (1, 1)], &[(2, 1)], 0.05), (&[(2, 1)], &[(0, 1), (1, 1)], 0.5)],
    );
    let exact = [
        (0.5, 2.7545945468528674, 1.9795840705393144, 11.620575551140437),
        (2.0, 5.546622111962481, 2.8025063713370106, 22.80934171789236),
        (100.0, 6.208472311836137, 2.920848704169106, 24.775906574425647),
    ];
    let at_two = [
        0.0003699081278387531,
        0.004549724636297825,
        0.024672547236985407,
        0.07802067586927992,
        0.16036842256970874,
        0.226125570763074,
        0.22502756058897744,
        0.1601836563851218,
        0.08179731087180024,
        0.02977980124253804,
        0.0076116510289414374,
        0.0013299422858473768,
        0.0001521907533961511,
        1.063261523416683e-05,
        3.9908372818588744e-07,
        5.941231983666541e-09,
    ];
    let still = frozen(&reactor, &[2.0 * UNIT], &Links::none(1), &[]);
    let system = System::new(&reactor, &still);
    let mut seen = vec![Vec::new(); exact.len()];
    for run in 0..RUNS {
        let mut method = method.start(&system, vec![20.0, 15.0, 0.0], (1, run));
        for (k, (time, ..)) in exact.iter().enumerate() {
            method.advance(*time).unwrap();
            let n = method.amounts();
            assert!(n[0] + n[2] == 20.0 && n[1] + n[2] == 15.0);
            seen[k].push(n[2]);
        }
    }
    for (x, &(time, mu, var, m4)) in seen.iter().zip(&exact) {
        assert_mean(x, mu, var, LIMIT, &format!("C at {time}"));
        assert_variance(x, var, m4, LIMIT, &format!("C at {time}"));
    }
    assert_distribution(&seen[1], &at_two, "C at 2");
}

/// A + B -> 0, k = 0.1, 12 and 10 molecules in volume 1: moments of B, distribution at t = 1.
#[rstest]
fn annihilation(#[values(D, Next, Composition, Sub)] method: Method) {
    let reactor = discrete(&[("A", 0.0), ("B", 0.0)], &[(&[(0, 1), (1, 1)], &[], 0.1)]);
    let exact = [
        (0.25, 7.62737840345104, 1.5072565431836495, 6.540612816599039),
        (1.0, 4.204201816694759, 1.5775308883286263, 7.267346059510668),
        (4.0, 1.0530026746104069, 0.6133149489217058, 1.07234430727911),
    ];
    let at_one = [
        0.00046637610268794155,
        0.010189977341159655,
        0.06955345389099699,
        0.20773527144782236,
        0.31225807711045317,
        0.2531176784645705,
        0.11403416544307352,
        0.028550468897576887,
        0.003836784405289309,
        0.00025160268401626894,
        6.144212353328199e-06,
    ];
    let still = frozen(&reactor, &[UNIT], &Links::none(1), &[]);
    let system = System::new(&reactor, &still);
    let mut seen = vec![Vec::new(); exact.len()];
    for run in 0..RUNS {
        let mut method = method.start(&system, vec![12.0, 10.0], (2, run));
        for (k, (time, ..)) in exact.iter().enumerate() {
            method.advance(*time).unwrap();
            seen[k].push(method.amounts()[1]);
        }
    }
    for (x, &(time, mu, var, m4)) in seen.iter().zip(&exact) {
        assert_mean(x, mu, var, LIMIT, &format!("B at {time}"));
        assert_variance(x, var, m4, LIMIT, &format!("B at {time}"));
    }
    assert_distribution(&seen[1], &at_one, "B at 1");
}

/// 50 receptors, ligand held at 0.33, ka = kb = 0.4: RL ~ Binomial(50, p(t)).
#[rstest]
fn receptor_occupancy_at_held_ligand(#[values(D, Next, Composition, Sub)] method: Method) {
    // 33 ligands in volume 100 with 50 receptors there: k_on is the 0.4 of the reference.
    let reactor = discrete(
        &[("L", 0.0), ("R", 0.0), ("RL", 0.0)],
        &[(&[(0, 1), (1, 1)], &[(2, 1)], 0.4), (&[(2, 1)], &[(0, 1), (1, 1)], 0.4)],
    );
    let held = [true, false, false];
    let exact = [(1.0, 0.1023672564403814), (2.0, 0.1625007449892356), (50.0, 0.24812030075118396)];
    let still = frozen(&reactor, &[100.0 * UNIT], &Links::none(1), &held);
    let system = System::new(&reactor, &still);
    let mut seen = vec![Vec::new(); exact.len()];
    for run in 0..RUNS {
        let mut method = method.start(&system, vec![33.0, 50.0, 0.0], (3, run));
        for (k, (time, _)) in exact.iter().enumerate() {
            method.advance(*time).unwrap();
            let n = method.amounts();
            assert!(n[0] == 33.0 && n[1] + n[2] == 50.0 && method.ledger().supplied[0] == n[2]);
            seen[k].push(n[2]);
        }
    }
    for (x, &(time, p)) in seen.iter().zip(&exact) {
        assert_mean(x, 50.0 * p, 50.0 * p * (1.0 - p), LIMIT, &format!("RL at {time}"));
        assert_variance(x, 50.0 * p * (1.0 - p), binomial_m4(50.0, p), LIMIT, &format!("RL at {time}"));
        assert_distribution(x, &binomial_masses(50, p), &format!("RL at {time}"));
    }
}

/// 100 molecules in volumes 1 and 0.25, g = 0.5: Binomial(100, p(t)), 80/20 in the end.
#[rstest]
fn two_voxel_diffusion(#[values(D, Next, Composition, Sub)] method: Method) {
    let reactor = discrete(&[("A", 1.0)], &[]);
    let links = Links::from_pairs(2, &[(0, 1, 0.5 * UNIT)]);
    let volumes = [UNIT, 0.25 * UNIT];
    let exact = [(0.1, 0.955760156614281), (0.5, 0.8573009593720381), (5.0, 0.8000007453306345)];
    let still = frozen(&reactor, &volumes, &links, &[]);
    let system = System::new(&reactor, &still);
    let mut seen = vec![Vec::new(); exact.len()];
    for run in 0..RUNS {
        let mut method = method.start(&system, vec![100.0, 0.0], (4, run));
        for (k, (time, _)) in exact.iter().enumerate() {
            method.advance(*time).unwrap();
            assert_eq!(method.amounts().iter().sum::<f64>(), 100.0);
            seen[k].push(method.amounts()[0]);
        }
    }
    for (x, &(time, p)) in seen.iter().zip(&exact) {
        assert_mean(x, 100.0 * p, 100.0 * p * (1.0 - p), LIMIT, &format!("n0 at {time}"));
        assert_variance(x, 100.0 * p * (1.0 - p), binomial_m4(100.0, p), LIMIT, &format!("n0 at {time}"));
        assert_distribution(x, &binomial_masses(100, p), &format!("n0 at {time}"));
    }
}

/// 0 -> X at 10 V, X -> 0 at 0.5, four unequal volumes: independent Poisson, flat concentration.
#[rstest]
fn birth_death_diffusion(#[values(D, Next, Composition, Sub)] method: Method) {
    let reactor = discrete(&[("X", 1.0)], &[(&[], &[(0, 1)], 10.0), (&[(0, 1)], &[], 0.5)]);
    let links = Links::from_pairs(4, &[(0, 1, UNIT), (1, 2, 0.3 * UNIT), (2, 3, 2.0 * UNIT)]);
    let sizes = [1.0, 0.5, 2.0, 0.25];
    let volumes = sizes.map(|v| v * UNIT);
    let still = frozen(&reactor, &volumes, &links, &[]);
    let system = System::new(&reactor, &still);
    for (time, seed) in [(1.0, 5), (20.0, 6)] {
        let mut seen = vec![Vec::new(); 4];
        for run in 0..RUNS {
            let mut method = method.start(&system, vec![0.0; 4], (seed, run));
            method.advance(time).unwrap();
            seen.iter_mut().zip(method.amounts()).for_each(|(x, &n)| x.push(n));
        }
        for (i, x) in seen.iter().enumerate() {
            let mu = sizes[i] * 20.0 * (1.0 - (-0.5 * time).exp());
            assert_mean(x, mu, mu, LIMIT, &format!("voxel {i} at {time}"));
            assert_variance(x, mu, poisson_m4(mu), LIMIT, &format!("voxel {i} at {time}"));
            assert_distribution(x, &poisson_masses(mu, 120), &format!("voxel {i} at {time}"));
        }
        // No correlation between voxels: standard error of the coefficient 0.01.
        let (a, b) = (&seen[0], &seen[1]);
        let (ma, mb) = (mean(a), mean(b));
        let covariance = a.iter().zip(b).map(|(x, y)| (x - ma) * (y - mb)).sum::<f64>() / RUNS as f64;
        assert!((covariance / (variance(a) * variance(b)).sqrt()).abs() < 0.045);
    }
}

/// A + B -> 0 with diffusion in volumes 1 and 0.5, A and B starting apart (85 states).
/// Time, then mean, variance and fourth central moment of A0, A1, B0, B1.
type Moments = (f64, [f64; 4], [f64; 4], [f64; 4]);
const APART: [Moments; 3] = [
    (
        0.5,
        [4.46470641153805, 0.6783103099679232, 0.4000722194142978, 2.742944502091676],
        [1.1180316122273821, 0.5961353764574444, 0.35783251134669214, 0.8514650804222991],
        [3.588090045791495, 1.2851498748357941, 0.5411256229480633, 1.930434122357404],
    ),
    (
        1.0,
        [3.3884561859496354, 0.7637841473872831, 0.44562404406393574, 1.7066162892729821],
        [1.3404251338185187, 0.6409805204066169, 0.38330227230480357, 0.9615065804619324],
        [4.918601216714376, 1.3689409165982755, 0.5583555311415782, 2.346755977026197],
    ),
    (
        3.0,
        [1.7260126123445498, 0.749566939707972, 0.2072221734302513, 0.2683573786222682],
        [0.7562113121452106, 0.5483315857609129, 0.18120662967663026, 0.24351805265513088],
        [1.655185200833758, 0.8482006014154094, 0.1664642521412256, 0.3054453528807444],
    ),
];

#[rstest]
fn two_voxel_annihilation(#[values(D, Next, Composition, Sub)] method: Method) {
    let reactor = discrete(&[("A", 0.6), ("B", 0.2)], &[(&[(0, 1), (1, 1)], &[], 0.4)]);
    let links = Links::from_pairs(2, &[(0, 1, UNIT)]);
    let volumes = [UNIT, 0.5 * UNIT];
    let still = frozen(&reactor, &volumes, &links, &[]);
    let system = System::new(&reactor, &still);
    let mut seen = vec![vec![Vec::new(); 4]; 3];
    let mut total = Vec::new();
    for run in 0..RUNS {
        let mut method = method.start(&system, vec![6.0, 0.0, 0.0, 4.0], (7, run));
        for (k, (time, ..)) in APART.iter().enumerate() {
            method.advance(*time).unwrap();
            let n = method.amounts();
            for (x, slot) in seen[k].iter_mut().zip([0, 2, 1, 3]) {
                x.push(n[slot]);
            }
            if k == 1 {
                total.push(n[1] + n[3]);
            }
        }
    }
    for (k, (time, mu, var, m4)) in APART.iter().enumerate() {
        for q in 0..4 {
            assert_mean(&seen[k][q], mu[q], var[q], LIMIT, &format!("quantity {q} at {time}"));
            assert_variance(&seen[k][q], var[q], m4[q], LIMIT, &format!("quantity {q} at {time}"));
        }
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

/// What is seen does not depend on when one looks.
#[rstest]
fn course_is_independent_of_output_times(
    #[values(D, Next, Composition, Sub)] method: Method,
    #[values(1, 2)] voxels: usize,
) {
    let reactor = discrete(&[("X", 1.0)], &[(&[], &[(0, 1)], 10.0), (&[(0, 1)], &[], 0.5)]);
    let links = if voxels == 1 { Links::none(1) } else { Links::from_pairs(2, &[(0, 1, UNIT)]) };
    let still = frozen(&reactor, &vec![UNIT; voxels], &links, &[]);
    let system = System::new(&reactor, &still);
    let run = |times: &[f64]| {
        let mut method = method.start(&system, vec![0.0; voxels], (8, 0));
        times.iter().for_each(|&t| method.advance(t).unwrap());
        (method.amounts().to_vec(), method.ledger().counters, method.time())
    };
    assert_eq!(run(&[10.0]), run(&[0.1, 0.2, 3.0, 3.0, 9.99, 10.0]));
}

/// Two equal channels A -> B and A -> C fire equally often, however fast A hops meanwhile. 4000 molecules that
/// all react: B ~ Binomial(4000, 1/2), standard deviation 31.6, five of them allowed (chance 6e-7 each).
#[rstest]
fn equal_channels_split_equally(
    #[values(D, Next, Composition, Sub)] method: Method,
    #[values(0.0, 1.0, 10.0)] diffusivity: f64,
) {
    let species = [("A", diffusivity), ("B", 0.0), ("C", 0.0)];
    let reactor = discrete(&species, &[(&[(0, 1)], &[(1, 1)], 1.0), (&[(0, 1)], &[(2, 1)], 1.0)]);
    let links = Links::from_pairs(5, &[(0, 1, UNIT), (1, 2, UNIT), (2, 3, UNIT), (3, 4, UNIT)]);
    let still = frozen(&reactor, &[UNIT; 5], &links, &[]);
    let system = System::new(&reactor, &still);
    let mut amounts = vec![0.0; 15];
    amounts[6] = 4000.0;
    let mut method = method.start(&system, amounts, (9, 0));
    method.advance(100.0).unwrap();
    let [a, b, c] = [0, 1, 2].map(|s| method.amounts().iter().skip(s).step_by(3).sum::<f64>());
    assert_eq!((a, b + c), (0.0, 4000.0));
    assert!((b - 2000.0).abs() < 5.0 * 31.6, "{b} to {c}");
    assert!((diffusivity > 0.0) == (method.ledger().counters.hops > 0));
}

/// The same by the split sampler, in steps of 50 ms.
#[rstest]
fn equal_channels_split_equally_in_steps(#[values(0.0, 1.0, 10.0)] diffusivity: f64) {
    let species = [("A", diffusivity), ("B", 0.0), ("C", 0.0)];
    let reactor = discrete(&species, &[(&[(0, 1)], &[(1, 1)], 1.0), (&[(0, 1)], &[(2, 1)], 1.0)]);
    let links = Links::from_pairs(5, &[(0, 1, UNIT), (1, 2, UNIT), (2, 3, UNIT), (3, 4, UNIT)]);
    let still = frozen(&reactor, &[UNIT; 5], &links, &[]);
    let mut amounts = vec![0.0; 15];
    amounts[6] = 4000.0;
    let mut state = SplitState::new(&reactor, amounts, 9, 0);
    for k in 0..400 {
        state.step(&reactor, &still, 0.05 * f64::from(k), 0.05).unwrap();
    }
    let [a, b, c] = [0, 1, 2].map(|s| state.total(s));
    assert_eq!((a, b + c), (0.0, 4000.0));
    assert!((b - 2000.0).abs() < 5.0 * 31.6, "{b} to {c}");
}

/// A reservoir that emits by its mean of 3.5 molecules, next to a voxel where A decays at 2/s and a sponge draws
/// it towards 4 at 3/s: a birth-death process of births 3.5 g + 12 and deaths (g + 2 + 3) n with g = 1, Poisson of
/// mean 15.5/6 (1 - exp(-6 t)). The reservoir's own reaction 2 A -> B fires at 3.5² k.
#[rstest]
fn reservoirs_and_sponges(#[values(D, Next, Composition, Sub)] method: Method) {
    let reactor = discrete(&[("A", 1.0), ("B", 0.0)], &[(&[(0, 1)], &[], 2.0), (&[(0, 2)], &[(1, 1)], 0.1)]);
    let still = {
        let links = Links::from_pairs(2, &[(0, 1, UNIT)]);
        frozen(&reactor, &[UNIT, UNIT], &links, &[true, false, false, false])
    };
    let mut system = System::new(&reactor, &still);
    system.hold_means(&[0], 0);
    system.add_sponge(&[0, 1], 0, 3.0, &[9.0, 4.0]);
    let (mut found, mut made, mut supplied) = (Vec::new(), Vec::new(), 0.0);
    for run in 0..RUNS {
        let mut method = method.start(&system, vec![3.5, 0.0, 0.0, 0.0], (10, run));
        method.advance(0.4).unwrap();
        let (n, ledger) = (method.amounts(), method.ledger());
        assert!(n[0] == 3.5);
        supplied += ledger.supplied[0];
        // The books close: what is free came from the reservoir and the sponge, less what reacted.
        assert_eq!(n[2], ledger.supplied[0] + reactor.made(&ledger.fired, 0));
        found.push(n[2]);
        made.push(n[1]);
    }
    // 2 A -> B in the other voxel too takes two at a time, too rare here to be left out: compare B of the
    // reservoir only, and the other voxel without it below.
    let mean_b = 0.1 * 3.5 * 3.5 * 0.4;
    assert_mean(&made, mean_b, mean_b, LIMIT, "B of the reservoir");
    assert_variance(&made, mean_b, poisson_m4(mean_b), LIMIT, "B of the reservoir");
    assert!(supplied > 0.0 && found.iter().all(|n| n.fract() == 0.0));
}

/// The same without the pairs: exactly Poisson.
#[rstest]
fn fed_voxel_is_poisson(#[values(D, Next, Composition, Sub)] method: Method) {
    let reactor = discrete(&[("A", 1.0)], &[(&[(0, 1)], &[], 2.0)]);
    let links = Links::from_pairs(2, &[(0, 1, UNIT)]);
    let still = frozen(&reactor, &[UNIT, UNIT], &links, &[true, false]);
    let mut system = System::new(&reactor, &still);
    system.hold_means(&[0], 0);
    system.add_sponge(&[0, 1], 0, 3.0, &[9.0, 4.0]);
    let mut found = Vec::new();
    for run in 0..RUNS {
        let mut method = method.start(&system, vec![3.5, 0.0], (11, run));
        method.advance(0.4).unwrap();
        found.push(method.amounts()[1]);
    }
    let mu = 15.5 / 6.0 * (1.0 - (-2.4_f64).exp());
    assert_mean(&found, mu, mu, LIMIT, "A");
    assert_variance(&found, mu, poisson_m4(mu), LIMIT, "A");
    assert_distribution(&found, &poisson_masses(mu, 40), "A");
}

/// A hundred reactions in a ring, two linked volumes: all methods keep the molecules, and the stationary
/// numbers are multinomial. 2000 molecules over 100 species: Poisson-like, mean 20 (1 - 1/100 from the fixed sum).
#[rstest]
fn large_network(#[values(D, Next, Composition, Sub)] method: Method) {
    let names: Vec<String> = (0..100).map(|k| format!("S{k}")).collect();
    let species: Vec<(&str, f64)> = names.iter().map(|name| (name.as_str(), 0.0)).collect();
    let sides: Vec<[(usize, u32); 1]> = (0..100).map(|k| [(k, 1)]).collect();
    let reactions: Vec<_> = (0..100).map(|k| (&sides[k][..], &sides[(k + 1) % 100][..], 1.0)).collect();
    let reactor = discrete(&species, &reactions);
    let still = frozen(&reactor, &[UNIT], &Links::none(1), &[]);
    let system = System::new(&reactor, &still);
    let mut squares = Vec::new();
    for run in 0..200 {
        let mut method = method.start(&system, vec![20.0; 100], (12, run));
        method.advance(20.0).unwrap();
        assert_eq!(method.amounts().iter().sum::<f64>(), 2000.0);
        squares.push(method.amounts().iter().map(|n| (n - 20.0) * (n - 20.0)).sum::<f64>() / 19.8 / 100.0);
    }
    // Each molecule makes Poisson(20) steps of a ring of 100: cells hold sums of independent indicators whose
    // chances add up to 20; Σ p² over starts 20·Σ_k P(k)² = 20/(2 √(π 20)) = 1.26, so the variance is 18.74.
    // The sum of 100 squares has the relative error sqrt(2/100), the mean of 200 of them 0.01.
    let ratio = mean(&squares) * 19.8 / 18.74;
    assert!((ratio - 1.0).abs() < 0.05, "{method:?}: {ratio}");
}
