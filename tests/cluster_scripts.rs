//! An ensemble in blocks: the folder, the scripts and what they submit, without a scheduler.
#![cfg(unix)]

mod face;

use face::{Bench, channel, gillesph, record, shipped};
use rstest::rstest;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const MODEL: &str = "\
name: t
reactions:
  species: { A: , B: }
  kinetics: molecules
  reactions: { decay: { equation: A -> B, rate: 1 1/s } }
domain: { kind: well_mixed, volume: 1 fL }
initial: { A: 100 }
run: { until: 1 s, realizations: 10, seed: 5 }
output: { every: 0.5 s }
";

/// Writes the model and its blocks into a folder whose name is as bad as names get.
fn folder(bench: &Bench, verb: &str, options: &[&str]) -> PathBuf {
    let model = bench.model("m.yaml", MODEL);
    let out = bench.path("it's a 100%j $folder");
    let arguments = ["cluster", verb, model.to_str().unwrap(), "--out", out.to_str().unwrap()];
    gillesph(&[&arguments[..], options].concat());
    out
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gillesph")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn scripts_are_sound() {
    let bench = Bench::new();
    let options =
        ["--blocks", "4", "--time", "1-06:00:00", "--memory", "4G", "--threads", "2", "--partition", "long"];
    let out = folder(&bench, "slurm", &options);
    let scripts = ["block.sh", "merge.sh", "submit.sh"].map(|name| out.join("cluster").join(name));
    let passes = |program: &str, arguments: &[&str]| {
        for script in &scripts {
            let Ok(output) = Command::new(program).args(arguments).arg(script).output() else {
                eprintln!("{program} is not here: scripts are not checked by it");
                return;
            };
            let said = String::from_utf8_lossy(&output.stdout).into_owned()
                + &String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{program} {}: {said}", script.display());
        }
    };
    passes("bash", &["-n"]);
    passes("shellcheck", &[]);
    for script in &scripts {
        let text = text(script);
        assert!(text.contains("set -euo pipefail") && text.contains(env!("CARGO_BIN_EXE_gillesph")));
        let place = text.split('@').skip(1).find(|word| word.chars().all(|c| c.is_ascii_uppercase()));
        assert!(place.is_none_or(str::is_empty), "a place is left in {}: {place:?}", script.display());
    }
    for line in [
        "#SBATCH --time=1-06:00:00",
        "#SBATCH --mem=4G",
        "#SBATCH --cpus-per-task=2",
        "#SBATCH --partition=long",
        "#SBATCH --signal=B:USR1@120",
        "#SBATCH --requeue",
        "#SBATCH --open-mode=append",
        "\"$gillesph\" cluster block . \"$block\" --threads 2 &",
        // By the job's own number it could be the whole array.
        "        scontrol requeue \"${SLURM_ARRAY_JOB_ID}_$block\" && sleep 60",
    ] {
        assert!(text(&scripts[0]).contains(&format!("\n{line}\n")), "{line}");
    }
    let mode = scripts[2].metadata().unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o755);
}

/// A folder with `sbatch`, `squeue` and `scancel` that write down how they were called. `squeue` prints the file
/// `queue`, `sbatch` counts jobs up from 101.
fn scheduler(bench: &Bench) -> PathBuf {
    let bin = bench.path("bin");
    std::fs::create_dir(&bin).unwrap();
    let said = "printf '%s' \"${0##*/}\" >>\"$here/calls\"; printf ' <%s>' \"$@\" >>\"$here/calls\"; echo >>\"$here/calls\"";
    for (name, does) in [
        ("sbatch", "n=$(cat \"$here/count\" 2>/dev/null || echo 100); echo $((n + 1)) | tee \"$here/count\""),
        ("squeue", "cat \"$here/queue\" 2>/dev/null || true"),
        ("scancel", ":"),
    ] {
        let path = bin.join(name);
        let text = format!("#!/usr/bin/env bash\nset -eu\nhere=$(dirname -- \"$0\")\n{said}\n{does}\n");
        std::fs::write(&path, text).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    }
    bin
}

