//! Closest-point queries: the point of the geometry that is nearest to a given one.
//!
//! Boxes are opened in the order of their distances, until the next is farther than the best point so far. As with
//! rays, single precision only excludes: each primitive's distance is computed in f64, on its own, so results do
//! not depend on the tree. Primitives of instances are measured in the world, under any map: triangles by their
//! transformed corners, spheres as the ellipsoids that they become (`ellipsoid`).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::aabb::{Aabb, LARGEST_COORDINATE};
use crate::affine::Affine;
use crate::batch::for_each;
use crate::bvh::Bvh;
use crate::ellipsoid::nearest_on_ellipsoid;
use crate::item::Leaf;
use crate::nearest::{Nearest, nearest_on_triangle};
use crate::node::{Child, Content, WIDTH};
use crate::ray::NONE;
use crate::unrounded::{InTree, Shapes, Unrounded};
use crate::vector::{dot, subtract, wide};

/// Relative margin for the rounding of distances: 2⁻²⁰.
const ROOM: f64 = 1.0 + 9.536_743_164_062_5e-7;

/// Relative error of a transformed box, with a large margin: 2⁻⁴⁶.
const MAPPED_ERROR: f64 = 1.421_085_471_520_200_4e-14;

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
    /// Number of the instance; [`NONE`] where the geometry is not in an instance.
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
    /// Number of the instance; [`NONE`] where the geometry is not in an instance.
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
    /// negative. What moves in time ([`Builder::moving_triangles`](crate::Builder::moving_triangles)) is not looked at.
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
        self.search_points(InTree, wide(point), max_distance.into(), false).map(Into::into)
    }

    /// [`Self::closest_point`] in double precision, on shapes as they were before they were rounded for the tree.
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
        self.search_points(shapes, point, max_distance, false)
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
        self.search_points(InTree, wide(point), max_distance.into(), true).is_some()
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

    fn search_points<S: Shapes>(
        &self,
        shapes: S,
        point: [f64; 3],
        max_distance: f64,
        any: bool,
    ) -> Option<ClosestPointF64> {
        let usable = point.iter().all(|x| x.abs() <= f64::from(LARGEST_COORDINATE)) && max_distance >= 0.0;
        if !usable || self.nodes.is_empty() {
            return None;
        }
        let queue = BinaryHeap::new();
        let mut search = Search { outer: self, shapes, point, max_distance, any, best: None, queue };
        search.queue.push(QueueEntry { distance: 0.0, child: Child::ROOT, place: NONE });
        search.run();
        search.best
    }
}

/// A child still to be opened.
struct QueueEntry {
    /// Lower bound of the distances within it.
    distance: f64,
    child: Child,
    /// Index of the instance in the outer tree's list; [`NONE`] for the outer tree itself.
    place: u32,
}

impl Ord for QueueEntry {
    /// The nearest is the largest, which the heap returns first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance)
    }
}

impl PartialOrd for QueueEntry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for QueueEntry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for QueueEntry {}

struct Search<'a, S> {
    outer: &'a Bvh,
    shapes: S,
    point: [f64; 3],
    max_distance: f64,
    /// True if any point that is near enough suffices.
    any: bool,
    best: Option<ClosestPointF64>,
    queue: BinaryHeap<QueueEntry>,
}

