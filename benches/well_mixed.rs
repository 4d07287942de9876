//! Events per second in one volume: networks read from YAML, 101 output times, one core.
//! `cargo bench --bench well_mixed`.

use divan::Bencher;
use divan::counter::ItemsCount;
use gillesph::chemistry::Links;
use gillesph::chemistry::split::Frozen;
use gillesph::chemistry::ssa::{CompositionRejection, Direct, EventMethod, NextReaction, System};
use gillesph::model::{Method, load};
use gillesph::plan::Plan;
use gillesph::simulation::{Ready, Watch};
use std::path::Path;

fn main() {
    divan::main();
}

/// A shipped model with a method; set to 10 realizations.
fn plan(name: &str, method: &str) -> Plan {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name);
    let set = [format!("chemistry.method={method}"), String::from("run.realizations=10")];
    Plan::new(load::model(&path, &set).unwrap(), 10).unwrap()
}

fn run(plan: &Plan) -> u64 {
    let outcome = Ready::new(plan).unwrap().run(&(0..10).collect::<Vec<u32>>(), &Watch::silent());
    outcome.tally.reaction_events
}

/// Ten realizations of a model from start to the last output; the rate counts reaction events.
fn events(bencher: Bencher, model: &str, method: &str) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().ok();
    let plan = plan(model, method);
    let events = run(&plan);
    bencher.counter(ItemsCount::new(events)).bench(|| run(&plan));
}

#[divan::bench(args = ["direct", "next_reaction", "composition_rejection", "tau_leaping", "split"])]
fn schloegl(bencher: Bencher, method: &str) {
    events(bencher, "schloegl.yaml", method);
}

#[divan::bench(args = ["direct", "next_reaction", "composition_rejection", "tau_leaping", "split"])]
fn gene_expression(bencher: Bencher, method: &str) {
    events(bencher, "gene_expression.yaml", method);
}

/// A ring of n conversions S0 -> S1 -> …: where one method overtakes the other (`plan::methods`).
#[divan::bench(args = [16, 32, 64, 128, 256], consts = [0, 1, 2])]
fn ring<const METHOD: usize>(bencher: Bencher, n: usize) {
    let method = [Method::Direct, Method::NextReaction, Method::CompositionRejection][METHOD];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.yaml");
    let names: Vec<String> = (0..n).map(|k| format!("S{k}")).collect();
    let reactions: Vec<String> =
        (0..n).map(|k| format!("r{k}: {{ equation: S{k} -> S{}, rate: 1 }}", (k + 1) % n)).collect();
    let text = format!(
        "name: ring\nreactions: {{ species: [{}], kinetics: molecules, reactions: {{ {} }} }}\n\
         domain: {{ kind: well_mixed, volume: 1 fL }}\nrun: {{ until: 1 s }}\n",
        names.join(", "),
        reactions.join(", ")
    );
    std::fs::write(&path, text).unwrap();
    let plan = Plan::new(load::model(&path, &[]).unwrap(), 1).unwrap();
    let frozen = Frozen::build(&plan.reactor, &Links::none(1), &[1e-18], &[0], &[0], &[]).unwrap();
    let system = System::new(&plan.reactor, &frozen);
    let until = 100_000.0 / (20.0 * n as f64);
    let play = || {
        let amounts = vec![20.0; n];
        let mut one: Box<dyn EventMethod> = match method {
            Method::Direct => Box::new(Direct::new(&system, amounts, (1, 0)).unwrap()),
            Method::NextReaction => Box::new(NextReaction::new(&system, amounts, (1, 0)).unwrap()),
            _ => Box::new(CompositionRejection::new(&system, amounts, (1, 0)).unwrap()),
        };
        one.advance(until).unwrap();
        one.ledger().counters.events
    };
    bencher.counter(ItemsCount::new(play())).bench(play);
}
