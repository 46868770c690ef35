//! Procedural shapes: neither triangles nor spheres; the caller defines their bounds and intersections.

use std::fmt::Debug;

use crate::aabb::Aabb;
use crate::capsule::Capsule;
use crate::eight_rays::EightRays;
use crate::ray::Ray;
use lookfrom_simd::LaneMask;

/// Many shapes of one kind, numbered from 0.
///
/// ```
/// use lookfrom_bvh::{Aabb, Builder, Procedural, ProceduralHit, Ray};
/// use std::sync::Arc;
///
/// /// The unit square in the plane z = 0.
/// #[derive(Debug)]
/// struct Square;
///
/// impl Procedural for Square {
///     fn count(&self) -> u32 {
///         1
///     }
///     fn bounds(&self, _: u32) -> Aabb {
///         Aabb { min: [0.0; 3], max: [1.0, 1.0, 0.0] }
///     }
///     fn intersect(&self, _: u32, ray: &Ray) -> Option<ProceduralHit> {
///         let t = -ray.origin[2] / ray.direction[2];
///         let [u, v] = [0, 1].map(|i| ray.origin[i] + t * ray.direction[i]);
///         let inside = (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
///         (inside && ray.t_min < t && t < ray.t_max).then_some(ProceduralHit { t, u, v })
///     }
/// }
///
/// let mut builder = Builder::new();
/// builder.procedural(Arc::new(Square));
/// let hit = builder.build()?.closest_hit(&Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -1.0]));
/// assert_eq!((hit.t, hit.u, hit.v), (2.0, 0.25, 0.5));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
pub trait Procedural: Send + Sync + Debug {
    /// The number of shapes. Called when the tree is built.
    fn count(&self) -> u32;

    /// The bounding box of a shape, which must contain all hits of [`Self::intersect`]. A shape whose box is empty
    /// or not finite is left out. Called once or twice, when the tree is built.
    fn bounds(&self, primitive: u32) -> Aabb;

    /// A capsule that contains all hits of [`Self::intersect`] but for the rounding of t, for all shapes or for none; `None` unless
    /// overridden. Up to eight shapes with capsules share a leaf, and rays that pass a capsule by do not ask for the shape: less time
    /// and memory where shapes are long and thin. Called when the tree is built.
    fn capsule(&self, _primitive: u32) -> Option<Capsule> {
        None
    }

    /// The nearest hit with `ray.t_min < t < ray.t_max`; others are ignored. In an instance the ray is in the
    /// object's space, rounded to f32, with the same `t`.
    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit>;

    /// [`Self::intersect`], with the same bits, for those of eight rays of which bit i of `wanted` is set; what is found for others is
    /// ignored. Unless overridden, one ray after the other.
    fn intersect_eight(&self, primitive: u32, rays: &EightRays, wanted: u32) -> [Option<ProceduralHit>; 8] {
        let mut found = [None; 8];
        for lane in LaneMask(wanted) {
            found[lane] = self.intersect(primitive, &rays.ray(lane));
        }
        found
    }
}

/// A hit of a ray with a [`Procedural`].
///
/// ```
/// let hit = lookfrom_bvh::ProceduralHit { t: 2.0, u: 0.0, v: 0.0 };
/// # assert_eq!(hit.t, 2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProceduralHit {
    /// The ray's parameter.
    pub t: f32,
    /// Becomes [`Hit::u`](crate::Hit::u).
    pub u: f32,
    /// Becomes [`Hit::v`](crate::Hit::v).
    pub v: f32,
}
