//! The intersection of a ray with a sphere: Haines et al. (2019).
//!
//! Entirely in f64: "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7. With
//! the vector `f` from centre to origin and half the usual linear coefficient, `A t² + 2 B t + C = 0`.

use crate::aabb::{Aabb, LARGEST_COORDINATE};
use crate::exact::{ExactRay, Rounded};
use crate::vector::{dot, subtract, wide};
use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, f64x8, mask32x8, prelude::*};

mod block;

pub(crate) use block::{SphereBlock, SphereItem};

/// A sphere's surface: rays hit it from both sides.
///
/// ```
/// use lookfrom_bvh::{Builder, Sphere};
/// let mut builder = Builder::new();
/// builder.spheres(&[Sphere { center: [0.0, 1.0, 0.0], radius: 0.5 }]);
/// # assert_eq!(builder.build()?.statistics().spheres, 1);
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: [f32; 3],
    /// Positive and finite.
    pub radius: f32,
}

impl Sphere {
    /// Its bounding box, rounded outwards.
    ///
    /// ```
    /// use lookfrom_bvh::Sphere;
    /// let bounds = Sphere { center: [0.0; 3], radius: 1.0 }.bounds();
    /// assert!(bounds.min[0] < -1.0 && bounds.max[0] > 1.0);
    /// ```
    pub fn bounds(&self) -> Aabb {
        // One ulp more than the sum's rounding: a point at exactly the radius is inside.
        Aabb {
            min: self.center.map(|x| (x - self.radius).next_down()),
            max: self.center.map(|x| (x + self.radius).next_up()),
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.center.iter().all(|x| x.abs() <= LARGEST_COORDINATE) && self.radius.abs() <= LARGEST_COORDINATE
    }
}

/// Both hits of the whole line with the sphere, the smaller t first. `None` where the line misses it.
pub(crate) fn intersect_exact<T: Rounded>(ray: &ExactRay<T>, sphere: &Sphere) -> Option<[T; 2]> {
    let radius = f64::from(sphere.radius);
    let line = Line::new(ray.origin, ray.direction);
    let quadratic = Quadratic::new(&line, wide(sphere.center), radius);
    if !(quadratic.discriminant >= 0.0) {
        return None;
    }
    let [t1, t2] = quadratic.roots(radius).map(T::rounded);
    Some(if t1 <= t2 { [t1, t2] } else { [t2, t1] })
}

/// Eight rays, or one in all lanes, for the exclusion of spheres in single precision.
pub(crate) struct SphereFilter<S: Simd> {
    origin: [f32x8<S>; 3],
    d: [f32x8<S>; 3],
    /// The square of the direction's length.
    a: f32x8<S>,
}

impl<S: Simd> SphereFilter<S> {
    #[inline(always)]
    pub(crate) fn new(origin: [f32x8<S>; 3], d: [f32x8<S>; 3]) -> Self {
        Self { origin, d, a: dot(d, d) }
    }

