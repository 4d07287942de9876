//! Exact solutions of the reaction–diffusion master equation through the whole program: YAML in, Parquet out.
//!
//! The numbers come from the matrix exponential over the full state space or from the closed form named with
//! the case. Their volumes are pure numbers: here volume 1 is 1 fL, a conductance 1 is 1 µm at 1 µm²/s, and a
//! rate of k per molecule and volume is k N_A fL (see [`second`]). 10 000 realizations; means within 4.7 and
//! variances within 4.7 standard errors: about 300 quantities are compared, each false with chance 2.6e-6 if
//! normal, all together 8e-4; distributions by chi-square at 1e-4. Seeds fixed beforehand.

#[path = "chemistry_cases/mod.rs"]
mod cases;
mod face;

use cases::*;
use face::{Bench, amounts};
use gillesph::chemistry::AVOGADRO;
use gillesph::tables::SeriesTable;
use rstest::rstest;

const REALIZATIONS: u32 = 10_000;
const LIMIT: f64 = 4.7;
/// m³ in a femtolitre.
const FL: f64 = 1e-18;
/// mol/m³ in a nanomole per litre.
const NM: f64 = 1e-6;

/// Rate constant of a bimolecular reaction in m³/mol/s, from fL per molecule and s.
fn second(k: f64) -> f64 {
    k * FL * AVOGADRO
}

/// Rate of a source in mol/m³/s, from molecules per fL and s.
fn zeroth(k: f64) -> f64 {
    k / (FL * AVOGADRO)
}

fn check(x: &[f64], mean: f64, variance: f64, m4: f64, what: &str) {
    assert_eq!(x.len(), REALIZATIONS as usize);
    assert!(x.iter().all(|n| n.fract() == 0.0 && *n >= 0.0), "{what}: molecules come whole");
    assert_mean(x, mean, variance, LIMIT, what);
    assert_variance(x, variance, m4, LIMIT, what);
}

fn play(model: &str, domain: &str, method: &str, times: &[f64], seed: u32) -> SeriesTable {
    let until = times.iter().copied().fold(0.0, f64::max);
    let text = format!(
        "{model}\ndomain: {domain}\nchemistry: {{ {method} }}\n\
         run: {{ until: {until} s, realizations: {REALIZATIONS}, seed: {seed} }}\noutput: {{ times: {times:?} }}\n"
    );
    Bench::new().series(&text, &[])
}

/// 100 molecules in volumes 1 and 0.25, conductance 0.5: n_0 ~ Binomial(100, p), 80 to 20 in the end.
/// p = 0.8 + 0.2 exp(-g (1/V_0 + 1/V_1) t).
#[rstest]
#[case("method: next_subvolume", 11)]
#[case("method: direct", 13)]
#[case("method: next_reaction", 14)]
#[case("method: composition_rejection", 15)]
#[case("method: split, step: 0.5 s", 12)] // diffusion alone is exact at any step
fn two_voxel_diffusion(#[case] method: &str, #[case] seed: u32) {
    let model = "name: two_voxels\nreactions: { species: { X: { diffusion: 1 um^2/s } }, reactions: {} }\n\
                 initial: { X: [100, 0] }";
    let domain = "{ kind: graph, volumes: [1 fL, 0.25 fL], names: [a, b], links: [[a, b, 0.5 um]] }";
    let times = [0.1, 0.5, 5.0];
    let series = play(model, domain, method, &times, seed);
    for (t, p) in times.into_iter().zip([0.955760156614281, 0.8573009593720381, 0.8000007453306345]) {
        let (a, b) = (amounts(&series, "a", "X", t), amounts(&series, "b", "X", t));
        assert!(a.iter().zip(&b).all(|(a, b)| a + b == 100.0));
        let variance = 100.0 * p * (1.0 - p);
        check(&a, 100.0 * p, variance, binomial_m4(100.0, p), &format!("{method}: a at {t}"));
        assert_distribution(&a, &binomial_masses(100, p), &format!("{method}: a at {t}"));
    }
}

