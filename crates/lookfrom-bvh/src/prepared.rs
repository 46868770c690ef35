//! A ray prepared for the box test and the conservative triangle test: in f32, translated and scaled, once in the
//! world and again in each instance that it enters.
//!
//! These tests only *exclude*, with error margins; exact tests use the ray in f64 (see `exact`). Where the origin
//! of the scaled ray is rounded, the difference is part of the margin: of the products' and of `rounding`.
//!
//! A scaled ray never starts behind its origin: for a ray with a negative `t_min` the origin is moved back along
//! the ray. So its distances are positive, and their bits have the same order.

use crate::error_bounds::{
    ERROR, FAR, LARGEST_FILTERED, LARGEST_PRODUCT, LARGEST_RECIPROCAL, MOVED_ROOM, PRODUCT_ROOM, ROOM, SHORT,
    SURE_AFTER, TINY, UNDERFLOW, USUAL_UNDERFLOW,
};
use crate::exact::ExactRay;
use crate::ray::Ray;
use lookfrom_simd::{Simd, f32x4, prelude::*};

#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedRay {
    pub(crate) scaled: ScaledRay,
    /// The first distance, with its margin.
    pub(crate) t_min: f32,
    /// Box test: 1 / direction, and the same with a margin for farther faces.
    pub(crate) near_reciprocal: [f32; 3],
    pub(crate) far_reciprocal: [f32; 3],
    /// Box test: these times the origin, shifted within their errors so that near faces appear nearer, far faces
    /// farther.
    pub(crate) near_product: [f32; 3],
    pub(crate) far_product: [f32; 3],
    /// Box test: the face that is hit first, 0 the minimum or 1 the maximum.
    pub(crate) near_side: [usize; 3],
}

/// The ray in f32. Distances along it are measured from its origin, in lengths of its direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScaledRay {
    pub(crate) origin: [f32; 3],
    /// The ray's direction, times a power of two where it is very short or long.
    pub(crate) direction: [f32; 3],
    /// The ray's t at the origin: 0 or less.
    start: f32,
    /// The factor from t to distances: the power of two's inverse.
    pub(crate) scale: f32,
    /// Upper limits of the reciprocals.
    largest_reciprocal: [f32; 3],
    /// The error of the origin, beyond its rounding to f32.
    moved: f32,
    /// The magnitude that the origin's rounding to f32 is relative to; 0 for usual rays of the world, of which nothing is rounded.
    pub(crate) rounding: f32,
    /// The conservative triangle test's errors, relative and absolute.
    pub(crate) error: f32,
    pub(crate) underflow: f32,
    /// The distance before which the conservative test may find a sure hit.
    pub(crate) sure_before: f32,
}

impl PreparedRay {
    /// A usual ray in the world, in which no coordinate is larger than `largest`. `None` for one that starts behind
    /// its origin, or whose numbers are so large or so small that they need care.
    #[inline(always)]
    pub(crate) fn usual<S: Simd>(simd: S, ray: &Ray, largest: f32) -> Option<Self> {
        let &Ray { origin, t_min, direction, .. } = ray;
        is_usual(simd, origin, direction, t_min, largest).then(
            #[inline(always)]
            || Self::cast(simd, &ScaledRay::usual(origin, direction, 0.0), direction, t_min),
        )
    }

    /// Any ray, in any space in which no coordinate is larger than `largest`. `None` where it cannot hit
    /// anything.
    #[inline(always)]
    pub(crate) fn new<S: Simd>(simd: S, exact: &ExactRay, largest: f32) -> Option<Self> {
        let origin = exact.origin.map(|x| x as f32);
        let direction = exact.direction.map(|x| x as f32);
        let scaled = if is_usual(simd, origin, direction, exact.t_min, largest) {
            ScaledRay::usual(origin, direction, greater(greatest(origin), f32::MIN_POSITIVE))
        } else {
            ScaledRay::unusual(exact, largest)?
        };
        Some(Self::cast(simd, &scaled, direction, exact.t_min))
    }

    #[inline(always)]
    fn cast<S: Simd>(simd: S, scaled: &ScaledRay, direction: [f32; 3], t_min: f32) -> Self {
        // The slabs' constants, three axes at once.
        let lanes = |[x, y, z]: [f32; 3]| f32x4::load_array(simd, [x, y, z, 0.0]);
        let (o, d) = (lanes(scaled.origin), lanes(scaled.direction));
        let [near_reciprocal, far_reciprocal, near_product, far_product] =
            slabs(simd, o, d, lanes(scaled.largest_reciprocal), scaled.moved);

        let &ScaledRay { start, scale, .. } = scaled;
        let first = (t_min - start) - ((t_min.abs() - start) * ROOM + TINY);
        Self {
            scaled: *scaled,
            t_min: greater(first * scale, 0.0),
            near_reciprocal: first_three(near_reciprocal),
            far_reciprocal: first_three(far_reciprocal),
            near_product: first_three(near_product),
            far_product: first_three(far_product),
            near_side: direction.map(|x| (x.to_bits() >> 31) as usize),
        }
    }

    /// Whether it is a usual ray of the world, as it was given.
    #[inline(always)]
    pub(crate) fn is_usual(&self) -> bool {
        self.scaled.rounding == 0.0
    }

