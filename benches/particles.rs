//! Rates of the particle chemistry on one core: hops per second, and voxels times reactions per second of a
//! step in which nothing fires. `cargo bench --bench particles`; the rates stand in the rows `item/s`.

use divan::Bencher;
use divan::counter::ItemsCount;
use gillesph::chemistry::split::{Frozen, SplitState};
use gillesph::chemistry::{AVOGADRO, Kinetics, Links, Network, Rate, Reaction, Reactor, Species};
use gillesph::error::{Place, Source};
use gillesph::fluid::exchange::{Voxels, links};
use gillesph::fluid::weights::Weights;
use gillesph::random::{Purpose, stream};
use gillesph::space::domain::Domain;
use gillesph::space::kernel::{Kernel, KernelKind};
use gillesph::vector::Vector;
use std::sync::Arc;

fn main() {
    divan::main();
}

/// A volume in which 1 mol/m³ is one molecule.
const UNIT: f64 = 1.0 / AVOGADRO;

/// A periodic cube of `n`³ particles a metre apart; the cut-off of 2.2 takes in 32 neighbours.
fn cube(n: usize) -> Links {
    let domain =
        Domain { min: Vector::<3>::zeros(), max: Vector::from_element(n as f64), periodic: [true; 3] };
    let positions: Vec<Vector<3>> = (0..n.pow(3))
        .map(|index| Vector::from_fn(|k, _| (index / n.pow(k as u32) % n) as f64 + 0.5))
        .collect();
    let count = positions.len();
    let (volumes, hosts) = (vec![1.0; count], vec![true; count]);
    let voxels = Voxels {
        positions: &positions,
        volumes: &volumes,
        hosts: &hosts,
        domain: &domain,
        barriers: &[],
        obstacles: &[],
    };
    let mut links = links(&voxels, &Kernel::new(KernelKind::Lucy, 2.2), Weights::Normalised, 1.0);
    assert!((0..count).all(|i| links.row(i).len() == 32));
    links.conductance.iter_mut().for_each(|g| *g *= UNIT);
    links
}

/// Species of diffusivity 1 m²/s: one without `reactions`, three with them, at constants of 1e-12.
fn reactor(reactions: usize) -> Reactor {
    let source = Arc::new(Source::new("bench", ""));
    let place = Place { source, line: 1, column: 1, width: 1 };
    let species = |name: &str| Species {
        name: String::from(name),
        diffusion: 1.0,
        only_in: None,
        representation: None,
        place: place.clone(),
    };
    // Unimolecular and bimolecular ones in turn.
    let sides: [[Vec<(usize, u32)>; 2]; 4] = [
        [vec![(0, 1), (1, 1)], vec![(2, 1)]],
        [vec![(2, 1)], vec![(0, 1), (1, 1)]],
        [vec![(0, 1)], vec![]],
        [vec![(1, 2)], vec![(0, 1)]],
    ];
    let reaction = |r: usize| Reaction {
        name: format!("reaction {r}"),
        equation: String::new(),
        reactants: sides[r % 4][0].clone(),
        products: sides[r % 4][1].clone(),
        rate: Rate::MassAction(1e-12),
        only_in: None,
        place: place.clone(),
    };
    let network = Network {
        name: String::from("bench"),
        kinetics: Kinetics::Concentration,
        species: if reactions == 0 { vec![species("A")] } else { ["A", "B", "C"].map(species).into() },
        parameters: Vec::new(),
        reactions: (0..reactions).map(reaction).collect(),
    };
    let discrete = vec![true; network.species.len()];
    Reactor::everywhere(&network, &discrete)
}

fn freeze(reactor: &Reactor, links: &Links) -> Frozen {
    let n = links.voxels();
    Frozen::build(reactor, links, &vec![UNIT; n], &vec![0; n], &vec![0; n], &[]).expect("a sound geometry")
}

/// Steps over which the rate of one sample is taken.
const STEPS: u32 = 20;

/// Hops per second on a cube of 20³ voxels, 0.3 hops per molecule and step, by molecules per voxel.
#[divan::bench(args = [1, 3, 10, 30, 100, 1000], sample_count = 30, sample_size = 1)]
fn hops(bencher: Bencher, molecules: u32) {
    let (reactor, links) = (reactor(0), cube(20));
    let frozen = freeze(&reactor, &links);
    let dt = 0.3 / frozen.table(0).expect("A diffuses").rate;
    let mut state = SplitState::new(&reactor, vec![f64::from(molecules); links.voxels()], 1, 0);
    // On a lattice of equal voxels every virtual jump is a hop.
    let expected = 0.3 * f64::from(molecules) * links.voxels() as f64 * f64::from(STEPS);
    bencher.counter(ItemsCount::new(expected as u64)).bench_local(|| {
        for _ in 0..STEPS {
            state.diffuse(&reactor, &frozen, 0.0, dt).expect("counts stay sound");
        }
    });
}

/// Molecules per second of one lot that leaves a voxel of 32 neighbours, on either side of the choice between
/// one draw per molecule and a chain of binomials; the two should be nearly equal at 1792.
#[divan::bench(args = [256, 1792, 1793, 16384], sample_count = 30, sample_size = 20)]
fn scatter(bencher: Bencher, molecules: u64) {
    let (reactor, links) = (reactor(0), cube(5));
    let frozen = freeze(&reactor, &links);
    let table = frozen.table(0).expect("A diffuses");
    let mut next = vec![0; links.voxels()];
    let mut random = stream(1, 0, Purpose::Diffusion);
    bencher.counter(ItemsCount::new(molecules * 125)).bench_local(|| {
        (0..125).for_each(|i| table.scatter(i, molecules, &mut next, &mut random));
    });
}

/// Voxels times reactions per second of a chemistry step in which nothing fires, by number of voxels.
#[divan::bench(args = [1_000, 10_000, 100_000], consts = [1, 4, 8], sample_count = 30, sample_size = 1)]
fn nothing_fires<const REACTIONS: usize>(bencher: Bencher, voxels: usize) {
    let reactor = reactor(REACTIONS);
    let frozen = freeze(&reactor, &Links::none(voxels));
    let mut state = SplitState::new(&reactor, [10.0, 5.0, 2.0].repeat(voxels), 1, 0);
    bencher.counter(ItemsCount::new(voxels * REACTIONS * STEPS as usize)).bench_local(|| {
        for _ in 0..STEPS {
            state.react(&reactor, &frozen, 0.0, 1e-3).expect("propensities stay sound");
        }
    });
    assert_eq!(state.counters.events, 0);
}
