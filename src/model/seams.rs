//! Groups at a periodic side: they go on at the side across.

use super::domain::Boundary;
use super::groups::{Group, Material};
use super::names::{axis_name, side_name};
use super::reader::Faults;
use crate::geometry::Shape;
use crate::vector::Vector;

/// Share of the box that counts as touching its side.
const TOUCHING: f64 = 1e-9;

/// Joins to the shape of each group that reaches a periodic side its image at the side across, and refuses what lies
/// outside the box altogether. Elastic solids keep their shape: their plan says what they cannot do.
pub(super) fn carry_on(
    groups: &mut [Group],
    boundaries: &[Boundary],
    (min, max): (&Vector<3>, &Vector<3>),
    faults: &mut Faults,
) {
    let rigid = |group: &&mut Group| !matches!(group.material, Material::Solid | Material::Surface);
    for group in groups.iter_mut().filter(rigid).filter(|group| group.shape != Shape::EverythingElse) {
        for (k, boundary) in boundaries.iter().enumerate() {
            let length = max[k] - min[k];
            let near = TOUCHING * length;
            let (low, high) = group.shape.reach(k);
            if group.material.is_filled() && (low >= max[k] - near || high <= min[k] + near) {
                faults.at(
                    &group.place,
                    format!(
                        "group `{}` has no particles: it lies outside the box along {}",
                        group.name,
                        axis_name(k)
                    ),
                    "move it inside, or make the box larger",
                );
                break;
            }
            // Of a wall that ends at the side its surface is to be known from across; others have none.
            let slack = if matches!(group.material, Material::Wall { .. }) { near } else { -near };
            let ends = [low <= min[k] + slack, high >= max[k] - slack];
            if *boundary != Boundary::Periodic || ends == [false; 2] {
                continue;
            }
            if low.is_infinite() || high.is_infinite() {
                let ends_there =
                    |shape: &Shape| matches!(shape, Shape::HalfSpace { normal, .. } if normal[k] != 0.0);
                if matches!(group.material, Material::Wall { .. }) && ends_there(&group.shape) {
                    faults.at(
                        &group.place,
                        format!(
                            "the wall `{}` has a surface across {} and reaches the periodic side {}, beyond which it does not go on",
                            group.name,
                            axis_name(k),
                            side_name(k, true)
                        ),
                        "give it as a box, which goes on at the side across",
                    );
                }
                continue;
            }
            // What reaches from side to side meets itself.
            if high - low >= length - 2.0 * near {
                continue;
            }
            let mut parts = vec![group.shape.clone()];
            for (at_end, by) in ends.into_iter().zip([length, -length]) {
                if at_end {
                    parts.push(group.shape.shifted(k, by));
                }
            }
            group.shape = Shape::Union(parts);
            group.crosses = Some(k);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;
    use std::sync::Arc;

    /// What holds a place holds its image too, and a group in the middle is left as it is.
    #[test]
    fn a_disc_on_a_corner_is_at_all_four() {
        let place = Place { source: Arc::default(), line: 1, column: 1, width: 1 };
        let group = |x: f64, y: f64| Group {
            material: Material::Wall { free_slip: false },
            shape: Shape::Ball { centre: [x, y, 0.0].into(), radius: 1.0 },
            ..Group::unread("post", &place, 0.1)
        };
        let (min, max) = (Vector::zeros(), Vector::from([10.0, 8.0, 0.0]));
        let mut groups = [group(9.7, 0.2), group(5.0, 4.0)];
        let before = groups[1].shape.clone();
        let mut faults = Faults::default();
        carry_on(&mut groups, &[Boundary::Periodic, Boundary::Periodic], (&min, &max), &mut faults);
        assert!(faults.list.is_empty() && groups[1].shape == before && groups[0].crosses.is_some());
        for (x, y) in [(9.7, 0.2), (-0.3, 0.2), (9.7, 8.2), (-0.3, 8.2)] {
            let there = groups[0].shape.signed_distance(&Vector::from([x + 0.6, y, 0.0]));
            assert!((there + 0.4).abs() < 1e-12, "{x} {y} {there}");
        }
        let mut outside = [group(12.0, 4.0)];
        carry_on(&mut outside, &[Boundary::Periodic, Boundary::NoSlip], (&min, &max), &mut faults);
        assert_eq!(faults.list.len(), 1);
    }
}