    /// A ray's end as a distance, with its margin. 0 or more.
    #[inline(always)]
    pub(crate) fn end(&self, t_max: f32) -> f32 {
        let ScaledRay { start, scale, .. } = self.scaled;
        greater(((t_max - start) + ((t_max.abs() - start) * ROOM + TINY)) * scale, 0.0)
    }
}

/// The slabs' constants, lane by lane: 1 / direction near and far, and their products with the origin.
#[inline(always)]
pub(crate) fn slabs<S: Simd, V: SimdFloat<S, Element = f32>>(
    simd: S,
    origin: V,
    direction: V,
    largest_reciprocal: V,
    moved: f32,
) -> [V; 4] {
    let reciprocal = V::splat(simd, 1.0) / direction.abs();
    let near_reciprocal = reciprocal.min(largest_reciprocal).copysign(direction);
    let far_reciprocal = near_reciprocal * (1.0 + ROOM);
    let moved = near_reciprocal.abs() * moved;
    let near_product = near_reciprocal * origin;
    let near_product = near_product + (near_product.abs() * PRODUCT_ROOM + moved);
    let far_product = far_reciprocal * origin;
    let far_product = far_product - (far_product.abs() * PRODUCT_ROOM + moved);
    [near_reciprocal, far_reciprocal, near_product, far_product]
}

/// True if a ray does not start behind its origin and no number is so large or small that it needs care.
#[inline(always)]
fn is_usual<S: Simd>(simd: S, origin: [f32; 3], direction: [f32; 3], t_min: f32, largest: f32) -> bool {
    let lanes = |[x, y, z]: [f32; 3]| f32x4::load_array(simd, [x, y, z, 0.0]);
    let in_range = lanes(origin).abs().simd_lt(FAR) & lanes(direction).abs().simd_lt(1.0 / SHORT);
    in_range.all_true() & (greatest(direction) > SHORT) & (largest < LARGEST_FILTERED) & (t_min >= 0.0)
}

impl ScaledRay {
    /// `rounding` is 0 where origin and direction are exact.
    #[inline(always)]
    fn usual(origin: [f32; 3], direction: [f32; 3], rounding: f32) -> Self {
        Self {
            origin,
            direction,
            start: 0.0,
            scale: 1.0,
            largest_reciprocal: [LARGEST_RECIPROCAL; 3],
            moved: 0.0,
            rounding,
            error: ERROR * greatest(direction),
            underflow: USUAL_UNDERFLOW,
            sure_before: 1.0 / SURE_AFTER,
        }
    }

    /// The scaled form of a ray that starts behind its origin or has numbers out of the usual range. `None` where
    /// one of them is not finite, or the direction vanishes.
    #[cold]
    #[inline(never)]
    fn unusual(exact: &ExactRay, largest: f32) -> Option<Self> {
        let widest = |x: [f64; 3]| x.iter().fold(0.0_f64, |widest, x| widest.max(x.abs()));
        let (o, d) = (exact.origin, exact.direction);
        let direction = d.map(|x| x as f32);
        let length = greatest(direction);
        if !(o.iter().chain(&d).all(|x| x.is_finite()) && length > 0.0 && length.is_finite()) {
            return None;
        }

        // Move back, but not farther than where the whole tree is ahead.
        let everything = -1.001 * (widest(o) + f64::from(largest)) / widest(d);
        let start = f64::from(exact.t_min.min(0.0)).max(everything).max(f64::from(-LARGEST_PRODUCT)) as f32;
        let t = f64::from(start);
        let origin = [0, 1, 2].map(|axis| (o[axis] + t * d[axis]) as f32);
        let moved = if start < 0.0 { ((widest(o) - t * widest(d)) * MOVED_ROOM) as f32 } else { 0.0 };
        let farthest = greatest(origin);
        if !farthest.is_finite() {
            return None;
        }

        // A power of two within the range of f32 that makes the direction's length 1 to 4, and its inverse.
        let exponent = (length.to_bits() & 0x7f80_0000).clamp(1 << 23, 253 << 23);
        let (shorten, scale) = (f32::from_bits((254 << 23) - exponent), f32::from_bits(exponent));

        let in_range = farthest < LARGEST_FILTERED && largest < LARGEST_FILTERED;
        // Not where t itself might leave the range of f32.
        let may_be_sure = scale > SURE_AFTER && scale < 1.0 / SURE_AFTER;
        Some(Self {
            origin,
            direction: direction.map(|x| x * shorten),
            start,
            scale,
            largest_reciprocal: origin.map(|x| LARGEST_PRODUCT / x.abs().max(1.0)),
            moved,
            rounding: greater(farthest + moved, f32::MIN_POSITIVE),
            error: if in_range { ERROR * (length * shorten) } else { f32::INFINITY },
            underflow: UNDERFLOW * 4.0,
            sure_before: if may_be_sure { 1.0 / SURE_AFTER } else { -1.0 },
        })
    }
}

/// The largest magnitude.
#[inline(always)]
fn greatest(values: [f32; 3]) -> f32 {
    let [x, y, z] = values.map(f32::abs);
    greater(greater(x, y), z)
}

#[inline(always)]
fn first_three<S: Simd>(values: f32x4<S>) -> [f32; 3] {
    [values[0], values[1], values[2]]
}

/// The larger of two numbers; the second where one is NaN.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
