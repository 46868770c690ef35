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
use crate::sphere::Sphere;
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

impl ClosestPoint {
    /// The order of points at equal distance: as for hits at equal t.
    fn rank(&self) -> (u32, u32, u32) {
        (self.instance.wrapping_add(1), self.geometry, self.primitive)
    }

    fn precedes(&self, other: &Self) -> bool {
        self.distance < other.distance || (self.distance == other.distance && self.rank() < other.rank())
    }
}

impl Bvh {
    /// The point on triangles and spheres' surfaces that is nearest to `point`, and at most `max_distance` away. Of
    /// several at the same distance (in f32) the one with the lowest ids, as for [`Self::closest_hit`].
    ///
    /// Distances are right to rounding in f32, and to about 10⁻¹⁵ of the triangle's or sphere's size. Any maps of
    /// instances are supported. Procedural shapes are ignored, because they do not define their surfaces. `None`
    /// where nothing is near enough, for a point that is NaN or beyond 2¹⁰⁰, and where `max_distance` is NaN or
    /// negative.
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
        self.search_points(point, max_distance, false)
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
        self.search_points(point, max_distance, true).is_some()
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

    fn search_points(&self, point: [f32; 3], max_distance: f32, any: bool) -> Option<ClosestPoint> {
        let usable = point.iter().all(|x| x.abs() <= LARGEST_COORDINATE) && max_distance >= 0.0;
        if !usable || self.nodes.is_empty() {
            return None;
        }
        let (point, queue) = (wide(point), BinaryHeap::new());
        let mut search = Search { outer: self, point, max_distance, any, best: None, queue };
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

struct Search<'a> {
    outer: &'a Bvh,
    point: [f64; 3],
    max_distance: f32,
    /// True if any point that is near enough suffices.
    any: bool,
    best: Option<ClosestPoint>,
    queue: BinaryHeap<QueueEntry>,
}

impl Search<'_> {
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
                        let distance = space.distance_to_box(&bounds);
                        if distance <= self.end() {
                            self.queue.push(QueueEntry { distance, child: node.child(slot), place });
                        }
                    }
                }
                Content::Triangles(block) => {
                    let block = &bvh.triangles[block];
                    for lane in 0..block.count() {
                        let nearest = nearest_on_triangle(&space.corners(&block.corners(lane)));
                        self.offer(&space, block.ids(lane), nearest);
                    }
                }
                Content::Leaf(leaf) => match bvh.leaves[leaf] {
                    Leaf::Spheres { first, count } => {
                        for item in &bvh.spheres[first as usize..(first + count) as usize] {
                            self.offer(&space, (item.geometry, item.primitive), space.sphere(&item.shape));
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
        f64::from(self.best.map_or(self.max_distance, |best| best.distance)) * ROOM
    }

    /// Replaces the best point if a primitive's nearest point is nearer.
    fn offer(&mut self, space: &Space<'_>, (geometry, primitive): (u32, u32), nearest: Nearest) {
        let offset = nearest.offset;
        let found = ClosestPoint {
            position: [0, 1, 2].map(|axis| (self.point[axis] + offset[axis]) as f32),
            distance: nearest.distance as f32,
            u: nearest.u as f32,
            v: nearest.v as f32,
            primitive,
            geometry,
            instance: space.instance,
        };
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
    fn offset(&self, p: [f32; 3]) -> [f64; 3] {
        let p = self.map.map_or(wide(p), |map| map.vector(wide(p)));
        [0, 1, 2].map(|axis| p[axis] + self.origin[axis])
    }

    fn corners(&self, corners: &[[f32; 3]; 3]) -> [[f64; 3]; 3] {
        corners.map(|corner| self.offset(corner))
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

    fn sphere(&self, sphere: &Sphere) -> Nearest {
        let center = self.offset(sphere.center);
        let radius = f64::from(sphere.radius);
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
