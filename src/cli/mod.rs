//! The command line: verbs, exit statuses, where messages go.
//!
//! Standard output carries only what was asked for; faults, progress and notes go to standard error.

/// A line on standard error; what cannot be told there (a closed pipe) is left untold.
macro_rules! tell {
    ($($words:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stderr(), $($words)*);
    }};
}

mod check;
mod cluster;
mod compare;
mod import;
mod job;
mod run;
mod sweep;
mod verbs;

use crate::error::{ModelError, RunError};
use crate::validation::Scope;
use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// Stochastic chemistry in moving fluids and living walls.
#[derive(Parser)]
#[command(name = "gillesph", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Read and check a model or a reactions file and print the compiled plan
    Check {
        /// Model or reactions file
        file: PathBuf,
        /// Change a value of the model, e.g. --set run.until="1 s" (repeatable)
        #[arg(long, value_name = "PATH=VALUE")]
        set: Vec<String>,
    },
    /// Run the ensemble and write tables, figures and report
    Run(run::Options),
    /// Draw figures and report.html of a finished run again from its tables
    Report {
        /// Folder of the run
        dir: PathBuf,
    },
    /// Join blocks of one ensemble that ran apart; the result is identical to one run
    Merge {
        /// Folder to write
        out: PathBuf,
        /// Folders of the blocks
        #[arg(required = true)]
        blocks: Vec<PathBuf>,
        /// Replace a folder that already holds a run
        #[arg(long)]
        force: bool,
    },
    /// Run an ensemble on a cluster as many jobs: scripts for Slurm or Snakemake, and where its blocks stand
    Cluster {
        #[command(subcommand)]
        task: cluster::Task,
    },
    /// Compare two runs: which means and variances differ, and what a difference would have to be to be seen
    ///
    /// Every amount that both runs hold is tested at each output time for its mean (t test) and its variance
    /// (O'Brien 1981). The chance of any false alarm over all of them is --level (Holm 1979). Runs of one
    /// seed share their random numbers and are compared in pairs. Differences are b - a, relative ones in
    /// units of a; "sees 80 %" is the smallest true relative difference that this comparison finds with 80 %
    /// power.
    ///
    /// Exit status, as of diff: 0 no difference found, 1 the runs differ, 2 the input is wrong.
    Compare(compare::Options),
    /// Show the reaction network as a graph: conservation laws, orders, linkage classes, deficiency
    Network {
        /// Model or reactions file
        file: PathBuf,
        /// Print an SVG picture
        #[arg(long, conflicts_with = "dot")]
        svg: bool,
        /// Print a Graphviz graph
        #[arg(long)]
        dot: bool,
    },
    /// Run published cases and print ours beside the published and reference values
    Validate {
        /// Names of cases; all if none is given
        cases: Vec<String>,
        /// List the cases
        #[arg(long)]
        list: bool,
        /// All resolutions, also those that take long
        #[arg(long)]
        full: bool,
        /// Of cases with parts only those whose name holds TEXT: `Re 1000 200`, `Ra 1e5 100`, `320`
        #[arg(long, value_name = "TEXT")]
        only: Option<String>,
        /// Folder for tables and figures, one folder a case in it
        #[arg(long, default_value = "reports/validation")]
        out: PathBuf,
    },
    /// Write a model from a file of another program
    Import {
        #[command(subcommand)]
        format: import::Format,
    },
    /// Print shell completions
    Completions {
        /// Shell to complete for
        shell: clap_complete::Shell,
    },
}

/// What ends a verb before its work is done.
pub(crate) enum Stop {
    /// The input is wrong: exit status 2.
    Model(ModelError),
    /// The run failed: exit status 1.
    Run(RunError),
    /// Interrupted: exit status 130.
    Interrupted,
    /// Already reported; just the status.
    Status(u8),
}

impl From<ModelError> for Stop {
    fn from(error: ModelError) -> Stop {
        Stop::Model(error)
    }
}

impl From<crate::error::Fault> for Stop {
    fn from(fault: crate::error::Fault) -> Stop {
        Stop::Model(fault.into())
    }
}

impl From<RunError> for Stop {
    fn from(error: RunError) -> Stop {
        Stop::Run(error)
    }
}

/// Parses the command line, does what it says, and reports faults.
#[must_use]
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    std::panic::set_hook(Box::new(|info| {
        tell!("gillesph met a state it should never be in; please report this with your model: {info}");
    }));
    let result = std::panic::catch_unwind(|| perform(arguments.verb)).unwrap_or(Err(Stop::Status(1)));
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Stop::Model(error)) => {
            let count = error.faults.len();
            eprint!("{error}");
            tell!("{count} fault{}; nothing was written", if count == 1 { "" } else { "s" });
            ExitCode::from(2)
        }
        Err(Stop::Run(error)) => {
            tell!("failed: {error}");
            ExitCode::from(1)
        }
        Err(Stop::Interrupted) => ExitCode::from(130),
        Err(Stop::Status(status)) => ExitCode::from(status),
    }
}

fn perform(verb: Verb) -> Result<(), Stop> {
    match verb {
        Verb::Check { file, set } => check::check(&file, &set),
        Verb::Run(options) => run::run(&options),
        Verb::Report { dir } => verbs::report(&dir),
        Verb::Merge { out, blocks, force } => verbs::merge(&out, &blocks, force),
        Verb::Cluster { task } => cluster::cluster(&task),
        Verb::Compare(options) => compare::compare(&options),
        Verb::Network { file, svg, dot } => verbs::network(&file, svg, dot),
        Verb::Validate { cases, list, full, only, out } => {
            verbs::validate(&cases, list, Scope { full, only: only.as_deref(), met: None }, &out)
        }
        Verb::Import { format } => import::import(&format),
        Verb::Completions { shell } => {
            verbs::completions(shell, &mut <Arguments as clap::CommandFactory>::command());
            Ok(())
        }
    }
}

/// Does what a user would have typed.
pub(crate) fn perform_words(words: Vec<std::ffi::OsString>) -> Result<(), Stop> {
    let shown: Vec<String> = words.iter().map(|word| crate::cluster::word(&word.to_string_lossy())).collect();
    tell!("{}", shown.join(" "));
    perform(Arguments::parse_from(words).verb)
}

/// Prints text asked for; a closed pipe is no fault.
pub(crate) fn print(text: &str) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes());
    let _ = out.flush();
}