    /// The lanes in which a ray may hit a sphere; in all others it misses it, or has passed it. They must be usual rays.
    ///
    /// A line misses the sphere where b² < a (f² − r²). Of these, b² and a f² have errors of at most 9 and 12 units of
    /// rounding of a f², and the margin is 64. It covers the rounding of the exact test, too.
    #[inline(always)]
    pub(crate) fn may_hit(&self, [x, y, z]: [f32x8<S>; 3], radius: f32x8<S>) -> mask32x8<S> {
        const MARGIN: f32 = 64.0 * f32::EPSILON / 2.0;
        // More than what products lose by underflow.
        const TINY: f32 = 1e-30;
        // The square of a bound of b's error, relative to a f².
        const SURE_SIGN: f32 = 1e-12;
        let Self { origin: [ox, oy, oz], d, a } = *self;
        let f = [ox - x, oy - y, oz - z];
        let (b, ff) = (dot(f, d), dot(f, f));
        let bb = b * b + TINY;
        let outside = ff * (1.0 - MARGIN) - (radius * radius) * (1.0 + MARGIN);
        let misses = bb.simd_lt(a * outside);
        let zero = b.like(0.0);
        let is_past = b.simd_gt(zero) & outside.simd_gt(zero) & (b * b).simd_gt(a * ff * SURE_SIGN + TINY);
        !(misses | is_past)
    }
}

/// The lines of eight rays.
#[inline(always)]
pub(crate) fn lines<S: Simd>(origin: [f32x8<S>; 3], direction: [f32x8<S>; 3]) -> Line<f64x8<S>> {
    Line::new(
        [Real::widen(origin[0]), Real::widen(origin[1]), Real::widen(origin[2])],
        [Real::widen(direction[0]), Real::widen(direction[1]), Real::widen(direction[2])],
    )
}

/// Lines among the rays of a mask that hit the sphere, and both hits of each. `None` where there are none.
#[inline(always)]
pub(crate) fn intersect_lanes<S: Simd>(
    simd: S,
    lines: &Line<f64x8<S>>,
    sphere: &Sphere,
    rays: mask32x8<S>,
) -> Option<(mask32x8<S>, [f32x8<S>; 2])> {
    let like = lines.a;
    let like_f32 = f32x8::splat(simd, 0.0);
    let [x, y, z] = sphere.center.map(f64::from);
    let radius = like.like(f64::from(sphere.radius));
    let quadratic = Quadratic::new(lines, [like.like(x), like.like(y), like.like(z)], radius);
    let hit = Float::lt(quadratic.discriminant, like.like(0.0));
    let hit = Float::eq(quadratic.discriminant, quadratic.discriminant) & !hit;
    let hit = like_f32.narrow_mask(hit) & rays;
    if !hit.any() {
        return None;
    }
    let [t1, t2] = quadratic.roots(radius);
    let [t1, t2]: [f32x8<S>; 2] = [Real::narrow(t1), Real::narrow(t2)];
    let turned = Float::gt(t1, t2);
    Some((hit, [Float::select(turned, t2, t1), Float::select(turned, t1, t2)]))
}

/// A line that is tested against spheres.
pub(crate) struct Line<T> {
    origin: [T; 3],
    d: [T; 3],
    /// The square of the direction's length.
    a: T,
}

impl<T: Float<Scalar = f64>> Line<T> {
    #[inline(always)]
    fn new(origin: [T; 3], d: [T; 3]) -> Self {
        Self { origin, d, a: dot(d, d) }
    }
}

/// The quadratic equation of a line and a sphere.
struct Quadratic<T> {
    /// From the centre to the line's origin.
    f: [T; 3],
    a: T,
    b: T,
    discriminant: T,
}

impl<T: Float<Scalar = f64>> Quadratic<T> {
    #[inline(always)]
    fn new(&Line { origin, d, a }: &Line<T>, center: [T; 3], radius: T) -> Self {
        let f = subtract(origin, center);
        let b = dot(f, d);

        // The discriminant from the line's point nearest to the centre: no cancellation for small or distant
        // spheres.
        let s = b / a;
        let nearest = [f[0] - s * d[0], f[1] - s * d[1], f[2] - s * d[2]];
        Self { f, a, b, discriminant: a * (radius * radius - dot(nearest, nearest)) }
    }

    /// Both roots without cancellation, in any order.
    #[inline(always)]
    fn roots(&self, radius: T) -> [T; 2] {
        let Self { f, a, b, discriminant } = *self;
        let length = dot(f, f).sqrt();
        let c = (length - radius) * (length + radius);
        let q = -(b + discriminant.sqrt().copysign(b));
        let zero = a.like(0.0);
        let is_zero = q.eq(zero);
        [T::select(is_zero, zero, q / a), T::select(is_zero, zero, c / q)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;

    fn roots(sphere: Sphere, origin: [f32; 3], direction: [f32; 3]) -> Option<[f32; 2]> {
        intersect_exact(&ExactRay::new(&Ray::new(origin, direction)), &sphere)
    }

    #[test]
    fn from_outside_inside_and_behind() {
        let sphere = Sphere { center: [0.0, 0.0, 5.0], radius: 1.0 };
        assert_eq!(roots(sphere, [0.0; 3], [0.0, 0.0, 2.0]), Some([2.0, 3.0]));
        assert_eq!(roots(sphere, [0.0, 0.0, 5.0], [0.0, 0.0, 1.0]), Some([-1.0, 1.0]));
        assert_eq!(roots(sphere, [0.0, 0.0, 9.0], [0.0, 0.0, 1.0]), Some([-5.0, -3.0]));
        assert_eq!(roots(sphere, [1.5, 0.0, 0.0], [0.0, 0.0, 1.0]), None);
        assert_eq!(roots(sphere, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), Some([5.0, 5.0]), "tangent");
    }

    #[test]
    fn a_small_sphere_far_away() {
        // B² − AC in f32 would be noise here.
        let sphere = Sphere { center: [0.0, 0.0, 1e6], radius: 0.5 };
        assert_eq!(roots(sphere, [0.0; 3], [0.0, 0.0, 1.0]), Some([999_999.5, 1_000_000.5]));
    }
}
