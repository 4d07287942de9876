//! The temperature of a fluctuating fluid, whatever its mean flow.

use crate::fluid::flow::Flow;
use crate::vector::Vector;

impl<const D: usize> Flow<D> {
    /// kT over the thickness that is not simulated, J/m^(3-D), by the velocities of now; none without fluid.
    ///
    /// The mean of m |v_i - u_i|²/(D (1 + Σ_j w_j²)) with u_i = Σ_j w_j v_j, w_j = V_j W/Σ V W over the fluid around i
    /// without itself: velocities in equilibrium are independent, so the variance of the difference is that of both.
    /// A mean flow that is linear over a cut-off cancels.
    #[must_use]
    pub fn thermal_energy(&self) -> Option<f64> {
        let mut around = vec![(0.0, 0.0, Vector::<D>::zeros()); self.sides.len()];
        self.each_way(|i, j, x, _| {
            let other = &self.sides[j];
            if !other.is_solid() {
                let weight = other.volume * self.kernel.value(x.norm());
                let sums = &mut around[i];
                *sums = (sums.0 + weight, sums.1 + weight * weight, sums.2 + other.velocity * weight);
            }
        });
        let (mut sum, mut count) = (0.0, 0.0);
        for ((side, own), (all, squares, velocity)) in self.sides.iter().zip(&self.own).zip(around) {
            if !side.is_solid() && all > 0.0 {
                let strays = (side.velocity - velocity / all).norm_squared();
                sum += own.mass * strays / (D as f64 * (1.0 + squares / (all * all)));
                count += 1.0;
            }
        }
        (count > 0.0).then(|| sum / count)
    }
}
