//! Instances: a tree within another one, possibly many times. Only two levels.

use std::sync::Arc;

use super::Bvh;
use crate::aabb::Aabb;
use crate::affine::Affine;
use crate::exact::{ExactRay, Rounded};
use crate::vector::{dot, round_down, round_up, subtract, wide};

/// Entries of a matrix and of its inverse beyond 2⁹⁰ exceed the range of f32.
const LARGEST_ENTRY: f64 = 1.237_940_039_285_380_3e27;

/// There may be millions: its id is its place in the tree's list.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    pub(crate) bvh: Arc<Bvh>,
    pub(crate) world_from_object: Affine,
    /// The linear part of the inverse.
    pub(crate) object_from_world: [[f64; 3]; 3],
}

impl Instance {
    /// `None` where the map has no usable inverse.
    pub(crate) fn new(bvh: Arc<Bvh>, world_from_object: Affine) -> Option<Self> {
        let object_from_world = usable_inverse(&world_from_object)?;
        Some(Self { bvh, world_from_object, object_from_world })
    }

    /// A ray of the world in the object's space; t is unchanged.
    #[inline(always)]
    pub(crate) fn ray_in_object<T: Rounded>(&self, ray: &ExactRay<T>) -> ExactRay<T> {
        in_object(&self.world_from_object, &self.object_from_world, ray)
    }

    /// [`Self::ray_in_object`] where the instance is by another map; `None` where that has no usable inverse.
    pub(crate) fn ray_in_moved<T: Rounded>(&self, map: &Affine, ray: &ExactRay<T>) -> Option<ExactRay<T>> {
        // The inverse of what slides is known.
        if map.matrix == self.world_from_object.matrix {
            return Some(in_object(map, &self.object_from_world, ray));
        }
        Some(in_object(map, &usable_inverse(map)?, ray))
    }

    /// The box in the world.
    pub(crate) fn bounds(&self) -> Aabb {
        self.bvh.bounds_under(&self.world_from_object)
    }
}

/// The linear part of a map's inverse, if both are in the range of f32.
fn usable_inverse(map: &Affine) -> Option<[[f64; 3]; 3]> {
    let inverse = map.inverse()?.matrix;
    let entries = map.matrix.iter().chain(&inverse).flatten();
    entries.into_iter().all(|entry| entry.abs() < LARGEST_ENTRY).then_some(inverse)
}

#[inline(always)]
fn in_object<T: Rounded>(map: &Affine, inverse: &[[f64; 3]; 3], ray: &ExactRay<T>) -> ExactRay<T> {
    let in_object = |v: [f64; 3]| inverse.map(|row| dot(row, v));
    ExactRay {
        // Subtract first, to keep the significant digits near the object.
        origin: in_object(subtract(ray.origin, map.translation)),
        direction: in_object(ray.direction),
        t_min: ray.t_min,
    }
}

impl Bvh {
    /// The box around the eight corners of the tree's box under a map, rounded outwards.
    pub(crate) fn bounds_under(&self, map: &Affine) -> Aabb {
        let object = self.bounds();
        if object.is_empty() {
            return Aabb::EMPTY;
        }
        let sides = [wide(object.min), wide(object.max)];
        let mut bounds = Aabb::EMPTY;
        for axis in 0..3 {
            let row = map.matrix[axis];
            let shift = map.translation[axis];
            // Each term takes its minimum and maximum independently.
            let (mut least, mut greatest, mut magnitude) = (shift, shift, shift.abs());
            for column in 0..3 {
                let [a, b] = [row[column] * sides[0][column], row[column] * sides[1][column]];
                least += a.min(b);
                greatest += a.max(b);
                magnitude += a.abs().max(b.abs());
            }
            let error = 16.0 * f64::EPSILON * magnitude;
            bounds.min[axis] = round_down(least - error);
            bounds.max[axis] = round_up(greatest + error);
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_instances_take_176_megabytes() {
        assert_eq!(size_of::<Instance>(), 176);
    }
}
