//! A ray made ready for the tests: once in the world, and once more in each instance that it enters.
//!
//! The f32 values serve the box test and the triangle filter, which only *exclude*, with room for their errors; the
//! f64 values serve the decisions. Inside an instance the f64 ray is not rounded, only its f32 shadow is, and the
//! difference is part of the room: the products' and `rounding`.

use crate::affine::Affine;
use crate::ray::Ray;
use crate::simd::{Simd, f32x4, prelude::*};
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
    pub(crate) fn new<S: Simd>(simd: S, ray: &Ray) -> Option<Self> {
        if !(ray.t_min < ray.t_max) {
            return None;
        }
        Self::with_rounding(
            simd,
            ray.origin,
            ray.direction,
            wide(ray.origin),
            wide(ray.direction),
            ray.t_min,
            0.0,
        )
    }

    /// The same ray in an object's space; t stays what it is.
    #[inline(always)]
    pub(crate) fn in_object<S: Simd>(
        &self,
        simd: S,
        world_from_object: &Affine,
        object_from_world: &Affine,
    ) -> Option<Self> {
        // Subtract first: near the object that is where the digits are.
        let origin = object_from_world.vector(subtract(self.origin64, world_from_object.translation));
        let direction = object_from_world.vector(self.direction64);
        let narrow = |x: [f64; 3]| x.map(|x| x as f32);
        Self::with_rounding(simd, narrow(origin), narrow(direction), origin, direction, self.t_min, 1.0)
    }

    /// `rounding` is 1 where the f32 values are rounded, else 0.
    #[inline(always)]
    fn with_rounding<S: Simd>(
        simd: S,
        origin: [f32; 3],
        direction: [f32; 3],
        origin64: [f64; 3],
        direction64: [f64; 3],
        t_min: f32,
        rounding: f32,
    ) -> Option<Self> {
        // Shear along the longest component, so that both factors are at most 1.
        let [x, y, z] = direction.map(f32::abs);
        let last = if (x > y) & (x > z) { 0 } else { 2 - usize::from(y > z) };
        let length = greater(greater(x, y), z);
        let largest = greater(greater(origin[0].abs(), origin[1].abs()), origin[2].abs());
        // The sum is NaN where one of them is not finite.
        let zero = f32x4::splat(simd, 0.0);
        let o = f32x4::load_array(simd, [origin[0], origin[1], origin[2], 0.0]);
        let d = f32x4::load_array(simd, [direction[0], direction[1], direction[2], 0.0]);
        let finite = (o * zero + d * zero).simd_eq(zero).all_true();
        if !(finite & (length > 0.0)) {
            return None;
        }

        // A power of two within the range of f32, and its inverse.
        let exponent = (length.to_bits() & 0x7f80_0000).clamp(1 << 23, 253 << 23);
        let scale = f32::from_bits((254 << 23) - exponent);
        let t_scale = f32::from_bits(exponent);

        // The slabs' constants, three axes at once.
        let scaled = d * scale;
        let one = f32x4::splat(simd, 1.0);
        let largest_reciprocal = f32x4::splat(simd, LARGEST_PRODUCT) / o.abs().max(one);
        let near_reciprocal = (one / scaled.abs()).min(largest_reciprocal).copysign(d);
        let far_reciprocal = near_reciprocal * (1.0 + ROOM);
        let near_product = near_reciprocal * o;
        let near_product = near_product + near_product.abs() * PRODUCT_ROOM;
        let far_product = far_reciprocal * o;
        let far_product = far_product - far_product.abs() * PRODUCT_ROOM;
        let near_side = direction.map(|x| (x.to_bits() >> 31) as usize);

        // Where it can, it stays positive: so are then all distances, and in order as bits.
        let start = (t_min - t_min.abs() * ROOM - TINY) * t_scale;
        Some(Self {
            t_min,
            scaled_t_min: if t_min < 0.0 { start } else { greater(start, 0.0) },
            origin,
            scaled_direction: first_three(scaled),
            t_scale,
            near_reciprocal: first_three(near_reciprocal),
            far_reciprocal: first_three(far_reciprocal),
            near_product: first_three(near_product),
            far_product: first_three(far_product),
            near_side,
            rounding: rounding * largest,
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

#[inline(always)]
fn first_three<S: Simd>(values: f32x4<S>) -> [f32; 3] {
    [values[0], values[1], values[2]]
}

/// The greater of two numbers, the second where there is a NaN.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
