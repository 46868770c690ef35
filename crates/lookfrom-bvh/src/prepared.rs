//! A ray made ready for the tests: once in the world, and once more in each instance that it enters.
//!
//! The f32 values serve the box test and the triangle filter, which only *exclude*, with room for their errors; the
//! f64 values serve the decisions. Inside an instance the f64 ray is not rounded, only its f32 shadow is, and the
//! difference is part of the room: the products' and `rounding`.

use crate::affine::Affine;
use crate::ray::Ray;
use crate::vector::{subtract, wide};

/// The largest product of an origin and a reciprocal, 2¹²⁶: beyond it a reciprocal is made smaller, that of 0 too. So no
/// slab distance is ever NaN, and inside a padded box such a component leaves t free.
const LARGEST_PRODUCT: f32 = 8.507_059e37;

/// Room in a product of origin and reciprocal, relative, 2⁻²²: for its rounding, and the origin's in an instance.
const PRODUCT_ROOM: f32 = 2.384_185_8e-7;

/// Room for rounding in distances along a ray, relative: 2⁻²⁰, sixteen units of rounding. Four are needed for a slab
/// (reciprocal, product, and the f32 t that it is compared with), on either side.
pub(crate) const ROOM: f32 = 9.536_743e-7;

/// Room for the rounding of a t so small that rounding is not relative to it: 2⁻¹⁰⁰.
const TINY: f32 = 7.888_609e-31;

/// The axes in a turn, by the last.
static AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

#[derive(Clone, Copy, Debug)]
pub(crate) struct Prepared {
    /// Hits need a t above this.
    pub(crate) t_min: f32,
    /// Box test and triangle filter: the start of the ray, with room, in terms of the scaled direction.
    pub(crate) scaled_t_min: f32,
    /// The origin in f32.
    pub(crate) origin: [f32; 3],
    /// Box test and triangle filter: the direction in f32 times a power of two, its longest component in [1, 4).
    pub(crate) scaled_direction: [f32; 3],
    /// What takes t to that direction: the power of two's inverse.
    pub(crate) t_scale: f32,

    /// Box test: 1 / direction, and the same with room for farther faces.
    pub(crate) near_reciprocal: [f32; 3],
    pub(crate) far_reciprocal: [f32; 3],
    /// Box test: these times the origin, moved within their errors so that near faces seem nearer, far faces farther.
    pub(crate) near_product: [f32; 3],
    pub(crate) far_product: [f32; 3],
    /// Box test: which face is met first, 0 the minimum or 1 the maximum.
    pub(crate) near_side: [usize; 3],

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
        let last = if (x > y) & (x > z) { 0 } else { 2 - usize::from(y > z) };
        let [x, y, z] = direction.map(f32::abs);
        let length = greater(greater(x, y), z);
        let largest = greater(greater(origin[0].abs(), origin[1].abs()), origin[2].abs());
        if !(length > 0.0 && length < f32::INFINITY && largest < f32::INFINITY) {
            return None;
        }

        // A power of two within the range of f32, and its inverse.
        let exponent = (length.to_bits() & 0x7f80_0000).clamp(1 << 23, 253 << 23);
        let scale = f32::from_bits((254 << 23) - exponent);
        let t_scale = f32::from_bits(exponent);
        let scaled_direction = direction.map(|x| x * scale);

        let mut near_reciprocal = [0.0; 3];
        let mut far_reciprocal = [0.0; 3];
        let mut near_product = [0.0; 3];
        let mut far_product = [0.0; 3];
        let mut near_side = [0; 3];
        for axis in 0..3 {
            let reciprocal = 1.0 / scaled_direction[axis].abs();
            let most = LARGEST_PRODUCT / greater(origin[axis].abs(), 1.0);
            let reciprocal = if reciprocal < most { reciprocal } else { most };
            near_reciprocal[axis] = reciprocal.copysign(direction[axis]);
            far_reciprocal[axis] = near_reciprocal[axis] * (1.0 + ROOM);
            let product = near_reciprocal[axis] * origin[axis];
            near_product[axis] = product + product.abs() * PRODUCT_ROOM;
            let product = far_reciprocal[axis] * origin[axis];
            far_product[axis] = product - product.abs() * PRODUCT_ROOM;
            near_side[axis] = (direction[axis].to_bits() >> 31) as usize;
        }

        // Where it can, it stays positive: so are then all distances, and in order as bits.
        let start = (t_min - t_min.abs() * ROOM - TINY) * t_scale;
        Some(Self {
            t_min,
            scaled_t_min: if t_min < 0.0 { start } else { greater(start, 0.0) },
            origin,
            scaled_direction,
            t_scale,
            near_reciprocal,
            far_reciprocal,
            near_product,
            far_product,
            near_side,
            rounding: if relative > 0.0 { largest } else { 0.0 },
            largest,
            axes: AXES[last],
            origin64,
            direction64,
        })
    }

    /// The end of the ray, with room, in terms of the scaled direction.
    #[inline(always)]
    pub(crate) fn scaled_end(&self, t_max: f32) -> f32 {
        (t_max + t_max.abs() * ROOM + TINY) * self.t_scale
    }
}

/// The greater of two numbers, the second where there is a NaN.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
