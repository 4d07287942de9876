//! Progress on the terminal, and the wish to stop.

use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Shows progress and tells whether the user wants to stop.
pub struct Watch {
    stop: Arc<AtomicBool>,
    bar: ProgressBar,
}

impl Watch {
    /// Shows nothing and never stops.
    #[must_use]
    pub fn silent() -> Watch {
        Watch { stop: Arc::default(), bar: ProgressBar::hidden() }
    }

    /// A progress bar on standard error if that is a terminal and `quiet` is not set. Ctrl-C once asks to stop;
    /// twice stops at once.
    #[must_use]
    pub fn on_terminal(quiet: bool) -> Watch {
        let stop = Arc::new(AtomicBool::new(false));
        let asked = stop.clone();
        // A handler that cannot be set leaves Ctrl-C to end the program at once.
        let _ = ctrlc::set_handler(move || {
            if asked.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
            eprintln!("\nstopping after this step; once more to stop at once");
        });
        let hidden = quiet || !std::io::stderr().is_terminal();
        Watch { stop, bar: if hidden { ProgressBar::hidden() } else { ProgressBar::new(0) } }
    }

    /// Begins to count to `total` in `unit`s.
    pub fn begin(&self, total: u64, unit: &'static str) {
        let style = ProgressStyle::with_template(
            "{elapsed_precise} [{bar:30.cyan/blue}] {pos}/{len} {prefix} ({rate}, {eta} left)  {msg}",
        );
        if let Ok(style) = style {
            self.bar.set_style(style.progress_chars("=> ").with_key("rate", rate));
        }
        self.bar.set_length(total);
        self.bar.set_position(0);
        self.bar.reset();
        self.bar.set_prefix(unit);
    }

    /// Shows what is known by now.
    pub fn tell(&self, words: String) {
        self.bar.set_message(words);
    }

    /// Counts `done` more.
    pub fn advance(&self, done: u64) {
        self.bar.inc(done);
    }

    /// Removes the bar.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }

    /// Whether the user wants to stop.
    #[must_use]
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Steps or realizations a second, with one decimal where there are few.
fn rate(state: &ProgressState, out: &mut dyn Write) {
    let rate = state.per_sec();
    // The bar is decoration: what cannot be written is left out.
    let _ = if rate < 100.0 { write!(out, "{rate:.1}/s") } else { write!(out, "{rate:.0}/s") };
}