impl<S: Shapes> Search<'_, S> {
    fn run(&mut self) {
        while let Some(QueueEntry { distance, child, place }) = self.queue.pop() {
            if distance > self.end() || (self.any && self.best.is_some()) {
                break;
            }
            let instance = self.outer.instances.get(place as usize);
            let bvh = instance.map_or(self.outer, |instance| &*instance.bvh);
            let space = match instance {
                Some(instance) => Space::new(&instance.world_from_object, self.point, place),
                None => Space::world(self.point),
            };
            match child.content() {
                Content::Node(number) => {
                    let node = &bvh.nodes[number];
                    for slot in 0..WIDTH {
                        let bounds = node.child_bounds(slot);
                        if bounds.is_empty() {
                            continue;
                        }
                        let distance = space.distance_to_box(&bounds) - self.shapes.error();
                        if distance <= self.end() {
                            self.queue.push(QueueEntry { distance, child: node.child(slot), place });
                        }
                    }
                }
                Content::Triangles(block) => {
                    let block = &bvh.triangles[block];
                    for lane in 0..block.count() {
                        let (geometry, primitive) = block.ids(lane);
                        let ids = [space.instance, geometry, primitive];
                        let corners = self.shapes.triangle(ids, block.corners(lane));
                        self.offer(ids, nearest_on_triangle(&corners.map(|p| space.offset(p))));
                    }
                }
                Content::Leaf(leaf) => match bvh.leaves[leaf] {
                    Leaf::Spheres { block } => {
                        for item in bvh.spheres[block as usize].items() {
                            let ids = [space.instance, item.geometry, item.primitive];
                            let (center, radius) =
                                self.shapes.sphere(ids, (item.shape.center, item.shape.radius));
                            self.offer(ids, space.sphere(center, radius));
                        }
                    }
                    Leaf::Procedurals { .. } => {}
                    Leaf::Instances { first, count } => {
                        let roots = (first..first + count)
                            .filter(|&place| !self.outer.instances[place as usize].bvh.nodes.is_empty())
                            .map(|place| QueueEntry { distance, child: Child::ROOT, place });
                        self.queue.extend(roots);
                    }
                },
            }
        }
    }

    /// Boxes beyond this distance are ignored.
    fn end(&self) -> f64 {
        self.best.map_or(self.max_distance, |best| best.distance) * ROOM
    }

    /// Replaces the best point if a primitive's nearest point is nearer.
    fn offer(&mut self, [instance, geometry, primitive]: [u32; 3], nearest: Nearest) {
        let Nearest { offset, u, v, .. } = nearest;
        let position = [0, 1, 2].map(|axis| self.point[axis] + offset[axis]);
        let distance = self.shapes.distance(nearest.distance);
        let found = ClosestPointF64 { position, distance, u, v, primitive, geometry, instance };
        if found.distance <= self.max_distance && self.best.is_none_or(|best| found.precedes(&best)) {
            self.best = Some(found);
        }
    }
}

/// A tree's space relative to the query point: axes as in the world, the query point at 0.
struct Space<'a> {
    /// `None` for the world itself.
    map: Option<&'a Affine>,
    /// The space's origin relative to the query point.
    origin: [f64; 3],
    instance: u32,
}

impl<'a> Space<'a> {
    fn world(point: [f64; 3]) -> Self {
        Self { map: None, origin: point.map(|x| -x), instance: NONE }
    }

    fn new(map: &'a Affine, point: [f64; 3], instance: u32) -> Self {
        Self { map: Some(map), origin: subtract(map.translation, point), instance }
    }

    /// A point of the space relative to the query point.
    fn offset(&self, p: [f64; 3]) -> [f64; 3] {
        let p = self.map.map_or(p, |map| map.vector(p));
        [0, 1, 2].map(|axis| p[axis] + self.origin[axis])
    }

    /// Lower bound of the distances within a box.
    fn distance_to_box(&self, bounds: &Aabb) -> f64 {
        let (mut low, mut high) = (self.origin, self.origin);
        for axis in 0..3 {
            match self.map {
                None => {
                    low[axis] += f64::from(bounds.min[axis]);
                    high[axis] += f64::from(bounds.max[axis]);
                }
                Some(map) => {
                    // Each term takes its minimum and maximum independently.
                    let mut magnitude = self.origin[axis].abs();
                    for column in 0..3 {
                        let entry = map.matrix[axis][column];
                        let a = entry * f64::from(bounds.min[column]);
                        let b = entry * f64::from(bounds.max[column]);
                        low[axis] += a.min(b);
                        high[axis] += a.max(b);
                        magnitude += a.abs().max(b.abs());
                    }
                    low[axis] -= MAPPED_ERROR * magnitude;
                    high[axis] += MAPPED_ERROR * magnitude;
                }
            }
        }
        let outside = [0, 1, 2].map(|axis| low[axis].max(-high[axis]).max(0.0));
        dot(outside, outside).sqrt()
    }

    fn sphere(&self, center: [f64; 3], radius: f64) -> Nearest {
        let center = self.offset(center);
        if let Some(map) = self.map {
            return nearest_on_ellipsoid(center, &map.matrix, radius);
        }
        let length = dot(center, center).sqrt();
        // At the centre all directions are equivalent.
        let toward = if length > 0.0 { center.map(|x| -x / length) } else { [1.0, 0.0, 0.0] };
        let offset = [0, 1, 2].map(|axis| center[axis] + radius * toward[axis]);
        Nearest { offset, distance: (length - radius).abs(), u: 0.0, v: 0.0 }
    }
}
