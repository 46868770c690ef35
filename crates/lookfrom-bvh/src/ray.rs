//! Rays and hits in single precision: plain data with the layout of C.
//!
//! `prepared` prepares a ray for the tests.

/// "None" in place of an id: the ids of a miss.
///
/// ```
/// use lookfrom_bvh::{Hit, NONE};
/// assert_eq!(Hit::MISS.instance, NONE);
/// ```
pub const NONE: u32 = u32::MAX;

/// A ray or a segment of one: the points `p(t) = origin + t · direction` with `t_min < t < t_max`.
///
/// The direction may have any length but zero; `t` is in units of its length. A ray with a NaN, an infinite
/// origin or direction, a zero direction or an empty range hits nothing.
///
/// The layout is that of C: `origin` at byte 0, `t_min` at 12, `direction` at 16, `t_max` at 28; 32 bytes in all.
///
/// ```
/// use lookfrom_bvh::Ray;
/// let ray = Ray { t_min: 0.5, ..Ray::new([0.0; 3], [0.0, 0.0, -2.0]).with_t_max(1.0) };
/// assert_eq!((ray.t_min, ray.t_max), (0.5, 1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// The point at `t = 0`.
    pub origin: [f32; 3],
    /// Hits need `t > t_min`. May be negative.
    pub t_min: f32,
    /// Any length but zero.
    pub direction: [f32; 3],
    /// Hits need `t < t_max`. May be infinite.
    pub t_max: f32,
}

impl Ray {
    /// The ray with `t` in (0, ∞).
    ///
    /// ```
    /// use lookfrom_bvh::Ray;
    /// let ray = Ray::new([0.0; 3], [0.0, 0.0, -2.0]);
    /// assert_eq!((ray.t_min, ray.t_max), (0.0, f32::INFINITY));
    /// ```
    pub const fn new(origin: [f32; 3], direction: [f32; 3]) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f32::INFINITY }
    }

    /// This ray with another `t_max`.
    ///
    /// ```
    /// use lookfrom_bvh::Ray;
    /// assert_eq!(Ray::new([0.0; 3], [0.0, 0.0, -2.0]).with_t_max(4.0).t_max, 4.0);
    /// ```
    pub const fn with_t_max(self, t_max: f32) -> Self {
        Self { t_max, ..self }
    }
}

/// The intersection of a ray with a primitive, or [`Hit::MISS`].
///
/// The layout is that of C: `t` at byte 0, `u` at 4, `v` at 8, `primitive` at 12, `geometry` at 16, `instance` at 20; 24 bytes
/// in all.
///
/// ```
/// # use lookfrom_bvh::{Builder, Ray, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// let hit = bvh.closest_hit(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]));
/// assert_eq!((hit.t, hit.geometry, hit.primitive), (2.0, 0, 0));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// The ray's parameter: the hit is at `origin + t · direction`. Infinite for a miss.
    pub t: f32,
    /// First coordinate. Of a triangle: β, the weight of its second corner. Of a sphere: 0. Of a procedural shape: its own.
    pub u: f32,
    /// Second coordinate. Of a triangle: γ, the weight of its third corner. Of a sphere: 0. Of a procedural shape: its own.
    pub v: f32,
    /// Number of the primitive in its geometry.
    pub primitive: u32,
    /// Number of the geometry in its tree, in the order of the builder's calls.
    pub geometry: u32,
    /// Number of the instance; [`NONE`] where the geometry is not in an instance.
    pub instance: u32,
}

impl Hit {
    /// Nothing was hit.
    ///
    /// ```
    /// assert_eq!(lookfrom_bvh::Hit::MISS.t, f32::INFINITY);
    /// ```
    pub const MISS: Self =
        Self { t: f32::INFINITY, u: 0.0, v: 0.0, primitive: NONE, geometry: NONE, instance: NONE };

    /// True if something was hit.
    ///
    /// ```
    /// use lookfrom_bvh::Hit;
    /// assert!(!Hit::MISS.is_hit() && Hit { primitive: 0, ..Hit::MISS }.is_hit());
    /// ```
    pub const fn is_hit(&self) -> bool {
        self.primitive != NONE
    }

    /// The order of hits at equal `t`, which breaks ties: geometry outside of instances comes first, then by
    /// instance, geometry and primitive.
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
        assert_eq!((size_of::<Ray>(), align_of::<Ray>()), (32, 4));
        let ray = [offset_of!(Ray, origin), offset_of!(Ray, t_min), offset_of!(Ray, direction)];
        assert_eq!((ray, offset_of!(Ray, t_max)), ([0, 12, 16], 28));
        assert_eq!((size_of::<Hit>(), align_of::<Hit>()), (24, 4));
        let point = [offset_of!(Hit, t), offset_of!(Hit, u), offset_of!(Hit, v)];
        let ids = [offset_of!(Hit, primitive), offset_of!(Hit, geometry), offset_of!(Hit, instance)];
        assert_eq!((point, ids), ([0, 4, 8], [12, 16, 20]));
    }
}