/// 0 -> X at 10 V, X -> 0 at 0.5 n in volumes 1, 0.5, 2, 0.25: independent Poisson of mean
/// V 20 (1 - exp(-t/2)) whatever the conductances; the concentration is flat, so splitting is exact too.
#[rstest]
#[case("method: next_subvolume", 21)]
#[case("method: direct", 23)]
#[case("method: next_reaction", 24)]
#[case("method: composition_rejection", 25)]
#[case("method: split, step: 0.1 s", 22)]
fn birth_death_diffusion(#[case] method: &str, #[case] seed: u32) {
    let model = format!(
        "name: birth_death\nreactions:\n  species: {{ X: {{ diffusion: 1 um^2/s }} }}\n  kinetics: concentration\n  \
         reactions:\n    birth: {{ equation: 0 -> X, rate: {:e} mol/m^3/s }}\n    \
         death: {{ equation: X -> 0, rate: 0.5 1/s }}",
        zeroth(10.0)
    );
    let domain = "{ kind: graph, volumes: [1 fL, 0.5 fL, 2 fL, 0.25 fL], names: [a, b, c, d], \
                  links: [[a, b, 1 um], [b, c, 0.3 um], [c, d, 2 um]] }";
    let times = [1.0, 20.0];
    let series = play(&model, domain, method, &times, seed);
    let names = ["a", "b", "c", "d"];
    let exact = [
        [7.8693868057473315, 3.9346934028736658, 15.738773611494663, 1.9673467014368329],
        [19.99909200140475, 9.999546000702376, 39.9981840028095, 4.999773000351188],
    ];
    for (t, means) in times.into_iter().zip(exact) {
        let seen = names.map(|name| amounts(&series, name, "X", t));
        for (x, (name, mu)) in seen.iter().zip(names.iter().zip(means)) {
            let what = format!("{method}: {name} at {t}");
            check(x, mu, mu, poisson_m4(mu), &what);
            assert_distribution(x, &poisson_masses(mu, 150), &what);
        }
        for i in 0..4 {
            for j in 0..i {
                // Independent: the coefficient of correlation has the standard error 1/sqrt(10 000).
                let (mi, mj) = (mean(&seen[i]), mean(&seen[j]));
                let product: f64 = seen[i].iter().zip(&seen[j]).map(|(a, b)| (a - mi) * (b - mj)).sum();
                let covariance = product / (f64::from(REALIZATIONS) - 1.0);
                let coefficient = covariance / (variance(&seen[i]) * variance(&seen[j])).sqrt();
                assert!(coefficient.abs() < LIMIT * 0.01, "{method}: {i}, {j} at {t}: {coefficient}");
            }
        }
        let sum: f64 = means.iter().sum();
        check(&amounts(&series, "all", "X", t), sum, sum, poisson_m4(sum), "all");
    }
}

/// 50 receptors at ligand held at 0.33, k_a = k_b = 0.4: bound ~ Binomial(50, p(t)),
/// p = k_a c / (k_a c + k_b) (1 - exp(-(k_a c + k_b) t)). Said in three ways: the ligand as a catalyst by
/// count (33 of them, c = 0.4/100), as a rate law of counts, as a rate law of concentrations.
#[rstest]
fn receptor_occupancy(
    #[values("direct", "next_reaction", "composition_rejection", "next_subvolume", "split")] method: &str,
    #[values(0, 1, 2)] way: usize,
) {
    let bind = [
        "{ equation: R + L -> RL + L, rate: 0.004 1/s }",
        "{ equation: R -> RL, law: \"k_a * 0.01 * L * R\" }",
        "{ equation: R -> RL, law: \"k_a * (L / (1 nM)) * R\" }",
    ][way];
    let kinetics = ["molecules", "molecules", "concentration"][way];
    // 33 molecules in 1 fL stand for the 0.33; in the last way k_a multiplies their concentration over 1 nM.
    let k_a = if way == 2 { 0.4 * 0.33 / (33.0 * zeroth(1.0) / NM) } else { 0.4 };
    let model = format!(
        "name: receptors\nreactions:\n  species: [L, R, RL]\n  parameters: {{ k_a: {k_a:e} 1/s }}\n  \
         kinetics: {kinetics}\n  reactions:\n    bind: {bind}\n    \
         part: {{ equation: RL -> R, rate: 0.4 1/s }}\ninitial: {{ L: 33, R: 50 }}"
    );
    let times = [1.0, 2.0, 50.0];
    let seed = 31 + way as u32;
    let series =
        play(&model, "{ kind: well_mixed, volume: 1 fL }", &format!("method: {method}"), &times, seed);
    for (t, p) in times.into_iter().zip([0.1023672564403814, 0.1625007449892356, 0.24812030075118396]) {
        let what = format!("{method}, way {way}: RL at {t}");
        let bound = amounts(&series, "all", "RL", t);
        check(&bound, 50.0 * p, 50.0 * p * (1.0 - p), binomial_m4(50.0, p), &what);
        assert_distribution(&bound, &binomial_masses(50, p), &what);
        assert!(amounts(&series, "all", "L", t).iter().all(|&n| n == 33.0), "{what}: ligand is held");
    }
}