/// Runs submit.sh with that scheduler; what it said, and the calls of `sbatch` and `scancel`.
fn submit(out: &Path, bin: &Path, options: &[&str]) -> (String, Vec<String>) {
    let _ = std::fs::remove_file(bin.join("calls"));
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let output: Output = Command::new(out.join("cluster/submit.sh"))
        .args(options)
        .env("PATH", path)
        .env_remove("GILLESPH")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let calls = text(&bin.join("calls"));
    let calls = calls.lines().filter(|call| !call.starts_with("squeue")).map(String::from).collect();
    (String::from_utf8(output.stdout).unwrap(), calls)
}

#[test]
fn only_blocks_that_are_not_finished_are_submitted() {
    let bench = Bench::new();
    let out = folder(&bench, "slurm", &["--blocks", "4"]);
    let bin = scheduler(&bench);
    let here = out.join("cluster").canonicalize().unwrap();
    let here = here.to_str().unwrap();
    let logs = here.replace('%', "%%");
    let blocks = |list: &str, option: &str| {
        format!(
            "sbatch <--parsable> <--chdir={here}> <--output={logs}/logs/block-%4a.log> <--array={list}>{option} <block.sh>"
        )
    };
    let merge = |dependency: &str, option: &str| {
        let dependency = if dependency.is_empty() {
            String::new()
        } else {
            format!(" <--dependency=afterok:{dependency}>")
        };
        format!(
            "sbatch <--parsable> <--chdir={here}> <--output={logs}/logs/merge.log> <--kill-on-invalid-dep=yes>{dependency}{option} <merge.sh>"
        )
    };
    let finish = |k: &str| gillesph(&["cluster", "block", out.to_str().unwrap(), k]);

    // At first all of them; options are handed on.
    let (said, calls) = submit(&out, &bin, &["--account=my project"]);
    let option = " <--account=my project>";
    assert_eq!(calls, [blocks("0-3", option), merge("101", option)]);
    assert_eq!(said, "blocks 0-3: job 101\nmerge: job 102\n");

    // All of them wait or run: nothing to do.
    let queue = |text: &str| std::fs::write(bin.join("queue"), text).unwrap();
    queue("101 0\n101 1\n101 2\n101 3\n102 N/A\n999 7\n");
    let (said, calls) = submit(&out, &bin, &[]);
    assert!(calls.is_empty(), "{calls:?}");
    assert!(said.contains("nothing to submit: job 102 joins the blocks once 0,1,2,3 are finished"), "{said}");

    // Block 1 is done, 3 still runs, 0 and 2 died; the merge that waits would never run.
    finish("1");
    queue("101 3\n102 N/A\n999 0\n");
    let (_, calls) = submit(&out, &bin, &[]);
    assert_eq!(calls, ["scancel <102>".to_string(), blocks("0,2", ""), merge("101_3:103", "")]);

    // The merge was cut off: blocks 0 and 3 run on, of two submissions.
    finish("2");
    queue("101 3\n103 0\n");
    let (_, calls) = submit(&out, &bin, &[]);
    assert_eq!(calls, [merge("101_3:103_0", "")]);

    // All blocks are finished, but not joined.
    finish("0");
    finish("3");
    queue("");
    let (_, calls) = submit(&out, &bin, &[]);
    assert_eq!(calls, [merge("", "")]);
    gillesph(&["cluster", "merge", here]);
    let (said, calls) = submit(&out, &bin, &[]);
    assert!(calls.is_empty() && said.starts_with("all blocks are finished and joined in "), "{said}");
}

