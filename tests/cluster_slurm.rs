//! An ensemble on a real Slurm: an array, a task killed, one that meets its time limit, resubmission, merge.
//! Skipped, with a line that says why, where Slurm cannot be had.
#![cfg(target_os = "linux")]

mod face;
mod slurm;

use face::{Bench, gillesph};
use slurm::{Slurm, processes};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// About two seconds a block.
const MODEL: &str = "\
name: slow
reactions:
  species: { X: , Y: }
  kinetics: molecules
  reactions: { swap: { equation: X <-> Y, rate: 1 1/s, reverse: 2 1/s } }
domain: { kind: well_mixed, volume: 1 fL }
initial: { X: 1000 }
run: { until: 500 s, realizations: 300, seed: 3 }
output: { every: 5 s }
";

/// The process that runs a block, once its record is there.
fn running(cluster: &Path, block: u32) -> Option<u32> {
    let record = std::fs::read_to_string(cluster.join(format!("blocks/{block:04}/run.json"))).ok()?;
    if !record.contains("\"status\": \"running\"") {
        return None;
    }
    let words = format!("cluster\0block\0.\0{block}\0");
    processes().find(|process| {
        let command = std::fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
        let folder = std::fs::read_link(format!("/proc/{process}/cwd")).unwrap_or_default();
        folder == cluster && String::from_utf8_lossy(&command).contains(&words)
    })
}

fn log(cluster: &Path, name: &str) -> String {
    std::fs::read_to_string(cluster.join("logs").join(name)).unwrap_or_default()
}

fn tables(dir: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = std::fs::read_dir(dir.join("tables")).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.into_iter().map(|file| (file.file_name().unwrap().into(), std::fs::read(file).unwrap())).collect()
}

#[test]
fn a_killed_task_alone_runs_again_and_the_tables_are_those_of_one_run() {
    let slurm = match Slurm::start() {
        Ok(slurm) => slurm,
        Err(why) => {
            // Straight to standard error: the test harness would keep a line of a test that passes.
            let _ = writeln!(std::io::stderr(), "SKIPPED the test with a real Slurm: {}", why.trim());
            return;
        }
    };
    let bench = Bench::new();
    let model = bench.model("slow.yaml", MODEL);
    let out = bench.path("an ensemble, 100% in blocks");
    let (model, shown) = (model.to_str().unwrap(), out.to_str().unwrap());
    gillesph(&["cluster", "slurm", model, "--blocks", "3", "--out", shown, "--time", "00:10:00"]);
    let cluster = out.join("cluster").canonicalize().unwrap();
    let submit = cluster.join("submit.sh");

    let said = slurm.say(&submit, &[]);
    assert!(said.starts_with("blocks 0-2: job "), "{said}");
    let array = said.lines().next().and_then(|line| line.rsplit(' ').next()).unwrap().to_string();

    // Block 1 is killed while it runs, as by a machine out of memory.
    let mut process = 0;
    slurm.until("block 1 runs", |_| running(&cluster, 1).inspect(|found| process = *found).is_some());
    assert!(Command::new("kill").args(["-9", &process.to_string()]).status().unwrap().success());
    // Block 2 is told that its time is nearly over, as `--signal` does it.
    slurm.until("block 2 runs", |_| running(&cluster, 2).is_some());
    slurm.say("scancel", &["--batch", "--signal=USR1", &format!("{array}_2")]);

    slurm.until_empty();
    let status = slurm.say(env!("CARGO_BIN_EXE_gillesph"), &["cluster", "status", shown]);
    assert!(
        status.contains("2 finished, 1 running"),
        "{status}\n{}\n{}",
        log(&cluster, "block-0001.log"),
        log(&cluster, "block-0002.log")
    );
    assert!(!out.join("run.json").exists(), "blocks were joined before all were finished");
    let requeued = log(&cluster, "block-0002.log");
    for words in ["start 1,", "back to the queue", "start 2,", "--resume", "exit status 0"] {
        assert!(requeued.contains(words), "`{words}` is missing: {requeued}");
    }

    let said = slurm.say(&submit, &[]);
    assert!(said.starts_with("blocks 1: job ") && said.lines().count() == 2, "{said}");
    slurm.until_empty();
    let starts = |k: u32| log(&cluster, &format!("block-{k:04}.log")).matches("start 1,").count();
    assert_eq!([0, 1, 2].map(starts), [1, 2, 1], "only block 1 was to be submitted twice");
    assert!(log(&cluster, "block-0001.log").contains("--resume"));
    let status = slurm.say(env!("CARGO_BIN_EXE_gillesph"), &["cluster", "status", shown]);
    assert!(status.contains("3 finished; 300 of 300"), "{status}\n{}", log(&cluster, "block-0001.log"));
    assert!(status.ends_with("; joined\n"), "{status}\n{}", log(&cluster, "merge.log"));
    assert!(slurm.say(&submit, &[]).starts_with("all blocks are finished and joined"));

    let direct = bench.run(Path::new(model), "direct", &["--threads", "2"]);
    assert!(tables(&direct) == tables(&out), "the tables differ from those of one run");
}
