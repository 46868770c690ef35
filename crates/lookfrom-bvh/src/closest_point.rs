//! Closest-point queries: the point of the geometry that is nearest to a given one.
//!
//! Boxes are opened in the order of their distances, until the next is farther than the best point so far. As with
//! rays, single precision only excludes: each primitive's distance is computed in f64, on its own, so results do
//! not depend on the tree. Primitives of instances are measured in the world, under any map: triangles by their
//! transformed corners, spheres as the ellipsoids that they become (`ellipsoid`).

mod search;

use search::search;

use crate::batch::for_each;
use crate::bvh::Bvh;
use crate::settings::Settings;
use crate::unrounded::{InTree, Unrounded};
use crate::vector::wide;

/// The nearest point of some geometry, as [`Bvh::closest_point`] finds it.
///
/// ```
/// # use lookfrom_bvh::{Builder, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// let nearest = bvh.closest_point([0.0, 0.0, 3.0], f32::INFINITY).unwrap();
/// assert_eq!((nearest.position, nearest.distance), ([0.0, 0.0, 1.0], 2.0));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Its position in the world.
    pub position: [f32; 3],
    /// Its distance from the query point, not negative.
    pub distance: f32,
    /// First coordinate. Of a triangle: β, the weight of its second corner. Of a sphere: 0.
    pub u: f32,
    /// Second coordinate. Of a triangle: γ, the weight of its third corner. Of a sphere: 0.
    pub v: f32,
    /// Number of the primitive in its geometry.
    pub primitive: u32,
    /// Number of the geometry in its tree.
    pub geometry: u32,
    /// Number of the instance; [`NONE`](crate::NONE) where the geometry is not in an instance.
    pub instance: u32,
}

/// The nearest point of some geometry in double precision, as [`Bvh::closest_point_unrounded`] finds it.
///
/// ```
/// # use lookfrom_bvh::ClosestPointF64;
/// fn reach(nearest: &ClosestPointF64) -> f64 {
///     nearest.distance
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPointF64 {
    /// Its position in the world.
    pub position: [f64; 3],
    /// Its distance from the query point, not negative.
    pub distance: f64,
    /// First coordinate. Of a triangle: β, the weight of its second corner. Of a sphere: 0.
    pub u: f64,
    /// Second coordinate. Of a triangle: γ, the weight of its third corner. Of a sphere: 0.
    pub v: f64,
    /// Number of the primitive in its geometry.
    pub primitive: u32,
    /// Number of the geometry in its tree.
    pub geometry: u32,
    /// Number of the instance; [`NONE`](crate::NONE) where the geometry is not in an instance.
    pub instance: u32,
}

impl ClosestPointF64 {
    /// The order of points at equal distance: as for hits at equal t.
    fn rank(&self) -> (u32, u32, u32) {
        (self.instance.wrapping_add(1), self.geometry, self.primitive)
    }

    fn precedes(&self, other: &Self) -> bool {
        self.distance < other.distance || (self.distance == other.distance && self.rank() < other.rank())
    }
}

impl From<ClosestPointF64> for ClosestPoint {
    fn from(fine: ClosestPointF64) -> Self {
        let ClosestPointF64 { position, distance, u, v, primitive, geometry, instance } = fine;
        let [distance, u, v] = [distance, u, v].map(|x| x as f32);
        Self { position: position.map(|x| x as f32), distance, u, v, primitive, geometry, instance }
    }
}

impl Bvh {
    /// The point on triangles and spheres' surfaces that is nearest to `point`, and at most `max_distance` away. Of
    /// several at the same distance (in f32) the one with the lowest ids, as for [`Self::closest_hit`].
    ///
    /// Distances are right to rounding in f32, and to about 10⁻¹⁵ of the triangle's or sphere's size. Any maps of
    /// instances are supported. Procedural shapes are ignored, because they do not define their surfaces. `None`
    /// where nothing is near enough, for a point that is NaN or beyond 2¹⁰⁰, and where `max_distance` is NaN or
    /// negative. What moves is where it is at time 0; [`Query::closest_point`](crate::Query::closest_point) has a time, and masks.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Triangles};
    /// let positions = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    /// let mut builder = Builder::new();
    /// builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// let bvh = builder.build()?;
    /// let nearest = bvh.closest_point([1.0, 2.0, -3.0], f32::INFINITY).unwrap();
    /// assert_eq!((nearest.position, nearest.distance), ([1.0, 2.0, 0.0], 3.0));
    /// assert_eq!((nearest.u, nearest.v), (0.25, 0.5));
    /// assert!(bvh.closest_point([1.0, 2.0, -3.0], 2.5).is_none());
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_point(&self, point: [f32; 3], max_distance: f32) -> Option<ClosestPoint> {
        closest_point(&Settings::new(self), point, max_distance)
    }

