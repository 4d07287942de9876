//! Turgor: the pressure of what a wall encloses.
//!
//! ```text
//! p = p_T min(1, t/t_rise) - K (V/V0 - 1),     load on x_k = p dV/dx_k
//! ```
//!
//! The load is the exact slope of ∫ p dV, so it neither pushes nor turns a closed wall. K = 0 is a reservoir of constant
//! pressure (water follows), p_T = 0 a fixed amount of liquid of bulk modulus K.

use crate::solid::elastic::Elastic;
use crate::solid::shell::Wall;
use crate::solid::surface::{BEYOND, slopes, volume};

/// The pressure inside, as a law of time and volume.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Turgor {
    /// p_T, Pa.
    pub pressure: f64,
    /// K, Pa.
    pub stiffness: f64,
    /// Time over which the pressure rises, s.
    pub rise: f64,
}

/// What the turgor is now.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Inside {
    /// Volume inside the inner surface, m^D.
    pub volume: f64,
    /// Pa.
    pub pressure: f64,
}

impl Turgor {
    /// The pressure (Pa) at time `t` (s) when the volume is `swollen` times that at the start.
    #[must_use]
    pub fn at(&self, t: f64, swollen: f64) -> f64 {
        let risen = if self.rise > 0.0 { (t / self.rise).clamp(0.0, 1.0) } else { 1.0 };
        self.pressure * risen - self.stiffness * (swollen - 1.0)
    }

    /// Sets the loads of a wall at time `t` (s); `start` is the volume inside at the start, m^D.
    pub fn load<const D: usize>(&self, solid: &mut Elastic<D>, wall: &Wall<D>, t: f64, start: f64) -> Inside {
        let nodes = wall.inner(|i| solid.position(i));
        let volume = volume(&nodes, &wall.faces);
        let pressure = self.at(t, volume / start);
        for (column, slope) in slopes(&nodes, &wall.faces).iter().enumerate() {
            for (layer, part) in BEYOND.iter().enumerate() {
                solid.loads[wall.particle(column, layer)] = slope * (pressure * part);
            }
        }
        Inside { volume, pressure }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::{Law, Material, Options, Setup};
    use crate::space::{Domain, KernelKind};
    use crate::vector::Vector;

    fn free<const D: usize>() {
        let built = Wall::<D>::round(&Vector::from_element(2e-5), 7.5e-6, 1e-5, 6e-7);
        let n = built.places.len();
        let mut solid = Elastic::new(Setup {
            domain: Domain { min: Vector::zeros(), max: Vector::from_element(4e-5), periodic: [false; D] },
            kernel: KernelKind::Lucy,
            cutoff: 1e-6,
            places: built.places,
            volumes: built.volumes,
            holds: vec![crate::solid::Hold::Free; n],
            material: Material::of_young(Law::NeoHookean, 1000.0, 1e6, 0.3),
            options: Options::default(),
        })
        .unwrap();
        solid
            .displace(|x| Vector::from_fn(|k, _| 1e-7 * (x[(k + 1) % D] * 3e5).sin() + 0.02 * x[k]))
            .unwrap();
        let turgor = Turgor { pressure: 2e5, stiffness: 1e5, rise: 2.0 };
        let start = volume(&built.wall.inner(|i| solid.places()[i]), &built.wall.faces);
        let inside = turgor.load(&mut solid, &built.wall, 1.0, start);
        assert_eq!(inside.pressure, 1e5 - 1e5 * (inside.volume / start - 1.0));
        let (mut force, mut torque, mut size) = (Vector::<D>::zeros(), 0.0, 0.0);
        for i in 0..n {
            for one in [solid.loads[i], solid.forces[i]] {
                let arm = solid.position(i) - Vector::from_element(2e-5);
                force += one;
                torque += arm[0] * one[1] - arm[1] * one[0];
                size += one.norm();
            }
        }
        // Rounding of the sums.
        assert!(
            force.norm() < 1e-12 * size && torque.abs() < 1e-12 * size * 1e-5,
            "{D}: {force} {torque} of {size}"
        );
    }

    #[test]
    fn a_closed_wall_is_neither_pushed_nor_turned() {
        free::<2>();
        free::<3>();
    }
}
