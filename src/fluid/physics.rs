//! The physics of a flow: terms added up.

use crate::fluid::noise::ThermalNoise;
use crate::fluid::particles::{Side, Slopes};
use crate::fluid::pass::{Approach, Pair};
use crate::fluid::setup::Friction;
use crate::fluid::terms::{
    Continuity, DensityDiffusion, Moment, Pressure, Shift, TransportStress, Viscosity, viscosity,
};
use crate::space::kernel::Kernel;
use crate::vector::Vector;

/// The physics of a flow. Optional physics is an `Option`.
pub struct Terms<const D: usize> {
    pub continuity: Continuity,
    pub density_diffusion: Option<DensityDiffusion>,
    pub moment: Option<Moment>,
    pub pressure: Pressure,
    pub viscosity: Viscosity,
    /// Whether friction between particles far from solids is of the fourth order, [`viscosity::beyond_the_second_order`].
    pub fourth_order: bool,
    pub transport_stress: Option<TransportStress>,
    /// Whether the momentum that the drift carries is bounded next to solids, [`Setup::bounds_drift`](crate::fluid::Setup).
    pub bounds_drift: bool,
    pub shift: Option<Shift<D>>,
    pub noise: Option<ThermalNoise<D>>,
}

/// Which terms there are. A sweep looks once a block, and is compiled for each of the usual sets, so that no pair
/// has to ask for what is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Makeup {
    continuity: Continuity,
    pub(super) density_diffusion: bool,
    pub(super) moment: bool,
    pressure: Pressure,
    form: Friction,
    pub(super) fourth_order: bool,
    transport_stress: bool,
    pub(super) shift: bool,
    pub(super) noise: bool,
}

impl Makeup {
    /// SPH-BVF without noise.
    pub const FLOW: Makeup = Makeup {
        continuity: Continuity::Corrected,
        density_diffusion: true,
        moment: true,
        pressure: Pressure::Weighted,
        form: Friction::Morris,
        fourth_order: true,
        transport_stress: true,
        shift: true,
        noise: false,
    };
    /// SPH-BVF with noise.
    pub const THERMAL_FLOW: Makeup = Makeup {
        continuity: Continuity::Advected,
        density_diffusion: false,
        fourth_order: false,
        noise: true,
        ..Makeup::FLOW
    };
    /// SDPD without noise, and plain SPH.
    pub const BATH: Makeup = Makeup {
        continuity: Continuity::Summed,
        density_diffusion: false,
        pressure: Pressure::Squares,
        fourth_order: false,
        transport_stress: false,
        shift: false,
        ..Makeup::FLOW
    };
    /// SDPD with noise.
    pub const THERMAL_BATH: Makeup = Makeup { noise: true, ..Makeup::BATH };

    /// Whether the sweep of densities sums the spread of velocities.
    #[inline(always)]
    pub(super) fn spreads(self) -> bool {
        self.continuity == Continuity::Corrected
    }
}

impl<const D: usize> Terms<D> {
    /// Whether j feels the opposite of what i feels, so that a pair need be evaluated only once.
    #[must_use]
    pub fn are_mutual(&self) -> bool {
        self.pressure != Pressure::Switched
    }

    /// Which terms there are.
    #[must_use]
    pub fn makeup(&self) -> Makeup {
        Makeup {
            continuity: self.continuity,
            density_diffusion: self.density_diffusion.is_some(),
            moment: self.moment.is_some(),
            pressure: self.pressure,
            form: self.viscosity.form,
            fourth_order: self.fourth_order,
            transport_stress: self.transport_stress.is_some(),
            shift: self.shift.is_some(),
            noise: self.noise.is_some(),
        }
    }

    /// The kernel of the shift, if there is one.
    #[inline(always)]
    #[must_use]
    pub fn shift_kernel(&self) -> Option<&Kernel<D>> {
        self.shift.as_ref().map(Shift::kernel)
    }

    /// What the density of i gains from j, per volume of j; kg/m³/s times m^-D.
    #[inline(always)]
    pub(super) fn density(&self, makeup: Makeup, a: &Approach<D>, i: &Side<D>, j: &Side<D>) -> f64 {
        let mut out = 0.0;
        makeup.continuity.pair(a, i, j, &mut out);
        if makeup.density_diffusion
            && let Some(diffusion) = &self.density_diffusion
        {
            diffusion.pair(a, i, j, &mut out);
        }
        out
    }

    /// eta_ij F c_ij: the strength of friction between i and j, with a solid if `SOLID`. The solid takes the factor c of the fluid.
    #[inline(always)]
    pub fn rub<const SOLID: bool>(&self, makeup: Makeup, p: &Pair<D>, i: &Side<D>, j: &Side<D>) -> f64 {
        let eta = if SOLID { viscosity::with_solid(i, j) } else { viscosity::between_fluids(i, j) };
        let rub = eta * p.f;
        let other = if SOLID { i } else { j };
        if makeup.moment {
            rub * Moment.pair(p, &i.moment, &other.moment, i.uneven || other.uneven)
        } else {
            rub
        }
    }

    /// The friction between i and j whose velocities are `apart` (m/s), with a solid if `SOLID`; N/m³ times m^-D.
    #[inline(always)]
    pub(super) fn friction<const SOLID: bool>(
        &self,
        makeup: Makeup,
        p: &Pair<D>,
        (i, j): (&Side<D>, &Side<D>),
        apart: &Vector<D>,
    ) -> Vector<D> {
        let mut out = Vector::zeros();
        self.viscosity.pair(self.rub::<SOLID>(makeup, p, i, j), &p.x, apart, &mut out);
        out
    }

    /// The force between fluid i and j, N/m³ times m^-D: V_j of it is the force per volume of i. `slopes` are theirs where
    /// friction is of the fourth order.
    #[inline(always)]
    pub(super) fn force(
        &self,
        makeup: Makeup,
        p: &Pair<D>,
        i: &Side<D>,
        j: &Side<D>,
        slopes: Option<[&Slopes<D>; 2]>,
    ) -> Vector<D> {
        let mut out = Vector::zeros();
        makeup.pressure.pair(p, i, j, &mut out);
        let rub = self.rub::<false>(makeup, p, i, j);
        let friction = Viscosity { form: makeup.form };
        if let Some([a, b]) = slopes
            && a.clear
            && b.clear
        {
            friction.pair(rub, &p.x, &viscosity::beyond_the_second_order(i, j), &mut out);
            out -= (a.flux + b.flux) * (p.x * p.f);
        } else {
            friction.pair(rub, &p.x, &(i.velocity - j.velocity), &mut out);
            if makeup.transport_stress {
                TransportStress.pair(p, i, j, &mut out);
            }
        }
        if makeup.noise
            && let Some(noise) = &self.noise
        {
            noise.pair(makeup.form, rub, p, i, j, &mut out);
        }
        out
    }

    /// The force between fluid i and solid j, N/m³ times m^-D; `share` is the part of i in what j mirrors.
    #[inline(always)]
    pub fn force_of_solid(
        &self,
        makeup: Makeup,
        p: &Pair<D>,
        i: &Side<D>,
        j: &Side<D>,
        share: f64,
    ) -> Vector<D> {
        let mut out = Vector::zeros();
        makeup.pressure.pair(p, i, j, &mut out);
        let rub = self.rub::<true>(makeup, p, i, j);
        Viscosity { form: makeup.form }.pair(rub, &p.x, &(i.velocity - j.velocity), &mut out);
        if makeup.noise
            && let Some(noise) = &self.noise
        {
            out += noise.solid(makeup.form, rub, share, p, i, j);
        }
        out
    }
}