    /// [`Self::closest_point`] in double precision, on shapes as they were before they were rounded for the tree; those that move, at
    /// time 0.
    ///
    /// Distances are right to about 10⁻¹⁵ of the distance and of the triangle's or sphere's size.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Triangles, Unrounded};
    /// struct Thirds([[f64; 3]; 3]);
    /// impl Unrounded for Thirds {
    ///     fn triangle(&self, _: u32, _: u32, _: u32) -> [[f64; 3]; 3] {
    ///         self.0
    ///     }
    ///     fn sphere(&self, _: u32, _: u32, _: u32) -> ([f64; 3], f64) {
    ///         ([0.0; 3], 0.0)
    ///     }
    ///     fn error(&self) -> f64 {
    ///         1e-7
    ///     }
    /// }
    /// let z = 1.0 / 3.0;
    /// let thirds = Thirds([[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]]);
    /// let positions = thirds.0.map(|p| p.map(|x| x as f32));
    /// let mut builder = Builder::new();
    /// builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// let nearest = builder.build()?.closest_point_unrounded([0.25, 0.5, 0.0], f64::INFINITY, &thirds).unwrap();
    /// assert_eq!(nearest.distance, z);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_point_unrounded(
        &self,
        point: [f64; 3],
        max_distance: f64,
        shapes: &impl Unrounded,
    ) -> Option<ClosestPointF64> {
        search(&Settings::new(self), shapes, point, max_distance, false)
    }

    /// [`Self::closest_point`] for each point, on several threads where there are many. The two slices should have
    /// equal lengths; the surplus of the longer one is ignored.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let bvh = builder.build()?;
    /// let mut nearest = [None; 2];
    /// bvh.closest_points(&[[3.0, 0.0, 0.0], [0.0, 0.5, 0.0]], 1.0, &mut nearest);
    /// assert!(nearest[0].is_none());
    /// assert_eq!(nearest[1].unwrap().distance, 0.5);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_points(
        &self,
        points: &[[f32; 3]],
        max_distance: f32,
        nearest: &mut [Option<ClosestPoint>],
    ) {
        for_each(points, nearest, |_, &point, nearest| *nearest = self.closest_point(point, max_distance));
    }

    /// True if [`Self::closest_point`] would find a point: stops at the first primitive that is near enough.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let bvh = builder.build()?;
    /// assert!(bvh.is_near([3.0, 0.0, 0.0], 2.0) && !bvh.is_near([3.0, 0.0, 0.0], 1.9));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn is_near(&self, point: [f32; 3], max_distance: f32) -> bool {
        is_near(&Settings::new(self), point, max_distance)
    }

    /// [`Self::is_near`] for each point, on several threads where there are many. The two slices should have equal
    /// lengths; the surplus of the longer one is ignored.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let mut near = [false; 2];
    /// builder.build()?.are_near(&[[3.0, 0.0, 0.0], [0.0, 0.5, 0.0]], 1.0, &mut near);
    /// assert_eq!(near, [false, true]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn are_near(&self, points: &[[f32; 3]], max_distance: f32, near: &mut [bool]) {
        for_each(points, near, |_, &point, near| *near = self.is_near(point, max_distance));
    }
}

/// [`Bvh::closest_point`] of what a query sees, at the time of its first ray.
pub(crate) fn closest_point(
    settings: &Settings<'_>,
    point: [f32; 3],
    max_distance: f32,
) -> Option<ClosestPoint> {
    search(settings, InTree, wide(point), max_distance.into(), false).map(Into::into)
}

/// [`Bvh::is_near`], as [`closest_point`].
pub(crate) fn is_near(settings: &Settings<'_>, point: [f32; 3], max_distance: f32) -> bool {
    search(settings, InTree, wide(point), max_distance.into(), true).is_some()
}
