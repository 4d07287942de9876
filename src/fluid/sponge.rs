//! Sponges: regions where the velocity relaxes to a target, solved exactly.

use crate::fluid::domain::Domain;
use crate::fluid::setup::Sponge;
use crate::vector::Vector;

/// The sponges with their decay over one kick.
pub(super) struct Relaxation<'a, const D: usize> {
    sponges: Vec<(&'a Sponge<D>, f64)>,
    domain: &'a Domain<D>,
}

impl<'a, const D: usize> Relaxation<'a, D> {
    pub fn new(sponges: &'a [Sponge<D>], dt: f64, domain: &'a Domain<D>) -> Relaxation<'a, D> {
        Relaxation { sponges: sponges.iter().map(|s| (s, (-s.rate * dt).exp())).collect(), domain }
    }

    /// v -> target + (v - target) exp(-rate dt) in every sponge that holds the place.
    #[inline]
    pub fn apply(&self, position: &Vector<D>, velocity: &mut Vector<D>) {
        for (sponge, decay) in &self.sponges {
            let place = self.domain.wrap(position);
            if (sponge.region)(&place) {
                let target = (sponge.velocity)(&place);
                *velocity = target + (*velocity - target) * *decay;
            }
        }
    }

    /// Takes the shift out where a sponge sets the velocity. Particles are to pass with the target velocity: with
    /// the pressure rising across a plug the shift would drive them back (4 % of the flux of a channel, measured).
    #[inline]
    pub fn damp(&self, position: &Vector<D>, drift: &mut Vector<D>) {
        for (sponge, decay) in &self.sponges {
            if (sponge.region)(&self.domain.wrap(position)) {
                *drift *= *decay;
            }
        }
    }
}
