//! A ray made ready for the tests: once in the world, and once more in each instance that it enters.
//!
//! The f32 values serve the box test and the triangle filter, which only *exclude*, with room for their errors; the
//! f64 values serve the decisions. Inside an instance the f64 ray is not rounded, only its f32 shadow is, and the
//! difference is part of the room: `near_origin`, `far_origin` and `rounding`.

use crate::affine::Affine;
use crate::ray::Ray;
use crate::vector::{subtract, wide};

/// The largest reciprocal of a direction's component: a component of 0 counts as one of 2⁻¹²⁶. So no slab distance is
/// ever NaN (0 · ∞), and inside a padded box such a component leaves t free.
const LARGEST_RECIPROCAL: f32 = 8.507_059e37;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Prepared {
    /// Hits need a t above this.
    pub(crate) t_min: f32,
    /// The origin in f32.
    pub(crate) origin: [f32; 3],

    /// Box test: the origin, moved within its error so that near faces seem nearer and far faces farther.
    pub(crate) near_origin: [f32; 3],
    pub(crate) far_origin: [f32; 3],
    /// Box test: 1 / direction.
    pub(crate) reciprocal: [f32; 3],
    /// Box test: which face is met first, 0 the minimum or 1 the maximum.
    pub(crate) near_side: [usize; 3],

    /// Triangle filter: the direction in f32 times a power of two, its longest component below 4.
    pub(crate) scaled_direction: [f32; 3],
    /// Triangle filter: what takes t to that direction: the power of two's inverse.
    pub(crate) t_scale: f32,
    /// Triangle filter: what the origin's rounding to f32 is relative to; 0 for a ray in the world.
    pub(crate) rounding: f32,
    /// The largest of the origin's coordinates.
    pub(crate) largest: f32,

    /// Triangle decision: the axes, so permuted that the direction is longest along the last.
    pub(crate) axes: [usize; 3],
    /// The ray in f64.
    pub(crate) origin64: [f64; 3],
    pub(crate) direction64: [f64; 3],
}

impl Prepared {
    /// A ray in the world. None where it cannot hit anything.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        let finite = ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite());
        if !finite || !(ray.t_min < ray.t_max) {
            return None;
        }
        Self::with_rounding(wide(ray.origin), wide(ray.direction), ray.t_min, 0.0)
    }

    /// The same ray in an object's space; t stays what it is.
    pub(crate) fn in_object(&self, world_from_object: &Affine, object_from_world: &Affine) -> Option<Self> {
        // Subtract first: near the object that is where the digits are.
        let origin = object_from_world.vector(subtract(self.origin64, world_from_object.translation));
        let direction = object_from_world.vector(self.direction64);
        Self::with_rounding(origin, direction, self.t_min, f32::EPSILON)
    }

    #[inline(always)]
    fn with_rounding(origin64: [f64; 3], direction64: [f64; 3], t_min: f32, relative: f32) -> Option<Self> {
        let origin = origin64.map(|x| x as f32);
        let direction = direction64.map(|x| x as f32);

        // Shear along the longest component, so that both factors are at most 1.
        let [x, y, z] = direction64.map(f64::abs);
        let axes = if x > y && x > z {
            [1, 2, 0]
        } else if y > z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let length = direction64[axes[2]];
        if !length.is_finite() || length == 0.0 || !origin.iter().all(|x| x.is_finite()) {
            return None;
        }

        let mut near_origin = origin;
        let mut far_origin = origin;
        let mut reciprocal = [0.0; 3];
        let mut near_side = [0; 3];
        for axis in 0..3 {
            let negative = direction[axis].is_sign_negative();
            let forward = if negative { -1.0 } else { 1.0 };
            let error = relative * origin[axis].abs() * forward;
            near_origin[axis] += error;
            far_origin[axis] -= error;
            reciprocal[axis] = (1.0 / direction[axis].abs()).min(LARGEST_RECIPROCAL) * forward;
            near_side[axis] = usize::from(negative);
        }

        // A power of two within the range of f32, and its inverse.
        let exponent = (direction[axes[2]].to_bits() & 0x7f80_0000).clamp(1 << 23, 253 << 23);
        let scale = f32::from_bits((254 << 23) - exponent);
        let t_scale = f32::from_bits(exponent);

        let largest = origin.iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
        Some(Self {
            t_min,
            origin,
            near_origin,
            far_origin,
            reciprocal,
            near_side,
            scaled_direction: direction.map(|x| x * scale),
            t_scale,
            rounding: if relative > 0.0 { largest } else { 0.0 },
            largest,
            axes,
            origin64,
            direction64,
        })
    }
}