/// The same with the ligand continuous, 0.33 nM, a fifth of a molecule in the femtolitre: receptors are sampled
/// at what the continuous species says, by mass action and by law.
#[rstest]
#[case("{ equation: R + L -> RL + L, rate: 0.4 /nM/s }", 35)]
#[case("{ equation: R -> RL, law: \"0.4 s^-1 * L / (1 nM) * R\" }", 36)]
fn receptors_at_a_continuous_ligand(#[case] bind: &str, #[case] seed: u32) {
    let model = format!(
        "name: receptors\nreactions:\n  species: {{ L: {{ representation: continuous }}, R: {{}}, RL: {{}} }}\n  \
         kinetics: concentration\n  reactions:\n    bind: {bind}\n    \
         part: {{ equation: RL -> R, rate: 0.4 1/s }}\ninitial: {{ L: 0.33 nM, R: 50 }}"
    );
    let times = [1.0, 2.0, 50.0];
    let series = play(&model, "{ kind: well_mixed, volume: 1 fL }", "method: split", &times, seed);
    for (t, p) in times.into_iter().zip([0.1023672564403814, 0.1625007449892356, 0.24812030075118396]) {
        let what = format!("{bind}: RL at {t}");
        let bound = amounts(&series, "all", "RL", t);
        check(&bound, 50.0 * p, 50.0 * p * (1.0 - p), binomial_m4(50.0, p), &what);
        assert_distribution(&bound, &binomial_masses(50, p), &what);
    }
}

/// A + B <-> C in volume 2, k = 0.05 and 0.5, from 20, 15, 0.
#[rstest]
fn abc_equilibrium(
    #[values("direct", "next_reaction", "composition_rejection", "next_subvolume", "split")] method: &str,
) {
    let model = format!(
        "name: abc\nreactions:\n  species: [A, B, C]\n  kinetics: concentration\n  reactions:\n    \
         join: {{ equation: A + B <-> C, rate: {:e} m^3/mol/s, reverse: 0.5 1/s }}\n\
         initial: {{ A: 20, B: 15 }}",
        second(0.05)
    );
    let times = [0.5, 2.0, 100.0];
    let series = play(&model, "{ kind: well_mixed, volume: 2 fL }", &format!("method: {method}"), &times, 41);
    let exact = [
        (2.7545945468528674, 1.9795840705393144, 11.620575551140437),
        (5.546622111962481, 2.8025063713370106, 22.80934171789236),
        (6.208472311836137, 2.920848704169107, 24.775906574425647),
    ];
    for ((t, (mu, var, m4)), masses) in times.into_iter().zip(exact).zip(&ABC) {
        let what = format!("{method}: C at {t}");
        let [a, b, c] = ["A", "B", "C"].map(|s| amounts(&series, "all", s, t));
        assert!((0..c.len()).all(|r| a[r] + c[r] == 20.0 && b[r] + c[r] == 15.0), "{what}");
        check(&c, mu, var, m4, &what);
        assert_distribution(&c, masses, &what);
    }
}

/// A + B -> 0 in one volume, k = 0.1, 12 and 10 molecules.
#[rstest]
fn annihilation(
    #[values("direct", "next_reaction", "composition_rejection", "next_subvolume", "split")] method: &str,
) {
    let model = format!(
        "name: annihilation\nreactions:\n  species: [A, B]\n  kinetics: concentration\n  reactions:\n    \
         meet: {{ equation: A + B -> 0, rate: {:e} m^3/mol/s }}\ninitial: {{ A: 12, B: 10 }}",
        second(0.1)
    );
    let times = [0.25, 1.0, 4.0];
    let series = play(&model, "{ kind: well_mixed, volume: 1 fL }", &format!("method: {method}"), &times, 51);
    let exact = [
        (7.62737840345104, 1.5072565431836495, 6.540612816599039),
        (4.204201816694759, 1.5775308883286263, 7.267346059510668),
        (1.0530026746104069, 0.6133149489217058, 1.07234430727911),
    ];
    for ((t, (mu, var, m4)), masses) in times.into_iter().zip(exact).zip(&ANNIHILATION) {
        let what = format!("{method}: B at {t}");
        let [a, b] = ["A", "B"].map(|s| amounts(&series, "all", s, t));
        assert!(a.iter().zip(&b).all(|(a, b)| a - b == 2.0), "{what}");
        check(&b, mu, var, m4, &what);
        assert_distribution(&b, masses, &what);
    }
}

