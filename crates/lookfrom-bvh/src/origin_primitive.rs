//! The origin primitive of a ray, and its exclusion: no self-intersection.
//!
//! [`Point`](crate::Point) places origins so that rays do not hit the triangle that they start on. A query that
//! knows the triangle need not test it at all, which saves the slowest test: the ray is too near for single
//! precision.

use crate::ray::{Hit, NONE};

/// The primitive that a ray starts on. A triangle is flat, so the ray cannot hit it again, and it is not reported.
/// A sphere or a procedural shape, which a ray from its inside does hit again, is reported as usual.
///
/// ```
/// use lookfrom_bvh::{Hit, NONE, OriginPrimitive};
/// let hit = Hit { t: 1.0, geometry: 2, primitive: 7, ..Hit::MISS };
/// assert_eq!(OriginPrimitive::of(&hit), OriginPrimitive { instance: NONE, geometry: 2, primitive: 7 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct OriginPrimitive {
    /// Number of its instance; [`NONE`] where its geometry is not in an instance.
    pub instance: u32,
    /// Number of its geometry; [`NONE`] for rays without an origin primitive.
    pub geometry: u32,
    /// Its number within the geometry.
    pub primitive: u32,
}

impl OriginPrimitive {
    /// The ray has no origin primitive, or an unknown one.
    ///
    /// ```
    /// use lookfrom_bvh::{NONE, OriginPrimitive};
    /// assert_eq!(OriginPrimitive::NONE.geometry, NONE);
    /// ```
    pub const NONE: Self = Self { instance: NONE, geometry: NONE, primitive: NONE };

    /// The primitive that was hit.
    ///
    /// ```
    /// use lookfrom_bvh::{Hit, OriginPrimitive};
    /// assert_eq!(OriginPrimitive::of(&Hit::MISS), OriginPrimitive::NONE);
    /// ```
    pub const fn of(hit: &Hit) -> Self {
        Self { instance: hit.instance, geometry: hit.geometry, primitive: hit.primitive }
    }

    #[inline(always)]
    pub(crate) fn is(self, instance: u32, (geometry, primitive): (u32, u32)) -> bool {
        self.primitive == primitive && self.geometry == geometry && self.instance == instance
    }
}

impl Default for OriginPrimitive {
    fn default() -> Self {
        Self::NONE
    }
}
