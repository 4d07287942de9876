//! Sponges: regions where the velocity relaxes to a target, solved exactly.

use crate::fluid::setup::Sponge;
use crate::space::domain::Domain;
use crate::vector::Vector;

/// The sponges with their decay over one kick.
pub(super) struct Relaxation<'a, const D: usize> {
    /// Each sponge, what it leaves of a velocity over the kick, and what it leaves of the shift.
    sponges: Vec<(&'a Sponge<D>, f64, f64)>,
    domain: &'a Domain<D>,
}

impl<'a, const D: usize> Relaxation<'a, D> {
    /// `passage` is the time a particle takes across a cut-off, s.
    pub fn new(sponges: &'a [Sponge<D>], dt: f64, passage: f64, domain: &'a Domain<D>) -> Relaxation<'a, D> {
        let left = |s: &'a Sponge<D>| (s, (-s.rate * dt).exp(), 1.0 / (1.0 + s.rate * passage));
        Relaxation { sponges: sponges.iter().map(left).collect(), domain }
    }

    /// v -> target + (v - target) exp(-rate dt) in every sponge that holds the place.
    #[inline]
    pub fn apply(&self, position: &Vector<D>, velocity: &mut Vector<D>) {
        for (sponge, decay, _) in &self.sponges {
            let place = self.domain.wrap(position);
            if (sponge.region)(&place) {
                let target = (sponge.velocity)(&place);
                *velocity = target + (*velocity - target) * *decay;
            }
        }
    }

    /// Takes the shift out where a sponge sets the velocity, and whether it does. Particles are to pass with the target velocity; with
    /// the pressure rising across a plug the shift would drive them back. A share 1/(1 + rate · passage) stays, so
    /// that a weak sponge does not let particles clump; it does not depend on the step.
    #[inline]
    pub fn damp(&self, position: &Vector<D>, drift: &mut Vector<D>) -> bool {
        let mut held = false;
        for (sponge, _, share) in &self.sponges {
            if (sponge.region)(&self.domain.wrap(position)) {
                *drift *= *share;
                held |= *share < 0.5;
            }
        }
        held
    }
}
