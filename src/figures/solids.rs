//! Elastic solids: where their particles are and what they carry, their outlines in time, the course of their measures.

mod courses;
mod outlines;
mod snapshots;

use super::{Figure, Samples};
use crate::tables::ProbeRows;

pub use courses::{courses, ends};

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

/// Rows of one probe and quantity.
fn rows<'a>(samples: &'a Samples, probe: &str, quantity: &str) -> Vec<&'a ProbeRows> {
    samples.probes.iter().filter(|r| r.probe == probe && r.quantity == quantity).collect()
}

/// Words for a quantity as the tables name it.
#[must_use]
pub fn words(quantity: &str) -> String {
    quantity.replace('_', " ")
}
