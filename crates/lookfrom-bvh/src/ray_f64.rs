//! Rays and hits in double precision: plain data with the layout of C.
//!
//! For rays whose numbers are not representable in f32: CAD far from the origin, measurements, comparisons with
//! other kernels. `traverse_f64` traces them.

use crate::ray::{NONE, Ray};

/// A ray in double precision: the points `p(t) = origin + t · direction` with `t_min < t < t_max`.
///
/// The direction may have any length but zero; `t` is in units of its length. A ray with a NaN, an empty range,
/// or an origin or direction that f32 would round to infinity (or to a zero direction) hits nothing.
///
/// The layout is that of C: `origin` at byte 0, `t_min` at 24, `direction` at 32, `t_max` at 56; 64 bytes in all.
///
/// ```
/// use lookfrom_bvh::RayF64;
/// let ray = RayF64 { t_max: 10.0, ..RayF64::new([0.1, 0.2, 0.3], [0.0, 0.0, 1.0]) };
/// assert_eq!((ray.t_min, ray.t_max), (0.0, 10.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct RayF64 {
    /// The point at `t = 0`.
    pub origin: [f64; 3],
    /// Hits need `t > t_min`. May be negative.
    pub t_min: f64,
    /// Any length but zero.
    pub direction: [f64; 3],
    /// Hits need `t < t_max`. May be infinite.
    pub t_max: f64,
}

impl RayF64 {
    /// The ray with `t` in (0, ∞).
    ///
    /// ```
    /// assert_eq!(lookfrom_bvh::RayF64::new([0.0; 3], [1.0, 0.0, 0.0]).t_max, f64::INFINITY);
    /// ```
    pub const fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f64::INFINITY }
    }
}

impl From<Ray> for RayF64 {
    fn from(ray: Ray) -> Self {
        let Ray { origin, t_min, direction, t_max } = ray;
        Self {
            origin: origin.map(f64::from),
            t_min: t_min.into(),
            direction: direction.map(f64::from),
            t_max: t_max.into(),
        }
    }
}

/// The intersection of a [`RayF64`] with a primitive, or [`HitF64::MISS`].
///
/// The layout is that of C: `t` at byte 0, `u` at 8, `v` at 16, `primitive` at 24, `geometry` at 28, `instance` at 32; 40 bytes
/// in all, of which the last four are padding.
///
/// ```
/// assert!(!lookfrom_bvh::HitF64::MISS.is_hit());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct HitF64 {
    /// The ray's parameter: the hit is at `origin + t · direction`. Infinite for a miss.
    pub t: f64,
    /// First coordinate. Of a triangle: β, the weight of its second corner. Of a sphere: 0. Of a procedural shape: its own,
    /// in f32.
    pub u: f64,
    /// Second coordinate. Of a triangle: γ, the weight of its third corner. Of a sphere: 0. Of a procedural shape: its own,
    /// in f32.
    pub v: f64,
    /// Number of the primitive in its geometry.
    pub primitive: u32,
    /// Number of the geometry in its tree, in the order of the builder's calls.
    pub geometry: u32,
    /// Number of the instance; [`NONE`] where the geometry is not in an instance.
    pub instance: u32,
}

impl HitF64 {
    /// Nothing was hit.
    ///
    /// ```
    /// assert_eq!(lookfrom_bvh::HitF64::MISS.t, f64::INFINITY);
    /// ```
    pub const MISS: Self =
        Self { t: f64::INFINITY, u: 0.0, v: 0.0, primitive: NONE, geometry: NONE, instance: NONE };

    /// True if something was hit.
    ///
    /// ```
    /// use lookfrom_bvh::HitF64;
    /// assert!(HitF64 { primitive: 0, ..HitF64::MISS }.is_hit());
    /// ```
    pub const fn is_hit(&self) -> bool {
        self.primitive != NONE
    }

    /// The order of hits at equal `t`, as for [`Hit`](crate::Hit)s.
    pub(crate) fn rank(&self) -> (u32, u32, u32) {
        (self.instance.wrapping_add(1), self.geometry, self.primitive)
    }

    /// True if this hit precedes another: it is nearer, or as near and of lower rank.
    pub(crate) fn precedes(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.rank() < other.rank())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{align_of, offset_of};

    #[test]
    fn the_layout_is_as_documented() {
        assert_eq!((size_of::<RayF64>(), align_of::<RayF64>()), (64, 8));
        let ray = [offset_of!(RayF64, origin), offset_of!(RayF64, t_min), offset_of!(RayF64, direction)];
        assert_eq!((ray, offset_of!(RayF64, t_max)), ([0, 24, 32], 56));
        assert_eq!((size_of::<HitF64>(), align_of::<HitF64>()), (40, 8));
        let point = [offset_of!(HitF64, t), offset_of!(HitF64, u), offset_of!(HitF64, v)];
        let ids = [offset_of!(HitF64, primitive), offset_of!(HitF64, geometry), offset_of!(HitF64, instance)];
        assert_eq!((point, ids), ([0, 8, 16], [24, 28, 32]));
    }
}
