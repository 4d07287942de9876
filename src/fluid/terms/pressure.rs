//! The pressure gradient.

use crate::fluid::particles::Side;
use crate::fluid::pass::Pair;
use crate::vector::Vector;

/// Force on i: Σ 2 V_i V_j p_ij F x_ij, with a mean p_ij of the pressures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pressure {
    /// p_ij = (rho_i p_j + rho_j p_i)/(rho_i + rho_j); Adami, Hu & Adams 2013.
    Weighted,
    /// 2 p_ij = rho_j p_i/rho_i + rho_i p_j/rho_j, which is m_i m_j (p_i/rho_i² + p_j/rho_j²); Monaghan 1992,
    /// Español & Revenga 2003. With [`Continuity::Summed`](super::Continuity) it conserves energy.
    Squares,
    /// As `Squares` where that is positive, else with the difference in place of the sum; SPH-BVF Eqs (26)-(29).
    /// Not antisymmetric: momentum is lost where pressures are negative.
    Switched,
}

impl Pressure {
    /// Force per volume of i and of j, N/m³ times m^-D.
    #[inline(always)]
    pub fn pair<const D: usize>(self, p: &Pair<D>, i: &Side<D>, j: &Side<D>, out: &mut Vector<D>) {
        let twice = match self {
            Pressure::Weighted => {
                2.0 * (i.density * j.pressure + j.density * i.pressure) / (i.density + j.density)
            }
            Pressure::Squares | Pressure::Switched => {
                let (mine, yours) =
                    (i.pressure * i.inverse_density * j.density, j.pressure * j.inverse_density * i.density);
                if self == Pressure::Switched && mine + yours < 0.0 { yours - mine } else { mine + yours }
            }
        };
        *out += p.x * (twice * p.f);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid::terms::tests::side;
    use crate::space::kernel::{Kernel, KernelKind};

    #[test]
    fn the_switch_acts_on_tension_alone_and_only_for_its_form() {
        let x = Vector::<2>::new(0.3, 0.1);
        let p = Pair {
            x,
            f: Kernel::<2>::new(KernelKind::Lucy, 1.0).f(x.norm()),
            f_shift: 0.0,
            inverse_square: 1.0 / x.norm_squared(),
        };
        let force = |form: Pressure, a: f64, b: f64| {
            let mut out = Vector::zeros();
            form.pair(&p, &side(1.0, a), &side(1.0, b), &mut out);
            out
        };
        for (a, b) in [(2.0, 1.0), (2.0, -1.0)] {
            assert_eq!(force(Pressure::Switched, a, b), force(Pressure::Squares, a, b));
            // Equal densities: all forms agree.
            assert_eq!(force(Pressure::Weighted, a, b), force(Pressure::Squares, a, b));
        }
        // Equation (29): p_j - p_i.
        assert_eq!(force(Pressure::Switched, -2.0, 1.0), x * (3.0 * p.f));
        assert_eq!(force(Pressure::Squares, -2.0, 1.0), x * -p.f);
    }
}
