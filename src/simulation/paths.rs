//! Whether a species that is confined to groups can get from one to another by its hops.

use crate::chemistry::split::Frozen;
use crate::error::{Fault, ModelError};
use crate::plan::Plan;

/// Refuses species with a diffusivity and an `only_in` whose groups no chain of hops connects, or inside of which
/// there is no hop at all.
///
/// Parts of one group may lie apart (two cells of one kind): a molecule stays in its own.
///
/// # Errors
/// All faults, each at the species.
pub(super) fn check(plan: &Plan, frozen: &Frozen, groups: &[usize]) -> Result<(), ModelError> {
    let names = plan.model.domain.group_names();
    let mut faults = Vec::new();
    for (s, species) in plan.network.species.iter().enumerate() {
        let (Some(only_in), Some(table)) = (&species.only_in, frozen.table(s)) else { continue };
        let lives = |i: usize| plan.reactor.habitat[s].holds(frozen.home[i]);
        let named: Vec<usize> =
            (0..names.len()).filter(|&g| only_in.iter().any(|named| named.name == names[g])).collect();
        let hops = (0..frozen.voxels()).any(|i| lives(i) && table.leaving[i] > 0.0);
        // Groups joined by links, from each to the first of its set.
        let mut set: Vec<usize> = (0..names.len()).collect();
        for i in (0..frozen.voxels()).filter(|&i| lives(i)) {
            for (j, p) in table.row(i) {
                let (a, b) = (set[groups[i]], set[groups[j]]);
                if p > 0.0 && a != b && lives(j) {
                    set.iter_mut().filter(|root| **root == a.max(b)).for_each(|root| *root = a.min(b));
                }
            }
        }
        let apart = named.iter().find(|&&g| set[g] != set[named[0]]);
        let reason = match (hops, apart) {
            (false, _) => format!(
                "`{}` diffuses but has nowhere to hop: no link joins two voxels of {}",
                species.name,
                only_in.iter().map(|named| named.name.as_str()).collect::<Vec<_>>().join(", ")
            ),
            (true, Some(&g)) => format!(
                "`{}` cannot get from `{}` to `{}`: no path of hops leads through the groups it may live in",
                species.name, names[named[0]], names[g]
            ),
            (true, None) => continue,
        };
        let remedy = "set its diffusion to 0, link the groups, or add those in between to its `only_in`";
        faults.push(Fault::at(&species.place, reason, remedy));
    }
    if faults.is_empty() { Ok(()) } else { Err(ModelError::sorted(faults)) }
}
