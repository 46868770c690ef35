//! Positions far from the origin, such as the coordinates of maps, in single precision: they are relative to the middle of their
//! box, which is the place of the parts.

use glam::{DMat4, DVec3, Vec3};

use crate::error::Location;
use crate::files::LoadContext;
use crate::shape::{Mesh, Part};

/// The distance of the middle of the box from the origin, in sizes of the box, beyond which positions become relative to it:
/// as much precision is lost by rounding where they are.
const FAR: f64 = 16.0;

/// A mesh is coarse where most of its triangles are smaller than so many steps of its coordinates.
const FEW_STEPS: f64 = 4.0;

/// Boxes are large beside rounding if their sides have so many steps.
const MANY_STEPS: f64 = (1 << 18) as f64;

/// The place of a file's positions in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Place {
    /// The point that positions are relative to: 0 on axes along which they are near the origin.
    pub(crate) origin: DVec3,
    /// The step between neighbouring numbers, at the largest coordinate.
    step: f64,
    /// The longest side of the box.
    size: f64,
}

/// Rounds positions to single precision, where it matters relative to their middle. `is_single` says that the file has them in
/// single precision itself, so that their steps are those of where they are; nothing is lost by moving them.
pub(crate) fn placed(exact: &[DVec3], is_single: bool) -> (Vec<Vec3>, Place) {
    let finite = exact.iter().filter(|point| point.is_finite());
    let (min, max) = finite
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &point| (min.min(point), max.max(point)));
    let (middle, size) = (min.midpoint(max), (max - min).max_element());
    let far = |middle: f64| match size > 0.0 && middle.abs() > FAR * size && (middle as f32).is_finite() {
        true => f64::from(middle as f32),
        false => 0.0,
    };
    let origin = DVec3::from_array(middle.to_array().map(far));
    let positions: Vec<Vec3> = exact.iter().map(|&point| (point - origin).as_vec3()).collect();
    let moved = if is_single { DVec3::ZERO } else { origin };
    let largest = (min - moved).abs().max((max - moved).abs()).max_element() as f32;
    let step = f64::from(largest.next_up() - largest);
    let is_usable = step.is_finite() && size.is_finite();
    (positions, if is_usable { Place { origin, step, size } } else { Place { origin, ..Place::default() } })
}

impl Place {
    /// Puts parts there, and warns if that is not precise enough for their meshes. `flat` triangles were left out of them,
    /// for lack of area.
    pub(crate) fn put(
        self,
        parts: &mut [Part],
        meshes: &[Mesh],
        flat: u64,
        file: &Location,
        context: &mut LoadContext<'_>,
    ) {
        if self.origin != DVec3::ZERO {
            for part in parts {
                part.world_from_object = DMat4::from_translation(self.origin) * part.world_from_object;
            }
        }
        // Of a box of many steps, triangles have no area in the file itself.
        let flat = if self.size < MANY_STEPS * self.step { flat as usize } else { 0 };
        let (mut all, mut small) = (flat, flat);
        for mesh in meshes {
            let point = |vertex: u32| mesh.positions[vertex as usize].as_dvec3();
            all += mesh.triangles.len();
            small += mesh.triangles.iter().filter(|triangle| self.is_small(triangle.map(point))).count();
        }
        if 2 * small > all {
            let message = format!(
                "most triangles are smaller than {FEW_STEPS} steps of their coordinates, which are {} here: single precision is too \
                 coarse for such a distance from the origin",
                self.step as f32
            );
            context.warn(file, message);
        }
    }

    fn is_small(self, [a, b, c]: [DVec3; 3]) -> bool {
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        longest < (FEW_STEPS * self.step) * (FEW_STEPS * self.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn only_far_axes_move() {
        let box_at = |at: [f64; 3]| [DVec3::from(at) - 1.0, DVec3::from(at) + 1.0];
        let (positions, place) = placed(&box_at([5e5, 4.6e6 + 0.125, 3.0]), false);
        assert_eq!(place.origin, DVec3::new(5e5, 4.6e6, 0.0));
        assert_eq!(positions, [Vec3::new(-1.0, -0.875, 2.0), Vec3::new(1.0, 1.125, 4.0)]);
        assert_eq!(placed(&box_at([20.0, 0.0, 0.0]), false).1.origin, DVec3::ZERO);
        assert_eq!(placed(&[DVec3::splat(1e9)], false).1.origin, DVec3::ZERO);
        assert_eq!(placed(&[], false).1.origin, DVec3::ZERO);
        let odd = [DVec3::NAN, DVec3::splat(1e300), DVec3::splat(-1e300), DVec3::INFINITY];
        assert_eq!(placed(&odd, false).1.origin, DVec3::ZERO);
    }

    proptest! {
        #[test]
        fn single_precision_is_moved_exactly(
            middle in prop::array::uniform3(-24_i32..24),
            points in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 2..20),
            size in -20_i32..20,
        ) {
            let middle = DVec3::from_array(middle.map(|exponent| f64::from(exponent.signum()) * libm::exp2(f64::from(exponent.abs()))));
            let size = libm::exp2(f64::from(size));
            let exact: Vec<DVec3> = points
                .iter()
                .map(|&point| (middle + size * Vec3::from(point).as_dvec3()).as_vec3().as_dvec3())
                .collect();
            let (positions, place) = placed(&exact, true);
            for (position, exact) in positions.iter().zip(&exact) {
                prop_assert_eq!(position.as_dvec3() + place.origin, *exact);
            }
        }
    }
}
