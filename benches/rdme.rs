//! Reaction and diffusion on voxels at rest: hops and reactions per second, one core.
//! `cargo bench --bench rdme`.

use divan::Bencher;
use divan::counter::ItemsCount;
use gillesph::model::load;
use gillesph::plan::Plan;
use gillesph::simulation::{Ready, Watch};
use std::path::Path;

fn main() {
    divan::main();
}

fn events(bencher: Bencher, path: &Path, set: &[String]) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().ok();
    let plan = Plan::new(load::model(path, set).unwrap(), 1).unwrap();
    let run = || {
        let tally = Ready::new(&plan).unwrap().run(&[0], &Watch::silent()).tally;
        tally.reaction_events + tally.hops
    };
    bencher.counter(ItemsCount::new(run())).bench(run);
}

/// The box of `models/opposing_sources.yaml`, 41 x 8 x 8 voxels with 32 neighbours, for its 60 s.
#[divan::bench(
    args = ["split", "next_subvolume", "composition_rejection", "direct", "next_reaction"],
    sample_count = 5
)]
fn opposing_sources(bencher: Bencher, method: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/opposing_sources.yaml");
    let set =
        [format!("chemistry.method={method}"), "output.every=60 s".into(), "output.particles=false".into()];
    events(bencher, &path, &set);
}

/// A chain of n volumes, two species that hop, meet and are made: where one method overtakes the other
/// (`plan::methods`).
#[divan::bench(args = [2, 16, 128, 1024, 8192], consts = [0, 1, 2, 3], sample_count = 5)]
fn chain<const METHOD: usize>(bencher: Bencher, n: usize) {
    let method = ["next_subvolume", "composition_rejection", "direct", "next_reaction"][METHOD];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chain.yaml");
    let links: Vec<String> = (1..n).map(|k| format!("[{}, {k}, 1 um]", k - 1)).collect();
    let text = format!(
        "name: chain\nreactions:\n  species: {{ A: {{ diffusion: 1 um^2/s }}, B: {{ diffusion: 1 um^2/s }} }}\n  \
         kinetics: molecules\n  reactions: {{ j: {{ equation: A + B <-> 0, rate: 0.01 1/s, reverse: 4 1/s }} }}\n\
         domain: {{ kind: graph, volumes: [{}], links: [{}] }}\ninitial: {{ A: 20, B: 20 }}\n\
         chemistry: {{ method: {method} }}\nrun: {{ until: {} s }}\noutput: {{ times: [{} s] }}\n",
        vec!["1 fL"; n].join(", "),
        links.join(", "),
        4000.0 / n as f64,
        4000.0 / n as f64
    );
    std::fs::write(&path, text).unwrap();
    events(bencher, &path, &[]);
}
