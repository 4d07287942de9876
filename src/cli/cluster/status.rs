//! `cluster status`: where the blocks stand.

use crate::cluster::{self, Folder, State};
use std::collections::BTreeSet;

/// The list of blocks to run but some, as schedulers write it; `joined` if nothing is left to do.
pub(super) fn unfinished(folder: &Folder, except: &[u32]) -> String {
    let except: BTreeSet<u32> = except.iter().copied().collect();
    let mut open = folder.unfinished();
    if open.is_empty() && folder.joined() {
        return "joined\n".into();
    }
    open.retain(|k| !except.contains(k));
    cluster::compact(&open) + "\n"
}

/// Where each block stands, and a line for all.
pub(super) fn table(folder: &Folder) -> String {
    let ensemble = &folder.ensemble;
    let mut text = format!("{}, seed {}: {}\n", ensemble.name, ensemble.seed, folder.path.display());
    text.push_str("block  realizations           done  state        wall time\n");
    let states = [
        State::Finished,
        State::Running,
        State::Interrupted,
        State::Failed,
        State::Unreadable,
        State::Missing,
    ];
    let mut counts = [0_u32; 6];
    let (mut done, mut wall) = (0_u64, 0.0);
    for k in 0..ensemble.blocks {
        let (range, standing) = (ensemble.range(k), folder.standing(k));
        let size = range.end - range.start;
        let mut remark = standing.error.clone();
        if let Some(age) = standing.age {
            remark = format!("last written {} ago", duration(age));
        }
        let line = format!(
            "{k:>5}  {:<15} {:>11}  {:<11} {:>10}  {remark}",
            format!("{}..{}", range.start, range.end),
            format!("{}/{size}", standing.finished),
            standing.state.word(),
            if standing.state == State::Missing { "-".into() } else { duration(standing.wall_seconds) },
        );
        text.push_str(line.trim_end());
        text.push('\n');
        done += u64::from(standing.finished);
        wall += standing.wall_seconds;
        if let Some(at) = states.iter().position(|state| *state == standing.state) {
            counts[at] += 1;
        }
    }
    let said: Vec<String> = states
        .iter()
        .zip(counts)
        .filter(|(_, count)| *count > 0)
        .map(|(state, count)| format!("{count} {}", state.word()))
        .collect();
    text.push_str(&format!(
        "{} block{}: {}; {done} of {} realizations, {} in all; {}\n",
        ensemble.blocks,
        if ensemble.blocks == 1 { "" } else { "s" },
        said.join(", "),
        ensemble.realizations,
        duration(wall),
        if folder.joined() { "joined" } else { "not joined" }
    ));
    text
}

/// Seconds as `12.3 s` or `h:mm:ss`.
fn duration(seconds: f64) -> String {
    if seconds < 100.0 {
        return format!("{seconds:.1} s");
    }
    let whole = seconds.round() as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}
