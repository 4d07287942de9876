//! Which method samples the chemistry: by name, or by the size of the network and the number of voxels.

use super::chemistry::hybrid;
use crate::chemistry::Network;
use crate::error::Fault;
use crate::model::{Method, Model, ParticleDomain};

/// Reactions up to which the direct method is the fastest in one volume. Measured on rings of n conversions,
/// million events per second on one core: n = 32: 24 direct, 15 next reaction, 12 composition-rejection;
/// n = 64: 12, 17, 14; n = 128: 10, 11, 21; n = 256: 4, 10, 14.
const FEW_REACTIONS: usize = 48;

/// Volumes up to which the next subvolume method is the faster one on a graph. Measured on chains of n volumes
/// with two species (`cargo bench --bench rdme`), million events per second, next subvolume and
/// composition-rejection: n = 2: 12.2, 10.4; n = 16: 9.7, 10.0; n = 128: 8.0, 9.4; n = 1024: 5.5, 7.3.
const FEW_VOLUMES: usize = 16;

/// The method for compartments, if the model names none:
/// - split where a species is continuous or hybrid, or a chemistry step is given;
/// - one volume: direct up to [`FEW_REACTIONS`] reactions, composition-rejection above;
/// - a graph: next subvolume up to [`FEW_VOLUMES`] volumes of as few reactions, composition-rejection above.
pub fn method(
    model: &Model,
    network: &Network,
    discrete: &[bool],
    volumes: usize,
    faults: &mut Vec<Fault>,
) -> Method {
    let all_discrete = all_discrete(model, network, discrete);
    match model.chemistry.method {
        None if !all_discrete || model.chemistry.step.is_some() => Method::Split,
        None if network.reactions.len() > FEW_REACTIONS => Method::CompositionRejection,
        None if volumes == 1 => Method::Direct,
        None if volumes <= FEW_VOLUMES => Method::NextSubvolume,
        None => Method::CompositionRejection,
        Some(method) => {
            check_discrete(model, method, all_discrete, faults);
            check_step(model, method, faults);
            method
        }
    }
}

/// On particles the split sampler is the choice; event-driven methods only by name, only at rest.
pub fn check_particles(
    model: &Model,
    network: &Network,
    domain: &ParticleDomain,
    discrete: &[bool],
    faults: &mut Vec<Fault>,
) {
    let Some(method) = model.chemistry.method.filter(|method| method.event_driven()) else { return };
    let mut refuse = |reason: &str, remedy: &str| {
        faults.push(Fault::at(&model.places.chemistry, reason, remedy));
    };
    if domain.moves() {
        refuse(
            "an event-driven method needs particles at rest, and here they flow: rates would change between events",
            "remove `method` for the split method, or set fluid: { method: none }",
        );
    } else if method == Method::TauLeaping {
        refuse(
            "tau-leaping is for one volume and for graphs of volumes",
            "remove `method`: the split method is exact in each step and as fast",
        );
    }
    check_discrete(model, method, all_discrete(model, network, discrete), faults);
    check_step(model, method, faults);
}

fn check_step(model: &Model, method: Method, faults: &mut Vec<Fault>) {
    if method.event_driven() && model.chemistry.step.is_some() {
        faults.push(Fault::at(
            &model.places.chemistry,
            match method {
                Method::TauLeaping => "tau-leaping chooses its leaps itself and knows no `step`",
                _ => "an event-driven method goes from event to event and knows no `step`",
            },
            match method {
                Method::TauLeaping => "remove `step`; `tolerance` makes leaps shorter or longer",
                _ => "remove `step`, or set method: split",
            },
        ));
    }
}

fn all_discrete(model: &Model, network: &Network, discrete: &[bool]) -> bool {
    discrete.iter().all(|&d| d) && hybrid(model, network).is_empty()
}

fn check_discrete(model: &Model, method: Method, all_discrete: bool, faults: &mut Vec<Fault>) {
    if method.event_driven() && !all_discrete {
        faults.push(Fault::at(
            &model.places.chemistry,
            match method {
                Method::TauLeaping => "tau-leaping needs discrete species, and some are continuous or hybrid",
                _ => "an event-driven method needs discrete species, and some are continuous or hybrid",
            },
            "set method: split, or make all species discrete",
        ));
    }
}
