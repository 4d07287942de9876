//! Elastic solids: where their particles are and what they carry, their outlines in time, the course of their measures.

mod courses;
mod outlines;
mod snapshots;

use super::{Figure, Samples};
use crate::tables::{ParticleFrame, ProbeRows};

pub use courses::{Course, courses, ends, round};

/// Figures of every elastic solid, and of the points that were followed.
pub fn solids(samples: &Samples) -> Vec<Figure> {
    let mut out = Vec::new();
    for name in names(samples) {
        out.extend(snapshots::snapshots(samples, name));
        out.extend(outlines::outlines(samples, name));
        out.extend(courses::course(samples, name));
        out.extend(courses::distributions(samples, name));
    }
    out.extend(courses::points(samples));
    out
}

/// The elastic solids of a run.
#[must_use]
pub fn names(samples: &Samples) -> Vec<&str> {
    samples.record.probes.iter().filter(|p| p.kind == "solid").map(|p| p.name.as_str()).collect()
}

/// The probe that holds the outline of a solid.
#[must_use]
pub fn outline(name: &str) -> String {
    format!("{name} outline")
}

/// Whether a probe is the outline of a solid: drawn with it, not along a line.
#[must_use]
pub fn is_outline(samples: &Samples, probe: &str) -> bool {
    names(samples).into_iter().any(|name| outline(name) == probe)
}

/// Whether each particle is of a solid. Surfaces and zones take particles of a solid into their own group: those that are
/// ever stressed or stretched belong to the solid that is next by number.
fn members(samples: &Samples, name: &str) -> Vec<bool> {
    let frames = &samples.frames;
    let count = frames.iter().map(ParticleFrame::len).max().unwrap_or(0);
    let groups = &samples.record.domain.groups;
    let zone = |group: &str| {
        groups.iter().any(|g| g.name == group && (g.material == "zone" || g.material == "surface"))
    };
    let solid = |group: &str| names(samples).contains(&group);
    let ever = |of: &dyn Fn(&ParticleFrame, usize) -> bool| -> Vec<bool> {
        (0..count).map(|i| frames.iter().any(|f| i < f.len() && of(f, i))).collect()
    };
    let known = ever(&|f, i| solid(f.group_name(i)));
    let mut own = ever(&|f, i| f.group_name(i) == name);
    let taken = ever(&|f, i| zone(f.group_name(i)) && is_strained(f, i));
    let numbers: Vec<usize> = (0..count).filter(|&i| known[i]).collect();
    for i in (0..count).filter(|&i| taken[i] && !known[i]) {
        let after = numbers.partition_point(|&n| n < i);
        let beside = [after.checked_sub(1), Some(after)].into_iter().flatten().filter_map(|k| numbers.get(k));
        own[i] = beside.min_by_key(|n| n.abs_diff(i)).is_some_and(|&n| own[n]);
    }
    own
}

/// Whether a particle shows that it is elastic.
pub(super) fn is_strained(frame: &ParticleFrame, i: usize) -> bool {
    let at = |values: &[f64], rest: f64| values.get(i).is_some_and(|v| v.is_finite() && *v != rest);
    at(&frame.stress, 0.0) || at(&frame.stretch, 1.0)
}

/// Rows of one probe and quantity.
fn rows<'a>(samples: &'a Samples, probe: &str, quantity: &str) -> Vec<&'a ProbeRows> {
    samples.probes.iter().filter(|r| r.probe == probe && r.quantity == quantity).collect()
}

/// Words for a quantity as the tables name it.
#[must_use]
pub fn words(quantity: &str) -> String {
    quantity.replace('_', " ")
}