/// The same, k = 0.4, with diffusion (conductances 0.6 and 0.2) between volumes 1 and 0.5; 6 A in the first,
/// 4 B in the second. Split at 10 ms: the error of the splitting, a few times (τ rate)² = 1e-4, is far below
/// the standard error of a mean, 0.01.
#[rstest]
#[case("method: next_subvolume", 61)]
#[case("method: direct", 63)]
#[case("method: next_reaction", 64)]
#[case("method: composition_rejection", 65)]
#[case("method: split, step: 10 ms", 62)]
fn two_voxel_annihilation(#[case] method: &str, #[case] seed: u32) {
    let model = format!(
        "name: apart\nreactions:\n  species: {{ A: {{ diffusion: 0.6 um^2/s }}, B: {{ diffusion: 0.2 um^2/s }} }}\n  \
         kinetics: concentration\n  reactions:\n    meet: {{ equation: A + B -> 0, rate: {:e} m^3/mol/s }}\n\
         initial: {{ A: [6, 0], B: [0, 4] }}",
        second(0.4)
    );
    let domain = "{ kind: graph, volumes: [1 fL, 0.5 fL], links: [[0, 1, 1 um]] }";
    let times = APART.map(|(t, ..)| t);
    let series = play(&model, domain, method, &times, seed);
    for ((t, mu, var, m4), masses) in APART.into_iter().zip(&APART_TOTAL_B) {
        for (q, (group, species)) in [("0", "A"), ("1", "A"), ("0", "B"), ("1", "B")].into_iter().enumerate()
        {
            let what = format!("{method}: {species} in {group} at {t}");
            check(&amounts(&series, group, species, t), mu[q], var[q], m4[q], &what);
        }
        assert_distribution(&amounts(&series, "all", "B", t), masses, &format!("{method}: B at {t}"));
    }
}

/// Chances of 0, 1, … molecules of C at 0.5, 2 and 100 s, by matrix exponential.
const ABC: [[f64; 16]; 3] = [
    [
        0.03830197738355205,
        0.1509354694171121,
        0.26195725304432543,
        0.26488202888826196,
        0.17397692389515235,
        0.07835134987970367,
        0.024896809231335085,
        0.005658748702847342,
        0.0009228202467605966,
        0.00010733927685870443,
        8.77124445601036e-06,
        4.904034876436289e-07,
        1.7978312382259865e-08,
        4.0295158343558047e-10,
        4.860196513482031e-12,
        2.3296077001413716e-14,
    ],
    [
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
    ],
    [
        0.00010514662176167706,
        0.0015771993264251554,
        0.010488375520727284,
        0.04090466453083636,
        0.10430689455363264,
        0.1835801344143934,
        0.22947516801799192,
        0.2065276512161928,
        0.1342429732905253,
        0.06264672086891189,
        0.020673417886740923,
        0.004698504065168392,
        0.0007047756097752591,
        6.505621013310083e-05,
        3.252810506655043e-06,
        6.505621013310086e-08,
    ],
];

/// Chances of 0, 1, … molecules of B at 0.25, 1 and 4 s, by matrix exponential.
const ANNIHILATION: [[f64; 11]; 3] = [
    [
        7.705474494431927e-09,
        9.195865495369908e-07,
        3.639945382486264e-05,
        0.0006711262141726306,
        0.006647942237391401,
        0.03801685622771516,
        0.12973085282541674,
        0.26494500282595135,
        0.31372998518737444,
        0.19643383936826528,
        0.049787068367863924,
    ],
    [
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
    ],
    [
        0.2443971486683742,
        0.4937303672805465,
        0.22795472391374874,
        0.03233473751634162,
        0.0015566212999084123,
        2.6246482027357217e-05,
        1.5453000234024946e-07,
        3.088529974328149e-10,
        1.977722193239325e-13,
        3.6207855075946436e-17,
        1.425164082740925e-21,
    ],
];

/// Chances of 0, 1, … molecules of B in both volumes at 0.5, 1 and 3 s, by matrix exponential over 85 states.
const APART_TOTAL_B: [[f64; 5]; 3] = [
    [
        0.001011068568595986,
        0.024422675405392464,
        0.17065102442342467,
        0.43836892915661646,
        0.3655463024459703,
    ],
    [0.030071343079525244, 0.20871813770111253, 0.40666702631346646, 0.2879858286147126, 0.06655766429118358],
    [
        0.5773720764706882,
        0.3717845009036404,
        0.04876482535819053,
        0.0020489886374296584,
        2.9608630052247718e-05,
    ],
];

/// Time, then mean, variance and fourth central moment of A0, A1, B0, B1.
type Moments = (f64, [f64; 4], [f64; 4], [f64; 4]);

/// By matrix exponential over 85 states.
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
