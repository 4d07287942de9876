//! Which reactions happen in which voxels, and how: sampled or integrated.

use crate::chemistry::propensity::Propensities;
use crate::chemistry::reactor::Reactor;

/// Reactions of voxels that share home group, current group and surfaces.
#[derive(Clone, Debug)]
pub(super) struct Kind {
    place: (u8, u8, u64),
    /// By mode of the hybrid species; one entry if there are none.
    pub lists: Vec<Lists>,
}

/// The reactions of a voxel by the way they are treated.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    /// By events: a participant is discrete.
    pub sampled: Vec<u32>,
    /// By rate equations: every participant is continuous.
    pub integrated: Vec<u32>,
    /// Whether one sort changes what the other reads.
    pub coupled: bool,
    /// Whether events are all that happens: nothing is integrated, no real amount is taken from, nothing comes through a surface.
    pub plain: bool,
    /// Sampled reactions that take whole molecules out of a continuous amount.
    pub taking: Vec<u32>,
}

impl Lists {
    fn sort(propensities: &Propensities, here: &[u32], weighted: bool) -> Lists {
        let (sampled, integrated): (Vec<u32>, Vec<u32>) =
            here.iter().partition(|&&r| propensities.stochastic(r as usize));
        let changes = |list: &[u32], s: u32| {
            list.iter().any(|&r| propensities.changes(r as usize).iter().any(|c| c.0 == s))
        };
        let reads = |list: &[u32], s: u32| list.iter().any(|&r| propensities.inputs(r as usize).contains(&s));
        let coupled = (0..propensities.species() as u32).any(|s| {
            changes(&integrated, s) && (reads(&sampled, s) || changes(&sampled, s))
                || changes(&sampled, s) && reads(&integrated, s)
        });
        let takes = |&r: &u32| {
            let mut changes = propensities.changes(r as usize).iter();
            changes.any(|&(s, change)| change < 0.0 && !propensities.whole(s as usize))
        };
        let taking: Vec<u32> = sampled.iter().copied().filter(takes).collect();
        let plain = integrated.is_empty() && taking.is_empty() && !weighted;
        Lists { sampled, integrated, coupled, plain, taking }
    }
}

/// The distinct kinds of voxel, and the kind of each; `surfaces(i)` is the set of surface reactions of voxel i,
/// one bit each in their order among the surface reactions.
pub(super) fn sort_into_kinds(
    reactor: &Reactor,
    home: &[u8],
    current: &[u8],
    surfaces: impl Fn(usize) -> u64,
) -> (Vec<Kind>, Vec<u32>) {
    let mut kinds: Vec<Kind> = Vec::new();
    let mut last = 0;
    let mut kind = Vec::with_capacity(home.len());
    for (i, (&home, &current)) in home.iter().zip(current).enumerate() {
        let place = (home, current, surfaces(i));
        if kinds.get(last).is_none_or(|k| k.place != place) {
            last = kinds.iter().position(|k| k.place == place).unwrap_or_else(|| {
                kinds.push(Kind { place, lists: lists(reactor, place) });
                kinds.len() - 1
            });
        }
        kind.push(last as u32);
    }
    (kinds, kind)
}

fn lists(reactor: &Reactor, (home, current, surfaces): (u8, u8, u64)) -> Vec<Lists> {
    let mut bit = 0;
    let mut here = Vec::new();
    for r in 0..reactor.propensities.len() {
        let mut happens = reactor.happens(r, home, current);
        if reactor.surface[r] {
            happens &= surfaces >> bit & 1 == 1;
            bit += 1;
        }
        if happens {
            here.push(r as u32);
        }
    }
    let weighted = here.iter().any(|&r| reactor.surface[r as usize]);
    let modes = reactor.hybrid.as_ref().map_or(1, |hybrid| hybrid.modes());
    (0..modes).map(|mode| Lists::sort(reactor.propensities_in(mode as u8), &here, weighted)).collect()
}
