//! `run.until_precision`: which number must be known how well before a run may stop.

use super::domain::Domain;
use super::names::{group_index, species_index};
use super::node::Node;
use super::reader::{Faults, Fields};
use super::times::End;
use crate::chemistry::Network;
use crate::error::Fault;
use crate::quantity::{Dimension, Quantity};

/// Stop once the confidence interval of the mean amount of a species in a group at a time is narrow enough.
#[derive(Clone, Debug, PartialEq)]
pub struct Precision {
    pub species: usize,
    /// `None`: the whole domain.
    pub group: Option<usize>,
    /// One of the output times, s.
    pub time: f64,
    /// Half the width of the interval over the mean.
    pub relative_error: f64,
    pub confidence: f64,
    /// Realizations after which the run stops in any case.
    pub at_most: u32,
}

/// Realizations before the first look. The spread must be known before it can say when to stop: from fewer, runs whose
/// spread looks small by chance stop early.
pub const FIRST_LOOK: u32 = 100;

/// Reads the field of `run:`.
pub(super) fn read(
    node: &Node,
    end: End,
    domain: &Domain,
    network: &Network,
    faults: &mut Faults,
) -> Option<Precision> {
    let mut fields = Fields::of(node, "until_precision", faults)?;
    let quantity =
        fields.required("quantity", faults).and_then(|n| quantity(n, end, domain, network, faults));
    let mut share = |key: &'static str, usual: f64, faults: &mut Faults| -> Option<f64> {
        let Some(n) = fields.optional(key) else { return Some(usual) };
        let value = n.number(faults)?;
        if value > 0.0 && value < 1.0 {
            return Some(value);
        }
        faults.at(
            &n.place,
            format!("expected a share between 0 and 100 %, found {value}"),
            format!("e.g. {key}: {} %", 100.0 * usual),
        );
        None
    };
    let relative_error = share("relative_error", 0.01, faults);
    let confidence = share("confidence", 0.95, faults);
    let at_most = match fields.optional("at_most") {
        None => Some(1_000_000),
        Some(n) => n.integer(faults).and_then(|count| {
            if count < i64::from(FIRST_LOOK) || count > i64::from(u32::MAX) {
                faults.at(
                    &n.place,
                    format!("expected at least {FIRST_LOOK} realizations, found {count}"),
                    format!("the first look is at {FIRST_LOOK} realizations; give more, or leave until_precision out"),
                );
                return None;
            }
            Some(count as u32)
        }),
    };
    fields.finish(faults);
    let (species, group, time) = quantity?;
    Some(Precision {
        species,
        group,
        time,
        relative_error: relative_error?,
        confidence: confidence?,
        at_most: at_most?,
    })
}

/// `SPECIES`, `SPECIES in GROUP`, `SPECIES at TIME`, `SPECIES in GROUP at TIME`; the end if no time is given.
fn quantity(
    node: &Node,
    end: End,
    domain: &Domain,
    network: &Network,
    faults: &mut Faults,
) -> Option<(usize, Option<usize>, f64)> {
    let text = node.text(faults)?;
    let (what, time) = match text.split_once(" at ") {
        None => (text, end.time),
        Some((what, when)) => {
            let offset = text.chars().count() - when.chars().count();
            let place = node.place.inside(offset, when.chars().count());
            let found = match Quantity::parse(when.trim()) {
                Ok(found) if found.dimension == Dimension::TIME || found.dimension.is_none() => found.value,
                Ok(_) => {
                    faults.at(
                        &place,
                        format!("expected a time, found `{when}`"),
                        "e.g. `RL in membrane at 0.8 s`",
                    );
                    return None;
                }
                Err(fault) => {
                    faults.push(Fault::at(&place, fault.reason, fault.remedy));
                    return None;
                }
            };
            if !(0.0..=end.time * (1.0 + 1e-12)).contains(&found) && !end.time.is_nan() {
                let (reason, remedy) =
                    (format!("{found} s lies outside the run of {} s", end.time), "make run.until longer");
                faults.at(&place, reason, remedy);
                return None;
            }
            (what, found.min(end.time))
        }
    };
    let (species, group) = match what.split_once(" in ") {
        None => (what.trim(), None),
        Some((species, group)) => (species.trim(), Some(group.trim())),
    };
    let species = species_index(species, &node.place, network, faults)?;
    let group = match group {
        None | Some("all") => None,
        Some(group) => Some(group_index(group, &node.place, &domain.group_names(), faults)?),
    };
    Some((species, group, time))
}
