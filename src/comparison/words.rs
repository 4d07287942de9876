//! A comparison in words: what was compared, the table, the verdict.

use super::shared::list;
use super::{Comparison, POWER, Pairing, SideRecord};
use crate::quantity::readable::{show, significant};
use crate::tables::ComparisonRow;
use std::fmt::Write;

/// Differences named in the verdict.
const NAMED: usize = 4;

/// `RL in membrane at 800 ms`.
fn quantity(row: &ComparisonRow) -> String {
    format!("{} in {} at {}", row.species, row.group, show(row.time, "s"))
}

fn percent(share: f64) -> String {
    if share.is_finite() { format!("{} %", significant(100.0 * share, 2)) } else { "–".into() }
}

fn signed(share: f64) -> String {
    let sign = if share > 0.0 { "+" } else { "" };
    if share.is_finite() { format!("{sign}{}", percent(share)) } else { "–".into() }
}

fn probability(p: f64) -> String {
    if p == 0.0 { "0".into() } else { significant(p, 2) }
}

/// The verdict: what differs, or what would have been seen.
pub(super) fn verdict(comparison: &Comparison) -> String {
    if comparison.rows.is_empty() {
        return match comparison.equal {
            0 => "nothing to compare".into(),
            1 => "no difference: the one quantity is equal, value by value".into(),
            equal => format!("no difference: all {equal} quantities are equal, value by value"),
        };
    }
    let power = percent(POWER);
    if comparison.differs {
        let found: Vec<&ComparisonRow> = comparison.rows.iter().filter(|row| row.differs).collect();
        let mut named: Vec<String> = found.iter().take(NAMED).map(|row| difference(row)).collect();
        if found.len() > NAMED {
            named.push(format!("and {} more", found.len() - NAMED));
        }
        return format!("differs: {}", named.join("; "));
    }
    let parts: Vec<String> =
        ["mean", "variance"].iter().filter_map(|moment| sight(&comparison.rows, moment)).collect();
    if parts.is_empty() {
        return "no difference found".into();
    }
    format!("no difference found: would have seen, with {power} power, {}", parts.join("; "))
}

/// `RL in membrane at 800 ms, mean +2.1 % ± 0.3 %`.
fn difference(row: &ComparisonRow) -> String {
    let size = if row.relative.is_finite() {
        let error = percent(row.standard_error / row.a.abs());
        let error = if row.standard_error > 0.0 { format!(" ± {error}") } else { String::new() };
        format!("{}{error}", signed(row.relative))
    } else {
        format!("{} instead of {}", significant(row.b, 3), significant(row.a, 3))
    };
    format!("{}, {} {size}", quantity(row), row.moment)
}

/// The smallest differences seen: `1.3 % or more in the mean of X in all at 60 s (3.5 % in half of 20 means,
/// 12 % in all of them)`.
fn sight(rows: &[ComparisonRow], moment: &str) -> Option<String> {
    let mut known: Vec<&ComparisonRow> =
        rows.iter().filter(|row| row.moment == moment && row.detectable.is_finite()).collect();
    known.sort_by(|a, b| a.detectable.total_cmp(&b.detectable));
    let (first, last) = (known.first()?, known.last()?);
    let best = format!("{} or more in the {moment} of {}", percent(first.detectable), quantity(first));
    if known.len() == 1 {
        return Some(best);
    }
    let middle = known[(known.len() - 1) / 2];
    Some(format!(
        "{best} ({} in half of {} {moment}s, {} in all of them)",
        percent(middle.detectable),
        known.len(),
        percent(last.detectable)
    ))
}

impl Comparison {
    /// The comparison as text: heading, table (the first `shown` rows), verdict.
    #[must_use]
    pub fn text(&self, shown: usize) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let mut line = |words: String| {
            let _ = writeln!(out, "{words}");
        };
        let side = |side: &SideRecord| {
            format!(
                "{} ({}, seed {}, {} realizations)",
                side.folder, side.model, side.seed, side.realizations
            )
        };
        line(format!("a: {}", side(&self.a)));
        line(format!("b: {}", side(&self.b)));
        line(match self.pairing {
            Pairing::Paired => "one seed: compared realization by realization, paired t tests".into(),
            Pairing::Independent => "independent realizations: Welch's t tests".into(),
        });
        if !self.rows.is_empty() {
            line(format!(
                "{} and {} (O'Brien), any false alarm with a chance of {} (Holm)",
                counted(self.means, "mean", "means"),
                counted(self.variances, "variance", "variances"),
                percent(self.level)
            ));
        }
        for note in self.notes() {
            line(note);
        }
        if !self.rows.is_empty() {
            line(String::new());
            for words in self.table(shown) {
                line(words);
            }
            if shown < self.rows.len() {
                line(format!("{} more rows, the likelier ones; --all shows them", self.rows.len() - shown));
            }
        }
        line(format!("\n{}", self.verdict));
        out
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.equal > 0 {
            notes.push(format!(
                "left out: {} equal in every realization",
                counted(self.equal, "quantity", "quantities")
            ));
        }
        if self.repeated > 0 {
            notes.push(format!(
                "left out: {} with the numbers of another group",
                counted(self.repeated, "quantity", "quantities")
            ));
        }
        for (side, names, times) in
            [("a", &self.only_a, &self.times_only_a), ("b", &self.only_b, &self.times_only_b)]
        {
            if !names.is_empty() {
                notes.push(format!("only in {side}: {}", list(names)));
            }
            if !times.is_empty() {
                let times: Vec<String> = times.iter().map(|t| show(*t, "s")).collect();
                notes.push(format!("only in {side}: {}", list(&times)));
            }
        }
        notes
    }

    fn table(&self, shown: usize) -> Vec<String> {
        let sees = format!("sees {}", percent(POWER));
        let mut head = vec!["quantity", "", "a", "b", "relative", "error", "t", "p", "p (Holm)", &sees];
        if self.difference.is_some() {
            head.push("power");
        }
        head.push("");
        let mut cells: Vec<Vec<String>> = vec![head.into_iter().map(String::from).collect()];
        for row in self.rows.iter().take(shown) {
            let mut one = vec![
                quantity(row),
                row.moment.to_string(),
                significant(row.a, 4),
                significant(row.b, 4),
                signed(row.relative),
                percent(row.standard_error / row.a.abs()),
                if row.t.is_finite() { significant(row.t, 3) } else { row.judged.to_string() },
                probability(row.p),
                probability(row.p_adjusted),
                percent(row.detectable),
            ];
            if self.difference.is_some() {
                one.push(percent(row.power));
            }
            one.push(if row.differs { "differs".into() } else { String::new() });
            cells.push(one);
        }
        let width = |k: usize| cells.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..cells[0].len()).map(width).collect();
        let line = |row: &Vec<String>| {
            let parts: Vec<String> = row
                .iter()
                .zip(&widths)
                .enumerate()
                .map(|(k, (cell, &width))| {
                    // Words to the left, numbers to the right.
                    if k < 2 || k + 1 == row.len() {
                        format!("{cell:<width$}")
                    } else {
                        format!("{cell:>width$}")
                    }
                })
                .collect();
            parts.join("  ").trim_end().to_string()
        };
        cells.iter().map(line).collect()
    }
}

fn counted(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}