/// All files below a folder with their bytes, in order of path.
fn files(dir: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut open = vec![dir.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.push((path.strip_prefix(dir).unwrap().to_path_buf(), std::fs::read(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

#[test]
fn blocks_run_go_on_and_join_to_one_run() {
    let bench = Bench::new();
    let set = ["--set", "initial.A=60", "--seed", "9", "--realizations", "11"];
    let out = folder(&bench, "slurm", &[&["--blocks", "3"], &set[..]].concat());
    let (dir, blocks) = (out.to_str().unwrap(), out.join("cluster/blocks"));
    // A later change of the model must not reach blocks that have not run.
    std::fs::write(bench.path("m.yaml"), MODEL.replace("rate: 1 1/s", "rate: 2 1/s")).unwrap();

    // Block 0 was cut off before its record was written, block 1 after it.
    std::fs::create_dir_all(blocks.join("0000/tables")).unwrap();
    gillesph(&["cluster", "block", dir, "0"]);
    gillesph(&["cluster", "block", dir, "1"]);
    let path = blocks.join("0001/run.json");
    let running = text(&path).replacen("\"status\": \"finished\"", "\"status\": \"running\"", 1);
    std::fs::write(&path, running).unwrap();
    let (status, shown, _) = run(&["cluster", "status", dir]);
    assert_eq!(status, 0);
    for words in [
        "0..3 ",
        "3..7 ",
        "7..11",
        "finished",
        "last written",
        "1 finished, 1 running, 1 missing",
        "not joined",
    ] {
        assert!(shown.contains(words), "`{words}` is missing:\n{shown}");
    }
    let (status, _, said) = run(&["cluster", "merge", dir]);
    assert!(status == 2 && said.contains("not finished are blocks 1-2"), "{said}");

    let (status, _, said) = run(&["cluster", "block", dir, "1"]);
    assert!(status == 0 && said.contains("--resume"), "{said}");
    let (status, _, said) = run(&["cluster", "block", dir, "1"]);
    assert!(status == 0 && said.contains("block 1 is finished"), "{said}");
    assert_eq!(run(&["cluster", "status", dir, "--unfinished"]).1, "2\n");
    assert_eq!(run(&["cluster", "status", dir, "--unfinished", "--except", "0,2"]).1, "\n");
    gillesph(&["cluster", "block", dir, "2"]);
    gillesph(&["cluster", "merge", dir]);
    // Again, for a job that is run twice.
    gillesph(&["cluster", "merge", dir]);
    assert!(run(&["cluster", "status", dir]).1.contains("3 finished; 11 of 11 realizations"));
    assert_eq!(run(&["cluster", "status", dir, "--unfinished"]).1, "joined\n");

    let direct = bench.run(&bench.model("m.yaml", MODEL), "direct", &set);
    assert_eq!(record(&direct)["model"]["hash"], record(&out)["model"]["hash"]);
    assert!(files(&direct.join("tables")) == files(&out.join("tables")), "the tables differ");
}

#[test]
fn scripts_can_be_written_anew_for_the_same_ensemble_only() {
    let bench = Bench::new();
    let out = folder(&bench, "slurm", &["--blocks", "2"]);
    gillesph(&["cluster", "block", out.to_str().unwrap(), "0"]);
    // More memory, another scheduler: the finished block stays.
    folder(&bench, "slurm", &["--blocks", "2", "--memory", "8G"]);
    folder(&bench, "snakemake", &["--blocks", "2"]);
    assert!(text(&out.join("cluster/block.sh")).contains("--mem=8G"));
    assert_eq!(run(&["cluster", "status", out.to_str().unwrap(), "--unfinished"]).1, "1\n");

    let model = bench.path("m.yaml");
    let model = model.to_str().unwrap();
    let arguments = ["cluster", "slurm", model, "--out", out.to_str().unwrap()];
    let changed = |options: &[&str]| {
        let (status, _, said) = run(&[&arguments[..], options].concat());
        assert_eq!(status, 2, "{said}");
        said
    };
    let said = changed(&["--blocks", "5", "--seed", "6", "--realizations", "20", "--set", "initial.A=1"]);
    for words in [
        "the seed was 5, now 6",
        "the number of blocks was 2, now 5",
        "the number of realizations was 10, now 20",
        "the model (its text, or a value given with --set) was",
        "4 faults; nothing was written",
    ] {
        assert!(said.contains(words), "`{words}` is missing: {said}");
    }
    // Blocks of another version of the program cannot be joined with ours.
    let description = out.join("cluster/cluster.json");
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    std::fs::write(&description, text(&description).replace(&version, "\"version\": \"0.0.9\"")).unwrap();
    let (status, _, said) = run(&["cluster", "block", out.to_str().unwrap(), "1"]);
    assert!(status == 2 && said.contains("version 0.0.9"), "{said}");
}

#[rstest]
#[case::no_block(&["--blocks", "0"], "--blocks 0: at least one block is needed")]
#[case::too_many_blocks(&["--blocks", "11"], "--blocks 11: more blocks than realizations (10)")]
#[case::no_realization(&["--blocks", "2", "--realizations", "0"], "--realizations 0: at least one realization is needed")]
#[case::time(&["--blocks", "2", "--time", "2h"], "--time 2h: expected a time limit")]
#[case::memory(&["--blocks", "2", "--memory", "4GB"], "--memory 4GB: expected a whole number with K, M, G or T")]
#[case::threads(&["--blocks", "2", "--threads", "0"], "--threads 0: expected 1 to 4096 threads")]
#[case::partition(&["--blocks", "2", "--partition", "a b"], "--partition a b: expected the name of a partition")]
#[case::value(&["--blocks", "2", "--set", "run.unti=1 s"], "unti")]
#[case::run_there(&["--blocks", "2", "--out", "run"], "run already holds a run")]
#[case::other_there(&["--blocks", "2", "--out", "other"], "other/cluster is there and holds no blocks of an ensemble")]
#[case::file_there(&["--blocks", "2", "--out", "m.yaml"], "m.yaml is not a folder")]
#[case::below_file(&["--blocks", "2", "--out", "m.yaml/x"], "m.yaml/x: ")]
fn bad_input_is_refused_and_nothing_is_written(#[case] options: &[&str], #[case] reason: &str) {
    let bench = Bench::new();
    let model = bench.model("m.yaml", MODEL);
    let here = model.parent().unwrap();
    bench.run(&model, "run", &[]);
    std::fs::create_dir_all(bench.path("other/cluster")).unwrap();
    let before = files(here);
    for verb in ["slurm", "snakemake"] {
        let output = Command::new(env!("CARGO_BIN_EXE_gillesph"))
            .current_dir(here)
            .args(["cluster", verb, "m.yaml"])
            .args(options)
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            output.stdout.is_empty() && said.contains(reason) && said.contains("nothing was written"),
            "{said}"
        );
        assert!(files(here) == before, "something was written");
    }
}

#[test]
fn a_folder_that_is_none_a_block_that_is_not_there_a_model_that_cannot_be_copied() {
    let bench = Bench::new();
    let out = folder(&bench, "snakemake", &["--blocks", "2"]);
    let (status, _, said) = run(&["cluster", "block", out.to_str().unwrap(), "2"]);
    assert!(status == 2 && said.contains("there is no block 2") && said.contains("from 0 to 1"), "{said}");
    let nowhere = bench.path("nowhere");
    for verb in ["status", "merge"] {
        let (status, _, said) = run(&["cluster", verb, nowhere.to_str().unwrap()]);
        assert!(status == 2 && said.contains("holds no blocks of an ensemble"), "{said}");
    }
    let (status, _, said) = run(&["cluster", "slurm", nowhere.to_str().unwrap(), "--blocks", "2"]);
    assert!(status == 2 && said.contains("does not exist"), "{said}");

    // Blocks that run apart cannot tell when all of them together know enough.
    let asked = "run: { until_precision: { quantity: A at 1 s, relative_error: 1 %, confidence: 95 %, at_most: 1000 }, ";
    let model = bench.model("asked.yaml", &MODEL.replace("run: {", asked).replace("realizations: 10, ", ""));
    let (status, _, said) = run(&["cluster", "slurm", model.to_str().unwrap(), "--blocks", "2"]);
    assert!(status == 2 && said.contains("until_precision chooses the number of realizations"), "{said}");

    // A reactions file named by its whole path would be read from there, changed or not.
    let reactions = bench.model(
        "r.yaml",
        "species: { A: }\nkinetics: molecules\nreactions: { a: { equation: A -> 0, rate: 1 1/s } }\n",
    );
    let shown = reactions.display();
    let model = bench.model("whole.yaml", &format!("name: w\nreactions: {shown}\ndomain: {{ kind: well_mixed, volume: 1 fL }}\nrun: {{ until: 1 s, realizations: 4 }}\n"));
    let target = bench.path("new");
    let (status, _, said) = run(&[
        "cluster",
        "slurm",
        model.to_str().unwrap(),
        "--blocks",
        "2",
        "--out",
        target.to_str().unwrap(),
    ]);
    assert!(status == 2 && said.contains("cannot be copied"), "{said}");
    assert!(!target.exists(), "something was written");
}

#[test]
fn a_flow_that_is_replayed_goes_with_the_model() {
    let bench = Bench::new();
    let text = channel("{ representation: discrete }", "{ until: 0.2 ms, realizations: 4, seed: 5 }")
        .replace("every: 0.2 ms", "every: 0.1 ms")
        .replace("times: [0, 0.2 ms]", "times: [0]");
    let model =
        |what: &str| bench.model("m.yaml", &format!("{text}flow: {{ {what}: flows/channel.flow }}\n"));
    let recording = model("record");
    let out = bench.path("out");
    let arguments =
        ["cluster", "slurm", recording.to_str().unwrap(), "--blocks", "2", "--out", out.to_str().unwrap()];
    let (status, _, said) = run(&arguments);
    assert!(status == 2 && said.contains("each of them would write that file") && !out.exists(), "{said}");

    std::fs::create_dir(bench.path("flows")).unwrap();
    bench.run(&recording, "recorded", &["--realizations", "1"]);
    let replaying = model("replay");
    gillesph(&arguments);
    let direct = bench.run(&replaying, "direct", &[]);
    // The blocks have a copy.
    std::fs::remove_file(bench.path("flows/channel.flow")).unwrap();
    for k in ["0", "1"] {
        gillesph(&["cluster", "block", out.to_str().unwrap(), k]);
    }
    gillesph(&["cluster", "merge", out.to_str().unwrap()]);
    assert!(files(&direct.join("tables")) == files(&out.join("tables")), "the tables differ");
}

#[test]
fn a_model_keeps_its_reactions_file() {
    let bench = Bench::new();
    let out = bench.path("out");
    let model = shipped("models/dimerisation.yaml");
    gillesph(&["cluster", "slurm", model.to_str().unwrap(), "--blocks", "3", "--out", out.to_str().unwrap()]);
    for file in ["models/dimerisation.yaml", "reactions/dimerisation.yaml"] {
        assert_eq!(text(&out.join("cluster/input").join(file)), text(&shipped(file)), "{file}");
    }
}

#[test]
fn a_snakefile_has_a_rule_for_blocks_and_one_that_joins_them() {
    let bench = Bench::new();
    let options =
        ["--blocks", "7", "--time", "90", "--memory", "2G", "--threads", "3", "--partition", "long"];
    let out = folder(&bench, "snakemake", &options);
    let text = text(&out.join("cluster/Snakefile"));
    for words in [
        "rule all:",
        "rule block:",
        "rule merge:",
        "for k in range(7)",
        "threads: 3",
        "runtime=90,",
        "mem_mb=2048,",
        "slurm_partition=\"long\",",
        "{GILLESPH:q} cluster block . {wildcards.block} --threads {threads} 2>> {log:q}",
        "{GILLESPH:q} cluster merge . 2>> {log:q}",
        &format!("os.environ.get(\"GILLESPH\", \"{}\")", env!("CARGO_BIN_EXE_gillesph")),
    ] {
        assert!(text.contains(words), "`{words}` is missing:\n{text}");
    }
    // Written for Python: no tabs, brackets that close, no place left.
    assert!(!text.contains('\t') && !text.contains("@B") && !text.contains("@R"));
    for (open, close) in [('(', ')'), ('[', ']'), ('{', '}')] {
        assert_eq!(text.matches(open).count(), text.matches(close).count(), "{open}{close}");
    }
}
